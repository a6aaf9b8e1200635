/* The parts of a glTF scene, each read by a file of its own: materials, nodes and their objects, meshes, animations. */
#ifndef ENGINE_GLTF_SCENE_H
#define ENGINE_GLTF_SCENE_H

#include "gltf_document.h"

/* Appends the lights of the nodes in the scene; animations are read. False: out of memory (reported). */
bool gltf_read_lights(gltf_document *document, const bool *in_scene);

/* The sky that a scene of the file has; what is broken of it is noted. False: out of memory (reported). */
bool gltf_read_sky(gltf_document *document, const cJSON *scene);

/* Number of the scene's material for a primitive: read when first used, so that nothing is told of others. False: out
 * of memory (reported).
 */
bool gltf_material_number(gltf_document *document, const cJSON *primitive, uint32_t *number);

/* An image as a texture of the scene (its number and one), and the mean of its pixels, r g b in linear light and alpha.
 * False with the reason in *fault. */
bool gltf_image_texture(gltf_document *document, int64_t image, uint32_t *texture, float mean[4], const char **fault);

/* Binds the channels to the graph's nodes; a channel that cannot be read is noted and left out. False: out of memory
 * (reported).
 */
bool gltf_read_animations(gltf_document *document);

/* What a mesh will take in memory, before any of it is made. Corners of all its faces; 0 for one that has none. */
uint64_t gltf_count_corners(const gltf_document *document, const cJSON *mesh);

/* All primitives of a mesh as one; a primitive or face that cannot be read is noted (subject: name) and left out.
 * skin NULL: object space, morph targets at the weights of node or mesh. Else world space as the skin's joints are at
 * rest; the graph is posed at rest. shape: NULL, or zeroed: gets the vertices with what moves them; the caller frees it
 * in either case. False: out of memory (reported).
 */
typedef struct gltf_skin {
	double (*matrices)[16]; /* by joint, world from mesh at rest, column-major */
	double (*inverse)[16];  /* by joint, its bind matrix */
	uint32_t *nodes;        /* by joint */
	uint32_t joint_count;
} gltf_skin;
bool gltf_read_mesh(gltf_document *document, const cJSON *mesh, const cJSON *node, const gltf_skin *skin,
		    const char *name, engine_mesh *out, import_shape *shape);

/* Morph targets of a node's mesh, as its first primitive has them. */
uint32_t gltf_count_targets(const gltf_document *document, int64_t node);

/* The matrices of a skin; the caller frees its arrays. False with the reason in *fault. */
bool gltf_read_skin(gltf_document *document, int64_t skin, gltf_skin *out, const char **fault);

/* The objects to come, counted before any is made. */
typedef struct gltf_objects {
	uint64_t *mesh_corners; /* by mesh: of all its faces, and what going through it costs */
	uint64_t *skin_corners; /* by skin: the same of its joints */
	uint32_t *uses;         /* by mesh: nodes that have it and were not read so far */
	engine_mesh *meshes;    /* by mesh: as read, or zeroed */
	uint64_t corners;       /* of all objects together */
	uint32_t node_count;    /* of the graph: the file's nodes, one for each instance, one for world space */
	uint32_t next_node;     /* the next for an instance */
} gltf_objects;

/* False (reported): out of memory, or the file makes too much of its bytes. */
bool gltf_count_objects(gltf_document *document, gltf_objects *objects);

/* Appends the objects of the nodes in the scene. False: out of memory (reported). */
bool gltf_read_objects(gltf_document *document, gltf_objects *objects, const bool *in_scene);
void gltf_free_objects(const gltf_document *document, gltf_objects *objects);

#endif
