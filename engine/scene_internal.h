/* What the readers of scene files share: the loader's state, nodes and animation, and the last checks. */
#ifndef ENGINE_SCENE_INTERNAL_H
#define ENGINE_SCENE_INTERNAL_H

#include "scene_file.h"

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
} scene_node;

typedef struct engine_scene_graph {
	scene_node *nodes;
	uint32_t node_count;
	scene_channel *channels;
	uint32_t channel_count;
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

typedef struct scene_loader {
	const char *path;
	engine_scene *scene;
	char *message;
	size_t message_size;
	uint32_t degenerate_faces;
	scene_names names;
} scene_loader;

/* Writes "path: text" as one line; always false, so that callers can return it. */
__attribute__((format(printf, 2, 3))) bool scene_fail(scene_loader *loader, const char *format, ...);

/* Adds to the scene's warning, "; " between. */
__attribute__((format(printf, 2, 3))) void scene_warn(scene_loader *loader, const char *format, ...);

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

/* Appends a material, zeroed but for its name and rho 0.5. NULL: out of memory (already reported). */
engine_scene_material *scene_add_material(scene_loader *loader, const char *name);

/* Checks rho and radiance of a material. */
bool scene_check_material(scene_loader *loader, const engine_scene_material *material);

/* Number of the material for faces that have none; made when first asked for. False: out of memory (reported). */
bool scene_default_material(scene_loader *loader, uint32_t *number);

/* Takes the mesh (zeroes *mesh, also on failure), cleans it, pairs its triangles if asked to, checks the poses of its
 * node and appends the object. A mesh with no face left is a warning as long as another object has some.
 */
typedef struct scene_object_def {
	const char *name;
	uint32_t node;
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
	SCENE_POSE_FAR
} scene_pose_result;

/* World pose of a node. time_s NULL: at rest. mirrored: of the node's matrix times diag(-1, 1, 1). */
scene_pose_result scene_node_pose(const engine_scene_graph *graph, uint32_t node, const double *time_s, bool mirrored,
				  engine_pose *pose);

/* World matrix of a node, column-major. time_s NULL: at rest. */
void scene_node_matrix(const engine_scene_graph *graph, uint32_t node, const double *time_s, double matrix[16]);

/* Object point to world; out may be point. */
void scene_transform_point(const engine_pose *pose, const float point[3], float out[3]);

bool scene_read_gltf(scene_loader *loader);
bool scene_read_assimp(scene_loader *loader);

#endif
