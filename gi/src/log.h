/* Lines that go to the host: what failed, what it should know, how far a long step is. */
#ifndef GI_LOG_H
#define GI_LOG_H

#include "compiler.h"
#include "gi/gi.h"

#include <stdint.h>

typedef struct gi_log {
	gi_message_fn *message;
	gi_progress_fn *progress;
	void *user;
} gi_log;

/* Formats one line, hands it to the host and returns `result`. */
GI_FORMAT(3, 4) gi_result gi_fail(const gi_log *log, gi_result result, const char *format, ...);

/* Hands the host one line about something that is no error. */
GI_FORMAT(2, 3) void gi_warn(const gi_log *log, const char *format, ...);

/* Tells the host, if it wants to know, that step `done` of `total` begins. */
GI_FORMAT(4, 5) void gi_progress(const gi_log *log, uint32_t done, uint32_t total, const char *format, ...);

/* A pointer that a public function has to be given is NULL: "`what` must not be NULL", or "the context must not be
 * NULL" where there is none, and so no callback either: stderr gets the line. GI_ERROR_INVALID_ARGUMENT. */
gi_result gi_fail_null(const gi_context *gi, const char *what);

/* The handle that a public function was given is of no `what` that is there. GI_ERROR_INVALID_HANDLE. */
gi_result gi_fail_stale(const gi_context *gi, const char *function, const char *what);

#endif
