/* A shape that changes: what makes it, and what it takes to be evaluated anew.
 *
 *   positions --joints (linear blend)--> --scale--> cage --stencils--> vertices of the leaves, of what is drawn
 *
 * All of it is a function of the shape's values alone, whatever it was before: a shape that is set twice is the same
 * bits. Two shapes are kept, the one that was set last and the one that the last update took.
 */
#ifndef GI_DEFORM_H
#define GI_DEFORM_H

#include "drawn_surface.h"
#include "gi_shared.h"
#include "stencils.h"

#include "gi/gi.h"

/* What makes a shape; object space. */
typedef struct gi_shape {
	float *positions;      /* 3 * vertex_count, of the cage before joints and scale */
	float *joints;         /* 16 * joint_count */
	float *draw_positions; /* 3 * draw_count, likewise */
	float scale[3];
} gi_shape;

/* Four joints of each vertex. NULL: the vertices follow none. */
typedef struct gi_skin {
	uint32_t *joints;
	float *weights;
} gi_skin;

typedef struct gi_deform {
	uint32_t vertex_count, draw_count, joint_count;
	gi_skin skin, draw_skin;
	gi_stencils points;             /* of the leaves' vertices */
	gi_stencils drawn, tangents[2]; /* of the vertices of what is drawn; none where that is the leaves' */
	uint32_t leaf_count, node_count;
	uint32_t *faces;   /* of each leaf: number of the definition's face */
	uint32_t *by_size; /* the leaves in the order of their areas by the definition, the largest first (rank.h) */
	bool two_sided;
	gi_shape next, now;
	gi_vec4 *vertices, *trial;        /* of the leaves, by `next`, and by what is tried */
	double (*cage)[3];                /* the cage that was evaluated last */
	double (*draw)[3], (*normals)[3]; /* likewise of a mesh that is drawn, and sums of its normals */
	bool drawn_is_late;               /* what is drawn is not by `now` */
	gi_node_sums *sums;               /* of the nodes, by `now` */
	void *scratch;                    /* as large as any array that is uploaded (reshape.c) */
} gi_deform;

/* Of a definition that has passed its checks; takes the stencils of `refined->points`. NULL: out of memory. */
gi_deform *gi_deform_make(const gi_object_def *def, gi_refined *refined, const gi_hierarchy *hierarchy);

/* Takes the stencils of what is drawn. `finer`: it is not the leaves' own surface. */
void gi_deform_take_drawn(gi_deform *deform, gi_refined *fine, bool finer);

/* Evaluates the leaves' vertices by a shape into deform->trial. */
void gi_deform_try(gi_deform *deform, const gi_shape *shape);

/* What was tried is the shape from now on: copies of the arrays that are not its own already. */
void gi_deform_take(gi_deform *deform, const gi_shape *shape);

/* The shape set last is the one of now: its vertices to the hierarchy, which is not refitted yet. */
void gi_deform_settle(gi_deform *deform, gi_hierarchy *hierarchy);

/* Positions and normals of what is drawn, by the shape of now. */
void gi_deform_draw(gi_deform *deform, const gi_hierarchy *hierarchy, gi_drawn_surface *drawn);

/* Another one of the same shapes. What does not change, stencils and skins, it has in common with the first. NULL: out
 * of memory. */
gi_deform *gi_deform_copy(const gi_deform *deform, uint32_t leaf_vertices);

/* `last`: no other has what is common. NULL is fine. */
void gi_deform_free(gi_deform *deform, bool last);

#endif
