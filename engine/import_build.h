/* What readers of files build a scene with: the loader's state, nodes and animation, and the last checks. */
#ifndef ENGINE_IMPORT_BUILD_H
#define ENGINE_IMPORT_BUILD_H

#include "import_types.h"

typedef enum import_interpolation { IMPORT_LINEAR, IMPORT_STEP, IMPORT_CUBIC } import_interpolation;

/* The values of one property of one node over time.
 *   linear, step   values[key][component]
 *   cubic          values[key][in-tangent, value, out-tangent][component]
 */
typedef struct import_channel {
	float *times; /* key_count, seconds, strictly rising, >= 0 */
	float *values;
	uint32_t key_count;  /* >= 1 */
	uint32_t components; /* 3, or 4 for rotations; of morph targets, how many there are */
	bool turns;          /* rotations */
	import_interpolation interpolation;
} import_channel;

enum { IMPORT_TRANSLATION, IMPORT_ROTATION, IMPORT_SCALE, IMPORT_PROPERTIES };

typedef struct import_node {
	int32_t parent;    /* -1: none */
	bool has_matrix;   /* else translation, rotation, scale */
	double matrix[16]; /* column-major */
	double translation[3], rotation[4], scale[3];
	int32_t channels[IMPORT_PROPERTIES]; /* -1: at rest */
	int32_t weights_channel;             /* of morph targets; -1: at rest */
	bool moves;                          /* it or a parent has a channel */
} import_node;

/* More morph targets and joints of a vertex are not looked at. */
enum { IMPORT_MOST_TARGETS = 128, IMPORT_INFLUENCES = 8 };

/* The vertices of an object that deforms, as the file has them: object space, of a skin world space. */
typedef struct import_shape {
	uint32_t vertex_count;
	float *rest;      /* 3 a vertex: as the mesh was read, joints and targets at rest */
	float *bind;      /* 3 a vertex: before them */
	uint32_t *joints; /* IMPORT_INFLUENCES a vertex, and their weights; NULL: no skin */
	float *weights;
	uint32_t joint_count;
	uint32_t *nodes;        /* of the joints */
	double (*inverse)[16];  /* bind matrices */
	double (*matrices)[16]; /* world from mesh, as last placed */
	uint32_t target_count;
	float *deltas; /* 3 a target, target_count a vertex */
	double rest_weights[IMPORT_MOST_TARGETS];
	int32_t weights_channel; /* -1: as at rest */
} import_shape;

void import_free_shape(import_shape *shape); /* NULL is fine */

/* World matrices are kept for one time, as one walk from the parents down serves all objects. */
typedef struct engine_scene_graph {
	import_node *nodes;
	uint32_t *order; /* room for node_count; order_count nodes of the scene, parents before their children */
	double *world;   /* 16 * node_count, column-major: at time_s, or at rest */
	uint32_t node_count, order_count;
	import_channel *channels;
	uint32_t channel_count;
	bool posed, at_rest; /* world is valid; it is that at rest */
	double time_s;
	double origin[3]; /* of the scene in the file's coordinates; taken off every world position */
} engine_scene_graph;

typedef struct import_name {
	const char *name; /* belongs to an object; NULL: an empty slot */
	uint32_t number;  /* "name#number" is the next to try: all from #2 on are taken */
} import_name;

/* The names of the objects so far. Zeroed: none. */
typedef struct import_names {
	import_name *slots;
	size_t capacity, count; /* capacity is 0 or a power of two */
} import_names;

/* What a file holds and the reader leaves out or mends: one kind, however often. */
typedef struct import_kind {
	char text[160];
	char first[64]; /* what it was found in first, or "" */
	uint32_t count;
} import_kind;

enum { IMPORT_MAX_KINDS = 32 };

typedef struct import_loader {
	const char *path;
	engine_scene *scene;
	char *message;
	size_t message_size;
	import_kind *kinds; /* IMPORT_MAX_KINDS, kind_count in use */
	uint32_t kind_count;
	uint32_t faces_seen;       /* of all objects, before any were dropped */
	bool meshes_broken;        /* one or more could not be read */
	uint32_t default_material; /* its number and one; 0: none yet */
	import_names names;
} import_loader;

/* Writes "path: text" as one line; always false, so that callers can return it. */
__attribute__((format(printf, 2, 3))) bool import_fail(import_loader *loader, const char *format, ...);

/* All bytes of the scene's own file, at most 4 GiB, and a zero after the last; the caller frees them. NULL: reported.
 */
uint8_t *import_read_file(import_loader *loader, size_t *size);

/* A note on faces that have no place, of any format. */
#define IMPORT_BROKEN_FACES "faces with a corner that is not there, not finite or beyond 1e15 m are left out"

/* Counts one more case of what the text says; each text becomes one clause of the scene's warning, with the count and
 * the subject (a name; NULL: none) of the first case. Texts are plural: "textures are not read".
 */
__attribute__((format(printf, 3, 4))) void import_note(import_loader *loader, const char *subject, const char *format,
						       ...);

/* The same for `count` cases at once; none is no case. */
__attribute__((format(printf, 4, 5))) void import_note_many(import_loader *loader, uint32_t count, const char *subject,
							    const char *format, ...);

/* Writes what was noted into the scene's warning. */
void import_write_warning(import_loader *loader);

/* A copy with control characters replaced, or `fallback` formatted with `number` where name is NULL or empty. */
char *import_copy_name(const char *name, const char *fallback, uint32_t number);

/* Takes wish (malloc'd, or NULL) and returns it, or "wish#2" and so on where it is taken: exports go by name. The name
 * stays free until import_take_name(). NULL: out of memory.
 */
char *import_unique_name(import_names *names, char *wish);

/* Remembers a name that is free; it must live as long as the table. False: out of memory. */
bool import_take_name(import_names *names, const char *name);

/* Identity, no parent, no animation. */
import_node import_node_default(void);

/* Makes the graph of `count` nodes, all import_node_default(), with none in the order. False: out of memory (reported).
 */
bool import_make_graph(import_loader *loader, uint32_t count);

/* Appends a material, zeroed but for its name, rho 0.5 and factors of 1 for it and alpha. NULL: out of memory (already
 * reported). */
engine_scene_material *import_add_material(import_loader *loader, const char *name);

/* Appends a texture, which is the scene's from then on, freed where that fails; its number and one. False: out of
 * memory. */
bool import_add_texture(import_loader *loader, engine_texture *texture, uint32_t *number);

/* Number of the material for faces that have none; made when first asked for. False: out of memory (reported). */
bool import_default_material(import_loader *loader, uint32_t *number);

/* Marks the materials that faces use and brings all into their ranges; what changes a used one is noted. */
void import_settle_materials(import_loader *loader);

/* Takes the mesh (zeroes *mesh, also on failure), cleans it, pairs its triangles if asked to and appends the object.
 * A mesh with no face left is noted and dropped. Its pose is found by import_settle_objects().
 */
typedef struct import_object_def {
	const char *name;
	uint32_t node;
	double offset[3]; /* object space: the mesh's positions count from here, for those too large for floats */
	double rounding;  /* metres: how far the file's coordinates may be off; the mesh's floats are reckoned with
			     anyhow */
	engine_scheme scheme;
	uint32_t levels;
	bool pair_triangles;
	import_shape *shape; /* taken too; NULL: it keeps its shape */
} import_object_def;
bool import_add_object(import_loader *loader, const import_object_def *def, engine_mesh *mesh);

typedef enum import_pose_result {
	IMPORT_POSE_OK,
	IMPORT_POSE_SINGULAR,
	IMPORT_POSE_SHEARED,
	IMPORT_POSE_MIRRORED,
	IMPORT_POSE_FAR,
	IMPORT_POSE_TINY, /* of no pose alone: no face is large enough at it */
	IMPORT_POSE_RESULTS
} import_pose_result;

/* What the library takes: metres of any coordinate, square metres of a leaf (with a margin), W/(m2 sr) of a lamp. */
#define IMPORT_FARTHEST 1e9
#define IMPORT_LEAST_AREA 1e-23
#define IMPORT_MOST_RADIANCE 3e11f

/* Finds the pose as graph->world has it; where the matrix mirrors or shears, the mesh takes that part. Faces too far or
 * too small for the library are dropped.
 */
import_pose_result import_stand_object(import_loader *loader, engine_scene_object *object);

/* What an object holds. */
void import_release_object(engine_scene_object *object);

/* Sets the `moves` of all nodes in the order. */
void import_mark_moving(engine_scene_graph *graph);

/* The values of a channel at a time, as many as it has components. */
void import_evaluate(const import_channel *channel, double time_s, double *out);

/* Brings graph->world to a time. NULL: at rest. */
void import_pose_graph(engine_scene_graph *graph, const double *time_s);

/* World pose of an object as graph->world has it. For a baked one, whose mesh holds the stretch of its matrix at rest,
 * the rotation and translation alone, and the stretch (row-major 3 x 3, symmetric) in `stretch` where that is not NULL.
 */
import_pose_result import_object_pose(const engine_scene_graph *graph, const engine_scene_object *object,
				      engine_pose *pose, double stretch[9]);

/* a b, of column-major 4 x 4 matrices; out may be either. */
void import_multiply(const double a[16], const double b[16], double out[16]);

/* Object point to world; out may be point. */
void import_transform_point(const engine_pose *pose, const float point[3], float out[3]);

#endif
