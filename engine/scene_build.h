/* What readers of files build a scene with: the loader's state, nodes and animation, and the last checks. */
#ifndef ENGINE_SCENE_BUILD_H
#define ENGINE_SCENE_BUILD_H

#include "scene_types.h"

typedef enum scene_interpolation { SCENE_LINEAR, SCENE_STEP, SCENE_CUBIC } scene_interpolation;

/* The values of one property of one node over time.
 *   linear, step   values[key][component]
 *   cubic          values[key][in-tangent, value, out-tangent][component]
 */
typedef struct scene_channel {
	float *times; /* key_count, seconds, strictly rising, >= 0 */
	float *values;
	uint32_t key_count;  /* >= 1 */
	uint32_t components; /* 3, or 4 for rotations */
	scene_interpolation interpolation;
} scene_channel;

enum { SCENE_TRANSLATION, SCENE_ROTATION, SCENE_SCALE, SCENE_PROPERTIES };

typedef struct scene_node {
	int32_t parent;    /* -1: none */
	bool has_matrix;   /* else translation, rotation, scale */
	double matrix[16]; /* column-major */
	double translation[3], rotation[4], scale[3];
	int32_t channels[SCENE_PROPERTIES]; /* -1: at rest */
	bool moves;                         /* it or a parent has a channel */
} scene_node;

/* World matrices are kept for one time, as one walk from the parents down serves all objects. */
typedef struct engine_scene_graph {
	scene_node *nodes;
	uint32_t *order; /* room for node_count; order_count nodes of the scene, parents before their children */
	double *world;   /* 16 * node_count, column-major: at time_s, or at rest */
	uint32_t node_count, order_count;
	scene_channel *channels;
	uint32_t channel_count;
	bool posed, at_rest; /* world is valid; it is that at rest */
	double time_s;
	double origin[3]; /* of the scene in the file's coordinates; taken off every world position */
} engine_scene_graph;

typedef struct scene_name {
	const char *name; /* belongs to an object; NULL: an empty slot */
	uint32_t number;  /* "name#number" is the next to try: all from #2 on are taken */
} scene_name;

/* The names of the objects so far. Zeroed: none. */
typedef struct scene_names {
	scene_name *slots;
	size_t capacity, count; /* capacity is 0 or a power of two */
} scene_names;

/* What a file holds and the reader leaves out or mends: one kind, however often. */
typedef struct scene_kind {
	char text[160];
	char first[64]; /* what it was found in first, or "" */
	uint32_t count;
} scene_kind;

enum { SCENE_MAX_KINDS = 32 };

/* A material made of another and a colour. */
typedef struct scene_tint {
	uint64_t key;    /* base << 15 | r << 10 | g << 5 | b, steps of 1/31 of the square root; */
	uint32_t number; /* of the material, and one; 0: an empty slot */
} scene_tint;

typedef struct scene_tints {
	scene_tint *slots;
	size_t capacity, count; /* capacity is 0 or a power of two */
} scene_tints;

typedef struct scene_loader {
	const char *path;
	engine_scene *scene;
	char *message;
	size_t message_size;
	scene_kind *kinds; /* SCENE_MAX_KINDS, kind_count in use */
	uint32_t kind_count;
	uint32_t faces_seen;       /* of all objects, before any were dropped */
	bool meshes_broken;        /* one or more could not be read */
	uint32_t default_material; /* its number and one; 0: none yet */
	scene_names names;
	scene_tints tints;
} scene_loader;

/* Writes "path: text" as one line; always false, so that callers can return it. */
__attribute__((format(printf, 2, 3))) bool scene_fail(scene_loader *loader, const char *format, ...);

/* All bytes of the scene's own file, at most 4 GiB, and a zero after the last; the caller frees them. NULL: reported.
 */
uint8_t *scene_read_file(scene_loader *loader, size_t *size);

/* A note on faces that have no place, of any format. */
#define SCENE_BROKEN_FACES "faces with a corner that is not there, not finite or beyond 1e15 m are left out"

/* Counts one more case of what the text says; each text becomes one clause of the scene's warning, with the count and
 * the subject (a name; NULL: none) of the first case. Texts are plural: "textures are not read".
 */
__attribute__((format(printf, 3, 4))) void scene_note(scene_loader *loader, const char *subject, const char *format,
						      ...);

/* The same for `count` cases at once; none is no case. */
__attribute__((format(printf, 4, 5))) void scene_note_many(scene_loader *loader, uint32_t count, const char *subject,
							   const char *format, ...);

/* Writes what was noted into the scene's warning. */
void scene_write_warning(scene_loader *loader);

/* A copy with control characters replaced, or `fallback` formatted with `number` where name is NULL or empty. */
char *scene_copy_name(const char *name, const char *fallback, uint32_t number);

/* Takes wish (malloc'd, or NULL) and returns it, or "wish#2" and so on where it is taken: exports go by name. The name
 * stays free until scene_take_name(). NULL: out of memory.
 */
char *scene_unique_name(scene_names *names, char *wish);

/* Remembers a name that is free; it must live as long as the table. False: out of memory. */
bool scene_take_name(scene_names *names, const char *name);

/* Identity, no parent, no animation. */
scene_node scene_node_default(void);

/* Makes the graph of `count` nodes, all scene_node_default(), with none in the order. False: out of memory (reported).
 */
bool scene_make_graph(scene_loader *loader, uint32_t count);

/* Appends a material, zeroed but for its name and rho 0.5. NULL: out of memory (already reported). */
engine_scene_material *scene_add_material(scene_loader *loader, const char *name);

/* Number of the material for faces that have none; made when first asked for. False: out of memory (reported). */
bool scene_default_material(scene_loader *loader, uint32_t *number);

/* Number of a material that is `base` with its rho times a colour (linear r g b), for colours of vertices and faces: of
 * the first colour in each of 32 steps a channel, so that a gradient makes few. False: out of memory (reported).
 */
bool scene_tinted_material(scene_loader *loader, uint32_t base, const float color[3], uint32_t *number);

/* Marks the materials that faces use and brings all into their ranges; what changes a used one is noted. */
void scene_settle_materials(scene_loader *loader);

/* Takes the mesh (zeroes *mesh, also on failure), cleans it, pairs its triangles if asked to and appends the object.
 * A mesh with no face left is noted and dropped. Its pose is found by scene_settle_objects().
 */
typedef struct scene_object_def {
	const char *name;
	uint32_t node;
	double offset[3]; /* object space: the mesh's positions count from here, for those too large for floats */
	double rounding;  /* metres: how far the file's coordinates may be off; the mesh's floats are reckoned with
			     anyhow */
	engine_scheme scheme;
	uint32_t levels;
	bool pair_triangles;
} scene_object_def;
bool scene_add_object(scene_loader *loader, const scene_object_def *def, engine_mesh *mesh);

typedef enum scene_pose_result {
	SCENE_POSE_OK,
	SCENE_POSE_SINGULAR,
	SCENE_POSE_SHEARED,
	SCENE_POSE_MIRRORED,
	SCENE_POSE_FAR,
	SCENE_POSE_TINY, /* of no pose alone: no face is large enough at it */
	SCENE_POSE_RESULTS
} scene_pose_result;

/* What the library takes: metres of any coordinate, square metres of a leaf (with a margin), W/(m2 sr) of a lamp. */
#define SCENE_FARTHEST 1e9
#define SCENE_LEAST_AREA 1e-23
#define SCENE_MOST_RADIANCE 3e11f

/* Finds the pose as graph->world has it; where the matrix mirrors or shears, the mesh takes that part. Faces too far or
 * too small for the library are dropped.
 */
scene_pose_result scene_stand_object(scene_loader *loader, engine_scene_object *object);

/* What an object holds. */
void scene_release_object(engine_scene_object *object);

/* Sets the `moves` of all nodes in the order. */
void scene_mark_moving(engine_scene_graph *graph);

/* Brings graph->world to a time. NULL: at rest. */
void scene_pose_graph(engine_scene_graph *graph, const double *time_s);

/* World pose of an object as graph->world has it. For a baked one, whose mesh holds the stretch of its matrix at rest,
 * the rotation and translation alone, and the stretch (row-major 3 x 3, symmetric) in `stretch` where that is not NULL.
 */
scene_pose_result scene_object_pose(const engine_scene_graph *graph, const engine_scene_object *object,
				    engine_pose *pose, double stretch[9]);

/* a b, of column-major 4 x 4 matrices; out may be either. */
void scene_multiply(const double a[16], const double b[16], double out[16]);

/* Object point to world; out may be point. */
void scene_transform_point(const engine_pose *pose, const float point[3], float out[3]);

#endif
