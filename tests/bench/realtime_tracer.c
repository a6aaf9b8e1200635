#include "realtime_tracer.h"

#include "realtime_programs.h"
#include "realtime_scene.h"
#include "samples.h"
#include "trace_camera.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Rays start so far from their surface, as a share of the box's 5.5 m: positions come from the rasteriser. */
static const float LIFT = 1e-4f;

/* Pictures, of four floats a pixel. */
enum {
	PLACE, /* two of each that history has: of this frame and the last, in turn */
	NORMAL = PLACE + 2,
	OLD_DIRECT = NORMAL + 2,
	OLD_INDIRECT = OLD_DIRECT + 2,
	OLD_SQUARES = OLD_INDIRECT + 2,
	NEW_DIRECT = OLD_SQUARES + 2,
	NEW_INDIRECT,
	FILTERED_DIRECT, /* two: the filter goes to and fro */
	FILTERED_INDIRECT = FILTERED_DIRECT + 2,
	RADIANCE = FILTERED_INDIRECT + 2,
	PICTURES
};

struct realtime_tracer {
	realtime_settings settings;
	realtime_scene scene;
	int width, height;
	GLuint programs[REALTIME_PROGRAMS];
	GLuint pictures[PICTURES], depth, framebuffers[2], block;
	uint32_t frame;
	uint32_t filtered; /* which of the two the last frame ended in */
};

/* Of a sweep over each by itself, in a box of 256 x 256 pixels (docs/figures.md). */
realtime_settings realtime_settings_tuned(void)
{
	return (realtime_settings){.paths = 1,
				   .bounces = 3,
				   .filter_steps = 3,
				   .reuse = true,
				   .moving_frames = 8,
				   .rest_frames = 65536,
				   .hold = 5,
				   .depth_edge = 1,
				   .normal_edge = 16,
				   .light_edge = 3,
				   .largest = 200};
}

static void make_pictures(realtime_tracer *t)
{
	glCreateTextures(GL_TEXTURE_2D, PICTURES, t->pictures);
	for (int k = 0; k < PICTURES; k++) {
		glTextureStorage2D(t->pictures[k], 1, GL_RGBA32F, t->width, t->height);
		glTextureParameteri(t->pictures[k], GL_TEXTURE_MIN_FILTER, GL_NEAREST);
		glTextureParameteri(t->pictures[k], GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	}
	glCreateTextures(GL_TEXTURE_2D, 1, &t->depth);
	glTextureStorage2D(t->depth, 1, GL_DEPTH_COMPONENT32F, t->width, t->height);
	glCreateFramebuffers(2, t->framebuffers);
	static const GLenum both[2] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
	for (int k = 0; k < 2; k++) {
		glNamedFramebufferTexture(t->framebuffers[k], GL_COLOR_ATTACHMENT0, t->pictures[PLACE + k], 0);
		glNamedFramebufferTexture(t->framebuffers[k], GL_COLOR_ATTACHMENT1, t->pictures[NORMAL + k], 0);
		glNamedFramebufferTexture(t->framebuffers[k], GL_DEPTH_ATTACHMENT, t->depth, 0);
		glNamedFramebufferDrawBuffers(t->framebuffers[k], 2, both);
	}
	glCreateBuffers(1, &t->block);
	glNamedBufferStorage(t->block, sizeof(realtime_block), NULL, GL_DYNAMIC_STORAGE_BIT);
}

realtime_tracer *realtime_tracer_create(const trace_scene *scene, const realtime_settings *settings, int width,
					int height, double *build_ms, char *message, size_t message_size)
{
	realtime_tracer *t = calloc(1, sizeof *t);
	if (!t) {
		snprintf(message, message_size, "out of memory");
		return NULL;
	}
	t->settings = *settings;
	t->width = width;
	t->height = height;
	if (!realtime_programs_create(t->programs, message, message_size) ||
	    !realtime_scene_create(scene, &t->scene, message, message_size)) {
		realtime_tracer_destroy(t);
		return NULL;
	}
	make_pictures(t);
	realtime_tracer_reset(t);
	*build_ms = t->scene.build_ms;
	return t;
}

void realtime_tracer_destroy(realtime_tracer *t)
{
	if (!t)
		return;
	realtime_scene_destroy(&t->scene);
	realtime_programs_destroy(t->programs);
	glDeleteTextures(PICTURES, t->pictures);
	glDeleteTextures(1, &t->depth);
	glDeleteFramebuffers(2, t->framebuffers);
	glDeleteBuffers(1, &t->block);
	free(t);
}

void realtime_tracer_set(realtime_tracer *t, const realtime_settings *settings)
{
	t->settings = *settings;
}

void realtime_tracer_reset(realtime_tracer *t)
{
	static const float black[4] = {0, 0, 0, 0};
	for (int k = 0; k < PICTURES; k++)
		glClearTexImage(t->pictures[k], 0, GL_RGBA, GL_FLOAT, black);
	t->frame = 0;
	t->scene.has_before = false;
}

/* ---- what shaders know ---- */

static realtime_camera block_camera(const trace_camera *c)
{
	realtime_camera out = {0};
	memcpy(out.eye, c->eye, sizeof c->eye);
	memcpy(out.forward, c->forward, sizeof c->forward);
	memcpy(out.right, c->right, sizeof c->right);
	memcpy(out.up, c->up, sizeof c->up);
	return out;
}

static void upload_block(realtime_tracer *t, const float *view, const float *clip, gi_mode mode, bool moves)
{
	const realtime_settings *s = &t->settings;
	realtime_block *b = &t->scene.block;
	const trace_camera camera = trace_camera_make(view, clip, t->width, t->height);
	const realtime_camera now = block_camera(&camera);
	b->camera_before = t->frame ? b->camera : now;
	b->camera = now;
	b->counts[2] = t->frame;
	b->counts[3] = s->bounces;
	const uint32_t flags[4] = {moves, s->reuse, (uint32_t)mode, s->paths};
	const float settings[4] = {LIFT, s->moving_frames, s->hold, s->largest};
	const float edges[4] = {s->depth_edge, s->normal_edge, s->light_edge, s->rest_frames};
	memcpy(b->flags, flags, sizeof flags);
	memcpy(b->settings, settings, sizeof settings);
	memcpy(b->edges, edges, sizeof edges);
	realtime_scene_pose(&t->scene);
	glNamedBufferSubData(t->block, 0, sizeof *b, b);
	glBindBufferBase(GL_UNIFORM_BUFFER, 0, t->block);
}

/* ---- passes ---- */

static void draw_surfaces(realtime_tracer *t, const float *view, const float *clip, uint32_t now)
{
	static const float black[4] = {0, 0, 0, 0}, far_depth = 1;
	mat4 v, c, clip_from_world;
	memcpy(v, view, sizeof v);
	memcpy(c, clip, sizeof c);
	glm_mat4_mul(c, v, clip_from_world);
	glBindFramebuffer(GL_FRAMEBUFFER, t->framebuffers[now]);
	glViewport(0, 0, t->width, t->height);
	glClearNamedFramebufferfv(t->framebuffers[now], GL_COLOR, 0, black);
	glClearNamedFramebufferfv(t->framebuffers[now], GL_COLOR, 1, black);
	glClearNamedFramebufferfv(t->framebuffers[now], GL_DEPTH, 0, &far_depth);
	glEnable(GL_DEPTH_TEST);
	glEnable(GL_CULL_FACE);
	glDisable(GL_BLEND);
	glUseProgram(t->programs[REALTIME_SURFACE]);
	glUniformMatrix4fv(0, 1, GL_FALSE, clip_from_world[0]);
	glBindVertexArray(t->scene.vertex_array);
	for (uint32_t k = 0; k < t->scene.block.counts[0]; k++) {
		const uint32_t first = t->scene.index_first[k];
		glUniform1ui(1, k);
		glDrawElements(GL_TRIANGLES, (GLsizei)(t->scene.index_first[k + 1] - first), GL_UNSIGNED_INT,
			       (const void *)(sizeof(uint32_t) * first));
	}
	glDisable(GL_DEPTH_TEST);
	glDisable(GL_CULL_FACE);
}

/* Runs a program over the picture: reads from unit 4 on, writes images from 0 on. */
static void dispatch(const realtime_tracer *t, int program, const GLuint *reads, int read_count, const GLuint *writes,
		     int write_count)
{
	glUseProgram(t->programs[program]);
	for (int k = 0; k < read_count; k++)
		glBindTextureUnit((GLuint)(4 + k), reads[k]);
	for (int k = 0; k < write_count; k++)
		glBindImageTexture((GLuint)k, writes[k], 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA32F);
	glDispatchCompute((GLuint)(t->width + 7) / 8, (GLuint)(t->height + 7) / 8, 1);
	glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT |
			GL_TEXTURE_UPDATE_BARRIER_BIT);
}

static void trace(realtime_tracer *t)
{
	const GLuint *p = t->pictures;
	const GLuint reads[5] = {t->scene.textures[0], t->scene.textures[1], t->scene.textures[2],
				 p[FILTERED_DIRECT + t->filtered], p[FILTERED_INDIRECT + t->filtered]};
	const GLuint writes[2] = {p[NEW_DIRECT], p[NEW_INDIRECT]};
	dispatch(t, REALTIME_TRACE, reads, 5, writes, 2);
}

static void accumulate(realtime_tracer *t, uint32_t now)
{
	const GLuint *p = t->pictures;
	const uint32_t then = 1 - now;
	const GLuint reads[5] = {p[NEW_DIRECT], p[NEW_INDIRECT], p[OLD_DIRECT + then], p[OLD_INDIRECT + then],
				 p[OLD_SQUARES + then]};
	const GLuint writes[3] = {p[OLD_DIRECT + now], p[OLD_INDIRECT + now], p[OLD_SQUARES + now]};
	dispatch(t, REALTIME_ACCUMULATE, reads, 5, writes, 3);
}

static void filter(realtime_tracer *t, uint32_t now)
{
	const GLuint *p = t->pictures;
	const GLuint reads[3] = {p[OLD_DIRECT + now], p[OLD_INDIRECT + now], p[OLD_SQUARES + now]};
	const GLuint writes[2] = {p[FILTERED_DIRECT], p[FILTERED_INDIRECT]};
	dispatch(t, REALTIME_VARIANCE, reads, 3, writes, 2);
	t->filtered = 0;
	glUseProgram(t->programs[REALTIME_FILTER]);
	for (uint32_t k = 0; k < t->settings.filter_steps; k++) {
		const uint32_t from = t->filtered, to = 1 - from;
		const GLuint step_reads[2] = {p[FILTERED_DIRECT + from], p[FILTERED_INDIRECT + from]};
		const GLuint step_writes[2] = {p[FILTERED_DIRECT + to], p[FILTERED_INDIRECT + to]};
		glUniform1i(0, 1 << k);
		dispatch(t, REALTIME_FILTER, step_reads, 2, step_writes, 2);
		t->filtered = to;
	}
	const GLuint last[2] = {p[FILTERED_DIRECT + t->filtered], p[FILTERED_INDIRECT + t->filtered]};
	dispatch(t, REALTIME_PICTURE, last, 2, &p[RADIANCE], 1);
}

static double lap(const realtime_times *times, double *began)
{
	if (!times)
		return 0;
	glFinish();
	const double now = now_ms(), took = now - *began;
	*began = now;
	return took;
}

void realtime_tracer_frame(realtime_tracer *t, const float view_from_world[16], const float clip_from_view[16],
			   gi_mode mode, bool moves, realtime_times *times)
{
	const uint32_t now = t->frame & 1;
	double began = now_ms();
	realtime_times took;
	upload_block(t, view_from_world, clip_from_view, mode, moves);
	draw_surfaces(t, view_from_world, clip_from_view, now);
	took.surface = lap(times, &began);
	const GLuint surfaces[4] = {t->pictures[PLACE + now], t->pictures[NORMAL + now], t->pictures[PLACE + 1 - now],
				    t->pictures[NORMAL + 1 - now]};
	glBindTextures(0, 4, surfaces);
	trace(t);
	took.trace = lap(times, &began);
	accumulate(t, now);
	filter(t, now);
	took.filter = lap(times, &began);
	if (times)
		*times = took;
	t->frame++;
}

void realtime_tracer_read(const realtime_tracer *t, linear_image *out)
{
	glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
	for (int y = 0; y < t->height; y++) {
		float *row = out->rgb + 3 * (size_t)t->width * (size_t)(t->height - 1 - y);
		glGetTextureSubImage(t->pictures[RADIANCE], 0, 0, y, 0, t->width, 1, 1, GL_RGB, GL_FLOAT,
				     (GLsizei)(3 * sizeof *row * (size_t)t->width), row);
	}
}
