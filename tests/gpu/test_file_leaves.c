/* What leaves of scene files reflect and emit where pictures and colours of vertices say it: the mean over each, of a
 * mesh that is lit through a simplified cage too; and the light that bounces off them. */
#define _XOPEN_SOURCE 700 /* mkdtemp */
#include "snapshot.h"

#include "demos/file_scene.h"
#include "engine/image.h"

#include "scene_files.h"

typedef struct played {
	file_scene file;
	gi_context *gi;
	snapshot s;
} played;

static played play(const char *path, float leaf_size, uint32_t cage_faces, options_sides sides)
{
	played p = {.file = {.program = "test_file_leaves",
			     .lit = true,
			     .leaf_size = leaf_size,
			     .leaves = 1500,
			     .cage_faces = cage_faces,
			     .two_sided = sides}};
	gi_context_def def = harness_def();
	def.row_tolerance = .2f;
	def.sky = GI_SKY_ON;
	for (int c = 0; c < 3; c++)
		def.sky_exitance[c] = 1;
	if (!file_scene_load(&p.file, path, message, sizeof message))
		fail_msg("%s", message);
	p.gi = harness_context(&def);
	if (!file_scene_create(&p.file, p.gi, message, sizeof message))
		fail_msg("%s", message);
	assert_gi(gi_commit(p.gi));
	harness_update(p.gi);
	p.s = snapshot_take(p.gi);
	assert_true(p.s.leaf_count > 0);
	return p;
}

static void stop(played *p)
{
	snapshot_free(&p->s);
	gi_context_destroy(p->gi);
	file_scene_free(&p->file);
}

static void middle_of(const gi_leaf *leaf, double out[3])
{
	/* of both triangles, by their areas */
	double areas[2], sum = 0;
	for (int h = 0; h < 2; h++) {
		double n[3], squares = 0;
		for (int k = 0; k < 3; k++) {
			const int i = (k + 1) % 3, j = (k + 2) % 3;
			const float *a = leaf->corners[0], *b = leaf->corners[1 + h], *c = leaf->corners[2 + h];
			n[k] = ((double)b[i] - a[i]) * ((double)c[j] - a[j]) -
			       ((double)b[j] - a[j]) * ((double)c[i] - a[i]);
			squares += n[k] * n[k];
		}
		areas[h] = sqrt(squares);
		sum += areas[h];
	}
	for (int k = 0; k < 3; k++) {
		out[k] = 0;
		for (int h = 0; h < 2; h++)
			out[k] += areas[h] / sum *
				  ((double)leaf->corners[0][k] + leaf->corners[1 + h][k] + leaf->corners[2 + h][k]) / 3;
	}
}

/* ---- colours of vertices ---- */

/* Red grows with x, green with y, blue is 0.2: what floats of linear light say, and their sRGB values. */
static double srgb_of(double linear)
{
	return linear <= .0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - .055;
}

static void add_vertex(char *text, size_t size, double x, double y)
{
	const size_t length = strlen(text);
	snprintf(text + length, size - length, "v %.9g %.9g 0 %.9g %.9g %.9g\n", x, y, srgb_of(.1 + .2 * x),
		 srgb_of(.2 + .3 * y), srgb_of(.2));
}

static void check_gradient(const char *faces, float leaf_size, options_sides sides)
{
	/* A trapezoid, a triangle beside it, and a pentagon above. */
	static const double places[][2] = {{0, 0}, {2, 0}, {1.5, 1}, {.5, 1}, {2.5, .8}, {1.2, 2}, {.3, 1.6}};
	char text[2048] = "";
	for (size_t k = 0; k < sizeof places / sizeof *places; k++)
		add_vertex(text, sizeof text, places[k][0], places[k][1]);
	strcat(text, faces);
	played p = play(write_text("gradient.obj", text), leaf_size, 0, sides);
	double worst = 0;
	for (uint32_t k = 0; k < p.s.leaf_count; k++) {
		double at[3];
		middle_of(&p.s.leaves[k], at);
		const double wanted[3] = {.1 + .2 * at[0], .2 + .3 * at[1], .2};
		for (int c = 0; c < 3; c++)
			worst = fmax(worst, fabs((double)p.s.leaves[k].rho[c] - wanted[c]));
	}
	printf("  %u leaves of a gradient: rho off by %.1e\n", p.s.leaf_count, worst);
	if (worst > 1e-5)
		fail_msg("%s: rho is off by %g", faces, worst);
	stop(&p);
}

static void gradients_are_theirs_at_each_leaf(void **state)
{
	(void)state;
	check_gradient("f 1 2 3\nf 1 3 4\nf 2 5 3\n", .3f, OPTIONS_SIDES_OFF);
	check_gradient("f 1 2 3 4\nf 2 5 3\nf 3 6 7 4\n", .3f, OPTIONS_SIDES_OFF);
	check_gradient("f 1 2 3 4\n", 0, OPTIONS_SIDES_OFF);
	check_gradient("f 1 2 3 4\nf 2 5 3\nf 4 3 5 6 7\n", .2f, OPTIONS_SIDES_ON);
}

/* A picture of two columns, white and black, times a colour that grows across it, and the factor: 0.9 is more than
 * either. The mean of the product over a leaf that straddles the columns is not the product of the means. */
static void pictures_are_times_colours(void **state)
{
	(void)state;
	static const uint8_t columns[2 * 3] = {255, 255, 255, 0, 0, 0};
	char text[2048] = "mtllib m.mtl\n";
	for (int k = 0; k < 4; k++) {
		const size_t length = strlen(text);
		const int x = k == 1 || k == 2, y = k / 2;
		snprintf(text + length, sizeof text - length, "v %d %d 0 %d 1 0\nvt %d %d\n", x, y, x, x, y);
	}
	strcat(text, "usemtl m\nf 1/1 2/2 3/3 4/4\n");
	assert_true(engine_image_write_png(path_of("columns.png"), 2, 1, columns, message, sizeof message));
	write_text("m.mtl", "newmtl m\nKd 0.9 0.9 0.9\nmap_Kd columns.png\n");
	for (int odd = 0; odd < 2; odd++) {
		played p = play(write_text("columns.obj", text), odd ? .34f : .25f, 0, OPTIONS_SIDES_OFF);
		double rho[2] = {0, 0};
		for (uint32_t k = 0; k < p.s.leaf_count; k++) {
			const gi_leaf *leaf = &p.s.leaves[k];
			double at[3];
			middle_of(leaf, at);
			for (int c = 0; c < 2; c++)
				rho[c] += (double)(leaf->area * leaf->rho[c]);
			if (!odd && at[0] < .5) {
				assert_float_equal(leaf->rho[0], .9 * at[0], 2e-3);
				assert_float_equal(leaf->rho[1], .9, 1e-5);
			} else if (!odd) {
				assert_float_equal(leaf->rho[1], 0, 1e-5);
			}
		}
		printf("  %u leaves: mean rho %.4f %.4f of 0.1125 0.4500\n", p.s.leaf_count, rho[0], rho[1]);
		assert_float_equal(rho[0], .9 / 8, 2e-3);
		assert_float_equal(rho[1], .9 / 2, 1e-4);
		stop(&p);
	}
}

/* ---- cages ---- */

enum { ROUND = 96, TALL = 64 }; /* faces of a sphere */

static void write_sphere_vertices(FILE *file, bool colored)
{
	const double pi = 3.14159265358979323846;
	for (int j = 0; j <= TALL; j++)
		for (int i = 0; i <= ROUND; i++) {
			const double a = 2 * pi * (i % ROUND) / ROUND, b = pi * j / TALL;
			fprintf(file, "v %.7f %.7f %.7f%s\nvt %.6f %.6f\n", sin(b) * cos(a), 1.2 - cos(b),
				sin(b) * sin(a),
				!colored      ? ""
				: cos(a) >= 0 ? " 0.9 0 0"
					      : " 0 0.9 0",
				(double)i / ROUND, (double)j / TALL);
		}
}

/* A sphere of radius 1 between two white walls, all on a black floor; its half of x > 0 is red, the other green. */
static const char *write_sphere(bool colored)
{
	const char *path = path_of("sphere.obj");
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fprintf(file, "mtllib s.mtl\n");
	write_sphere_vertices(file, colored);
	fprintf(file, "o sphere\nusemtl %s\n", colored ? "unknown" : "painted");
	for (int j = 0; j < TALL; j++)
		for (int i = 0; i < ROUND; i++) {
			const int a = j * (ROUND + 1) + i + 1, b = a + ROUND + 1;
			fprintf(file, "f %d/%d %d/%d %d/%d %d/%d\n", a, a, b, b, b + 1, b + 1, a + 1, a + 1);
		}
	fprintf(file, "o walls\nusemtl white\n"
		      "v 1.6 0 -1\nv 1.6 0 1\nv 1.6 2.4 1\nv 1.6 2.4 -1\nf -4 -3 -2 -1\n"
		      "v -1.6 0 1\nv -1.6 0 -1\nv -1.6 2.4 -1\nv -1.6 2.4 1\nf -4 -3 -2 -1\n");
	fclose(file);
	return path;
}

/* Columns of the texture from x = 1 round: red, green, green, red. */
static void write_sphere_library(void)
{
	static const uint8_t columns[4 * 3] = {255, 0, 0, 0, 255, 0, 0, 255, 0, 255, 0, 0};
	assert_true(engine_image_write_png(path_of("s.png"), 4, 1, columns, message, sizeof message));
	write_text("s.mtl", "newmtl painted\nKd 0.79 0.79 0.79\nmap_Kd s.png\nnewmtl white\nKd 0.8 0.8 0.8\n");
}

typedef struct side {
	double area, rho[3], h[3];
} side;

static void add_leaf(side *s, const gi_leaf *leaf)
{
	s->area += (double)leaf->area;
	for (int c = 0; c < 3; c++) {
		s->rho[c] += (double)(leaf->area * leaf->rho[c]);
		s->h[c] += (double)(leaf->area * leaf->irradiance[c]);
	}
}

static void check_sphere(const char *what, bool colored, float leaf_size)
{
	played p = play(write_sphere(colored), leaf_size, 500, OPTIONS_SIDES_OFF);
	side halves[2] = {{0}}, walls[2] = {{0}}; /* x > 0 first */
	uint32_t leaves = 0;
	for (uint32_t k = 0; k < p.s.leaf_count; k++) {
		const gi_leaf *leaf = &p.s.leaves[k];
		double at[3];
		middle_of(leaf, at);
		const bool sphere = leaf->object.index1 == p.file.handles[0].index1;
		add_leaf(&(sphere ? halves : walls)[at[0] < 0], leaf);
		leaves += sphere;
		if (!sphere || fabs(at[0]) < .25)
			continue;
		if (fabsf(leaf->rho[at[0] < 0] - .787f) > .01f || leaf->rho[at[0] > 0] > .005f)
			fail_msg("%s: a leaf at x %.2f reflects %g %g", what, at[0], (double)leaf->rho[0],
				 (double)leaf->rho[1]);
	}
	for (int k = 0; k < 2; k++) {
		printf("  %s, %u leaves: rho %.3f %.3f, H of the wall %.4f %.4f\n", what, leaves,
		       halves[k].rho[0] / halves[k].area, halves[k].rho[1] / halves[k].area,
		       walls[k].h[0] / walls[k].area, walls[k].h[1] / walls[k].area);
		assert_true(halves[k].rho[k] > .74 * halves[k].area && halves[k].rho[1 - k] < .05 * halves[k].area);
		assert_true(walls[k].h[k] > 1.2 * walls[k].h[1 - k]);
	}
	stop(&p);
}

static void cages_have_what_lies_near(void **state)
{
	(void)state;
	write_sphere_library();
	check_sphere("colours of vertices", true, 0);
	check_sphere("a texture", false, 0);
	check_sphere("a texture, smaller leaves", false, .12f);
}

/* A cage of a picture finer than its leaves gives all in all what the picture does: no part counts more than its area.
 * Columns of 64 texels, bright and dark; a mesh of 128 x 128 quads as a sheet that is bent. */
static void cages_keep_the_mean(void **state)
{
	(void)state;
	enum { SIDE = 128 };
	uint8_t columns[64 * 3];
	for (int k = 0; k < 64; k++)
		memset(columns + 3 * k, k % 4 ? 60 : 220, 3);
	assert_true(engine_image_write_png(path_of("s.png"), 64, 1, columns, message, sizeof message));
	write_text("s.mtl", "newmtl painted\nmap_Kd s.png\nmap_Ke s.png\n");
	const char *path = path_of("sheet.obj");
	FILE *file = fopen(path, "w");
	fprintf(file, "mtllib s.mtl\nusemtl painted\n");
	for (int j = 0; j <= SIDE; j++)
		for (int i = 0; i <= SIDE; i++) {
			const double x = (double)i / SIDE, y = (double)j / SIDE;
			fprintf(file, "v %.6f %.6f %.6f\nvt %.6f %.6f\n", x, .2 * sin(5 * x) * cos(4 * y), -y, x, y);
		}
	for (int j = 0; j < SIDE; j++)
		for (int i = 0; i < SIDE; i++) {
			const int a = j * (SIDE + 1) + i + 1, b = a + SIDE + 1;
			fprintf(file, "f %d/%d %d/%d %d/%d %d/%d\n", a, a, a + 1, a + 1, b + 1, b + 1, b, b);
		}
	fclose(file);
	played p = play(path, 0, 300, OPTIONS_SIDES_OFF);
	const float wanted = p.file.scene.materials[0].rho[0];
	double area = 0, rho = 0, exitance = 0;
	for (uint32_t k = 0; k < p.s.leaf_count; k++) {
		area += (double)p.s.leaves[k].area;
		rho += (double)(p.s.leaves[k].area * p.s.leaves[k].rho[0]);
		exitance += (double)(p.s.leaves[k].area * p.s.leaves[k].exitance[0]);
	}
	printf("  %u leaves: mean rho %.4f, E / pi %.4f of %.4f\n", p.s.leaf_count, rho / area,
	       exitance / area / 3.14159265, (double)wanted);
	assert_true(p.s.leaf_count < 700);
	assert_float_equal(rho / area, wanted, .02 * (double)wanted);
	assert_float_equal(exitance / area / 3.14159265, wanted, .02 * (double)wanted);
	stop(&p);
}

static int open_all(void **state)
{
	make_folder(state);
	return harness_open(state);
}

static int close_all(void **state)
{
	remove_folder(state);
	return harness_close(state);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(gradients_are_theirs_at_each_leaf),
	    cmocka_unit_test(pictures_are_times_colours),
	    cmocka_unit_test(cages_have_what_lies_near),
	    cmocka_unit_test(cages_keep_the_mean),
	};
	return cmocka_run_group_tests_name("leaves of files", tests, open_all, close_all);
}
