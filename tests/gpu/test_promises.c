/* What gi.h says of the calls themselves: which figures a report has, what is there before the first update, what is
 * copied, what a default gives way to, and that a message is one line.
 */
#define _POSIX_C_SOURCE 200809L
#include "harness.h"

#include "scenes/shapes.h"

#include <glad/gl.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static gi_context_def coarse_def(void)
{
	gi_context_def def = harness_def();
	def.row_tolerance = .1f;
	return def;
}

static gi_object add_floor(gi_context *gi, const char *name)
{
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-1, 0, -1}, (float[]){0, 0, 2}, (float[]){2, 0, 0}, 2, 2, &mesh));
	return harness_add(gi, &(harness_object){.name = name, .rho = {.5f, .6f, .7f}}, &mesh);
}

static gi_object add_light(gi_context *gi)
{
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-.5f, 2, -.5f}, (float[]){1, 0, 0}, (float[]){0, 0, 1}, 1, 1, &mesh));
	return harness_add(gi, &(harness_object){.name = "light", .exitance = {10, 10, 10}}, &mesh);
}

/* ---- reports ---- */

static gi_report report_of(gi_context *gi)
{
	gi_report r;
	assert_gi(gi_finish(gi));
	assert_gi(gi_get_report(gi, &r));
	return r;
}

static void expect_passes(const gi_report *r, uint32_t ran, const char *when)
{
	for (int k = 0; k < GI_PASS_COUNT; k++)
		if ((r->pass_ms[k] > 0) != (ran >> k & 1))
			fail_msg("%s: the pass %s has %g ms", when, gi_pass_name((gi_pass)k), (double)r->pass_ms[k]);
}

static void move(gi_context *gi, gi_object object, float x)
{
	assert_gi(gi_set_pose(gi, object, (gi_pose){{x, 2, 0}, {0, 0, 0, 1}}));
}

static void draw(gi_context *gi, gi_mode mode, GLuint framebuffer)
{
	gi_view view = gi_view_default();
	view.width = view.height = 8;
	view.mode = mode;
	const float far = 1;
	glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
	glClearBufferfv(GL_DEPTH, 0, &far);
	assert_gi(gi_draw(gi, &view));
}

static GLuint make_framebuffer(GLuint buffers[2])
{
	GLuint framebuffer;
	glCreateRenderbuffers(2, buffers);
	glNamedRenderbufferStorage(buffers[0], GL_RGBA32F, 8, 8);
	glNamedRenderbufferStorage(buffers[1], GL_DEPTH_COMPONENT32F, 8, 8);
	glCreateFramebuffers(1, &framebuffer);
	glNamedFramebufferRenderbuffer(framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffers[0]);
	glNamedFramebufferRenderbuffer(framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, buffers[1]);
	return framebuffer;
}

/* On a software renderer a clock measures passes; named otherwise, it is asked as a GPU is, whose times come later. */
static gi_get_proc_address_fn *real_get_proc_address;
static PFNGLGETSTRINGPROC real_get_string;

static const GLubyte *get_string(GLenum name)
{
	return name == GL_RENDERER ? (const GLubyte *)"some GPU" : real_get_string(name);
}

static gi_proc get_proc_address(const char *name, void *user)
{
	const gi_proc real = real_get_proc_address(name, user);
	if (strcmp(name, "glGetString") != 0)
		return real;
	real_get_string = (PFNGLGETSTRINGPROC)real;
	return (gi_proc)get_string;
}

static void expect_times_of_what_ran(const gi_context_def *def)
{
	enum {
		SHADOWS = 1u << GI_PASS_SHADOW,
		DRAWN = 1u << GI_PASS_DRAW,
		SOLVED = 1u << GI_PASS_SOLVE | 1u << GI_PASS_LIGHT,
		BUILT = SOLVED | 1u << GI_PASS_POSE | 1u << GI_PASS_CUT | 1u << GI_PASS_FACTOR | 1u << GI_PASS_TRACE |
			1u << GI_PASS_CLOSE,
		UPDATED = BUILT | 1u << GI_PASS_FLAG,
		BUDGETED = UPDATED | 1u << GI_PASS_CHOOSE
	};
	gi_context *gi = harness_context(def);
	GLuint buffers[2];
	const GLuint framebuffer = make_framebuffer(buffers);
	add_floor(gi, "floor");
	const gi_object light = add_light(gi);
	assert_gi(gi_commit(gi));
	const gi_budget budget = {.rays = 1000000};
	gi_report r = harness_update(gi);
	expect_passes(&r, BUILT, "the first update");
	move(gi, light, .1f);
	assert_gi(gi_update(gi, &budget));
	draw(gi, GI_MODE_GLOBAL, framebuffer);
	r = report_of(gi);
	expect_passes(&r, BUDGETED | SHADOWS | DRAWN, "an update under a budget, and a picture");
	move(gi, light, .2f);
	r = harness_update(gi);
	expect_passes(&r, UPDATED | SHADOWS | DRAWN, "an exact one after it");
	draw(gi, GI_MODE_INDIRECT, framebuffer);
	r = report_of(gi);
	expect_passes(&r, UPDATED | DRAWN, "a picture without shadows");
	r = harness_update(gi);
	assert_int_equal(r.outcome, GI_OUTCOME_AT_REST);
	expect_passes(&r, DRAWN, "an update at rest");
	gi_reset_radiosity(gi);
	r = harness_update(gi);
	expect_passes(&r, SOLVED | DRAWN, "a solve alone");
	gi_invalidate(gi);
	r = harness_update(gi);
	expect_passes(&r, BUILT | DRAWN, "a rebuild");
	glDeleteFramebuffers(1, &framebuffer);
	glDeleteRenderbuffers(2, buffers);
	gi_context_destroy(gi);
}

static void passes_that_did_not_run_have_no_time(void **state)
{
	(void)state;
	gi_context_def def = coarse_def();
	expect_times_of_what_ran(&def);
	real_get_proc_address = def.get_proc_address;
	def.get_proc_address = get_proc_address;
	expect_times_of_what_ran(&def);
}

/* ---- before the first update ---- */

/* Where the leaves will be, what they will start from; and the same places once they are computed. */
static void leaves_are_where_they_were_committed(void **state)
{
	(void)state;
	enum { LEAVES = 5 };
	const gi_context_def def = coarse_def();
	gi_context *gi = harness_context(&def);
	const gi_object floor = add_floor(gi, "floor");
	add_light(gi);
	const gi_pose pose = {{3, -2, 7}, {.5f, .5f, -.5f, .5f}};
	assert_gi(gi_set_pose(gi, floor, pose));
	assert_gi(gi_commit(gi));
	gi_leaf early[LEAVES], late[LEAVES];
	uint32_t count;
	assert_gi(gi_read_leaves(gi, early, LEAVES, &count));
	assert_int_equal(count, LEAVES);
	/* Set after the commit: takes effect with the update. */
	assert_gi(gi_set_pose(gi, floor, gi_pose_identity()));
	gi_leaf still[LEAVES];
	assert_gi(gi_read_leaves(gi, still, LEAVES, &count));
	assert_memory_equal(early, still, sizeof early);
	assert_gi(gi_set_pose(gi, floor, pose));
	harness_update(gi);
	assert_gi(gi_read_leaves(gi, late, LEAVES, &count));
	double farthest = 0, extent = 0;
	for (int k = 0; k < LEAVES; k++) {
		for (int c = 0; c < 12; c++) {
			const double d =
			    fabs((double)early[k].corners[c / 3][c % 3] - (double)late[k].corners[c / 3][c % 3]);
			farthest = fmax(farthest, d);
			extent = fmax(extent, fabs((double)late[k].corners[c / 3][c % 3]));
		}
		assert_true(early[k].area == late[k].area && early[k].object.index1 == late[k].object.index1);
		assert_memory_equal(early[k].radiosity, early[k].exitance, sizeof early[k].exitance);
		assert_true(early[k].row_sum == 0 && early[k].irradiance[0] == 0);
	}
	printf("  corners before the first update: within %.1e of %.0f m\n", farthest, extent);
	assert_true(extent > 5 && farthest <= 1e-6 * extent);
	gi_context_destroy(gi);
}

static void buffers_come_with_a_commit(void **state)
{
	(void)state;
	const gi_context_def def = coarse_def();
	gi_context *gi = harness_context(&def);
	gi_buffers buffers;
	assert_int_equal(gi_get_buffers(gi, &buffers), GI_ERROR_NOT_COMMITTED);
	add_light(gi);
	assert_int_equal(gi_get_buffers(gi, &buffers), GI_ERROR_NOT_COMMITTED);
	assert_gi(gi_commit(gi));
	assert_gi(gi_get_buffers(gi, &buffers));
	assert_true(buffers.leaf_radiosity && buffers.leaf_indirect && buffers.light_indirect);
	gi_context_destroy(gi);
}

/* ---- copies ---- */

/* Shaders that are wanted later come from the folder that was named, whatever became of the name. */
static void definitions_are_copied(void **state)
{
	(void)state;
	char folder[] = RELUME_SOURCE_DIR "/shaders", name[] = "floor";
	float positions[12] = {0, 0, 0, 0, 0, 1, 1, 0, 1, 1, 0, 0};
	uint32_t indices[4] = {0, 1, 2, 3}, counts[1] = {4}, materials[1] = {0};
	gi_material material = {.rho = {.5f, .5f, .5f}, .exitance = {1, 1, 1}};
	gi_context_def def = coarse_def();
	def.shader_directory = folder;
	gi_context *gi = harness_context(&def);
	memset(folder, 'x', sizeof folder - 1);
	gi_object_def object_def = gi_object_def_default();
	object_def.name = name;
	object_def.positions = positions;
	object_def.vertex_count = 4;
	object_def.indices = indices;
	object_def.index_count = 4;
	object_def.face_counts = counts;
	object_def.face_materials = materials;
	object_def.face_count = 1;
	object_def.materials = &material;
	object_def.material_count = 1;
	gi_object object;
	assert_gi(gi_create_object(gi, &object_def, &object));
	memset(name, 'x', sizeof name - 1);
	memset(positions, 0xFF, sizeof positions);
	memset(indices, 0xFF, sizeof indices);
	memset(counts, 0xFF, sizeof counts);
	memset(materials, 0xFF, sizeof materials);
	memset(&material, 0xFF, sizeof material);
	memset(&object_def, 0xFF, sizeof object_def);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	assert_gi(gi_set_pose(gi, object, (gi_pose){{0, 1, 0}, {0, 0, 0, 1}}));
	assert_gi(gi_update(gi, &(gi_budget){.rays = 100})); /* its shaders are read now */
	gi_leaf leaf;
	uint32_t count;
	assert_gi(gi_read_leaves(gi, &leaf, 1, &count));
	assert_true(count == 1 && leaf.area == 1 && leaf.rho[0] == .5f && leaf.exitance[2] == 1);
	assert_int_equal(gi_set_material(gi, object, 7, (gi_material){0}), GI_ERROR_INVALID_ARGUMENT);
	assert_non_null(strstr(harness_last_message(), "'floor'"));
	gi_context_destroy(gi);
}

/* ---- defaults that give way ---- */

static gi_result create_smooth(gi_context *gi, uint32_t corners, uint32_t levels, gi_object *object)
{
	float positions[3 * 8];
	uint32_t indices[8];
	for (uint32_t k = 0; k < corners; k++) {
		const double angle = 2 * 3.14159265 * k / corners;
		indices[k] = k;
		positions[3 * k] = (float)cos(angle);
		positions[3 * k + 1] = 0;
		positions[3 * k + 2] = (float)-sin(angle);
	}
	gi_object_def def = gi_object_def_default();
	def.positions = positions;
	def.vertex_count = corners;
	def.indices = indices;
	def.index_count = corners;
	def.face_counts = &corners;
	def.face_count = 1;
	def.scheme = GI_SCHEME_CATMULL_CLARK;
	def.levels = levels;
	return gi_create_object(gi, &def, object);
}

/* Drawn finer than their leaves as far as that goes; with no step left, as their leaves. */
static void fine_smooth_cages_are_made(void **state)
{
	(void)state;
	const gi_context_def def = coarse_def();
	gi_context *gi = harness_context(&def);
	for (uint32_t corners = 3; corners <= 5; corners++)
		for (uint32_t levels = 6; levels <= 8; levels++) {
			gi_object object;
			if (create_smooth(gi, corners, levels, &object))
				fail_msg("%u corners, level %u: %s", corners, levels, harness_last_message());
			assert_gi(gi_destroy_object(gi, object));
		}
	gi_context_destroy(gi);
}

/* ---- views ---- */

static void expect_bad_view(gi_context *gi, const gi_view *view)
{
	assert_int_equal(gi_draw(gi, view), GI_ERROR_INVALID_ARGUMENT);
	assert_non_null(strstr(harness_last_message(), "gi_draw: "));
	assert_int_equal(glGetError(), GL_NO_ERROR);
}

static void views_are_checked(void **state)
{
	(void)state;
	const gi_context_def def = coarse_def();
	gi_context *gi = harness_context(&def);
	GLuint buffers[2];
	const GLuint framebuffer = make_framebuffer(buffers);
	add_floor(gi, "floor");
	add_light(gi);
	assert_gi(gi_commit(gi));
	static const uint32_t sizes[] = {0, 1u << 20, 0x7FFFFFFFu, 0xFFFFFFFFu};
	for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
		gi_view view = gi_view_default();
		view.width = sizes[k];
		expect_bad_view(gi, &view);
		view.width = 8;
		view.height = sizes[k];
		expect_bad_view(gi, &view);
	}
	for (int k = 0; k < 32; k++) {
		gi_view view = gi_view_default();
		(k < 16 ? view.view_from_world : view.clip_from_view)[k % 16] = k % 2 ? NAN : INFINITY;
		expect_bad_view(gi, &view);
	}
	gi_view view = gi_view_default();
	view.mode = (gi_mode)3;
	expect_bad_view(gi, &view);
	view = gi_view_default();
	view.overlay = (gi_overlay)-1;
	expect_bad_view(gi, &view);
	/* All zero is a picture of nothing. */
	view = gi_view_default();
	memset(view.clip_from_view, 0, sizeof view.clip_from_view);
	view.width = view.height = 8;
	glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
	assert_gi(gi_draw(gi, &view));
	glDeleteFramebuffers(1, &framebuffer);
	glDeleteRenderbuffers(2, buffers);
	gi_context_destroy(gi);
}

/* ---- messages ---- */

static void messages_are_one_line(void **state)
{
	(void)state;
	char lengthy[4096];
	memset(lengthy, 'n', sizeof lengthy - 1);
	lengthy[sizeof lengthy - 1] = '\0';
	for (int k = 0; k + 1 < 200; k += 2)
		memcpy(lengthy + k, "\xc3\xa9", 2); /* e acute, so that the cut must not part one */
	const char *const names[] = {"two\nlines", "a\r\n\tb\v\f\x1b[2J\x7f", "", lengthy, lengthy + 1};
	const gi_context_def def = coarse_def();
	gi_context *gi = harness_context(&def);
	for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
		const gi_object object = add_floor(gi, names[k]);
		assert_int_equal(gi_set_material(gi, object, 7, (gi_material){0}), GI_ERROR_INVALID_ARGUMENT);
		const char *message = harness_last_message();
		for (const char *c = message; *c; c++)
			assert_true((unsigned char)*c >= ' ' && *c != 127);
		assert_non_null(strstr(message, "there is no number 7"));
		assert_null(strstr(message, "\xc3'"));
	}
	gi_context_destroy(gi);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(passes_that_did_not_run_have_no_time),
	    cmocka_unit_test(leaves_are_where_they_were_committed),
	    cmocka_unit_test(buffers_come_with_a_commit),
	    cmocka_unit_test(definitions_are_copied),
	    cmocka_unit_test(fine_smooth_cages_are_made),
	    cmocka_unit_test(views_are_checked),
	    cmocka_unit_test(messages_are_one_line),
	};
	return cmocka_run_group_tests_name("promises", tests, harness_open, harness_close);
}
