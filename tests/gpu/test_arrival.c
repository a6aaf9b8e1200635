/* Objects that came, or are shown again, start from the light around them, not from black: how far their first pictures
 * are from the solution where an update may not build their rows, and that all that is certified of an update still
 * holds.
 */
#include "snapshot.h"

#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { BOXES = 12, FRAMES = 8 };

/* ---- places: other sizes, turned, far off, under a sky ---- */

typedef struct place {
	const char *name;
	float scale, far; /* metres */
	bool open;        /* ground below a bright sky instead of a room with a lamp */
} place;

static const float TURN[4] = {.18f, .37f, -.12f, .9f}; /* of all of it */

static gi_pose pose_in(const place *p, float x, float y, float z)
{
	const bool turned = p->scale != 1;
	gi_pose pose = gi_pose_identity();
	float at[3] = {p->scale * x, p->scale * y, p->scale * z};
	if (turned) { /* v + 2 q x (q x v + w v) */
		float length = 0, q[4], c[3], v[3];
		for (int k = 0; k < 4; k++)
			length += TURN[k] * TURN[k];
		for (int k = 0; k < 4; k++)
			q[k] = pose.rotation[k] = TURN[k] / sqrtf(length);
		for (int k = 0; k < 3; k++)
			c[k] = q[(k + 1) % 3] * at[(k + 2) % 3] - q[(k + 2) % 3] * at[(k + 1) % 3] + q[3] * at[k];
		for (int k = 0; k < 3; k++)
			v[k] = at[k] + 2 * (q[(k + 1) % 3] * c[(k + 2) % 3] - q[(k + 2) % 3] * c[(k + 1) % 3]);
		for (int k = 0; k < 3; k++)
			at[k] = v[k];
	}
	for (int k = 0; k < 3; k++)
		pose.position[k] = at[k] + p->far;
	return pose;
}

static gi_object add(gi_context *gi, const place *p, gi_pose pose, gi_material m, engine_mesh *mesh)
{
	for (uint32_t k = 0; k < 3 * mesh->vertex_count; k++)
		mesh->positions[k] *= p->scale;
	harness_object o = {.name = "thing"};
	for (int c = 0; c < 3; c++) {
		o.rho[c] = m.rho[c];
		o.exitance[c] = m.exitance[c];
	}
	const gi_object object = harness_add(gi, &o, mesh);
	assert_gi(gi_set_pose(gi, object, pose));
	return object;
}

static gi_object add_box(gi_context *gi, const place *p, float x, float z, float rho)
{
	engine_mesh mesh;
	assert_true(shape_box((float[]){-.25f, 0, -.25f}, (float[]){.25f, .6f, .25f}, 2, false, &mesh));
	return add(gi, p, pose_in(p, x, .01f, z), (gi_material){.rho = {rho, rho, .8f * rho}}, &mesh);
}

static gi_context *open_place(const place *p)
{
	gi_context_def def = harness_def();
	def.row_tolerance = .03f;
	def.sky = p->open ? GI_SKY_ON : GI_SKY_AUTO;
	for (int c = 0; c < 3 && p->open; c++)
		def.sky_exitance[c] = 5;
	gi_context *gi = harness_context(&def);
	engine_mesh mesh;
	assert_true(p->open ? shape_quad((float[]){-3, 0, -3}, (float[]){0, 0, 6}, (float[]){6, 0, 0}, 8, 8, &mesh)
			    : shape_box((float[]){-3, 0, -3}, (float[]){3, 2.5f, 3}, 8, true, &mesh));
	add(gi, p, pose_in(p, 0, 0, 0), (gi_material){.rho = {.7f, .6f, .5f}}, &mesh);
	assert_true(shape_quad((float[]){-.5f, 2.4f, -.5f}, (float[]){1, 0, 0}, (float[]){0, 0, 1}, 2, 2, &mesh));
	add(gi, p, pose_in(p, 0, 0, 0), (gi_material){.exitance = {20, 20, 20}}, &mesh);
	for (int k = 0; k < BOXES; k++)
		add_box(gi, p, 1.5f * (float)(k % 4) - 2.2f, 1.7f * (float)(k / 4) - 2.f, .5f);
	return gi;
}

/* ---- figures ---- */

/* Of the leaves of an object, or of all: sum of area |B - B'| over that of the light they reflect in truth. */
static double off(const snapshot *now, const snapshot *exact, gi_object object)
{
	double sum = 0, whole = 1e-30;
	for (uint32_t k = 0; k < exact->leaf_count; k++) {
		const gi_leaf *x = &now->leaves[k], *y = &exact->leaves[k];
		if (object.index1 && y->object.index1 != object.index1)
			continue;
		for (int c = 0; c < 3; c++) {
			sum += (double)y->area * fabs((double)x->radiosity[c] - (double)y->radiosity[c]);
			whole += (double)y->area * ((double)y->radiosity[c] - (double)y->exitance[c]);
		}
	}
	return sum / whole;
}

static void expect_within_bounds(const snapshot *s, float sky, const char *when)
{
	float brightest = sky, rho = 0;
	for (uint32_t k = 0; k < s->leaf_count; k++)
		for (int c = 0; c < 3; c++) {
			brightest = fmaxf(brightest, s->leaves[k].exitance[c]);
			rho = fmaxf(rho, s->leaves[k].rho[c]);
		}
	const float ceiling = brightest / (1 - rho);
	for (uint32_t k = 0; k < s->leaf_count; k++)
		for (int c = 0; c < 3; c++) {
			const gi_leaf *l = &s->leaves[k];
			if (!(l->radiosity[c] >= l->exitance[c] && l->radiosity[c] <= ceiling))
				fail_msg("%s: B %g of leaf %u is outside [%g, %g]", when, (double)l->radiosity[c], k,
					 (double)l->exitance[c], (double)ceiling);
		}
}

typedef struct arrival {
	const char *how;
	gi_budget budget;
	bool shown;       /* it was there and hidden */
	double most, all; /* share that it may be off by in the first frame, it and all leaves */
} arrival;

/* Returns a hash over the B of all frames. */
static uint64_t watch(const place *p, const arrival *a, bool tell)
{
	gi_context *gi = open_place(p), *whole = open_place(p);
	gi_object came = {0};
	if (a->shown) {
		came = add_box(gi, p, .1f, .9f, .6f);
		assert_gi(gi_set_hidden(gi, came, true));
	}
	assert_gi(gi_commit(gi));
	harness_update(gi);
	const gi_object there = add_box(whole, p, .1f, .9f, .6f);
	assert_gi(gi_commit(whole));
	const gi_report full = harness_update(whole);
	snapshot exact = snapshot_take(whole);
	if (a->shown) {
		assert_gi(gi_set_hidden(gi, came, false));
	} else {
		came = add_box(gi, p, .1f, .9f, .6f);
		assert_gi(gi_commit(gi));
	}
	assert_int_equal(came.index1, there.index1);
	uint64_t hash = 0;
	if (tell)
		printf("  %s, %s: off by, of itself / of all,", p->name, a->how);
	for (int frame = 0; frame < FRAMES; frame++) {
		char when[96];
		snprintf(when, sizeof when, "%s, %s, frame %d", p->name, a->how, frame);
		assert_gi(gi_update(gi, &a->budget));
		assert_gi(gi_finish(gi));
		gi_report r;
		assert_gi(gi_get_report(gi, &r));
		snapshot now = snapshot_take(gi);
		const double own = off(&now, &exact, came), all = off(&now, &exact, (gi_object){0});
		if (tell)
			printf(" %.1f/%.2f", 100 * own, 100 * all);
		const double distance = snapshot_distance(&now, &exact),
			     bound = (double)r.solve_bound + (double)r.stale_bound + (double)full.solve_bound;
		if (!(distance <= bound + 1e-6 * snapshot_largest(&exact)))
			fail_msg("%s: B is off by %g W/m2, and at most %g was certified", when, distance, bound);
		if (frame == 0 && !(own <= a->most && all <= a->all))
			fail_msg("%s: off by %.1f %%, all by %.2f %%", when, 100 * own, 100 * all);
		expect_within_bounds(&now, p->open ? 5 : 0, when);
		hash = 31 * hash + snapshot_hash_radiosity(&now);
		snapshot_free(&now);
	}
	if (tell)
		printf(" %%\n");
	/* Nothing of it is left once all rows are built. */
	harness_update(gi);
	snapshot after = snapshot_take(gi);
	snapshot_expect_same_rows(&after, &exact, a->how);
	snapshot_free(&after);
	snapshot_free(&exact);
	gi_context_destroy(gi);
	gi_context_destroy(whole);
	return hash;
}

static const place ROOM = {"room", 1, 0, false};
static const arrival FEW = {"300 rays", {.rays = 300}, false, .3, .031};

/* Black, as they were, they are off by 72 % in the first frame of 300 rays, and all by 3.5 %. */
static void first_frames(void **state)
{
	(void)state;
	static const place large = {"a room 90 times larger, turned, far off", 90, 4000, false},
			   small = {"a room of millimetres, turned", .004f, 0, false},
			   ground = {"ground below a sky", 1, 0, true};
	watch(&ROOM, &FEW, true);
	watch(&ROOM, &(arrival){"2,000 rays", {.rays = 2000}, false, .06, .007}, true);
	watch(&ROOM, &(arrival){"no budget", {.rays = 0}, false, .001, .001}, true);
	watch(&ROOM, &(arrival){"300 rays, shown", {.rays = 300}, true, .3, .031}, true);
	watch(&large, &FEW, true);
	watch(&small, &FEW, true);
	watch(&ground, &FEW, true);
}

static void the_same_every_time(void **state)
{
	(void)state;
	assert_true(watch(&ROOM, &FEW, false) == watch(&ROOM, &FEW, false));
}

/* A leaf that sees nothing borrows the light of one that does, and is black when its row is built. */
static void what_sees_nothing_gives_it_back(void **state)
{
	(void)state;
	gi_context_def def = harness_def();
	def.sky = GI_SKY_OFF;
	gi_context *gi = harness_context(&def);
	const gi_material grey = {.rho = {.5f, .5f, .5f}}, lamp = {.exitance = {20, 20, 20}};
	const place here = {"here", 1, 0, false};
	engine_mesh mesh;
	/* A floor, a lamp over it, and a shelf between that is lit from below alone. */
	assert_true(shape_quad((float[]){-1, 0, -1}, (float[]){0, 0, 2}, (float[]){2, 0, 0}, 6, 6, &mesh));
	add(gi, &here, gi_pose_identity(), grey, &mesh);
	assert_true(shape_quad((float[]){-1, 2, -1}, (float[]){2, 0, 0}, (float[]){0, 0, 2}, 1, 1, &mesh));
	add(gi, &here, gi_pose_identity(), lamp, &mesh);
	assert_true(shape_quad((float[]){-.2f, 1, -.2f}, (float[]){.4f, 0, 0}, (float[]){0, 0, .4f}, 2, 2, &mesh));
	add(gi, &here, gi_pose_identity(), grey, &mesh);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	/* Below the floor, looking down. */
	assert_true(shape_quad((float[]){-.2f, -1, -.2f}, (float[]){.4f, 0, 0}, (float[]){0, 0, .4f}, 2, 2, &mesh));
	const gi_object dark = add(gi, &here, gi_pose_identity(), grey, &mesh);
	assert_gi(gi_commit(gi));
	const gi_budget budget = {.rays = 1};
	assert_gi(gi_update(gi, &budget));
	for (int round = 0; round < 2; round++) {
		snapshot s = snapshot_take(gi);
		float most = 0;
		for (uint32_t k = 0; k < s.leaf_count; k++)
			if (s.leaves[k].object.index1 == dark.index1)
				most = fmaxf(most, s.leaves[k].radiosity[0]);
		printf("  what sees nothing: B %.3g W/m2 %s\n", (double)most, round ? "by its own row" : "at first");
		assert_true(round ? most == 0 : most > 0);
		snapshot_free(&s);
		if (round == 0)
			harness_update(gi);
	}
	gi_context_destroy(gi);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(first_frames),
	    cmocka_unit_test(the_same_every_time),
	    cmocka_unit_test(what_sees_nothing_gives_it_back),
	};
	return cmocka_run_group_tests_name("arrival", tests, harness_open, harness_close);
}
