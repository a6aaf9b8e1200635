/* Worlds whose objects come and go: rows that were kept from commit to commit are those of a context in which the scene
 * of now was built at once, to the bit.
 *
 * Random frames of a Cornell box or a closed room, in which there may be a crowd that stays: objects are created,
 * destroyed, hidden, shown, moved, lit and put out, become static or movable, updates have budgets or none. Now and
 * then a context is made that gets the scene of now in its only commit. Objects have the same places and ids there, for
 * samples are drawn by them.
 *
 * RELUME_FRAMES=N: so many, default 100. RELUME_WORLD=box, room or crowd: that one alone.
 */
#include "moving_scene.h"
#include "scenes/body.h"
#include "snapshot.h"

#include "scenes/cornell.h"
#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 8192, AT_ONCE = 12, KINDS = 5 };

/* With the walls and about half of the things as many as make GI_MOBILITY_AUTOMATIC static. */
enum { CROWD = GI_AUTOMATIC_OBJECTS - 7 };

typedef struct thing {
	int kind;
	bool alive, hidden;
	gi_mobility mobility;
	gi_material material;
	gi_pose pose;
	gi_object object;
} thing;

/* A thing that was the first in its place, or larger than those before it: it got new ids. */
typedef struct claim {
	uint32_t place;
	int kind;
} claim;

typedef struct world {
	gi_context *gi;
	bool room; /* closed: no sky */
	bool crowd;
	thing things[MOST];
	uint32_t count;
	claim claims[MOST];
	uint32_t claim_count;
	uint32_t leaves[MOST], nodes[MOST]; /* that a place has ids for */
} world;

static uint32_t chance_state;

static uint32_t chance_of(uint32_t most)
{
	chance_state = chance_state * 1664525u + 1013904223u; /* Numerical Recipes */
	return (chance_state >> 8) % most;
}

/* ---- things ---- */

static bool shape_of(int kind, engine_mesh *mesh)
{
	switch (kind) {
	case 0:
		return shape_box((float[]){-.4f, 0, -.4f}, (float[]){.4f, 1.1f, .4f}, 2, false, mesh);
	case 1:
		return shape_sphere(.5f, 2, mesh);
	case 2:
		return shape_quad((float[]){-.5f, .3f, -.5f}, (float[]){0, 0, 1}, (float[]){1, 0, .2f}, 3, 3, mesh);
	case 3: /* a tile: on the floor, and on others of its kind, it lies in their plane */
		return shape_quad((float[]){-.5f, 0, -.5f}, (float[]){0, 0, 1}, (float[]){1, 0, 0}, 2, 2, mesh);
	default:
		return shape_box((float[]){-.1f, -.1f, -.1f}, (float[]){.1f, .1f, .1f}, 1, false, mesh);
	}
}

static void create(gi_context *gi, thing *t)
{
	engine_mesh mesh;
	assert_true(shape_of(t->kind, &mesh));
	gi_object_def def = scene_mesh_def(&mesh);
	def.name = "thing";
	def.scheme = t->kind == 1 ? GI_SCHEME_CATMULL_CLARK : GI_SCHEME_BILINEAR;
	def.double_sided = t->kind == 2;
	def.mobility = t->mobility;
	def.materials = &t->material;
	def.material_count = 1;
	def.pose = t->pose;
	assert_gi(gi_create_object(gi, &def, &t->object));
	engine_mesh_free(&mesh);
	if (t->hidden)
		assert_gi(gi_set_hidden(gi, t->object, true));
}

static gi_pose pose_of(int kind)
{
	gi_pose p = random_pose(kind == 0 || kind == 3 ? BLOCK : SHEET, true);
	if (kind == 3 && chance_of(2)) {
		p = gi_pose_identity();
		p.position[0] = .5f * (float)chance_of(5) - 1;
		p.position[2] = .5f * (float)chance_of(5) - 1;
	}
	return p;
}

static gi_material material_of(bool emits)
{
	gi_material m = {.rho = {.1f * (float)(1 + chance_of(8)), .5f, .4f}};
	if (emits)
		m.exitance[0] = m.exitance[1] = 5 + (float)chance_of(20);
	return m;
}

static gi_mobility mobility_of(void)
{
	static const gi_mobility choice[] = {GI_MOBILITY_STATIC, GI_MOBILITY_STATIC, GI_MOBILITY_AUTOMATIC,
					     GI_MOBILITY_MOVABLE};
	return choice[chance_of(4)];
}

/* ---- worlds ---- */

static void add_crowd(gi_context *gi)
{
	engine_mesh mesh;
	for (int k = 0; k < CROWD; k++) {
		const float x = -2.6f + .4f * (float)(k % 14), z = -2.6f + .3f * (float)(k / 14);
		assert_true(shape_box((float[]){x, .002f, z}, (float[]){x + .1f, .05f + .01f * (float)(k % 9), z + .1f},
				      1, false, &mesh));
		harness_add(gi, &(harness_object){.name = "one of a crowd", .rho = {.3f, .4f, .5f}}, &mesh);
	}
}

static void build_walls(world *w, const gi_context_def *def)
{
	w->gi = harness_context(def);
	engine_mesh mesh;
	if (w->crowd)
		add_crowd(w->gi);
	if (w->room) {
		assert_true(shape_box((float[]){-2.75f, 0, -2.75f}, (float[]){2.75f, 5.5f, 2.75f}, 4, true, &mesh));
		harness_add(w->gi, &(harness_object){.name = "room", .rho = {.6f, .6f, .6f}}, &mesh);
		assert_true(
		    shape_quad((float[]){-.6f, 5.4f, -.6f}, (float[]){1.2f, 0, 0}, (float[]){0, 0, 1.2f}, 2, 2, &mesh));
		harness_add(w->gi, &(harness_object){.name = "light", .exitance = {40, 40, 40}}, &mesh);
		return;
	}
	cornell_def box = cornell_def_default();
	box.wall_faces = 2;
	box.wall_levels = 1;
	box.light_levels = 1;
	box.buddha = box.balls = false;
	cornell made;
	assert_gi(cornell_create(w->gi, &box, &made));
}

static thing *pick(world *w)
{
	uint32_t alive = 0;
	for (uint32_t k = 0; k < w->count; k++)
		alive += w->things[k].alive;
	if (!alive)
		return NULL;
	uint32_t which = chance_of(alive);
	for (uint32_t k = 0; k < w->count; k++)
		if (w->things[k].alive && which-- == 0)
			return &w->things[k];
	return NULL;
}

static uint32_t alive_of(const world *w)
{
	uint32_t alive = 0;
	for (uint32_t k = 0; k < w->count; k++)
		alive += w->things[k].alive;
	return alive;
}

/* Leaves and nodes of each kind. */
static uint32_t sizes[KINDS][2];

static void measure_kinds(const gi_context_def *def)
{
	for (int kind = 0; kind < KINDS; kind++) {
		gi_context_def alone = *def;
		gi_report r;
		alone.sky = GI_SKY_OFF;
		gi_context *gi = harness_context(&alone);
		create(gi, &(thing){.kind = kind, .pose = gi_pose_identity()});
		assert_gi(gi_commit(gi));
		assert_gi(gi_get_report(gi, &r));
		sizes[kind][0] = r.leaves;
		sizes[kind][1] = r.nodes;
		gi_context_destroy(gi);
	}
}

static void note_claim(world *w, const thing *t)
{
	const uint32_t place = t->object.index1, *size = sizes[t->kind];
	assert_true(place < MOST);
	if (size[0] <= w->leaves[place] && size[1] <= w->nodes[place])
		return;
	w->claims[w->claim_count++] = (claim){place, t->kind};
	w->leaves[place] = size[0];
	w->nodes[place] = size[1];
}

static void come(world *w)
{
	assert_true(w->count < MOST);
	thing *t = &w->things[w->count++];
	*t = (thing){.kind = (int)chance_of(KINDS), .alive = true};
	t->material = material_of(chance_of(4) == 0);
	t->mobility = mobility_of();
	t->pose = pose_of(t->kind);
	create(w->gi, t);
	note_claim(w, t);
}

static void go(world *w, thing *t)
{
	t->alive = false;
	assert_gi(gi_destroy_object(w->gi, t->object));
}

/* Returns whether objects came or went. */
static bool something_happens(world *w)
{
	thing *t = pick(w);
	const uint32_t what = chance_of(11);
	if (!t || (what < 2 && alive_of(w) < AT_ONCE)) {
		come(w);
		return true;
	}
	if (what < 4 && alive_of(w) > 2) {
		go(w, t);
		return true;
	}
	if (what == 4 || what == 5) {
		t->hidden = !t->hidden;
		assert_gi(gi_set_hidden(w->gi, t->object, t->hidden));
	} else if (what == 6) {
		t->material = material_of(chance_of(2) == 0);
		assert_gi(gi_set_material(w->gi, t->object, 0, t->material));
	} else if (what == 10) {
		t->mobility = mobility_of();
		assert_gi(gi_set_mobility(w->gi, t->object, t->mobility));
	} else if (t->mobility == GI_MOBILITY_MOVABLE || chance_of(4) == 0) {
		t->pose = pose_of(t->kind);
		assert_gi(gi_set_pose(w->gi, t->object, t->pose));
		assert_gi(gi_get_pose(w->gi, t->object, &t->pose));
		assert_gi(gi_get_mobility(w->gi, t->object, &t->mobility));
	}
	return false;
}

static uint32_t static_things; /* of worlds built at once */

/* The scene of now, in one commit. */
static void build_at_once(const world *w, const gi_context_def *def, world *out)
{
	*out = *w;
	build_walls(out, def);
	/* Places get their ids from what is first made there, and others from what is larger; then each object gets its
	 * own. */
	static gi_object fillers[MOST];
	memset(fillers, 0, sizeof fillers);
	for (uint32_t k = 0; k < w->claim_count; k++) {
		thing filler = {.kind = w->claims[k].kind, .pose = gi_pose_identity()};
		const uint32_t place = w->claims[k].place;
		if (fillers[place].index1)
			assert_gi(gi_destroy_object(out->gi, fillers[place]));
		create(out->gi, &filler);
		assert_int_equal(filler.object.index1, place);
		fillers[place] = filler.object;
	}
	for (uint32_t k = 0; k < out->count; k++) {
		thing *t = &out->things[k];
		if (!t->alive)
			continue;
		const uint32_t place = t->object.index1;
		static_things += t->mobility == GI_MOBILITY_STATIC && !t->hidden;
		assert_gi(gi_destroy_object(out->gi, fillers[place]));
		fillers[place] = (gi_object){0};
		create(out->gi, t);
		assert_int_equal(t->object.index1, place);
	}
	for (uint32_t k = 0; k < MOST; k++)
		if (fillers[k].index1)
			assert_gi(gi_destroy_object(out->gi, fillers[k]));
	assert_gi(gi_commit(out->gi));
}

typedef struct figures {
	uint32_t compared, commits;
	double entries, fresh, kept_entries;
	uint64_t common; /* entries of several objects at once */
} figures;

static uint64_t common_entries(const snapshot *s)
{
	uint64_t count = 0;
	for (uint64_t k = 0; k < s->entry_count; k++) {
		const gi_entry *e = &s->entries[k];
		count += e->leaf_count && s->leaves[e->first_leaf].object.index1 !=
					      s->leaves[e->first_leaf + e->leaf_count - 1].object.index1;
	}
	return count;
}

static void compare_with_one_built_at_once(world *w, const gi_context_def *def, const char *when, figures *f)
{
	static world other;
	assert_gi(gi_commit(w->gi)); /* which of surfaces in one place is seen is decided there */
	harness_update(w->gi);
	build_at_once(w, def, &other);
	const gi_report full = harness_update(other.gi);
	snapshot a = snapshot_take(w->gi), b = snapshot_take(other.gi);
	snapshot_expect_same_rows(&a, &b, when);
	const double distance = snapshot_distance(&a, &b), largest = snapshot_largest(&b);
	if (!(distance <= 1e-5 * largest))
		fail_msg("%s: B is %.3g W/m2 from the other's, whose largest is %g", when, distance, largest);
	f->entries += (double)full.entries;
	f->common += common_entries(&b);
	f->compared++;
	snapshot_free(&a);
	snapshot_free(&b);
	gi_context_destroy(other.gi);
}

static gi_context_def world_def(bool room)
{
	gi_context_def def = harness_def();
	def.row_tolerance = .05f;
	def.solve_tolerance = 1e-4f;
	def.profile = false;
	def.sky = room ? GI_SKY_AUTO : GI_SKY_ON;
	if (!room)
		def.sky_exitance[2] = 2;
	return def;
}

static void run(const char *name, bool room, bool crowd, uint32_t seed)
{
	static world w;
	const char *only = getenv("RELUME_WORLD");
	if (only && strcmp(only, name) != 0)
		skip();
	const gi_context_def def = world_def(room);
	const char *text = getenv("RELUME_FRAMES");
	const uint32_t frames = text ? (uint32_t)atoi(text) : 100, every = frames > 200 ? 25 : 5;
	figures f = {0};
	chance_state = seed;
	static_things = 0;
	seed_motion(seed);
	memset(&w, 0, sizeof w);
	w.room = room;
	w.crowd = crowd;
	measure_kinds(&def);
	build_walls(&w, &def);
	for (int k = 0; k < 8; k++)
		come(&w);
	assert_gi(gi_commit(w.gi));
	harness_update(w.gi);
	for (uint32_t frame = 1; frame <= frames; frame++) {
		char when[64];
		snprintf(when, sizeof when, "%s, frame %u", name, frame);
		bool others = false;
		for (uint32_t k = 0; k <= chance_of(3); k++)
			others = something_happens(&w) || others;
		/* What was made takes part after a commit, what was destroyed is gone before it. */
		if (others && chance_of(4)) {
			assert_gi(gi_commit(w.gi));
			f.commits++;
		}
		const gi_budget budget = {.rays = 500 + chance_of(3000)};
		assert_gi(gi_update(w.gi, chance_of(2) ? &budget : NULL));
		assert_gi(gi_finish(w.gi));
		gi_report r;
		assert_gi(gi_get_report(w.gi, &r));
		assert_true(r.outcome != GI_OUTCOME_NOT_FINITE);
		f.fresh += (double)r.new_entries;
		f.kept_entries += (double)r.entries;
		if (frame % every == 0)
			compare_with_one_built_at_once(&w, &def, when, &f);
	}
	printf("  %s: %u frames, %u things, %u commits; %u times built at once, %.0f entries, %.1f static things, "
	       "%.0f common entries; cut anew %.1f %% a frame\n",
	       name, frames, w.count, f.commits, f.compared, f.entries / f.compared, (double)static_things / f.compared,
	       (double)f.common / f.compared, 100 * f.fresh / f.kept_entries);
	assert_true(f.common > 0);
	gi_context_destroy(w.gi);
}

static void in_a_box(void **state)
{
	(void)state;
	run("box", false, false, 5);
}

static void in_a_room(void **state)
{
	(void)state;
	run("room", true, false, 17);
}

/* Now and then there are enough objects that stay for those that are not said to move to be static. */
static void in_a_crowd(void **state)
{
	(void)state;
	run("crowd", true, true, 29);
}

/* One thing more and one less, again and again: nothing is built that was there, and memory is flat to the byte. */
static void one_more_one_less(void **state)
{
	(void)state;
	static world w;
	const gi_context_def def = world_def(false);
	memset(&w, 0, sizeof w);
	chance_state = 3;
	seed_motion(3);
	build_walls(&w, &def);
	for (int k = 0; k < 6; k++)
		come(&w);
	assert_gi(gi_commit(w.gi));
	const gi_report full = harness_update(w.gi);
	thing *mover = &w.things[0];
	assert_gi(gi_set_pose(w.gi, mover->object, pose_of(mover->kind)));
	harness_update(w.gi);
	const thing one = {.kind = 0, .alive = true, .material = {.rho = {.5f, .5f, .5f}}, .pose = pose_of(0)};
	gi_report flat = {0};
	uint64_t added = 0, removed = 0;
	for (int round = 0; round < 12; round++) {
		thing *t = &w.things[w.count];
		*t = one;
		create(w.gi, t);
		assert_gi(gi_commit(w.gi));
		added = harness_update(w.gi).new_entries;
		go(&w, t);
		assert_gi(gi_commit(w.gi));
		const gi_report r = harness_update(w.gi);
		removed = r.new_entries;
		if (round == 2)
			flat = r;
		if (round > 2)
			assert_int_equal(r.gpu_bytes, flat.gpu_bytes);
		if (round > 2)
			assert_int_equal(r.entries, flat.entries);
	}
	printf("  of %llu entries one more takes %llu, one less %llu; %.1f MB\n", (unsigned long long)full.entries,
	       (unsigned long long)added, (unsigned long long)removed, 1e-6 * (double)flat.gpu_bytes);
	assert_true(added < full.entries / 2);
	assert_int_equal(removed, 0);
	gi_context_destroy(w.gi);
}

/* A box that moves below a cover: every row that faces it has another entry of it, which no ray sees, as before.
 * What rows sum to stays, so that none outside the cover is closed. Without the cover those are that see it, and
 * both times rows are a rebuild's. */
static void a_mover_below_a_cover(void **state)
{
	(void)state;
	static world w;
	for (int covered = 1; covered >= 0; covered--) {
		const gi_context_def def = world_def(true);
		memset(&w, 0, sizeof w);
		w.room = true;
		build_walls(&w, &def);
		engine_mesh mesh;
		uint32_t inside = 0;
		if (covered) {
			assert_true(shape_box((float[]){-.6f, .001f, -.6f}, (float[]){.6f, 1, .6f}, 3, false, &mesh));
			harness_add(w.gi, &(harness_object){.name = "cover", .rho = {.5f, .5f, .5f}}, &mesh);
			inside = 6 * 9;
		}
		assert_true(shape_box((float[]){-.1f, .3f, -.1f}, (float[]){.1f, .5f, .1f}, 2, false, &mesh));
		const gi_object mover =
		    harness_add(w.gi, &(harness_object){.name = "mover", .rho = {.5f, .5f, .5f}}, &mesh);
		inside += 6 * 4;
		assert_gi(gi_commit(w.gi));
		harness_update(w.gi);
		gi_report r = {0};
		for (int frame = 1; frame <= 4; frame++) {
			assert_gi(gi_set_pose(w.gi, mover,
					      (gi_pose){{.05f * (float)frame, 0, .02f * (float)frame}, {0, 0, 0, 1}}));
			r = harness_update(w.gi);
			assert_true(r.dirty_rows > r.leaves / 4);
			assert_true(covered ? r.closed_rows <= inside : r.closed_rows > r.leaves / 8);
		}
		printf("  %s: of %u rows %llu are dirty, %llu are closed\n", covered ? "below a cover" : "in the open",
		       r.leaves, (unsigned long long)r.dirty_rows, (unsigned long long)r.closed_rows);
		snapshot kept = snapshot_take(w.gi);
		gi_invalidate(w.gi);
		harness_update(w.gi);
		snapshot anew = snapshot_take(w.gi);
		snapshot_expect_same_rows(&kept, &anew, "a mover");
		snapshot_free(&kept);
		snapshot_free(&anew);
		gi_context_destroy(w.gi);
	}
}

/* What is known of the B of an update under a budget, against that of an exact one. */
static uint64_t expect_certified(gi_context *gi, const char *when, double *worst)
{
	gi_report part;
	assert_gi(gi_update(gi, &(gi_budget){.rays = 300}));
	assert_gi(gi_finish(gi));
	assert_gi(gi_get_report(gi, &part));
	if (!(part.rays < 1200))
		fail_msg("%s: %llu rays of 300", when, (unsigned long long)part.rays);
	snapshot a = snapshot_take(gi);
	const gi_report full = harness_update(gi);
	snapshot b = snapshot_take(gi);
	const double distance = snapshot_distance(&a, &b),
		     bound = (double)part.solve_bound + (double)part.stale_bound + (double)full.solve_bound;
	if (!(distance <= bound))
		fail_msg("%s: B is off by %g W/m2, and at most %g was certified", when, distance, bound);
	*worst = fmax(*worst, distance / bound);
	snapshot_free(&a);
	snapshot_free(&b);
	return part.waiting_rows;
}

/* After a commit too an update keeps to its budget, and what it leaves to do is bounded. */
static void under_a_budget(void **state)
{
	(void)state;
	static world w;
	const gi_context_def def = world_def(false);
	double worst = 0;
	memset(&w, 0, sizeof w);
	chance_state = 11;
	seed_motion(11);
	build_walls(&w, &def);
	for (int k = 0; k < 6; k++)
		come(&w);
	assert_gi(gi_commit(w.gi));
	harness_update(w.gi);
	for (int round = 0; round < 12; round++) {
		come(&w);
		assert_gi(gi_commit(w.gi));
		assert_true(expect_certified(w.gi, "one more", &worst) > 0);
		go(&w, pick(&w));
		if (round % 2)
			assert_gi(gi_commit(w.gi));
		expect_certified(w.gi, "one less", &worst);
	}
	printf("  B was off by %.2g of what was certified at most\n", worst);
	gi_context_destroy(w.gi);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(in_a_box),
	    cmocka_unit_test(in_a_room),
	    cmocka_unit_test(in_a_crowd),
	    cmocka_unit_test(one_more_one_less),
	    cmocka_unit_test(a_mover_below_a_cover),
	    cmocka_unit_test(under_a_budget),
	};
	return cmocka_run_group_tests_name("worlds", tests, harness_open, harness_close);
}
