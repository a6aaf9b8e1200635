#define _POSIX_C_SOURCE 200809L /* nanosleep */
/* Updates under a budget: rows that wait are counted and bounded, none waits for ever, and what is exact again is a
 * rebuild's, to the bit.
 *
 * Two gi contexts get the same poses: one updates under a budget, the other exactly. The bound is tested against the
 * exact one's B: |B - B'| <= solve_bound + stale_bound + solve_bound', all of it certified.
 */
#include "moving_scene.h"
#include "snapshot.h"

#include "scenes/body.h"
#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static gi_context_def coarse_def(void)
{
	gi_context_def def = harness_def();
	def.row_tolerance = 0.05f;
	def.profile = false;
	return def;
}

static gi_report update_under(gi_context *gi, const gi_budget *budget)
{
	gi_report report = {0};
	if (gi_update(gi, budget) || gi_finish(gi) || gi_get_report(gi, &report))
		fail_msg("update: %s", harness_last_message());
	return report;
}

typedef void open_fn(scene *s, const gi_context_def *def);

typedef struct pair {
	scene bounded, exact;
	motion motion;
} pair;

static void pose_both(pair *p, int mover, gi_pose pose)
{
	assert_gi(gi_set_pose(p->bounded.gi, p->bounded.mover[mover], pose));
	assert_gi(gi_set_pose(p->exact.gi, p->exact.mover[mover], pose));
}

static pair open_pair(open_fn *open, const gi_context_def *def, uint32_t seed, bool stay_inside)
{
	pair p;
	seed_motion(seed);
	open(&p.bounded, def);
	open(&p.exact, def);
	p.motion = start_motion(stay_inside);
	for (int k = 0; k < MOVERS; k++)
		pose_both(&p, k, p.motion.pose[k]);
	return p;
}

static void close_pair(pair *p)
{
	gi_context_destroy(p->bounded.gi);
	gi_context_destroy(p->exact.gi);
}

static void move_both(pair *p)
{
	bool moved[MOVERS];
	next_poses(&p->motion, moved);
	for (int k = 0; k < MOVERS; k++)
		if (moved[k])
			pose_both(p, k, p->motion.pose[k]);
}

/* ---- certified ---- */

enum { MOST_RATIOS = 4096 };

typedef struct tally {
	double ratios[MOST_RATIOS]; /* bound over distance, where rows wait */
	uint32_t count, frames, with_waiting;
	double waiting;    /* sum of the share of rows */
	double off, bound; /* sums, relative to the largest B */
} tally;

static int order_doubles(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static void expect_bounded(const pair *p, const gi_report *a, const gi_report *b, const char *when, tally *t)
{
	snapshot bounded = snapshot_take(p->bounded.gi), exact = snapshot_take(p->exact.gi);
	const double distance = snapshot_distance(&bounded, &exact);
	const double bound = (double)a->solve_bound + (double)a->stale_bound;
	/* Both B are stored in single precision: half a unit in the last place of the largest, each. */
	const double rounding = 2 * snapshot_largest(&exact) / 16777216.0;
	if (!(distance <= bound + (double)b->solve_bound + rounding))
		fail_msg("%s: B is %.4g from the exact update's; solve_bound %.4g, stale_bound %.4g, %llu rows wait",
			 when, distance, (double)a->solve_bound, (double)a->stale_bound,
			 (unsigned long long)a->waiting_rows);
	assert_true(a->waiting_rows > 0 || a->stale_bound == 0); /* and 0 where all that waits reflects nothing */
	assert_true((a->waiting_rows > 0) == (a->waiting_entries > 0));
	t->frames++;
	t->with_waiting += a->waiting_rows > 0;
	t->waiting += (double)a->waiting_rows / a->leaves;
	t->off += distance / snapshot_largest(&exact);
	t->bound += bound / snapshot_largest(&exact);
	if (a->waiting_rows && distance > (double)b->solve_bound && t->count < MOST_RATIOS)
		t->ratios[t->count++] = bound / distance;
	snapshot_free(&bounded);
	snapshot_free(&exact);
}

static void print_tally(const char *name, tally *t)
{
	qsort(t->ratios, t->count, sizeof *t->ratios, order_doubles);
	printf(
	    "  %s: %u frames, %u with waiting rows, %.1f %% of the rows in the mean; bound over distance: median %.1f, "
	    "least %.2f; mean %.2f %% and %.2f %% of the largest B\n",
	    name, t->frames, t->with_waiting, 100 * t->waiting / t->frames, t->count ? t->ratios[t->count / 2] : 0,
	    t->count ? t->ratios[0] : 0, 100 * t->bound / t->frames, 100 * t->off / t->frames);
}

/* Rows of the bounded scene against the exact one's, which waits for nothing. */
static void expect_same_rows(const pair *p, const char *when)
{
	snapshot a = snapshot_take(p->bounded.gi), b = snapshot_take(p->exact.gi);
	snapshot_expect_same_rows(&a, &b, when);
	snapshot_free(&a);
	snapshot_free(&b);
}

static void play(const char *name, open_fn *open, const gi_context_def *def, const gi_budget *budget, uint32_t all)
{
	const uint32_t frames = harness_is_long() ? all : all / 2;
	pair p = open_pair(open, def, 11, open == open_room);
	static tally t;
	t = (tally){0};
	gi_report a = update_under(p.bounded.gi, budget);
	harness_update(p.exact.gi);
	assert_int_equal(a.waiting_rows, 0); /* the first rows are built whole */
	for (uint32_t frame = 1; frame <= frames; frame++) {
		char when[96];
		snprintf(when, sizeof when, "%s, frame %u", name, frame);
		move_both(&p);
		a = update_under(p.bounded.gi, budget);
		const gi_report b = harness_update(p.exact.gi);
		expect_bounded(&p, &a, &b, when, &t);
		if (frame % 10 == 0) { /* and an exact update brings everything up to date */
			a = update_under(p.bounded.gi, NULL);
			assert_int_equal(a.waiting_rows, 0);
			expect_same_rows(&p, when);
		}
	}
	print_tally(name, &t);
	assert_true(t.with_waiting > 0);
	close_pair(&p);
}

static void rays(void **state)
{
	(void)state;
	const gi_context_def def = coarse_def();
	play("2,000 rays", open_box, &def, &(gi_budget){.rays = 2000}, 40);
	play("10,000 rays", open_room, &def, &(gi_budget){.rays = 10000}, 40);
}

static void bright_sky(void **state)
{
	(void)state;
	gi_context_def def = coarse_def();
	def.sky = GI_SKY_ON;
	for (int c = 0; c < 3; c++)
		def.sky_exitance[c] = 3.0f + (float)c;
	play("bright sky, 4,000 rays", open_box, &def, &(gi_budget){.rays = 4000}, 30);
}

static void error(void **state)
{
	(void)state;
	const gi_context_def def = coarse_def();
	play("error 0.2", open_box, &def, &(gi_budget){.error = .2f}, 30);
	play("error 0.05", open_room, &def, &(gi_budget){.error = .05f}, 30);
	play("error 0.05 and 3,000 rays", open_box, &def, &(gi_budget){.rays = 3000, .error = .05f}, 30);
}

/* ---- a camera ---- */

/* Above the middle, looking down: the floor is in sight, and what faces up. */
static gi_view view_from_above(void)
{
	gi_view view = gi_view_default();
	const float down[16] = {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, -4.5f, 1};
	const float wide[16] = {.8f, 0, 0, 0, 0, .8f, 0, 0, 0, 0, -1.02f, -1, 0, 0, -.2f, 0};
	memcpy(view.view_from_world, down, sizeof down);
	memcpy(view.clip_from_view, wide, sizeof wide);
	return view;
}

static bool faces_up(const gi_leaf *leaf)
{
	float a[3], b[3];
	for (int k = 0; k < 3; k++) {
		a[k] = leaf->corners[2][k] - leaf->corners[0][k];
		b[k] = leaf->corners[3][k] - leaf->corners[1][k];
	}
	return a[2] * b[0] - a[0] * b[2] > 0;
}

/* Sum of area |B - B'|^2 over the leaves that face up and lie below the camera, or over the others. */
static double squared_error(const pair *p, bool seen)
{
	snapshot a = snapshot_take(p->bounded.gi), b = snapshot_take(p->exact.gi);
	double sum = 0;
	for (uint32_t k = 0; k < a.leaf_count; k++)
		for (int c = 0; c < 3 && seen == (faces_up(&a.leaves[k]) && a.leaves[k].corners[0][1] < 4); c++) {
			const double d = (double)a.leaves[k].radiosity[c] - (double)b.leaves[k].radiosity[c];
			sum += (double)a.leaves[k].area * d * d;
		}
	snapshot_free(&a);
	snapshot_free(&b);
	return sum;
}

typedef struct errors {
	double seen, unseen;
} errors;

static errors errors_under(const gi_budget *budget)
{
	const gi_context_def def = coarse_def();
	pair p = open_pair(open_room, &def, 21, true);
	update_under(p.bounded.gi, budget);
	harness_update(p.exact.gi);
	errors sum = {0, 0};
	for (uint32_t frame = 1; frame <= 24; frame++) {
		move_both(&p);
		update_under(p.bounded.gi, budget);
		harness_update(p.exact.gi);
		sum.seen += squared_error(&p, true);
		sum.unseen += squared_error(&p, false);
	}
	update_under(p.bounded.gi, NULL);
	expect_same_rows(&p, "a camera, then an exact update");
	close_pair(&p);
	return sum;
}

/* With as many rays what the camera sees is less wrong, and bounds hold as without. */
static void what_is_seen_goes_first(void **state)
{
	(void)state;
	const gi_view view = view_from_above();
	const errors alike = errors_under(&(gi_budget){.rays = 3000}),
		     viewed = errors_under(&(gi_budget){.rays = 3000, .view = &view});
	printf("  squared error with a camera: in sight %.2f of that without, elsewhere %.2f\n",
	       viewed.seen / alike.seen, viewed.unseen / alike.unseen);
	assert_true(alike.seen > 0 && viewed.seen < .8 * alike.seen);
	const gi_context_def def = coarse_def();
	play("2,000 rays, a camera", open_box, &def, &(gi_budget){.rays = 2000, .view = &view}, 20);
}

/* ---- many frames ---- */

/* Another budget every frame; every 20th an exact update, which has to find everything that waited. */
static void any_budget(void **state)
{
	(void)state;
	enum { EXACT_EVERY = 20 };
	static const gi_budget budgets[] = {
	    {.rays = 500}, {.rays = 3000}, {.error = .3f}, {.rays = 20000, .error = .02f}, {.ms = 0}};
	const gi_context_def def = coarse_def();
	const char *text = getenv("RELUME_FRAMES");
	const uint32_t frames = text ? (uint32_t)atoi(text) : 60;
	pair p = open_pair(open_box, &def, 77, false);
	harness_update(p.bounded.gi);
	static tally t;
	t = (tally){0};
	for (uint32_t frame = 1; frame <= frames; frame++) {
		char when[64];
		snprintf(when, sizeof when, "any budget, frame %u", frame);
		move_both(&p);
		if (frame % EXACT_EVERY) {
			const gi_report a = update_under(p.bounded.gi, &budgets[(frame * 2654435761u >> 16) % 5]);
			if (frame % EXACT_EVERY == EXACT_EVERY / 2) {
				const gi_report b = harness_update(p.exact.gi);
				expect_bounded(&p, &a, &b, when, &t);
			}
			continue;
		}
		update_under(p.bounded.gi, NULL);
		gi_invalidate(p.exact.gi);
		harness_update(p.exact.gi);
		expect_same_rows(&p, when);
	}
	print_tally("any budget", &t);
	close_pair(&p);
}

/* ---- nothing waits for ever ---- */

/* A budget of one ray, everything in motion: each row is refreshed within the promised number of updates, and once
 * nothing moves all rows become those of an exact update. */
static void nothing_waits_for_ever(void **state)
{
	(void)state;
	const gi_context_def def = coarse_def();
	const gi_budget least = {.rays = 1};
	pair p = open_pair(open_box, &def, 5, false);
	update_under(p.bounded.gi, &least);
	harness_update(p.exact.gi);
	for (int frame = 0; frame < 30; frame++) {
		move_both(&p);
		const gi_report r = update_under(p.bounded.gi, &least);
		assert_true(r.dirty_rows > 0 && r.waiting_rows > 0);
	}
	harness_update(p.exact.gi);
	uint32_t updates = 0;
	gi_report r;
	do
		r = update_under(p.bounded.gi, &least);
	while (++updates < 200 && r.waiting_rows > 0);
	printf("  one ray an update: all rows current %u updates after the last move\n", updates);
	assert_true(updates <= 75);
	expect_same_rows(&p, "one ray an update");
	r = update_under(p.bounded.gi, &least);
	assert_int_equal(r.outcome, GI_OUTCOME_AT_REST);
	close_pair(&p);
}

/* Rows whose change is bounded as small wait while nothing moves, for nothing; a smaller error or none brings them up.
 */
static void small_changes_wait(void **state)
{
	(void)state;
	const gi_context_def def = coarse_def();
	pair p = open_pair(open_box, &def, 3, false);
	const gi_budget loose = {.error = .5f}, tight = {.error = .01f};
	update_under(p.bounded.gi, &loose);
	harness_update(p.exact.gi);
	gi_pose pose = HOME[BLOCK];
	pose.position[0] += .05f;
	pose_both(&p, BLOCK, pose);
	harness_update(p.exact.gi);
	gi_report r = update_under(p.bounded.gi, &loose);
	const uint64_t waiting = r.waiting_rows;
	assert_true(waiting > 0);
	do
		r = update_under(p.bounded.gi, &loose);
	while (r.outcome != GI_OUTCOME_AT_REST);
	assert_int_equal(r.waiting_rows, waiting);
	assert_int_equal(r.dispatches, 0);
	assert_int_equal(r.assessed_rows, 0);
	r = update_under(p.bounded.gi, &tight);
	assert_true(r.dirty_rows > 0 && r.waiting_rows < waiting);
	r = update_under(p.bounded.gi, NULL);
	assert_int_equal(r.waiting_rows, 0);
	expect_same_rows(&p, "an exact update after waiting");
	close_pair(&p);
}

/* A closed room with a block and a lamp of so many metres below its ceiling, which gives the same light whatever its
 * size; then the block moves. */
static gi_report move_below_lamp(float size, const gi_budget *budget)
{
	const gi_context_def def = coarse_def();
	gi_context *gi = harness_context(&def);
	const float h = size / 2, e = 20 / (size * size);
	engine_mesh mesh;
	assert_true(shape_box((float[]){-2, 0, -2}, (float[]){2, 3, 2}, 2, true, &mesh));
	harness_add(gi, &(harness_object){.name = "room", .levels = 2, .rho = {.7f, .6f, .5f}}, &mesh);
	assert_true(shape_quad((float[]){-h, 2.9f, -h}, (float[]){size, 0, 0}, (float[]){0, 0, size}, 1, 1, &mesh));
	harness_add(gi, &(harness_object){.name = "lamp", .exitance = {e, e, e}}, &mesh);
	assert_true(shape_box((float[]){-.5f, 0, -.5f}, (float[]){.5f, 1, .5f}, 1, false, &mesh));
	const gi_object block =
	    harness_add(gi, &(harness_object){.name = "block", .levels = 2, .rho = {.6f, .6f, .6f}}, &mesh);
	assert_gi(gi_set_pose(gi, block, (gi_pose){{.8f, 0, .3f}, {0, .2f, 0, .98f}}));
	assert_gi(gi_commit(gi));
	update_under(gi, budget);
	assert_gi(gi_set_pose(gi, block, (gi_pose){{.801f, 0, .3f}, {0, .2f, 0, .98f}}));
	const gi_report r = update_under(gi, budget);
	gi_context_destroy(gi);
	return r;
}

/* What counts is the light reflected: a lamp of a ten-thousandth of the area and ten thousand times as bright lets the
 * same rows wait. */
static void small_lamps_hide_nothing(void **state)
{
	(void)state;
	const gi_budget budget = {.error = 1};
	const gi_report large = move_below_lamp(.4f, &budget), small = move_below_lamp(.004f, &budget);
	printf("  lamps of 40 and 0.4 cm: %.1f and %.1f %% of the rows wait, off by at most %.2f and %.2f of the "
	       "largest R, "
	       "%.2g and %.2g of the largest B\n",
	       100. * (double)large.waiting_rows / large.leaves, 100. * (double)small.waiting_rows / small.leaves,
	       (double)large.stale_relative, (double)small.stale_relative,
	       (double)(large.stale_bound / large.radiosity_max), (double)(small.stale_bound / small.radiosity_max));
	assert_true(large.waiting_rows > 0 && large.waiting_rows < large.leaves);
	assert_in_range(small.waiting_rows, large.waiting_rows * 2 / 3, large.waiting_rows * 3 / 2);
	assert_float_equal(small.stale_relative, large.stale_relative, .5 * (double)large.stale_relative);
	assert_float_equal(small.stale_relative, small.stale_bound / small.reflected_max, 1e-5);
}

/* ---- time ---- */

static gi_context_def timed_def(void)
{
	gi_context_def def = coarse_def();
	def.profile = true; /* a budget of time needs the timers */
	return def;
}

static void time_is_certified(void **state)
{
	(void)state;
	const gi_context_def def = timed_def();
	play("1 ms", open_box, &def, &(gi_budget){.ms = 1}, 40);
	play("3 ms", open_room, &def, &(gi_budget){.ms = 3}, 40);
	play("2 ms, error 0.1", open_box, &def, &(gi_budget){.ms = 2, .error = .1f}, 30);
}

/* Into next to no time fit one row, one sweep, and a look at as many rows as always. What is counted is asked for, not
 * what it took. */
static void expect_little_work(const gi_report *r)
{
	enum { LEAST_ROWS = 32, MOST_DISPATCHES = 100 };
	assert_true(r->dirty_rows <= 1);
	assert_int_equal(r->sweeps, 1);
	assert_true(r->assessed_rows <= LEAST_ROWS);
	assert_true(r->dispatches <= MOST_DISPATCHES);
}

/* Nothing fits, everything moves; then nothing moves, and all rows become an exact update's, the solve as near as one.
 */
static void little_time_little_work(void **state)
{
	(void)state;
	const gi_context_def def = timed_def();
	const gi_budget little = {.ms = 1e-3f};
	pair p = open_pair(open_box, &def, 13, false);
	update_under(p.bounded.gi, &little);
	harness_update(p.exact.gi);
	static tally t;
	t = (tally){0};
	gi_report r;
	for (int frame = 0; frame < 20; frame++) {
		move_both(&p);
		r = update_under(p.bounded.gi, &little);
		const gi_report exact = harness_update(p.exact.gi);
		expect_little_work(&r);
		expect_bounded(&p, &r, &exact, "little time", &t);
	}
	print_tally("next to no time", &t);
	uint32_t updates = 0;
	do {
		r = update_under(p.bounded.gi, &little);
		assert_true(r.dirty_rows <= 1 && r.sweeps <= 1);
	} while (++updates < 4 * r.leaves && r.outcome != GI_OUTCOME_AT_REST);
	printf("  one row at a time: at rest %u updates after the last move, %u leaves\n", updates, r.leaves);
	assert_int_equal(r.outcome, GI_OUTCOME_AT_REST);
	assert_int_equal(r.waiting_rows, 0);
	assert_true(r.solve_relative <= def.solve_tolerance);
	expect_same_rows(&p, "one row at a time");
	close_pair(&p);
}

/* Right after a commit, and after lights went on, no more is done than at other times: something went, ten came, one of
 * them shines and is put out. Static things make the update commit by itself. */
typedef struct room_of_many {
	gi_context *gi;
	gi_object boxes[40];
	uint32_t count;
} room_of_many;

static void put_box(room_of_many *room, gi_mobility mobility)
{
	engine_mesh mesh;
	const uint32_t k = room->count;
	assert_true(shape_box((float[]){-.2f, 0, -.2f}, (float[]){.2f, .5f, .2f}, 1, false, &mesh));
	gi_object_def object = scene_mesh_def(&mesh);
	object.mobility = mobility;
	object.pose.position[0] = (float)(k % 6) - 2.5f;
	object.pose.position[1] = .01f;
	object.pose.position[2] = (float)(k / 6) - 2.5f;
	assert_gi(gi_create_object(room->gi, &object, &room->boxes[room->count++]));
	engine_mesh_free(&mesh);
}

static gi_context *open_many(room_of_many *room, const gi_context_def *def, uint32_t boxes)
{
	*room = (room_of_many){.gi = harness_context(def)};
	engine_mesh mesh;
	assert_true(shape_box((float[]){-3, 0, -3}, (float[]){3, 2.5f, 3}, 6, true, &mesh));
	harness_add(room->gi, &(harness_object){.name = "room", .rho = {.6f, .6f, .6f}}, &mesh);
	assert_true(shape_quad((float[]){-.5f, 2.4f, -.5f}, (float[]){1, 0, 0}, (float[]){0, 0, 1}, 1, 1, &mesh));
	harness_add(room->gi, &(harness_object){.name = "lamp", .exitance = {20, 20, 20}}, &mesh);
	for (uint32_t k = 0; k < boxes; k++)
		put_box(room, k % 2 ? GI_MOBILITY_STATIC : GI_MOBILITY_MOVABLE);
	assert_gi(gi_commit(room->gi));
	harness_update(room->gi);
	return room->gi;
}

static void time_holds_after_commits(void **state)
{
	(void)state;
	const gi_context_def def = timed_def();
	const gi_budget little = {.ms = 1e-3f};
	room_of_many room;
	gi_context *gi = open_many(&room, &def, 12);
	const gi_material dark = {.rho = {.5f, .5f, .5f}}, lit = {.rho = {.5f, .5f, .5f}, .exitance = {30, 20, 10}};
	static const char *const events[] = {"one moves",     "one went",          "a static one went",
					     "ten came",      "a static one came", "one shines",
					     "it is put out", "a static one moves"};
	enum { EVENTS = sizeof events / sizeof *events, AFTER = 4 };
	for (int warm = 0; warm < 12; warm++) { /* what things take is learned */
		assert_gi(gi_set_pose(gi, room.boxes[0], (gi_pose){{-2.5f, .01f * (float)warm, -2.5f}, {0, 0, 0, 1}}));
		update_under(gi, &little);
	}
	for (int event = 0; event < EVENTS; event++) {
		bool commits = event && event < 5;
		switch (event) {
		case 0:
			assert_gi(gi_set_pose(gi, room.boxes[0], (gi_pose){{-2.4f, .3f, -2.4f}, {0, 0, 0, 1}}));
			break;
		case 1:
			assert_gi(gi_destroy_object(gi, room.boxes[2]));
			break;
		case 2:
			assert_gi(gi_destroy_object(gi, room.boxes[3]));
			break;
		case 3:
			for (int k = 0; k < 10; k++)
				put_box(&room, GI_MOBILITY_MOVABLE);
			break;
		case 4:
			put_box(&room, GI_MOBILITY_STATIC);
			break;
		case 5:
		case 6:
			assert_gi(gi_set_material(gi, room.boxes[4], 0, event == 5 ? lit : dark));
			break;
		default:
			assert_gi(gi_set_pose(gi, room.boxes[5], (gi_pose){{1.5f, .6f, -2.5f}, {0, 0, 0, 1}}));
		}
		if (commits)
			assert_gi(gi_commit(gi));
		uint64_t rows = 0, rays = 0;
		for (int k = 0; k < AFTER; k++) {
			const gi_report r = update_under(gi, &little);
			expect_little_work(&r);
			rows += r.dirty_rows;
			rays += r.rays;
			assert_true(r.waiting_rows > 0);
		}
		printf("  %s: %llu rows, %llu rays in %d updates\n", events[event], (unsigned long long)rows,
		       (unsigned long long)rays, AFTER);
	}
	const gi_report full = harness_update(gi);
	assert_int_equal(full.waiting_rows, 0);
	gi_context_destroy(gi);
}

/* A commit that takes as long as the budget: whoever hears of it sleeps. */
static void sleep_in_commits(const char *what, uint32_t done, uint32_t total, void *user)
{
	const float *ms = user;
	(void)done, (void)total;
	if (strcmp(what, "joining objects") == 0)
		nanosleep(&(struct timespec){0, (long)(1e6f * *ms)}, NULL);
}

/* The first move of a static object makes its update commit, and that is time of the budget: rows get the tenth that is
 * left. The updates between have all of it, and as much to do. */
static void a_commit_takes_from_the_budget(void **state)
{
	(void)state;
	enum { STATICS = 5, WARM = 8, AGAIN = 2 };
	float asleep = 0;
	gi_context_def def = timed_def();
	def.row_tolerance = .01f;
	def.progress = sleep_in_commits;
	def.user = &asleep;
	room_of_many room;
	gi_context *gi = open_many(&room, &def, 2 * STATICS + 4); /* two stay together to the end */
	gi_budget budget = {.ms = 1e-3f};
	double least = INFINITY; /* what no budget shortens */
	uint64_t with = 0, without = 0;
	for (int k = -WARM; k < AGAIN * STATICS; k++) {
		for (int n = 0; n < STATICS; n++)
			assert_gi(gi_set_pose(gi, room.boxes[2 * n],
					      (gi_pose){{(float)n - 2, .1f * (float)(k & 7), -1.5f}, {0, 0, 0, 1}}));
		const bool commits = k >= 0 && k % AGAIN == 0;
		const gi_object box = room.boxes[2 * (k / AGAIN) + 1];
		if (commits)
			assert_gi(gi_set_pose(gi, box, (gi_pose){{.3f * (float)k / AGAIN, 1.2f, 1.5f}, {0, 0, 0, 1}}));
		const gi_report r = update_under(gi, &budget);
		if (k < 0) {
			least = fmin(least, (double)r.update_ms);
			budget.ms = asleep = k < -WARM / 2 ? 1e-3f : (float)(20 * least);
		} else {
			*(commits ? &with : &without) += r.rays;
		}
	}
	with *= AGAIN - 1;
	printf("  in %.1f ms: %llu rays beside commits of that time, %llu without\n", (double)budget.ms,
	       (unsigned long long)with, (unsigned long long)without);
	assert_true(with < without / 2);
	assert_int_equal(harness_update(gi).waiting_rows, 0);
	gi_context_destroy(gi);
}

/* ---- edges ---- */

static void no_budget_is_exact(void **state)
{
	(void)state;
	const gi_context_def def = coarse_def();
	pair p = open_pair(open_box, &def, 9, false);
	for (int frame = 0; frame < 4; frame++) {
		const gi_report a = update_under(p.bounded.gi, &(gi_budget){0}), b = harness_update(p.exact.gi);
		assert_int_equal(a.dispatches, b.dispatches);
		assert_int_equal(a.gpu_bytes, b.gpu_bytes);
		assert_int_equal(a.waiting_rows, 0);
		expect_same_rows(&p, "a budget of nothing");
		move_both(&p);
	}
	close_pair(&p);
}

/* Lights switched and objects moved under a budget; then a commit, across which rows wait on. */
static void switches_and_commits(void **state)
{
	(void)state;
	const gi_context_def def = coarse_def();
	const gi_budget budget = {.rays = 1500};
	pair p = open_pair(open_box, &def, 21, false);
	update_under(p.bounded.gi, &budget);
	harness_update(p.exact.gi);
	static tally t;
	t = (tally){0};
	for (int frame = 0; frame < 12; frame++) {
		const gi_material m =
		    frame % 3 ? (gi_material){.rho = {.5f, .5f, .5f}, .exitance = {0, (float)(frame % 2) * 5, 5}}
			      : (gi_material){.rho = {.7f, .2f, .2f}};
		assert_gi(gi_set_material(p.bounded.gi, p.bounded.mover[BLOCK], 0, m));
		assert_gi(gi_set_material(p.exact.gi, p.exact.mover[BLOCK], 0, m));
		move_both(&p);
		const gi_report a = update_under(p.bounded.gi, &budget), b = harness_update(p.exact.gi);
		expect_bounded(&p, &a, &b, "a switch", &t);
	}
	print_tally("switches", &t);
	assert_gi(gi_commit(p.bounded.gi));
	gi_report r = update_under(p.bounded.gi, &budget);
	const uint64_t waited = r.waiting_rows;
	uint32_t updates = 1;
	for (; r.waiting_rows && updates < 200; updates++) {
		r = update_under(p.bounded.gi, &budget);
		assert_true(r.waiting_rows < waited);
	}
	printf("  %u rows waited after the commit, %u updates\n", (uint32_t)waited, updates);
	assert_true(waited > 0);
	assert_int_equal(r.waiting_rows, 0);
	expect_same_rows(&p, "after a commit");
	close_pair(&p);
}

static void bad_budgets(void **state)
{
	(void)state;
	gi_context_def def = coarse_def();
	pair p = open_pair(open_box, &def, 1, false);
	const gi_budget bad[] = {{.ms = -1},      {.ms = NAN},    {.ms = INFINITY}, {.error = -.1f},
				 {.error = 1.5f}, {.error = NAN}, {.ms = 5} /* without profile */};
	for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
		assert_int_equal(gi_update(p.bounded.gi, &bad[k]), GI_ERROR_INVALID_ARGUMENT);
		assert_non_null(harness_last_message()[0] ? harness_last_message() : NULL);
	}
	gi_view view = view_from_above();
	view.view_from_world[5] = NAN;
	assert_int_equal(gi_update(p.bounded.gi, &(gi_budget){.rays = 5, .view = &view}), GI_ERROR_INVALID_ARGUMENT);
	assert_non_null(strstr(harness_last_message(), "budget.view"));
	close_pair(&p);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(any_budget),
	    cmocka_unit_test(rays),
	    cmocka_unit_test(bright_sky),
	    cmocka_unit_test(error),
	    cmocka_unit_test(what_is_seen_goes_first),
	    cmocka_unit_test(nothing_waits_for_ever),
	    cmocka_unit_test(small_changes_wait),
	    cmocka_unit_test(small_lamps_hide_nothing),
	    cmocka_unit_test(time_is_certified),
	    cmocka_unit_test(little_time_little_work),
	    cmocka_unit_test(time_holds_after_commits),
	    cmocka_unit_test(a_commit_takes_from_the_budget),
	    cmocka_unit_test(no_budget_is_exact),
	    cmocka_unit_test(switches_and_commits),
	    cmocka_unit_test(bad_budgets),
	};
	return cmocka_run_group_tests_name("budget", tests, harness_open, harness_close);
}
