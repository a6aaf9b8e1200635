/* Reading rows and light back to the CPU: for tests, exports and figures. Waits for the GPU. */
#include "bits.h"
#include "caustics.h"
#include "context.h"
#include "handles.h"
#include "host_memory.h"

#include <math.h>
#include <string.h>

static void *allocate(const gi_context *gi, uint64_t bytes)
{
	const gi_allocator *before = gi_memory_from(&gi->def.allocator);
	void *memory = gi_calloc(1, bytes + 1);
	gi_memory_from(before);
	return memory;
}

static void *read_buffer(const gi_context *gi, const gpu_buffer *buffer, uint64_t bytes)
{
	void *data = allocate(gi, bytes);
	if (data)
		gpu_buffer_read(&gi->gpu, buffer, 0, bytes, data);
	return data;
}

/* place: where the result goes. */
static gi_result begin_read(gi_context *gi, const char *function, const void *place)
{
	if (!gi)
		return gi_fail_null(gi, "");
	if (!place)
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_ARGUMENT, "%s: the place for the result must not be NULL",
			       function);
	return gpu_check_current(&gi->gpu, function) ? GI_ERROR_WRONG_CONTEXT : gi_finish(gi);
}

static gi_result no_memory(const gi_context *gi)
{
	return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
}

/* ---- links ---- */

/* One of a row (gi_shared.h). */
typedef struct row_link {
	uint32_t node;
	float weights[3];
	bool specular, photons;
} row_link;

/* That in place `at` of the pool; returns how many places it takes. */
static uint32_t link_at(const uint32_t *pool, uint32_t at, row_link *out)
{
	const uint32_t *words = pool + 2 * (size_t)at;
	const bool specular = words[0] & GI_LINK_SPECULAR;
	*out = (row_link){.node = specular ? words[0] & GI_LINK_NODE : words[0],
			  .specular = specular,
			  .photons = specular && words[0] & GI_LINK_PHOTONS};
	for (int c = 0; c < 3; c++)
		out->weights[c] = gi_float_from_bits(words[specular ? 1 + c : 1]);
	return specular ? 2 : 1;
}

/* ---- leaves ---- */

typedef struct leaf_arrays {
	gi_vec4 *vertices, *radiosity;
	gi_uvec4 *headers;
} leaf_arrays;

static void fill_leaf(const gi_context *gi, const leaf_arrays *a, const object_record *o, uint32_t index,
		      uint32_t local, gi_leaf *out)
{
	const gi_hierarchy *h = &o->hierarchy;
	const uint32_t leaf = o->leaf_base + local, node = h->leaf_node[local];
	const uint32_t *corners = &h->topology[node].corners.x;
	const gi_material *m = &o->materials[h->leaf_material[local]];
	*out = (gi_leaf){.area = h->geometry[node].moment.w,
			 .row_sum = fabsf(gi_float_from_bits(a->headers[leaf].w)),
			 .object = handles_of(gi, index)};
	for (int c = 0; c < 4; c++)
		memcpy(out->corners[c], &a->vertices[o->vertex_base + corners[c]], sizeof out->corners[c]);
	memcpy(out->rho, m->rho, sizeof out->rho);
	memcpy(out->exitance, m->exitance, sizeof out->exitance);
	memcpy(out->radiosity, &a->radiosity[leaf], sizeof out->radiosity);
}

/* Irradiance that is no link's: through mirrors and glass, from lights without a surface. The first of `stride` vec4 a
 * leaf; light NULL: none. */
static gi_result add_vectors(gi_context *gi, const gpu_buffer *light, uint32_t stride, gi_leaf *leaves, uint32_t count)
{
	if (!light)
		return GI_OK;
	gi_vec4 *found = read_buffer(gi, light, sizeof *found * stride * gi->scene.leaf_count);
	if (!found)
		return no_memory(gi);
	for (uint32_t leaf = 0; leaf < count; leaf++)
		for (int c = 0; c < 3; c++)
			leaves[leaf].irradiance[c] += (&found[stride * leaf].x)[c];
	gi_free(found);
	return GI_OK;
}

/* H = sum of weight * B over the leaf's links; also right where rho is zero. */
static gi_result fill_irradiance(gi_context *gi, gi_leaf *leaves, uint32_t count, const gi_uvec4 *headers)
{
	const gi_rows *r = &gi->rows;
	const uint32_t nodes = gi->scene.node_count;
	gi_vec4 *light = read_buffer(gi, &gi->solver.radiosity, sizeof *light * GI_NODE_PARTS * nodes);
	uint32_t *links = read_buffer(gi, &r->links, r->links.size);
	for (uint32_t leaf = 0; light && links && leaf < count; leaf++) {
		const uint32_t first = headers[leaf].x, n = headers[leaf].y & GI_BLOCK_COUNT_MASK;
		double h[3] = {0};
		row_link link;
		for (uint32_t k = 0; k < n;) {
			k += link_at(links, first + k, &link);
			const gi_vec4 *from = &light[(link.photons ? GI_NODE_R : GI_NODE_B) * nodes + link.node];
			for (int c = 0; c < 3; c++)
				h[c] += (double)link.weights[c] * (&from->x)[c];
		}
		for (int c = 0; c < 3; c++)
			leaves[leaf].irradiance[c] = (float)h[c];
	}
	const bool ok = light && links;
	gi_free(light);
	gi_free(links);
	if (!ok)
		return no_memory(gi);
	gi_result result = add_vectors(gi, caustics_light(gi), 1, leaves, count);
	if (!result)
		result = add_vectors(gi, punctual_sums(gi), GI_PUNCTUAL_PARTS, leaves, count);
	return result;
}

gi_result gi_read_leaves(gi_context *gi, gi_leaf *leaves, uint32_t capacity, uint32_t *count)
{
	if (count)
		*count = 0;
	gi_result result = begin_read(gi, "gi_read_leaves", count);
	if (result)
		return result;
	const gi_scene *s = &gi->scene;
	*count = s->leaf_count;
	if (!leaves || !s->leaf_count)
		return GI_OK;
	leaf_arrays a = {
	    .vertices = read_buffer(gi, &s->vertices_world_gpu, sizeof(gi_vec4) * s->vertex_count),
	    .radiosity = read_buffer(gi, &gi->solver.leaf_radiosity, sizeof(gi_vec4) * s->leaf_count),
	    .headers = read_buffer(gi, &gi->rows.headers, sizeof(gi_uvec4) * s->leaf_count),
	};
	const uint32_t wanted = capacity < s->leaf_count ? capacity : s->leaf_count;
	if (!a.vertices || !a.radiosity || !a.headers) {
		result = no_memory(gi);
	} else {
		for (uint32_t slot = 0; slot < s->slot_count; slot++) {
			if (s->slots[slot] == GI_NONE)
				continue;
			const object_record *o = &s->objects[s->slots[slot]];
			for (uint32_t k = 0; k < o->hierarchy.leaf_count && o->leaf_base + k < wanted; k++)
				fill_leaf(gi, &a, o, s->slots[slot], k, &leaves[o->leaf_base + k]);
		}
		result = fill_irradiance(gi, leaves, wanted, a.headers);
	}
	gi_free(a.vertices);
	gi_free(a.radiosity);
	gi_free(a.headers);
	return result;
}

/* ---- rows ---- */

static void leaf_range(const gi_scene *s, uint32_t node, uint32_t *first, uint32_t *count)
{
	const gi_uvec4 range = s->topology[node].range;
	const bool sky = range.w & GI_NODE_SKY;
	*first = sky ? 0 : range.y;
	*count = sky ? 0 : range.z;
}

static gi_entry entry_of(const gi_scene *s, gi_uvec4 e)
{
	gi_entry out = {.leaf = e.w & GI_ENTRY_LEAF_MASK,
			.node = e.x,
			.form_factor = gi_float_from_bits(e.y),
			.samples = (e.w >> GI_ENTRY_SAMPLE_SHIFT) & GI_ENTRY_SAMPLE_MASK,
			.back = (e.w & GI_ENTRY_BACK) != 0};
	for (uint32_t mask = e.z & 0xFFFFu; mask; mask &= mask - 1)
		out.visible++;
	leaf_range(s, e.x, &out.first_leaf, &out.leaf_count);
	return out;
}

gi_result gi_read_entries(gi_context *gi, gi_entry *entries, uint64_t capacity, uint64_t *count)
{
	if (count)
		*count = 0;
	gi_result result = begin_read(gi, "gi_read_entries", count);
	if (result)
		return result;
	const gi_scene *s = &gi->scene;
	const uint64_t segments = (uint64_t)s->leaf_count * scene_source_count(s);
	if (!segments)
		return GI_OK;
	gi_uvec4 *segment = read_buffer(gi, &gi->rows.segments, sizeof *segment * segments);
	gi_uvec4 *pool = read_buffer(gi, &gi->rows.entries, gi->rows.entries.size);
	if (!segment || !pool)
		result = no_memory(gi);
	for (uint64_t k = 0; !result && k < segments; k++) {
		const uint32_t n = segment[k].y & GI_BLOCK_COUNT_MASK;
		for (uint32_t e = 0; e < n; e++) {
			const gi_uvec4 entry = pool[segment[k].x + e];
			if (entry.w & GI_ENTRY_GONE)
				continue;
			if (entries && *count < capacity)
				entries[*count] = entry_of(s, entry);
			(*count)++;
		}
	}
	gi_free(segment);
	gi_free(pool);
	return result;
}

static gi_link public_link(const gi_scene *s, uint32_t leaf, const row_link *link)
{
	const float *w = link->weights;
	gi_link out = {.leaf = leaf,
		       .node = link->node,
		       .weight = fmaxf(w[0], fmaxf(w[1], w[2])),
		       .weights = {w[0], w[1], w[2]},
		       .specular = link->specular};
	leaf_range(s, link->node, &out.first_leaf, &out.leaf_count);
	return out;
}

gi_result gi_read_links(gi_context *gi, gi_link *links, uint64_t capacity, uint64_t *count)
{
	if (count)
		*count = 0;
	gi_result result = begin_read(gi, "gi_read_links", count);
	if (result)
		return result;
	const gi_scene *s = &gi->scene;
	if (!s->leaf_count)
		return GI_OK;
	gi_uvec4 *headers = read_buffer(gi, &gi->rows.headers, sizeof *headers * s->leaf_count);
	uint32_t *pool = read_buffer(gi, &gi->rows.links, gi->rows.links.size);
	if (!headers || !pool)
		result = no_memory(gi);
	for (uint32_t leaf = 0; !result && leaf < s->leaf_count; leaf++) {
		const uint32_t n = headers[leaf].y & GI_BLOCK_COUNT_MASK;
		for (uint32_t k = 0; k < n; (*count)++) {
			row_link link;
			k += link_at(pool, headers[leaf].x + k, &link);
			if (links && *count < capacity)
				links[*count] = public_link(s, leaf, &link);
		}
	}
	gi_free(headers);
	gi_free(pool);
	return result;
}

/* ---- form factors between objects ---- */

/* Objects' parts of the links of `from`, area weighted: sums[slot]; the rest is sky. */
static gi_result sum_links(gi_context *gi, const object_record *from, double *sums, double *area)
{
	const gi_scene *s = &gi->scene;
	gi_uvec4 *headers = read_buffer(gi, &gi->rows.headers, sizeof *headers * s->leaf_count);
	uint32_t *pool = read_buffer(gi, &gi->rows.links, gi->rows.links.size);
	gi_uvec4 *leaves = read_buffer(gi, &s->leaves_gpu, sizeof *leaves * s->leaf_count);
	const bool ok = headers && pool && leaves;
	for (uint32_t k = 0; ok && k < from->hierarchy.leaf_count; k++) {
		const gi_uvec4 header = headers[from->leaf_base + k];
		const double a = from->hierarchy.geometry[from->hierarchy.leaf_node[k]].moment.w;
		*area += a;
		row_link link;
		for (uint32_t l = 0; l < (header.y & GI_BLOCK_COUNT_MASK);) {
			l += link_at(pool, header.x + l, &link);
			const gi_uvec4 range = s->topology[link.node].range;
			const uint32_t slot = range.w & GI_NODE_SKY ? s->sky_slot : leaves[range.y].y;
			sums[slot] += link.specular ? 0 : a * link.weights[0];
		}
	}
	gi_free(headers);
	gi_free(pool);
	gi_free(leaves);
	return ok ? GI_OK : no_memory(gi);
}

static bool is_known(const gi_context *gi, gi_object object)
{
	const object_record *o = handles_find(gi, object);
	return o && o->committed;
}

/* The part of `sums` that is one object's, or everybody's but the sky's. */
static double part_of(const gi_context *gi, const double *sums, gi_object to)
{
	if (to.index1 != 0)
		return sums[handles_find(gi, to)->slot];
	double sum = 0;
	for (uint32_t slot = 0; slot < gi->scene.slot_count; slot++)
		sum += slot != gi->scene.sky_slot ? sums[slot] : 0;
	return sum;
}

gi_result gi_form_factors(gi_context *gi, gi_object from, const gi_object *to, uint32_t count, double *out)
{
	if (gi && (!to || !out))
		return gi_fail_null(gi, "gi_form_factors: to and out");
	gi_result result = begin_read(gi, "gi_form_factors", out);
	if (result)
		return result;
	bool known = is_known(gi, from);
	for (uint32_t k = 0; k < count; k++)
		known = known && (to[k].index1 == 0 || is_known(gi, to[k]));
	if (!known)
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_HANDLE,
			       "gi_form_factors: an object is stale or not committed");
	double *sums = allocate(gi, sizeof *sums * gi->scene.slot_count), area = 0;
	if (!sums)
		return no_memory(gi);
	result = sum_links(gi, handles_find(gi, from), sums, &area);
	for (uint32_t k = 0; !result && k < count; k++)
		out[k] = part_of(gi, sums, to[k]) / area;
	gi_free(sums);
	return result;
}

gi_result gi_form_factor(gi_context *gi, gi_object from, gi_object to, double *out)
{
	return gi_form_factors(gi, from, &to, 1, out);
}
