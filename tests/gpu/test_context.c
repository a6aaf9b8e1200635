/* Contexts: every kind gives OpenGL 4.5 core and the same pixels, or one line that says what is missing. */
#define _POSIX_C_SOURCE 200809L /* setenv */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "engine/context.h"
#include "engine/gl.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 64, PIXEL_BYTES = SIZE * SIZE * 4 };

static const char vertex_source[] =
    "#version 450 core\n"
    "void main() {\n"
    "	vec2 corners[3] = vec2[3](vec2(-0.75, -0.75), vec2(0.75, -0.75), vec2(0.0, 0.75));\n"
    "	gl_Position = vec4(corners[gl_VertexID], 0.0, 1.0);\n"
    "}\n";
static const char fragment_source[] = "#version 450 core\n"
				      "layout(location = 0) out vec4 color;\n"
				      "void main() { color = vec4(1.0, 0.5, 0.25, 1.0); }\n";

static engine_context *open_kind(engine_context_kind kind, char *message, size_t message_size)
{
	engine_context_def def = engine_context_def_default();
	def.kind = kind;
	def.width = def.height = SIZE;
	def.hidden = true;
	def.vsync = false;
	return engine_context_create(&def, message, message_size);
}

static GLuint make_framebuffer(GLuint *texture)
{
	GLuint framebuffer = 0;
	glCreateTextures(GL_TEXTURE_2D, 1, texture);
	glTextureStorage2D(*texture, 1, GL_RGBA8, SIZE, SIZE);
	glCreateFramebuffers(1, &framebuffer);
	glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, *texture, 0);
	assert_int_equal(glCheckNamedFramebufferStatus(framebuffer, GL_FRAMEBUFFER), GL_FRAMEBUFFER_COMPLETE);
	return framebuffer;
}

/* A cleared picture with one triangle in it. */
static void draw(uint8_t *pixels)
{
	char message[256] = "";
	GLuint program = engine_gl_program("test", vertex_source, fragment_source, message, sizeof message);
	if (!program)
		fail_msg("%s", message);
	GLuint texture = 0, vertex_array = 0, framebuffer = make_framebuffer(&texture);
	glCreateVertexArrays(1, &vertex_array);
	glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
	glViewport(0, 0, SIZE, SIZE);
	glClearColor(0.0f, 0.2f, 0.4f, 1.0f);
	glClear(GL_COLOR_BUFFER_BIT);
	glBindVertexArray(vertex_array);
	glUseProgram(program);
	glDrawArrays(GL_TRIANGLES, 0, 3);
	glReadPixels(0, 0, SIZE, SIZE, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
	assert_int_equal(glGetError(), GL_NO_ERROR);
	glDeleteProgram(program);
	glDeleteVertexArrays(1, &vertex_array);
	glDeleteFramebuffers(1, &framebuffer);
	glDeleteTextures(1, &texture);
}

/* The colours are exact multiples away from rounding ties, so every renderer gives these bytes. */
static void check_pixels(const uint8_t *pixels)
{
	const uint8_t clear[4] = {0, 51, 102, 255}, drawn[3] = {255, 128, 64};
	const uint8_t *center = pixels + (SIZE / 2 * SIZE + SIZE / 2) * 4;
	assert_memory_equal(pixels, clear, 4);
	for (int c = 0; c < 3; c++)
		assert_in_range(center[c], drawn[c] - 1, drawn[c]); /* 0.5 is 127.5: either way is allowed */
}

/* Returns whether Mesa's software renderer drew. */
static bool draw_with(engine_context_kind kind, uint8_t *pixels)
{
	char message[256] = "";
	engine_context *context = open_kind(kind, message, sizeof message);
	if (!context)
		fail_msg("%s: %s", engine_context_kind_name(kind), message);
	print_message("%s: %s\n", engine_context_kind_name(kind), engine_context_describe(context));
	assert_int_equal(engine_context_get_kind(context), kind);
	GLint version[2] = {0, 0};
	glGetIntegerv(GL_MAJOR_VERSION, &version[0]);
	glGetIntegerv(GL_MINOR_VERSION, &version[1]);
	assert_true(version[0] * 10 + version[1] >= 45);
	draw(pixels);
	check_pixels(pixels);
	engine_context_swap(context);
	bool software = strstr(engine_context_describe(context), "llvmpipe") != NULL;
	engine_context_destroy(context);
	return software;
}

static void headless_kinds_agree(void **state)
{
	(void)state;
	static uint8_t osmesa[PIXEL_BYTES], egl[PIXEL_BYTES];
	char message[256];
	bool software = draw_with(ENGINE_CONTEXT_EGL, egl);
	engine_context *context = open_kind(ENGINE_CONTEXT_OSMESA, message, sizeof message);
	if (!context) {
		print_message("osmesa skipped: %s\n", message);
		skip();
	}
	engine_context_destroy(context);
	draw_with(ENGINE_CONTEXT_OSMESA, osmesa);
	if (software) /* another rasteriser may place an edge pixel differently */
		assert_memory_equal(osmesa, egl, PIXEL_BYTES);
}

static void window_draws_the_same(void **state)
{
	(void)state;
	static uint8_t pixels[PIXEL_BYTES];
	if (!getenv("DISPLAY") && !getenv("WAYLAND_DISPLAY")) {
		print_message("glfw skipped: no display\n");
		skip();
	}
	draw_with(ENGINE_CONTEXT_GLFW, pixels);
}

static void auto_without_a_display_is_headless(void **state)
{
	(void)state;
	char message[512];
	char *x11 = getenv("DISPLAY") ? strdup(getenv("DISPLAY")) : NULL;
	char *wayland = getenv("WAYLAND_DISPLAY") ? strdup(getenv("WAYLAND_DISPLAY")) : NULL;
	unsetenv("DISPLAY");
	unsetenv("WAYLAND_DISPLAY");
	engine_context *context = open_kind(ENGINE_CONTEXT_AUTO, message, sizeof message);
	bool window = context && engine_context_has_window(context);
	if (x11)
		setenv("DISPLAY", x11, 1);
	if (wayland)
		setenv("WAYLAND_DISPLAY", wayland, 1);
	free(x11);
	free(wayland);
	if (!context)
		fail_msg("%s", message);
	assert_false(window);
	engine_context_destroy(context);
}

static void a_display_that_is_not_there_falls_back(void **state)
{
	(void)state;
	char message[512];
	char *x11 = getenv("DISPLAY") ? strdup(getenv("DISPLAY")) : NULL;
	setenv("DISPLAY", ":9999", 1);
	engine_context *window = open_kind(ENGINE_CONTEXT_GLFW, message, sizeof message);
	engine_context *fallback = open_kind(ENGINE_CONTEXT_AUTO, message, sizeof message);
	if (x11)
		setenv("DISPLAY", x11, 1);
	else
		unsetenv("DISPLAY");
	free(x11);
	assert_non_null(fallback);
	if (!getenv("WAYLAND_DISPLAY"))
		assert_null(window);
	engine_context_destroy(window);
	engine_context_destroy(fallback);
}

static void two_contexts_take_turns(void **state)
{
	(void)state;
	static uint8_t pixels[PIXEL_BYTES];
	char message[256];
	engine_context *first = open_kind(ENGINE_CONTEXT_EGL, message, sizeof message);
	engine_context *second = open_kind(ENGINE_CONTEXT_EGL, message, sizeof message);
	assert_non_null(first);
	assert_non_null(second);
	draw(pixels);
	check_pixels(pixels);
	assert_true(engine_context_make_current(first));
	draw(pixels);
	check_pixels(pixels);
	engine_context_destroy(second);
	memset(pixels, 0, sizeof pixels);
	draw(pixels);
	check_pixels(pixels);
	engine_context_destroy(first);
}

static void resize_and_input(void **state)
{
	(void)state;
	char message[256];
	engine_context *context = open_kind(ENGINE_CONTEXT_EGL, message, sizeof message);
	assert_non_null(context);
	assert_false(engine_context_resize(context, 0, 10));
	assert_false(engine_context_resize(context, 10, 100000));
	assert_true(engine_context_resize(context, 96, 48));
	assert_int_equal(engine_context_width(context), 96);
	assert_int_equal(engine_context_height(context), 48);
	assert_true(engine_context_poll(context)->resized);
	assert_false(engine_context_poll(context)->resized);
	assert_int_equal(engine_context_poll(context)->pressed_count, 0);
	assert_false(engine_context_should_close(context));
	engine_context_request_close(context);
	assert_true(engine_context_should_close(context));
	engine_context_destroy(context);
}

static void without_osmesa_egl_is_advised(void **state)
{
	(void)state;
	char message[256];
	engine_context *context = open_kind(ENGINE_CONTEXT_OSMESA, message, sizeof message);
	const bool is_there = context != NULL;
	engine_context_destroy(context);
	if (is_there)
		skip();
	assert_non_null(strstr(message, "OSMesa"));
	assert_non_null(strstr(message, "--context egl"));
}

static void osmesa_resizes(void **state)
{
	(void)state;
	static uint8_t pixels[PIXEL_BYTES];
	char message[256];
	engine_context *context = open_kind(ENGINE_CONTEXT_OSMESA, message, sizeof message);
	if (!context)
		skip();
	assert_true(engine_context_resize(context, 16, 200));
	draw(pixels);
	check_pixels(pixels);
	engine_context_destroy(context);
}

static void bad_definitions_are_refused(void **state)
{
	(void)state;
	char message[256];
	engine_context_def zero = {0}, huge = engine_context_def_default();
	assert_null(engine_context_create(&zero, message, sizeof message));
	assert_non_null(strstr(message, "engine_context_def_default"));
	huge.width = 1 << 20;
	assert_null(engine_context_create(&huge, message, sizeof message));
	assert_non_null(strstr(message, "1048576"));
	engine_context_destroy(NULL);
}

static void names(void **state)
{
	(void)state;
	engine_context_kind kind = ENGINE_CONTEXT_AUTO;
	assert_true(engine_context_kind_from_name("egl", &kind));
	assert_int_equal(kind, ENGINE_CONTEXT_EGL);
	assert_false(engine_context_kind_from_name("vulkan", &kind));
	assert_int_equal(kind, ENGINE_CONTEXT_EGL);
	assert_string_equal(engine_context_kind_name(ENGINE_CONTEXT_OSMESA), "osmesa");
}

static void broken_shaders_give_one_line(void **state)
{
	(void)state;
	char message[256] = "";
	engine_context *context = open_kind(ENGINE_CONTEXT_EGL, message, sizeof message);
	assert_non_null(context);
	assert_int_equal(engine_gl_program("broken", "#version 450 core\nvoid main() { nonsense; }\n", fragment_source,
					   message, sizeof message),
			 0);
	assert_non_null(strstr(message, "broken (vertex)"));
	assert_null(strchr(message, '\n'));
	engine_context_destroy(context);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(names),
	    cmocka_unit_test(bad_definitions_are_refused),
	    cmocka_unit_test(headless_kinds_agree),
	    cmocka_unit_test(window_draws_the_same),
	    cmocka_unit_test(auto_without_a_display_is_headless),
	    cmocka_unit_test(a_display_that_is_not_there_falls_back),
	    cmocka_unit_test(two_contexts_take_turns),
	    cmocka_unit_test(resize_and_input),
	    cmocka_unit_test(osmesa_resizes),
	    cmocka_unit_test(without_osmesa_egl_is_advised),
	    cmocka_unit_test(broken_shaders_give_one_line),
	};
	return cmocka_run_group_tests_name("context", tests, NULL, NULL);
}
