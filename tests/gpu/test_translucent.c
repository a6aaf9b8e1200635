/* Light below the surface of objects, in the solve: against a dense solution with the same links, against the closed form
 * of a half space under a light, what moves, and scenes that have none of it.
 */
#include "harness.h"
#include "scenes/body.h"
#include "scenes/shapes.h"
#include "snapshot.h"

#include "bits.h"
#include "dipole.h"
#include "object.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const float LAMP[3] = {30, 25, 20};

/* Of three colours with mean free paths of about a fifth, a half and a tenth of a ball's radius. */
static const gi_subsurface WAX = {{14, 6, 30}, {.2f, .3f, 2}, 1.4f};

/* ---- scenes ---- */

typedef struct made {
	gi_context *gi;
	gi_object room, lamp, ball, block;
} made;

static gi_object_def translucent_def(engine_mesh *mesh, const gi_subsurface *medium, const float position[3])
{
	gi_object_def def = scene_mesh_def(mesh);
	def.subsurface = medium;
	memcpy(def.pose.position, position, 3 * sizeof *position);
	return def;
}

static const float AT_BALL[3] = {-.3f, .5f, .1f};

/* Told once more for the test's own copy: the same mesh makes the same links. */
static void ball_mesh(engine_mesh *mesh)
{
	assert_true(shape_sphere(.35f, 8, mesh));
}

static gi_object add_ball(gi_context *gi, const gi_subsurface *medium)
{
	engine_mesh mesh;
	ball_mesh(&mesh);
	const gi_object_def def = translucent_def(&mesh, medium, AT_BALL);
	gi_object ball;
	assert_gi(gi_create_object(gi, &def, &ball));
	engine_mesh_free(&mesh);
	return ball;
}

static gi_object add_body(gi_context *gi, const char *name, bool ok, engine_mesh *mesh, const float rho[3],
			  const float exitance[3])
{
	assert_true(ok);
	const scene_body body = {.name = name, .rho = rho, .exitance = exitance};
	gi_object out;
	assert_gi(scene_add_body(gi, &body, mesh, &out));
	return out;
}

/* A closed room of 2 m, a lamp below its ceiling, a ball of the medium or of what is diffuse, a diffuse block. */
static made open_room(const gi_context_def *def, const gi_subsurface *medium)
{
	static const float walls[3] = {.7f, .6f, .5f}, blue[3] = {.2f, .3f, .8f}, black[3] = {0, 0, 0};
	made s = {.gi = harness_context(def)};
	engine_mesh mesh;
	bool ok = shape_box((const float[]){-1, 0, -1}, (const float[]){1, 2, 1}, 6, true, &mesh);
	s.room = add_body(s.gi, "room", ok, &mesh, walls, black);
	ok = shape_quad((const float[]){-.2f, 1.98f, -.2f}, (const float[]){.4f, 0, 0}, (const float[]){0, 0, .4f}, 2,
			2, &mesh);
	s.lamp = add_body(s.gi, "lamp", ok, &mesh, black, LAMP);
	s.ball = add_ball(s.gi, medium);
	ok = shape_box((const float[]){.2f, .01f, -.4f}, (const float[]){.6f, .7f, .1f}, 3, false, &mesh);
	s.block = add_body(s.gi, "block", ok, &mesh, blue, black);
	assert_gi(gi_commit(s.gi));
	return s;
}

/* ---- a dense solution ---- */

/* The object that the library built of the same definition. */
static scene_object build_copy(void)
{
	engine_mesh mesh;
	ball_mesh(&mesh);
	const gi_object_def def = translucent_def(&mesh, &WAX, AT_BALL);
	const gi_log log = {NULL, NULL, NULL};
	scene_object copy;
	assert_gi(object_build(&(object_builder){&log, NULL, 0}, &def, &copy));
	engine_mesh_free(&mesh);
	return copy;
}

/* value: of leaves, room behind them for clusters. */
static void pull(const gi_subsurface_links *l, double (*value)[3])
{
	for (uint32_t row = l->leaf_count; row < l->leaf_count + l->small_count + l->large_count; row++)
		for (int c = 0; c < 3; c++) {
			value[row][c] = 0;
			for (uint32_t k = l->first[row]; k < l->first[row + 1]; k++)
				value[row][c] +=
				    (double)gi_float_from_bits((&l->links[k].y)[c]) * value[l->links[k].x][c];
		}
}

/* B = E + rho W B, but R = S W B at the ball's leaves; by Jacobi to the last bit of a double. */
static void solve_dense(const snapshot *s, gi_object ball, const scene_object *copy, double (*b)[3])
{
	const gi_subsurface_links *l = &copy->subsurface;
	double(*h)[3] = calloc(s->leaf_count, sizeof *h);
	double(*value)[3] = calloc(l->leaf_count + l->small_count + l->large_count, sizeof *value);
	assert_true(h && value);
	uint32_t first = 0;
	while (s->leaves[first].object.index1 != ball.index1)
		first++;
	double change = 1;
	for (int sweep = 0; sweep < 2000 && change > 1e-13; sweep++) {
		memset(h, 0, sizeof *h * s->leaf_count);
		for (uint64_t k = 0; k < s->link_count; k++) {
			const gi_link *link = &s->links[k];
			for (int c = 0; c < 3 && link->leaf_count == 1; c++)
				h[link->leaf][c] += (double)link->weight * b[link->first_leaf][c];
		}
		memcpy(value, h + first, sizeof *value * l->leaf_count);
		pull(l, value);
		change = 0;
		for (uint32_t leaf = 0; leaf < s->leaf_count; leaf++)
			for (int c = 0; c < 3; c++) {
				double next = (double)s->leaves[leaf].rho[c] * h[leaf][c];
				if (leaf >= first && leaf < first + l->leaf_count) {
					next = 0;
					for (uint32_t k = l->first[leaf - first]; k < l->first[leaf - first + 1]; k++)
						next += (double)gi_float_from_bits((&l->links[k].y)[c]) *
							value[l->links[k].x][c];
				}
				next += (double)s->leaves[leaf].exitance[c];
				change = fmax(change, fabs(next - b[leaf][c]));
				b[leaf][c] = next;
			}
	}
	assert_true(change <= 1e-13);
	free(h);
	free(value);
}

static void check_certified(gi_context *gi, const made *s, const scene_object *copy, const gi_report *r,
			    const char *when)
{
	snapshot now = snapshot_take(gi);
	double(*b)[3] = calloc(now.leaf_count, sizeof *b), worst = 0, relative = 0, most[3] = {0, 0, 0};
	assert_non_null(b);
	solve_dense(&now, s->ball, copy, b);
	for (uint32_t leaf = 0; leaf < now.leaf_count; leaf++)
		for (int c = 0; c < 3; c++)
			most[c] = fmax(most[c], b[leaf][c] - (double)now.leaves[leaf].exitance[c]);
	for (uint32_t leaf = 0; leaf < now.leaf_count; leaf++)
		for (int c = 0; c < 3; c++) {
			const double off = fabs(b[leaf][c] - (double)now.leaves[leaf].radiosity[c]);
			const double light = b[leaf][c] - (double)now.leaves[leaf].exitance[c];
			worst = fmax(worst, off);
			relative = fmax(relative, off / (light + 1e-5 * most[c]));
		}
	print_message(
	    "%s: off by %.3g W/m2, certified %.3g; %.3g of the light, certified %.3g; q %.3f, A %.2f, %u sweeps\n",
	    when, worst, (double)r->solve_bound, relative, (double)r->solve_relative, (double)r->contraction,
	    (double)r->amplification, r->sweeps);
	assert_true(worst <= (double)r->solve_bound);
	/* The report counts by the light as it is stored. */
	assert_true(relative <= (double)r->solve_relative * (1 + 2 * (double)r->solve_relative) + 1e-7);
	assert_true(r->contraction < 1 && r->amplification >= 1);
	free(b);
	snapshot_free(&now);
}

static void bounds_hold_against_a_dense_solution(void **state)
{
	(void)state;
	harness_require_context();
	static const float tolerances[] = {.1f, 1e-2f, 1e-4f};
	scene_object copy = build_copy();
	for (size_t k = 0; k < sizeof tolerances / sizeof *tolerances; k++) {
		gi_context_def def = harness_def();
		def.row_tolerance = .05f;
		def.solve_tolerance = tolerances[k];
		made s = open_room(&def, &WAX);
		gi_report r = harness_update(s.gi);
		assert_true(r.outcome > 0);
		check_certified(s.gi, &s, &copy, &r, "from nothing");
		gi_pose pose = {{.3f, .6f, .3f}, {.1f, .2f, .3f, .9f}};
		assert_gi(gi_set_pose(s.gi, s.ball, pose));
		r = harness_update(s.gi);
		check_certified(s.gi, &s, &copy, &r, "after a move");
		assert_gi(gi_set_solve(s.gi, tolerances[k], 1));
		gi_reset_radiosity(s.gi);
		r = harness_update(s.gi);
		check_certified(s.gi, &s, &copy, &r, "one sweep");
		gi_context_destroy(s.gi);
	}
	object_free(&copy);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(bounds_hold_against_a_dense_solution),
	};
	return cmocka_run_group_tests(tests, harness_open, harness_close);
}
