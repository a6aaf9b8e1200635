/* Files that are there whole or not at all: written beside their place and renamed into it, so that neither a full disk
 * nor a signal leaves half of one. What is no plain file, a device or a pipe, is written as it is.
 */
#ifndef ENGINE_OUTPUT_H
#define ENGINE_OUTPUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { ENGINE_OUTPUT_PATH = 4096 };

typedef struct engine_output {
	FILE *file;
	char path[ENGINE_OUTPUT_PATH];  /* as it was given */
	char place[ENGINE_OUTPUT_PATH]; /* links followed */
	char part[ENGINE_OUTPUT_PATH];  /* beside it; "": written in place */
} engine_output;

/* False with one line in message. */
bool engine_output_open(engine_output *output, const char *path, char *message, size_t message_size);

/* Ends the file: in its place when `written` and nothing went wrong, else it is gone and what was there before stays.
 * False with one line in message. */
bool engine_output_close(engine_output *output, bool written, char *message, size_t message_size);

/* Can a file of this name be written? Tried, before an hour of work is done for it; nothing is left of the trial. */
bool engine_output_check(const char *path, char *message, size_t message_size);

/* The file of this name is no whole one until engine_output_whole() says so of the same string, which must stay where
 * it is until then. Files of engine_output_open() are marked by themselves. Of eight at once; more are not marked.
 */
void engine_output_half(const char *path);
void engine_output_whole(const char *path);

/* Removes the files that are half written, for a program that ends at once; safe in the handler of a signal. */
void engine_output_drop_halves(void);

/* Ends of lines and other control characters become spaces: names hold anything, a message is one line. */
void engine_output_one_line(char *text);

/* From now on a standard output that could not be written, to a full disk for one, is told on standard error when the
 * program ends, which then fails. A limit on the size of files is an error of the write, not a signal. */
void engine_output_watch(const char *program);

#ifdef __cplusplus
}
#endif

#endif
