/* The OpenGL context that a gi_context was made in is not current: an error in one line from every function that needs
 * it, nothing of another context's touched, and all as before once it is current again.
 */
#include "harness.h"

#include "scenes/shapes.h"

#include <glad/gl.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LEAVES = 5 };

static struct {
	uint32_t count;
	gi_result result;
	char text[1024];
} heard;

static void hear(gi_result result, const char *message, void *user)
{
	(void)user;
	heard.count++;
	heard.result = result;
	snprintf(heard.text, sizeof heard.text, "%s", message);
}

typedef struct home {
	engine_context *context;
	gi_context *gi;
	gi_object floor;
} home;

static home open_home(void)
{
	home h = {0};
	char message[256];
	engine_context_def def = engine_context_def_default();
	def.kind = ENGINE_CONTEXT_EGL;
	def.width = def.height = 16;
	h.context = engine_context_create(&def, message, sizeof message);
	if (!h.context) {
		print_message("skipped: %s\n", message);
		skip();
	}
	gi_context_def gi = gi_context_def_default();
	gi.get_proc_address = engine_context_find_gl;
	gi.get_proc_user = h.context;
	gi.message = hear;
	gi.row_tolerance = .1f;
	assert_gi(gi_context_create(&gi, &h.gi));
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-1, 0, -1}, (float[]){0, 0, 2}, (float[]){2, 0, 0}, 2, 2, &mesh));
	h.floor = harness_add(h.gi, &(harness_object){.name = "floor", .rho = {.5f, .6f, .7f}}, &mesh);
	assert_true(shape_quad((float[]){-.5f, 2, -.5f}, (float[]){1, 0, 0}, (float[]){0, 0, 1}, 1, 1, &mesh));
	harness_add(h.gi, &(harness_object){.name = "light", .exitance = {10, 10, 10}}, &mesh);
	assert_gi(gi_commit(h.gi));
	harness_update(h.gi);
	return h;
}

static void read_light(const home *h, gi_leaf leaves[LEAVES])
{
	uint32_t count;
	assert_gi(gi_read_leaves(h->gi, leaves, LEAVES, &count));
	assert_int_equal(count, LEAVES);
}

#define expect_refused(call)                                                                                           \
	do {                                                                                                           \
		heard.count = 0;                                                                                       \
		const gi_result got = (call);                                                                          \
		if (got != GI_ERROR_WRONG_CONTEXT || heard.count != 1 || heard.result != got ||                        \
		    strchr(heard.text, '\n') || !strstr(heard.text, "current"))                                        \
			fail_msg("%s: %s, %u messages, the last one: %s", #call, gi_result_text(got), heard.count,     \
				 heard.text);                                                                          \
	} while (0)

static void expect_all_refused(const home *h)
{
	const gi_view view = gi_view_default();
	gi_leaf leaves[LEAVES];
	gi_report report;
	float irradiance[3 * LEAVES];
	uint32_t count = 1;
	uint64_t many = 1;
	double f;
	expect_refused(gi_commit(h->gi));
	expect_refused(gi_update(h->gi, NULL));
	expect_refused(gi_update(h->gi, &(gi_budget){.rays = 5}));
	expect_refused(gi_finish(h->gi));
	expect_refused(gi_get_report(h->gi, &report));
	expect_refused(gi_draw(h->gi, &view));
	expect_refused(gi_set_textures(h->gi, h->floor, 0, NULL));
	expect_refused(gi_read_leaves(h->gi, leaves, LEAVES, &count));
	assert_int_equal(count, 0);
	expect_refused(gi_read_entries(h->gi, NULL, 0, &many));
	assert_int_equal(many, 0);
	many = 1;
	expect_refused(gi_read_links(h->gi, NULL, 0, &many));
	assert_int_equal(many, 0);
	expect_refused(gi_form_factor(h->gi, h->floor, h->floor, &f));
	expect_refused(gi_trace_paths(h->gi, NULL, irradiance, LEAVES, &count));
}

/* Values are set and got without OpenGL, objects made too. */
static void expect_values_taken(home *h)
{
	engine_mesh mesh;
	gi_pose pose;
	gi_buffers buffers;
	gi_object_range range;
	gi_vertex_light light;
	heard.count = 0;
	assert_gi(gi_set_pose(h->gi, h->floor, (gi_pose){{0, .25f, 0}, {0, 0, 0, 1}}));
	assert_gi(gi_get_pose(h->gi, h->floor, &pose));
	assert_gi(gi_set_pose(h->gi, h->floor, gi_pose_identity()));
	assert_gi(gi_get_buffers(h->gi, &buffers));
	assert_gi(gi_get_object_range(h->gi, h->floor, &range));
	assert_gi(gi_map_vertices(h->gi, h->floor, (float[]){0, 0, 0}, NULL, 1, &light));
	assert_true(shape_quad((float[]){0, 0, 0}, (float[]){0, 0, 1}, (float[]){1, 0, 0}, 1, 1, &mesh));
	assert_gi(gi_destroy_object(h->gi, harness_add(h->gi, &(harness_object){.name = "more"}, &mesh)));
	gi_invalidate(h->gi);
	gi_reset_radiosity(h->gi);
	assert_int_equal(heard.count, 0);
}

static void expect_same_light(const home *h, const gi_leaf before[LEAVES])
{
	gi_leaf now[LEAVES];
	assert_gi(gi_commit(h->gi));
	gi_reset_radiosity(h->gi);
	harness_update(h->gi);
	read_light(h, now);
	for (int k = 0; k < LEAVES; k++)
		assert_memory_equal(before[k].radiosity, now[k].radiosity, sizeof now[k].radiosity);
}

static void no_context_is_current(void **state)
{
	(void)state;
	home a = open_home(), b = open_home();
	gi_leaf before[LEAVES];
	assert_true(engine_context_make_current(a.context));
	read_light(&a, before);
	assert_true(engine_context_make_current(b.context));
	gi_context_destroy(b.gi);
	engine_context_destroy(b.context);
	expect_all_refused(&a);
	expect_values_taken(&a);
	assert_true(engine_context_make_current(a.context));
	expect_same_light(&a, before);
	gi_context_destroy(a.gi);
	engine_context_destroy(a.context);
}

static void another_context_is_current(void **state)
{
	(void)state;
	home a = open_home();
	gi_leaf before[LEAVES];
	read_light(&a, before);
	home b = open_home();
	expect_all_refused(&a);
	expect_values_taken(&a);

	/* Names are the same in both; those of the other one are left alone. */
	heard.count = 0;
	gi_context_destroy(a.gi);
	assert_int_equal(heard.count, 1);
	assert_int_equal(heard.result, GI_ERROR_WRONG_CONTEXT);
	expect_same_light(&b, before);
	assert_int_equal(glGetError(), GL_NO_ERROR);
	gi_context_destroy(b.gi);
	engine_context_destroy(b.context);
	engine_context_destroy(a.context);
}

/* The host's window is gone before the library's context. */
static void the_context_is_gone(void **state)
{
	(void)state;
	home a = open_home();
	engine_context_destroy(a.context);
	expect_all_refused(&a);
	heard.count = 0;
	gi_context_destroy(a.gi);
	assert_int_equal(heard.count, 1);
	assert_int_equal(heard.result, GI_ERROR_WRONG_CONTEXT);
}

/* The object is another context's, which has one of the same number and age. */
static void expect_strange_handles_refused(gi_context *gi, gi_object object)
{
	engine_mesh mesh;
	gi_material material;
	assert_true(shape_quad((float[]){0, 0, 0}, (float[]){0, 0, 1}, (float[]){1, 0, 0}, 1, 1, &mesh));
	const gi_object own = harness_add(gi, &(harness_object){.name = "own", .rho = {.5f, .25f, .125f}}, &mesh);
	assert_int_equal(own.index1, object.index1);
	assert_int_equal(own.generation, object.generation);
	assert_false(gi_object_is_valid(gi, object));
	assert_int_equal(gi_set_pose(gi, object, gi_pose_identity()), GI_ERROR_INVALID_HANDLE);
	assert_int_equal(gi_get_material(gi, object, 0, &material), GI_ERROR_INVALID_HANDLE);
	assert_int_equal(gi_destroy_object(gi, object), GI_ERROR_INVALID_HANDLE);
	assert_gi(gi_get_material(gi, own, 0, &material));
	assert_float_equal(material.rho[1], .25f, 0);
	assert_int_equal(gi_get_material(gi, own, 1, &material), GI_ERROR_INVALID_ARGUMENT);
	assert_gi(gi_destroy_object(gi, own));
}

/* Two in one OpenGL context are at home there both. */
static void two_share_a_context(void **state)
{
	(void)state;
	home a = open_home();
	gi_context_def def = gi_context_def_default();
	def.get_proc_address = engine_context_find_gl;
	def.get_proc_user = a.context;
	def.message = hear;
	gi_context *second;
	gi_leaf before[LEAVES];
	read_light(&a, before);
	assert_gi(gi_context_create(&def, &second));
	expect_strange_handles_refused(second, a.floor);
	assert_gi(gi_commit(second));
	harness_update(second);
	expect_same_light(&a, before);
	gi_context_destroy(second);
	expect_same_light(&a, before);
	gi_context_destroy(a.gi);
	engine_context_destroy(a.context);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(no_context_is_current),
	    cmocka_unit_test(another_context_is_current),
	    cmocka_unit_test(the_context_is_gone),
	    cmocka_unit_test(two_share_a_context),
	};
	return cmocka_run_group_tests_name("current", tests, NULL, NULL);
}
