/* What the scene's arrays have of one object: its own, with the numbers of the scene. */
#ifndef GI_SCENE_OBJECT_H
#define GI_SCENE_OBJECT_H

#include "object.h"

/* Where its vertices, leaves and nodes begin in the scene. */
typedef struct scene_base {
	uint32_t node, vertex, leaf;
} scene_base;

/* Without the flags that the scene sets. */
gi_node_topology scene_topology_of(const gi_hierarchy *hierarchy, uint32_t node, scene_base base);

/* Four corners a leaf; areas are summed up along the object, so that rays can end on its leaves by area. */
void scene_fill_quads(const gi_hierarchy *hierarchy, gi_vec4 *quads);

/* The grid of its tree, and the tree on it. */
void scene_fill_tree(const object_record *object, gi_object_data *data, gi_uvec4 *tree);

/* Without ranks (rank.h). */
void scene_fill_primitives(const object_record *object, gi_primitive *primitives);

#endif
