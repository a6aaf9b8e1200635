/* What OBJ and PLY files hold, before it becomes objects: vertices in double precision, polygons of them, colours,
 * texture coordinates. */
#ifndef ENGINE_IMPORT_POLYGONS_H
#define ENGINE_IMPORT_POLYGONS_H

#include "import_build.h"

/* A face without a material gets the default one. */
#define IMPORT_NO_MATERIAL UINT32_MAX

/* A corner whose number in the file is of no vertex. */
#define IMPORT_NO_VERTEX UINT32_MAX

/* Below 2^30, so that three numbers for each still count in 32 bits wherever they go. */
#define IMPORT_MOST_ITEMS (1u << 30)

/* An array that grows by doubling, so that memory follows what a file holds and not what it states. */
typedef struct import_array {
	void *items;
	size_t count, capacity;
} import_array;

/* Room for one more item at the end, counted; NULL: out of memory or IMPORT_MOST_ITEMS reached. */
void *import_array_add(import_array *array, size_t item_size);

typedef struct import_polygon {
	uint32_t corners;  /* how many; they follow those of the polygon before, in import_polygons.corners */
	uint32_t group;    /* which object it becomes a part of */
	uint32_t material; /* the scene's number, or IMPORT_NO_MATERIAL */
	uint32_t place;    /* where it is in the file: see import_polygons */
	bool colored;      /* as a whole; else as its vertices are, where all have a colour */
	float color[3];    /* reflectance, linear */
} import_polygon;

typedef struct import_uv {
	float uv[2];
} import_uv;

typedef struct import_vertex {
	double position[3]; /* metres, finite, no farther than ENGINE_MESH_FARTHEST; 0 of a broken one */
	bool broken;        /* no place is known; faces on it are left out */
	bool colored;
	float color[3]; /* reflectance, linear */
} import_vertex;

typedef struct import_polygons {
	import_array vertices; /* import_vertex */
	import_array corners;  /* uint32_t, numbers of vertices that may come later, or IMPORT_NO_VERTEX */
	import_array uvs;      /* import_uv */
	/* uint32_t, of each corner the number of its uv, which may come later too, or IMPORT_NO_VERTEX; empty where a
	 * format has none */
	import_array corner_uvs;
	import_array faces;   /* import_polygon */
	uint32_t small_faces; /* of fewer than three corners, dropped */
	uint32_t digits;      /* the most significant ones of any coordinate; 0: not written in digits */
	const char *places;   /* what import_polygon.place counts: "line" or "face" */
} import_polygons;

void import_polygons_free(import_polygons *polygons);

/* Adds a vertex without a colour; a broken one where the position is NULL, not finite or too far, so that the others
 * keep their numbers. `text` is what the file says there, or NULL. NULL: out of memory.
 */
import_vertex *import_add_vertex(import_loader *loader, import_polygons *polygons, const double *position,
				 uint32_t place, const char *text);

/* Counts the digits of a coordinate that import_read_number() read from `before` to `after`. */
void import_count_digits(import_polygons *polygons, const char *before, const char *after);

/* The reflectance that a displayed colour stands for: sRGB, each brought to 0..1, to linear. */
void import_linear_color(const double srgb[3], float linear[3]);

/* Makes a face of the last `corners` of polygons->corners, or takes them off again where they are fewer than three.
 * NULL: out of memory. A pointer to a face that is dropped is good until the next call.
 */
import_polygon *import_add_polygon(import_polygons *polygons, uint32_t corners);

/* Whether a face has a colour, or all its corners are of vertices that have one. */
bool import_has_color(const import_polygons *polygons, const import_polygon *face, const uint32_t *corners);

/* Makes the scene's objects: one for each group that has faces, in the order of the groups, named names[group] (NULL or
 * empty: numbered). Faces with a corner that is no vertex, or a broken one, are left out and told; the file is refused
 * where those are most of it. Meshes have colours where some face has one, and texture coordinates where one of a
 * textured material has.
 */
bool import_add_polygons(import_loader *loader, import_polygons *polygons, const char *const *names,
			 uint32_t group_count);

#endif
