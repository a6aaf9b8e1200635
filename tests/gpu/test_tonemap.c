/* Radiance in, sRGB bytes out: known greys, hue above white, NaN and infinity, row order. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "engine/context.h"
#include "engine/gl.h"
#include "engine/hud.h"
#include "engine/tonemap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 8, HEIGHT = 4 };

static engine_context *context;

static int open_context(void **state)
{
	(void)state;
	char message[512] = "";
	engine_context_def def = engine_context_def_default();
	def.hidden = true;
	context = engine_context_create(&def, message, sizeof message);
	if (!context)
		print_message("%s\n", message);
	return context ? 0 : -1;
}

static int close_context(void **state)
{
	(void)state;
	engine_context_destroy(context);
	return 0;
}

static engine_target *make_target(int width, int height)
{
	char message[256] = "";
	engine_target *target = engine_target_create(width, height, message, sizeof message);
	if (!target)
		fail_msg("%s", message);
	return target;
}

/* One pixel of a target filled with that radiance. */
static void show(engine_target *target, float r, float g, float b, float exposure, uint8_t *pixel)
{
	uint8_t rgb[WIDTH * HEIGHT * 3];
	const float radiance[4] = {r, g, b, 1};
	engine_target_begin(target);
	glClearNamedFramebufferfv(engine_target_hdr_framebuffer(target), GL_COLOR, 0, radiance);
	engine_target_tonemap(target, exposure);
	engine_target_read(target, rgb);
	memcpy(pixel, rgb + 3 * 11, 3);
}

static void dark_values_are_srgb(void **state)
{
	(void)state;
	engine_target *target = make_target(WIDTH, HEIGHT);
	uint8_t p[3];
	show(target, 0.0f, 0.2140f, 0.5f, 1.0f,
	     p); /* sRGB: 0.214 is 127.5, 0.5 is 187.5; half floats and ties: 1 off */
	assert_int_equal(p[0], 0);
	assert_in_range(p[1], 127, 128);
	assert_in_range(p[2], 187, 188);
	show(target, 0.0f, 0.1070f, 0.25f, 2.0f, p);
	assert_in_range(p[1], 127, 128);
	engine_target_destroy(target);
}

static void bright_values_keep_order_and_never_clip(void **state)
{
	(void)state;
	engine_target *target = make_target(WIDTH, HEIGHT);
	uint8_t p[3], previous = 0;
	for (float radiance = 0.5f; radiance < 60; radiance *= 2) {
		show(target, radiance, radiance / 2, radiance / 4, 1.0f, p);
		assert_true(p[0] >= previous && p[0] >= p[1] && p[1] >= p[2]);
		if (radiance < 4)
			assert_true(p[0] > p[1] && p[1] > p[2] && p[0] < 255);
		previous = p[0];
	}
	engine_target_destroy(target);
}

static void broken_values_do_no_harm(void **state)
{
	(void)state;
	engine_target *target = make_target(WIDTH, HEIGHT);
	uint8_t p[3];
	show(target, NAN, -1.0f, 0.2140f, 1.0f, p);
	assert_int_equal(p[0], 0);
	assert_int_equal(p[1], 0);
	assert_in_range(p[2], 127, 128);
	show(target, INFINITY, INFINITY, INFINITY, 1.0f, p);
	assert_in_range(p[0], 254, 255);
	engine_target_destroy(target);
}

static void first_row_is_the_top(void **state)
{
	(void)state;
	engine_target *target = make_target(WIDTH, HEIGHT);
	uint8_t rgb[WIDTH * HEIGHT * 3];
	engine_target_begin(target);
	glEnable(GL_SCISSOR_TEST);
	glScissor(0, HEIGHT - 1, WIDTH, 1); /* GL counts from the bottom */
	glClearColor(1, 1, 1, 1);
	glClear(GL_COLOR_BUFFER_BIT);
	glDisable(GL_SCISSOR_TEST);
	engine_target_tonemap(target, 1.0f);
	engine_target_read(target, rgb);
	assert_true(rgb[0] > 200);
	assert_int_equal(rgb[3 * WIDTH], 0);
	float radiance[WIDTH * HEIGHT * 3]; /* as it was before exposure and tone mapping */
	engine_target_read_radiance(target, radiance);
	assert_true(radiance[0] == 1 && radiance[3 * WIDTH - 1] == 1 && radiance[3 * WIDTH] == 0);
	assert_int_equal(glGetError(), GL_NO_ERROR);
	engine_target_destroy(target);
}

static void resizing_keeps_working(void **state)
{
	(void)state;
	char message[256];
	engine_target *target = make_target(3, 3);
	uint8_t p[3];
	assert_true(engine_target_resize(target, WIDTH, HEIGHT, message, sizeof message));
	show(target, 0.5f, 0.5f, 0.5f, 1.0f, p);
	assert_in_range(p[0], 187, 188);
	assert_int_equal(engine_target_width(target), WIDTH);
	assert_int_equal(engine_target_height(target), HEIGHT);
	if (engine_context_get_kind(context) != ENGINE_CONTEXT_EGL) /* which has no default framebuffer */
		engine_target_present(target, 16, 16);
	glBindFramebuffer(GL_FRAMEBUFFER, 0);
	assert_int_equal(glGetError(), GL_NO_ERROR);
	engine_target_destroy(target);
	engine_target_destroy(NULL);
}

static int count_lit(const uint8_t *rgb, int width, int x0, int y0, int x1, int y1)
{
	int lit = 0;
	for (int y = y0; y < y1; y++) {
		for (int x = x0; x < x1; x++)
			lit += rgb[(y * width + x) * 3 + 1] > 128;
	}
	return lit;
}

static void text_and_plots_are_drawn_where_asked(void **state)
{
	(void)state;
	enum { SIZE = 128 };
	static uint8_t rgb[SIZE * SIZE * 3];
	char message[256] = "";
	engine_target *target = make_target(SIZE, SIZE);
	engine_hud *hud = engine_hud_create(message, sizeof message);
	if (!hud)
		fail_msg("%s", message);
	float values[20];
	for (int i = 0; i < 20; i++)
		values[i] = (float)i;
	engine_target_begin(target);
	engine_target_tonemap(target, 1.0f);
	engine_hud_text(hud, 4, 4, 1, (const float[4]){1, 1, 1, 1}, "leaves %d\nms 12.5", 4000);
	engine_hud_plot(hud, (const float[4]){64, 64, 60, 60}, (const float[4]){1, 1, 1, 1}, values, 20, 0, 19);
	engine_hud_draw(hud, SIZE, SIZE);
	engine_target_read(target, rgb);
	assert_int_equal(glGetError(), GL_NO_ERROR);
	assert_true(count_lit(rgb, SIZE, 4, 4, 100, 30) > 60);
	assert_true(count_lit(rgb, SIZE, 64, 94, 94, 125) > 10); /* the line rises from the lower left ... */
	assert_true(count_lit(rgb, SIZE, 94, 63, 125, 94) > 10);
	assert_int_equal(count_lit(rgb, SIZE, 0, 40, 60, SIZE), 0); /* ... and nothing is drawn beside it */
	engine_hud_draw(hud, SIZE, SIZE);                           /* drawing forgets what was drawn */
	engine_hud_destroy(hud);
	engine_target_destroy(target);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(dark_values_are_srgb),     cmocka_unit_test(bright_values_keep_order_and_never_clip),
	    cmocka_unit_test(broken_values_do_no_harm), cmocka_unit_test(first_row_is_the_top),
	    cmocka_unit_test(resizing_keeps_working),   cmocka_unit_test(text_and_plots_are_drawn_where_asked),
	};
	return cmocka_run_group_tests_name("tonemap", tests, open_context, close_context);
}
