#include "realtime_programs.h"

#include <stdio.h>
#include <string.h>

/* Shader files, made string literals by the build. */
static const char common[] =
#include "shaders/realtime.glsl.inc"
    ;
static const char surface_vertex[] =
#include "shaders/realtime_surface.vert.inc"
    ;
static const char surface_fragment[] =
#include "shaders/realtime_surface.frag.inc"
    ;
static const char trace[] =
#include "shaders/realtime_trace.comp.inc"
    ;
static const char accumulate[] =
#include "shaders/realtime_accumulate.comp.inc"
    ;
static const char variance[] =
#include "shaders/realtime_variance.comp.inc"
    ;
static const char filter[] =
#include "shaders/realtime_filter.comp.inc"
    ;
static const char picture[] =
#include "shaders/realtime_picture.comp.inc"
    ;

static const char include_line[] = "#include \"realtime.glsl\"\n";

static void first_line(char *text)
{
	text[strcspn(text, "\r\n")] = 0;
}

static GLuint compile(GLenum kind, const char *text, char *message, size_t message_size)
{
	const char *include = strstr(text, include_line), *rest = include ? include + strlen(include_line) : "";
	const char *parts[3] = {text, common, rest};
	const GLint lengths[3] = {include ? (GLint)(include - text) : -1, -1, -1};
	GLuint shader = glCreateShader(kind);
	GLint ok = 0;
	glShaderSource(shader, include ? 3 : 1, parts, lengths);
	glCompileShader(shader);
	glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
	if (ok)
		return shader;
	glGetShaderInfoLog(shader, (GLsizei)message_size, NULL, message);
	first_line(message);
	glDeleteShader(shader);
	return 0;
}

/* Takes the shaders, `second` may be 0. */
static GLuint link_program(GLuint first, GLuint second, char *message, size_t message_size)
{
	GLuint program = glCreateProgram();
	GLint ok = 0;
	glAttachShader(program, first);
	if (second)
		glAttachShader(program, second);
	glLinkProgram(program);
	glDeleteShader(first);
	glDeleteShader(second);
	glGetProgramiv(program, GL_LINK_STATUS, &ok);
	if (ok)
		return program;
	glGetProgramInfoLog(program, (GLsizei)message_size, NULL, message);
	first_line(message);
	glDeleteProgram(program);
	return 0;
}

static GLuint surface_program(char *message, size_t message_size)
{
	const GLuint vertex = compile(GL_VERTEX_SHADER, surface_vertex, message, message_size);
	const GLuint fragment = vertex ? compile(GL_FRAGMENT_SHADER, surface_fragment, message, message_size) : 0;
	if (fragment)
		return link_program(vertex, fragment, message, message_size);
	glDeleteShader(vertex);
	return 0;
}

bool realtime_programs_create(GLuint programs[REALTIME_PROGRAMS], char *message, size_t message_size)
{
	static const char *const texts[REALTIME_PROGRAMS] = {NULL, trace, accumulate, variance, filter, picture};
	memset(programs, 0, REALTIME_PROGRAMS * sizeof *programs);
	programs[REALTIME_SURFACE] = surface_program(message, message_size);
	bool ok = programs[REALTIME_SURFACE] != 0;
	for (int k = REALTIME_TRACE; ok && k < REALTIME_PROGRAMS; k++) {
		const GLuint shader = compile(GL_COMPUTE_SHADER, texts[k], message, message_size);
		programs[k] = shader ? link_program(shader, 0, message, message_size) : 0;
		ok = programs[k] != 0;
	}
	return ok;
}

void realtime_programs_destroy(GLuint programs[REALTIME_PROGRAMS])
{
	for (int k = 0; k < REALTIME_PROGRAMS; k++)
		glDeleteProgram(programs[k]);
}
