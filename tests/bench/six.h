/* What the methods of figure 6 are measured with: one scene of one fineness, its truth, and rows of results. */
#ifndef TESTS_BENCH_SIX_H
#define TESTS_BENCH_SIX_H

#include "context.h"
#include "linear_image.h"
#include "trace_camera.h"
#include "trace_scene.h"

#include <stdbool.h>
#include <stdint.h>

/* How much is done. */
typedef struct six_effort {
	int width, height;
	uint32_t truth_samples; /* paths a pixel of each half of the truth */
	uint32_t frames;        /* that are timed */
	uint32_t most_frames;   /* at rest, until real-time ray tracing is as good as radiosity */
	uint32_t most_samples;  /* until off-line ray tracing is */
	uint32_t shown_samples; /* paths a pixel of an off-line picture */
} six_effort;

typedef enum six_method { SIX_RADIOSITY, SIX_REALTIME, SIX_OFFLINE, SIX_METHODS } six_method;
extern const char *const six_method_names[SIX_METHODS];

typedef enum six_motion { SIX_REST, SIX_MOVING, SIX_MOTIONS } six_motion;
extern const char *const six_motion_names[SIX_MOTIONS];

/* What a frame's time goes to; those that a method does not have are NAN. */
typedef enum six_part {
	SIX_BUILD,   /* once: objects, leaves and the first solve; trees */
	SIX_BVH,     /* of each frame: trees brought up to date */
	SIX_ROWS,    /* form factors and visibility */
	SIX_SOLVE,   /* sweeps, light of what is drawn */
	SIX_SURFACE, /* what each pixel shows */
	SIX_TRACE,   /* rays */
	SIX_FILTER,  /* accumulation and filter */
	SIX_DRAW,    /* shadow maps and picture */
	SIX_PARTS
} six_part;
extern const char *const six_part_names[SIX_PARTS];

typedef struct six_row {
	uint32_t triangles; /* of the Buddha, as drawn */
	double mesh_kb;
	six_method method;
	six_motion motion;
	double ms; /* a frame, median; off-line: a picture */
	double parts[SIX_PARTS];
	double relative_mse, ssim;
	double equal_error_ms; /* until the error is radiosity's; NAN: not reached */
} six_row;

/* One fineness. */
typedef struct six_scene {
	const six_effort *effort;
	engine_context *context;
	engine_mesh drawn, cage; /* the Buddha, and what lights it */
	trace_scene *scene;      /* for ray tracers, at the pose that is measured */
	float view_from_world[16], clip_from_view[16];
	linear_image truth[2], truth_mean;
	uint8_t *truth_shown; /* 3 bytes a pixel, tone-mapped */
} six_scene;

/* The pose that pictures are measured at, seconds along the Buddha's way, and a frame's step. */
extern const float SIX_TIME, SIX_FRAME;
extern const float SIX_EXPOSURE;

/* The Buddha of about so many triangles. Ends the program when something fails. */
void six_scene_open(six_scene *scene, const six_effort *effort, engine_context *context, uint32_t triangles);
void six_scene_close(six_scene *scene);

/* A row without figures. */
six_row six_row_of(const six_scene *scene, six_method method, six_motion motion);

/* Fills in the errors of a picture, and writes it to `path` unless that is NULL. */
void six_judge(const six_scene *scene, const linear_image *picture, six_row *row, const char *path);

/* An error after a time, and when it falls to `wanted`: between two measurements along the line through both in
 * logarithms. NAN while it has not. */
typedef struct six_course {
	double ms, error; /* the last ones */
	double reached_ms;
} six_course;
six_course six_course_begin(void);
void six_course_add(six_course *course, double ms, double error, double wanted);

/* The methods, each at rest and while the Buddha moves. `wanted`: the errors of radiosity's rows. Pictures go to
 * `folder`. */
void six_radiosity(const six_scene *scene, const char *folder, six_row rows[SIX_MOTIONS]);
void six_realtime(const six_scene *scene, const char *folder, const double wanted[SIX_MOTIONS],
		  six_row rows[SIX_MOTIONS]);
void six_offline(const six_scene *scene, const char *folder, const double wanted[SIX_MOTIONS],
		 six_row rows[SIX_MOTIONS]);

#endif
