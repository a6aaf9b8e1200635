/* OpenGL glue of the engine: the generated loader, shaders with their logs, and small checks. */
#ifndef ENGINE_GL_H
#define ENGINE_GL_H

#include "gl_proc.h"

#include <glad/gl.h>

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Loads the functions of <glad/gl.h> for the current context. False with one line in message when the context is not
 * OpenGL 4.5 core or better.
 */
bool engine_gl_load(engine_gl_get_proc get_proc, char *message, size_t message_size);

/* Compiles and links a program from a vertex and a fragment shader. name stands in messages only. Returns 0 after
 * writing the first line of the driver's log to message.
 */
GLuint engine_gl_program(const char *name, const char *vertex_source, const char *fragment_source, char *message,
			 size_t message_size);

#ifdef __cplusplus
}
#endif

#endif
