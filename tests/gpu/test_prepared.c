/* Objects prepared on other threads while the frame loop goes on: taken in as they come, they are those that
 * gi_create_object makes, to the bit. What the preparation itself does on threads is tests/unit/test_prepare.c.
 */
#include "snapshot.h"

#include "scenes/body.h"
#include "scenes/shapes.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>

enum { THREADS = 3, EACH = 4, COUNT = THREADS * EACH };

/* ---- definitions ---- */

/* A ball, a box of both sides, a smooth blob: number says where it stands and which it is. */
typedef struct thing {
	engine_mesh mesh;
	gi_material material;
	gi_object_def def;
} thing;

static void make_thing(uint32_t number, thing *t)
{
	static const float lower[3] = {-.2f, -.2f, -.2f}, upper[3] = {.2f, .3f, .2f};
	const uint32_t kind = number % 3;
	assert_true(kind ? shape_box(lower, upper, 1, false, &t->mesh) : shape_sphere(.25f, 2, &t->mesh));
	t->material = (gi_material){.rho = {.6f, .5f, .4f}, .exitance = {number % 5 ? 0 : 3, 0, 0}};
	t->def = scene_mesh_def(&t->mesh);
	t->def.name = "thing";
	t->def.materials = &t->material;
	t->def.material_count = 1;
	t->def.scheme = kind == 2 ? GI_SCHEME_CATMULL_CLARK : GI_SCHEME_BILINEAR;
	t->def.levels = 1;
	t->def.double_sided = kind == 1;
	t->def.pose.position[0] = .8f * (float)(number % 4) - 1.2f;
	t->def.pose.position[1] = .5f;
	t->def.pose.position[2] = .8f * (float)(number / 4) - .8f;
}

static gi_context *open_room(const gi_context_def *def, gi_object *mover)
{
	gi_context *gi = harness_context(def);
	engine_mesh mesh;
	assert_true(shape_box((float[]){-2, 0, -2}, (float[]){2, 2.5f, 2}, 3, true, &mesh));
	harness_add(gi, &(harness_object){.name = "room", .rho = {.5f, .5f, .5f}}, &mesh);
	assert_true(shape_quad((float[]){-.5f, 2.4f, -.5f}, (float[]){1, 0, 0}, (float[]){0, 0, 1}, 1, 1, &mesh));
	harness_add(gi, &(harness_object){.name = "lamp", .exitance = {20, 20, 20}}, &mesh);
	assert_true(shape_sphere(.2f, 1, &mesh));
	*mover =
	    harness_add(gi, &(harness_object){.name = "ball", .rho = {.7f, .7f, .7f}, .position = {0, 1.5f, 0}}, &mesh);
	assert_gi(gi_commit(gi));
	return gi;
}

static gi_context_def coarse_def(void)
{
	gi_context_def def = harness_def();
	def.row_tolerance = .1f;
	return def;
}

/* ---- threads ---- */

static struct line {
	pthread_mutex_t lock;
	gi_prepared_object *prepared[COUNT]; /* NULL: not yet */
} line = {.lock = PTHREAD_MUTEX_INITIALIZER};

static void *prepare_some(void *first)
{
	thing *things = first;
	for (uint32_t k = 0; k < EACH; k++) {
		thing *t = &things[k];
		gi_prepared_object *made;
		if (gi_prepare_object(&t->def, NULL, NULL, NULL, &made))
			return NULL;
		pthread_mutex_lock(&line.lock);
		for (uint32_t n = 0; n < COUNT; n++)
			if (!line.prepared[n]) {
				line.prepared[n] = made;
				break;
			}
		pthread_mutex_unlock(&line.lock);
	}
	return first;
}

/* In whatever order they came. */
static gi_prepared_object *take_one(void)
{
	gi_prepared_object *taken = NULL;
	pthread_mutex_lock(&line.lock);
	for (uint32_t n = 0; n < COUNT && !taken; n++) {
		taken = line.prepared[n];
		line.prepared[n] = NULL;
	}
	pthread_mutex_unlock(&line.lock);
	return taken;
}

static void compare(gi_context *a, gi_context *b, const char *what)
{
	snapshot left = snapshot_take(a), right = snapshot_take(b);
	assert_int_equal(left.leaf_count, right.leaf_count);
	snapshot_expect_same_rows(&left, &right, what);
	for (uint32_t k = 0; k < left.leaf_count; k++)
		assert_memory_equal(left.leaves[k].corners, right.leaves[k].corners, sizeof left.leaves[k].corners);
	printf("  %s: %u leaves, %llu entries, the same bits\n", what, left.leaf_count,
	       (unsigned long long)left.entry_count);
	snapshot_free(&left);
	snapshot_free(&right);
}

static void prepared_is_created(void **state)
{
	(void)state;
	const gi_context_def def = coarse_def();
	gi_object mover, object;
	gi_context *a = open_room(&def, &mover), *b = open_room(&def, &mover);
	for (uint32_t k = 0; k < 3; k++) {
		thing t;
		make_thing(k, &t);
		gi_prepared_object *prepared;
		assert_gi(gi_prepare_object(&t.def, def.message, NULL, NULL, &prepared));
		assert_gi(gi_create_object(a, &t.def, &object));
		assert_gi(gi_create_prepared_object(b, &prepared, &object));
		assert_null(prepared);
		assert_true(gi_object_is_valid(b, object));
		engine_mesh_free(&t.mesh);
	}
	assert_gi(gi_commit(a));
	assert_gi(gi_commit(b));
	harness_update(a);
	harness_update(b);
	compare(a, b, "from a definition and prepared");
	gi_context_destroy(a);
	gi_context_destroy(b);
}

/* Frames go on, objects come as they are ready. */
static void frames_go_on(void **state)
{
	(void)state;
	const gi_context_def def = coarse_def();
	gi_object mover, other;
	gi_context *gi = open_room(&def, &mover), *at_once = open_room(&def, &other);
	harness_update(gi);
	thing things[COUNT];
	for (uint32_t k = 0; k < COUNT; k++)
		make_thing(k, &things[k]);
	pthread_t threads[THREADS];
	for (uint32_t t = 0; t < THREADS; t++)
		assert_int_equal(pthread_create(&threads[t], NULL, prepare_some, things + t * EACH), 0);
	uint32_t taken = 0, frames = 0;
	gi_object objects[COUNT];
	while (taken < COUNT && frames < 100000) {
		gi_prepared_object *prepared = take_one();
		if (prepared) {
			assert_gi(gi_create_prepared_object(gi, &prepared, &objects[taken++]));
			assert_gi(gi_commit(gi));
		}
		const float way = .01f * (float)(frames++ % 20);
		assert_gi(gi_set_pose(gi, mover, (gi_pose){{way, 1.5f, 0}, {0, 0, 0, 1}}));
		assert_gi(gi_update(gi, NULL));
	}
	for (uint32_t t = 0; t < THREADS; t++) {
		void *first = NULL;
		assert_int_equal(pthread_join(threads[t], &first), 0);
		assert_non_null(first);
	}
	assert_int_equal(taken, COUNT);
	printf("  %u objects came in %u frames\n", taken, frames);
	const gi_pose home = {{0, 1.5f, 0}, {0, 0, 0, 1}};
	assert_gi(gi_set_pose(gi, mover, home));
	harness_update(gi);
	/* Built at once, in the order they came in. */
	for (uint32_t k = 0; k < COUNT; k++) {
		gi_pose pose;
		gi_object object;
		assert_gi(gi_get_pose(gi, objects[k], &pose));
		uint32_t n = 0;
		while (memcmp(&things[n].def.pose.position, pose.position, sizeof pose.position) != 0)
			assert_true(++n < COUNT);
		assert_gi(gi_create_object(at_once, &things[n].def, &object));
	}
	assert_gi(gi_commit(at_once));
	harness_update(at_once);
	compare(gi, at_once, "as they came, and at once");
	for (uint32_t k = 0; k < COUNT; k++)
		engine_mesh_free(&things[k].mesh);
	gi_context_destroy(gi);
	gi_context_destroy(at_once);
}

/* What a context cannot take stays whose it was. */
static void refused_it_is_kept(void **state)
{
	(void)state;
	gi_context_def small = coarse_def(), large = coarse_def();
	small.max_buffer_mib = 1;
	gi_context *a = harness_context(&small), *b = harness_context(&large);
	engine_mesh mesh;
	assert_true(shape_sphere(1, 6, &mesh));
	gi_object_def def = scene_mesh_def(&mesh);
	def.levels = 3;
	gi_prepared_object *prepared, *none = NULL;
	gi_object object = {1, 1, 1};
	assert_gi(gi_prepare_object(&def, small.message, NULL, NULL, &prepared));
	assert_int_equal(gi_create_prepared_object(a, &prepared, &object), GI_ERROR_INVALID_GEOMETRY);
	printf("  %s\n", harness_last_message());
	assert_non_null(prepared);
	assert_int_equal(object.index1, 0);
	assert_int_equal(gi_create_prepared_object(a, &none, &object), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_create_prepared_object(a, NULL, &object), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_create_prepared_object(NULL, &prepared, &object), GI_ERROR_INVALID_ARGUMENT);
	assert_gi(gi_create_prepared_object(b, &prepared, &object));
	assert_null(prepared);
	assert_gi(gi_prepare_object(&def, small.message, NULL, NULL, &prepared));
	gi_free_prepared_object(prepared);
	engine_mesh_free(&mesh);
	gi_context_destroy(a);
	gi_context_destroy(b);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(prepared_is_created),
	    cmocka_unit_test(frames_go_on),
	    cmocka_unit_test(refused_it_is_kept),
	};
	return cmocka_run_group_tests_name("prepared", tests, harness_open, harness_close);
}
