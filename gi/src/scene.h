/* All objects as the GPU sees them: laid end to end, and which of them are sources of rows. */
#ifndef GI_SCENE_H
#define GI_SCENE_H

#include "arena.h"
#include "buffers.h"
#include "gpu.h"
#include "object.h"

/* A node of several static objects, those of slots [first_slot, end_slot). */
typedef struct scene_top {
	uint32_t node, first_slot, end_slot;
	uint32_t id;
	uint32_t changed; /* number of the row update that last saw it or something below it changed */
	uint32_t before;  /* its node in the scene before the last commit, GI_NONE: it was not there */
} scene_top;

/* A set of receivers: points that rows are made for and that are sources of none. Its slot, and the numbers of its
 * points as leaves, nodes and vertices, lie behind those of all objects and the sky. */
enum { GI_RECEIVER_CORNERS = 4 };
typedef struct receiver_place {
	uint32_t set;          /* in the list of the context (receiver_sets.h) */
	uint32_t first, count; /* points among those of all sets */
	uint32_t light;        /* where its light begins, in vec4 */
} receiver_place;

typedef struct gi_scene {
	object_record *objects; /* by handle index */
	uint32_t object_count;  /* places, dead ones too; there is room for the next power of two */
	uint32_t first_free;    /* no place below it is */
	uint64_t created_count; /* objects ever created */
	uint32_t next_leaf_id, next_node_id;
	bool ever_committed;

	uint32_t *slots;       /* handle index of each slot; the sky's is GI_NONE */
	uint32_t slot_count;   /* the sky's too */
	uint32_t sky_slot;     /* GI_NONE: none */
	uint32_t statics_slot; /* static objects as one source, GI_NONE: none; their own slots are the first ones */
	uint32_t first_source; /* slot; from here on they are sources */
	scene_top *tops;
	struct static_sum *sums; /* of each top (statics.h) */
	uint32_t top_count;
	bool automatic_static; /* GI_MOBILITY_AUTOMATIC is static, as of the last commit */
	/* Number of the row update that last saw an object come to the static ones or leave them. */
	uint32_t statics_update;
	uint32_t *changed_slots; /* static objects that the update sees changed: room for all of them */
	bool shown_changed;      /* since the last update an object was hidden, shown or destroyed */
	bool regroup;            /* a static object moved or was hidden: the next update begins with a commit */
	uint32_t leaf_count, node_count, vertex_count, light_count, large_count;
	uint32_t translucent_leaves;
	receiver_place *sets;                            /* those with normals first */
	uint32_t set_count, receiver_count, light_words; /* light_words: vec4 that their light takes */
	float mean_area;                                 /* of leaves, m2; 0 without receivers */

	gi_arena arrays;             /* all of these, slots and tops: */
	gi_object_data *object_data; /* of slots, then of sets of receivers */
	gi_node_topology *topology;  /* of nodes and receivers, as uploaded */
	gi_vec4 *node_exitance;      /* node_count: rgb, w mean rho */
	gi_bvh_node *tlas;
	gi_uvec4 *tlas_packed;
	gi_vec4 tlas_grid, tlas_cells;
	uint32_t tlas_count; /* nodes that there is room for in each of two trees */
	/* Nodes of the tree over all objects that are seen, and of that over those that may lie between two others. */
	uint32_t tlas_all, tlas_inner;
	uint32_t tlas_inner_first, tlas_inner_end; /* where the second lies in tlas; it may be the first */

	SCENE_BUFFERS(BUFFER_MEMBER)
} gi_scene;

/* NULL of the sky, and of static objects as one. */
object_record *scene_object_in(const gi_scene *scene, uint32_t slot);
/* The same as of the last update. Not the sky. */
bool scene_slot_is_seen(const gi_scene *scene, uint32_t slot);
/* Exitance of the sky as of the last update, rgb, W/m2; 0 where there is none. */
void scene_sky_exitance(const gi_scene *scene, float out[3]);
float scene_ray_lift(const gi_scene *scene); /* of rays that find the nearest surface, metres */
uint32_t scene_source_count(const gi_scene *scene);
uint32_t scene_row_count(const gi_scene *scene);    /* leaves and receivers */
uint32_t scene_vertex_count(const gi_scene *scene); /* receivers' too, GI_RECEIVER_CORNERS each */
uint32_t scene_place_count(const gi_scene *scene);  /* slots and sets of receivers */
/* Does what has this place have rows: neither the sky nor static objects as one. */
bool scene_has_rows(const gi_scene *scene, uint32_t place);
void scene_place_sky(gi_object_data *data);
void scene_update_exitance(gi_context *gi, object_record *object);
/* The flags of a node that scene_update_exitance sets. */
#define SCENE_MATERIAL_BITS (GI_NODE_EMITTER | GI_NODE_SMOOTH | GI_NODE_FINER_MOST << GI_NODE_FINER_SHIFT)
void scene_update_top(gi_context *gi, const scene_top *top); /* likewise, of its objects' */
void scene_release(gi_context *gi, gi_scene *scene);         /* buffers and arrays, not the objects */
void scene_retire(gi_context *gi, gi_scene *scene); /* likewise, but their memory is kept for the next commit */
void scene_free(gi_context *gi);

#endif
