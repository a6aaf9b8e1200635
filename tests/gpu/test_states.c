/* Every function in every state a context can be in, twice: what gi.h says it returns there, one line with every error,
 * nothing read that is not there; and from each of them a commit and an update lead on.
 */
#include "faults.h"
#include "harness.h"

#include "scenes/shapes.h"

#include <glad/gl.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

static uint32_t messages;

static void hear(gi_result result, const char *message, void *user)
{
	(void)user;
	assert_true(result != GI_OK && message[0] && !strchr(message, '\n'));
	messages++;
}

/* ---- states ---- */

typedef struct subject {
	gi_context *gi;
	gi_object object;      /* what functions are tried on; zero: none was made */
	bool alive, committed; /* it is */
	bool any_commit;       /* there was one */
	bool updated;          /* and an update after it */
	bool any_update;       /* or before: what stays keeps its rows */
} subject;

static gi_object add(subject *s, float height)
{
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-1, height, -1}, height > 0 ? (float[]){2, 0, 0} : (float[]){0, 0, 2},
			       height > 0 ? (float[]){0, 0, 2} : (float[]){2, 0, 0}, 2, 2, &mesh));
	return harness_add(s->gi, &(harness_object){.name = "square", .rho = {.5f, .5f, .5f}, .exitance = {1, 2, 3}},
			   &mesh);
}

static void make(subject *s)
{
	s->object = add(s, 0);
	add(s, 1);
	s->alive = true;
}

static void commit(subject *s)
{
	assert_gi(gi_commit(s->gi));
	s->any_commit = true;
	s->committed = s->alive;
	s->updated = false;
}

static void update(subject *s)
{
	assert_gi(gi_update(s->gi, NULL));
	assert_gi(gi_finish(s->gi));
	s->updated = s->any_update = true;
}

static void fail_to_commit(subject *s)
{
	faults_begin(FAULT_GPU, 5, true);
	const gi_result result = gi_commit(s->gi);
	faults_end();
	assert_int_equal(result, GI_ERROR_OUT_OF_MEMORY);
}

static void nothing(subject *s)
{
	(void)s;
}

static void made(subject *s)
{
	make(s);
}

static void failed_at_first(subject *s)
{
	make(s);
	fail_to_commit(s);
}

static void committed_empty(subject *s)
{
	commit(s);
}

static void updated_empty(subject *s)
{
	commit(s);
	update(s);
}

static void committed(subject *s)
{
	make(s);
	commit(s);
}

static void committed_twice(subject *s)
{
	committed(s);
	commit(s);
}

static void updated(subject *s)
{
	committed(s);
	update(s);
}

static void updated_and_more_made(subject *s)
{
	updated(s);
	add(s, 2);
}

static void updated_and_destroyed(subject *s)
{
	updated(s);
	assert_gi(gi_destroy_object(s->gi, s->object));
	s->alive = false;
}

static void updated_and_failed(subject *s)
{
	updated_and_more_made(s);
	fail_to_commit(s);
}

static void destroyed_and_failed(subject *s)
{
	updated_and_destroyed(s);
	fail_to_commit(s);
}

static void destroyed_and_committed(subject *s)
{
	updated_and_destroyed(s);
	commit(s);
}

static void update_failed(subject *s)
{
	committed(s);
	faults_begin(FAULT_GPU, 0, true);
	const gi_result result = gi_update(s->gi, NULL);
	faults_end();
	assert_int_equal(result, GI_ERROR_OUT_OF_MEMORY);
}

/* ---- functions ---- */

#define expect(call, wanted)                                                                                           \
	do {                                                                                                           \
		messages = 0;                                                                                          \
		const gi_result got = (call), want = (wanted);                                                         \
		if (got != want || messages != (got != GI_OK))                                                         \
			fail_msg("%s, %s: %s and %u messages, not %s", name, #call, gi_result_text(got), messages,     \
				 gi_result_text(want));                                                                \
		assert_int_equal(glGetError(), GL_NO_ERROR);                                                           \
	} while (0)

static void expect_values(const subject *s, const char *name)
{
	const gi_result handle = s->alive ? GI_OK : GI_ERROR_INVALID_HANDLE;
	const gi_material material = {.rho = {.5f, .5f, .5f}, .exitance = {1, 2, 3}};
	gi_pose pose = gi_pose_identity();
	assert_true(gi_object_is_valid(s->gi, s->object) == s->alive);
	expect(gi_set_pose(s->gi, s->object, pose), handle);
	expect(gi_get_pose(s->gi, s->object, &pose), handle);
	expect(gi_set_material(s->gi, s->object, 0, material), handle);
	const gi_result argument = s->alive ? GI_ERROR_INVALID_ARGUMENT : handle;
	expect(gi_set_material(s->gi, s->object, 1, material), argument);
	gi_textures textures = gi_textures_default(); /* without coordinates */
	expect(gi_set_textures(s->gi, s->object, 0, &textures), argument);
	expect(gi_get_textures(s->gi, s->object, 0, &textures), argument);
}

static void expect_reading(const subject *s, const char *name)
{
	gi_leaf leaves[64];
	gi_entry entries[4096];
	gi_link links[4096];
	uint32_t leaf_count = 99;
	uint64_t entry_count = 99, link_count = 99;
	double f = -1;
	expect(gi_read_leaves(s->gi, leaves, 64, &leaf_count), GI_OK);
	expect(gi_read_entries(s->gi, entries, 4096, &entry_count), GI_OK);
	expect(gi_read_links(s->gi, links, 4096, &link_count), GI_OK);
	assert_true(leaf_count <= 64 && entry_count <= 4096 && link_count <= 4096);
	assert_true(s->any_commit || leaf_count == 0);
	if (!s->any_update)
		assert_true(entry_count == 0 && link_count == 0);
	for (uint32_t k = 0; k < leaf_count; k++)
		for (int c = 0; c < 3; c++)
			assert_true(isfinite(leaves[k].irradiance[c]) && leaves[k].radiosity[c] >= 1 &&
				    fabsf(leaves[k].corners[c][0]) <= 1 && leaves[k].area == 1);
	const gi_result known = s->alive && s->committed ? GI_OK : GI_ERROR_INVALID_HANDLE;
	expect(gi_form_factor(s->gi, s->object, s->object, &f), known);
	expect(gi_form_factor(s->gi, s->object, (gi_object){0}, &f), known);
	expect(gi_form_factors(s->gi, s->object, &s->object, 0, &f), known);
}

static void expect_pictures(const subject *s, const char *name)
{
	const gi_result drawn = s->any_commit ? GI_OK : GI_ERROR_NOT_COMMITTED;
	gi_view view = gi_view_default();
	gi_buffers buffers;
	view.width = view.height = 4;
	for (int mode = GI_MODE_GLOBAL; mode <= GI_MODE_INDIRECT; mode++) {
		view.mode = (gi_mode)mode;
		expect(gi_draw(s->gi, &view), drawn);
	}
	view.mode = GI_MODE_GLOBAL;
	for (int overlay = GI_OVERLAY_WIREFRAME; overlay <= GI_OVERLAY_BLOCKERS; overlay++) {
		view.overlay = (gi_overlay)overlay;
		expect(gi_draw(s->gi, &view), drawn);
	}
	expect(gi_get_buffers(s->gi, &buffers), drawn);
}

static void expect_frames(const subject *s, const char *name)
{
	const gi_path_options few = {.paths = 2, .seed = 1};
	float irradiance[3 * 64];
	uint32_t count = 99;
	gi_report report;
	expect(gi_finish(s->gi), GI_OK);
	expect(gi_get_report(s->gi, &report), GI_OK);
	assert_true(isfinite(report.solve_bound) && isfinite(report.sampling_squared));
	const bool traced = s->updated;
	expect(gi_trace_paths(s->gi, &few, irradiance, 64, &count), traced ? GI_OK : GI_ERROR_NOT_COMMITTED);
	assert_true(traced || count == 0);
}

static void expect_updates(subject *s, const char *name)
{
	const gi_result result = s->any_commit ? GI_OK : GI_ERROR_NOT_COMMITTED;
	expect(gi_update(s->gi, NULL), result);
	gi_invalidate(s->gi);
	gi_reset_radiosity(s->gi);
	expect(gi_update(s->gi, &(gi_budget){.rays = 10}), result);
	expect(gi_update(s->gi, &(gi_budget){.ms = 1}), result);
}

static void (*const states[])(subject *s) = {nothing,
					     made,
					     failed_at_first,
					     committed_empty,
					     updated_empty,
					     committed,
					     committed_twice,
					     updated,
					     updated_and_more_made,
					     updated_and_destroyed,
					     updated_and_failed,
					     destroyed_and_failed,
					     destroyed_and_committed,
					     update_failed};
static const char *const names[] = {"nothing",
				    "made",
				    "failed at first",
				    "committed empty",
				    "updated empty",
				    "committed",
				    "committed twice",
				    "updated",
				    "updated and more made",
				    "updated and destroyed",
				    "updated and failed",
				    "destroyed and failed",
				    "destroyed and committed",
				    "update failed"};
enum { STATES = sizeof states / sizeof *states };
_Static_assert(sizeof names / sizeof *names == STATES, "a name each");

static subject enter(int state)
{
	gi_context_def def = harness_def();
	def.message = hear;
	def.row_tolerance = .1f;
	def.estimate_leaves = 4;
	faults_in(&def);
	subject s = {.gi = harness_context(&def)};
	states[state](&s);
	return s;
}

static GLuint make_framebuffer(GLuint buffers[2])
{
	GLuint framebuffer;
	glCreateRenderbuffers(2, buffers);
	glNamedRenderbufferStorage(buffers[0], GL_RGBA32F, 4, 4);
	glNamedRenderbufferStorage(buffers[1], GL_DEPTH_COMPONENT32F, 4, 4);
	glCreateFramebuffers(1, &framebuffer);
	glNamedFramebufferRenderbuffer(framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffers[0]);
	glNamedFramebufferRenderbuffer(framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, buffers[1]);
	glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
	return framebuffer;
}

static void every_function_in_every_state(void **state)
{
	(void)state;
	for (int k = 0; k < STATES; k++) {
		const char *name = names[k];
		subject s = enter(k);
		GLuint buffers[2];
		const GLuint framebuffer = make_framebuffer(buffers);
		for (int twice = 0; twice < 2; twice++) {
			expect_values(&s, name);
			expect_reading(&s, name);
			expect_pictures(&s, name);
			expect_frames(&s, name);
		}
		expect_updates(&s, name);
		expect(gi_destroy_object(s.gi, s.object), s.alive ? GI_OK : GI_ERROR_INVALID_HANDLE);
		expect(gi_destroy_object(s.gi, s.object), GI_ERROR_INVALID_HANDLE);
		s.alive = false;
		make(&s);
		commit(&s);
		update(&s);
		expect_reading(&s, name);
		expect_frames(&s, name);
		glDeleteFramebuffers(1, &framebuffer);
		glDeleteRenderbuffers(2, buffers);
		gi_context_destroy(s.gi);
	}
	printf("  %d states\n", STATES);
}

/* Each state is also one that a context may be destroyed in. */
static void contexts_end_in_every_state(void **state)
{
	(void)state;
	for (int k = 0; k < STATES; k++) {
		messages = 0;
		gi_context_destroy(enter(k).gi);
		assert_int_equal(glGetError(), GL_NO_ERROR);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(every_function_in_every_state),
	    cmocka_unit_test(contexts_end_in_every_state),
	};
	return cmocka_run_group_tests_name("states", tests, harness_open, harness_close);
}
