/* Memory runs out at every allocation in turn, the CPU's and the GPU's: each call says GI_ERROR_OUT_OF_MEMORY in one
 * line or does without, leaves rows, light and picture as they were, and works once there is memory again.
 */
#include "faults.h"
#include "snapshot.h"

#include "scenes/body.h"
#include "scenes/shapes.h"
#include "target.h"

#include <glad/gl.h>

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 32 };

static struct {
	uint32_t count;
	char text[1024];
} heard;

static void hear(gi_result result, const char *message, void *user)
{
	(void)user;
	assert_int_equal(result, GI_ERROR_OUT_OF_MEMORY);
	heard.count++;
	snprintf(heard.text, sizeof heard.text, "%s", message);
}

/* ---- the scene ---- */

typedef struct loaded {
	gi_context *gi;
	gi_object ball;
	target target;
	float shift; /* of the ball */
} loaded;

static gi_object add_quad(gi_context *gi, const char *name, float height, float exitance, uint32_t n)
{
	engine_mesh mesh;
	const bool up = exitance == 0;
	assert_true(shape_quad((float[]){-1, height, -1}, up ? (float[]){0, 0, 2} : (float[]){2, 0, 0},
			       up ? (float[]){2, 0, 0} : (float[]){0, 0, 2}, n, n, &mesh));
	return harness_add(
	    gi, &(harness_object){.name = name, .rho = {.5f, .6f, .7f}, .exitance = {exitance, exitance, 1}}, &mesh);
}

static gi_object add_ball(gi_context *gi, float x)
{
	engine_mesh mesh;
	assert_true(shape_sphere(.3f, 2, &mesh));
	return harness_add(
	    gi,
	    &(harness_object){.name = "ball", .rho = {.5f, .5f, .5f}, .exitance = {2, 2, 2}, .position = {x, .5f, 0}},
	    &mesh);
}

static gi_context_def faulty_def(bool coarse)
{
	gi_context_def def = harness_def();
	def.message = hear;
	def.row_tolerance = coarse ? 1 : .05f;
	def.emitter_refinement = coarse ? 1 : 20;
	def.solve_tolerance = 1e-6f;
	def.estimate_leaves = 16;
	faults_in(&def);
	return def;
}

static loaded load(bool coarse)
{
	const gi_context_def def = faulty_def(coarse);
	loaded l = {.gi = harness_context(&def)};
	add_quad(l.gi, "floor", 0, 0, 3);
	add_quad(l.gi, "light", 2, 10, 1);
	l.ball = add_ball(l.gi, 0);
	assert_gi(gi_commit(l.gi));
	l.target = target_make(SIZE);
	return l;
}

static void unload(loaded *l)
{
	target_free(&l->target);
	gi_context_destroy(l->gi);
	const faults_memory left = faults_memory_now();
	if (left.blocks || left.bytes)
		fail_msg("%" PRId64 " blocks of %" PRId64 " bytes in all were never freed", left.blocks, left.bytes);
}

/* ---- what must not change ---- */

typedef struct look {
	snapshot rows;
	float pixels[SIZE * SIZE * 4];
} look;

/* From above, parallel. */
static gi_result draw(loaded *l, gi_overlay overlay)
{
	gi_view view = gi_view_default();
	const float world[16] = {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1},
		    clip[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -.2f, 0, 0, 0, 0, 1};
	memcpy(view.view_from_world, world, sizeof world);
	memcpy(view.clip_from_view, clip, sizeof clip);
	view.overlay = overlay;
	return target_try(&l->target, l->gi, view);
}

static look *look_at(loaded *l)
{
	look *seen = calloc(1, sizeof *seen);
	assert_non_null(seen);
	assert_gi(draw(l, GI_OVERLAY_NONE));
	memcpy(seen->pixels, l->target.pixels, sizeof seen->pixels);
	seen->rows = snapshot_take(l->gi);
	return seen;
}

static void free_look(look *seen)
{
	snapshot_free(&seen->rows);
	free(seen);
}

static void expect_as_before(loaded *l, const look *before, const char *what)
{
	look *now = look_at(l);
	snapshot_expect_same_rows(&before->rows, &now->rows, what);
	assert_int_equal(snapshot_hash_radiosity(&before->rows), snapshot_hash_radiosity(&now->rows));
	if (memcmp(before->pixels, now->pixels, sizeof now->pixels) != 0)
		fail_msg("after %s the picture is another", what);
	free_look(now);
}

/* ---- what is tried ---- */

typedef gi_result attempt(loaded *l);

static gi_result try_commit(loaded *l)
{
	return gi_commit(l->gi);
}

static const float square[12] = {0, 1, 0, 1, 1, 0, 1, 1, 1, 0, 1, 1};
static const uint32_t corners[4] = {0, 1, 2, 3};

static gi_result create(loaded *l, const gi_object_def *def)
{
	gi_object object;
	const gi_result result = gi_create_object(l->gi, def, &object);
	assert_true((result == GI_OK) == (object.index1 != 0));
	if (!result)
		assert_gi(gi_destroy_object(l->gi, object));
	return result;
}

static gi_object_def square_def(void)
{
	gi_object_def def = gi_object_def_default();
	def.name = "square";
	def.positions = square;
	def.vertex_count = 4;
	def.indices = corners;
	def.index_count = 4;
	def.face_count = 1;
	return def;
}

/* Creases, both sides, finer drawing. */
static gi_result try_create(loaded *l)
{
	static const uint32_t crease[2] = {0, 1};
	static const float sharp[1] = {2};
	gi_object_def def = square_def();
	def.scheme = GI_SCHEME_CATMULL_CLARK;
	def.levels = 1;
	def.double_sided = true;
	def.crease_vertices = crease;
	def.crease_sharpness = sharp;
	def.crease_count = 1;
	return create(l, &def);
}

static gi_result try_create_by_size(loaded *l)
{
	gi_object_def def = square_def();
	def.leaf_size = .3f;
	def.double_sided = true;
	return create(l, &def);
}

static gi_result try_create_drawn(loaded *l)
{
	gi_object_def def = square_def();
	def.draw_positions = square;
	def.draw_vertex_count = 4;
	def.draw_indices = corners;
	def.draw_index_count = 3;
	return create(l, &def);
}

/* A shape that changes: by joints, refined as a whole or split. */
static gi_object_def skin_def(void)
{
	static const uint32_t joints[16];
	static const float weights[16] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
	gi_object_def def = square_def();
	def.deforms = true;
	def.joints = joints;
	def.joint_weights = weights;
	def.joint_count = 1;
	def.double_sided = true;
	return def;
}

static gi_result try_create_skin(loaded *l)
{
	gi_object_def def = skin_def();
	def.scheme = GI_SCHEME_CATMULL_CLARK;
	def.levels = 1;
	return create(l, &def);
}

static gi_result try_create_skin_by_size(loaded *l)
{
	gi_object_def def = skin_def();
	def.leaf_size = .4f;
	return create(l, &def);
}

static gi_result create_instance(loaded *l, gi_object of)
{
	gi_object object;
	const gi_result result = gi_create_instance(l->gi, of, gi_pose_identity(), &object);
	assert_true((result == GI_OK) == (object.index1 != 0));
	if (!result)
		assert_gi(gi_destroy_object(l->gi, object));
	return result;
}

static gi_result try_instance(loaded *l)
{
	return create_instance(l, l->ball);
}

/* What put_up_a_skin made; it waits for a commit. */
static gi_object skin;

static void put_up_a_skin(loaded *l)
{
	gi_object_def def = skin_def();
	def.scheme = GI_SCHEME_CATMULL_CLARK;
	def.levels = 1;
	assert_gi(gi_create_object(l->gi, &def, &skin));
}

static gi_result try_instance_of_skin(loaded *l)
{
	return create_instance(l, skin);
}

/* With an allocator that is not the context's, which then has blocks of both. */
static gi_result try_prepare(loaded *l)
{
	gi_object_def def = square_def();
	def.scheme = GI_SCHEME_CATMULL_CLARK;
	def.levels = 2;
	const gi_allocator allocator = faults_allocator();
	gi_prepared_object *made = NULL;
	gi_result result = gi_prepare_object(&def, hear, NULL, &allocator, &made);
	assert_true((result == GI_OK) == (made != NULL));
	gi_object object = {0};
	if (!result)
		result = gi_create_prepared_object(l->gi, &made, &object);
	gi_free_prepared_object(made);
	if (!result)
		assert_gi(gi_destroy_object(l->gi, object));
	return result;
}

static gi_result try_choose(loaded *l)
{
	gi_object_def def = square_def();
	gi_leaf_choice_def choice_def = gi_leaf_choice_def_default();
	choice_def.leaves = 20;
	gi_leaf_choice choice;
	const gi_result result = gi_choose_leaves(l->gi, &choice_def, &def, 1, &choice);
	gi_free_leaf_choice(&choice);
	return result;
}

static gi_result try_draw(loaded *l)
{
	return draw(l, GI_OVERLAY_NONE);
}

static gi_result try_overlay(loaded *l)
{
	return draw(l, GI_OVERLAY_WIREFRAME);
}

static gi_result try_heat_map(loaded *l)
{
	return draw(l, GI_OVERLAY_DIRTY);
}

static gi_result try_update(loaded *l)
{
	gi_invalidate(l->gi);
	return gi_update(l->gi, NULL);
}

/* A mover back and forth, so that the rows are the same again every other time. */
static gi_result try_budget(loaded *l)
{
	static const gi_budget budget = {.rays = 1 << 30};
	l->shift = l->shift > 0 ? 0 : .125f;
	assert_gi(gi_set_pose(l->gi, l->ball, (gi_pose){{l->shift, .5f, 0}, {0, 0, 0, 1}}));
	return gi_update(l->gi, &budget);
}

static gi_result try_read(loaded *l)
{
	static gi_leaf leaves[256];
	static gi_entry entries[65536];
	static gi_link links[65536];
	uint32_t leaf_count = 1;
	uint64_t entry_count = 1, link_count = 1;
	double f;
	gi_result result = gi_read_leaves(l->gi, leaves, 256, &leaf_count);
	if (!result)
		result = gi_read_entries(l->gi, entries, 65536, &entry_count);
	if (!result)
		result = gi_read_links(l->gi, links, 65536, &link_count);
	if (!result)
		result = gi_form_factor(l->gi, l->ball, l->ball, &f);
	return result;
}

static gi_result try_paths(loaded *l)
{
	static float irradiance[3 * 256];
	uint32_t count;
	return gi_trace_paths(l->gi, &(gi_path_options){.paths = 4, .seed = 1}, irradiance, 256, &count);
}

static gi_result try_context(loaded *l)
{
	(void)l;
	const gi_context_def def = faulty_def(false);
	gi_context *gi = NULL;
	const gi_result result = gi_context_create(&def, &gi);
	assert_true((result == GI_OK) == (gi != NULL));
	gi_context_destroy(gi);
	return result;
}

/* All after the first one too: each number at first, then ever larger steps. */
static uint32_t next_number(uint32_t number)
{
	return number < 64 ? number + 1 : number + number / 8;
}

static void expect_told(gi_result result, uint32_t failed, const char *what, uint32_t number)
{
	if (result && (result != GI_ERROR_OUT_OF_MEMORY || heard.count != 1))
		fail_msg("%s, allocation %u: %s, %u messages, the last one: %s", what, number, gi_result_text(result),
			 heard.count, heard.text);
	if (!result && heard.count)
		fail_msg("%s, allocation %u: all is well, and: %s", what, number, heard.text);
	if (result && !failed)
		fail_msg("%s: fails with all the memory there is: %s", what, heard.text);
}

/* What a call is tried on: a scene of its own for each way to run out of memory, since what one attempt made is there
 * for the next. */
typedef struct trial {
	const char *what;
	attempt *try;
	void (*prepare)(loaded *l); /* NULL: nothing more than the scene */
	bool coarse;                /* rows of an entry an object */
	bool fresh;                 /* without a first update */
	bool changes;               /* rows, or what a picture makes: they are not looked at between */
} trial;

/* Of calls that went well though an allocation failed: a buffer with room to spare became one without. */
static uint32_t made_do;

static void exhaust(const trial *t, fault_kind kind, bool all)
{
	loaded l = load(t->coarse);
	if (!t->fresh)
		harness_update(l.gi);
	look *before = t->changes ? NULL : look_at(&l);
	if (t->prepare)
		t->prepare(&l);
	uint32_t number = 0, tried = 0, failed;
	do {
		heard.count = 0;
		faults_begin(kind, number, all);
		const gi_result result = t->try(&l);
		failed = faults_end();
		expect_told(result, failed, t->what, number);
		assert_int_equal(glGetError(), GL_NO_ERROR);
		if (result && before)
			expect_as_before(&l, before, t->what);
		if (!result && failed && before) {
			made_do++;
			free_look(before);
			before = look_at(&l);
		}
		number = next_number(number);
		tried += failed > 0;
	} while (failed);
	printf("  %s: %u allocations of the %s failed, %s\n", t->what, tried, kind == FAULT_CPU ? "CPU" : "GPU",
	       all ? "with all after them" : "one at a time");
	if (before)
		free_look(before);
	/* All is as it would have been. */
	assert_gi(gi_commit(l.gi));
	const gi_report report = harness_update(l.gi);
	assert_true(report.sampling_squared == report.sampling_squared);
	look *kept = look_at(&l);
	gi_invalidate(l.gi);
	harness_update(l.gi);
	snapshot rebuilt = snapshot_take(l.gi);
	snapshot_expect_same_rows(&kept->rows, &rebuilt, t->what);
	snapshot_free(&rebuilt);
	free_look(kept);
	unload(&l);
}

static void in_every_way(const trial *t)
{
	for (int kind = 0; kind < FAULT_KINDS; kind++)
		for (int all = 0; all < 2; all++)
			if (harness_is_long() || all != kind % 2) /* one of two ways each */
				exhaust(t, (fault_kind)kind, all);
}

/* ---- tests ---- */

static void objects(void **state)
{
	(void)state;
	in_every_way(&(trial){"gi_create_object", .try = try_create});
	in_every_way(&(trial){"gi_create_object by a leaf size", .try = try_create_by_size});
	in_every_way(&(trial){"gi_create_object with a drawn mesh", .try = try_create_drawn});
	in_every_way(&(trial){"gi_create_object that deforms", .try = try_create_skin});
	in_every_way(&(trial){"gi_create_object that deforms, by a leaf size", .try = try_create_skin_by_size});
	in_every_way(&(trial){"gi_create_instance", .try = try_instance});
	in_every_way(
	    &(trial){"gi_create_instance of one that deforms", .try = try_instance_of_skin, .prepare = put_up_a_skin});
	in_every_way(&(trial){"gi_prepare_object", .try = try_prepare});
	in_every_way(&(trial){"gi_choose_leaves", .try = try_choose});
}

static void put_up_a_lamp(loaded *l)
{
	add_quad(l->gi, "another light", 1.5f, 30, 2);
}

static void take_away_the_ball(loaded *l)
{
	assert_gi(gi_destroy_object(l->gi, l->ball));
}

/* The picture knows the lamps of the scene that is there. */
static void commits(void **state)
{
	(void)state;
	made_do = 0;
	in_every_way(&(trial){"gi_commit of one lamp more", .try = try_commit, .prepare = put_up_a_lamp});
	assert_true(made_do > 0);
	in_every_way(&(trial){"gi_commit of one object less", .try = try_commit, .prepare = take_away_the_ball});
	in_every_way(&(trial){"gi_commit of the same", .try = try_commit});
}

/* Two layers that look at each other: a row has an entry for each of the other's, more than the pools begin with. */
static void put_up_many(loaded *l)
{
	enum { MANY = 320 };
	for (int k = 0; k < MANY; k++) {
		engine_mesh mesh;
		const float x = .1f * (float)(k % 16) - .8f, z = .1f * (float)(k / 16) - .8f, up[3] = {0, 0, .05f},
			    side[3] = {.05f, 0, 0};
		const bool above = k % 2;
		assert_true(
		    shape_quad((float[]){x, above ? 1.5f : 1, z}, above ? side : up, above ? up : side, 1, 1, &mesh));
		harness_add(l->gi, &(harness_object){.name = "scale", .rho = {.5f, .5f, .5f}}, &mesh);
	}
	assert_gi(gi_commit(l->gi));
}

static gi_result try_exact(loaded *l)
{
	return gi_update(l->gi, NULL);
}

static void updates(void **state)
{
	(void)state;
	in_every_way(&(trial){"a gi_update that outgrows its pools", .try = try_exact, .prepare = put_up_many,
			      .coarse = true, .changes = true});
	in_every_way(&(trial){"the first gi_update", .try = try_update, .fresh = true, .changes = true});
	in_every_way(&(trial){"gi_update under a budget", .try = try_budget, .changes = true});
}

/* ---- mirrors ---- */

static void put_up_a_mirror(loaded *l)
{
	const gi_material black = {.rho = {0}};
	const gi_specular mirror = {.reflectance = {1, 1, 1}};
	engine_mesh mesh;
	assert_true(shape_sphere(.3f, 2, &mesh));
	gi_object_def def = scene_mesh_def(&mesh);
	def.name = "mirror";
	def.materials = &black;
	def.specular = &mirror;
	def.material_count = 1;
	memcpy(def.pose.position, (const float[]){.7f, .5f, .3f}, sizeof def.pose.position);
	gi_object ball;
	assert_gi(gi_create_object(l->gi, &def, &ball));
	engine_mesh_free(&mesh);
	assert_gi(gi_commit(l->gi));
}

/* At the floor, whose leaves are the first nine. */
static double floor_light(gi_context *gi)
{
	enum { LEAVES = 9 };
	gi_leaf leaves[LEAVES];
	uint32_t count;
	assert_gi(gi_read_leaves(gi, leaves, LEAVES, &count));
	double sum = 0;
	for (int k = 0; k < LEAVES; k++)
		sum += leaves[k].irradiance[0];
	return sum;
}

/* Whatever the first update lacked, one after it makes up for. */
static double light_in_the_end(fault_kind kind, bool fails)
{
	loaded l = load(false);
	put_up_a_mirror(&l);
	for (uint32_t number = 0, failed = fails; failed; number++) {
		heard.count = 0;
		faults_begin(kind, number, false);
		const gi_result result = gi_update(l.gi, NULL);
		failed = faults_end();
		expect_told(result, failed, "the first gi_update with a mirror", number);
		if (!result && !failed)
			printf("  the first gi_update with a mirror: %u allocations\n", number);
	}
	harness_update(l.gi);
	const double light = floor_light(l.gi);
	unload(&l);
	return light;
}

static void mirrors(void **state)
{
	(void)state;
	const double wanted = light_in_the_end(FAULT_CPU, false);
	for (int kind = 0; kind < FAULT_KINDS; kind++) {
		const double light = light_in_the_end((fault_kind)kind, true);
		printf("  %.9g W/m2 of %.9g\n", light, wanted);
		assert_true(fabs(light - wanted) < 1e-5 * wanted);
	}
}

static void light_a_mirror(loaded *l)
{
	put_up_a_mirror(l);
	harness_update(l->gi);
}

static void pictures(void **state)
{
	(void)state;
	in_every_way(&(trial){"gi_draw", .try = try_draw, .changes = true});
	in_every_way(&(trial){"gi_draw of a mirror", .try = try_draw, .prepare = light_a_mirror, .changes = true});
	in_every_way(&(trial){"gi_draw with a wireframe", .try = try_overlay});
	in_every_way(&(trial){"gi_draw of a heat map", .try = try_heat_map, .changes = true});
}

static void reading(void **state)
{
	(void)state;
	in_every_way(&(trial){"reading back", .try = try_read});
	in_every_way(&(trial){"gi_trace_paths", .try = try_paths});
}

static void contexts(void **state)
{
	(void)state;
	in_every_way(&(trial){"gi_context_create", .try = try_context});
}

/* A mover goes back and forth: what it takes is there after the first time. */
static void check_steady_frames(bool mirror, bool deforms)
{
	loaded l = load(false);
	if (mirror)
		put_up_a_mirror(&l);
	if (deforms) {
		put_up_a_skin(&l);
		assert_gi(gi_commit(l.gi));
	}
	const faults_memory scene = faults_memory_now();
	assert_true(scene.blocks > 0 && scene.bytes > 0);
	faults_memory warm = scene;
	for (int frame = 0; frame < 20; frame++) {
		if (frame == 4)
			warm = faults_memory_now();
		const gi_pose pose = {{frame % 2 ? .125f : 0, .5f, 0}, {0, 0, 0, 1}};
		assert_gi(gi_set_pose(l.gi, l.ball, pose));
		if (deforms)
			assert_gi(gi_set_scale(l.gi, skin, (float[]){1, frame % 2 ? 1.1f : 1, 1}));
		assert_gi(gi_update(l.gi, frame % 4 < 2 ? NULL : &(gi_budget){.rays = 100}));
		assert_gi(draw(&l, GI_OVERLAY_NONE));
		gi_report report;
		assert_gi(gi_get_report(l.gi, &report));
	}
	const faults_memory now = faults_memory_now();
	printf("  a scene: %" PRId64 " blocks, %" PRId64 " bytes; its first 4 frames: %" PRIu64
	       " allocations; 16 more: %" PRIu64 "\n",
	       scene.blocks, scene.bytes, warm.allocations - scene.allocations, now.allocations - warm.allocations);
	assert_int_equal(now.allocations, warm.allocations);
	unload(&l);
}

static void a_steady_frame_allocates_nothing(void **state)
{
	(void)state;
	check_steady_frames(false, false);
	check_steady_frames(true, false);
	check_steady_frames(false, true);
}

static void an_allocator_is_whole(void **state)
{
	(void)state;
	gi_context_def def = harness_def();
	def.allocator = faults_allocator();
	def.allocator.reallocate = NULL;
	gi_context *gi;
	assert_int_equal(gi_context_create(&def, &gi), GI_ERROR_INVALID_ARGUMENT);
	gi_object_def square = square_def();
	gi_prepared_object *made;
	assert_int_equal(gi_prepare_object(&square, def.message, NULL, &def.allocator, &made),
			 GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(faults_memory_now().blocks, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(objects),
	    cmocka_unit_test(commits),
	    cmocka_unit_test(updates),
	    cmocka_unit_test(mirrors),
	    cmocka_unit_test(pictures),
	    cmocka_unit_test(reading),
	    cmocka_unit_test(contexts),
	    cmocka_unit_test(a_steady_frame_allocates_nothing),
	    cmocka_unit_test(an_allocator_is_whole),
	};
	return cmocka_run_group_tests_name("memory", tests, harness_open, harness_close);
}
