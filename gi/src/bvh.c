/* Bounding volume hierarchies over boxes: of an object's primitives, and of the scene's objects.
 *
 * Binned surface-area heuristic after Wald, "On fast construction of SAH-based bounding volume hierarchies" (2007).
 * Nodes come out depth-first with skip links, in one pass: a node's skip is known when its subtree is written.
 */
#include "bvh.h"

#include "bits.h"
#include "host_memory.h"
#include "vec3d.h"

#include <float.h>
#include <math.h>

#define BINS 16
/* Below this depth splits are at the median, so that no input makes the recursion deep: 40 + log2(count) at most. */
#define MAX_SAH_DEPTH 40
/* Boxes grow by this many ulps of the largest coordinate of them all. The slab test rounds thrice a plane, relative to
 * the distance from the ray's origin: 8 ulps cover origins as far away as twice the size of what the boxes hold. */
#define PAD_ULPS 8.0f

typedef struct builder {
	const gi_box *boxes;
	uint32_t *order;
	gi_bvh_node *nodes;
	uint32_t node_count;
	uint32_t leaf_count;
	float pad;
} builder;

typedef struct bin {
	gi_box bounds; /* where there is something in it */
	uint32_t count;
} bin;

/* Where to cut: boxes whose centre falls into the bins below `bin` of the axis go left. */
typedef struct split {
	int axis; /* -1: no cut parts the boxes */
	int bin;
	float cost;
} split;

static gi_box empty_box(void)
{
	return (gi_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

/* No box has a NaN; without that, compilers call fminf. */
static void grow(gi_box *restrict to, const gi_box *restrict by)
{
	for (int axis = 0; axis < 4; axis++) {
		to->lower[axis] = by->lower[axis] < to->lower[axis] ? by->lower[axis] : to->lower[axis];
		to->upper[axis] = by->upper[axis] > to->upper[axis] ? by->upper[axis] : to->upper[axis];
	}
}

static float half_area(const gi_box *b)
{
	const float x = b->upper[0] - b->lower[0], y = b->upper[1] - b->lower[1], z = b->upper[2] - b->lower[2];
	return x * y + y * z + z * x;
}

/* Halves before adding: no overflow near the end of the floats. */
static float centre(const gi_box *b, int axis)
{
	return 0.5f * b->lower[axis] + 0.5f * b->upper[axis];
}

static gi_box bounds_of(const builder *b, uint32_t begin, uint32_t end)
{
	gi_box bounds = empty_box();
	for (uint32_t i = begin; i < end; i++)
		grow(&bounds, &b->boxes[b->order[i]]);
	return bounds;
}

static gi_box bounds_of_centres(const builder *b, uint32_t begin, uint32_t end)
{
	gi_box bounds = empty_box();
	for (uint32_t i = begin; i < end; i++) {
		const gi_box *item = &b->boxes[b->order[i]];
		gi_box point = {0};
		for (int axis = 0; axis < 3; axis++)
			point.lower[axis] = point.upper[axis] = centre(item, axis);
		grow(&bounds, &point);
	}
	return bounds;
}

static int bin_of(const gi_box *item, const gi_box *centres, int axis)
{
	const float extent = centres->upper[axis] - centres->lower[axis];
	const int index = (int)(BINS * ((centre(item, axis) - centres->lower[axis]) / extent));
	return index < BINS ? index : BINS - 1;
}

/* The cheapest cut along one axis: a sweep from the right keeps the costs of the right sides, one from the left adds
 * its own. */
static split best_on_axis(const bin bins[BINS], int axis)
{
	float right_cost[BINS], cost = INFINITY;
	gi_box side = empty_box();
	uint32_t count = 0;
	for (int i = BINS - 1; i > 0; i--) {
		if (bins[i].count > 0) {
			grow(&side, &bins[i].bounds);
			count += bins[i].count;
			cost = half_area(&side) * (float)count;
		}
		right_cost[i] = cost;
	}
	split best = {-1, 0, INFINITY};
	side = empty_box();
	count = 0;
	for (int i = 1; i < BINS; i++) {
		if (bins[i - 1].count == 0)
			continue; /* the cut before costs the same */
		grow(&side, &bins[i - 1].bounds);
		count += bins[i - 1].count;
		cost = half_area(&side) * (float)count + right_cost[i];
		if (cost < best.cost)
			best = (split){axis, i, cost};
	}
	return best;
}

static void put_into(bin *into, const gi_box *item)
{
	if (into->count++ == 0)
		into->bounds = *item;
	else
		grow(&into->bounds, item);
}

static split best_split(const builder *b, uint32_t begin, uint32_t end, const gi_box *centres)
{
	bin bins[3][BINS];
	for (int axis = 0; axis < 3; axis++)
		for (int i = 0; i < BINS; i++)
			bins[axis][i].count = 0;
	for (uint32_t i = begin; i < end; i++) {
		const gi_box *item = &b->boxes[b->order[i]];
		for (int axis = 0; axis < 3; axis++)
			if (centres->upper[axis] > centres->lower[axis])
				put_into(&bins[axis][bin_of(item, centres, axis)], item);
	}
	split best = {-1, 0, INFINITY};
	for (int axis = 0; axis < 3; axis++) {
		const split found = best_on_axis(bins[axis], axis);
		if (found.cost < best.cost)
			best = found;
	}
	return best;
}

/* Left items forward in order, right ones backward: a function of the input alone. */
static uint32_t partition(builder *b, uint32_t begin, uint32_t end, const split *cut, const gi_box *centres)
{
	while (begin < end) {
		if (bin_of(&b->boxes[b->order[begin]], centres, cut->axis) < cut->bin) {
			begin++;
			continue;
		}
		const uint32_t swapped = b->order[begin];
		b->order[begin] = b->order[--end];
		b->order[end] = swapped;
	}
	return begin;
}

static void store_bounds(builder *b, uint32_t node, const gi_box *bounds)
{
	const float *l = bounds->lower, *u = bounds->upper, pad = b->pad;
	b->nodes[node].lower = (gi_vec4){l[0] - pad, l[1] - pad, l[2] - pad, 0.0f};
	b->nodes[node].upper = (gi_vec4){u[0] + pad, u[1] + pad, u[2] + pad, gi_float_from_bits(GI_NONE)};
}

static void swap_halves(builder *b, uint32_t begin, uint32_t middle, uint32_t end)
{
	/* Rotation by three reversals. */
	const uint32_t parts[3][2] = {{begin, middle}, {middle, end}, {begin, end}};
	for (int part = 0; part < 3; part++)
		for (uint32_t i = parts[part][0], j = parts[part][1]; i + 1 < j; i++) {
			const uint32_t swapped = b->order[i];
			b->order[i] = b->order[--j];
			b->order[j] = swapped;
		}
}

/* Cuts [begin, end) in two, the half of larger area first: a ray more likely meets it, and any-hit rays end there. */
static uint32_t cut_in_two(builder *b, uint32_t begin, uint32_t end, int depth)
{
	const gi_box centres = bounds_of_centres(b, begin, end);
	const split cut = depth < MAX_SAH_DEPTH ? best_split(b, begin, end, &centres) : (split){-1, 0, 0.0f};
	uint32_t middle = begin + (end - begin) / 2;
	if (cut.axis >= 0)
		middle = partition(b, begin, end, &cut, &centres);
	const gi_box left = bounds_of(b, begin, middle), right = bounds_of(b, middle, end);
	if (half_area(&right) > half_area(&left)) {
		swap_halves(b, begin, middle, end);
		middle = begin + (end - middle);
	}
	return middle;
}

static void build_node(builder *b, uint32_t begin, uint32_t end, int depth)
{
	const uint32_t node = b->node_count++;
	const gi_box bounds = bounds_of(b, begin, end);
	store_bounds(b, node, &bounds);
	if (end - begin == 1) {
		b->nodes[node].upper.w = gi_float_from_bits(b->leaf_count++);
	} else {
		const uint32_t middle = cut_in_two(b, begin, end, depth);
		build_node(b, begin, middle, depth + 1);
		build_node(b, middle, end, depth + 1);
	}
	b->nodes[node].lower.w = gi_float_from_bits(b->node_count);
}

static float padding(const gi_box *boxes, uint32_t count)
{
	float largest = 0.0f;
	for (uint32_t i = 0; i < count; i++)
		for (int axis = 0; axis < 3; axis++)
			largest = fmaxf(largest, fmaxf(fabsf(boxes[i].lower[axis]), fabsf(boxes[i].upper[axis])));
	return PAD_ULPS * FLT_EPSILON * largest;
}

void gi_bvh_build_boxes(const gi_box *boxes, uint32_t count, gi_bvh_node *nodes, uint32_t *order)
{
	builder b = {.boxes = boxes, .order = order, .nodes = nodes, .pad = padding(boxes, count)};
	for (uint32_t i = 0; i < count; i++)
		order[i] = i;
	if (count > 0)
		build_node(&b, 0, count, 0);
}

/* One more than asked for: no size is zero. */
static void *allocate(size_t count, size_t size)
{
	return gi_calloc(count + 1, size);
}

/* ---- an object's primitives ---- */

/* A vertex with a number where its w would be. */
static gi_vec4 corner(const gi_hierarchy *h, uint32_t vertex, uint32_t bits)
{
	gi_vec4 v = h->vertices[vertex];
	v.w = gi_float_from_bits(bits);
	return v;
}

static gi_primitive primitive_of(const gi_hierarchy *h, uint32_t node)
{
	const gi_uvec4 corners = h->topology[node].corners, range = h->topology[node].range;
	gi_primitive p = {corner(h, corners.x, range.y), corner(h, corners.y, range.y + range.z),
			  h->vertices[corners.z], h->vertices[corners.w]};
	const gi_vec3d a = gi_vec3d_from(p.a), b = gi_vec3d_from(p.b), c = gi_vec3d_from(p.c), d = gi_vec3d_from(p.d);
	p.c.w = (float)(2 * gi_vec3d_length(gi_vec3d_triangle(a, b, c)));
	p.d.w = (float)(2 * gi_vec3d_length(gi_vec3d_triangle(a, c, d)));
	return p;
}

static gi_box box_of(const gi_primitive *p)
{
	const gi_vec4 corners[4] = {p->a, p->b, p->c, p->d};
	gi_box bounds = empty_box();
	for (int i = 0; i < 4; i++) {
		const gi_box point = {{corners[i].x, corners[i].y, corners[i].z},
				      {corners[i].x, corners[i].y, corners[i].z}};
		grow(&bounds, &point);
	}
	return bounds;
}

/* The largest flat nodes, and the leaves that lie in none. Counts them where `out` is NULL. */
static uint32_t collect(const gi_hierarchy *h, gi_primitive *out)
{
	const uint32_t wanted = h->deforms ? GI_NODE_LEAF : GI_NODE_FLAT | GI_NODE_LEAF;
	uint32_t count = 0;
	for (uint32_t node = 0; node < h->node_count;) {
		const gi_uvec4 range = h->topology[node].range;
		if (!(range.w & wanted)) {
			node++;
			continue;
		}
		if (out)
			out[count] = primitive_of(h, node);
		count++;
		node = range.x;
	}
	return count;
}

bool gi_bvh_build(const gi_hierarchy *hierarchy, gi_bvh *out)
{
	const uint32_t count = collect(hierarchy, NULL);
	gi_primitive *found = allocate(count, sizeof *found);
	gi_box *boxes = allocate(count, sizeof *boxes);
	uint32_t *order = allocate(count, sizeof *order);
	*out = (gi_bvh){.nodes = allocate(2 * (size_t)count, sizeof *out->nodes),
			.primitives = allocate(count, sizeof *out->primitives)};
	const bool enough = found && boxes && order && out->nodes && out->primitives;
	if (enough) {
		collect(hierarchy, found);
		for (uint32_t i = 0; i < count; i++)
			boxes[i] = box_of(&found[i]);
		gi_bvh_build_boxes(boxes, count, out->nodes, order);
		for (uint32_t i = 0; i < count; i++)
			out->primitives[i] = found[order[i]];
		out->primitive_count = count;
		out->node_count = count > 0 ? 2 * count - 1 : 0;
	} else {
		gi_bvh_free(out);
	}
	gi_free(found);
	gi_free(boxes);
	gi_free(order);
	return enough;
}

void gi_bvh_rebuild(const gi_hierarchy *h, gi_bvh *bvh, gi_box *boxes, uint32_t *order)
{
	for (uint32_t leaf = 0; leaf < h->leaf_count; leaf++) {
		const gi_primitive p = primitive_of(h, h->leaf_node[leaf]);
		boxes[leaf] = box_of(&p);
	}
	gi_bvh_build_boxes(boxes, h->leaf_count, bvh->nodes, order);
	for (uint32_t k = 0; k < h->leaf_count; k++)
		bvh->primitives[k] = primitive_of(h, h->leaf_node[order[k]]);
}

void gi_bvh_free(gi_bvh *bvh)
{
	if (!bvh)
		return;
	gi_free(bvh->nodes);
	gi_free(bvh->primitives);
	*bvh = (gi_bvh){0};
}
