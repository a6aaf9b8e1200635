/* Receivers: points that light falls on and that give none. A set of them is in the scene what an object is, but for
 * its place: slots, leaves, nodes and vertices of sets are numbered behind all others (scene.h), so that rows are made
 * for them by the passes that make all rows, while trees, the solve and whatever else goes over objects end before
 * them.
 *
 * A receiver with a normal is a small square across it. One without is a point that looks all round, whose row shares
 * out the whole sphere: its form factors are solid angles over 4 pi (round.glsl).
 */
#ifndef GI_RECEIVER_SETS_H
#define GI_RECEIVER_SETS_H

#include "scene.h"

/* Where a receiver is and the way it faces, in the frame of its set. */
typedef struct receiver_point {
	float position[3];
	float normal[3]; /* unit; 0: none */
} receiver_point;

/* Of probes: where they are, in the world. */
typedef struct receiver_grid {
	float lower[3], spacing; /* spacing 0: no probes */
	uint32_t count[3];
} receiver_grid;

typedef struct receiver_set {
	uint32_t generation; /* of the handle that owns this place; odd while alive */
	bool committed;
	bool moved;    /* since the last update */
	bool reshaped; /* its points are others since they were uploaded */
	gi_object object;
	gi_pose pose; /* of the object, where there is one */
	receiver_point *points;
	uint32_t count;
	uint32_t coefficients; /* vec4 a point: 1 irradiance, 4 or 9 spherical harmonics */
	float size, offset;
	receiver_grid grid;
	uint32_t id, ids;      /* of its points, as object_record.leaf_id */
	uint32_t place;        /* in gi_scene.sets, while committed */
	uint32_t moved_update; /* number of the row update that last saw it move */
} receiver_set;

typedef struct gi_receiver_sets {
	receiver_set *list;
	uint32_t count; /* dead ones too */
	uint32_t next_id;
} gi_receiver_sets;

receiver_set *receiver_sets_find(const gi_context *gi, gi_receivers handle);
/* From a definition that was checked but for its points. grid: NULL but for probes. */
gi_result receiver_sets_create(gi_context *gi, const gi_receivers_def *def, const receiver_grid *grid,
			       gi_receivers *out);
/* Other points, or normals; NULL: those that are there. Checks them. */
gi_result receiver_set_reshape(gi_context *gi, receiver_set *set, const float *positions, const float *normals);
void receiver_sets_remove(receiver_set *set);
bool receiver_set_is_alive(const receiver_set *set);
/* Do all points look round instead of along a normal? */
bool receiver_set_is_round(const receiver_set *set);
/* Of a point's square, metres. */
float receiver_point_size(const receiver_set *set, const receiver_point *point);

/* ---- in the scene ---- */

void receiver_sets_count(const gi_context *gi, gi_scene *next); /* those that are alive */
/* What a commit gathers of them, in arrays of the whole scene. */
typedef struct receiver_arrays {
	gi_node_geometry *rest;
	gi_vec4 *vertices;
	gi_uvec4 *leaves;
	gi_vec4 *leaf_quads;
	gi_material_data *material; /* one for all */
	uint32_t material_number;
} receiver_arrays;
void receiver_sets_gather(const gi_context *gi, gi_scene *next, const receiver_arrays *to);
void receiver_sets_committed(gi_context *gi, bool kept); /* the scene is the new one */

/* ---- what moves ---- */

bool receiver_sets_changed(gi_context *gi);     /* with the objects that they are fixed to, too */
gi_result receiver_sets_upload(gi_context *gi); /* what changed */
void receiver_sets_number(gi_context *gi, uint32_t update);
void receiver_sets_done(gi_context *gi);
void receiver_sets_free(gi_context *gi);

#endif
