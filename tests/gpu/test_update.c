/* Rows kept by updates are those of a rebuild, to the bit, whatever moved, turned, returned or was relit.
 *
 * Two gi contexts share the OpenGL context and get the same poses and materials. One updates; the other is invalidated
 * and made cold every frame. After each frame all entries, all links and all row sums are compared as bytes, and B to
 * 1e-5 of the largest.
 */
#include "snapshot.h"

#include "scenes/cornell.h"
#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The tolerance for B. Both solves stop within 1e-6 of the largest B of the same fixed point; the rest is room
 * for the rounding of sums of some hundred products in single precision. */
static const double RADIOSITY_TOLERANCE = 1e-5;
static const float SOLVE_TOLERANCE = 1e-6f;

/* Coarse, so that 200 rebuilds are affordable: about 700 leaves with 60 entries each. */
static const float ROW_TOLERANCE = 0.03f;

enum { MOVERS = 3, BALL = 0, BLOCK = 1, SHEET = 2 };

typedef struct scene {
	gi_context *gi;
	gi_object mover[MOVERS], light;
} scene;

/* ---- chance ---- */

static uint32_t random_state;

static uint32_t random_bits(void)
{
	/* xorshift32 (Marsaglia, 2003) */
	random_state ^= random_state << 13;
	random_state ^= random_state >> 17;
	random_state ^= random_state << 5;
	return random_state;
}

static float random_between(float low, float high)
{
	return low + (high - low) * (float)(random_bits() >> 8) * (1.0f / 16777216.0f);
}

static bool chance(float p)
{
	return random_between(0, 1) < p;
}

/* ---- scenes ---- */

static gi_object add_ball(gi_context *gi)
{
	engine_mesh mesh;
	assert_true(shape_sphere(.6f, 3, &mesh));
	return harness_add(
	    gi, &(harness_object){.name = "ball", .scheme = GI_SCHEME_CATMULL_CLARK, .rho = {.7f, .3f, .3f}}, &mesh);
}

static gi_object add_block(gi_context *gi)
{
	engine_mesh mesh;
	assert_true(shape_box((float[]){-.5f, 0, -.5f}, (float[]){.5f, 1.5f, .5f}, 2, false, &mesh));
	return harness_add(gi, &(harness_object){.name = "block", .levels = 1, .rho = {.3f, .7f, .3f}}, &mesh);
}

/* A sheet bent in the middle: it sees itself, and both its sides reflect. */
static gi_object add_sheet(gi_context *gi)
{
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-.7f, 0, -.7f}, (float[]){0, 0, 1.4f}, (float[]){1.4f, 0, 0}, 2, 2, &mesh));
	for (uint32_t k = 0; k < mesh.vertex_count; k++)
		mesh.positions[3 * k + 1] = .5f * fabsf(mesh.positions[3 * k]);
	return harness_add(
	    gi, &(harness_object){.name = "sheet", .levels = 1, .rho = {.3f, .3f, .7f}, .double_sided = true}, &mesh);
}

static void add_movers(scene *s)
{
	s->mover[BALL] = add_ball(s->gi);
	s->mover[BLOCK] = add_block(s->gi);
	s->mover[SHEET] = add_sheet(s->gi);
}

static void open_box(scene *s, const gi_context_def *def)
{
	s->gi = harness_context(def);
	cornell_def box = cornell_def_default();
	box.wall_faces = 2;
	box.wall_levels = 2;
	box.light_levels = 1;
	box.buddha = box.balls = false;
	cornell made;
	assert_gi(cornell_create(s->gi, &box, &made));
	s->light = made.light;
	add_movers(s);
	assert_gi(gi_commit(s->gi));
}

/* One closed inward object, as large as the Cornell box: no sky. */
static void open_room(scene *s, const gi_context_def *def)
{
	s->gi = harness_context(def);
	engine_mesh mesh;
	assert_true(shape_box((float[]){-2.75f, 0, -2.75f}, (float[]){2.75f, 5.5f, 2.75f}, 2, true, &mesh));
	harness_add(s->gi, &(harness_object){.name = "room", .levels = 1, .rho = {.6f, .6f, .6f}}, &mesh);
	assert_true(shape_quad((float[]){-.6f, 5.4f, -.6f}, (float[]){1.2f, 0, 0}, (float[]){0, 0, 1.2f}, 1, 1, &mesh));
	s->light = harness_add(s->gi, &(harness_object){.name = "light", .levels = 1, .exitance = {40, 40, 40}}, &mesh);
	add_movers(s);
	assert_gi(gi_commit(s->gi));
}

/* ---- motion ---- */

static const gi_pose HOME[MOVERS] = {
    {{0, 3.2f, 0}, {0, 0, 0, 1}},          /* between the light and the floor */
    {{-1.2f, 0, -.6f}, {0, .2f, 0, .98f}}, /* stands on the floor: contact */
    {{1.3f, 1.2f, .8f}, {.3f, 0, .1f, .95f}},
};

static gi_pose random_pose(int mover, bool stay_inside)
{
	gi_pose p = {.position = {random_between(-1.9f, 1.9f), random_between(.8f, 4.6f), random_between(-1.9f, 1.9f)}};
	for (int k = 0; k < 4; k++)
		p.rotation[k] = random_between(-1, 1);
	p.rotation[3] += 1.5f; /* never near zero */
	if (mover == BLOCK) {
		/* On the floor, or in the air. */
		p.position[1] = chance(.6f) ? 0 : random_between(0, 3);
		p.rotation[0] = p.rotation[2] = 0;
	}
	/* The ball goes through the space under the light. */
	if (mover == BALL && chance(.5f)) {
		p.position[0] = random_between(-.8f, .8f);
		p.position[2] = random_between(-.8f, .8f);
	}
	/* Out through the open front, and beyond. */
	if (mover == SHEET && !stay_inside && chance(.3f))
		p.position[2] = random_between(2.2f, 9);
	return p;
}

static gi_pose nudged(gi_pose p, bool turn)
{
	const float step = .12f;
	for (int k = 0; k < 3; k += 1 + (k == 0)) /* along the floor */
		p.position[k] = fminf(fmaxf(p.position[k] + random_between(-step, step), -1.9f), 1.9f);
	if (turn)
		p.rotation[1] += random_between(-.1f, .1f);
	return p;
}

/* The ball on the block, through it, or beside it, just touching. */
static gi_pose in_contact(const gi_pose *block)
{
	gi_pose p = *block;
	switch (random_bits() % 3) {
	case 0:
		p.position[1] += 1.5f + .6f; /* the cage's poles touch the top */
		break;
	case 1:
		p.position[1] += 1.2f;
		break;
	default:
		p.position[0] += .9f;
		p.position[1] += .7f;
	}
	return p;
}

typedef struct motion {
	gi_pose pose[MOVERS], seen[MOVERS][4]; /* poses they were in before */
	bool stay_inside;
} motion;

/* Which of the movers get a new pose in this frame. */
static void next_poses(motion *m, bool moved[MOVERS])
{
	for (int k = 0; k < MOVERS; k++) {
		const float dice = random_between(0, 1);
		const gi_pose before = m->pose[k];
		moved[k] = dice < .55f;
		if (dice < .25f)
			m->pose[k] = nudged(before, chance(.5f));
		else if (dice < .35f)
			m->pose[k] = random_pose(k, m->stay_inside);
		else if (dice < .45f)
			m->pose[k] = m->seen[k][random_bits() % 4];
		else if (dice < .5f)
			m->pose[k] = HOME[k];
		else if (dice < .55f && k == BALL)
			m->pose[k] = in_contact(&m->pose[BLOCK]);
		if (moved[k])
			m->seen[k][random_bits() % 4] = before;
	}
}

static motion start_motion(bool stay_inside)
{
	motion m = {.stay_inside = stay_inside};
	for (int k = 0; k < MOVERS; k++) {
		m.pose[k] = HOME[k];
		for (int j = 0; j < 4; j++)
			m.seen[k][j] = random_pose(k, stay_inside);
	}
	return m;
}

/* ---- comparison ---- */

typedef struct tally {
	double entries, fresh, flagged, worst;
	uint32_t frames, regrown; /* regrown: the pool was full, and gi_finish built all rows anew in a larger one */
} tally;

static void expect_converged(const gi_report *r, const char *when)
{
	if (r->outcome != GI_OUTCOME_CONVERGED && r->outcome != GI_OUTCOME_AT_REST)
		fail_msg("%s: outcome %d after %u sweeps, bound %g of the largest B %g, residual %g, q %g", when,
			 r->outcome, r->sweeps, (double)r->solve_relative, (double)r->radiosity_max,
			 (double)r->residual, (double)r->contraction);
}

static void compare(scene *kept, scene *rebuilt, const char *when, tally *t)
{
	gi_invalidate(rebuilt->gi);
	gi_reset_radiosity(rebuilt->gi);
	const gi_report report = harness_update(kept->gi), full = harness_update(rebuilt->gi);
	expect_converged(&report, when);
	expect_converged(&full, when);
	assert_int_equal(full.new_entries, full.entries);
	assert_int_equal(report.entries, full.entries);
	assert_int_equal(report.links, full.links);
	snapshot a = snapshot_take(kept->gi), b = snapshot_take(rebuilt->gi);
	assert_int_equal(a.entry_count, report.entries);
	assert_int_equal(a.link_count, report.links);
	snapshot_expect_same_rows(&a, &b, when);
	const double distance = snapshot_distance(&a, &b), largest = snapshot_largest(&b);
	if (!(distance <= RADIOSITY_TOLERANCE * largest)) /* all black: zero from zero */
		fail_msg("%s: B is %.3g W/m2 from the rebuild's, whose largest is %g", when, distance, largest);
	snapshot_free(&a);
	snapshot_free(&b);
	t->entries += (double)report.entries;
	t->fresh += (double)report.new_entries;
	t->flagged += (double)report.flagged_entries;
	t->regrown += report.new_entries == report.entries ? 1 : 0;
	t->worst = fmax(t->worst, distance > 0 ? distance / largest : 0);
	t->frames++;
}

static void print_tally(const char *name, const tally *t)
{
	printf("  %s: %u frames, %.0f entries; of them cut anew %.1f %%, flagged %.1f %%; pools grown %u times, worst "
	       "B %.2e\n",
	       name, t->frames, t->entries / t->frames, 100 * t->fresh / t->entries, 100 * t->flagged / t->entries,
	       t->regrown, t->worst);
}

typedef void open_fn(scene *s, const gi_context_def *def);

static void pose_both(scene pair[2], int mover, gi_pose pose)
{
	for (int k = 0; k < 2; k++)
		assert_gi(gi_set_pose(pair[k].gi, pair[k].mover[mover], pose));
}

static void run(const char *name, open_fn *open, const gi_context_def *def, uint32_t frames, bool stay_inside)
{
	scene pair[2];
	random_state = 20240229;
	for (int k = 0; k < 2; k++)
		open(&pair[k], def);
	motion m = start_motion(stay_inside);
	for (int k = 0; k < MOVERS; k++)
		pose_both(pair, k, m.pose[k]);
	tally t = {0};
	compare(&pair[0], &pair[1], "the first frame", &t);
	const snapshot at_home = snapshot_take(pair[0].gi);
	t = (tally){0};
	for (uint32_t frame = 1; frame <= frames; frame++) {
		char when[64];
		bool moved[MOVERS];
		snprintf(when, sizeof when, "%s, frame %u", name, frame);
		next_poses(&m, moved);
		for (int k = 0; k < MOVERS; k++)
			if (moved[k])
				pose_both(pair, k, m.pose[k]);
		compare(&pair[0], &pair[1], when, &t);
	}
	print_tally(name, &t);
	/* All three move often, and yet less than all is done again. */
	assert_true(t.regrown <= 2);
	assert_true(t.fresh + t.flagged < .8 * t.entries);
	assert_true(t.flagged > 0);

	/* Everything where it was at first: the rows of then, though nothing was rebuilt since. */
	for (int k = 0; k < MOVERS; k++)
		pose_both(pair, k, HOME[k]);
	compare(&pair[0], &pair[1], "home again", &t);
	snapshot home_again = snapshot_take(pair[0].gi);
	snapshot_expect_same_rows(&at_home, &home_again, "home again, against the first frame");
	snapshot_free(&home_again);
	snapshot_free((snapshot *)&at_home);
	for (int k = 0; k < 2; k++)
		gi_context_destroy(pair[k].gi);
}

static gi_context_def coarse_def(void)
{
	gi_context_def def = harness_def();
	def.row_tolerance = ROW_TOLERANCE;
	def.solve_tolerance = SOLVE_TOLERANCE;
	def.profile = false;
	return def;
}

static void open_front(void **state)
{
	(void)state;
	const gi_context_def def = coarse_def();
	const char *frames = getenv("RELUME_FRAMES");
	run("open box", open_box, &def, frames ? (uint32_t)atoi(frames) : 200, false);
}

static void bright_sky(void **state)
{
	(void)state;
	gi_context_def def = coarse_def();
	def.sky = GI_SKY_ON;
	for (int c = 0; c < 3; c++)
		def.sky_exitance[c] = 3.0f + (float)c;
	run("open box, bright sky", open_box, &def, 50, false);
}

static void closed_room(void **state)
{
	(void)state;
	const gi_context_def def = coarse_def();
	run("closed room", open_room, &def, 50, true);
}

/* ---- materials ---- */

static void light_both(scene pair[2], int which, gi_material m)
{
	for (int k = 0; k < 2; k++)
		assert_gi(gi_set_material(pair[k].gi, which < 0 ? pair[k].light : pair[k].mover[which], 0, m));
}

/* Lamps go out and on again, objects start to shine, turn black and white again, with and without a move in the same
 * frame. */
static void materials(void **state)
{
	(void)state;
	const gi_context_def def = coarse_def();
	const gi_material bright = {.exitance = {40, 30, 20}}, dark = {0}, red = {.rho = {.8f, .1f, .1f}},
			  glowing = {.rho = {.5f, .5f, .5f}, .exitance = {0, 3, 5}}, grey = {.rho = {.5f, .5f, .5f}};
	const struct {
		const char *what;
		int which;
		gi_material value;
		int moves;
	} steps[] = {
	    {"brighter", -1, bright, -1},
	    {"the block glows", BLOCK, glowing, -1},
	    {"the lamp is off", -1, dark, -1},
	    {"the ball is black", BALL, dark, -1},
	    {"the ball is red", BALL, red, BALL},
	    {"the lamp is on", -1, bright, SHEET},
	    {"the sheet glows", SHEET, glowing, BLOCK},
	    {"the block is grey", BLOCK, grey, BLOCK},
	    {"the sheet is black", SHEET, dark, -1},
	    {"the sheet is grey", SHEET, grey, SHEET},
	    {"all dark but the lamp", BLOCK, dark, -1},
	    {"the lamp is off again", -1, dark, BALL},
	    {"a lamp again", -1, bright, -1},
	};
	scene pair[2];
	random_state = 7;
	for (int k = 0; k < 2; k++)
		open_box(&pair[k], &def);
	motion m = start_motion(false);
	for (int k = 0; k < MOVERS; k++)
		pose_both(pair, k, m.pose[k]);
	tally t = {0};
	compare(&pair[0], &pair[1], "materials, first frame", &t);
	t = (tally){0};
	for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
		light_both(pair, steps[k].which, steps[k].value);
		if (steps[k].moves >= 0)
			pose_both(pair, steps[k].moves, random_pose(steps[k].moves, false));
		compare(&pair[0], &pair[1], steps[k].what, &t);
	}
	print_tally("materials", &t);
	for (int k = 0; k < 2; k++)
		gi_context_destroy(pair[k].gi);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(open_front),
	    cmocka_unit_test(bright_sky),
	    cmocka_unit_test(closed_room),
	    cmocka_unit_test(materials),
	};
	return cmocka_run_group_tests_name("update", tests, harness_open, harness_close);
}
