/* What both kinds of drawn surface are built with. */
#ifndef GI_DRAWN_BUILD_H
#define GI_DRAWN_BUILD_H

#include "drawn_surface.h"
#include "drawn_hanging.h"
#include "drawn_seams.h"
#include "vec3d.h"

/* A drawn surface while it is built. */
typedef struct drawn_builder {
	const gi_hierarchy *h;
	const uint8_t *parted; /* as gi_refined has it; NULL: none */
	gi_drawn_surface *out;
	uint32_t *group; /* per corner: another corner of its group, or itself */
	gi_hanging_list hanging;
	bool has_seams; /* flat leaves are drawn as such */
	gi_seams seams;
	uint32_t *first_drawn;  /* per vertex of the surface: a drawn vertex there, GI_NONE for none yet */
	uint32_t *next_drawn;   /* per drawn vertex: the next one at the same place */
	gi_draw_bond bond;      /* of the vertex that is added next, where there are any */
	const gi_leaf_uvs *uvs; /* of the leaves; NULL: what is drawn has none */
} drawn_builder;

typedef struct quad {
	uint32_t v[4];
	uint32_t count; /* 3: v[3] repeats v[2] */
} quad;

static inline quad leaf_quad(const gi_hierarchy *h, uint32_t leaf)
{
	const gi_uvec4 c = h->topology[h->leaf_node[leaf]].corners;
	return (quad){{c.x, c.y, c.z, c.w}, c.z == c.w ? 3 : 4};
}

static inline gi_vec3d leaf_normal(const gi_hierarchy *h, uint32_t leaf)
{
	return gi_vec3d_from(h->geometry[h->leaf_node[leaf]].axis);
}

static inline gi_vec3d vertex_position(const gi_hierarchy *h, uint32_t vertex)
{
	return gi_vec3d_from(h->vertices[vertex]);
}

static inline gi_vec3d unit_or(gi_vec3d v, gi_vec3d otherwise)
{
	const double length = gi_vec3d_length(v);
	return length > 0.0 ? gi_vec3d_scale(v, 1.0 / length) : otherwise;
}

/* Allocates room for count + 1, so that no size is zero. Sets *enough to false where there is no memory. */
void *gi_drawn_allocate(size_t count, size_t size, bool *enough);
/* Makes the light vertices; corners in one place share one where the leaves' normals have at least this cosine. False:
 * out of memory. */
bool gi_drawn_make_lights(drawn_builder *s, double least_cosine);
void gi_drawn_free_builder(drawn_builder *s);
void gi_drawn_add_triangle(gi_drawn_surface *out, uint32_t a, uint32_t b, uint32_t c);
uint32_t gi_drawn_add_vertex(drawn_builder *s, const gi_draw_vertex *v);
/* The light at a point of a leaf, four light vertices with their weights. In order of light vertex and without zeros,
 * so that the two leaves of a smooth edge give their common points the same. */
void gi_drawn_light_at(const gi_drawn_surface *drawn, uint32_t leaf, const float weight[4], uint32_t light[4],
		       float light_weight[4]);
void gi_drawn_set_light(const drawn_builder *s, uint32_t leaf, const float weight[4], gi_draw_vertex *v);
/* The drawn vertex that is `v`, a new one where there is none; `place` is the number of its vertex of the surface. */
uint32_t gi_drawn_share_vertex(drawn_builder *s, uint32_t place, const gi_draw_vertex *v);

#endif
