/* Real-time ray tracing, one of the rivals of figure 6, in compute shaders (shaders/realtime_*): what is seen is drawn
 * by the rasteriser; a path a pixel and frame, lit by a shadow ray, finds its light; it is gathered over time where the
 * same place is found again, and filtered as its variance asks for (SVGF: Schied et al., "Spatiotemporal variance-
 * guided filtering", HPG 2017). A ray that ends where the last frame looked takes its light from there: all further
 * bounces for one ray. docs/figures.md says how it was tuned.
 */
#ifndef TESTS_BENCH_REALTIME_TRACER_H
#define TESTS_BENCH_REALTIME_TRACER_H

#include "linear_image.h"
#include "trace_scene.h"

typedef struct realtime_settings {
	uint32_t paths;        /* a pixel and frame */
	uint32_t bounces;      /* diffuse ones of a path that meets no light that is known */
	uint32_t filter_steps; /* 0: none; each doubles how far the filter reaches */
	bool reuse;            /* light of the last frame where rays end */
	float moving_frames;   /* that history lasts where something moves */
	float rest_frames;     /* at rest */
	float hold;            /* deviations that history may be off the samples around, where something moves */
	float depth_edge;      /* pixels off the plane at which the filter's weight has fallen to 1 / e */
	float normal_edge;     /* power of the cosine */
	float light_edge;      /* deviations */
	float largest;         /* W/m2: what a path brings at most, against fireflies */
} realtime_settings;

/* Those that were found best (docs/figures.md). */
realtime_settings realtime_settings_tuned(void);

typedef struct realtime_tracer realtime_tracer;

/* What the parts of the last frame took, ms, each waited for. */
typedef struct realtime_times {
	double surface, trace, filter; /* what is seen; rays; accumulation, filter, picture */
} realtime_times;

/* The scene is read now, and its poses by each frame; what does not move stays. An OpenGL 4.5 context is current,
 * here and below. build_ms: what the trees took. NULL with one line in message. */
realtime_tracer *realtime_tracer_create(const trace_scene *scene, const realtime_settings *settings, int width,
					int height, double *build_ms, char *message, size_t message_size);
void realtime_tracer_destroy(realtime_tracer *tracer);

void realtime_tracer_set(realtime_tracer *tracer, const realtime_settings *settings);

/* The next frame. `moves`: something does. times: NULL, or what it took, in parts. */
void realtime_tracer_frame(realtime_tracer *tracer, const float view_from_world[16], const float clip_from_view[16],
			   gi_mode mode, bool moves, realtime_times *times);

/* Forgets all frames. */
void realtime_tracer_reset(realtime_tracer *tracer);

/* Radiance, W/m2/sr, of the last frame; waits for it. */
void realtime_tracer_read(const realtime_tracer *tracer, linear_image *out);

#endif
