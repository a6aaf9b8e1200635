/* A street of rooms: what a mover in one of them costs follows what can see it, not how long the street is; and what
 * walls hide it from is left alone without a bit being another.
 */
#include "snapshot.h"

#include "scenes/body.h"
#include "scenes/shapes.h"
#include "tests/bench/scale_world.h"

#include <math.h>
#include <stdio.h>

static void open_street(scale_world *w, uint32_t objects)
{
	gi_context_def def = harness_def();
	def.row_tolerance = .3f;
	const scale_settings settings = {
	    .kind = SCALE_STREET, .objects = objects, .cell = 1, .cells = 1, .fixed = true};
	scale_world_build(w, harness_context(&def), &settings);
	assert_gi(gi_commit(w->gi));
	harness_update(w->gi);
}

static void close_street(scale_world *w)
{
	gi_context_destroy(w->gi);
	scale_world_free(w);
}

/* What the same move costs, once it is known which walls hide the mover. */
static gi_report cost_of_a_move(uint32_t objects)
{
	scale_world w;
	open_street(&w, objects);
	gi_report r = {0};
	for (uint32_t round = 0; round < 3; round++) {
		scale_world_move(&w, 0, round);
		r = harness_update(w.gi);
	}
	printf("  %3u rooms, %5u leaves: a move takes %u rays, flags %u entries, cuts %u\n", w.places, r.leaves,
	       (unsigned)r.rays, (unsigned)r.flagged_entries, (unsigned)r.new_entries);
	close_street(&w);
	return r;
}

/* Rows that may see it are those of its room and of the street before it; its own, and a few in whose way no single
 * wall stands, have more entries in a longer street. Four times as long: less than 4^0.6 times the rays. */
static void a_longer_street(void **state)
{
	(void)state;
	harness_require_context();
	const gi_report one = cost_of_a_move(60), four = cost_of_a_move(240);
	assert_true((double)four.leaves > 3.5 * (double)one.leaves);
	assert_true((double)four.rays < 2.3 * (double)one.rays);
	assert_true((double)four.flagged_entries < 1.5 * (double)one.flagged_entries);
}

static void walls_hide_movers_to_the_bit(void **state)
{
	(void)state;
	harness_require_context();
	scale_world w;
	open_street(&w, 60);
	for (uint32_t round = 0; round < 4; round++) {
		scale_world_move(&w, round % 3, round);
		if (round % 2)
			scale_world_turn_door(&w, round);
		harness_update(w.gi);
	}
	snapshot_expect_rebuilt_rows(w.gi, "figures and a door moved");
	scale_world_add(&w, true);
	assert_gi(gi_commit(w.gi));
	scale_world_move(&w, 1, 9);
	harness_update(w.gi);
	snapshot_expect_rebuilt_rows(w.gi, "something static came as another moved");
	scale_world_remove(&w);
	assert_gi(gi_commit(w.gi));
	scale_world_move(&w, 0, 11);
	harness_update(w.gi);
	snapshot_expect_rebuilt_rows(w.gi, "it went as another moved");
	close_street(&w);
}

/* ---- a wall between a mover and half of a room ---- */

typedef struct parted_room {
	gi_context *gi;
	gi_object wall, mover;
} parted_room;

static gi_object add(gi_context *gi, gi_mobility mobility, engine_mesh *mesh, gi_material material, gi_pose pose)
{
	gi_object_def def = scene_mesh_def(mesh);
	gi_object object;
	def.materials = &material;
	def.material_count = 1;
	def.pose = pose;
	def.mobility = mobility;
	assert_gi(gi_create_object(gi, &def, &object));
	engine_mesh_free(mesh);
	return object;
}

static gi_pose standing(float x, float z)
{
	return (gi_pose){{x, .02f, z}, {0, sinf(.3f * z), 0, cosf(.3f * z)}};
}

static parted_room open_room(void)
{
	static const gi_material plaster = {.rho = {.7f, .7f, .7f}}, lamp = {.exitance = {20, 20, 20}};
	gi_context_def def = harness_def();
	def.row_tolerance = .05f;
	parted_room r = {.gi = harness_context(&def)};
	engine_mesh mesh;
	assert_true(shape_box((float[]){0, 0, 0}, (float[]){6, 3, 4}, 6, true, &mesh));
	add(r.gi, GI_MOBILITY_STATIC, &mesh, plaster, gi_pose_identity());
	assert_true(shape_box((float[]){2.9f, 0, .6f}, (float[]){3.1f, 2.6f, 4}, 1, false, &mesh));
	r.wall = add(r.gi, GI_MOBILITY_STATIC, &mesh, plaster, gi_pose_identity());
	for (int k = 0; k < 2; k++) {
		const float corner[3] = {1 + 3.5f * (float)k, 2.9f, 2};
		assert_true(shape_quad(corner, (float[]){.5f, 0, 0}, (float[]){0, 0, .5f}, 2, 2, &mesh));
		add(r.gi, GI_MOBILITY_STATIC, &mesh, lamp, gi_pose_identity());
	}
	assert_true(shape_box((float[]){-.2f, 0, -.2f}, (float[]){.2f, 1, .2f}, 2, false, &mesh));
	r.mover = add(r.gi, GI_MOBILITY_MOVABLE, &mesh, (gi_material){.rho = {.8f, .3f, .2f}}, standing(4.5f, 2.5f));
	assert_gi(gi_commit(r.gi));
	harness_update(r.gi);
	return r;
}

static void walk(const parted_room *r, float x, float z)
{
	assert_gi(gi_set_pose(r->gi, r->mover, standing(x, z)));
}

static void a_wall_that_changes(void **state)
{
	(void)state;
	harness_require_context();
	const parted_room r = open_room();
	for (int round = 0; round < 3; round++) {
		walk(&r, 4.5f, 2.5f + .1f * (float)round);
		harness_update(r.gi);
	}
	snapshot_expect_rebuilt_rows(r.gi, "behind the wall");
	assert_gi(gi_set_hidden(r.gi, r.wall, true));
	walk(&r, 4.4f, 2.4f);
	harness_update(r.gi);
	snapshot_expect_rebuilt_rows(r.gi, "the wall is hidden");
	assert_gi(gi_set_hidden(r.gi, r.wall, false));
	walk(&r, 4.5f, 2.4f);
	harness_update(r.gi);
	walk(&r, 4.5f, 2.3f);
	harness_update(r.gi);
	snapshot_expect_rebuilt_rows(r.gi, "the wall is back");
	assert_gi(gi_set_mobility(r.gi, r.wall, GI_MOBILITY_MOVABLE));
	assert_gi(gi_commit(r.gi));
	walk(&r, 4.6f, 2.4f);
	harness_update(r.gi);
	snapshot_expect_rebuilt_rows(r.gi, "the wall is movable");
	assert_gi(gi_set_pose(r.gi, r.wall, (gi_pose){{.3f, 0, -.4f}, {0, 0, 0, 1}}));
	harness_update(r.gi);
	snapshot_expect_rebuilt_rows(r.gi, "the wall moved");
	gi_context_destroy(r.gi);
}

/* Rows wait while the mover walks past the end of the wall and back. */
static void rows_that_wait(void **state)
{
	(void)state;
	harness_require_context();
	const parted_room r = open_room();
	const gi_budget budget = {.rays = 400};
	for (int round = 0; round < 24; round++) {
		walk(&r, 4.5f - .1f * (float)(round % 12), 2.5f - .18f * (float)(round % 12));
		assert_gi(gi_update(r.gi, &budget));
	}
	harness_update(r.gi);
	snapshot_expect_rebuilt_rows(r.gi, "after a walk under a budget");
	gi_context_destroy(r.gi);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_longer_street),
	    cmocka_unit_test(walls_hide_movers_to_the_bit),
	    cmocka_unit_test(a_wall_that_changes),
	    cmocka_unit_test(rows_that_wait),
	};
	return cmocka_run_group_tests(tests, harness_open, harness_close);
}
