/* What the library and its host owe each other about OpenGL's state (gi.h, Rules): whatever the host has set, pictures
 * and light are the same; afterwards nothing has changed but what is promised; the host's queries and errors are its
 * own.
 */
#include "harness.h"

#include "scenes/shapes.h"

#include <glad/gl.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 64, LEFT = 3, BOTTOM = 5, WIDTH = 80, HEIGHT = 72, LEAVES = 256 };

/* Two colours, of which the second is the host's alone. */
typedef struct target {
	GLuint framebuffer, colours[2], depth;
} target;

typedef struct picture {
	float colour[WIDTH * HEIGHT * 4], depth[WIDTH * HEIGHT];
} picture;

static target make_target(void)
{
	target t;
	const GLenum attachments[2] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
	glCreateFramebuffers(1, &t.framebuffer);
	glCreateTextures(GL_TEXTURE_2D, 2, t.colours);
	glCreateTextures(GL_TEXTURE_2D, 1, &t.depth);
	for (int k = 0; k < 2; k++) {
		glTextureStorage2D(t.colours[k], 1, GL_RGBA32F, WIDTH, HEIGHT);
		glNamedFramebufferTexture(t.framebuffer, attachments[k], t.colours[k], 0);
	}
	glTextureStorage2D(t.depth, 1, GL_DEPTH32F_STENCIL8, WIDTH, HEIGHT);
	glNamedFramebufferTexture(t.framebuffer, GL_DEPTH_STENCIL_ATTACHMENT, t.depth, 0);
	glNamedFramebufferDrawBuffers(t.framebuffer, 2, attachments);
	return t;
}

static void free_target(target *t)
{
	glDeleteFramebuffers(1, &t->framebuffer);
	glDeleteTextures(2, t->colours);
	glDeleteTextures(1, &t->depth);
}

static void clear(const target *t, float depth)
{
	const float zero[4] = {0}, kept[4] = {1, 2, 3, 4};
	glClearNamedFramebufferfv(t->framebuffer, GL_COLOR, 0, zero);
	glClearNamedFramebufferfv(t->framebuffer, GL_COLOR, 1, kept);
	glClearNamedFramebufferfi(t->framebuffer, GL_DEPTH_STENCIL, 0, depth, 0);
	glBindFramebuffer(GL_FRAMEBUFFER, t->framebuffer);
	glViewport(LEFT, BOTTOM, SIZE, SIZE);
}

static void read_picture(const target *t, picture *out)
{
	static float other[WIDTH * HEIGHT * 4];
	glGetTextureImage(t->colours[0], 0, GL_RGBA, GL_FLOAT, sizeof out->colour, out->colour);
	glGetTextureImage(t->depth, 0, GL_DEPTH_COMPONENT, GL_FLOAT, sizeof out->depth, out->depth);
	glGetTextureImage(t->colours[1], 0, GL_RGBA, GL_FLOAT, sizeof other, other);
	for (int k = 0; k < WIDTH * HEIGHT * 4; k++)
		if (other[k] != (float)(k % 4 + 1))
			fail_msg("the host's second colour was drawn into: %g", (double)other[k]);
}

static gi_object add_scene(gi_context *gi)
{
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-2, 0, -2}, (float[]){0, 0, 4}, (float[]){4, 0, 0}, 8, 8, &mesh));
	harness_add(gi, &(harness_object){.name = "floor", .rho = {.8f, .7f, .6f}}, &mesh);
	for (int k = 0; k < 2; k++) {
		const float corner[3] = {-.8f + (float)k, 2, -.2f - .3f * (float)k};
		assert_true(shape_quad(corner, (float[]){.5f, 0, 0}, (float[]){0, 0, .4f}, 2, 2, &mesh));
		harness_add(gi, &(harness_object){.name = "lamp", .exitance = {10, 8, 6}}, &mesh);
	}
	assert_true(shape_box((float[]){-.3f, -.3f, -.3f}, (float[]){.3f, .3f, .3f}, 2, false, &mesh));
	return harness_add(gi, &(harness_object){.name = "box", .rho = {.5f, .5f, .5f}, .position = {.6f, .7f, -.4f}},
			   &mesh);
}

/* From above and aside, in perspective: distances from 1 to 20 m. */
static gi_view look(void)
{
	gi_view view = gi_view_default();
	const float c = .8f, s = .6f, near = 1, far = 20;
	const float world[16] = {1, 0, 0, 0, 0, c, s, 0, 0, -s, c, 0, 0, 0, -5, 1};
	const float clip[16] = {
	    2, 0, 0, 0, 0, 2, 0, 0, 0, 0, -(far + near) / (far - near), -1, 0, 0, -2 * far * near / (far - near), 0};
	memcpy(view.view_from_world, world, sizeof world);
	memcpy(view.clip_from_view, clip, sizeof clip);
	view.width = view.height = SIZE;
	return view;
}

/* ---- state on entry ---- */

static void set_hostile_state(GLuint sampler)
{
	static const GLenum on[] = {GL_PRIMITIVE_RESTART,   GL_RASTERIZER_DISCARD,
				    GL_STENCIL_TEST,        GL_FRAMEBUFFER_SRGB,
				    GL_SCISSOR_TEST,        GL_BLEND,
				    GL_POLYGON_OFFSET_FILL, GL_DEPTH_CLAMP,
				    GL_COLOR_LOGIC_OP,      GL_SAMPLE_ALPHA_TO_COVERAGE,
				    GL_SAMPLE_COVERAGE,     GL_SAMPLE_MASK,
				    GL_CLIP_DISTANCE0,      GL_CLIP_DISTANCE0 + 5,
				    GL_LINE_SMOOTH,         GL_CULL_FACE};
	for (size_t k = 0; k < sizeof on / sizeof *on; k++)
		glEnable(on[k]);
	glPrimitiveRestartIndex(2);
	glDisable(GL_DEPTH_TEST);
	glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
	glDepthRange(1, 0);
	glDepthFunc(GL_GREATER);
	glDepthMask(GL_FALSE);
	glClearDepth(0);
	glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
	glPolygonOffset(100, 1000);
	glStencilFunc(GL_NEVER, 1, 0xff);
	glStencilOp(GL_INCR, GL_INCR, GL_INCR);
	glScissor(1, 1, 1, 1);
	glColorMaski(0, GL_FALSE, GL_TRUE, GL_FALSE, GL_TRUE);
	glColorMaski(1, GL_TRUE, GL_FALSE, GL_TRUE, GL_TRUE);
	glBlendEquationSeparate(GL_FUNC_REVERSE_SUBTRACT, GL_MAX);
	glBlendFuncSeparate(GL_ZERO, GL_ONE, GL_DST_COLOR, GL_ZERO);
	glLogicOp(GL_CLEAR);
	glSampleCoverage(0, GL_TRUE);
	glSampleMaski(0, 0);
	glCullFace(GL_FRONT_AND_BACK);
	glFrontFace(GL_CW);
	glProvokingVertex(GL_FIRST_VERTEX_CONVENTION);
	glPixelStorei(GL_PACK_ROW_LENGTH, 7);
	glPixelStorei(GL_UNPACK_SWAP_BYTES, GL_TRUE);
	glActiveTexture(GL_TEXTURE0 + 50);
	for (GLuint unit = 0; unit < 64; unit++)
		glBindSampler(unit, sampler);
}

static void set_ordinary_state(void)
{
	static const GLenum off[] = {GL_PRIMITIVE_RESTART,   GL_RASTERIZER_DISCARD,
				     GL_STENCIL_TEST,        GL_FRAMEBUFFER_SRGB,
				     GL_SCISSOR_TEST,        GL_BLEND,
				     GL_POLYGON_OFFSET_FILL, GL_DEPTH_CLAMP,
				     GL_COLOR_LOGIC_OP,      GL_SAMPLE_ALPHA_TO_COVERAGE,
				     GL_SAMPLE_COVERAGE,     GL_SAMPLE_MASK,
				     GL_CLIP_DISTANCE0,      GL_CLIP_DISTANCE0 + 5,
				     GL_LINE_SMOOTH,         GL_CULL_FACE,
				     GL_DEPTH_TEST};
	for (size_t k = 0; k < sizeof off / sizeof *off; k++)
		glDisable(off[k]);
	glPrimitiveRestartIndex(0);
	glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
	glDepthRange(0, 1);
	glDepthFunc(GL_LESS);
	glDepthMask(GL_TRUE);
	glClearDepth(1);
	glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
	glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
	glBlendEquation(GL_FUNC_ADD);
	glBlendFunc(GL_ONE, GL_ZERO);
	glSampleMaski(0, ~0u);
	glCullFace(GL_BACK);
	glFrontFace(GL_CCW);
	glProvokingVertex(GL_LAST_VERTEX_CONVENTION);
	glPixelStorei(GL_PACK_ROW_LENGTH, 0);
	glPixelStorei(GL_UNPACK_SWAP_BYTES, GL_FALSE);
	glActiveTexture(GL_TEXTURE0);
	for (GLuint unit = 0; unit < 64; unit++)
		glBindSampler(unit, 0);
}

/* ---- state on exit ---- */

/* Everything that OpenGL tells of a value or four by one name; of the promised list nothing. */
static const GLenum STATE[] = {GL_DRAW_FRAMEBUFFER_BINDING,
			       GL_READ_FRAMEBUFFER_BINDING,
			       GL_RENDERBUFFER_BINDING,
			       GL_ARRAY_BUFFER_BINDING,
			       GL_COPY_READ_BUFFER_BINDING,
			       GL_COPY_WRITE_BUFFER_BINDING,
			       GL_PIXEL_PACK_BUFFER_BINDING,
			       GL_PIXEL_UNPACK_BUFFER_BINDING,
			       GL_SHADER_STORAGE_BUFFER_BINDING,
			       GL_UNIFORM_BUFFER_BINDING,
			       GL_ATOMIC_COUNTER_BUFFER_BINDING,
			       GL_TRANSFORM_FEEDBACK_BUFFER_BINDING,
			       GL_DRAW_INDIRECT_BUFFER_BINDING,
			       GL_TEXTURE_BUFFER_BINDING,
			       GL_PROGRAM_PIPELINE_BINDING,
			       GL_TRANSFORM_FEEDBACK_BINDING,
			       GL_ACTIVE_TEXTURE,
			       GL_VIEWPORT,
			       GL_SCISSOR_BOX,
			       GL_SCISSOR_TEST,
			       GL_DEPTH_TEST,
			       GL_DEPTH_FUNC,
			       GL_DEPTH_WRITEMASK,
			       GL_DEPTH_CLAMP,
			       GL_CULL_FACE,
			       GL_CULL_FACE_MODE,
			       GL_FRONT_FACE,
			       GL_BLEND,
			       GL_BLEND_SRC_RGB,
			       GL_BLEND_DST_RGB,
			       GL_BLEND_SRC_ALPHA,
			       GL_BLEND_DST_ALPHA,
			       GL_BLEND_EQUATION_RGB,
			       GL_BLEND_EQUATION_ALPHA,
			       GL_COLOR_LOGIC_OP,
			       GL_LOGIC_OP_MODE,
			       GL_STENCIL_TEST,
			       GL_STENCIL_FUNC,
			       GL_STENCIL_REF,
			       GL_STENCIL_WRITEMASK,
			       GL_STENCIL_BACK_FUNC,
			       GL_POLYGON_OFFSET_FILL,
			       GL_POLYGON_SMOOTH,
			       GL_LINE_SMOOTH,
			       GL_PRIMITIVE_RESTART,
			       GL_PRIMITIVE_RESTART_INDEX,
			       GL_PRIMITIVE_RESTART_FIXED_INDEX,
			       GL_RASTERIZER_DISCARD,
			       GL_PROVOKING_VERTEX,
			       GL_CLIP_ORIGIN,
			       GL_CLIP_DEPTH_MODE,
			       GL_SAMPLE_ALPHA_TO_COVERAGE,
			       GL_SAMPLE_ALPHA_TO_ONE,
			       GL_SAMPLE_COVERAGE,
			       GL_SAMPLE_COVERAGE_INVERT,
			       GL_SAMPLE_MASK,
			       GL_FRAMEBUFFER_SRGB,
			       GL_DITHER,
			       GL_MULTISAMPLE,
			       GL_PACK_ROW_LENGTH,
			       GL_PACK_ALIGNMENT,
			       GL_UNPACK_SWAP_BYTES,
			       GL_UNPACK_ALIGNMENT,
			       GL_PATCH_VERTICES,
			       GL_DRAW_BUFFER0,
			       GL_DRAW_BUFFER1,
			       GL_READ_BUFFER};
enum { STATES = sizeof STATE / sizeof *STATE, MORE_BINDINGS = 8 };

typedef struct snapshot {
	GLint values[STATES][4], masks[8][4], blends[8], clips[8], units[20], unit_samplers[20], polygon_mode[2];
	GLint storage[MORE_BINDINGS], uniforms[MORE_BINDINGS], boxes[16][4], scissors[16];
	GLfloat viewports[16][4], clear_depth, offset[2], line_width;
	GLdouble ranges[16][2];
} snapshot;

static void take_snapshot(snapshot *s)
{
	memset(s, 0, sizeof *s);
	for (int k = 0; k < STATES; k++)
		glGetIntegerv(STATE[k], s->values[k]);
	for (GLuint k = 0; k < 8; k++) {
		glGetIntegeri_v(GL_COLOR_WRITEMASK, k, s->masks[k]);
		s->blends[k] = glIsEnabledi(GL_BLEND, k);
		s->clips[k] = glIsEnabled(GL_CLIP_DISTANCE0 + k);
	}
	for (GLuint k = 0; k < 16; k++) {
		glGetIntegeri_v(GL_SCISSOR_BOX, k, s->boxes[k]);
		glGetFloati_v(GL_VIEWPORT, k, s->viewports[k]);
		glGetDoublei_v(GL_DEPTH_RANGE, k, s->ranges[k]);
		s->scissors[k] = glIsEnabledi(GL_SCISSOR_TEST, k);
	}
	for (GLuint k = 0; k < 20; k++) {
		glGetIntegeri_v(GL_TEXTURE_BINDING_2D, 44 + k, &s->units[k]);
		glGetIntegeri_v(GL_SAMPLER_BINDING, 44 + k, &s->unit_samplers[k]);
	}
	for (GLuint k = 0; k < MORE_BINDINGS; k++) {
		glGetIntegeri_v(GL_SHADER_STORAGE_BUFFER_BINDING, 37 + k, &s->storage[k]);
		glGetIntegeri_v(GL_UNIFORM_BUFFER_BINDING, 2 + k, &s->uniforms[k]);
	}
	glGetIntegerv(GL_POLYGON_MODE, s->polygon_mode);
	glGetFloatv(GL_DEPTH_CLEAR_VALUE, &s->clear_depth);
	glGetFloatv(GL_POLYGON_OFFSET_FACTOR, &s->offset[0]);
	glGetFloatv(GL_POLYGON_OFFSET_UNITS, &s->offset[1]);
	glGetFloatv(GL_LINE_WIDTH, &s->line_width);
	while (glGetError() != GL_NO_ERROR)
		; /* a driver that lacks some of the names */
}

static void expect_same_state(const snapshot *before, const char *when)
{
	static snapshot after;
	take_snapshot(&after);
	for (int k = 0; k < STATES; k++)
		if (memcmp(before->values[k], after.values[k], sizeof after.values[k]))
			fail_msg("%s: state 0x%04x was %d and is %d", when, STATE[k], before->values[k][0],
				 after.values[k][0]);
	if (memcmp(before, &after, sizeof after))
		fail_msg("%s: state by index or of several values has changed", when);
}

/* A frame in which all is done: a mover, an update, the kinds of pictures, values read back. */
static void do_all(gi_context *gi, gi_object box, float x, gi_view view)
{
	gi_report report;
	uint64_t count;
	assert_gi(gi_set_pose(gi, box, (gi_pose){{x, .7f, -.4f}, {0, 0, 0, 1}}));
	assert_gi(gi_update(gi, NULL));
	for (int mode = 0; mode < 3; mode++)
		for (int overlay = 0; overlay <= GI_OVERLAY_RECEIVERS; overlay++) {
			view.mode = (gi_mode)mode;
			view.overlay = (gi_overlay)overlay;
			assert_gi(gi_draw(gi, &view));
		}
	assert_gi(gi_get_report(gi, &report));
	assert_gi(gi_read_entries(gi, NULL, 0, &count));
}

static void read_light(gi_context *gi, gi_leaf leaves[LEAVES])
{
	uint32_t count;
	memset(leaves, 0, LEAVES * sizeof *leaves);
	assert_gi(gi_read_leaves(gi, leaves, LEAVES, &count));
	assert_in_range(count, 64, LEAVES);
	for (uint32_t k = 0; k < count; k++)
		leaves[k].object.context = 0; /* two contexts are compared */
}

static void expect_same_picture(const picture *a, const picture *b)
{
	for (int k = 0; k < WIDTH * HEIGHT; k++)
		if (memcmp(a->colour + 4 * k, b->colour + 4 * k, 4 * sizeof(float)) || a->depth[k] != b->depth[k])
			fail_msg("pixel %d %d: %g %g %g %g at depth %g, expected %g %g %g %g at %g", k % WIDTH,
				 k / WIDTH, (double)b->colour[4 * k], (double)b->colour[4 * k + 1],
				 (double)b->colour[4 * k + 2], (double)b->colour[4 * k + 3], (double)b->depth[k],
				 (double)a->colour[4 * k], (double)a->colour[4 * k + 1], (double)a->colour[4 * k + 2],
				 (double)a->colour[4 * k + 3], (double)a->depth[k]);
}

static void hostile_state_changes_nothing(void **state)
{
	(void)state;
	harness_require_context();
	static picture plain, hostile;
	static gi_leaf light[2][LEAVES];
	static snapshot before;
	const gi_context_def def = harness_def();
	target t = make_target();
	GLuint sampler, buffers[2];
	glCreateSamplers(1, &sampler);
	glSamplerParameteri(sampler, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
	glCreateBuffers(2, buffers);
	const gi_view view = look();
	for (int k = 0; k < 2; k++) {
		clear(&t, 1);
		if (k) {
			set_hostile_state(sampler);
			glBindBuffer(GL_SHADER_STORAGE_BUFFER, buffers[0]);
			glBindBuffer(GL_UNIFORM_BUFFER, buffers[1]);
			take_snapshot(&before);
		}
		gi_context *gi = harness_context(&def);
		const gi_object box = add_scene(gi);
		assert_gi(gi_commit(gi));
		assert_gi(gi_update(gi, NULL));
		assert_gi(gi_draw(gi, &view));
		if (k)
			expect_same_state(&before, "a first picture");
		set_ordinary_state();
		read_picture(&t, k ? &hostile : &plain);
		if (k) {
			set_hostile_state(sampler);
			glBindBuffer(GL_SHADER_STORAGE_BUFFER, buffers[0]);
			glBindBuffer(GL_UNIFORM_BUFFER, buffers[1]);
			glViewportIndexedf(0, .5f, .25f, 9.5f, 8.75f);
			take_snapshot(&before);
		}
		do_all(gi, box, .3f, view);
		read_light(gi, light[k]);
		if (k)
			expect_same_state(&before, "a frame");
		gi_context_destroy(gi);
		if (k)
			expect_same_state(&before, "gi_context_destroy");
		set_ordinary_state();
	}
	expect_same_picture(&plain, &hostile);
	assert_memory_equal(light[0], light[1], sizeof light[0]);
	float brightest = 0;
	for (int k = 0; k < WIDTH * HEIGHT * 4; k += 4)
		brightest = fmaxf(brightest, plain.colour[k]);
	assert_true(brightest > .1f);
	glDeleteBuffers(2, buffers);
	glDeleteSamplers(1, &sampler);
	free_target(&t);
}

/* ---- conventions of hosts ---- */

/* z to [0,1], near or far at 1; y turned over. */
static gi_view as_host(const gi_view *view, bool upper_left, bool zero_to_one, bool reversed)
{
	gi_view out = *view;
	out.clip_upper_left = upper_left;
	out.clip_zero_to_one = zero_to_one;
	out.depth_reversed = reversed;
	for (int column = 0; column < 4; column++) {
		float *m = out.clip_from_view + 4 * column;
		m[2] = reversed ? -m[2] : m[2];
		m[2] = zero_to_one ? .5f * (m[2] + m[3]) : m[2];
	}
	return out;
}

/* The same picture, rows turned over where y points down; depths in the host's own measure. Halves of it are covered by
 * the host's own surface at a depth between the box and the floor. */
static void check_convention(gi_context *gi, const target *t, const gi_view *view, int convention)
{
	static picture plain, got;
	const bool upper_left = convention & 1, zero_to_one = convention & 2, reversed = convention & 4;
	const gi_view as = as_host(view, upper_left, zero_to_one, reversed);
	int drawn[2] = {0};
	for (int covered = 0; covered < 2; covered++) {
		const float own = covered ? .815f : 1;
		clear(t, own);
		assert_gi(gi_draw(gi, view));
		read_picture(t, &plain);
		clear(t, reversed ? 1 - own : own);
		assert_gi(gi_draw(gi, &as));
		read_picture(t, &got);
		for (int y = 0; y < SIZE; y++)
			for (int x = 0; x < SIZE; x++) {
				const int from = (BOTTOM + y) * WIDTH + LEFT + x;
				const int to = (BOTTOM + (upper_left ? SIZE - 1 - y : y)) * WIDTH + LEFT + x;
				const float depth = reversed ? 1 - got.depth[to] : got.depth[to];
				const bool seen = plain.colour[4 * from + 3] > 0;
				drawn[covered] += seen;
				if (fabsf(depth - plain.depth[from]) > 1e-5f || seen != (got.colour[4 * to + 3] > 0))
					fail_msg("convention %d, pixel %d %d: depth %g, expected %g", convention, x, y,
						 (double)depth, (double)plain.depth[from]);
				for (int c = 0; c < 3; c++)
					if (fabsf(got.colour[4 * to + c] - plain.colour[4 * from + c]) > 1e-3f)
						fail_msg("convention %d, pixel %d %d: %g, expected %g", convention, x,
							 y, (double)got.colour[4 * to + c],
							 (double)plain.colour[4 * from + c]);
			}
	}
	print_message("convention %d: %d pixels drawn, %d behind what the host drew\n", convention, drawn[0],
		      drawn[0] - drawn[1]);
	assert_true(drawn[0] > SIZE * SIZE / 4 && drawn[1] > drawn[0] / 8 && drawn[1] < drawn[0] * 7 / 8);
}

static void hosts_have_their_conventions(void **state)
{
	(void)state;
	harness_require_context();
	const gi_context_def def = harness_def();
	target t = make_target();
	gi_context *gi = harness_context(&def);
	add_scene(gi);
	assert_gi(gi_commit(gi));
	assert_gi(gi_update(gi, NULL));
	gi_view view = look();
	for (int mode = 0; mode < 3; mode++)
		for (int convention = 0; convention < 8; convention++) {
			view.mode = (gi_mode)mode;
			check_convention(gi, &t, &view, convention);
		}
	gi_context_destroy(gi);
	free_target(&t);
}

/* ---- queries, errors, framebuffers ---- */

static gi_proc as_gpu(const char *name, void *user);
static PFNGLGETSTRINGPROC real_get_string;

static const GLubyte *get_string(GLenum name)
{
	return name == GL_RENDERER ? (const GLubyte *)"some GPU" : real_get_string(name);
}

static gi_context_def real_def;

static gi_proc as_gpu(const char *name, void *user)
{
	const gi_proc real = real_def.get_proc_address(name, user);
	if (strcmp(name, "glGetString") != 0)
		return real;
	real_get_string = (PFNGLGETSTRINGPROC)real;
	return (gi_proc)get_string;
}

/* A GPU's passes are timed by queries: a host may have one of its own around them. */
static void the_host_measures_too(void **state)
{
	(void)state;
	harness_require_context();
	gi_context_def def = real_def = harness_def();
	def.get_proc_address = as_gpu;
	target t = make_target();
	gi_context *gi = harness_context(&def);
	const gi_object box = add_scene(gi);
	assert_gi(gi_commit(gi));
	clear(&t, 1);
	GLuint query;
	GLuint64 ns = 0;
	glCreateQueries(GL_TIME_ELAPSED, 1, &query);
	glBeginQuery(GL_TIME_ELAPSED, query);
	do_all(gi, box, .2f, look());
	glEndQuery(GL_TIME_ELAPSED);
	assert_int_equal(glGetError(), GL_NO_ERROR);
	glGetQueryObjectui64v(query, GL_QUERY_RESULT, &ns);
	assert_true(ns > 0);
	gi_report report;
	assert_gi(gi_finish(gi));
	assert_gi(gi_get_report(gi, &report));
	assert_true(report.pass_ms[GI_PASS_DRAW] > 0 && report.pass_ms[GI_PASS_SOLVE] > 0);
	assert_true((double)report.pass_ms[GI_PASS_SOLVE] < 1e-6 * (double)ns);
	glDeleteQueries(1, &query);
	gi_context_destroy(gi);
	free_target(&t);
}

static void errors_stay_the_hosts(void **state)
{
	(void)state;
	harness_require_context();
	const gi_context_def def = harness_def();
	target t = make_target();
	glEnable(0xffff);
	gi_context *gi = harness_context(&def);
	const gi_object box = add_scene(gi);
	assert_gi(gi_commit(gi));
	clear(&t, 1);
	do_all(gi, box, .2f, look());
	gi_context_destroy(gi);
	assert_int_equal(glGetError(), GL_INVALID_ENUM);
	assert_int_equal(glGetError(), GL_NO_ERROR);
	free_target(&t);
}

static void incomplete_framebuffers_are_refused(void **state)
{
	(void)state;
	harness_require_context();
	const gi_context_def def = harness_def();
	const gi_view view = look();
	target t = make_target();
	GLuint empty;
	glCreateFramebuffers(1, &empty);
	gi_context *gi = harness_context(&def);
	add_scene(gi);
	assert_gi(gi_commit(gi));
	glBindFramebuffer(GL_FRAMEBUFFER, empty);
	assert_int_equal(gi_draw(gi, &view), GI_ERROR_FRAMEBUFFER);
	assert_non_null(strstr(harness_last_message(), "not complete"));
	assert_int_equal(glGetError(), GL_NO_ERROR);
	clear(&t, 1);
	assert_gi(gi_draw(gi, &view));
	glDeleteFramebuffers(1, &empty);
	gi_context_destroy(gi);
	free_target(&t);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(hostile_state_changes_nothing),
	    cmocka_unit_test(hosts_have_their_conventions),
	    cmocka_unit_test(the_host_measures_too),
	    cmocka_unit_test(errors_stay_the_hosts),
	    cmocka_unit_test(incomplete_framebuffers_are_refused),
	};
	return cmocka_run_group_tests_name("contract", tests, harness_open, harness_close);
}
