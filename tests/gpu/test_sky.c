/* Pictures of the sky: gradients and suns against closed forms, what changes when they do, who sees them. */
#include "snapshot.h"

#include "scenes/body.h"
#include "scenes/shapes.h"

#include <glad/gl.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;
static const float GREY[3] = {.6f, .5f, .4f}, BLACK[3] = {0, 0, 0};

/* ---- pictures ---- */

typedef struct picture {
	uint32_t width, height;
	float *texels;
} picture;

static picture make_picture(uint32_t width, uint32_t height, float value)
{
	picture p = {width, height, calloc(3 * (size_t)width * height, sizeof *p.texels)};
	assert_non_null(p.texels);
	for (uint32_t k = 0; k < 3 * width * height; k++)
		p.texels[k] = value;
	return p;
}

static void set_picture(gi_context *gi, const picture *p)
{
	assert_gi(gi_set_sky_image(gi, p->texels, p->width, p->height, NULL));
}

/* L = a + b cos of the angle from straight above, in rows. */
static picture gradient(double a, double b)
{
	const picture p = make_picture(1, 256, 0);
	for (uint32_t row = 0; row < p.height; row++) {
		const double cosine = .5 * (cos(PI * row / p.height) + cos(PI * (row + 1.0) / p.height));
		for (uint32_t c = 0; c < 3; c++)
			p.texels[3 * row + c] = (float)(a + b * cosine);
	}
	return p;
}

static double texel_angle(const picture *p, uint32_t row)
{
	return 2 * PI / p->width * (cos(PI * row / p->height) - cos(PI * (row + 1.0) / p->height));
}

/* One texel that alone gives a plate that looks at it the irradiance; to it. */
static void add_sun(picture *p, uint32_t column, uint32_t row, double irradiance, double towards[3])
{
	for (uint32_t c = 0; c < 3; c++)
		p->texels[3 * (row * p->width + column) + c] = (float)(irradiance / texel_angle(p, row));
	const double around = 2 * PI * ((column + .5) / p->width - .5), down = PI * (row + .5) / p->height;
	towards[0] = sin(around) * sin(down);
	towards[1] = cos(down);
	towards[2] = -cos(around) * sin(down);
}

/* Clouds: blobs of light, some of it bright. */
static picture clouds(uint32_t seed)
{
	const picture p = make_picture(64, 32, .2f);
	for (uint32_t blob = 0; blob < 12; blob++) {
		seed = seed * 1664525u + 1013904223u;
		const double x = (seed >> 8 & 63), y = (seed >> 16 & 31), r = 1 + (seed >> 24 & 7);
		for (uint32_t k = 0; k < p.width * p.height; k++) {
			const double dx = k % p.width - x, dy = k / p.width - y;
			p.texels[3 * k + blob % 3] += (float)(8 / r * exp(-(dx * dx + dy * dy) / (r * r)));
		}
	}
	return p;
}

/* ---- scenes ---- */

static gi_context *open_context(float tolerance)
{
	gi_context_def def = harness_def();
	def.sky = GI_SKY_ON;
	def.row_tolerance = tolerance;
	def.solve_tolerance = 1e-3f;
	return harness_context(&def);
}

static void add(gi_context *gi, const char *name, engine_mesh *mesh, const float *rho)
{
	const scene_body body = {.name = name, .rho = rho};
	gi_object out;
	assert_gi(scene_add_body(gi, &body, mesh, &out));
}

/* Of one square metre about the origin, tilted about z: it looks to (-sin, cos, 0). */
static void add_plate(gi_context *gi, double tilt, uint32_t n)
{
	const float c = (float)cos(tilt), s = (float)sin(tilt);
	engine_mesh mesh;
	assert_true(
	    shape_quad((float[]){-.5f * c, -.5f * s, -.5f}, (float[]){0, 0, 1}, (float[]){c, s, 0}, n, n, &mesh));
	add(gi, "plate", &mesh, GREY);
}

/* Of 1 m by 1 m, as deep as said, with black walls; its bottom at y = 0. */
static void add_well(gi_context *gi, float deep, uint32_t n, const float *walls)
{
	engine_mesh mesh;
	assert_true(shape_quad((float[]){0, 0, 0}, (float[]){0, 0, 1}, (float[]){1, 0, 0}, n, n, &mesh));
	add(gi, "bottom", &mesh, GREY);
	const float y[3] = {0, deep, 0};
	assert_true(shape_quad((float[]){0, 0, 0}, y, (float[]){0, 0, 1}, 4, 4, &mesh));
	add(gi, "left", &mesh, walls);
	assert_true(shape_quad((float[]){1, 0, 0}, (float[]){0, 0, 1}, y, 4, 4, &mesh));
	add(gi, "right", &mesh, walls);
	assert_true(shape_quad((float[]){0, 0, 0}, (float[]){1, 0, 0}, y, 4, 4, &mesh));
	add(gi, "back", &mesh, walls);
	assert_true(shape_quad((float[]){0, 0, 1}, y, (float[]){1, 0, 0}, 4, 4, &mesh));
	add(gi, "front", &mesh, walls);
}

static gi_leaf *read_leaves(gi_context *gi, uint32_t *count)
{
	assert_gi(gi_read_leaves(gi, NULL, 0, count));
	gi_leaf *leaves = calloc(*count + 1, sizeof *leaves);
	assert_non_null(leaves);
	assert_gi(gi_read_leaves(gi, leaves, *count, count));
	return leaves;
}

/* Largest relative error of H over leaves and channels. */
static double worst_error(gi_context *gi, double wanted)
{
	uint32_t count;
	gi_leaf *leaves = read_leaves(gi, &count);
	double worst = 0;
	for (uint32_t k = 0; k < count; k++)
		for (int c = 0; c < 3; c++)
			worst = fmax(worst, fabs((double)leaves[k].irradiance[c] / wanted - 1));
	free(leaves);
	return worst;
}

static void expect_below(const char *what, double value, double limit)
{
	printf("  %s: %.4f (%.4f)\n", what, value, limit);
	if (!(value < limit))
		fail_msg("%s: %g is not below %g", what, value, limit);
}

/* ---- closed forms ---- */

/* H = pi L, from a picture as from a colour. */
static void uniform(void **state)
{
	(void)state;
	gi_context *gi = open_context(.01f);
	add_plate(gi, .4, 3);
	picture white = make_picture(8, 4, 2);
	set_picture(gi, &white);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	expect_below("uniform, of H", worst_error(gi, 2 * PI), 1e-5);
	assert_gi(gi_set_sky(gi, GI_SKY_ON, (float[]){1, 1, 1}));
	const gi_report r = harness_update(gi);
	assert_true(r.rays == 0 && r.new_entries == 0);
	expect_below("and a colour, of H", worst_error(gi, 2 * PI + 1), 1e-5);
	free(white.texels);
	gi_context_destroy(gi);
}

/* Of L = a + b cos from above to what looks `tilt` off: H = pi a + 2 pi / 3 b cos tilt. */
static void gradients(void **state)
{
	(void)state;
	static const float tolerances[] = {.1f, .01f};
	for (int k = 0; k < 2; k++)
		for (int step = 0; step <= 4; step += k ? 1 : 2) {
			const double tilt = step * PI / 4;
			gi_context *gi = open_context(tolerances[k]);
			add_plate(gi, tilt, 2);
			picture p = gradient(3, 2.5);
			set_picture(gi, &p);
			assert_gi(gi_commit(gi));
			harness_update(gi);
			const double h = PI * 3 + 2 * PI / 3 * 2.5 * cos(tilt);
			char what[64];
			snprintf(what, sizeof what, "gradient at %d degrees, tolerance %g", 45 * step,
				 (double)tolerances[k]);
			expect_below(what, worst_error(gi, h), k ? .01 : .03);
			free(p.texels);
			gi_context_destroy(gi);
		}
}

/* One bright texel gives an open plate E cos theta. */
static void sun(void **state)
{
	(void)state;
	static const uint32_t places[][4] = {
	    {1024, 512, 300, 60}, {1024, 512, 511, 170}, {256, 128, 17, 30}, {64, 32, 40, 6}, {2048, 1024, 5, 333}};
	for (size_t k = 0; k < sizeof places / sizeof *places; k++) {
		picture p = make_picture(places[k][0], places[k][1], 1);
		double towards[3];
		add_sun(&p, places[k][2], places[k][3], 1000, towards);
		gi_context *gi = open_context(.01f);
		add_plate(gi, .3, 4);
		set_picture(gi, &p);
		assert_gi(gi_commit(gi));
		harness_update(gi);
		const double cosine = -sin(.3) * towards[0] + cos(.3) * towards[1];
		char what[64];
		snprintf(what, sizeof what, "sun of %.2f degrees, cosine %.3f", 360.0 / p.width, cosine);
		expect_below(what, worst_error(gi, PI + 1000 * fmax(cosine, 0)), .01);
		free(p.texels);
		gi_context_destroy(gi);
	}
}

/* At the bottom of a black well the sun's shadow is where it is: what all of the bottom gets, and how wide its edge is.
 */
static void well(void **state)
{
	(void)state;
	enum { N = 24 };
	picture p = make_picture(1024, 512, 0);
	double towards[3];
	add_sun(&p, 768, 80, 1000, towards); /* from +x, 28 degrees off the zenith */
	const double deep = .8, reach = deep * towards[0] / towards[1], aside = deep * fabs(towards[2]) / towards[1];
	gi_context *gi = open_context(.02f);
	add_well(gi, (float)deep, N, BLACK);
	set_picture(gi, &p);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	uint32_t count, edge = 0, wrong = 0;
	gi_leaf *leaves = read_leaves(gi, &count);
	double sum = 0;
	for (uint32_t k = 0; k < N * N; k++) {
		const double h = (double)leaves[k].irradiance[1] / (1000 * towards[1]);
		double low = 1, high = 0;
		for (int c = 0; c < 4; c++) {
			low = fmin(low, (double)leaves[k].corners[c][0]);
			high = fmax(high, (double)leaves[k].corners[c][0]);
		}
		/* Its right side is in the shadow of the right wall. */
		const bool lit = high<1 - reach - .01, dark = low> 1 - reach + .01;
		wrong += (lit && fabs(h - 1) > .02) || (dark && h > .02);
		edge += !lit && !dark;
		sum += h / (N * N);
	}
	const double share = (1 - reach) * (1 - aside);
	printf("  sun %.1f degrees off: %u of %d leaves are of the edge; lit share %.4f, by its place %.4f\n",
	       acos(towards[1]) * 180 / PI, edge, N * N, sum, share);
	expect_below("well, leaves off its edge that are wrong", wrong, N); /* the side walls' shadow, a sliver */
	expect_below("well, lit share", fabs(sum / share - 1), .03);
	free(leaves);
	free(p.texels);
	gi_context_destroy(gi);
}

/* ---- against paths ---- */

static double error_against_paths(gi_context *gi)
{
	snapshot s = snapshot_take(gi);
	const double error = snapshot_light_error(gi, &s, harness_paths(1024));
	snapshot_free(&s);
	return error;
}

static void paths_see_it(void **state)
{
	(void)state;
	gi_context *gi = open_context(.01f);
	add_well(gi, .6f, 6, GREY);
	picture p = make_picture(1, 1, 1);
	set_picture(gi, &p);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	expect_below("a grey well below a white sky, against paths", error_against_paths(gi), .03);
	free(p.texels);
	p = clouds(5);
	set_picture(gi, &p);
	harness_update(gi);
	expect_below("clouds over a grey well, against paths", error_against_paths(gi), .04);
	free(p.texels);
	p = make_picture(512, 256, .5f);
	double towards[3];
	add_sun(&p, 390, 50, 30, towards);
	set_picture(gi, &p);
	harness_update(gi);
	expect_below("sun over a grey well, against paths", error_against_paths(gi), .05);
	free(p.texels);
	gi_context_destroy(gi);
}

/* ---- changes ---- */

static void expect_as_created(gi_context *gi, const picture *p, const char *what)
{
	gi_context *other = open_context(.03f);
	add_well(other, .6f, 4, GREY);
	if (p)
		set_picture(other, p);
	assert_gi(gi_commit(other));
	harness_update(other);
	snapshot a = snapshot_take(gi), b = snapshot_take(other);
	snapshot_expect_same_rows(&a, &b, what);
	if (snapshot_hash_radiosity(&a) != snapshot_hash_radiosity(&b))
		fail_msg("%s: B is another", what);
	snapshot_free(&a);
	snapshot_free(&b);
	gi_context_destroy(other);
}

static void changes(void **state)
{
	(void)state;
	enum { COUNT = 7 };
	double towards[3];
	picture pictures[COUNT] = {clouds(1), clouds(2), make_picture(256, 128, .1f), make_picture(256, 128, .1f)};
	add_sun(&pictures[2], 100, 30, 50, towards);
	add_sun(&pictures[3], 140, 30, 50, towards);
	pictures[4] = pictures[3]; /* the same patches, less light */
	pictures[4].texels = calloc(3 * 256 * 128, sizeof(float));
	assert_non_null(pictures[4].texels);
	for (uint32_t k = 0; k < 3 * 256 * 128; k++)
		pictures[4].texels[k] = .5f * pictures[3].texels[k];
	pictures[6] = gradient(1, 1);
	static const bool solve_alone[COUNT] = {false, true, false, false, true, false, false};
	gi_context *gi = open_context(.03f);
	add_well(gi, .6f, 4, GREY);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	for (int k = 0; k < COUNT; k++) {
		picture *p = pictures[k].texels ? &pictures[k] : NULL;
		if (p)
			set_picture(gi, p);
		else
			assert_gi(gi_set_sky_image(gi, NULL, 0, 0, NULL));
		gi_reset_radiosity(gi);
		const gi_report r = harness_update(gi);
		printf("  picture %d: %llu rays\n", k, (unsigned long long)r.rays);
		assert_true((r.rays == 0 && r.new_entries == 0) == solve_alone[k]);
		char what[32];
		snprintf(what, sizeof what, "picture %d", k);
		expect_as_created(gi, p, what);
		assert_int_equal(harness_update(gi).outcome, GI_OUTCOME_AT_REST);
	}
	for (int k = 0; k < COUNT; k++)
		free(pictures[k].texels);
	gi_context_destroy(gi);
}

/* Under a budget too: rows that waited end as those of a rebuild, and bounds hold. */
static void budget(void **state)
{
	(void)state;
	gi_context *gi = open_context(.03f);
	add_well(gi, .6f, 6, GREY);
	engine_mesh mesh;
	assert_true(shape_sphere(.1f, 3, &mesh));
	const scene_body body = {.name = "ball", .rho = GREY};
	gi_object ball;
	assert_gi(scene_add_body(gi, &body, &mesh, &ball));
	picture p = clouds(3);
	set_picture(gi, &p);
	assert_gi(gi_commit(gi));
	for (uint32_t k = 0; k < 12; k++) {
		const gi_pose pose = {{.5f + .02f * k, .3f, .5f}, {0, 0, 0, 1}};
		assert_gi(gi_set_pose(gi, ball, pose));
		assert_gi(gi_update(gi, &(gi_budget){.rays = 400}));
		assert_gi(gi_finish(gi));
		gi_report r;
		assert_gi(gi_get_report(gi, &r));
		snapshot now = snapshot_take(gi);
		if (k == 11) {
			assert_true(r.waiting_rows > 0);
			harness_update(gi);
			snapshot exact = snapshot_take(gi);
			const double off = snapshot_distance(&now, &exact);
			printf("  under a budget off by %g, bound %g\n", off, (double)(r.stale_bound + r.solve_bound));
			assert_true(off <= (double)(r.stale_bound + r.solve_bound) * 1.001);
			snapshot_free(&exact);
			snapshot_expect_rebuilt_rows(gi, "after a budget");
		}
		snapshot_free(&now);
	}
	free(p.texels);
	gi_context_destroy(gi);
}

/* ---- mirrors ---- */

enum { SIZE = 32 };

static void draw_from_above(gi_context *gi, float pixels[SIZE][SIZE][4])
{
	GLuint target, colour, depth;
	glCreateFramebuffers(1, &target);
	glCreateTextures(GL_TEXTURE_2D, 1, &colour);
	glTextureStorage2D(colour, 1, GL_RGBA32F, SIZE, SIZE);
	glCreateRenderbuffers(1, &depth);
	glNamedRenderbufferStorage(depth, GL_DEPTH_COMPONENT32F, SIZE, SIZE);
	glNamedFramebufferTexture(target, GL_COLOR_ATTACHMENT0, colour, 0);
	glNamedFramebufferRenderbuffer(target, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth);
	glBindFramebuffer(GL_FRAMEBUFFER, target);
	glClearDepth(1);
	glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
	gi_view view = gi_view_default();
	/* From (0, 1, 0) down; the picture's x is the world's, its y is -z. 90 degrees wide. */
	static const float from_world[16] = {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, -1, 1};
	static const float clip[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1.0202f, -1, 0, 0, -.20202f, 0};
	memcpy(view.view_from_world, from_world, sizeof from_world);
	memcpy(view.clip_from_view, clip, sizeof clip);
	view.width = view.height = SIZE;
	assert_gi(gi_draw(gi, &view));
	glReadPixels(0, 0, SIZE, SIZE, GL_RGBA, GL_FLOAT, pixels);
	glBindFramebuffer(GL_FRAMEBUFFER, 0);
	glDeleteFramebuffers(1, &target);
	glDeleteTextures(1, &colour);
	glDeleteRenderbuffers(1, &depth);
}

/* The camera looks straight down on a mirror that lies flat, and sees what is above. */
static void mirrored(void **state)
{
	(void)state;
	gi_context *gi = open_context(.1f);
	const gi_material dark = {.rho = {0}};
	const gi_specular mirror = {.reflectance = {1, 1, 1}};
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-2, 0, -2}, (float[]){0, 0, 4}, (float[]){4, 0, 0}, 2, 2, &mesh));
	gi_object_def def = scene_mesh_def(&mesh);
	def.materials = &dark;
	def.specular = &mirror;
	def.material_count = 1;
	gi_object plate;
	assert_gi(gi_create_object(gi, &def, &plate));
	engine_mesh_free(&mesh);
	/* Four quarters of the sky, by where they lie. */
	picture p = make_picture(4, 2, 0);
	for (uint32_t k = 0; k < 4; k++)
		p.texels[3 * k + k % 3] = 1.0f + (float)k;
	set_picture(gi, &p);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	static float pixels[SIZE][SIZE][4];
	draw_from_above(gi, pixels);
	/* Up in the picture is -z, the middle columns of the sky: 1 to the left, 2 to the right; 0 and 3 behind. */
	const struct {
		int x, y;
		uint32_t texel;
	} seen[] = {{8, 24, 1}, {24, 24, 2}, {8, 8, 0}, {24, 8, 3}};
	for (size_t k = 0; k < sizeof seen / sizeof *seen; k++)
		for (int c = 0; c < 3; c++) {
			const float value = pixels[seen[k].y][seen[k].x][c],
				    wanted = p.texels[3 * seen[k].texel + (uint32_t)c];
			if (!(fabsf(value - wanted) < 1e-3f))
				fail_msg("pixel %zu, channel %d: %g is not %g", k, c, (double)value, (double)wanted);
		}
	free(p.texels);
	gi_context_destroy(gi);
}

/* Light of a sun by way of a mirror falls on a ceiling: rows and paths agree where patches of the sky are looked up. */
static void by_a_mirror(void **state)
{
	(void)state;
	gi_context *gi = open_context(.02f);
	const gi_material dark = {.rho = {0}};
	const gi_specular mirror = {.reflectance = {.9f, .9f, .9f}};
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-1, 0, -1}, (float[]){0, 0, 2}, (float[]){2, 0, 0}, 4, 4, &mesh));
	gi_object_def def = scene_mesh_def(&mesh);
	def.materials = &dark;
	def.specular = &mirror;
	def.material_count = 1;
	gi_object plate;
	assert_gi(gi_create_object(gi, &def, &plate));
	engine_mesh_free(&mesh);
	assert_true(shape_quad((float[]){-.5f, 1, -.5f}, (float[]){1, 0, 0}, (float[]){0, 0, 1}, 4, 4, &mesh));
	add(gi, "ceiling", &mesh, GREY);
	picture p = clouds(9);
	set_picture(gi, &p);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	expect_below("clouds in a mirror, against paths", error_against_paths(gi), .08);
	free(p.texels);
	gi_context_destroy(gi);
}

/* ---- what is refused ---- */

static void refused(void **state)
{
	(void)state;
	gi_context *gi = open_context(.1f);
	const float fine[3] = {1, 2, 3}, nan[3] = {1, NAN, 1}, below[3] = {1, -1, 1}, above[3] = {1, 1, 4e11f};
	const float none[4] = {0}, bad[4] = {0, INFINITY, 0, 1};
	assert_int_equal(gi_set_sky_image(NULL, fine, 1, 1, NULL), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_set_sky_image(gi, fine, 0, 1, NULL), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_set_sky_image(gi, fine, 1, 32769, NULL), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_set_sky_image(gi, nan, 1, 1, NULL), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_set_sky_image(gi, below, 1, 1, NULL), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_set_sky_image(gi, above, 1, 1, NULL), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_set_sky_image(gi, fine, 1, 1, none), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_set_sky_image(gi, fine, 1, 1, bad), GI_ERROR_INVALID_ARGUMENT);
	assert_gi(gi_set_sky_image(gi, fine, 1, 1, NULL));
	gi_context_destroy(gi);
}

/* 100 rounds: nothing is left of any (the sanitizers look). */
static void again_and_again(void **state)
{
	(void)state;
	picture p = clouds(4);
	for (int round = 0; round < (harness_is_long() ? 100 : 12); round++) {
		gi_context *gi = open_context(.3f);
		add_plate(gi, 0, 1);
		set_picture(gi, &p);
		if (round % 3 == 1) {
			assert_gi(gi_commit(gi));
			harness_update(gi);
			set_picture(gi, &p);
		}
		gi_context_destroy(gi);
	}
	free(p.texels);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(uniform), cmocka_unit_test(gradients),       cmocka_unit_test(sun),
	    cmocka_unit_test(well),    cmocka_unit_test(paths_see_it),    cmocka_unit_test(changes),
	    cmocka_unit_test(budget),  cmocka_unit_test(mirrored),        cmocka_unit_test(by_a_mirror),
	    cmocka_unit_test(refused), cmocka_unit_test(again_and_again),
	};
	return cmocka_run_group_tests(tests, harness_open, harness_close);
}
