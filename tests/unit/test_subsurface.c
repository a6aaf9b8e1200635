/* Subsurface scattering of one object, on the CPU: the dipole against the formulas of the paper, links against the
 * closed forms of a half space that is lit in part, and no more light out than in. */
#include "cages.h"

#include "bits.h"
#include "dipole.h"
#include "subsurface.h"

#include <float.h>
#include <stdlib.h>

static const double PI = 3.14159265358979323846;

/* ---- the paper, written out (Jensen and others 2001, section 2.1) ---- */

typedef struct paper {
	double s, a, index; /* sigma_s', sigma_a */
} paper;

static double paper_exitance(paper m, double r)
{
	const double extinction = m.s + m.a, share = m.s / extinction, transport = sqrt(3 * m.a * extinction);
	const double n = m.index, fdr = -1.440 / (n * n) + 0.710 / n + 0.668 + 0.0636 * n;
	const double boundary = (1 + fdr) / (1 - fdr), diffusion = 1 / (3 * extinction);
	const double zr = 1 / extinction, zv = zr + 4 * boundary * diffusion;
	const double dr = sqrt(r * r + zr * zr), dv = sqrt(r * r + zv * zv);
	return share / (4 * PI) *
	       (zr * (transport * dr + 1) * exp(-transport * dr) / (dr * dr * dr) +
		zv * (transport * dv + 1) * exp(-transport * dv) / (dv * dv * dv));
}

static double paper_albedo(paper m)
{
	const double share = m.s / (m.s + m.a), root = sqrt(3 * (1 - share)), n = m.index;
	const double fdr = -1.440 / (n * n) + 0.710 / n + 0.668 + 0.0636 * n, boundary = (1 + fdr) / (1 - fdr);
	return share / 2 * (1 + exp(-4.0 / 3 * boundary * root)) * exp(-root);
}

/* Integral of R_d from r on over whole circles, or over the part of them beyond a line at distance `line`; in steps
 * that grow with r. */
static double paper_beyond(paper m, double from, double line)
{
	const double mean_free_path = 1 / (m.s + m.a);
	double sum = 0;
	for (double r = from; r < 1e6 * (mean_free_path + from);) {
		const double step = 1e-3 * fmax(r - line, 0) + 1e-4 * fmin(mean_free_path, line > 0 ? line : 1e30);
		const double at = r + 0.5 * step;
		sum += step * at * paper_exitance(m, at) * (line > 0 ? 2 * acos(line / at) : 2 * PI);
		r += step;
	}
	return sum;
}

static const paper MEDIA[] = {{1000, 1, 1.3}, {2190, 2.1, 1.5}, {100, 30, 1.33}, {50, 0, 1.4}, {1, 9, 1}};
enum { MEDIA_COUNT = sizeof MEDIA / sizeof *MEDIA };

static gi_dipole dipole_of(paper m)
{
	return gi_dipole_of(m.s, m.a, m.index);
}

static void the_dipole_is_the_papers(void **state)
{
	(void)state;
	for (size_t k = 0; k < MEDIA_COUNT; k++) {
		const paper m = MEDIA[k];
		const gi_dipole d = dipole_of(m);
		CHECK_NEAR(gi_dipole_albedo(&d), paper_albedo(m), 1e-12);
		for (double r = 1e-5; r < 1; r *= 3) {
			const double expected = paper_exitance(m, r);
			CHECK_NEAR(gi_dipole_exitance(&d, r * r), expected, 1e-12 * expected);
			/* The sum's steps are a thousandth. */
			const double beyond = paper_beyond(m, r, 0);
			CHECK_NEAR(2 * PI * gi_dipole_beyond(&d, r * r), beyond, 1e-4 * paper_albedo(m));
		}
	}
}

/* Steepness bounds the differential, here and farther out. */
static void steepness_bounds_the_slope(void **state)
{
	(void)state;
	for (size_t k = 0; k < MEDIA_COUNT; k++) {
		const gi_dipole d = dipole_of(MEDIA[k]);
		for (double r = 1e-5; r < 1; r *= 1.7) {
			const double here = gi_dipole_exitance(&d, r * r), step = 1e-6 * r;
			const double slope = (here - gi_dipole_exitance(&d, (r + step) * (r + step))) / step;
			assert_true(slope <= 1.001 * gi_dipole_steepness(&d, r) * here);
			assert_true(gi_dipole_steepness(&d, 2 * r) <= gi_dipole_steepness(&d, r));
		}
	}
}

/* ---- links ---- */

typedef struct lit {
	gi_hierarchy h;
	gi_subsurface_links links;
	double *value; /* of each leaf and cluster: irradiance */
} lit;

static gi_subsurface grey(paper m)
{
	const float s = (float)m.s, a = (float)m.a;
	return (gi_subsurface){{s, s, s}, {a, a, a}, (float)m.index};
}

static void build(lit *l, const test_cage *cage, uint32_t levels, gi_subsurface medium)
{
	build_cage(cage, levels, &l->h);
	assert_true(gi_subsurface_build(&l->h, &medium, &l->links));
	const gi_subsurface_links *s = &l->links;
	l->value = calloc(s->leaf_count + s->small_count + s->large_count, sizeof *l->value);
	assert_non_null(l->value);
}

static void end(lit *l)
{
	gi_hierarchy_free(&l->h);
	gi_subsurface_free(&l->links);
	free(l->value);
}

static double weight_of(gi_uvec4 link, int channel)
{
	return (double)gi_float_from_bits((&link.x)[1 + channel]);
}

static double row_of(const lit *l, uint32_t row, int channel)
{
	double sum = 0;
	for (uint32_t k = l->links.first[row]; k < l->links.first[row + 1]; k++)
		sum += weight_of(l->links.links[k], channel) * l->value[l->links.links[k].x];
	return sum;
}

/* Clusters of the leaves' values. */
static void pull(lit *l)
{
	const gi_subsurface_links *s = &l->links;
	for (uint32_t row = s->leaf_count; row < s->leaf_count + s->small_count + s->large_count; row++)
		l->value[row] = row_of(l, row, 0);
}

static gi_vec4 centre_of(const lit *l, uint32_t leaf)
{
	const uint32_t *corners = &l->h.topology[l->h.leaf_node[leaf]].corners.x;
	gi_vec4 c = {0, 0, 0, 0};
	for (int k = 0; k < 4; k++) {
		c.x += 0.25f * l->h.vertices[corners[k]].x;
		c.y += 0.25f * l->h.vertices[corners[k]].y;
		c.z += 0.25f * l->h.vertices[corners[k]].z;
	}
	return c;
}

static double area_of(const lit *l, uint32_t leaf)
{
	return (double)l->h.geometry[l->h.leaf_node[leaf]].moment.w;
}

/* The square [-1, 1]^2. */
static void cage_plate(test_cage *t)
{
	cage_begin(t, GI_REFINE_BILINEAR);
	for (int k = 0; k < 4; k++)
		cage_vertex(t, k == 1 || k == 2 ? 1.0f : -1.0f, k > 1 ? 1.0f : -1.0f, 0);
	cage_face(t, 4, (uint32_t[]){0, 1, 2, 3});
}

/* A plate lit where x < 0, seen along its middle: B over the leaf is the integral of R_d over the lit half plane. */
static void check_half_plane(paper m)
{
	enum { LEVELS = 5, SIDE = 1 << LEVELS };
	const double leaf = 2.0 / SIDE;
	test_cage cage;
	lit l;
	cage_plate(&cage);
	build(&l, &cage, LEVELS, grey(m));
	for (uint32_t k = 0; k < l.h.leaf_count; k++)
		l.value[k] = centre_of(&l, k).x < 0;
	pull(&l);
	double worst = 0;
	for (uint32_t k = 0; k < l.h.leaf_count; k++) {
		const gi_vec4 c = centre_of(&l, k);
		if (fabs((double)c.y) > leaf || fabs((double)c.x) > 0.3)
			continue;
		/* Simpson's rule over the leaf, of which one side may lie on the line. */
		const double near = fabs((double)c.x) - 0.5 * leaf, far = fabs((double)c.x) + 0.5 * leaf;
		const double steps[] = {near, 0.75 * near + 0.25 * far, 0.5 * (near + far), 0.25 * near + 0.75 * far,
					far};
		const double rule[] = {1, 4, 2, 4, 1};
		double beyond = 0;
		for (int s = 0; s < 5; s++) {
			const double line = fmax(steps[s], 1e-6 * leaf);
			beyond += rule[s] / 12 * paper_beyond(m, line, line);
		}
		const double expected = c.x < 0 ? paper_albedo(m) - beyond : beyond;
		const double off = fabs(row_of(&l, k, 0) - expected) / fmax(expected, 1e-3 * paper_albedo(m));
		worst = fmax(worst, off);
	}
	print_message("half plane, leaves of %g mean free paths: worst off by %.2f %%, %.1f links a leaf\n",
		      leaf * (m.s + m.a), 100 * worst, (double)l.links.first[l.h.leaf_count] / l.h.leaf_count);
	assert_true(worst <= 0.05);
	end(&l);
}

static void a_half_lit_plate_is_the_closed_form(void **state)
{
	(void)state;
	check_half_plane((paper){160, 1.6, 1.3});
	check_half_plane((paper){16, 2, 1.3});
	check_half_plane((paper){16, .5, 1.5});
	check_half_plane((paper){50, 5, 1.4});
}

/* ---- no more out than in ---- */

/* Of all that enters at each leaf, how much leaves; and the sums of rows. */
static void check_sums(const char *name, const test_cage *cage, uint32_t levels, gi_subsurface medium, double sums[2])
{
	lit l;
	build(&l, cage, levels, medium);
	const gi_subsurface_links *s = &l.links;
	const uint32_t rows = s->leaf_count + s->small_count + s->large_count;
	double *out = calloc(rows, sizeof *out), most[2] = {0, 0}, area = 0;
	assert_non_null(out);
	sums[0] = sums[1] = 0;
	for (int c = 0; c < 3; c++) {
		memset(out, 0, sizeof *out * rows);
		for (uint32_t row = rows; row-- > 0;) {
			const double from = row < s->leaf_count ? area_of(&l, row) : 0;
			double sum = 0;
			for (uint32_t k = s->first[row]; row < s->leaf_count && k < s->first[row + 1]; k++) {
				sum += weight_of(s->links[k], c);
				out[s->links[k].x] += from * weight_of(s->links[k], c);
			}
			most[0] = fmax(most[0], sum / (double)s->albedo[c]);
			sums[0] += c == 0 ? from * sum : 0;
		}
		for (uint32_t row = rows; row-- > s->leaf_count;)
			for (uint32_t k = s->first[row]; k < s->first[row + 1]; k++)
				out[s->links[k].x] += out[row] * weight_of(s->links[k], c);
		for (uint32_t leaf = 0; leaf < s->leaf_count; leaf++)
			most[1] = fmax(most[1], out[leaf] / area_of(&l, leaf) / (double)s->albedo[c]);
	}
	for (uint32_t leaf = 0; leaf < s->leaf_count; leaf++)
		area += area_of(&l, leaf);
	sums[0] /= area;
	sums[1] = (double)s->albedo[0];
	print_message("%s: of a half space's %.4f on average %.4f leaves; rows, columns at most %.7f, %.7f of it\n",
		      name, sums[1], sums[0], most[0], most[1]);
	assert_true(most[0] <= 1 && most[1] <= 1);
	free(out);
	end(&l);
}

/* A slab as thin as told, with both faces. */
static void cage_slab(test_cage *t, float thickness)
{
	cage_cube(t, GI_REFINE_BILINEAR);
	for (uint32_t k = 0; k < t->cage.vertex_count; k++)
		t->positions[3 * k + 2] *= thickness / 2;
}

static void no_more_light_leaves_than_entered(void **state)
{
	(void)state;
	const gi_subsurface skin = {{740, 880, 1010}, {32, 170, 480}, 1.3f}, milk = {{30, 40, 60}, {0, .1f, 1}, 1.3f};
	test_cage cage;
	double sums[2];
	cage_cube(&cage, GI_REFINE_CATMULL_CLARK);
	check_sums("round, of skin", &cage, 3, skin, sums);
	check_sums("round, of milk", &cage, 3, milk, sums);
	/* A sphere gives back what a half space does but for what it is too small for. */
	assert_true(sums[0] <= sums[1] && sums[0] >= 0.9 * sums[1]);
	cage_cube(&cage, GI_REFINE_BILINEAR);
	check_sums("cube of milk", &cage, 3, milk, sums);
	cage_slab(&cage, 0.01f);
	check_sums("slab of milk", &cage, 3, milk, sums);
	/* Both faces of it see nearly the same: without the limit it would give back almost twice as much. */
	assert_true(sums[0] <= sums[1] && sums[0] >= 0.85 * sums[1]);
}

/* ---- extremes ---- */

static double diagonal_of(const lit *l, uint32_t leaf)
{
	double sum = 0;
	for (uint32_t k = l->links.first[leaf]; k < l->links.first[leaf + 1]; k++)
		sum += l->links.links[k].x == leaf ? weight_of(l->links.links[k], 0) : 0;
	return sum;
}

/* Mean free paths far below leaves: each leaf gives back its own light, as a diffuse surface of the half space's
 * albedo. */
static void dense_media_are_diffuse(void **state)
{
	(void)state;
	const paper media[] = {{1e8, 1e6, 1.3}, {1e9, 1e9, 1.5}, {1e9, 0, 1.5}};
	for (size_t k = 0; k < 3; k++) {
		test_cage cage;
		lit l;
		cage_cube(&cage, GI_REFINE_CATMULL_CLARK);
		build(&l, &cage, 3, grey(media[k]));
		const double albedo = fmin(paper_albedo(media[k]), 0.9999);
		for (uint32_t leaf = 0; leaf < l.h.leaf_count; leaf++)
			CHECK_NEAR(diagonal_of(&l, leaf), albedo, 1e-3 * albedo);
		end(&l);
	}
}

/* Mean free paths far above the object, or a colour that nothing scatters: nothing comes back, and all numbers are
 * numbers. */
static void thin_media_are_black(void **state)
{
	(void)state;
	const gi_subsurface media[] = {{{1e-6f, 0, 1e-3f}, {0, 0, 1e-5f}, 1.3f},
				       {{0, 0, 0}, {1e9f, 1, 0}, 2.5f},
				       {{FLT_MIN, 1e-30f, 0}, {0, FLT_MIN, FLT_MIN}, 1}};
	for (size_t k = 0; k < 3; k++) {
		test_cage cage;
		double sums[2];
		lit l;
		cage_cube(&cage, GI_REFINE_CATMULL_CLARK);
		check_sums("nearly empty", &cage, 2, media[k], sums);
		build(&l, &cage, 2, media[k]);
		for (uint32_t n = 0; n < l.links.first[l.links.leaf_count]; n++)
			for (int c = 0; c < 3; c++)
				assert_true(weight_of(l.links.links[n], c) < 1e-3);
		end(&l);
	}
}

static void faulty_media_are_told(void **state)
{
	(void)state;
	assert_null(gi_subsurface_fault(&(gi_subsurface){{0, 1, 1e9f}, {0, 1, 1e9f}, 1}));
	assert_non_null(gi_subsurface_fault(&(gi_subsurface){{-1, 1, 1}, {0, 1, 1}, 1.3f}));
	assert_non_null(gi_subsurface_fault(&(gi_subsurface){{1, 1, 1}, {0, 1, NAN}, 1.3f}));
	assert_non_null(gi_subsurface_fault(&(gi_subsurface){{1, INFINITY, 1}, {0, 1, 1}, 1.3f}));
	assert_non_null(gi_subsurface_fault(&(gi_subsurface){{1, 1, 1}, {0, 1, 1}, 0.9f}));
	assert_non_null(gi_subsurface_fault(&(gi_subsurface){{1, 1, 1}, {0, 1, 1}, 2.6f}));
}

/* ---- clusters ---- */

/* One row by brute force: points on a fine grid over each leaf, no clusters. */
static double brute_row(const lit *l, uint32_t leaf, paper m)
{
	enum { GRID = 6 };
	const gi_vec4 to = centre_of(l, leaf);
	double sum = 0;
	for (uint32_t from = 0; from < l->h.leaf_count; from++) {
		const uint32_t *v = &l->h.topology[l->h.leaf_node[from]].corners.x;
		for (int k = 0; k < GRID * GRID; k++) {
			const float s = ((float)(k % GRID) + 0.5f) / GRID, t = ((float)(k / GRID) + 0.5f) / GRID;
			const float rule[4] = {(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t};
			double squared = 0;
			for (int c = 0; c < 3; c++) {
				double at = 0;
				for (int i = 0; i < 4; i++)
					at += (double)(rule[i] * (&l->h.vertices[v[i]].x)[c]);
				squared += (at - (double)(&to.x)[c]) * (at - (double)(&to.x)[c]);
			}
			sum += l->value[from] * area_of(l, from) / (GRID * GRID) * paper_exitance(m, sqrt(squared));
		}
	}
	return sum;
}

/* Light from one side on a round body: rows by links and clusters against brute force, at media as fine as leaves and
 * coarser, where a point stands for the leaf that receives. */
static void clusters_stand_for_their_leaves(void **state)
{
	(void)state;
	const paper media[] = {{5, .1, 1.3}, {12, .5, 1.5}};
	for (size_t k = 0; k < 2; k++) {
		test_cage cage;
		lit l;
		cage_cube(&cage, GI_REFINE_CATMULL_CLARK);
		build(&l, &cage, 4, grey(media[k]));
		for (uint32_t leaf = 0; leaf < l.h.leaf_count; leaf++)
			l.value[leaf] = fmax((double)centre_of(&l, leaf).z, 0);
		pull(&l);
		double worst = 0, largest = 0;
		for (uint32_t leaf = 0; leaf < l.h.leaf_count; leaf += 7) {
			const double expected = brute_row(&l, leaf, media[k]);
			worst = fmax(worst, fabs(row_of(&l, leaf, 0) - expected));
			largest = fmax(largest, expected);
		}
		print_message(
		    "round: worst off by %.2f %% of the largest, %u leaves, %.1f links each, %u + %u clusters\n",
		    100 * worst / largest, l.links.leaf_count,
		    (double)l.links.first[l.links.leaf_count] / l.links.leaf_count, l.links.small_count,
		    l.links.large_count);
		assert_true(worst <= 0.01 * largest);
		end(&l);
	}
}

/* Four times the leaves have far less than four times the links each. */
static void links_grow_slowly(void **state)
{
	(void)state;
	double links[2];
	for (uint32_t k = 0; k < 2; k++) {
		test_cage cage;
		lit l;
		cage_cube(&cage, GI_REFINE_CATMULL_CLARK);
		build(&l, &cage, 3 + k, grey((paper){20, .1, 1.3}));
		links[k] = (double)l.links.first[l.links.leaf_count] / l.links.leaf_count;
		end(&l);
	}
	print_message("links a leaf: %.1f, with four times the leaves %.1f\n", links[0], links[1]);
	assert_true(links[1] < 2 * links[0]);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(the_dipole_is_the_papers),
	    cmocka_unit_test(steepness_bounds_the_slope),
	    cmocka_unit_test(a_half_lit_plate_is_the_closed_form),
	    cmocka_unit_test(no_more_light_leaves_than_entered),
	    cmocka_unit_test(dense_media_are_diffuse),
	    cmocka_unit_test(thin_media_are_black),
	    cmocka_unit_test(faulty_media_are_told),
	    cmocka_unit_test(clusters_stand_for_their_leaves),
	    cmocka_unit_test(links_grow_slowly),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
