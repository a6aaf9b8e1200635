/* What casts shadows: the surface as the rays see it, the coarsest flat polygons of each object, and which of them can
 * hide anything where the objects are now. */
#ifndef GI_CASTERS_H
#define GI_CASTERS_H

#include "gpu_draw.h"
#include "shade_shared.h"
#include "vec3d.h"

struct gi_context;

/* A flat polygon of an object that has few. */
typedef struct caster_wall {
	float corner[4][3]; /* rest frame */
	gpu_range range;
	bool hides; /* where it is now it may hide something */
} caster_wall;

typedef struct gi_caster {
	gpu_range range;
	bool solid;          /* a closed surface, seen from outside */
	uint32_t wall_count; /* 0: too many to look at */
	caster_wall *walls;
	uint32_t sphere_count;
	gi_vec4 *spheres;       /* hold all of the surface; rest frame, w radius */
	uint32_t *sphere_nodes; /* theirs, of a shape that changes */
	bool as_drawn;          /* by what is drawn, not by the leaves */
	uint32_t first_vertex, vertex_count;
	double off;                      /* what is drawn lies at most this far outside of them */
	double outside;                  /* and what casts of them */
	double outside_box;              /* and of the object's box at rest */
	uint32_t first_range, end_range; /* that can hide something */
	gi_vec3d box[8];                 /* world */
} gi_caster;

typedef struct gi_casters {
	gi_caster *list; /* by slot */
	uint32_t count;
	gpu_mesh mesh;
	gpu_range *ranges;
	uint32_t range_capacity;
	struct caster_vertex *staging; /* of a shape that changed */
	uint32_t staging_room;
} gi_casters;

/* Of the committed scene. */
gi_result casters_create(struct gi_context *gi, gi_casters *casters);
void casters_free(struct gi_context *gi, gi_casters *casters);

/* Brings a caster to the shape that its object has now. False when memory ran out. */
bool casters_refit(struct gi_context *gi, gi_casters *casters, uint32_t slot);

/* Boxes, ranges and which walls hide, for the objects' poses. False when memory ran out. */
bool casters_place(const struct gi_context *gi, gi_casters *casters);

#endif
