/* The shaders of real-time ray tracing, compiled. */
#ifndef TESTS_BENCH_REALTIME_PROGRAMS_H
#define TESTS_BENCH_REALTIME_PROGRAMS_H

#include "gl.h"

enum {
	REALTIME_SURFACE,
	REALTIME_TRACE,
	REALTIME_ACCUMULATE,
	REALTIME_VARIANCE,
	REALTIME_FILTER,
	REALTIME_PICTURE,
	REALTIME_PROGRAMS
};

/* False with the first line of the driver's log in message; those made so far are there then, the others 0. */
bool realtime_programs_create(GLuint programs[REALTIME_PROGRAMS], char *message, size_t message_size);
void realtime_programs_destroy(GLuint programs[REALTIME_PROGRAMS]);

#endif
