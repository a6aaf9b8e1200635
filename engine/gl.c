#include "gl.h"

#include <stdio.h>
#include <string.h>

static bool is_core_45(void)
{
	GLint major = 0, minor = 0, profile = 0;
	glGetIntegerv(GL_MAJOR_VERSION, &major);
	glGetIntegerv(GL_MINOR_VERSION, &minor);
	glGetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
	return major * 10 + minor >= 45 && (profile & GL_CONTEXT_CORE_PROFILE_BIT) != 0;
}

bool engine_gl_load(engine_gl_get_proc get_proc, char *message, size_t message_size)
{
	int version = gladLoadGL(get_proc);
	if (version == 0) {
		snprintf(message, message_size,
			 "the OpenGL driver gives no functions; reinstall the driver or try another --context");
		return false;
	}
	if (is_core_45())
		return true;
	snprintf(message, message_size,
		 "OpenGL 4.5 core is needed, the driver \"%s\" gives %d.%d; update it or try another --context",
		 (const char *)glGetString(GL_RENDERER), GLAD_VERSION_MAJOR(version), GLAD_VERSION_MINOR(version));
	return false;
}

/* The first line of a driver's log says what is wrong; a message is one line. */
static void write_log(const char *name, const char *stage, char *log, char *message, size_t message_size)
{
	log[strcspn(log, "\r\n")] = '\0';
	snprintf(message, message_size, "shader %s (%s): %s", name, stage, log[0] ? log : "failed without a log");
}

static GLuint compile(const char *name, GLenum type, const char *source, char *message, size_t message_size)
{
	GLuint shader = glCreateShader(type);
	glShaderSource(shader, 1, &source, NULL);
	glCompileShader(shader);
	GLint compiled = 0;
	glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
	if (compiled)
		return shader;
	char log[512] = "";
	glGetShaderInfoLog(shader, sizeof log, NULL, log);
	write_log(name, type == GL_VERTEX_SHADER ? "vertex" : "fragment", log, message, message_size);
	glDeleteShader(shader);
	return 0;
}

static GLuint link(const char *name, GLuint vertex, GLuint fragment, char *message, size_t message_size)
{
	GLuint program = glCreateProgram();
	glAttachShader(program, vertex);
	glAttachShader(program, fragment);
	glLinkProgram(program);
	GLint linked = 0;
	glGetProgramiv(program, GL_LINK_STATUS, &linked);
	if (linked)
		return program;
	char log[512] = "";
	glGetProgramInfoLog(program, sizeof log, NULL, log);
	write_log(name, "link", log, message, message_size);
	glDeleteProgram(program);
	return 0;
}

GLuint engine_gl_program(const char *name, const char *vertex_source, const char *fragment_source, char *message,
			 size_t message_size)
{
	GLuint program = 0;
	GLuint vertex = compile(name, GL_VERTEX_SHADER, vertex_source, message, message_size);
	GLuint fragment = vertex ? compile(name, GL_FRAGMENT_SHADER, fragment_source, message, message_size) : 0;
	if (fragment)
		program = link(name, vertex, fragment, message, message_size);
	glDeleteShader(vertex); /* 0 is ignored */
	glDeleteShader(fragment);
	return program;
}
