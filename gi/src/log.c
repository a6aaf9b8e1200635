#include "log.h"

#include "context.h"

#include <stdarg.h>
#include <stdio.h>

/* Names of objects and folders may hold anything, ends of lines and commands to a terminal too. */
static void keep_to_one_line(char *line)
{
	for (; *line; line++)
		if ((unsigned char)*line < ' ' || *line == 127)
			*line = ' ';
}

static void say(const gi_log *log, gi_result result, const char *format, va_list arguments)
{
	char line[1024];
	vsnprintf(line, sizeof line, format, arguments);
	keep_to_one_line(line);
	if (log->message)
		log->message(result, line, log->user);
	else
		fprintf(stderr, "gi: %s\n", line);
}

gi_result gi_fail(const gi_log *log, gi_result result, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	say(log, result, format, arguments);
	va_end(arguments);
	return result;
}

void gi_warn(const gi_log *log, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	say(log, GI_OK, format, arguments);
	va_end(arguments);
}

void gi_progress(const gi_log *log, uint32_t done, uint32_t total, const char *format, ...)
{
	if (!log->progress)
		return;
	char what[128];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(what, sizeof what, format, arguments);
	va_end(arguments);
	keep_to_one_line(what);
	log->progress(what, done, total, log->user);
}

gi_result gi_fail_null(const gi_context *gi, const char *what)
{
	static const gi_log no_log;
	return gi_fail(gi ? &gi->gpu.log : &no_log, GI_ERROR_INVALID_ARGUMENT, "%s must not be NULL",
		       gi ? what : "the context");
}

gi_result gi_fail_stale(const gi_context *gi, const char *function, const char *what)
{
	return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_HANDLE,
		       "%s: the %s was destroyed, was never created or is another context's", function, what);
}
