/* What does not move, under common nodes: a binary tree over the static objects whose inner nodes, tops, stand for
 * several objects at once. Their nodes and leaves lie in the order of the tree, tops in between, so that all of it is
 * one hierarchy:
 *
 *   nodes   | top | top | object | object | top | object | ... | movers ... | sky
 *   slots   | objects in the order of the tree | the whole, as a source | movers | sky
 *
 * A top is in the world's frame. The tree is that of cells.h, so that a top is a function of its own objects: where one
 * comes or goes, only the tops that it is below change. Rows keep what they have of all others.
 */
#ifndef GI_STATICS_H
#define GI_STATICS_H

#include "scene.h"
#include "vec3d.h"

/* A node of the tree, depth-first. */
typedef struct static_node {
	uint32_t skip;                 /* the node after its subtree */
	uint32_t first_slot, end_slot; /* of its objects */
	uint32_t node;                 /* number in the scene: of the top, or of the object's root */
	uint32_t id;                   /* of a top */
	uint32_t number;               /* of a top, among tops */
	bool top;
} static_node;

typedef struct static_tree {
	uint32_t object_count, count; /* 2 object_count - 1 nodes; none for fewer than two objects */
	static_node *nodes;
	uint32_t *objects;   /* handle index of each slot */
	uint32_t node_count; /* of the scene's nodes, tops among them */
} static_tree;

/* What a top is the sum of, all of it in the world. */
typedef struct static_sum {
	bool known; /* as of the scene before, where nothing below the top was placed anew since */
	gi_vec3d centre, moment, axis;
	double radius, area, shape; /* shape times area */
	double cone;                /* half angle of the normals about the axis; pi: any direction */
	double spread[6];           /* xx yy zz xy yz zx */
	uint32_t first_leaf, leaf_count, back;
} static_sum;

/* Is an object of that mobility static, by scene->automatic_static? */
bool statics_hold(const gi_scene *scene, gi_mobility mobility);

/* Of the objects that are static, alive and not hidden; sets scene->automatic_static. Lies in `memory`, from its
 * beginning. False: out of memory. */
bool statics_build(gi_scene *scene, const gi_scene *was, gi_arena *memory, static_tree *out);

/* Which tops are those of the scene before (scene_top.before), whose objects were `were`: the same objects are below
 * them, and their sums are taken over. The others changed as of update `update`. */
void statics_follow(gi_scene *now, const gi_scene *was, const object_record *were, uint32_t update);

/* Are the static ones those of the scene before, in the same order and below the same tops? */
bool statics_are_same(const gi_scene *was, const gi_scene *now);

/* Geometry and topology of the tops, of the objects' roots in `rest` and `spread`, which are as numbered. Of corners, x
 * is the top's id and y the update that last changed it, as scene->tops has it. */
void statics_place(const static_tree *tree, gi_scene *scene, gi_node_geometry *rest, gi_node_spread *spread,
		   gi_node_topology *topology);

#endif
