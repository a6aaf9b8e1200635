/* Objects are prepared on several threads at once, from the same definitions, and come out as on one thread, to the
 * bit. Built with -fsanitize=thread (preset "thread") it is also the proof that those threads share nothing they write.
 */
#include "handles.h"

#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE = 6, VERTICES = (SIDE + 1) * (SIDE + 1), QUADS = SIDE * SIDE, THREADS = 4, TURNS = 3 };

/* ---- definitions: every way an object can be built ---- */

/* A sheet with waves, as quads and as triangles. */
static struct sheet {
	float positions[3 * VERTICES];
	uint32_t quads[4 * QUADS], triangles[6 * QUADS], three[2 * QUADS];
	float sizes[QUADS];
} sheet;

static void make_sheet(void)
{
	for (uint32_t j = 0; j <= SIDE; j++)
		for (uint32_t i = 0; i <= SIDE; i++) {
			float *p = sheet.positions + 3 * (j * (SIDE + 1) + i);
			p[0] = (float)i;
			p[1] = .3f * sinf((float)i) * cosf(1.7f * (float)j);
			p[2] = -(float)j;
		}
	for (uint32_t q = 0; q < QUADS; q++) {
		const uint32_t a = q / SIDE * (SIDE + 1) + q % SIDE, b = a + 1, c = b + SIDE + 1, d = a + SIDE + 1;
		memcpy(sheet.quads + 4 * q, (uint32_t[]){a, b, c, d}, sizeof(uint32_t[4]));
		memcpy(sheet.triangles + 6 * q, (uint32_t[]){a, b, c, a, c, d}, sizeof(uint32_t[6]));
		sheet.three[2 * q] = sheet.three[2 * q + 1] = 3;
		sheet.sizes[q] = q % 5 ? 0 : .2f;
	}
}

static gi_object_def sheet_def(const char *name)
{
	gi_object_def def = gi_object_def_default();
	def.name = name;
	def.positions = sheet.positions;
	def.vertex_count = VERTICES;
	def.indices = sheet.quads;
	def.index_count = 4 * QUADS;
	def.face_count = QUADS;
	return def;
}

static gi_object_def with_triangles(gi_object_def def)
{
	def.indices = sheet.triangles;
	def.index_count = 6 * QUADS;
	def.face_counts = sheet.three;
	def.face_count = 2 * QUADS;
	return def;
}

enum { KINDS = 7 };

/* Cut into triangles first. And a face twice: a warning. */
static gi_object_def with_notch(gi_object_def def)
{
	static const float notch[] = {0, 0, 0, 2, 0, 0, 2, 2, 0, 1, .5f, 0, 0, 2, 0};
	static const uint32_t notched[] = {0, 1, 2, 3, 4, 1, 2, 3, 4, 0}, five[] = {5, 5};
	def.name = "notch";
	def.positions = notch;
	def.vertex_count = 5;
	def.indices = notched;
	def.index_count = 10;
	def.face_counts = five;
	def.face_count = 2;
	def.levels = 2;
	return def;
}

static gi_object_def with_cuts(gi_object_def def)
{
	static const float flat[] = {0, 0, 0, 4, 0, 0, 4, 0, -4, 0, 0, -4};
	static const uint32_t flat_face[] = {0, 1, 2, 3};
	static const gi_leaf_cut cuts[] = {{.face = 0, .from = {-1, 0, -1}, .to = {5, 0, -2}, .parts = true},
					   {.face = 0, .from = {1, 0, 1}, .to = {2, 0, -5}}};
	def.name = "cut";
	def.positions = flat;
	def.vertex_count = 4;
	def.indices = flat_face;
	def.index_count = 4;
	def.face_count = 1;
	def.leaf_size = .5f;
	def.leaf_cuts = cuts;
	def.leaf_cut_count = 2;
	return def;
}

static gi_object_def kind(int k)
{
	static const uint32_t crease[] = {8, 9, 9, 10};
	static const float sharp[] = {2, 10};
	static const gi_material materials[] = {{.rho = {.5f, .4f, .3f}}, {.exitance = {1, 2, 3}}};
	gi_object_def def = sheet_def("sheet");
	switch (k) {
	case 0:
		def.levels = 2;
		def.double_sided = true;
		return def;
	case 1:
		def.scheme = GI_SCHEME_CATMULL_CLARK;
		def.levels = 2;
		def.crease_vertices = crease;
		def.crease_sharpness = sharp;
		def.crease_count = 2;
		return def;
	case 2:
		def = with_triangles(def);
		def.scheme = GI_SCHEME_LOOP;
		def.leaf_size = .4f;
		return def;
	case 3:
		def.leaf_size = .35f;
		def.leaf_sizes = sheet.sizes;
		def.materials = materials;
		def.material_count = 2;
		return def;
	case 4: /* drawn as something finer */
		def.draw_positions = sheet.positions;
		def.draw_vertex_count = VERTICES;
		def.draw_indices = sheet.triangles;
		def.draw_index_count = 6 * QUADS;
		return def;
	case 5:
		return with_notch(def);
	default:
		return with_cuts(def);
	}
}

/* ---- one thread against many ---- */

typedef struct heard {
	uint32_t count;
	char text[256];
	pthread_t thread;
} heard;

static void hear(gi_result result, const char *message, void *user)
{
	heard *h = user;
	(void)result;
	h->count++;
	h->thread = pthread_self();
	snprintf(h->text, sizeof h->text, "%s", message);
}

static bool same(const void *a, const void *b, size_t count, size_t size)
{
	return count == 0 || memcmp(a, b, count * size) == 0;
}

#define SAME(part, array, count) same(a->part.array, b->part.array, a->part.count, sizeof *a->part.array)

static bool same_objects(const object_record *a, const object_record *b)
{
	return a->hierarchy.node_count == b->hierarchy.node_count &&
	       a->hierarchy.leaf_count == b->hierarchy.leaf_count &&
	       a->hierarchy.vertex_count == b->hierarchy.vertex_count && a->bvh.node_count == b->bvh.node_count &&
	       a->bvh.primitive_count == b->bvh.primitive_count && a->drawn.light_count == b->drawn.light_count &&
	       a->drawn.vertex_count == b->drawn.vertex_count && a->drawn.index_count == b->drawn.index_count &&
	       a->material_count == b->material_count && strcmp(a->name, b->name) == 0 && a->plane == b->plane &&
	       SAME(hierarchy, geometry, node_count) && SAME(hierarchy, topology, node_count) &&
	       SAME(hierarchy, vertices, vertex_count) && SAME(hierarchy, leaf_node, leaf_count) &&
	       SAME(hierarchy, leaf_material, leaf_count) && SAME(bvh, nodes, node_count) &&
	       SAME(bvh, primitives, primitive_count) && SAME(drawn, light_first, light_count) &&
	       SAME(drawn, vertices, vertex_count) && SAME(drawn, indices, index_count);
}

/* What a thread found; asserted by the main one. */
typedef struct worker {
	pthread_t thread;
	const gi_object_def *defs;
	gi_prepared_object *const *expected;
	gi_prepared_object *last; /* freed by another thread */
	int first;
	uint32_t prepared, failed, different, strange_messages;
} worker;

static void prepare_one(worker *w, int k)
{
	heard h = {0};
	gi_prepared_object *made = NULL;
	const gi_result result = gi_prepare_object(&w->defs[k], hear, &h, NULL, &made);
	w->prepared++;
	w->failed += result != GI_OK;
	w->different += made && !same_objects(&made->object, &w->expected[k]->object);
	/* The notch is there twice. */
	const bool told = k == 5;
	w->strange_messages += h.count != (told ? 1 : 0) || (told && !pthread_equal(h.thread, pthread_self()));
	gi_free_prepared_object(w->last);
	w->last = made;
}

static void break_one(worker *w)
{
	heard h = {0};
	gi_prepared_object *made = w->last;
	gi_object_def def = w->defs[0];
	char name[32];
	snprintf(name, sizeof name, "broken %d", w->first);
	def.name = name;
	def.vertex_count = 3;
	const gi_result result = gi_prepare_object(&def, hear, &h, NULL, &made);
	w->failed += result != GI_ERROR_INVALID_GEOMETRY || made;
	w->strange_messages += h.count != 1 || !strstr(h.text, name) || !pthread_equal(h.thread, pthread_self());
}

static void *work(void *data)
{
	worker *w = data;
	for (int k = 0; k < TURNS * KINDS; k++) {
		prepare_one(w, (w->first + k) % KINDS);
		if (k % 5 == 0)
			break_one(w);
	}
	return NULL;
}

static void threads_prepare_the_same_bits(void **state)
{
	(void)state;
	make_sheet();
	gi_object_def defs[KINDS];
	gi_prepared_object *expected[KINDS];
	heard h = {0};
	uint32_t leaves = 0;
	for (int k = 0; k < KINDS; k++) {
		defs[k] = kind(k);
		if (gi_prepare_object(&defs[k], hear, &h, NULL, &expected[k]))
			fail_msg("kind %d: %s", k, h.text);
		leaves += expected[k]->object.hierarchy.leaf_count;
	}
	worker workers[THREADS + 1];
	for (int t = 0; t <= THREADS; t++)
		workers[t] = (worker){.defs = defs, .expected = expected, .first = t};
	for (int t = 0; t < THREADS; t++)
		assert_int_equal(pthread_create(&workers[t].thread, NULL, work, &workers[t]), 0);
	work(&workers[THREADS]);
	uint32_t prepared = 0;
	for (int t = 0; t <= THREADS; t++) {
		worker *w = &workers[t];
		if (t < THREADS)
			assert_int_equal(pthread_join(w->thread, NULL), 0);
		if (w->failed || w->different || w->strange_messages)
			fail_msg("thread %d: of %u, %u failed, %u are different; %u messages are not as they should be",
				 t, w->prepared, w->failed, w->different, w->strange_messages);
		prepared += w->prepared;
		gi_free_prepared_object(w->last);
	}
	for (int k = 0; k < KINDS; k++)
		gi_free_prepared_object(expected[k]);
	printf("  %u objects of %d kinds, %u leaves a kind in the mean, on %d threads: all the same bits\n", prepared,
	       KINDS, leaves / KINDS, THREADS + 1);
}

static void what_is_wrong_is_told(void **state)
{
	(void)state;
	make_sheet();
	heard h = {0};
	gi_object_def def = kind(0);
	gi_prepared_object *made = NULL;
	assert_int_equal(gi_prepare_object(NULL, hear, &h, NULL, &made), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_prepare_object(&def, hear, &h, NULL, NULL), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_prepare_object(&(gi_object_def){0}, hear, &h, NULL, &made), GI_ERROR_INVALID_DEF);
	def.pose.rotation[3] = 0;
	assert_int_equal(gi_prepare_object(&def, hear, &h, NULL, &made), GI_ERROR_INVALID_POSE);
	def = kind(0);
	def.leaf_size = 1e-6f;
	assert_int_equal(gi_prepare_object(&def, hear, &h, NULL, &made), GI_ERROR_INVALID_GEOMETRY);
	assert_non_null(strstr(h.text, "raise leaf_size"));
	assert_int_equal(h.count, 5);
	assert_null(made);
	gi_free_prepared_object(NULL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(threads_prepare_the_same_bits),
	    cmocka_unit_test(what_is_wrong_is_told),
	};
	return cmocka_run_group_tests_name("prepare", tests, NULL, NULL);
}
