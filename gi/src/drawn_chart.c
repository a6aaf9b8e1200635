#include "drawn_chart.h"

#include "host_memory.h"

#include <string.h>

/* A chart while it is built. */
typedef struct charting {
	const gi_drawn_surface *drawn;
	const float (*uvs)[2];
	gi_drawn_chart *out;
	uint32_t *next; /* by vertex: another one of the same vertex of the surface; itself: not met yet; GI_NONE */
} charting;

/* So many of one vertex are looked through for the same coordinates; beyond that it is drawn once more, at no harm. */
enum { MOST_LOOKED_AT = 16 };

/* The vertex that has these coordinates at the place of the surface's vertex v. */
static uint32_t vertex_at(charting *c, uint32_t v, const float uv[2])
{
	gi_drawn_chart *out = c->out;
	if (c->next[v] == v) {
		memcpy(out->uvs[v], uv, sizeof out->uvs[v]);
		c->next[v] = GI_NONE;
		return v;
	}
	uint32_t at = v;
	for (int looked = 0; at != GI_NONE && looked < MOST_LOOKED_AT; looked++, at = c->next[at])
		if (out->uvs[at][0] == uv[0] && out->uvs[at][1] == uv[1])
			return at;
	const uint32_t added = out->vertex_count++;
	out->source[added - c->drawn->vertex_count] = v;
	memcpy(out->uvs[added], uv, sizeof out->uvs[added]);
	c->next[added] = c->next[v];
	return c->next[v] = added;
}

/* Each triangle behind those of lower materials and those before it of its own. */
static void sort_triangles(charting *c, const uint32_t *materials)
{
	gi_drawn_chart *out = c->out;
	const uint32_t triangles = c->drawn->index_count / 3;
	for (uint32_t t = 0; t < triangles; t++)
		out->first[(materials ? materials[t] : 0) + 1] += 3;
	for (uint32_t m = 0; m < out->material_count; m++)
		out->first[m + 1] += out->first[m];
	for (uint32_t t = 0; t < triangles; t++) {
		uint32_t *at = &out->first[materials ? materials[t] : 0];
		for (uint32_t k = 3 * t; k < 3 * t + 3; k++)
			out->indices[(*at)++] = vertex_at(c, c->drawn->indices[k], c->uvs[k]);
	}
	memmove(out->first + 1, out->first, sizeof *out->first * out->material_count);
	out->first[0] = 0;
}

bool gi_drawn_chart_build(const gi_drawn_surface *drawn, const float (*uvs)[2], const uint32_t *materials,
			  uint32_t material_count, gi_drawn_chart *out)
{
	/* A vertex can be drawn again for each corner but its first. */
	const size_t most = (size_t)drawn->vertex_count + drawn->index_count;
	*out = (gi_drawn_chart){.vertex_count = drawn->vertex_count, .material_count = material_count};
	out->source = gi_malloc(sizeof *out->source * ((size_t)drawn->index_count + 1));
	out->uvs = gi_calloc(most + 1, sizeof *out->uvs);
	out->indices = gi_malloc(sizeof *out->indices * ((size_t)drawn->index_count + 1));
	out->first = gi_calloc((size_t)material_count + 1, sizeof *out->first);
	charting c = {drawn, uvs, out, gi_malloc(sizeof *c.next * (most + 1))};
	const bool enough = out->source && out->uvs && out->indices && out->first && c.next;
	for (uint32_t v = 0; enough && v < drawn->vertex_count; v++)
		c.next[v] = v;
	if (enough)
		sort_triangles(&c, materials);
	gi_free(c.next);
	if (!enough) {
		gi_drawn_chart_free(out);
		return false;
	}
	/* Where there is no memory for the smaller ones the larger ones stay. */
	void *source = gi_realloc(out->source, sizeof *out->source * (out->vertex_count - drawn->vertex_count + 1));
	void *kept = gi_realloc(out->uvs, sizeof *out->uvs * ((size_t)out->vertex_count + 1));
	out->source = source ? source : out->source;
	out->uvs = kept ? kept : out->uvs;
	return true;
}

void gi_drawn_chart_free(gi_drawn_chart *chart)
{
	gi_free(chart->source);
	gi_free(chart->uvs);
	gi_free(chart->indices);
	gi_free(chart->first);
	*chart = (gi_drawn_chart){.vertex_count = 0};
}
