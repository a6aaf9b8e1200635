/* Objects whose parts see nothing of each other: no cluster of them may lose light that is there, or bring light that
 * is not. Sources one behind the other against closed forms; what is sealed, behind a wall or behind slats against path
 * tracing.
 */
#include "harness.h"
#include "scenes/body.h"
#include "snapshot.h"

#include "tests/reference/reference_error.h"
#include "tests/reference/leaves.h"
#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double HALF_PER_CENT = 0.005;

static void expect_near(const char *what, double value, double truth, double relative)
{
	printf("  %-56s %.9f  truth %.9f  error %+.4f %%\n", what, value, truth, 100 * (value - truth) / truth);
	if (!(fabs(value - truth) <= relative * fabs(truth)))
		fail_msg("%s: %.9f is not %.9f within %g", what, value, truth, relative);
}

/* ---- sources one behind the other ---- */

/* Unit squares a gap c apart, facing each other (Howell's C-11). */
static double parallel_squares(double c)
{
	const double x = 1 / c, s = sqrt(1 + x * x), pi = 3.14159265358979323846;
	return 2 / (pi * x * x) * (log(s * s / sqrt(1 + 2 * x * x)) + 2 * x * s * atan(x / s) - 2 * x * atan(x));
}

/* From a point to the rectangle [0,a] x [0,b] at distance c, its corner on the point's normal; odd in a and b. */
static double point_to_corner(double a, double b, double c)
{
	const double x = a / c, y = b / c, u = sqrt(1 + x * x), v = sqrt(1 + y * y);
	return (x / u * atan(y / u) + y / v * atan(x / v)) / (2 * 3.14159265358979323846);
}

/* From the unit square to one at a distance, `shift` to the side: midpoint rule over points of the first, whose error
 * is below 1e-5 of it at these distances. */
static double shifted_squares(double shift, double c)
{
	enum { POINTS = 200 };
	double sum = 0;
	for (int i = 0; i < POINTS; i++)
		for (int j = 0; j < POINTS; j++) {
			const double u = (i + .5) / POINTS, v = (j + .5) / POINTS, low = shift - u, high = low + 1;
			sum += point_to_corner(high, 1 - v, c) - point_to_corner(low, 1 - v, c) -
			       point_to_corner(high, -v, c) + point_to_corner(low, -v, c);
		}
	return sum / (POINTS * POINTS);
}

/* 45 degrees about x, then about z: no plane of the scene is one of the axes' any more. */
static void turn(engine_mesh *mesh)
{
	const float s = sqrtf(.5f);
	for (uint32_t k = 0; k < mesh->vertex_count; k++) {
		float *p = mesh->positions + 3 * k;
		const float q[3] = {p[0], s * (p[1] - p[2]), s * (p[1] + p[2])};
		p[0] = s * (q[0] - q[1]);
		p[1] = s * (q[0] + q[1]);
		p[2] = q[2];
	}
}

typedef struct stack {
	float near, far, shift; /* distances from the receiver; the far part's shift to the side */
	bool boxes, turned;
	uint32_t levels;
	bool defaults; /* else rows are finer than a context's by default */
} stack;

static void append_part(engine_mesh *mesh, const stack *s, float distance, float shift)
{
	engine_mesh part;
	const float lower[3] = {shift, distance, 0}, upper[3] = {1 + shift, distance + .25f, 1};
	assert_true(s->boxes ? shape_box(lower, upper, 1, false, &part)
			     : shape_quad(lower, (float[]){1, 0, 0}, (float[]){0, 0, 1}, 1, 1, &part));
	assert_true(shape_append(mesh, &part));
}

static gi_object add_turned(gi_context *gi, const stack *s, const char *name, uint32_t levels, engine_mesh *mesh)
{
	if (s->turned)
		turn(mesh);
	return harness_add(gi, &(harness_object){.name = name, .levels = levels, .rho = {.5f, .5f, .5f}}, mesh);
}

/* From a unit square to an object of two parts, both facing it, the second behind the first. */
static double factor_to_stack(const stack *s)
{
	gi_context_def def = harness_def();
	if (!s->defaults) {
		def.row_tolerance = 0.002f;
		def.near_samples = 16;
	}
	gi_context *gi = harness_context(&def);
	engine_mesh square, parts = {0};
	assert_true(shape_quad((float[]){0, 0, 0}, (float[]){0, 0, 1}, (float[]){1, 0, 0}, 1, 1, &square));
	const gi_object receiver = add_turned(gi, s, "receiver", 3, &square);
	append_part(&parts, s, s->near, 0);
	append_part(&parts, s, s->far, s->shift);
	const gi_object source = add_turned(gi, s, "source", s->levels, &parts);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	double factor;
	assert_gi(gi_form_factor(gi, receiver, source, &factor));
	gi_context_destroy(gi);
	return factor;
}

/* Squares of one size, one right behind the other: the second is hidden from every point of the receiver. */
static void sources_one_behind_the_other(void **state)
{
	(void)state;
	static const float gaps[] = {.5f, 1, 1.5f, 2, 4, 8};
	for (int form = 0; form < 4; form++)
		for (size_t k = 0; k < sizeof gaps / sizeof *gaps; k++) {
			const stack s = {1, 1 + gaps[k], 0, form & 1, form >> 1, k % 2 ? 3 : 0, false};
			char what[80];
			snprintf(what, sizeof what, "%s%s, a second %.1f m behind the first",
				 s.boxes ? "boxes" : "squares", s.turned ? " at 45 degrees" : "", (double)gaps[k]);
			expect_near(what, factor_to_stack(&s), parallel_squares(1), HALF_PER_CENT);
		}
	static const float nears[] = {.5f, 2, 3};
	for (size_t k = 0; k < sizeof nears / sizeof *nears; k++) {
		const stack s = {nears[k], nears[k] + 5, 0, false, k == 1, 3, false};
		char what[80];
		snprintf(what, sizeof what, "squares, the first at %.1f m, a second 5 m behind", (double)nears[k]);
		expect_near(what, factor_to_stack(&s), parallel_squares(nears[k]), HALF_PER_CENT);
	}
}

/* The same without any option, at other distances too. */
static void by_default(void **state)
{
	(void)state;
	static const float nears[] = {.5f, .7f, 1, 1.4f, 2, 3}, gaps[] = {.5f, 1.3f, 5};
	/* From 3 m the squares are 3 % of what a row sees, and some eight entries of a ray each: closing makes them
	 * good for what the rays to all else missed. */
	static const double far_tolerance = .01;
	for (int form = 0; form < 4; form++)
		for (size_t k = 0; k < sizeof nears / sizeof *nears; k++) {
			const float gap = gaps[k % 3];
			const stack s = {nears[k], nears[k] + gap, 0, form & 1, form >> 1, k % 2 ? 3 : 0, true};
			char what[80];
			snprintf(what, sizeof what, "default: %s%s at %.1f m, a second %.1f m behind",
				 s.boxes ? "boxes" : "squares", s.turned ? " at 45 degrees" : "", (double)s.near,
				 (double)gap);
			expect_near(what, factor_to_stack(&s), parallel_squares((double)s.near),
				    s.near < 3 ? HALF_PER_CENT : far_tolerance);
		}
}

/* A second square so far to the side that the first hides none of it. */
static void sources_side_by_side_at_two_distances(void **state)
{
	(void)state;
	static const float fars[] = {1.5f, 2, 4};
	for (int turned = 0; turned < 2; turned++)
		for (size_t k = 0; k < sizeof fars / sizeof *fars; k++) {
			const stack s = {1, fars[k], fars[k] + .1f, false, turned, 3, false};
			char what[80];
			snprintf(what, sizeof what, "squares%s at 1 and %.1f m, side by side",
				 turned ? " at 45 degrees" : "", (double)fars[k]);
			expect_near(what, factor_to_stack(&s),
				    parallel_squares(1) + shifted_squares((double)s.shift, (double)s.far),
				    HALF_PER_CENT);
		}
}

/* ---- scenes: each mesh is put together from rectangles, every one of cells of about the leaf size ---- */

enum { MATERIALS = 2 };

/* A mesh on its way, its faces' materials: 0 reflects, 1 is a lamp. */
typedef struct body {
	engine_mesh mesh;
	uint32_t lamps; /* so many faces, the last ones, are a lamp */
	float cell;
	bool two_sided;
} body;

static void rectangle(body *b, const float corner[3], const float u[3], const float v[3])
{
	assert_true(shape_append_quad(&b->mesh, corner, u, v, b->cell));
}

/* Sides of a box, facing outward or inward; `without`: a side that is left out, 0 to 5, or 6. */
static void box_sides(body *b, const float lower[3], const float upper[3], bool inward, int without)
{
	for (int side = 0; side < 6; side++) {
		const int axis = side / 2, next = (axis + 1) % 3, last = (axis + 2) % 3;
		float corner[3] = {lower[0], lower[1], lower[2]}, u[3] = {0}, v[3] = {0};
		if (side & 1)
			corner[axis] = upper[axis];
		u[next] = upper[next] - lower[next];
		v[last] = upper[last] - lower[last];
		const bool turned = (side & 1) == (int)inward;
		if (side != without)
			rectangle(b, corner, turned ? v : u, turned ? u : v);
	}
}

static void cube_lamp(body *b, const float centre[3], float edge)
{
	const uint32_t before = b->mesh.face_count;
	float lower[3], upper[3];
	for (int c = 0; c < 3; c++) {
		lower[c] = centre[c] - edge / 2;
		upper[c] = centre[c] + edge / 2;
	}
	box_sides(b, lower, upper, false, 6);
	b->lamps += b->mesh.face_count - before;
}

/* A square lamp that looks down. */
static void ceiling_lamp(body *b, const float centre[3], float edge)
{
	const uint32_t before = b->mesh.face_count;
	rectangle(b, (float[]){centre[0] - edge / 2, centre[1], centre[2] - edge / 2}, (float[]){edge, 0, 0},
		  (float[]){0, 0, edge});
	b->lamps += b->mesh.face_count - before;
}

static gi_object finish(gi_context *gi, const char *name, body *b)
{
	const gi_material materials[MATERIALS] = {{.rho = {.7f, .7f, .7f}}, {.exitance = {100, 100, 100}}};
	uint32_t *of_faces = calloc(b->mesh.face_count, sizeof *of_faces);
	assert_non_null(of_faces);
	for (uint32_t f = b->mesh.face_count - b->lamps; f < b->mesh.face_count; f++)
		of_faces[f] = 1;
	gi_object_def def = scene_mesh_def(&b->mesh);
	def.name = name;
	def.face_materials = of_faces;
	def.materials = materials;
	def.material_count = MATERIALS;
	def.double_sided = b->two_sided;
	gi_object object;
	if (gi_create_object(gi, &def, &object))
		fail_msg("%s: %s", name, harness_last_message());
	free(of_faces);
	engine_mesh_free(&b->mesh);
	return object;
}

static gi_context *open_scene(float row_tolerance, uint32_t estimate_leaves, gi_sky sky)
{
	gi_context_def def = harness_def();
	def.row_tolerance = row_tolerance;
	def.solve_tolerance = 1e-5f;
	def.estimate_leaves = estimate_leaves;
	def.sky = sky;
	return harness_context(&def);
}

static gi_report first_update(gi_context *gi)
{
	assert_gi(gi_commit(gi));
	return harness_update(gi);
}

static void add_room(gi_context *gi, const float upper[3], float cell)
{
	body room = {.cell = cell};
	box_sides(&room, (float[]){0, 0, 0}, upper, true, 6);
	finish(gi, "room", &room);
}

/* ---- errors against path tracing ---- */

typedef struct judged {
	reference_error error; /* of H, all leaves */
	double estimate;       /* relative, mean of some updates */
	double entries;        /* per leaf */
	float least_sum, most_sum;
} judged;

static double *widened(const gi_leaf *leaves, uint32_t count)
{
	double *h = calloc(3 * (size_t)count, sizeof *h);
	assert_non_null(h);
	leaf_irradiance(leaves, count, h);
	return h;
}

/* Noise of the reference drops out; 1,024 paths leave the measure a standard error of about 0.1 % of H. */
static const uint32_t PATHS = 1024;

static judged judge(gi_context *gi)
{
	enum { UPDATES = 4 };
	judged j = {.least_sum = 1};
	double squared = 0;
	gi_report r = {0};
	assert_gi(gi_commit(gi));
	for (int k = 0; k < UPDATES; k++) {
		gi_reset_radiosity(gi);
		r = harness_update(gi);
		squared += (double)r.sampling_squared / UPDATES;
	}
	snapshot s = snapshot_take(gi);
	leaf_scene scene;
	reference_result traced;
	assert_true(leaf_scene_make(s.leaves, s.leaf_count, &scene));
	assert_true(reference_trace(&scene.scene, harness_paths(PATHS), 1, &traced));
	double *h = widened(s.leaves, s.leaf_count), power = 0, area = 0;
	assert_true(reference_error_measure(h, traced.irradiance[0], traced.irradiance[1], scene.areas, s.leaf_count,
					    &j.error));
	for (uint32_t k = 0; k < s.leaf_count; k++) {
		for (uint32_t c = 0; c < 3; c++)
			power += scene.areas[k] * h[3 * k + c] * h[3 * k + c];
		area += scene.areas[k];
		j.least_sum = fminf(j.least_sum, s.leaves[k].row_sum);
		j.most_sum = fmaxf(j.most_sum, s.leaves[k].row_sum);
	}
	j.estimate = sqrt(fmax(0, squared) / (power / area));
	j.entries = (double)r.entries / r.leaves;
	free(h);
	reference_result_free(&traced);
	leaf_scene_free(&scene);
	snapshot_free(&s);
	return j;
}

static void expect_at_most(const char *what, double value, double limit)
{
	if (!(value <= limit))
		fail_msg("%s: %g is more than %g", what, value, limit);
}

/* The least that a row of a closed scene sums to before it is closed: less than 0.8 would be a source that is lost. */
static double least_row(gi_context *gi)
{
	snapshot s = snapshot_take(gi);
	double *sums = calloc(s.leaf_count, sizeof *sums), least = INFINITY;
	assert_non_null(sums);
	for (uint64_t k = 0; k < s.entry_count; k++)
		if (s.entries[k].samples > 0)
			sums[s.entries[k].leaf] +=
			    (double)s.entries[k].form_factor * s.entries[k].visible / s.entries[k].samples;
	for (uint32_t l = 0; l < s.leaf_count; l++)
		least = fmin(least, sums[l]);
	free(sums);
	snapshot_free(&s);
	return least;
}

static void expect_error(const char *what, gi_context *gi, float cell, double limit)
{
	const judged j = judge(gi);
	const double least = least_row(gi);
	printf(
	    "  %-40s %4.0f entries per leaf, error of H %5.2f %% (bias %+.2f %%), estimate %5.2f %%, rows sum to %.2f "
	    "at least\n",
	    what, j.entries, 100 * j.error.rms, 100 * j.error.bias, 100 * j.estimate, least);
	gi_context_destroy(gi);
	assert_true(least >= .8);
	expect_at_most(what, j.error.rms, limit);
	expect_at_most("estimate over error", j.estimate, 2 * j.error.rms);
	/* Light that varies within a leaf is not seen by it (docs/accuracy.md): in leaves of 0.5 m that is most of the
	 * error. */
	if (cell <= .25f)
		expect_at_most("error over estimate", j.error.rms, 2 * j.estimate);
}

/* Floor, ceiling and walls of the open cells of a plan, a metre each; '#' is closed. */
static void add_plan(gi_context *gi, const char *const *rows, int count, float height, float cell)
{
	body b = {.cell = cell};
	for (int z = 0; z < count; z++)
		for (int x = 0; rows[z][x]; x++) {
			if (rows[z][x] == '#')
				continue;
			const float p[3] = {(float)x, 0, (float)z}, top[3] = {p[0], height, p[2]}, ex[3] = {1, 0, 0},
				    ez[3] = {0, 0, 1}, up[3] = {0, height, 0};
			rectangle(&b, p, ez, ex);
			rectangle(&b, top, ex, ez);
			if (rows[z][x - 1] == '#')
				rectangle(&b, p, up, ez);
			if (rows[z][x + 1] == '#')
				rectangle(&b, (float[]){p[0] + 1, 0, p[2]}, ez, up);
			if (rows[z - 1][x] == '#')
				rectangle(&b, p, ex, up);
			if (rows[z + 1][x] == '#')
				rectangle(&b, (float[]){p[0], 0, p[2] + 1}, up, ex);
		}
	finish(gi, "corridor", &b);
}

/* Round three corners: walls of one mesh that look the same way, one behind the other. */
static void corridor_with_three_bends(void **state)
{
	(void)state;
	static const char *const plan[] = {"##########", "#........#", "#........#", "######...#",
					   "######...#", "#........#", "#........#", "#..#######",
					   "#..#######", "#..#######", "##########"};
	for (int k = 0; k < 2; k++) {
		const float cell = k ? .25f : .5f;
		gi_context *gi = open_scene(.01f, 512, GI_SKY_OFF);
		add_plan(gi, plan, 11, 2.5f, cell);
		body lamp = {.cell = cell};
		ceiling_lamp(&lamp, (float[]){2, 2.45f, 2}, .6f);
		finish(gi, "lamp", &lamp);
		char what[80];
		snprintf(what, sizeof what, "corridor, leaves of %.2f m", (double)cell);
		expect_error(what, gi, cell, .02);
	}
}

/* Slats before a lamp that covers most of a wall: flat ones of two sides, upright and tilted, and thin boxes. */
static void thirty_slats_before_a_lamp(void **state)
{
	(void)state;
	static const char *const names[] = {"flat", "tilted", "boxes"};
	for (int form = 0; form < 3; form++)
		for (int k = 0; k < (harness_is_long() ? 2 : 1); k++) {
			const float cell = k ? .25f : .5f;
			gi_context *gi = open_scene(.01f, 512, GI_SKY_AUTO);
			add_room(gi, (float[]){5, 3, 4}, cell);
			body lamp = {.cell = cell}, slats = {.cell = cell, .two_sided = form < 2};
			rectangle(&lamp, (float[]){.05f, .25f, .8f}, (float[]){0, 2.5f, 0}, (float[]){0, 0, 2.4f});
			lamp.lamps = lamp.mesh.face_count;
			for (int n = 0; n < 30; n++) {
				const float y = .2f + 2.6f * ((float)n + .5f) / 30, corner[3] = {.4f, y, .6f};
				if (form == 2)
					box_sides(&slats, corner, (float[]){.5f, y + .02f, 3.4f}, false, 6);
				else
					rectangle(&slats, corner, (float[]){0, 0, 2.8f},
						  (float[]){.08f, form ? .03f : 0, 0});
			}
			finish(gi, "lamp", &lamp);
			finish(gi, "slats", &slats);
			char what[80];
			snprintf(what, sizeof what, "slats, %s, leaves of %.2f m", names[form], (double)cell);
			expect_error(what, gi, cell, .08);
		}
}

/* ---- light that has to stay where it is ---- */

typedef struct seen {
	double mean, most; /* H */
	uint32_t lit, count;
} seen;

/* Of the leaves of an object whose centres are in a box. */
static seen look(const snapshot *s, gi_object object, const float lower[3], const float upper[3])
{
	seen sum = {0};
	double area = 0;
	for (uint32_t k = 0; k < s->leaf_count; k++) {
		const gi_leaf *l = &s->leaves[k];
		bool inside = l->object.index1 == object.index1;
		for (int c = 0; c < 3; c++) {
			const float x =
			    .25f * (l->corners[0][c] + l->corners[1][c] + l->corners[2][c] + l->corners[3][c]);
			inside = inside && x >= lower[c] && x <= upper[c];
		}
		if (!inside)
			continue;
		sum.count++;
		sum.lit += l->irradiance[0] > 0;
		sum.most = fmax(sum.most, (double)l->irradiance[0]);
		sum.mean += (double)l->area * (double)l->irradiance[0];
		area += (double)l->area;
	}
	sum.mean /= area > 0 ? area : 1;
	return sum;
}

static const float EVERYWHERE[2][3] = {{-1e6f, -1e6f, -1e6f}, {1e6f, 1e6f, 1e6f}};

static void expect_dark(const char *what, gi_context *gi, gi_object outside)
{
	first_update(gi);
	snapshot s = snapshot_take(gi);
	const seen o = look(&s, outside, EVERYWHERE[0], EVERYWHERE[1]);
	printf("  %-56s %u of %u leaves outside are lit, most %g\n", what, o.lit, o.count, o.most);
	snapshot_free(&s);
	gi_context_destroy(gi);
	assert_true(o.count > 0);
	assert_int_equal(o.lit, 0);
}

static gi_object add_outer_room(gi_context *gi, float cell)
{
	body room = {.cell = cell};
	box_sides(&room, (float[]){0, 0, 0}, (float[]){5, 3, 4.5f}, true, 6);
	return finish(gi, "outer room", &room);
}

static const float TOLERANCES[] = {.1f, .01f};

/* A bulb in a box of two sides; the bulb is an object or a part of the box's mesh. */
static void sealed_box(void **state)
{
	(void)state;
	for (int form = 0; form < 4; form++)
		for (int k = 0; k < 2; k++) {
			gi_context *gi = open_scene(TOLERANCES[k], 0, GI_SKY_AUTO);
			const gi_object room = add_outer_room(gi, .5f);
			body box = {.cell = form & 2 ? .1f : .3f, .two_sided = true}, bulb = {.cell = .1f};
			box_sides(&box, (float[]){2.1f, 1, 1.3f}, (float[]){2.7f, 1.7f, 1.9f}, false, 6);
			cube_lamp(form & 1 ? &box : &bulb, (float[]){2.4f, 1.4f, 1.6f}, .11f);
			finish(gi, "box", &box);
			if (!(form & 1))
				finish(gi, "bulb", &bulb);
			char what[80];
			snprintf(what, sizeof what, "box of two sides, bulb %s, %s, at %g",
				 form & 1 ? "in its mesh" : "apart", form & 2 ? "fine" : "coarse",
				 (double)TOLERANCES[k]);
			expect_dark(what, gi, room);
		}
}

/* Thick walls round a lit room: outside and inside as one mesh or as two, turned or not, the lamp in the mesh too. */
static void house_with_thick_walls(void **state)
{
	(void)state;
	for (int form = 0; form < 4; form++)
		for (int k = 0; k < 2; k++) {
			gi_context *gi = open_scene(TOLERANCES[k], 0, GI_SKY_AUTO);
			const gi_object room = add_outer_room(gi, .5f);
			body outside = {.cell = .4f}, inside = {.cell = .4f};
			body *in = form & 1 ? &inside : &outside;
			box_sides(&outside, (float[]){1, .01f, 1}, (float[]){3.4f, 2.2f, 3.5f}, false, 6);
			box_sides(in, (float[]){1.2f, .2f, 1.2f}, (float[]){3.2f, 2, 3.3f}, true, 6);
			ceiling_lamp(in, (float[]){2.2f, 1.9f, 2.2f}, .5f);
			const gi_object house = finish(gi, "house", &outside);
			gi_pose pose = gi_pose_identity();
			if (form & 2)
				pose = (gi_pose){{.3f, .15f, .1f}, {.03f, .06f, .02f, 1}};
			assert_gi(gi_set_pose(gi, house, pose));
			if (form & 1)
				assert_gi(gi_set_pose(gi, finish(gi, "house, inside", &inside), pose));
			char what[80];
			snprintf(what, sizeof what, "house of %s%s, at %g", form & 1 ? "two meshes" : "one mesh",
				 form & 2 ? ", turned" : "", (double)TOLERANCES[k]);
			expect_dark(what, gi, room);
		}
}

/* A shade of two sides with a hole in its bottom, round a bulb, `shift` metres to the side. */
static gi_object add_shade_and_room(gi_context *gi, float cell, float shift)
{
	const float lower[3] = {1.7f + shift, 1.2f, 1.7f}, upper[3] = {2.3f + shift, 1.8f, 2.3f};
	body shade = {.cell = .1f, .two_sided = true}, bulb = {.cell = .1f};
	const gi_object room = add_outer_room(gi, cell);
	box_sides(&shade, lower, upper, false, 2);
	for (int n = 0; n < 9; n++)
		if (n != 4)
			rectangle(&shade,
				  (float[]){lower[0] + .2f * (float)(n % 3), lower[1], lower[2] + .2f * (float)(n / 3)},
				  (float[]){.2f, 0, 0}, (float[]){0, 0, .2f});
	cube_lamp(&bulb, (float[]){2 + shift, 1.5f, 2}, .1f);
	finish(gi, "shade", &shade);
	finish(gi, "bulb", &bulb);
	return room;
}

/* Area-weighted mean square of H's error over own light, as gi_report.sampling_local has it, without the noise of the
 * reference. */
static double local_error(const snapshot *s, const leaf_scene *scene, const reference_result *traced)
{
	static const double DARK = .01;
	double area = 0, power = 0, sum = 0;
	for (uint32_t k = 0; k < s->leaf_count; k++) {
		const double h = (double)s->leaves[k].irradiance[0];
		area += scene->areas[k];
		power += scene->areas[k] * h * h;
	}
	for (uint32_t k = 0; k < s->leaf_count; k++) {
		const double h = (double)s->leaves[k].irradiance[0];
		sum += scene->areas[k] * (h - traced->irradiance[0][3 * k]) * (h - traced->irradiance[1][3 * k]) /
		       (h * h + DARK * DARK * power / area);
	}
	return sum / area;
}

/* The room has the light that a small hole lets out, in the mean over some places: a row takes one ray for each part of
 * the shade's bright inside. The report says how far single leaves are off, which the scene's light would hide. */
static void lampshade_with_a_hole(void **state)
{
	(void)state;
	if (!harness_is_long()) { /* its noise takes five rooms */
		print_message("  a shade with a hole: skipped, RELUME_LONG=1 runs it\n");
		skip();
	}
	enum { PLACES = 5 };
	double mean = 0, truth = 0, local = 0, estimated = 0;
	for (int k = 0; k < PLACES; k++) {
		gi_context *gi = open_scene(.01f, 512, GI_SKY_AUTO);
		const gi_object room = add_shade_and_room(gi, .25f, .1f * (float)k);
		const gi_report r = first_update(gi);
		snapshot s = snapshot_take(gi);
		leaf_scene scene;
		reference_result traced;
		assert_true(leaf_scene_make(s.leaves, s.leaf_count, &scene));
		assert_true(reference_trace(&scene.scene, harness_paths(2 * PATHS), 1, &traced));
		mean += look(&s, room, EVERYWHERE[0], EVERYWHERE[1]).mean;
		double area = 0, light = 0;
		for (uint32_t n = 0; n < s.leaf_count; n++)
			if (s.leaves[n].object.index1 == room.index1) {
				light +=
				    .5 * scene.areas[n] * (traced.irradiance[0][3 * n] + traced.irradiance[1][3 * n]);
				area += scene.areas[n];
			}
		truth += light / area;
		local += local_error(&s, &scene, &traced) / PLACES;
		estimated += (double)r.sampling_local_squared / PLACES;
		reference_result_free(&traced);
		leaf_scene_free(&scene);
		snapshot_free(&s);
		gi_context_destroy(gi);
	}
	expect_near("H in the room round a shade with a hole", mean / PLACES, truth / PLACES, .05);
	printf("  error over own light %.1f %%, sampling_local %.1f %%\n", 100 * sqrt(local), 100 * sqrt(estimated));
	assert_true(estimated > local / 4 && estimated < local * 4);
}

/* Two rooms in one shell, parted by a wall 0.2 m thick whose faces are `at` and 0.2 m behind. Returns H of the dark
 * room over that of the lit one. */
static double leak(float cell, float at, bool one_mesh)
{
	gi_context *gi = open_scene(.01f, 0, GI_SKY_AUTO);
	body shell = {.cell = cell}, wall = {.cell = cell}, lamp = {.cell = .4f};
	box_sides(&shell, (float[]){0, 0, 0}, (float[]){8, 3, 4}, true, 6);
	box_sides(one_mesh ? &shell : &wall, (float[]){at, -.01f, -.01f}, (float[]){at + .2f, 3.01f, 4.01f}, false, 6);
	const gi_object rooms = finish(gi, "rooms", &shell);
	if (!one_mesh)
		finish(gi, "wall", &wall);
	ceiling_lamp(&lamp, (float[]){2, 2.9f, 2}, .8f);
	finish(gi, "lamp", &lamp);
	first_update(gi);
	snapshot s = snapshot_take(gi);
	const float edge = .55f * cell; /* leaves of which more is in the wall than in the room are left out */
	const seen lit = look(&s, rooms, (float[]){-1, -1, -1}, (float[]){at - edge, 4, 5}),
		   dark = look(&s, rooms, (float[]){at + .2f + edge, -1, -1}, (float[]){9, 4, 5});
	printf("  wall at %.2f m, leaves of %.3f m, %s: H %.4f in the lit room, %.6f in the dark one, %.4f %%\n",
	       (double)at, (double)cell, one_mesh ? "one mesh" : "two meshes", lit.mean, dark.mean,
	       100 * dark.mean / lit.mean);
	snapshot_free(&s);
	gi_context_destroy(gi);
	return dark.mean / lit.mean;
}

/* Leaves that reach through the wall shine on both sides: what that brings at leaves of 0.5, 0.25 and 0.125 m, with
 * exact rows. Where leaves end at the wall nothing comes through. */
static void dark_room_beside_a_bright_one(void **state)
{
	(void)state;
	static const float cells[] = {.5f, .25f, .125f};
	static const double allowed[] = {.031, .015, .0066};
	for (int k = 0; k < 3; k++) {
		expect_at_most("light through the wall", leak(cells[k], 3.9f, false), allowed[k]);
		if (k < 2)
			expect_at_most("light through the wall of one mesh", leak(cells[k], 3.9f, true), allowed[k]);
	}
	for (int one_mesh = 0; one_mesh < 2; one_mesh++)
		expect_at_most("light through a wall where leaves end", leak(.2f, 4, one_mesh), 0);
}

/* ---- emitters ---- */

/* A room that emits all over costs no more than one of whose sides one does. */
static void where_everything_emits(void **state)
{
	(void)state;
	double entries[3], rays[3];
	for (int k = 0; k < 3; k++) {
		gi_context *gi = open_scene(.01f, 0, GI_SKY_AUTO);
		body room = {.cell = .25f};
		box_sides(&room, (float[]){0, 0, 0}, (float[]){4, 3, 4}, true, 6);
		room.lamps = k == 0 ? 0 : k == 1 ? 192 : room.mesh.face_count;
		finish(gi, "room", &room);
		const gi_report r = first_update(gi);
		entries[k] = (double)r.entries / r.leaves;
		rays[k] = (double)r.rays / r.leaves;
		printf("  %s: %.0f entries and %.0f rays per leaf, %.0f MiB\n",
		       k == 0   ? "nothing emits"
		       : k == 1 ? "one side emits"
				: "everything emits",
		       entries[k], rays[k], (double)r.gpu_bytes / 1048576);
		gi_context_destroy(gi);
	}
	expect_at_most("entries where everything emits", entries[2], 1.01 * entries[0]);
	expect_at_most("entries where one side emits", entries[1], 3 * entries[0]);
}

int main(void)
{
	setvbuf(stdout, NULL, _IOLBF, 0);
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(sources_one_behind_the_other),
	    cmocka_unit_test(by_default),
	    cmocka_unit_test(sources_side_by_side_at_two_distances),
	    cmocka_unit_test(corridor_with_three_bends),
	    cmocka_unit_test(thirty_slats_before_a_lamp),
	    cmocka_unit_test(sealed_box),
	    cmocka_unit_test(house_with_thick_walls),
	    cmocka_unit_test(lampshade_with_a_hole),
	    cmocka_unit_test(dark_room_beside_a_bright_one),
	    cmocka_unit_test(where_everything_emits),
	};
	return cmocka_run_group_tests_name("clusters", tests, harness_open, harness_close);
}
