/* Many objects that stay where they are, under common nodes: as near to path tracing as objects alone, with fewer
 * entries; one of them that comes, goes, is lit or moved after all costs rows an entry or two; what is not said to move
 * is one of them until it does; files are played so.
 */
#define _POSIX_C_SOURCE 200809L /* mkdtemp */
#include "snapshot.h"

#include "furnished_file.h"

#include "demos/file_scene.h"
#include "scenes/body.h"
#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint32_t random_state;

static uint32_t random_below(uint32_t most)
{
	random_state = random_state * 1664525u + 1013904223u; /* Numerical Recipes */
	return (random_state >> 8) % most;
}

/* ---- a hall ---- */

enum { ROWS_OF_BOXES = 9, BOXES = ROWS_OF_BOXES * ROWS_OF_BOXES, MOST_ROWS = 17 };

static gi_object add_static(gi_context *gi, const char *name, engine_mesh *mesh, gi_mobility mobility, gi_pose pose,
			    gi_material material)
{
	gi_object_def def = scene_mesh_def(mesh);
	gi_object object;
	def.name = name;
	def.materials = &material;
	def.material_count = 1;
	def.pose = pose;
	def.mobility = mobility;
	assert_gi(gi_create_object(gi, &def, &object));
	engine_mesh_free(mesh);
	return object;
}

/* A hall with boxes of many heights and turns and a lamp at one end. */
static gi_object hall_object, hall_boxes[MOST_ROWS * MOST_ROWS];

static gi_context *open_hall_of(int rows, gi_mobility mobility, float row_tolerance)
{
	gi_context_def def = harness_def();
	def.row_tolerance = row_tolerance;
	def.solve_tolerance = 1e-3f;
	gi_context *gi = harness_context(&def);
	const float side = 1.2f * (float)rows;
	engine_mesh mesh;
	assert_true(shape_box((float[]){0, 0, 0}, (float[]){side, 4, side}, 6, true, &mesh));
	hall_object =
	    add_static(gi, "hall", &mesh, mobility, gi_pose_identity(), (gi_material){.rho = {.7f, .7f, .7f}});
	assert_true(shape_quad((float[]){1, 3.9f, 1}, (float[]){3, 0, 0}, (float[]){0, 0, 3}, 3, 3, &mesh));
	add_static(gi, "lamp", &mesh, mobility, gi_pose_identity(), (gi_material){.exitance = {20, 20, 20}});
	random_state = 77;
	for (int k = 0; k < rows * rows; k++) {
		const float high = .2f + .2f * (float)random_below(7), turn = .1f * (float)random_below(16),
			    rho = .2f + .1f * (float)random_below(7);
		assert_true(shape_box((float[]){-.25f, 0, -.25f}, (float[]){.25f, high, .25f}, 1, false, &mesh));
		const gi_pose pose = {{1.2f * ((float)(k % rows) + .5f), .005f, 1.2f * ((float)(k / rows) + .5f)},
				      {0, sinf(turn), 0, cosf(turn)}};
		hall_boxes[k] = add_static(gi, "box", &mesh, mobility, pose, (gi_material){.rho = {rho, rho, .5f}});
	}
	assert_gi(gi_commit(gi));
	return gi;
}

static gi_context *open_hall(gi_mobility mobility, float row_tolerance)
{
	return open_hall_of(ROWS_OF_BOXES, mobility, row_tolerance);
}

/* Common nodes cost accuracy no more than other nodes do: per entry rows are better with them. */
static void the_light_of_static_things(void **state)
{
	(void)state;
	static const struct {
		gi_mobility mobility;
		float tolerance;
	} runs[] = {{GI_MOBILITY_MOVABLE, .1f},
		    {GI_MOBILITY_STATIC, .1f},
		    {GI_MOBILITY_STATIC, .02f},
		    {GI_MOBILITY_STATIC, .005f}};
	double errors[4], entries[4];
	for (int k = 0; k < 4; k++) {
		gi_context *gi = open_hall(runs[k].mobility, runs[k].tolerance);
		const gi_report r = harness_update(gi);
		snapshot s = snapshot_take(gi);
		errors[k] = snapshot_light_error(gi, &s, 64);
		entries[k] = (double)r.entries / r.leaves;
		printf("  %s, row tolerance %-5g: %.1f entries a leaf, H off by %.2f %%\n",
		       runs[k].mobility == GI_MOBILITY_STATIC ? "static " : "movable", (double)runs[k].tolerance,
		       entries[k], 100 * errors[k]);
		snapshot_free(&s);
		gi_context_destroy(gi);
	}
	assert_true(entries[1] < .6 * entries[0]);
	/* Finer rows are nearer, and come to where those of objects alone are with no more entries. */
	assert_true(errors[2] < errors[1] && errors[3] < errors[2]);
	assert_true(errors[1] < 1.1 * errors[0]);
}

/* One of many static things comes, is lit, put out, hidden, shown and goes: rows keep what they have of nodes without
 * it, and are those of a rebuild. */
static void one_of_many_static_things(void **state)
{
	(void)state;
	static const char *const names[] = {"comes",    "is lit", "is put out", "is hidden",
					    "is shown", "goes",   "comes again"};
	const gi_material dull = {.rho = {.5f, .5f, .5f}}, lit = {.rho = {.5f, .5f, .5f}, .exitance = {3, 2, 1}};
	const gi_pose pose = {{6.1f, .005f, 4.9f}, {0, .6f, 0, .8f}};
	gi_context *gi = open_hall(GI_MOBILITY_STATIC, .1f);
	const gi_report full = harness_update(gi);
	gi_object box = {0};
	engine_mesh mesh;
	for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
		if (k == 0 || k == 6) {
			assert_true(shape_box((float[]){-.25f, 0, -.25f}, (float[]){.25f, .9f, .25f}, 1, false, &mesh));
			box = add_static(gi, "one more", &mesh, GI_MOBILITY_STATIC, pose, dull);
		}
		if (k == 1 || k == 2)
			assert_gi(gi_set_material(gi, box, 0, k == 1 ? lit : dull));
		if (k == 3 || k == 4)
			assert_gi(gi_set_hidden(gi, box, k == 3));
		if (k == 5)
			assert_gi(gi_destroy_object(gi, box));
		assert_gi(gi_commit(gi));
		const gi_report r = harness_update(gi);
		const double fresh = (double)r.new_entries / r.leaves;
		printf("  one %s: of %.1f entries a leaf %.2f are cut anew\n", names[k], (double)r.entries / r.leaves,
		       fresh);
		assert_true(r.new_entries > 0);
		/* A lamp is cut finer, and so is what it is one with. */
		assert_true(fresh < (k == 1 ? .2 : .1) * (double)full.entries / full.leaves);
		snapshot_expect_rebuilt_rows(gi, names[k]);
	}
	gi_context_destroy(gi);
}

static gi_object add_box(gi_context *gi, const char *name, gi_mobility mobility, const float at[3])
{
	engine_mesh mesh;
	assert_true(shape_box((float[]){-.25f, 0, -.25f}, (float[]){.25f, .9f, .25f}, 1, false, &mesh));
	return add_static(gi, name, &mesh, mobility, (gi_pose){{at[0], at[1], at[2]}, {0, 0, 0, 1}},
			  (gi_material){.rho = {.5f, .5f, .5f}});
}

/* Three boxes in a row in a hall, of which the middle one is at x. */
static gi_context *open_three(float x, gi_object *middle)
{
	gi_context_def def = harness_def();
	def.row_tolerance = .02f;
	gi_context *gi = harness_context(&def);
	engine_mesh mesh;
	assert_true(shape_box((float[]){0, 0, 0}, (float[]){12, 4, 8}, 5, true, &mesh));
	add_static(gi, "hall", &mesh, GI_MOBILITY_MOVABLE, gi_pose_identity(), (gi_material){.rho = {.7f, .7f, .7f}});
	assert_true(shape_quad((float[]){1, 3.9f, 1}, (float[]){3, 0, 0}, (float[]){0, 0, 3}, 3, 3, &mesh));
	add_static(gi, "lamp", &mesh, GI_MOBILITY_MOVABLE, gi_pose_identity(), (gi_material){.exitance = {20, 20, 20}});
	add_box(gi, "first", GI_MOBILITY_STATIC, (float[]){4.3f, .1f, 4.3f});
	*middle = add_box(gi, "middle", GI_MOBILITY_STATIC, (float[]){x, .1f, 4.3f});
	add_box(gi, "last", GI_MOBILITY_STATIC, (float[]){7.3f, .1f, 4.3f});
	assert_gi(gi_commit(gi));
	harness_update(gi);
	return gi;
}

/* One takes a step, stays static and is below the nodes that it was below: these are what they are where it was
 * there from the first. */
static void the_same_nodes_of_one_that_stepped(void **state)
{
	(void)state;
	gi_object middle, other;
	gi_context *gi = open_three(5.3f, &middle), *from_the_first = open_three(5.5f, &other);
	gi_pose pose;
	assert_gi(gi_get_pose(gi, middle, &pose));
	pose.position[0] = 5.5f;
	assert_gi(gi_set_pose(gi, middle, pose));
	assert_gi(gi_set_mobility(gi, middle, GI_MOBILITY_STATIC));
	harness_update(gi);
	snapshot stepped = snapshot_take(gi), there = snapshot_take(from_the_first);
	snapshot_expect_same_rows(&stepped, &there, "one took a step and stays static");
	snapshot_free(&stepped);
	snapshot_free(&there);
	gi_context_destroy(gi);
	gi_context_destroy(from_the_first);
}

/* Three boxes of which the middle one goes from next to the first to next to the last, and stays static: they are in
 * the same order below other nodes. And one that was to be movable from the next commit on is hidden before that. */
static void other_nodes_in_the_same_order(void **state)
{
	(void)state;
	gi_object middle;
	gi_context *gi = open_three(5.3f, &middle);
	gi_pose pose;
	assert_gi(gi_get_pose(gi, middle, &pose));
	pose.position[0] = 6.3f;
	assert_gi(gi_set_pose(gi, middle, pose));
	assert_gi(gi_set_mobility(gi, middle, GI_MOBILITY_STATIC));
	const gi_report r = harness_update(gi);
	printf("  of %llu entries %llu are cut anew\n", (unsigned long long)r.entries,
	       (unsigned long long)r.new_entries);
	snapshot_expect_rebuilt_rows(gi, "the middle one moved and stays static");

	assert_gi(gi_set_mobility(gi, middle, GI_MOBILITY_MOVABLE));
	assert_gi(gi_set_hidden(gi, middle, true));
	harness_update(gi);
	snapshot hidden = snapshot_take(gi);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	snapshot committed = snapshot_take(gi);
	snapshot_expect_same_rows(&hidden, &committed, "one that was to be movable is hidden");
	snapshot_free(&hidden);
	snapshot_free(&committed);
	gi_context_destroy(gi);
}

/* What moves has hundreds of neighbours: each row of it is asked for all of them, which is more turns than llvmpipe
 * gives a thread's loops. */
static void the_hall_moves(void **state)
{
	(void)state;
	gi_context *gi = open_hall_of(MOST_ROWS, GI_MOBILITY_MOVABLE, .1f);
	harness_update(gi);
	assert_gi(gi_set_pose(gi, hall_object, (gi_pose){{.01f, 0, .02f}, {0, 0, 0, 1}}));
	const gi_report r = harness_update(gi);
	printf("  %.1f entries a leaf, %.1f flagged\n", (double)r.entries / r.leaves,
	       (double)r.flagged_entries / r.leaves);
	snapshot_expect_rebuilt_rows(gi, "the hall moved");
	gi_context_destroy(gi);
}

/* What is not said to move is static where there are many, leaves them when it first moves, and is movable from then
 * on. */
static void automatic_until_it_moves(void **state)
{
	(void)state;
	gi_context *still = open_hall(GI_MOBILITY_STATIC, .1f);
	const gi_report wanted = harness_update(still);
	gi_context_destroy(still);
	gi_context *gi = open_hall(GI_MOBILITY_AUTOMATIC, .1f);
	const gi_report full = harness_update(gi);
	assert_int_equal(full.entries, wanted.entries);
	gi_mobility mobility;
	for (int k = 0; k < 4; k++) {
		const gi_object box = hall_boxes[(37 * k + 11) % BOXES];
		gi_pose pose;
		assert_gi(gi_get_mobility(gi, box, &mobility));
		assert_int_equal(mobility, GI_MOBILITY_AUTOMATIC);
		assert_gi(gi_get_pose(gi, box, &pose));
		uint64_t fresh[2];
		for (int move = 0; move < 2; move++) {
			pose.position[0] += .03f;
			assert_gi(gi_set_pose(gi, box, pose));
			/* Every other one under a budget, which holds, and then to the end. */
			const gi_budget budget = {.rays = 2000};
			gi_report part = {0};
			if (k % 2 && move == 0) {
				assert_gi(gi_update(gi, &budget));
				assert_gi(gi_finish(gi));
				assert_gi(gi_get_report(gi, &part));
				assert_true(part.rays < 2 * budget.rays);
				assert_true(part.waiting_rows > 0);
			}
			fresh[move] = part.new_entries + harness_update(gi).new_entries;
		}
		assert_gi(gi_get_mobility(gi, box, &mobility));
		assert_int_equal(mobility, GI_MOBILITY_MOVABLE);
		printf("  of %.1f entries a leaf the first move makes %.2f anew, the second %.2f\n",
		       (double)full.entries / full.leaves, (double)fresh[0] / full.leaves,
		       (double)fresh[1] / full.leaves);
		assert_true(fresh[0] < .15 * (double)full.entries);
		snapshot_expect_rebuilt_rows(gi, "a box moved for the first time");
	}
	/* Too few are left: all are movable. And some that are put down for good. */
	for (int k = 0; k < 20; k++)
		assert_gi(gi_set_mobility(gi, hall_boxes[k], GI_MOBILITY_MOVABLE));
	assert_gi(gi_commit(gi));
	const gi_report few = harness_update(gi);
	snapshot_expect_rebuilt_rows(gi, "few are left");
	for (int k = 0; k < BOXES; k++)
		assert_gi(gi_set_mobility(gi, hall_boxes[k], GI_MOBILITY_STATIC));
	assert_gi(gi_commit(gi));
	const gi_report again = harness_update(gi);
	snapshot_expect_rebuilt_rows(gi, "all are put down");
	printf("  %.1f entries a leaf with fewer than %d, %.1f when all are put down\n",
	       (double)few.entries / few.leaves, GI_AUTOMATIC_OBJECTS, (double)again.entries / again.leaves);
	assert_true((double)few.entries > 1.5 * (double)full.entries);
	assert_true((double)again.entries < 1.05 * (double)full.entries);
	gi_context_destroy(gi);
}

/* Form factors to single things below common nodes are drawn: their sum is what it is, each is off by chance. */
static void form_factors_of_static_things(void **state)
{
	(void)state;
	static double factors[2][BOXES + 1];
	double squared = 0, largest = 0, sums[2] = {0};
	int small = 0; /* the least that is still something */
	for (int k = 0; k < 2; k++) {
		gi_context *gi = open_hall(k ? GI_MOBILITY_STATIC : GI_MOBILITY_MOVABLE, .02f);
		harness_update(gi);
		static gi_object to[BOXES + 1];
		memcpy(to, hall_boxes, BOXES * sizeof *hall_boxes);
		assert_gi(gi_form_factors(gi, hall_boxes[BOXES / 2], to, BOXES + 1, factors[k]));
		for (int b = 0; b < BOXES; b++)
			sums[k] += factors[k][b];
		if (k) { /* as said: exact again where the other one is movable */
			double alone;
			for (int b = 0; b < BOXES; b++)
				if (factors[0][b] > 5e-4 &&
				    (factors[0][small] <= 5e-4 || factors[0][b] < factors[0][small]))
					small = b;
			assert_gi(gi_set_mobility(gi, hall_boxes[small], GI_MOBILITY_MOVABLE));
			assert_gi(gi_commit(gi));
			harness_update(gi);
			assert_gi(gi_form_factor(gi, hall_boxes[BOXES / 2], hall_boxes[small], &alone));
			printf("  to box %d: %.5f movable, %.5f static, %.5f movable among static ones\n", small,
			       factors[0][small], factors[1][small], alone);
			assert_true(alone > 0 && fabs(alone - factors[0][small]) < .05 * factors[0][small]);
		}
		gi_context_destroy(gi);
	}
	for (int b = 0; b < BOXES; b++) {
		squared += pow(factors[1][b] - factors[0][b], 2) / BOXES;
		largest = fmax(largest, fabs(factors[1][b] - factors[0][b]));
	}
	printf("  from one box to %d others: %.4f and %.4f in all, to anything %.4f and %.4f; single ones off by %.5f "
	       "RMS, "
	       "%.5f at most\n",
	       BOXES, sums[0], sums[1], factors[0][BOXES], factors[1][BOXES], sqrt(squared), largest);
	assert_true(fabs(sums[1] - sums[0]) < .05 * sums[0]);
	assert_true(largest < .02);
}

/* ---- a file ---- */

/* Hundreds of things without an animation, one with: what moves is movable, the rest is static, and so it is light. */
static void a_file_of_many_things(void **state)
{
	(void)state;
	harness_require_context();
	char folder[] = "/tmp/relume-furnished-XXXXXX", path[256], message[1024] = "";
	assert_non_null(mkdtemp(folder));
	assert_true(furnished_file_write(folder, path, sizeof path));
	file_scene scene = {.program = "test_static", .leaves = 1000};
	if (!file_scene_load(&scene, path, message, sizeof message))
		fail_msg("%s", message);
	gi_context_def def = harness_def();
	def.row_tolerance = .05f;
	gi_context *gi = harness_context(&def);
	if (!file_scene_create(&scene, gi, message, sizeof message))
		fail_msg("%s: %s", message, harness_last_message());
	assert_gi(gi_commit(gi));
	const gi_report full = harness_update(gi);
	uint32_t movable = 0;
	for (uint32_t k = 0; k < scene.scene.object_count; k++) {
		gi_mobility mobility;
		assert_gi(gi_get_mobility(gi, scene.handles[k], &mobility));
		movable += mobility == GI_MOBILITY_MOVABLE;
		assert_int_equal(mobility == GI_MOBILITY_MOVABLE, scene.scene.objects[k].animated);
	}
	assert_int_equal(movable, 1);
	assert_true(scene.scene.object_count > FURNISHED_THINGS);
	double fresh = 0;
	for (int frame = 1; frame <= 8; frame++) {
		assert_gi(file_scene_animate(&scene, gi, .2 * frame));
		fresh = fmax(fresh, (double)harness_update(gi).new_entries / full.leaves);
	}
	snapshot_expect_rebuilt_rows(gi, "frame 8");
	snapshot s = snapshot_take(gi);
	const double error = snapshot_light_error(gi, &s, 64);
	snapshot_free(&s);
	for (uint32_t k = 0; k < scene.scene.object_count; k++)
		assert_gi(gi_set_mobility(gi, scene.handles[k], GI_MOBILITY_MOVABLE));
	assert_gi(gi_commit(gi));
	const gi_report alone = harness_update(gi);
	s = snapshot_take(gi);
	const double error_alone = snapshot_light_error(gi, &s, 64);
	printf("  %u objects, %u leaves: %.1f entries a leaf, all movable %.1f; H off by %.2f and %.2f %%; a frame "
	       "makes %.2f "
	       "entries a leaf anew\n",
	       full.objects, full.leaves, (double)full.entries / full.leaves, (double)alone.entries / alone.leaves,
	       100 * error, 100 * error_alone, fresh);
	assert_true((double)full.entries < .6 * (double)alone.entries);
	assert_true(error < 1.15 * error_alone);
	assert_true(fresh < 6);
	snapshot_free(&s);
	gi_context_destroy(gi);
	file_scene_free(&scene);
	furnished_file_remove(folder);
}

/* Objects that were refined. */
static void count_built(const char *what, uint32_t done, uint32_t total, void *user)
{
	(void)done;
	(void)total;
	*(uint32_t *)user += strncmp(what, "building object", 15) == 0;
}

/* Nodes of one mesh and one scale, which nothing cuts apart, are refined once. */
static void a_shape_of_a_file_is_refined_once(void **state)
{
	(void)state;
	harness_require_context();
	char folder[] = "/tmp/relume-furnished-XXXXXX", path[256], message[1024] = "";
	assert_non_null(mkdtemp(folder));
	assert_true(furnished_file_write(folder, path, sizeof path));
	/* All of them simplified: a leaf a face, and no cuts where they come near the floor. */
	file_scene scene = {.program = "test_static", .cage_faces = 11};
	if (!file_scene_load(&scene, path, message, sizeof message))
		fail_msg("%s", message);
	gi_context_def def = harness_def();
	uint32_t built = 0;
	def.progress = count_built;
	def.user = &built;
	gi_context *gi = harness_context(&def);
	if (!file_scene_create(&scene, gi, message, sizeof message))
		fail_msg("%s: %s", message, harness_last_message());
	printf("  %u objects, %u of them refined\n", scene.scene.object_count, built);
	/* The hall, the lamp, what rolls, things of 5 widths and 11 heights. */
	assert_int_equal(built, 3 + 5 * 11);
	for (uint32_t k = 0; k < scene.scene.object_count; k++) {
		gi_pose pose;
		gi_mobility mobility;
		assert_gi(gi_get_pose(gi, scene.handles[k], &pose));
		assert_gi(gi_get_mobility(gi, scene.handles[k], &mobility));
		assert_memory_equal(pose.position, scene.scene.objects[k].rest.translation, sizeof pose.position);
		assert_int_equal(mobility == GI_MOBILITY_MOVABLE, scene.scene.objects[k].animated);
	}
	gi_context_destroy(gi);
	file_scene_free(&scene);
	furnished_file_remove(folder);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(the_same_nodes_of_one_that_stepped),
	    cmocka_unit_test(other_nodes_in_the_same_order),
	    cmocka_unit_test(the_hall_moves),
	    cmocka_unit_test(the_light_of_static_things),
	    cmocka_unit_test(one_of_many_static_things),
	    cmocka_unit_test(automatic_until_it_moves),
	    cmocka_unit_test(form_factors_of_static_things),
	    cmocka_unit_test(a_file_of_many_things),
	    cmocka_unit_test(a_shape_of_a_file_is_refined_once),
	};
	return cmocka_run_group_tests_name("static objects", tests, harness_open, harness_close);
}
