#include "snapshot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Compared as bytes: no padding may hide in them. */
_Static_assert(sizeof(gi_entry) == 8 * 4, "gi_entry has padding");
_Static_assert(sizeof(gi_link) == 5 * 4, "gi_link has padding");

static int order(uint32_t leaf_a, uint32_t node_a, uint32_t leaf_b, uint32_t node_b)
{
	if (leaf_a != leaf_b)
		return leaf_a < leaf_b ? -1 : 1;
	return node_a < node_b ? -1 : node_a > node_b;
}

static int order_entries(const void *a, const void *b)
{
	const gi_entry *p = a, *q = b;
	return order(p->leaf, p->node, q->leaf, q->node);
}

static int order_links(const void *a, const void *b)
{
	const gi_link *p = a, *q = b;
	return order(p->leaf, p->node, q->leaf, q->node);
}

/* The order they come in is mostly the order wanted: then there is nothing to do. */
static void sort(void *data, uint64_t count, size_t size, int (*compare)(const void *, const void *))
{
	bool sorted = true;
	for (uint64_t k = 1; sorted && k < count; k++)
		sorted = compare((char *)data + (k - 1) * size, (char *)data + k * size) < 0;
	if (!sorted)
		qsort(data, count, size, compare);
}

static void *allocate(uint64_t count, size_t size)
{
	void *data = calloc(count + 1, size);
	assert_non_null(data);
	return data;
}

snapshot snapshot_take(gi_context *gi)
{
	snapshot s = {0};
	uint64_t again;
	uint32_t leaves_again;
	assert_gi(gi_read_leaves(gi, NULL, 0, &s.leaf_count));
	assert_gi(gi_read_entries(gi, NULL, 0, &s.entry_count));
	assert_gi(gi_read_links(gi, NULL, 0, &s.link_count));
	s.leaves = allocate(s.leaf_count, sizeof *s.leaves);
	s.entries = allocate(s.entry_count, sizeof *s.entries);
	s.links = allocate(s.link_count, sizeof *s.links);
	assert_gi(gi_read_leaves(gi, s.leaves, s.leaf_count, &leaves_again));
	assert_int_equal(leaves_again, s.leaf_count);
	assert_gi(gi_read_entries(gi, s.entries, s.entry_count, &again));
	assert_int_equal(again, s.entry_count);
	assert_gi(gi_read_links(gi, s.links, s.link_count, &again));
	assert_int_equal(again, s.link_count);
	sort(s.entries, s.entry_count, sizeof *s.entries, order_entries);
	sort(s.links, s.link_count, sizeof *s.links, order_links);
	return s;
}

void snapshot_free(snapshot *s)
{
	free(s->leaves);
	free(s->entries);
	free(s->links);
	*s = (snapshot){0};
}

static void expect_same_entries(const snapshot *a, const snapshot *b, const char *when)
{
	const uint64_t shared = a->entry_count < b->entry_count ? a->entry_count : b->entry_count;
	for (uint64_t k = 0; k < shared; k++) {
		const gi_entry *p = &a->entries[k], *q = &b->entries[k];
		if (memcmp(p, q, sizeof *p) != 0)
			fail_msg("%s: entry %llu differs: leaf %u node %u F %.9g V %u/%u back %u, and leaf %u node %u "
				 "F %.9g V %u/%u "
				 "back %u",
				 when, (unsigned long long)k, p->leaf, p->node, (double)p->form_factor, p->visible,
				 p->samples, p->back, q->leaf, q->node, (double)q->form_factor, q->visible, q->samples,
				 q->back);
	}
	if (a->entry_count != b->entry_count)
		fail_msg("%s: %llu entries, and %llu", when, (unsigned long long)a->entry_count,
			 (unsigned long long)b->entry_count);
}

static void expect_same_links(const snapshot *a, const snapshot *b, const char *when)
{
	const uint64_t shared = a->link_count < b->link_count ? a->link_count : b->link_count;
	for (uint64_t k = 0; k < shared; k++) {
		const gi_link *p = &a->links[k], *q = &b->links[k];
		if (memcmp(p, q, sizeof *p) != 0)
			fail_msg("%s: link %llu differs: leaf %u node %u weight %.9g, and leaf %u node %u weight %.9g",
				 when, (unsigned long long)k, p->leaf, p->node, (double)p->weight, q->leaf, q->node,
				 (double)q->weight);
	}
	if (a->link_count != b->link_count)
		fail_msg("%s: %llu links, and %llu", when, (unsigned long long)a->link_count,
			 (unsigned long long)b->link_count);
}

void snapshot_expect_same_rows(const snapshot *a, const snapshot *b, const char *when)
{
	assert_int_equal(a->leaf_count, b->leaf_count);
	expect_same_entries(a, b, when);
	expect_same_links(a, b, when);
	for (uint32_t k = 0; k < a->leaf_count; k++)
		if (memcmp(&a->leaves[k].row_sum, &b->leaves[k].row_sum, sizeof(float)) != 0)
			fail_msg("%s: row sum of leaf %u is %.9g, and %.9g", when, k, (double)a->leaves[k].row_sum,
				 (double)b->leaves[k].row_sum);
}

double snapshot_distance(const snapshot *a, const snapshot *b)
{
	assert_int_equal(a->leaf_count, b->leaf_count);
	double distance = 0;
	for (uint32_t k = 0; k < a->leaf_count; k++)
		for (int c = 0; c < 3; c++) {
			const double d = fabs((double)a->leaves[k].radiosity[c] - (double)b->leaves[k].radiosity[c]);
			distance = d <= distance ? distance : d; /* a NaN stays */
		}
	return distance;
}

double snapshot_largest(const snapshot *s)
{
	double largest = 0;
	for (uint32_t k = 0; k < s->leaf_count; k++)
		for (int c = 0; c < 3; c++)
			largest = fmax(largest, (double)s->leaves[k].radiosity[c]);
	return largest;
}

static uint64_t hash(uint64_t h, const void *data, uint64_t size)
{
	const unsigned char *bytes = data;
	for (uint64_t k = 0; k < size; k++)
		h = (h ^ bytes[k]) * 0x100000001b3u;
	return h;
}

static const uint64_t FNV_BASIS = 0xcbf29ce484222325u;

uint64_t snapshot_hash_rows(const snapshot *s)
{
	const uint64_t h = hash(FNV_BASIS, s->entries, s->entry_count * sizeof *s->entries);
	return hash(h, s->links, s->link_count * sizeof *s->links);
}

uint64_t snapshot_hash_radiosity(const snapshot *s)
{
	uint64_t h = FNV_BASIS;
	for (uint32_t k = 0; k < s->leaf_count; k++)
		h = hash(h, s->leaves[k].radiosity, sizeof s->leaves[k].radiosity);
	return h;
}

/* Area-weighted relative RMS of H against path tracing, the noise of its two halves taken out. */
static double error_of(const float *one, const float *two, const snapshot *s)
{
	double squared = 0, power = 0;
	for (uint32_t k = 0; k < s->leaf_count; k++)
		for (uint32_t c = 0; c < 3; c++) {
			const double h = (double)s->leaves[k].irradiance[c], a = (double)one[3 * k + c],
				     b = (double)two[3 * k + c], area = (double)s->leaves[k].area;
			squared += area * (h - a) * (h - b);
			power += area * a * b;
		}
	return sqrt(fmax(squared, 0) / power);
}

double snapshot_light_error(gi_context *gi, const snapshot *s, uint32_t paths)
{
	float *halves[2];
	for (uint32_t k = 0; k < 2; k++) {
		uint32_t count;
		halves[k] = allocate(3 * (uint64_t)s->leaf_count, sizeof *halves[k]);
		assert_gi(gi_trace_paths(gi, &(gi_path_options){.paths = paths, .seed = k + 1}, halves[k],
					 s->leaf_count, &count));
	}
	const double error = error_of(halves[0], halves[1], s);
	free(halves[0]);
	free(halves[1]);
	return error;
}

void snapshot_expect_rebuilt_rows(gi_context *gi, const char *when)
{
	snapshot kept = snapshot_take(gi);
	gi_invalidate(gi);
	harness_update(gi);
	snapshot anew = snapshot_take(gi);
	snapshot_expect_same_rows(&kept, &anew, when);
	snapshot_free(&kept);
	snapshot_free(&anew);
}
