/* Builds the patch hierarchy of one object (hierarchy.h draws it).
 *
 *   gi_refined --sum_*--> area, normal and centre of every face of every level, bottom-up
 *              --emit_*--> nodes and leaves, depth-first: clusters (the base faces, parted about the
 *                           median), then faces
 *
 * Sums and measures are taken over the leaves of a node, in double, and stored as float: rounding does not pile up with
 * the levels.
 */
#include "hierarchy.h"

#include "hierarchy_node.h"
#include "hierarchy_quad.h"
#include "host_memory.h"
#include "split.h"

#include <stdio.h>
#include <string.h>

/* A face below this part of its own squared diagonal is a line or a point: its normal would be rounding. Of
 * its own, for a small lamp on a large object is a face as others are. */
#define ZERO_AREA 1e-12
/* Normals count this much of a bounds diagonal when base faces are clustered: opposite walls of a box part before the
 * halves of one wall do. */
#define NORMAL_WEIGHT 0.5

/* Keys are rounded to this part of the diagonal: symmetric cages are full of ties, and rounding of the positions must
 * not decide them, or the same cage at another scale would be another tree. */
#define KEY_STEPS 1048576.0

#define MAX_LEVELS GI_SPLIT_MAX_LEVELS

/* Sums over the leaves below a face. */
typedef struct face_sum {
	double area;
	gi_vec3d moment;
	gi_vec3d centre; /* area * centroid */
	uint32_t leaf_count;
} face_sum;

/* The faces of level + 1, grouped by parent: those of face f are children[first[f]] up to children[first[f + 1]]. */
typedef struct child_list {
	uint32_t *first;
	uint32_t *children;
} child_list;

/* A base face while the cluster tree is built. */
typedef struct cluster_item {
	double key[6]; /* position / diagonal, normal * NORMAL_WEIGHT */
	uint32_t face;
} cluster_item;

typedef struct builder {
	const gi_refined *refined;
	uint32_t finest;
	double diagonal2;
	face_sum *sums[MAX_LEVELS];
	child_list lists[MAX_LEVELS];
	cluster_item *items;
	uint32_t item_count;
	gi_hierarchy *out;
} builder;

/* ---- geometry of faces ---- */

double gi_quad_area(const float a[3], const float b[3], const float c[3], const float d[3])
{
	const quad q = {gi_vec3d_load(a), gi_vec3d_load(b), gi_vec3d_load(c), gi_vec3d_load(d)};
	return quad_area(&q);
}

static face_sum sum_quad(const quad *q)
{
	const gi_vec3d abc = gi_vec3d_triangle(q->a, q->b, q->c), acd = gi_vec3d_triangle(q->a, q->c, q->d);
	const double area1 = gi_vec3d_length(abc), area2 = gi_vec3d_length(acd);
	const gi_vec3d ac = gi_vec3d_add(q->a, q->c);
	return (face_sum){.area = area1 + area2,
			  .moment = gi_vec3d_add(abc, acd),
			  .centre = gi_vec3d_add(gi_vec3d_scale(gi_vec3d_add(ac, q->b), area1 / 3.0),
						 gi_vec3d_scale(gi_vec3d_add(ac, q->d), area2 / 3.0)),
			  .leaf_count = 1};
}

static void add_sum(face_sum *to, const face_sum *sum)
{
	to->area += sum->area;
	to->moment = gi_vec3d_add(to->moment, sum->moment);
	to->centre = gi_vec3d_add(to->centre, sum->centre);
	to->leaf_count += sum->leaf_count;
}

/* ---- sums and links of the refined levels ---- */

static void sum_leaves(builder *b)
{
	const gi_refine_level *level = &b->refined->levels[b->finest];
	for (uint32_t face = 0; face < level->face_count; face++) {
		const quad q = load_quad((const float(*)[3])b->refined->positions, level->corners[face]);
		const face_sum sum = sum_quad(&q);
		if (sum.area > ZERO_AREA * quad_diagonal2(&q))
			b->sums[b->finest][face] = sum;
	}
}

static void sum_parents(builder *b, uint32_t level)
{
	const gi_refine_level *below = &b->refined->levels[level + 1];
	for (uint32_t face = 0; face < below->face_count; face++)
		add_sum(&b->sums[level][below->parent[face]], &b->sums[level + 1][face]);
}

/* A counting sort: children stay in the order OpenSubdiv gave them. */
static void link_children(builder *b, uint32_t level)
{
	const gi_refine_level *below = &b->refined->levels[level + 1];
	const uint32_t count = b->refined->levels[level].face_count;
	child_list *list = &b->lists[level];
	for (uint32_t face = 0; face < below->face_count; face++)
		list->first[below->parent[face] + 1]++;
	for (uint32_t face = 0; face < count; face++)
		list->first[face + 1] += list->first[face];
	for (uint32_t face = below->face_count; face-- > 0;)
		list->children[--list->first[below->parent[face] + 1]] = face;
	/* Each first[f + 1] now is where f's children begin: one place too far up. */
	memmove(list->first, list->first + 1, count * sizeof *list->first);
	list->first[count] = below->face_count;
}

static void list_items(builder *b)
{
	const double diagonal = sqrt(b->diagonal2);
	for (uint32_t face = 0; face < b->refined->levels[0].face_count; face++) {
		const face_sum *sum = &b->sums[0][face];
		if (sum->leaf_count == 0)
			continue;
		const gi_vec3d centre = gi_vec3d_scale(sum->centre, 1.0 / (sum->area * diagonal));
		const gi_vec3d normal = gi_vec3d_scale(sum->moment, NORMAL_WEIGHT / sum->area);
		cluster_item item = {{centre.x, centre.y, centre.z, normal.x, normal.y, normal.z}, face};
		for (int axis = 0; axis < 6; axis++)
			item.key[axis] = rint(item.key[axis] * KEY_STEPS) / KEY_STEPS;
		b->items[b->item_count++] = item;
	}
}

/* ---- depth-first emission ---- */

static uint32_t open_node(gi_hierarchy *h, const uint32_t *corners)
{
	const uint32_t node = h->node_count++;
	h->topology[node].range = (gi_uvec4){0, h->leaf_count, 0, 0};
	h->topology[node].corners = (gi_uvec4){GI_NONE, GI_NONE, GI_NONE, GI_NONE};
	if (corners && corners[0] != UINT32_MAX) {
		h->topology[node].corners = (gi_uvec4){corners[0], corners[1], corners[2], corners[3]};
		h->topology[node].range.w = GI_NODE_POLYGON;
	}
	return node;
}

static void close_node(gi_hierarchy *h, uint32_t node)
{
	gi_uvec4 *range = &h->topology[node].range;
	range->x = h->node_count;
	range->z = h->leaf_count - range->y;
	gi_node_measure(h, node);
}

static void emit_leaf(builder *b, uint32_t face, uint32_t node)
{
	gi_hierarchy *h = b->out;
	const uint32_t leaf = h->leaf_count++;
	h->topology[node].range.w |= GI_NODE_LEAF;
	h->leaf_node[leaf] = node;
	h->leaf_face[leaf] = face;
	h->leaf_material[leaf] = b->refined->levels[b->finest].material[face];
}

/* Follows a face that was not refined further, an only child on every level below, to the finest. */
static uint32_t skip_only_children(const builder *b, uint32_t level, uint32_t *face)
{
	for (; level < b->finest; level++) {
		const uint32_t *first = b->lists[level].first + *face;
		if (first[1] - first[0] != 1)
			break;
		*face = b->lists[level].children[first[0]];
	}
	return level;
}

/* At most MAX_LEVELS deep. */
static void emit_face(builder *b, uint32_t level, uint32_t face)
{
	level = skip_only_children(b, level, &face);
	const uint32_t node = open_node(b->out, b->refined->levels[level].corners[face]);
	if (level == b->finest) {
		emit_leaf(b, face, node);
	} else {
		const child_list *list = &b->lists[level];
		for (uint32_t i = list->first[face]; i < list->first[face + 1]; i++)
			if (b->sums[level + 1][list->children[i]].leaf_count > 0)
				emit_face(b, level + 1, list->children[i]);
	}
	close_node(b->out, node);
}

static bool item_before(const cluster_item *a, const cluster_item *b, int axis)
{
	return a->key[axis] != b->key[axis] ? a->key[axis] < b->key[axis] : a->face < b->face;
}

static int widest_axis(const cluster_item *items, uint32_t count)
{
	int widest = 0;
	double most = -1.0;
	for (int axis = 0; axis < 6; axis++) {
		double lower = items[0].key[axis], upper = lower;
		for (uint32_t i = 1; i < count; i++) {
			lower = fmin(lower, items[i].key[axis]);
			upper = fmax(upper, items[i].key[axis]);
		}
		if (upper - lower > most) {
			most = upper - lower;
			widest = axis;
		}
	}
	return widest;
}

/* Hoare's selection as Wirth gives it: no item before `middle` comes after it in order, none behind it before. Items
 * differ by face at least, so the two sets are a function of the input alone. */
static void select_items(cluster_item *items, int64_t count, int64_t middle, int axis)
{
	int64_t begin = 0, end = count - 1;
	while (begin < end) {
		const cluster_item pivot = items[middle];
		int64_t low = begin, high = end;
		while (low <= high) {
			while (item_before(&items[low], &pivot, axis))
				low++;
			while (item_before(&pivot, &items[high], axis))
				high--;
			if (low > high)
				break;
			const cluster_item swapped = items[low];
			items[low++] = items[high];
			items[high--] = swapped;
		}
		if (high < middle)
			begin = low;
		if (middle < low)
			end = high;
	}
}

/* Where to part items about their middle: not through a row of faces with one key, if it ends near by. A wall of n by m
 * faces falls into rectangles then, which quads cover. */
static uint32_t split_of(const cluster_item *items, uint32_t count, int axis)
{
	const uint32_t middle = count / 2;
	const double key = items[middle].key[axis], same = 2 / KEY_STEPS;
	uint32_t before = 0, behind = 0;
	for (uint32_t i = 0; i < count; i++) {
		before += items[i].key[axis] < key - same;
		behind += items[i].key[axis] > key + same;
	}
	const uint32_t split = middle - before <= count - behind - middle ? before : count - behind;
	return split >= count / 4 && split <= count - count / 4 && split > 0 && split < count ? split : middle;
}

/* At most 2.5 log2(items) deep: no part has more than three quarters. */
static void emit_cluster(builder *b, cluster_item *items, uint32_t count)
{
	if (count == 1) {
		emit_face(b, 0, items[0].face);
		return;
	}
	const uint32_t node = open_node(b->out, NULL);
	const int axis = widest_axis(items, count);
	select_items(items, count, count / 2, axis);
	const uint32_t split = split_of(items, count, axis);
	select_items(items, count, split, axis);
	emit_cluster(b, items, split);
	emit_cluster(b, items + split, count - split);
	close_node(b->out, node);
}

/* ---- build ---- */

static void set_bounds(gi_hierarchy *h)
{
	gi_vec4 lower = {INFINITY, INFINITY, INFINITY, 0}, upper = {-INFINITY, -INFINITY, -INFINITY, 0};
	for (uint32_t i = 0; i < h->vertex_count; i++) {
		const gi_vec4 v = h->vertices[i];
		lower = (gi_vec4){fminf(lower.x, v.x), fminf(lower.y, v.y), fminf(lower.z, v.z), 0};
		upper = (gi_vec4){fmaxf(upper.x, v.x), fmaxf(upper.y, v.y), fmaxf(upper.z, v.z), 0};
	}
	h->lower = lower;
	h->upper = upper;
}

/* Sum of the tetrahedra from the middle of the bounds to the leaves' triangles: near the surface, so that little
 * cancels. */
static void set_totals(gi_hierarchy *h)
{
	h->area = h->volume = 0;
	const gi_vec3d from = gi_vec3d_scale(gi_vec3d_add(gi_vec3d_from(h->lower), gi_vec3d_from(h->upper)), 0.5);
	for (uint32_t leaf = 0; leaf < h->leaf_count; leaf++) {
		const quad q = node_quad(h, h->leaf_node[leaf]);
		const gi_vec3d abc = gi_vec3d_triangle(q.a, q.b, q.c), acd = gi_vec3d_triangle(q.a, q.c, q.d);
		const gi_vec3d a = gi_vec3d_sub(q.a, from);
		h->area += gi_vec3d_length(abc) + gi_vec3d_length(acd);
		h->volume += gi_vec3d_dot(a, gi_vec3d_add(abc, acd)) / 3.0;
	}
}

static void mark_backs(gi_hierarchy *h)
{
	if (h->closed && h->volume > 0.0)
		return;
	for (uint32_t node = 0; node < h->node_count; node++)
		h->topology[node].range.w |= GI_NODE_BACK;
}

static void *allocate(size_t count, size_t size, bool *enough)
{
	void *memory = gi_calloc(count > 0 ? count : 1, size);
	*enough = *enough && memory;
	return memory;
}

static bool allocate_builder(builder *b)
{
	bool enough = true;
	for (uint32_t level = 0; level < b->refined->level_count; level++) {
		const uint32_t count = b->refined->levels[level].face_count;
		b->sums[level] = allocate(count, sizeof(face_sum), &enough);
		if (level == b->finest)
			break;
		b->lists[level].first = allocate((size_t)count + 1, sizeof(uint32_t), &enough);
		b->lists[level].children =
		    allocate(b->refined->levels[level + 1].face_count, sizeof(uint32_t), &enough);
	}
	b->items = allocate(b->refined->levels[0].face_count, sizeof *b->items, &enough);
	return enough;
}

static void free_builder(builder *b)
{
	for (uint32_t level = 0; level < MAX_LEVELS; level++) {
		gi_free(b->sums[level]);
		gi_free(b->lists[level].first);
		gi_free(b->lists[level].children);
	}
	gi_free(b->items);
}

static bool copy_vertices(const gi_refined *refined, gi_hierarchy *h)
{
	bool enough = true;
	h->vertex_count = refined->vertex_count;
	h->vertices = allocate(h->vertex_count, sizeof *h->vertices, &enough);
	for (uint32_t i = 0; enough && i < h->vertex_count; i++) {
		const float *p = refined->positions[i];
		h->vertices[i] = (gi_vec4){p[0], p[1], p[2], 0.0f};
	}
	return enough;
}

static bool allocate_nodes(builder *b)
{
	gi_hierarchy *h = b->out;
	size_t nodes = b->item_count - 1, leaves = 0;
	for (uint32_t level = 0; level <= b->finest; level++) {
		leaves = 0;
		for (uint32_t face = 0; face < b->refined->levels[level].face_count; face++)
			leaves += b->sums[level][face].leaf_count > 0;
		nodes += leaves;
	}
	bool enough = true;
	h->geometry = allocate(nodes, sizeof *h->geometry, &enough);
	h->spread = allocate(nodes, sizeof *h->spread, &enough);
	h->topology = allocate(nodes, sizeof *h->topology, &enough);
	h->leaf_node = allocate(leaves, sizeof *h->leaf_node, &enough);
	h->leaf_material = allocate(leaves, sizeof *h->leaf_material, &enough);
	h->leaf_face = allocate(leaves, sizeof *h->leaf_face, &enough);
	return enough;
}

static const char *const OUT_OF_MEMORY = "out of memory while building the hierarchy";

/* NULL when all went well, else why not. */
static const char *build(builder *b)
{
	gi_hierarchy *h = b->out;
	if (!copy_vertices(b->refined, h) || !allocate_builder(b))
		return OUT_OF_MEMORY;
	set_bounds(h);
	const gi_vec3d diagonal = gi_vec3d_sub(gi_vec3d_from(h->upper), gi_vec3d_from(h->lower));
	b->diagonal2 = gi_vec3d_dot(diagonal, diagonal);
	h->deforms = b->refined->points.count > 0;

	sum_leaves(b);
	for (uint32_t level = b->finest; level-- > 0;) {
		sum_parents(b, level);
		link_children(b, level);
	}
	list_items(b);
	if (b->item_count == 0)
		return "no face has an area";
	if (!allocate_nodes(b))
		return OUT_OF_MEMORY;
	emit_cluster(b, b->items, b->item_count);
	set_totals(h);
	h->closed = b->refined->closed;
	mark_backs(h);
	return NULL;
}

bool gi_hierarchy_build(const gi_refined *refined, gi_hierarchy *out, char *message, size_t message_size)
{
	*out = (gi_hierarchy){0};
	const char *problem = "the refined cage has no levels, or too many";
	if (refined->level_count > 0 && refined->level_count <= MAX_LEVELS) {
		builder b = {.refined = refined, .finest = refined->level_count - 1, .out = out};
		problem = build(&b);
		free_builder(&b);
	}
	if (!problem)
		return true;
	gi_hierarchy_free(out);
	out->out_of_memory = problem == OUT_OF_MEMORY;
	if (message && message_size > 0)
		snprintf(message, message_size, "%s", problem);
	return false;
}

/* Children come behind their parents. */
static gi_node_sums sum_node(const gi_hierarchy *h, uint32_t node, const gi_node_sums *sums)
{
	const gi_uvec4 range = h->topology[node].range;
	gi_node_sums s = gi_node_no_sums();
	if (range.w & GI_NODE_LEAF) {
		const quad q = node_quad(h, node);
		gi_node_add_quad(&s, &q);
	}
	for (uint32_t child = node + 1; child < range.x; child = h->topology[child].range.x)
		gi_node_add_sums(&s, &sums[child]);
	return s;
}

void gi_hierarchy_refit(gi_hierarchy *h, gi_node_sums *sums)
{
	const double area = h->area;
	set_bounds(h);
	for (uint32_t node = h->node_count; node-- > 0;) {
		h->topology[node].range.w &= GI_NODE_LEAF | GI_NODE_POLYGON;
		sums[node] = sum_node(h, node, sums);
		gi_node_measure_by(h, node, &sums[node]);
	}
	set_totals(h);
	h->area = area;
	mark_backs(h);
}

void gi_hierarchy_free(gi_hierarchy *hierarchy)
{
	if (!hierarchy)
		return;
	gi_free(hierarchy->vertices);
	gi_free(hierarchy->leaf_node);
	gi_free(hierarchy->leaf_material);
	gi_free(hierarchy->leaf_face);
	gi_free(hierarchy->geometry);
	gi_free(hierarchy->spread);
	gi_free(hierarchy->topology);
	*hierarchy = (gi_hierarchy){0};
}
