/* Off-line ray tracing, one of the rivals of figure 6: a path tracer on Embree with every processor.
 *
 * Light is the sum over paths from the eye (Kajiya, "The rendering equation", 1986), each diffuse vertex lit by a point
 * of light drawn and by the direction its path goes on, joined by multiple importance sampling (Veach and Guibas,
 * 1995); mirrors and glass take a path on, by Fresnel's equations; Russian roulette ends it. Caustics come from photons
 * of light traced forward (caustic_splats.h). Numbers are scrambled Sobol points (low_discrepancy.h). Unbiased, but for
 * caustics that are not seen straight, which only tend to the truth; the same bits for the same seed whatever the
 * number of threads.
 */
#ifndef TESTS_BENCH_PATH_TRACER_H
#define TESTS_BENCH_PATH_TRACER_H

#include "linear_image.h"
#include "trace_camera.h"
#include "trace_scene.h"

typedef struct path_tracer_def {
	const trace_scene *scene; /* stays where it is until the end */
	trace_camera camera;
	gi_mode light;  /* as gi_draw has them: direct is what lamps give straight, caustics are indirect */
	bool antialias; /* the mean over each pixel, not what its middle shows, as gi_draw has it */
	bool
	    paths_alone; /* caustics too are found by paths from the eye: far more noise, the same picture in the end */
	uint32_t seed;   /* another seed is an independent picture */
	uint32_t threads; /* 0: one a processor */
} path_tracer_def;

typedef struct path_tracer path_tracer;

/* NULL when memory or Embree fails. */
path_tracer *path_tracer_create(const path_tracer_def *def);
void path_tracer_destroy(path_tracer *tracer);

/* Takes in the poses of what moves, and begins the picture anew. */
void path_tracer_update(path_tracer *tracer);

/* Traces `samples` more paths through each pixel; the picture is of all so far. False when out of memory. */
bool path_tracer_add(path_tracer *tracer, uint32_t samples);
uint32_t path_tracer_samples(const path_tracer *tracer);

/* Radiance, W/m2/sr, into a picture of the camera's size. */
void path_tracer_picture(const path_tracer *tracer, linear_image *out);

#endif
