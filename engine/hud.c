/* Everything becomes triangles in one array, drawn by one call:
 *
 *   //---- 4B ---- 4B ---- 4B
 *   //     x       y       r g b a (bytes)      three of them a triangle
 */
#include "hud.h"
#include "gl.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_easy_font.h>
#pragma GCC diagnostic pop

/* Shader files, made string literals by the build. */
static const char vertex_source[] =
#include "shaders/hud.vert.inc"
    ;
static const char fragment_source[] =
#include "shaders/hud.frag.inc"
    ;

/* A character is about 9 quads of 6 vertices: room for some 1,800 characters, a screen full. */
enum { MAX_VERTICES = 96 * 1024, MAX_TEXT = 1024, MAX_TEXT_QUADS = 12 * MAX_TEXT };

typedef struct hud_vertex {
	float position[2];
	uint8_t color[4];
} hud_vertex;

/* What stb_easy_font writes, four of them a quad. */
typedef struct font_vertex {
	float position[3];
	uint8_t color[4];
} font_vertex;

struct engine_hud {
	GLuint program, buffer, vertex_array;
	uint32_t count;
	hud_vertex vertices[MAX_VERTICES];
	font_vertex text_quads[4 * MAX_TEXT_QUADS]; /* scratch of engine_hud_text */
};

static void describe_vertices(engine_hud *hud)
{
	glCreateBuffers(1, &hud->buffer);
	glNamedBufferData(hud->buffer, sizeof hud->vertices, NULL, GL_STREAM_DRAW);
	glCreateVertexArrays(1, &hud->vertex_array);
	glVertexArrayVertexBuffer(hud->vertex_array, 0, hud->buffer, 0, sizeof(hud_vertex));
	glVertexArrayAttribFormat(hud->vertex_array, 0, 2, GL_FLOAT, GL_FALSE, offsetof(hud_vertex, position));
	glVertexArrayAttribFormat(hud->vertex_array, 1, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(hud_vertex, color));
	for (GLuint attribute = 0; attribute < 2; attribute++) {
		glVertexArrayAttribBinding(hud->vertex_array, attribute, 0);
		glEnableVertexArrayAttrib(hud->vertex_array, attribute);
	}
}

engine_hud *engine_hud_create(char *message, size_t message_size)
{
	engine_hud *hud = calloc(1, sizeof *hud);
	if (!hud) {
		snprintf(message, message_size, "out of memory for the text on screen");
		return NULL;
	}
	hud->program = engine_gl_program("hud", vertex_source, fragment_source, message, message_size);
	if (!hud->program) {
		free(hud);
		return NULL;
	}
	describe_vertices(hud);
	return hud;
}

void engine_hud_destroy(engine_hud *hud)
{
	if (!hud)
		return;
	glDeleteProgram(hud->program);
	glDeleteBuffers(1, &hud->buffer);
	glDeleteVertexArrays(1, &hud->vertex_array);
	free(hud);
}

/* Corners in order around the quad. */
static void add_quad(engine_hud *hud, const float corners[4][2], const float color[4])
{
	static const int order[6] = {0, 1, 2, 0, 2, 3};
	if (hud->count + 6 > MAX_VERTICES)
		return;
	for (int i = 0; i < 6; i++) {
		hud_vertex *vertex = &hud->vertices[hud->count++];
		memcpy(vertex->position, corners[order[i]], sizeof vertex->position);
		for (int c = 0; c < 4; c++)
			vertex->color[c] = (uint8_t)(fminf(fmaxf(color[c], 0.0f), 1.0f) * 255.0f + 0.5f);
	}
}

/* The font's quads start at the origin, in its own size. */
static void add_text_quad(engine_hud *hud, const font_vertex *quad, const float origin[2], float scale,
			  const float color[4])
{
	float corners[4][2];
	for (int k = 0; k < 4; k++) {
		for (int axis = 0; axis < 2; axis++)
			corners[k][axis] = origin[axis] + scale * quad[k].position[axis];
	}
	add_quad(hud, (const float(*)[2])corners, color);
}

void engine_hud_text(engine_hud *hud, float x, float y, float scale, const float color[4], const char *format, ...)
{
	char text[MAX_TEXT];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	/* The font's tables cover 32..126 and trust the caller. */
	for (char *c = text; *c; c++) {
		if (*c != '\n' && (*c < 32 || *c > 126))
			*c = '?';
	}
	int quads = stb_easy_font_print(0, 0, text, NULL, hud->text_quads, (int)sizeof hud->text_quads);
	for (int i = 0; i < quads; i++)
		add_text_quad(hud, hud->text_quads + 4 * i, (const float[2]){x, y}, scale, color);
}

void engine_hud_box(engine_hud *hud, const float box[4], const float color[4])
{
	float right = box[0] + box[2], bottom = box[1] + box[3];
	const float corners[4][2] = {{box[0], box[1]}, {right, box[1]}, {right, bottom}, {box[0], bottom}};
	add_quad(hud, corners, color);
}

/* One and a half pixels wide: a line of one flickers between two rows. */
static void add_line(engine_hud *hud, const float a[2], const float b[2], const float color[4])
{
	float dx = b[0] - a[0], dy = b[1] - a[1], length = hypotf(dx, dy);
	if (!(length > 0))
		return;
	float nx = -dy / length * 0.75f, ny = dx / length * 0.75f;
	const float corners[4][2] = {
	    {a[0] + nx, a[1] + ny}, {b[0] + nx, b[1] + ny}, {b[0] - nx, b[1] - ny}, {a[0] - nx, a[1] - ny}};
	add_quad(hud, corners, color);
}

void engine_hud_plot(engine_hud *hud, const float box[4], const float color[4], const float *values, uint32_t count,
		     float low, float high)
{
	if (count < 2 || !(low < high))
		return;
	float previous[2] = {0, 0};
	bool has_previous = false;
	for (uint32_t i = 0; i < count; i++) {
		float height = fminf(fmaxf((values[i] - low) / (high - low), 0.0f), 1.0f);
		float point[2] = {box[0] + box[2] * (float)i / (float)(count - 1), box[1] + box[3] * (1.0f - height)};
		if (has_previous && isfinite(values[i]))
			add_line(hud, previous, point, color);
		has_previous = isfinite(values[i]);
		memcpy(previous, point, sizeof previous);
	}
}

void engine_hud_draw(engine_hud *hud, int width, int height)
{
	if (hud->count == 0)
		return;
	/* Orphan first: the driver may still be drawing the last frame's text. */
	glNamedBufferData(hud->buffer, sizeof hud->vertices, NULL, GL_STREAM_DRAW);
	glNamedBufferSubData(hud->buffer, 0, (GLsizeiptr)(hud->count * sizeof hud->vertices[0]), hud->vertices);
	glDisable(GL_DEPTH_TEST);
	glDisable(GL_CULL_FACE);
	glEnable(GL_BLEND);
	glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
	glUseProgram(hud->program);
	glProgramUniform2f(hud->program, 0, (float)width, (float)height);
	glBindVertexArray(hud->vertex_array);
	glDrawArrays(GL_TRIANGLES, 0, (GLsizei)hud->count);
	glDisable(GL_BLEND);
	hud->count = 0;
}
