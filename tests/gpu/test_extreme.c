/* Scenes at the ends of what numbers hold: very small and very large, very bright, very thin, touching, sealed, thrown
 * far away, many. After each the figures are finite, rows are sane, no energy is made, and the next ordinary frame is
 * right.
 */
#include "pieces.h"

#include "scenes/body.h"
#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const harness_object GREY = {.name = "grey", .levels = 2, .rho = {.5f, .5f, .5f}};

/* ---- what must hold in every scene ---- */

static void expect_finite_report(const gi_report *r, const char *what)
{
	const float values[] = {r->residual, r->contraction, r->solve_bound, r->solve_relative, r->radiosity_max};
	for (size_t k = 0; k < sizeof values / sizeof *values; k++)
		if (!(isfinite(values[k]) && values[k] >= 0))
			fail_msg("%s: value %zu of the report is %g", what, k, (double)values[k]);
	assert_true(r->contraction < 1);
}

static void expect_finite_light(const snapshot *s, const char *what)
{
	for (uint32_t k = 0; k < s->leaf_count; k++) {
		const gi_leaf *l = &s->leaves[k];
		for (int c = 0; c < 3; c++)
			if (!(isfinite(l->radiosity[c]) && l->radiosity[c] >= l->exitance[c] &&
			      isfinite(l->irradiance[c]) && l->irradiance[c] >= 0 && isfinite(l->row_sum)))
				fail_msg("%s: leaf %u: E %g, B %g, H %g, row sum %g", what, k, (double)l->exitance[c],
					 (double)l->radiosity[c], (double)l->irradiance[c], (double)l->row_sum);
	}
}

/* Rows sum to at most 1, so with B = E + rho F B the largest B is at most the largest E / (1 - largest rho); rounding
 * of the sweeps takes 1e-5 of it. */
static const double MAXIMUM_TOLERANCE = 1e-5;

/* Irradiance received by all over what all radiate: at most 1 but for the reciprocity of rows, whose visibility is one
 * ray an entry. */
static const double RECEIVED_TOLERANCE = 0.02;

/* Of leaves in one place all receive what the one on top does: it is counted once. */
static bool is_there_again(const snapshot *s, uint32_t leaf)
{
	for (uint32_t k = leaf + 1; k < s->leaf_count; k++)
		if (memcmp(s->leaves[leaf].corners, s->leaves[k].corners, sizeof s->leaves[k].corners) == 0)
			return true;
	return false;
}

static double expect_no_energy_made(const snapshot *s, const char *what)
{
	double received = 0, radiated = 0;
	for (int c = 0; c < 3; c++) {
		double e = 0, rho = 0, b = 0;
		for (uint32_t k = 0; k < s->leaf_count; k++) {
			const gi_leaf *l = &s->leaves[k];
			e = fmax(e, (double)l->exitance[c]);
			rho = fmax(rho, (double)l->rho[c]);
			b = fmax(b, (double)l->radiosity[c]);
			if (is_there_again(s, k))
				continue;
			received += (double)l->area * (double)l->irradiance[c];
			radiated += (double)l->area * (double)l->radiosity[c];
		}
		if (!(b <= e / (1 - rho) * (1 + MAXIMUM_TOLERANCE)))
			fail_msg("%s: B %g above E / (1 - rho) = %g", what, b, e / (1 - rho));
	}
	const double share = radiated > 0 ? received / radiated : 0;
	if (!(share <= 1 + RECEIVED_TOLERANCE))
		fail_msg("%s: received %g of what is radiated", what, share);
	return share;
}

/* Solves, checks all of the above, and hands the snapshot over. */
static snapshot expect_sane(gi_context *gi, const char *what)
{
	const gi_report r = solve(gi);
	expect_finite_report(&r, what);
	snapshot s = snapshot_take(gi);
	expect_finite_light(&s, what);
	expect_sane_rows(&s);
	const double share = expect_no_energy_made(&s, what);
	printf("  %s: %u leaves, %llu entries, received %.4f of what is radiated\n", what, s.leaf_count,
	       (unsigned long long)s.entry_count, share);
	return s;
}

/* The rows and B of the frame as it stands are those of a rebuild. */
static void expect_like_rebuilt(gi_context *gi, const char *what)
{
	const gi_report a = solve(gi);
	snapshot updated = snapshot_take(gi);
	gi_invalidate(gi);
	gi_reset_radiosity(gi);
	const gi_report b = solve(gi);
	snapshot rebuilt = snapshot_take(gi);
	snapshot_expect_same_rows(&updated, &rebuilt, what);
	assert_true(snapshot_distance(&updated, &rebuilt) <= (double)a.solve_bound + (double)b.solve_bound);
	assert_true(a.solve_bound <= 2e-4f * a.radiosity_max && b.solve_bound <= 2e-4f * b.radiosity_max);
	snapshot_free(&updated);
	snapshot_free(&rebuilt);
}

static void move_by(gi_context *gi, gi_object object, float x, float y, float z)
{
	gi_pose pose;
	assert_gi(gi_get_pose(gi, object, &pose));
	pose.position[0] += x;
	pose.position[1] += y;
	pose.position[2] += z;
	assert_gi(gi_set_pose(gi, object, pose));
}

/* The scene is sane, and still is after an ordinary move, whose rows are a rebuild's. Frees all. */
static void finish(gi_context *gi, gi_object mover, float step, const char *what)
{
	snapshot s = expect_sane(gi, what);
	snapshot_free(&s);
	move_by(gi, mover, step, .5f * step, -.25f * step);
	expect_like_rebuilt(gi, what);
	s = expect_sane(gi, "  and a move later");
	snapshot_free(&s);
	gi_context_destroy(gi);
}

static double mean_irradiance(const snapshot *s, gi_object object)
{
	double sum = 0;
	for (uint32_t k = 0; k < s->leaf_count; k++)
		if (s->leaves[k].object.index1 == object.index1)
			sum += (double)s->leaves[k].area * (double)s->leaves[k].irradiance[0];
	return sum / area_of(s, object);
}

/* ---- scale ---- */

static gi_object add_scaled(gi_context *gi, const harness_object *like, engine_mesh *mesh, float scale)
{
	for (uint32_t k = 0; k < 3 * mesh->vertex_count; k++)
		mesh->positions[k] *= scale;
	harness_object scaled = *like;
	for (int c = 0; c < 3; c++)
		scaled.position[c] *= scale;
	return harness_add(gi, &scaled, mesh);
}

typedef struct scaled_scene {
	gi_context *gi;
	gi_object ball;
} scaled_scene;

/* A room, open at the top for the sky's sake, with a lamp, a curved object and a turned block. */
static scaled_scene make_scaled(float scale)
{
	scaled_scene s = {.gi = open_context(0.02f)};
	engine_mesh mesh;
	assert_true(shape_box((float[]){-2, 0, -2}, (float[]){2, 3, 2}, 1, true, &mesh));
	mesh.face_count--;
	mesh.index_count -= 4;
	add_scaled(s.gi, &(harness_object){.name = "walls", .levels = 3, .rho = {.7f, .5f, .3f}}, &mesh, scale);
	assert_true(shape_quad((float[]){-.5f, 2.9f, -.5f}, (float[]){1, 0, 0}, (float[]){0, 0, 1}, 1, 1, &mesh));
	add_scaled(s.gi, &(harness_object){.name = "lamp", .levels = 1, .exitance = {20, 20, 20}}, &mesh, scale);
	assert_true(shape_sphere(.5f, 3, &mesh));
	s.ball = add_scaled(
	    s.gi,
	    &(harness_object){
		.name = "ball", .scheme = GI_SCHEME_CATMULL_CLARK, .rho = {.5f, .5f, .8f}, .position = {1, 1, .5f}},
	    &mesh, scale);
	assert_true(shape_box((float[]){-.45f, -.6f, -.5f}, (float[]){.45f, .6f, .5f}, 1, false, &mesh));
	const gi_object block =
	    add_scaled(s.gi, &(harness_object){.name = "block", .levels = 1, .rho = {.2f, .8f, .2f}}, &mesh, scale);
	assert_gi(gi_set_pose(s.gi, block, (gi_pose){{-.95f * scale, .8f * scale, -.5f * scale}, {.1f, .3f, 0, .9f}}));
	assert_gi(gi_commit(s.gi));
	return s;
}

/* A scale that is no power of two rounds every coordinate anew, by 6e-8: form factors follow by some hundred times that
 * where a node is seen at a grazing angle (1e-5 of the factor; and 1e-6 where large
 * angles cancel, five of which, up to pi each, the contour sum adds in single precision), a cut differs where an
 * estimate is the tolerance, and a ray where it passes within rounding of an edge. Factors below that floor are
 * rounding: of what is seen along its plane one is 0 and takes no ray, where another is 1e-9 and takes one; they are
 * not asked. */
static const double SCALED_FACTOR = 1e-5, SCALED_FACTOR_FLOOR = 1e-6, SCALED_OTHERS = 2e-3, SCALED_SEEN = 2e-4,
		    SCALED_RADIOSITY = 1e-4;

static void expect_scaled(const snapshot *a, const snapshot *b, double scale)
{
	uint64_t i = 0, j = 0, same = 0, others = 0, seen = 0, seen_otherwise = 0;
	double worst = 0;
	while (i < a->entry_count && j < b->entry_count) {
		const gi_entry *p = &a->entries[i], *q = &b->entries[j];
		if (p->leaf != q->leaf || p->node != q->node) {
			const bool first = p->leaf < q->leaf || (p->leaf == q->leaf && p->node < q->node);
			i += first;
			j += !first;
			others++;
			continue;
		}
		const double off = fabs((double)p->form_factor - (double)q->form_factor) - SCALED_FACTOR_FLOOR;
		if (off > SCALED_FACTOR * (double)p->form_factor)
			print_message("    leaf %u, node %u: F %.9g, and %.9g\n", p->leaf, p->node,
				      (double)p->form_factor, (double)q->form_factor);
		worst = fmax(worst, off / fmax((double)p->form_factor, 1e-30));
		if ((double)fmaxf(p->form_factor, q->form_factor) > SCALED_FACTOR_FLOOR) {
			seen_otherwise += p->visible != q->visible || p->samples != q->samples || p->back != q->back;
			seen++;
		}
		same++;
		i++;
		j++;
	}
	others += a->entry_count - i + b->entry_count - j;
	const double distance = snapshot_distance(a, b) / snapshot_largest(a);
	printf("  scaled by %g: %llu entries alike, F within %.1e; of %llu above rounding %llu seen otherwise; %llu in "
	       "one "
	       "alone; B within %.1e\n",
	       scale, (unsigned long long)same, fmax(worst, 0), (unsigned long long)seen,
	       (unsigned long long)seen_otherwise, (unsigned long long)others, distance);
	assert_true(worst <= SCALED_FACTOR);
	assert_true((double)others <= SCALED_OTHERS * (double)same);
	assert_true((double)seen_otherwise <= SCALED_SEEN * (double)seen);
	assert_true(distance <= SCALED_RADIOSITY);
}

static void scaled_scenes(void **state)
{
	(void)state;
	const float scales[] = {1e-6f, 1e6f, 1e8f};
	scaled_scene plain = make_scaled(1);
	snapshot a = expect_sane(plain.gi, "scale 1");
	gi_context_destroy(plain.gi);
	for (size_t k = 0; k < sizeof scales / sizeof *scales; k++) {
		scaled_scene scaled = make_scaled(scales[k]);
		snapshot b = expect_sane(scaled.gi, "scaled");
		expect_scaled(&a, &b, (double)scales[k]);
		snapshot_free(&b);
		finish(scaled.gi, scaled.ball, .3f * scales[k], "scaled, again");
	}
	snapshot_free(&a);
}

/* ---- sizes side by side ---- */

/* A floor and a lamp half its size above it, of every size, in one scene: each gets the same from its own lamp. The
 * others' lamps shine on it sideways from five sizes away: 1e-3 of its own light in sum; the rest is four rays a leaf.
 */
static const double SIZES_TOLERANCE = 0.01;

static void sizes(void **state)
{
	(void)state;
	const float of[] = {1e-4f, 1e-2f, 1, 1e2f, 1e4f, 1e6f};
	enum { SIZES = sizeof of / sizeof *of };
	gi_object floors[SIZES], lamp = {0};
	gi_context *gi = open_context(0.005f);
	for (int k = 0; k < SIZES; k++) {
		harness_object like = GREY;
		like.position[0] = 5 * of[k];
		floors[k] = add_quad(gi, &like, (float[]){0, 0, 0}, (float[]){0, 0, of[k]}, (float[]){of[k], 0, 0});
		like =
		    (harness_object){.name = "lamp", .exitance = {10, 10, 10}, .position = {5 * of[k], of[k] / 2, 0}};
		lamp = add_quad(gi, &like, (float[]){0, 0, 0}, (float[]){of[k], 0, 0}, (float[]){0, 0, of[k]});
	}
	assert_gi(gi_commit(gi));
	snapshot s = expect_sane(gi, "sizes from 1e-4 to 1e6");
	for (int k = 0; k < SIZES; k++) {
		const double h = mean_irradiance(&s, floors[k]), truth = mean_irradiance(&s, floors[2]);
		printf("    floor of %g: H %.5f\n", (double)of[k], h);
		assert_true(fabs(h / truth - 1) <= SIZES_TOLERANCE);
	}
	snapshot_free(&s);
	finish(gi, lamp, 1e3f, "sizes, the largest lamp moved");
}

/* ---- emission ---- */

enum { FACES = 6 };

/* A box whose six sides emit 1e-6 to 1e9. */
static gi_object add_many_lamps(gi_context *gi, float factor)
{
	static const uint32_t numbers[FACES] = {0, 1, 2, 3, 4, 5};
	engine_mesh mesh;
	assert_true(shape_box((float[]){-.5f, -.5f, -.5f}, (float[]){.5f, .5f, .5f}, 1, false, &mesh));
	gi_material materials[FACES];
	for (int k = 0; k < FACES; k++) {
		const float e = factor * powf(10, 3.0f * (float)k - 6);
		materials[k] = (gi_material){.rho = {.1f, .2f, .3f}, .exitance = {e, e, e}};
	}
	gi_object_def def = scene_mesh_def(&mesh);
	def.name = "six lamps";
	def.face_materials = numbers;
	def.materials = materials;
	def.material_count = FACES;
	def.levels = 1;
	gi_object object;
	assert_gi(gi_create_object(gi, &def, &object));
	engine_mesh_free(&mesh);
	return object;
}

static gi_context *bright_and_dim(float factor, gi_object *mover)
{
	gi_context *gi = open_context(0.02f);
	add_room(gi, &GREY, (box){{-3, -3, -3}, {3, 3, 3}});
	*mover = add_many_lamps(gi, factor);
	const float e = 1e-6f * factor, bright = 1e9f * factor;
	add_block(gi, &(harness_object){.name = "dim", .levels = 1, .rho = {.5f, .5f, .5f}, .exitance = {e, e, e}},
		  (box){{1, 1, 1}, {1.5f, 1.5f, 1.5f}});
	add_block(gi, &(harness_object){.name = "bright", .levels = 1, .exitance = {bright, bright, bright}},
		  (box){{-2, -2, -2}, {-1.5f, -1.5f, -1.5f}});
	assert_gi(gi_commit(gi));
	return gi;
}

/* Light is linear in emission; steps of the solve, in the largest B. */
static void emission(void **state)
{
	(void)state;
	gi_object mover, other;
	gi_context *gi = bright_and_dim(1, &mover);
	snapshot a = expect_sane(gi, "emission from 1e-6 to 1e9");
	finish(gi, mover, .4f, "emission, again");
	gi = bright_and_dim(1e-15f, &other);
	snapshot b = expect_sane(gi, "emission from 1e-21 to 1e-6");
	snapshot_expect_same_rows(&a, &b, "dimmed");
	double worst = 0;
	for (uint32_t k = 0; k < a.leaf_count; k++)
		worst = fmax(worst, fabs((double)a.leaves[k].radiosity[0] - 1e15 * (double)b.leaves[k].radiosity[0]));
	assert_true(worst <= 4e-6 * snapshot_largest(&a));
	snapshot_free(&a);
	snapshot_free(&b);
	gi_context_destroy(gi);
}

/* ---- slivers and small lights ---- */

/* Mean H of a floor of 2 x 2 m under a lamp u x v of the power, 1 m above. */
static double floor_under(const float u[3], const float v[3], bool triangle, float power, const char *what)
{
	gi_context *gi = open_context(0.005f);
	const gi_object floor = add_quad(gi, &(harness_object){.name = "floor", .levels = 3, .rho = {.5f, .5f, .5f}},
					 (float[]){-1, -1, -1}, (float[]){0, 0, 2}, (float[]){2, 0, 0});
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-.5f * (u[0] + v[0]), 0, -.5f * (u[2] + v[2])}, u, v, 1, 1, &mesh));
	const float area = fabsf(u[2] * v[0] - u[0] * v[2]) * (triangle ? .5f : 1);
	if (triangle) {
		mesh.face_counts[0] = 3;
		mesh.index_count = 3;
	}
	const float e = power / area;
	const gi_object lamp = harness_add(
	    gi, &(harness_object){.name = "lamp", .levels = triangle ? 0 : 2, .exitance = {e, e, e}}, &mesh);
	assert_gi(gi_commit(gi));
	snapshot s = expect_sane(gi, what);
	const double h = mean_irradiance(&s, floor);
	printf("    %s: H %.6f\n", what, h);
	snapshot_free(&s);
	finish(gi, lamp, .05f, what);
	return h;
}

/* The power is one; the width, up to a hundredth of the distance, changes what arrives by 1e-4, the rest is where the
 * receivers' points lie. */
static const double THIN_TOLERANCE = 0.01;

static void thin_lamps(void **state)
{
	(void)state;
	const double wide = floor_under((float[]){1, 0, 0}, (float[]){0, 0, 1e-2f}, false, 1, "a lamp 1 x 1e-2");
	const double thin = floor_under((float[]){1, 0, 0}, (float[]){0, 0, 1e-6f}, false, 1, "a lamp 1 x 1e-6");
	const double slanted =
	    floor_under((float[]){.6f, 0, .8f}, (float[]){-.8e-6f, 0, .6e-6f}, false, 1, "the same, slanted");
	const double triangle = floor_under((float[]){1, 0, 0}, (float[]){0, 0, 1e-6f}, true, 1, "a triangle 1 x 1e-6");
	assert_true(fabs(thin / wide - 1) <= THIN_TOLERANCE);
	assert_true(fabs(slanted / wide - 1) <= THIN_TOLERANCE);
	assert_true(fabs(triangle / wide - 1) <= THIN_TOLERANCE);
	const double small =
	    floor_under((float[]){1e-2f, 0, 0}, (float[]){0, 0, 1e-2f}, false, 1, "a lamp 1e-2 x 1e-2");
	const double tiny = floor_under((float[]){1e-5f, 0, 0}, (float[]){0, 0, 1e-5f}, false, 1, "a lamp 1e-5 x 1e-5");
	assert_true(fabs(tiny / small - 1) <= THIN_TOLERANCE);
	/* A point lamp in the middle, 1 m above 2 x 2 m: 0.55412 of its light (Howell's B-3, four times). */
	assert_true(fabs(4 * tiny / .55412 - 1) <= 2 * THIN_TOLERANCE);
}

/* Two squares in one object, one of 10 m that reflects and one of 1e-5 m that shines. The small one is a face as others
 * are: without it the scene is dark. */
static void small_face_of_a_large_object(void **state)
{
	(void)state;
	const float t = 1e-5f;
	const float positions[] = {-10, 0, -10, -10, 0, 10, 10, 0, 10, 10, 0, -10, 0, 5, 0, t, 5, 0, t, 5, t, 0, 5, t};
	const uint32_t indices[] = {0, 1, 2, 3, 4, 5, 6, 7}, numbers[] = {0, 1};
	const gi_material materials[] = {{.rho = {.5f, .5f, .5f}}, {.exitance = {1e10f, 1e10f, 1e10f}}};
	gi_object_def def = gi_object_def_default();
	def.name = "floor with a lamp";
	def.positions = positions;
	def.vertex_count = 8;
	def.indices = indices;
	def.index_count = 8;
	def.face_count = 2;
	def.face_materials = numbers;
	def.materials = materials;
	def.material_count = 2;
	def.levels = 3;
	gi_context *gi = open_context(0.01f);
	gi_object object;
	assert_gi(gi_create_object(gi, &def, &object));
	assert_gi(gi_commit(gi));
	snapshot s = expect_sane(gi, "a face of 1e-5 m in an object of 20 m");
	assert_int_equal(s.leaf_count, 128);
	double power = 0;
	for (uint32_t k = 0; k < s.leaf_count; k++)
		power +=
		    s.leaves[k].exitance[0] == 0 ? (double)s.leaves[k].area * (double)s.leaves[k].irradiance[0] : 0;
	printf("    of 1 W %.4f W arrive\n", power);
	/* Howell's B-3 four times, for 10 x 10 m 5 m below a point; leaves half as large as that is far are good to 1
	 * %. */
	assert_true(fabs(power / .83103 - 1) <= .01);
	snapshot_free(&s);
	finish(gi, object, .1f, "the same object moved");
}

/* A strip 1e-6 wide gets what the floor gets along its middle: as a quad and as a triangle. */
static void thin_receivers(void **state)
{
	(void)state;
	double h[3];
	for (int kind = 0; kind < 3; kind++) {
		const float width = kind == 0 ? 1e-2f : 1e-6f;
		gi_context *gi = open_context(0.005f);
		engine_mesh mesh;
		assert_true(shape_quad((float[]){-.5f, 0, -.5f * width}, (float[]){0, 0, width}, (float[]){1, 0, 0}, 1,
				       1, &mesh));
		if (kind == 2) {
			mesh.face_counts[0] = 3;
			mesh.index_count = 3;
		}
		const gi_object strip =
		    harness_add(gi, &(harness_object){.name = "strip", .levels = 3, .rho = {.5f, .5f, .5f}}, &mesh);
		const gi_object lamp = add_quad(gi, &(harness_object){.name = "lamp", .exitance = {1, 1, 1}},
						(float[]){-.5f, .5f, -.5f}, (float[]){1, 0, 0}, (float[]){0, 0, 1});
		assert_gi(gi_commit(gi));
		snapshot s = expect_sane(gi, kind == 2 ? "a triangle 1 x 1e-6 below a lamp" : "a strip below a lamp");
		h[kind] = mean_irradiance(&s, strip);
		printf("    H %.6f\n", h[kind]);
		snapshot_free(&s);
		finish(gi, lamp, .05f, "  again");
	}
	assert_true(fabs(h[1] / h[0] - 1) <= THIN_TOLERANCE);
	/* A triangle's mean lies towards its base, where the lamp ends: within what the strip's own ends differ. */
	assert_true(h[2] > .7 * h[0] && h[2] < 1.1 * h[0]);
}

/* ---- contact ---- */

static gi_context *lit_box(gi_object *lamp)
{
	gi_context *gi = open_context(0.02f);
	add_room(gi, &(harness_object){.name = "walls", .levels = 2, .rho = {.7f, .7f, .7f}},
		 (box){{-2, 0, -2}, {2, 3, 2}});
	*lamp = add_quad(gi, &(harness_object){.name = "lamp", .levels = 1, .exitance = {20, 20, 20}},
			 (float[]){-.5f, 2.9f, -.5f}, (float[]){1, 0, 0}, (float[]){0, 0, 1});
	return gi;
}

static gi_object add_sheet(gi_context *gi, float height, bool down)
{
	const float a[3] = {1, 0, 0}, b[3] = {0, 0, 1};
	return add_quad(gi, &GREY, (float[]){-.5f, height, -.5f}, down ? a : b, down ? b : a);
}

static void contact(void **state)
{
	(void)state;
	gi_object lamp, mover;
	gi_context *gi = lit_box(&lamp);
	mover = add_block(gi, &GREY, (box){{-1, 0, -1}, {0, 1, 0}});
	add_block(gi, &GREY, (box){{0, 0, -1}, {1, 1, 0}});
	add_block(gi, &GREY, (box){{-1, 1, -1}, {0, 2, 0}});
	finish(gi, (assert_gi(gi_commit(gi)), mover), .2f, "boxes that touch the floor and each other");

	gi = lit_box(&lamp);
	mover = add_block(gi, &GREY, (box){{-1, -.5f, -1}, {.5f, 1, .5f}});
	add_block(gi, &GREY, (box){{-.5f, .2f, -.5f}, {1, 1.4f, 1}});
	add_block(gi, &GREY, (box){{-2.5f, .5f, -2.5f}, {-1.5f, 1.4f, -1}});
	finish(gi, (assert_gi(gi_commit(gi)), mover), .2f, "boxes through each other and through walls");

	for (int down = 0; down < 2; down++) {
		gi = lit_box(&lamp);
		add_sheet(gi, 1, false);
		mover = add_sheet(gi, 1, down);
		finish(gi, (assert_gi(gi_commit(gi)), mover), .2f,
		       down ? "a sheet's back on another's" : "two sheets in one place");
	}
	for (int face = 0; face < 2; face++) {
		gi = lit_box(&lamp);
		add_sheet(gi, 1, face == 0);
		mover = add_sheet(gi, 1 - 1e-6f, face == 1);
		finish(gi, (assert_gi(gi_commit(gi)), mover), .2f,
		       face ? "back to back at 1e-6" : "face to face at 1e-6");
	}
	gi = lit_box(&lamp);
	add_block(gi, &GREY, (box){{-1, .5f, -1}, {0, 1, 0}});
	mover = add_block(gi, &GREY, (box){{-1, .5f, -1}, {0, 1, 0}});
	finish(gi, (assert_gi(gi_commit(gi)), mover), .2f, "two boxes in one place");
}

/* ---- sealed ---- */

static void add_wall(gi_context *gi, const float corner[3], const float u[3], const float v[3])
{
	const harness_object wall = {.name = "wall", .levels = 2, .rho = {.8f, .8f, .8f}, .double_sided = true};
	add_quad(gi, &wall, corner, u, v);
}

/* Six sheets without thickness about a cube of a side, its lower corner at (x, 0, 0); `first` is the one at x. */
static void add_cell(gi_context *gi, float x, float side, bool first)
{
	const float X[3] = {side, 0, 0}, Y[3] = {0, side, 0}, Z[3] = {0, 0, side}, low[3] = {x, 0, 0};
	if (first)
		add_wall(gi, low, Y, Z);
	add_wall(gi, (float[]){x + side, 0, 0}, Y, Z);
	add_wall(gi, low, X, Z);
	add_wall(gi, (float[]){x, side, 0}, X, Z);
	add_wall(gi, low, X, Y);
	add_wall(gi, (float[]){x, 0, side}, X, Y);
}

/* Inside the cube with a margin, or on its sides and facing in. */
static bool is_inside(const gi_leaf *l, float x, float side)
{
	const float middle[3] = {x + side / 2, side / 2, side / 2};
	float centre[3], normal[3], towards = 0;
	leaf_centre_and_normal(l, centre, normal);
	bool within = true, on_side = false;
	for (int c = 0; c < 3; c++) {
		const float off = fabsf(centre[c] - middle[c]) / (side / 2);
		within = within && off < 1.00001f;
		on_side = on_side || off > .99999f;
		towards += normal[c] * (middle[c] - centre[c]);
	}
	return within && (!on_side || towards > 0);
}

static void expect_dark_inside(gi_context *gi, float x, float side, uint32_t least, const char *what)
{
	solve(gi);
	snapshot s = snapshot_take(gi);
	expect_finite_light(&s, what);
	uint32_t dark = 0;
	for (uint32_t k = 0; k < s.leaf_count; k++) {
		const gi_leaf *l = &s.leaves[k];
		if (!is_inside(l, x, side))
			continue;
		dark++;
		if (l->radiosity[0] != 0 || l->irradiance[0] != 0)
			fail_msg("%s: leaf %u of the dark room has B %g, H %g", what, k, (double)l->radiosity[0],
				 (double)l->irradiance[0]);
	}
	assert_true(dark >= least);
	snapshot_free(&s);
}

static gi_pose at(float x, float y, float z)
{
	return (gi_pose){{x, y, z}, {0, 0, 0, 1}};
}

/* Two rooms with a wall in common. The lamp goes along the wall and up to 1e-4 before it, furniture moves in the dark.
 */
static void sealed_rooms(void **state)
{
	(void)state;
	gi_context *gi = open_context(0.02f);
	add_cell(gi, 0, 2, true);
	add_cell(gi, 2, 2, false);
	const gi_object lamp = add_block(gi, &(harness_object){.name = "lamp", .levels = 1, .exitance = {50, 50, 50}},
					 (box){{-.3f, -.3f, -.3f}, {.3f, .3f, .3f}});
	const gi_object ball = add_ball(gi, &(harness_object){.name = "ball in the dark", .rho = {.9f, .9f, .9f}}, .4f);
	assert_gi(gi_set_pose(gi, lamp, at(1, 1, 1)));
	assert_gi(gi_set_pose(gi, ball, at(3, 1, 1)));
	assert_gi(gi_commit(gi));
	const float gaps[] = {.5f, 1e-2f, 1e-3f, 1e-4f};
	for (int k = 0; k < 8; k++) {
		const float x = 1.7f - gaps[k % 4], y = .35f + .16f * (float)k, z = .31f + .19f * (float)k;
		assert_gi(gi_set_pose(gi, lamp, at(x, y, z)));
		assert_gi(
		    gi_set_pose(gi, ball, at(2.4f + gaps[(k + 2) % 4], 1.5f - .1f * (float)k, .5f + .14f * (float)k)));
		expect_dark_inside(gi, 2, 2, 6 * 16 + 54, "sealed rooms");
	}
	expect_like_rebuilt(gi, "sealed rooms");
	finish(gi, ball, -.05f, "two sealed rooms");
}

/* A sealed room of 1 m in a bright one of 2 km: a share of the way to the far walls is more than the small room. */
static void small_sealed_room(void **state)
{
	(void)state;
	gi_context *gi = open_context(0.02f);
	add_room(
	    gi, &(harness_object){.name = "walls", .levels = 2, .rho = {.5f, .5f, .5f}, .exitance = {1e5f, 1e5f, 1e5f}},
	    (box){{-1000, -1000, -1000}, {1000, 1000, 1000}});
	add_cell(gi, 0, 1, true);
	const gi_object ball = add_ball(gi, &(harness_object){.name = "ball in the dark", .rho = {.9f, .9f, .9f}}, .2f);
	assert_gi(gi_set_pose(gi, ball, at(.5f, .5f, .5f)));
	assert_gi(gi_commit(gi));
	expect_dark_inside(gi, 0, 1, 6 * 16 + 54, "a sealed room of 1 m in one of 2 km");
	finish(gi, ball, .05f, "a sealed room of 1 m in one of 2 km");
}

/* ---- thrown away and back ---- */

static void thrown(void **state)
{
	(void)state;
	for (int open = 0; open < 2; open++) {
		scaled_scene s = make_scaled(1);
		gi_pose home;
		assert_gi(gi_get_pose(s.gi, s.ball, &home));
		snapshot before = expect_sane(s.gi, "before the throw");
		const gi_pose away[] = {{{1e5f, 3e4f, -2e4f}, {.3f, .1f, .2f, .9f}}, {{-1e8f, 1e7f, 3}, {0, 1, 0, 0}}};
		assert_gi(gi_set_pose(s.gi, s.ball, away[open]));
		snapshot far = expect_sane(s.gi, "thrown away");
		snapshot_free(&far);
		expect_like_rebuilt(s.gi, "thrown away");
		assert_gi(gi_set_pose(s.gi, s.ball, home));
		snapshot back = expect_sane(s.gi, "and back");
		snapshot_expect_same_rows(&before, &back, "thrown away and back");
		assert_true(snapshot_distance(&before, &back) <= 2e-6 * snapshot_largest(&before));
		expect_like_rebuilt(s.gi, "and back");
		snapshot_free(&before);
		snapshot_free(&back);
		finish(s.gi, s.ball, .2f, "after the throw");
	}
}

/* ---- many ---- */

static void thousand_objects(void **state)
{
	(void)state;
	enum { MANY = 1000, MOVERS = 5 };
	gi_context *gi = open_context(0.05f);
	gi_object movers[MOVERS] = {{0}};
	for (int k = 0; k < MANY; k++) {
		const float x = (float)(k % 10), y = (float)(k / 10 % 10), z = (float)(k / 100);
		const bool lamp = k % 97 == 0;
		const harness_object like = {.name = "one of many",
					     .rho = {.5f, .5f, .5f},
					     .exitance = {lamp ? 5.0f : 0},
					     .position = {x, y, z}};
		const float u[3] = {.3f, .1f * (float)(k % 3), 0}, v[3] = {0, .05f * (float)(k % 5), .3f};
		const gi_object object = k % 50 == 7
					     ? add_block(gi, &like, (box){{0, 0, 0}, {.3f, .2f, .4f}})
					     : add_quad(gi, &like, (float[]){0, 0, 0}, k % 2 ? v : u, k % 2 ? u : v);
		if (k % 200 == 57)
			movers[k / 200] = object;
	}
	assert_gi(gi_commit(gi));
	snapshot s = expect_sane(gi, "a thousand objects");
	snapshot_free(&s);
	for (int k = 0; k < MOVERS; k++)
		move_by(gi, movers[k], .3f, -.2f, .1f);
	finish(gi, movers[0], .1f, "a thousand objects, five moved");
}

/* ---- next to nothing, and everything ---- */

static void next_to_nothing(void **state)
{
	(void)state;
	gi_context *gi = open_context(0.01f);
	assert_gi(gi_commit(gi));
	snapshot s = expect_sane(gi, "an empty scene");
	assert_true(s.leaf_count == 0 && s.entry_count == 0 && s.link_count == 0);
	snapshot_free(&s);

	/* One leaf; then one more, and light. */
	harness_object like = GREY;
	like.levels = 0;
	const gi_object leaf = add_quad(gi, &like, (float[]){-1, 0, -1}, (float[]){0, 0, 2}, (float[]){2, 0, 0});
	assert_gi(gi_commit(gi));
	s = expect_sane(gi, "one leaf without light");
	assert_true(s.leaf_count == 1 && s.leaves[0].radiosity[0] == 0);
	snapshot_free(&s);
	add_block(gi, &GREY, (box){{-.5f, .5f, -.5f}, {.5f, 1, .5f}});
	assert_gi(gi_commit(gi));
	s = expect_sane(gi, "no light at all");
	for (uint32_t k = 0; k < s.leaf_count; k++)
		for (int c = 0; c < 3; c++)
			assert_true(s.leaves[k].radiosity[c] == 0 && s.leaves[k].irradiance[c] == 0);
	snapshot_free(&s);
	assert_gi(gi_set_material(gi, leaf, 0, (gi_material){.rho = {.5f, .5f, .5f}, .exitance = {3, 2, 1}}));
	finish(gi, leaf, .1f, "and one leaf lit");
}

static void inside_out(void **state)
{
	(void)state;
	gi_object lamp;
	gi_context *gi = lit_box(&lamp);
	const gi_object turned = add_room(gi, &GREY, (box){{-.5f, .5f, -.5f}, {.5f, 1.5f, .5f}});
	add_ball(gi, &GREY, .3f);
	assert_gi(gi_commit(gi));
	snapshot s = expect_sane(gi, "a box inside out");
	/* Its black backs close it: nothing gets in. */
	for (uint32_t k = 0; k < s.leaf_count; k++)
		if (s.leaves[k].object.index1 == turned.index1)
			assert_true(s.leaves[k].radiosity[0] == 0);
	snapshot_free(&s);
	finish(gi, turned, .1f, "a box inside out, again");
}

static void black_and_shining(void **state)
{
	(void)state;
	for (int kind = 0; kind < 3; kind++) {
		const float rho = kind == 2 ? .999f : 0, e = kind ? 1 : 0;
		const harness_object like = {
		    .name = "all alike", .levels = 2, .rho = {rho, rho, rho}, .exitance = {e, e, e}};
		gi_context_def def = harness_def();
		def.row_tolerance = .02f;
		def.max_sweeps = 1000;
		def.solve_tolerance = kind == 2 ? 1e-3f : 1e-4f; /* single precision stops at 1e-7 / (1 - rho) */
		gi_context *gi = harness_context(&def);
		add_room(gi, &like, (box){{-2, 0, -2}, {2, 3, 2}});
		const gi_object block = add_block(gi, &like, (box){{-1, .5f, -1}, {0, 1, 0}});
		if (kind == 0)
			add_block(gi, &(harness_object){.name = "lamp", .exitance = {5, 5, 5}},
				  (box){{.5f, 1, .5f}, {1, 1.5f, 1}});
		assert_gi(gi_commit(gi));
		const char *names[] = {"rho 0 everywhere", "everything shines, rho 0", "everything shines, rho 0.999"};
		if (kind < 2) {
			finish(gi, block, .3f, names[kind]);
			continue;
		}
		snapshot s = expect_sane(gi, names[kind]);
		/* E / (1 - rho), within the solve's tolerance twice over. */
		for (uint32_t k = 0; k < s.leaf_count; k++)
			assert_true(fabs((double)s.leaves[k].radiosity[0] / 1000 - 1) <= 3e-3);
		snapshot_free(&s);
		gi_context_destroy(gi);
	}
}

/* ---- values no float arithmetic carries ---- */

static void expect_refused(gi_context *gi, gi_result got, gi_result wanted, const snapshot *before, const char *what)
{
	if (got != wanted)
		fail_msg("%s: %s", what, gi_result_text(got));
	assert_true(harness_last_message()[0] && !strchr(harness_last_message(), '\n'));
	assert_int_equal(harness_update(gi).outcome, GI_OUTCOME_AT_REST);
	snapshot now = snapshot_take(gi);
	snapshot_expect_same_rows(before, &now, what);
	snapshot_free(&now);
}

static void refusals(void **state)
{
	(void)state;
	scaled_scene s = make_scaled(1);
	solve(s.gi);
	snapshot before = snapshot_take(s.gi);
	const float far[] = {1e30f, -1e30f, 2e9f, NAN, INFINITY};
	for (size_t k = 0; k < sizeof far / sizeof *far; k++) {
		gi_pose pose = gi_pose_identity();
		pose.position[k % 3] = far[k];
		expect_refused(s.gi, gi_set_pose(s.gi, s.ball, pose), GI_ERROR_INVALID_POSE, &before, "a far pose");
	}
	const float bright[] = {1e30f, 1e13f};
	for (size_t k = 0; k < sizeof bright / sizeof *bright; k++)
		expect_refused(s.gi, gi_set_material(s.gi, s.ball, 0, (gi_material){.exitance = {0, bright[k], 0}}),
			       GI_ERROR_INVALID_MATERIAL, &before, "too bright");
	const struct {
		float scale, position;
		gi_result result;
	} objects[] = {
	    {1e-30f, 0, GI_ERROR_INVALID_GEOMETRY}, {1e-13f, 0, GI_ERROR_INVALID_GEOMETRY},
	    {1e-13f, 1, GI_ERROR_INVALID_GEOMETRY}, {2e9f, 0, GI_ERROR_INVALID_GEOMETRY},
	    {1e30f, 0, GI_ERROR_INVALID_GEOMETRY},  {1, 1e30f, GI_ERROR_INVALID_POSE},
	};
	for (size_t k = 0; k < sizeof objects / sizeof *objects; k++) {
		const float positions[] = {0, 0, 0, 0, 0, 1, 1, 0, 1, 1, 0, 0};
		const uint32_t indices[] = {0, 1, 2, 3};
		gi_object_def def = gi_object_def_default();
		def.positions = positions;
		def.vertex_count = 4;
		def.indices = indices;
		def.index_count = 4;
		def.face_count = 1;
		for (int c = 0; c < 3; c++)
			def.scale[c] = objects[k].scale;
		def.pose.position[1] = objects[k].position;
		gi_object made;
		expect_refused(s.gi, gi_create_object(s.gi, &def, &made), objects[k].result, &before, "an object");
	}
	snapshot_free(&before);
	finish(s.gi, s.ball, .1f, "after bad values");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(scaled_scenes),
	    cmocka_unit_test(sizes),
	    cmocka_unit_test(emission),
	    cmocka_unit_test(thin_lamps),
	    cmocka_unit_test(small_face_of_a_large_object),
	    cmocka_unit_test(thin_receivers),
	    cmocka_unit_test(contact),
	    cmocka_unit_test(sealed_rooms),
	    cmocka_unit_test(small_sealed_room),
	    cmocka_unit_test(thrown),
	    cmocka_unit_test(thousand_objects),
	    cmocka_unit_test(next_to_nothing),
	    cmocka_unit_test(inside_out),
	    cmocka_unit_test(black_and_shining),
	    cmocka_unit_test(refusals),
	};
	return cmocka_run_group_tests_name("extreme scenes", tests, harness_open, harness_close);
}
