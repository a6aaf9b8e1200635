/* Programs of gi/: shader files flattened and handed to the driver. */
#include "gpu.h"

#include "host_memory.h"
#include "shader_source.h"

#include <gi_gl.h>

#include <stdio.h>
#include <string.h>

static gi_result no_memory(const gpu *g)
{
	return gi_fail(&g->log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
}

/* ---- text ---- */

typedef struct text {
	char *data;
	size_t length, capacity;
} text;

static bool text_append(text *t, const char *data, size_t length)
{
	if (t->length + length + 1 > t->capacity) {
		size_t capacity = 2 * (t->length + length + 1);
		char *grown = gi_realloc(t->data, capacity);
		if (!grown)
			return false;
		t->data = grown;
		t->capacity = capacity;
	}
	memcpy(t->data + t->length, data, length);
	t->length += length;
	t->data[t->length] = 0;
	return true;
}

static gi_result read_shader_file(const gpu *g, const char *name, char **out)
{
	char path[4096];
	const int length = snprintf(path, sizeof path, "%s/%s", g->shader_directory, name);
	FILE *file = length < (int)sizeof path ? fopen(path, "rb") : NULL;
	if (!file)
		return gi_fail(&g->log, GI_ERROR_SHADER, "the shader %s was not found in shader_directory", name);
	text t = {0};
	char chunk[4096];
	size_t got;
	bool enough = true;
	while (enough && (got = fread(chunk, 1, sizeof chunk, file)) > 0)
		enough = text_append(&t, chunk, got);
	const bool read = !ferror(file);
	fclose(file);
	*out = t.data;
	if (!enough)
		return no_memory(g);
	return read && t.data ? GI_OK : gi_fail(&g->log, GI_ERROR_SHADER, "the shader %s cannot be read", name);
}

static char *copy_of(const char *source)
{
	size_t size = strlen(source) + 1;
	char *copy = gi_malloc(size);
	if (copy)
		memcpy(copy, source, size);
	return copy;
}

/* The caller frees *out. */
static gi_result load_shader(const gpu *g, const char *name, char **out)
{
	*out = NULL;
	/* What is declared of buffers goes with what the library binds, wherever the rest comes from. */
	if (g->shader_directory && strcmp(name, "buffer_numbers.glsl") != 0 &&
	    strcmp(name, "buffer_declarations.glsl") != 0)
		return read_shader_file(g, name, out);
	for (const gi_shader_source *s = gi_shader_sources; s->name; s++)
		if (strcmp(s->name, name) == 0) {
			*out = copy_of(s->text);
			return *out ? GI_OK : no_memory(g);
		}
	return gi_fail(&g->log, GI_ERROR_SHADER, "there is no shader %s", name);
}

static bool append_line(const gpu *g, const char *line, size_t length, text *out)
{
	if (!text_append(out, line, length))
		return false;
	if (strncmp(line, "#version", 8) != 0)
		return true;
	char define[64];
	const int n = snprintf(define, sizeof define, "#define GI_GROUP_SIZE %uu\n", g->group_size);
	return text_append(out, define, (size_t)n);
}

/* Appends a file with its #include "..." lines replaced by the files they name; after #version goes the group size. */
static gi_result flatten_shader(const gpu *g, const char *name, int depth, text *out)
{
	char *source = NULL;
	if (depth == 8)
		return gi_fail(&g->log, GI_ERROR_SHADER, "the shader %s is included by what it includes", name);
	gi_result result = load_shader(g, name, &source);
	for (const char *line = source; !result && *line;) {
		size_t length = strcspn(line, "\n");
		length += line[length] == '\n';
		char included[128];
		if (sscanf(line, "#include \"%127[^\"\n]\"", included) == 1)
			result = flatten_shader(g, included, depth + 1, out);
		else if (!append_line(g, line, length, out))
			result = no_memory(g);
		line += length;
	}
	gi_free(source);
	return result;
}

/* ---- programs ---- */

/* Does not ask what the compiler makes of it. */
static gi_result attach_shader(const gpu *g, GLuint program, GLenum kind, const char *file)
{
	text source = {0};
	const gi_result result = flatten_shader(g, file, 0, &source);
	if (result) {
		gi_free(source.data);
		return result;
	}
	GLuint shader = g->gl->CreateShader(kind);
	gpu_label(g, GL_SHADER, shader, file);
	const char *text = source.data;
	g->gl->ShaderSource(shader, 1, &text, NULL);
	gi_free(source.data);
	g->gl->CompileShader(shader);
	g->gl->AttachShader(program, shader);
	g->gl->DeleteShader(shader); /* goes with the program */
	return GI_OK;
}

/* vertex_file NULL: a compute shader. */
static gi_result begin_program(const gpu *g, const char *vertex_file, const char *file, uint32_t *out)
{
	GLuint program = g->gl->CreateProgram();
	gi_result result = vertex_file ? attach_shader(g, program, GL_VERTEX_SHADER, vertex_file) : GI_OK;
	if (!result)
		result = attach_shader(g, program, vertex_file ? GL_FRAGMENT_SHADER : GL_COMPUTE_SHADER, file);
	if (result) {
		g->gl->DeleteProgram(program);
		return result;
	}
	g->gl->LinkProgram(program);
	gpu_label(g, GL_PROGRAM, program, file);
	*out = program;
	return GI_OK;
}

static gi_result note_program(gpu *g, const char *vertex_file, const char *file, uint32_t *program)
{
	if (g->program_count == g->program_capacity) {
		const uint32_t capacity = 2 * g->program_capacity + 32;
		gpu_program_use *grown = gi_realloc(g->programs, sizeof *grown * capacity);
		if (!grown)
			return no_memory(g);
		g->programs = grown;
		g->program_capacity = capacity;
	}
	g->programs[g->program_count++] = (gpu_program_use){vertex_file, file, program};
	return GI_OK;
}

static void forget_program(gpu *g, const uint32_t *program)
{
	for (uint32_t k = 0; k < g->program_count; k++)
		if (g->programs[k].program == program)
			g->programs[k--] = g->programs[--g->program_count];
}

/* Hosts are told one line: its length. */
static int first_line(const char *log)
{
	return (int)strcspn(log, "\r\n");
}

/* Did this shader compile? */
static bool check_shader(const gpu *g, GLuint shader, const char *file)
{
	GLint ok = 0;
	g->gl->GetShaderiv(shader, GL_COMPILE_STATUS, &ok);
	if (ok)
		return true;
	char log[800] = "";
	g->gl->GetShaderInfoLog(shader, sizeof log, NULL, log);
	gi_fail(&g->log, GI_ERROR_SHADER, "shader %s does not compile: %.*s", file, first_line(log), log);
	return false;
}

/* Waits for the compiler. */
static gi_result end_program(const gpu *g, const char *vertex_file, const char *file, uint32_t program)
{
	GLint ok = 0;
	g->gl->GetProgramiv(program, GL_LINK_STATUS, &ok);
	if (ok)
		return GI_OK;
	GLuint shaders[2];
	GLsizei count = 0;
	bool compiled = true;
	g->gl->GetAttachedShaders(program, 2, &count, shaders);
	for (GLsizei k = 0; k < count; k++) {
		GLint kind = 0;
		g->gl->GetShaderiv(shaders[k], GL_SHADER_TYPE, &kind);
		compiled = check_shader(g, shaders[k], kind == GL_VERTEX_SHADER ? vertex_file : file) && compiled;
	}
	if (compiled) {
		char log[800] = "";
		g->gl->GetProgramInfoLog(program, sizeof log, NULL, log);
		gi_fail(&g->log, GI_ERROR_SHADER, "shader %s does not link: %.*s", file, first_line(log), log);
	}
	return GI_ERROR_SHADER;
}

gi_result gpu_programs_begin(gpu *g, const gpu_program_file *files, size_t count)
{
	gi_result result = GI_OK;
	for (size_t k = 0; !result && k < count; k++) {
		gi_progress(&g->log, (uint32_t)k, (uint32_t)count, "compiling shaders");
		result = begin_program(g, NULL, files[k].file, files[k].program);
		if (!result)
			result = note_program(g, NULL, files[k].file, files[k].program);
	}
	return result;
}

gi_result gpu_programs_end(gpu *g, const gpu_program_file *files, size_t count)
{
	gi_result result = GI_OK;
	for (size_t k = 0; !result && k < count; k++) {
		gi_progress(&g->log, (uint32_t)k, (uint32_t)count, "waiting for shaders");
		result = end_program(g, NULL, files[k].file, *files[k].program);
	}
	return result;
}

void gpu_programs_free(gpu *g, const gpu_program_file *files, size_t count)
{
	for (size_t k = 0; k < count; k++)
		gpu_program_free(g, files[k].program);
}

gi_result gpu_programs_compute(gpu *g, const gpu_program_file *files, size_t count)
{
	gi_result result = gpu_programs_begin(g, files, count);
	if (!result)
		result = gpu_programs_end(g, files, count);
	if (result)
		gpu_programs_free(g, files, count);
	return result;
}

gi_result gpu_program_draw(gpu *g, const char *vertex_file, const char *fragment_file, uint32_t *out)
{
	gi_result result = begin_program(g, vertex_file, fragment_file, out);
	if (!result)
		result = end_program(g, vertex_file, fragment_file, *out);
	if (!result)
		result = note_program(g, vertex_file, fragment_file, out);
	if (result)
		gpu_program_free(g, out);
	return result;
}

gi_result gpu_program_want(gpu *g, const char *vertex_file, const char *fragment_file, uint32_t *program)
{
	return *program ? GI_OK : gpu_program_draw(g, vertex_file, fragment_file, program);
}

static void delete_program(const gpu *g, uint32_t *program)
{
	if (*program && !g->lost)
		g->gl->DeleteProgram(*program);
	*program = 0;
}

void gpu_program_free(gpu *g, uint32_t *program)
{
	forget_program(g, program);
	delete_program(g, program);
}

gi_result gpu_programs_reload(gpu *g)
{
	const uint32_t count = g->program_count;
	uint32_t *fresh = gi_calloc((size_t)count + 1, sizeof *fresh);
	gi_result result = fresh ? GI_OK : no_memory(g);
	for (uint32_t k = 0; !result && k < count; k++) {
		gi_progress(&g->log, k, count, "compiling shaders");
		result = begin_program(g, g->programs[k].vertex_file, g->programs[k].file, &fresh[k]);
	}
	for (uint32_t k = 0; !result && k < count; k++)
		result = end_program(g, g->programs[k].vertex_file, g->programs[k].file, fresh[k]);
	for (uint32_t k = 0; fresh && k < count; k++) {
		if (!result) {
			delete_program(g, g->programs[k].program);
			*g->programs[k].program = fresh[k];
		} else {
			delete_program(g, &fresh[k]);
		}
	}
	gi_free(fresh);
	return result;
}

void gpu_set_uint(const gpu *g, uint32_t program, int location, uint32_t value)
{
	g->gl->ProgramUniform1ui(program, location, value);
}

void gpu_set_floats(const gpu *g, uint32_t program, int location, int components, int count, const float *values)
{
	switch (components) {
	case 1:
		g->gl->ProgramUniform1fv(program, location, count, values);
		break;
	case 2:
		g->gl->ProgramUniform2fv(program, location, count, values);
		break;
	case 3:
		g->gl->ProgramUniform3fv(program, location, count, values);
		break;
	default:
		g->gl->ProgramUniform4fv(program, location, count, values);
	}
}

void gpu_set_matrices(const gpu *g, uint32_t program, int location, int count, const float *values)
{
	g->gl->ProgramUniformMatrix4fv(program, location, count, GL_FALSE, values);
}
