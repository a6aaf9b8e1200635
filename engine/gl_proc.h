/* A function that finds OpenGL's functions by name. */
#ifndef ENGINE_GL_PROC_H
#define ENGINE_GL_PROC_H

/* A GL entry point before it is cast to its type, and what looks one up by name (NULL: not there). */
typedef void (*engine_gl_proc)(void);
typedef engine_gl_proc (*engine_gl_get_proc)(const char *name);

#endif
