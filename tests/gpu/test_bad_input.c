/* Misuse on purpose: the right gi_result, exactly one line, and what was loaded stays as it was.
 *
 * Each test loads a small lit scene, does its worst to it, and then looks whether the scene still updates to the same
 * rows and the same B.
 */
#include "snapshot.h"

#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- messages ---- */

static struct {
	uint32_t count;
	gi_result result;
	char text[1024];
} heard;

static void hear(gi_result result, const char *message, void *user)
{
	assert_ptr_equal(user, &heard);
	heard.count++;
	heard.result = result;
	snprintf(heard.text, sizeof heard.text, "%s", message);
}

static void expect_heard(gi_result got, gi_result wanted, const char *what)
{
	if (got != wanted)
		fail_msg("%s: %s, and not %s (%s)", what, gi_result_text(got), gi_result_text(wanted), heard.text);
	if (heard.count != 1)
		fail_msg("%s: %u messages, the last one: %s", what, heard.count, heard.text);
	if (heard.result != wanted)
		fail_msg("%s: the message came with %s", what, gi_result_text(heard.result));
	if (!heard.text[0] || strchr(heard.text, '\n'))
		fail_msg("%s: no line: '%s'", what, heard.text);
	heard.count = 0;
}

/* The call fails with the result and one line. */
#define expect_error(call, wanted)                                                                                     \
	do {                                                                                                           \
		heard.count = 0;                                                                                       \
		expect_heard((call), (wanted), #call);                                                                 \
	} while (0)

/* ---- the scene that has to survive ---- */

typedef struct loaded {
	gi_context *gi;
	gi_object floor, ball, light;
	snapshot before;
} loaded;

static gi_context_def loud_def(void)
{
	gi_context_def def = harness_def();
	def.message = hear;
	def.user = &heard;
	def.row_tolerance = 0.05f;
	def.solve_tolerance = 1e-4f;
	return def;
}

static gi_object add_floor(gi_context *gi)
{
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-1, 0, -1}, (float[]){0, 0, 2}, (float[]){2, 0, 0}, 4, 4, &mesh));
	return harness_add(gi, &(harness_object){.name = "floor", .rho = {.5f, .6f, .7f}}, &mesh);
}

static gi_object add_ball(gi_context *gi)
{
	engine_mesh mesh;
	assert_true(shape_sphere(.3f, 2, &mesh));
	return harness_add(gi, &(harness_object){.name = "ball", .rho = {.5f, .5f, .5f}, .position = {0, .5f, 0}},
			   &mesh);
}

static gi_object add_light(gi_context *gi)
{
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-.5f, 2, -.5f}, (float[]){1, 0, 0}, (float[]){0, 0, 1}, 1, 1, &mesh));
	return harness_add(gi, &(harness_object){.name = "light", .exitance = {10, 10, 10}}, &mesh);
}

static loaded load(void)
{
	gi_context_def def = loud_def();
	def.max_buffer_mib = 128;
	loaded l = {.gi = harness_context(&def)};
	l.floor = add_floor(l.gi);
	l.ball = add_ball(l.gi);
	l.light = add_light(l.gi);
	assert_gi(gi_commit(l.gi));
	harness_update(l.gi);
	l.before = snapshot_take(l.gi);
	assert_true(snapshot_largest(&l.before) == 10);
	return l;
}

/* Nothing has changed, neither at rest nor when all is built again. */
static void expect_unharmed(loaded *l, const char *what)
{
	for (int rebuild = 0; rebuild < 2; rebuild++) {
		heard.count = 0;
		if (rebuild)
			gi_invalidate(l->gi);
		const gi_report report = harness_update(l->gi);
		if (report.outcome != (rebuild ? GI_OUTCOME_CONVERGED : GI_OUTCOME_AT_REST))
			fail_msg("after %s: outcome %d", what, report.outcome);
		snapshot now = snapshot_take(l->gi);
		snapshot_expect_same_rows(&l->before, &now, what);
		/* A rebuild solves on from where it was: both are within the solve's 1e-6 of the largest B, 10 W/m2. */
		assert_true(snapshot_distance(&l->before, &now) <= 2e-6 * 10);
		snapshot_free(&now);
		assert_int_equal(heard.count, 0);
	}
}

static void unload(loaded *l)
{
	snapshot_free(&l->before);
	gi_context_destroy(l->gi);
}

/* ---- context definitions ---- */

static void expect_bad_context(const gi_context_def *def, gi_result wanted, const char *what)
{
	gi_context *gi = (gi_context *)&heard;
	heard.count = 0;
	expect_heard(gi_context_create(def, &gi), wanted, what);
	assert_null(gi);
}

#define expect_bad_def(field, value)                                                                                   \
	do {                                                                                                           \
		gi_context_def bad = loud_def();                                                                       \
		bad.field = (value);                                                                                   \
		expect_bad_context(&bad, GI_ERROR_INVALID_ARGUMENT, #field " = " #value);                              \
	} while (0)

static void context_definitions(void **state)
{
	(void)state;
	loaded l = load();
	expect_bad_def(get_proc_address, NULL);
	expect_bad_def(row_tolerance, 0);
	expect_bad_def(row_tolerance, 1e-6f);
	expect_bad_def(row_tolerance, 1.5f);
	expect_bad_def(row_tolerance, -1);
	expect_bad_def(row_tolerance, NAN);
	expect_bad_def(emitter_refinement, .5f);
	expect_bad_def(emitter_refinement, NAN);
	expect_bad_def(emitter_refinement, INFINITY);
	expect_bad_def(emitter_samples, 3);
	expect_bad_def(emitter_samples, 17);
	expect_bad_def(near_samples, 0);
	expect_bad_def(near_samples, 17);
	expect_bad_def(solve_tolerance, 0);
	expect_bad_def(solve_tolerance, 1.5f);
	expect_bad_def(solve_tolerance, NAN);
	expect_bad_def(max_sweeps, 0);
	expect_bad_def(max_sweeps, 1001);
	expect_bad_def(estimate_leaves, 65537);
	expect_bad_def(sky, (gi_sky)7);
	expect_bad_def(sky_exitance[0], -1);
	expect_bad_def(sky_exitance[1], NAN);
	expect_bad_def(sky_exitance[2], INFINITY);
	const gi_context_def good = loud_def();
	expect_error(gi_context_create(&good, NULL), GI_ERROR_INVALID_ARGUMENT);

	/* These two have no callback of their own: their line goes to stderr. */
	gi_context *gi = (gi_context *)&heard;
	assert_int_equal(gi_context_create(NULL, &gi), GI_ERROR_INVALID_ARGUMENT);
	assert_null(gi);
	const gi_context_def nobody_made_it = {.row_tolerance = .01f};
	assert_int_equal(gi_context_create(&nobody_made_it, &gi), GI_ERROR_INVALID_DEF);
	gi_context_destroy(NULL);
	expect_unharmed(&l, "bad context definitions");
	unload(&l);
}

/* ---- environment ---- */

static gi_proc find_nothing(const char *name, void *user)
{
	(void)name;
	(void)user;
	return NULL;
}

static const unsigned char *old_version(unsigned name)
{
	(void)name;
	return (const unsigned char *)"3.3 (Core Profile) of long ago";
}

static gi_get_proc_address_fn *real_get_proc_address;

static gi_proc find_old_opengl(const char *name, void *user)
{
	if (strcmp(name, "glGetString") == 0)
		return (gi_proc)old_version;
	return real_get_proc_address(name, user);
}

static void environment(void **state)
{
	(void)state;
	loaded l = load();
	gi_context_def def = loud_def();
	real_get_proc_address = def.get_proc_address;
	def.get_proc_address = find_nothing;
	expect_bad_context(&def, GI_ERROR_NO_OPENGL_45, "no OpenGL at all");
	expect_unharmed(&l, "a context without OpenGL");
	def.get_proc_address = find_old_opengl;
	expect_bad_context(&def, GI_ERROR_NO_OPENGL_45, "OpenGL 3.3");
	assert_non_null(strstr(heard.text, "3.3"));
	expect_unharmed(&l, "a context with OpenGL 3.3");
	def = loud_def();
	def.shader_directory = "/nowhere/at/all";
	expect_bad_context(&def, GI_ERROR_SHADER, "no shaders");
	expect_unharmed(&l, "a context without shaders");
	unload(&l);
}

/* ---- object definitions ---- */

static const float square[12] = {0, 0, 0, 0, 0, 1, 1, 0, 1, 1, 0, 0};
static const uint32_t corners[4] = {0, 1, 2, 3};
static const float with_nan[12] = {0, 0, 0, 0, NAN, 1, 1, 0, 1, 1, 0, 0},
		   with_infinity[12] = {0, 0, INFINITY, 0, 0, 1, 1, 0, 1, 1, 0, 0};
static const float one_point[12] = {1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3},
		   one_line[12] = {0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0};
static const float very_large[12] = {0, 0, 0, 0, 0, 3e38f, 3e38f, 0, 3e38f, 3e38f, 0, 0};
static const uint32_t beyond[4] = {0, 1, 2, 4}, huge_index[4] = {0, 1, 2, 0xFFFFFFFFu};
static const uint32_t two_corners[1] = {2}, five_corners[1] = {5}, endless_corners[1] = {0xFFFFFFFFu};
static const uint32_t material_1[1] = {1}, edge_beyond[2] = {0, 9}, edge[2] = {0, 1};
static const float sharp[1] = {2}, blunt[1] = {-1}, sharp_nan[1] = {NAN};
static const gi_material good_material = {.rho = {.5f, .5f, .5f}};

static gi_object_def square_def(void)
{
	gi_object_def def = gi_object_def_default();
	def.name = "square";
	def.positions = square;
	def.vertex_count = 4;
	def.indices = corners;
	def.face_count = 1;
	def.index_count = 4;
	def.materials = &good_material;
	def.material_count = 1;
	return def;
}

static void expect_bad_object(gi_context *gi, const gi_object_def *def, gi_result wanted, const char *what)
{
	gi_object object = {7, 7, 7};
	heard.count = 0;
	expect_heard(gi_create_object(gi, def, &object), wanted, what);
	assert_int_equal(object.index1, 0);
	assert_int_equal(object.generation, 0);
	assert_int_equal(object.context, 0);
	/* The line says which object it is about. */
	if (wanted != GI_ERROR_INVALID_DEF && def && def->name)
		assert_non_null(strstr(heard.text, def->name));
}

#define expect_bad_field(gi, field, value, wanted)                                                                     \
	do {                                                                                                           \
		gi_object_def bad = square_def();                                                                      \
		bad.field = (value);                                                                                   \
		expect_bad_object(gi, &bad, wanted, #field " = " #value);                                              \
	} while (0)

static void bad_values(gi_context *gi)
{
	expect_bad_field(gi, scheme, (gi_scheme)9, GI_ERROR_INVALID_ARGUMENT);
	expect_bad_field(gi, scheme, (gi_scheme)-1, GI_ERROR_INVALID_ARGUMENT);
	expect_bad_field(gi, boundary, (gi_boundary)9, GI_ERROR_INVALID_ARGUMENT);
	expect_bad_field(gi, levels, 9, GI_ERROR_INVALID_ARGUMENT);
	expect_bad_field(gi, draw_levels, 5, GI_ERROR_INVALID_ARGUMENT);
	expect_bad_field(gi, leaf_size, -1, GI_ERROR_INVALID_ARGUMENT);
	expect_bad_field(gi, leaf_size, NAN, GI_ERROR_INVALID_ARGUMENT);
	expect_bad_field(gi, leaf_size, INFINITY, GI_ERROR_INVALID_ARGUMENT);
	expect_bad_field(gi, leaf_size, 1e-5f, GI_ERROR_INVALID_GEOMETRY); /* 1e10 leaves */
	expect_bad_field(gi, leaf_size, 1e-30f, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, leaf_sizes, &blunt[0], GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, leaf_sizes, &sharp_nan[0], GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, leaf_cut_count, 1, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, materials, NULL, GI_ERROR_INVALID_ARGUMENT);
	expect_bad_field(gi, scale[0], 0, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, scale[1], -1, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, scale[2], NAN, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, scale[2], 1e-30f, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, pose.rotation[3], 0, GI_ERROR_INVALID_POSE);
	expect_bad_field(gi, pose.rotation[0], NAN, GI_ERROR_INVALID_POSE);
	expect_bad_field(gi, pose.rotation[1], INFINITY, GI_ERROR_INVALID_POSE);
	expect_bad_field(gi, pose.position[1], NAN, GI_ERROR_INVALID_POSE);
	expect_bad_field(gi, pose.position[2], -INFINITY, GI_ERROR_INVALID_POSE);
}

static void bad_cages(gi_context *gi)
{
	expect_bad_field(gi, positions, NULL, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, indices, NULL, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, vertex_count, 0, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, vertex_count, 3, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, face_count, 0, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, face_count, 0x40000001u, GI_ERROR_INVALID_GEOMETRY); /* times 4 it is 4 again in 32 bits */
	expect_bad_field(gi, index_count, 3, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, index_count, 0, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, indices, beyond, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, indices, huge_index, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, face_counts, two_corners, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, face_counts, five_corners, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, face_counts, endless_corners, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, positions, with_nan, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, positions, with_infinity, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, positions, one_point, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, positions, one_line, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, positions, very_large, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, face_materials, material_1, GI_ERROR_INVALID_GEOMETRY);
	expect_bad_field(gi, scheme, GI_SCHEME_LOOP, GI_ERROR_INVALID_GEOMETRY); /* of a quad */
}

static void bad_creases_and_draw_meshes(gi_context *gi)
{
	gi_object_def def = square_def();
	gi_leaf_cut cut = {.face = 1};
	def.leaf_cuts = &cut;
	def.leaf_cut_count = 1;
	expect_bad_object(gi, &def, GI_ERROR_INVALID_GEOMETRY, "a leaf cut on no face");
	cut = (gi_leaf_cut){.to = {0, NAN, 0}};
	expect_bad_object(gi, &def, GI_ERROR_INVALID_GEOMETRY, "a leaf cut to nowhere");
	def = square_def();
	def.crease_count = 1;
	expect_bad_object(gi, &def, GI_ERROR_INVALID_GEOMETRY, "creases without arrays");
	def.crease_vertices = edge_beyond;
	def.crease_sharpness = sharp;
	expect_bad_object(gi, &def, GI_ERROR_INVALID_GEOMETRY, "a crease at a vertex that is not there");
	def.crease_vertices = edge;
	def.crease_sharpness = blunt;
	expect_bad_object(gi, &def, GI_ERROR_INVALID_GEOMETRY, "a crease of negative sharpness");
	def.crease_sharpness = sharp_nan;
	expect_bad_object(gi, &def, GI_ERROR_INVALID_GEOMETRY, "a crease of sharpness NaN");

	def = square_def();
	def.draw_index_count = 3;
	def.draw_vertex_count = 4;
	expect_bad_object(gi, &def, GI_ERROR_INVALID_GEOMETRY, "a draw mesh without arrays");
	def.draw_positions = square;
	def.draw_indices = beyond + 1;
	expect_bad_object(gi, &def, GI_ERROR_INVALID_GEOMETRY, "a draw mesh with an index out of range");
	def.draw_indices = corners;
	def.draw_index_count = 4;
	expect_bad_object(gi, &def, GI_ERROR_INVALID_GEOMETRY, "a draw mesh with four indices");
	def.draw_index_count = 3;
	def.draw_positions = with_nan;
	expect_bad_object(gi, &def, GI_ERROR_INVALID_GEOMETRY, "a draw mesh with NaN");
}

static const float bad_rhos[] = {1, 1.5f, -.1f, NAN, INFINITY}, bad_exitances[] = {-1, NAN, INFINITY, -INFINITY};

static void expect_bad_material(gi_context *gi, gi_material m, const char *what)
{
	gi_object_def def = square_def();
	def.materials = &m;
	expect_bad_object(gi, &def, GI_ERROR_INVALID_MATERIAL, what);
}

static void object_definitions(void **state)
{
	(void)state;
	loaded l = load();
	bad_values(l.gi);
	bad_cages(l.gi);
	bad_creases_and_draw_meshes(l.gi);
	for (size_t k = 0; k < sizeof bad_rhos / sizeof *bad_rhos; k++)
		expect_bad_material(l.gi, (gi_material){.rho = {.1f, bad_rhos[k], .1f}}, "bad rho");
	for (size_t k = 0; k < sizeof bad_exitances / sizeof *bad_exitances; k++)
		expect_bad_material(l.gi, (gi_material){.exitance = {0, 0, bad_exitances[k]}}, "bad exitance");

	gi_object object;
	const gi_object_def good = square_def(), nobody_made_it = {.positions = square};
	expect_bad_object(l.gi, &nobody_made_it, GI_ERROR_INVALID_DEF, "a definition nobody made");
	expect_bad_object(l.gi, NULL, GI_ERROR_INVALID_ARGUMENT, "no definition");
	expect_error(gi_create_object(l.gi, &good, NULL), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_create_object(NULL, &good, &object), GI_ERROR_INVALID_ARGUMENT);
	expect_unharmed(&l, "bad objects");
	unload(&l);
}

/* ---- values ---- */

static void expect_stale(loaded *l, gi_object object)
{
	const gi_pose pose = gi_pose_identity();
	gi_pose out;
	gi_material material;
	double f;
	assert_false(gi_object_is_valid(l->gi, object));
	expect_error(gi_set_pose(l->gi, object, pose), GI_ERROR_INVALID_HANDLE);
	expect_error(gi_get_pose(l->gi, object, &out), GI_ERROR_INVALID_HANDLE);
	expect_error(gi_set_material(l->gi, object, 0, good_material), GI_ERROR_INVALID_HANDLE);
	expect_error(gi_get_material(l->gi, object, 0, &material), GI_ERROR_INVALID_HANDLE);
	expect_error(gi_destroy_object(l->gi, object), GI_ERROR_INVALID_HANDLE);
	expect_error(gi_form_factor(l->gi, object, l->floor, &f), GI_ERROR_INVALID_HANDLE);
	if (object.index1)
		expect_error(gi_form_factor(l->gi, l->floor, object, &f), GI_ERROR_INVALID_HANDLE);
}

static void handles(void **state)
{
	(void)state;
	loaded l = load();
	expect_stale(&l, (gi_object){0});
	expect_stale(&l, (gi_object){99, 1, l.ball.context});
	expect_stale(&l, (gi_object){0xFFFFFFFFu, 1, l.ball.context});
	expect_stale(&l, (gi_object){l.ball.index1, l.ball.generation + 1, l.ball.context});
	expect_stale(&l, (gi_object){l.ball.index1, l.ball.generation + 2, l.ball.context});
	expect_stale(&l, (gi_object){l.ball.index1, 0, l.ball.context});
	expect_unharmed(&l, "stale handles");

	/* Destroyed; then another one in its place. */
	assert_gi(gi_destroy_object(l.gi, l.ball));
	expect_stale(&l, l.ball);
	assert_gi(gi_commit(l.gi));
	expect_stale(&l, l.ball);
	const gi_object old = l.ball;
	l.ball = add_ball(l.gi);
	assert_int_equal(l.ball.index1, old.index1);
	expect_stale(&l, old);
	assert_gi(gi_commit(l.gi));
	expect_stale(&l, old);
	assert_true(gi_object_is_valid(l.gi, l.ball));
	harness_update(l.gi);
	expect_unharmed(&l, "an object destroyed and made again");
	unload(&l);
}

static void poses_and_materials(void **state)
{
	(void)state;
	loaded l = load();
	const gi_pose bad_poses[] = {
	    {.rotation = {0, 0, 0, 0}},
	    {.rotation = {0, 0, NAN, 1}},
	    {.rotation = {0, INFINITY, 0, 1}},
	    {.position = {NAN, 0, 0}, .rotation = {0, 0, 0, 1}},
	    {.position = {0, INFINITY, 0}, .rotation = {0, 0, 0, 1}},
	};
	for (size_t k = 0; k < sizeof bad_poses / sizeof *bad_poses; k++)
		expect_error(gi_set_pose(l.gi, l.ball, bad_poses[k]), GI_ERROR_INVALID_POSE);
	gi_pose pose;
	assert_gi(gi_get_pose(l.gi, l.ball, &pose));
	assert_float_equal(pose.position[1], .5f, 0);
	gi_mobility mobility;
	expect_error(gi_set_mobility(l.gi, l.ball, (gi_mobility)3), GI_ERROR_INVALID_ARGUMENT);
	expect_error(gi_set_mobility(l.gi, (gi_object){99, 1, l.ball.context}, GI_MOBILITY_STATIC),
		     GI_ERROR_INVALID_HANDLE);
	assert_gi(gi_get_mobility(l.gi, l.ball, &mobility));
	assert_int_equal(mobility, GI_MOBILITY_AUTOMATIC);
	for (size_t k = 0; k < sizeof bad_rhos / sizeof *bad_rhos; k++)
		expect_error(gi_set_material(l.gi, l.ball, 0, (gi_material){.rho = {bad_rhos[k], 0, 0}}),
			     GI_ERROR_INVALID_MATERIAL);
	for (size_t k = 0; k < sizeof bad_exitances / sizeof *bad_exitances; k++)
		expect_error(gi_set_material(l.gi, l.ball, 0, (gi_material){.exitance = {bad_exitances[k], 0, 0}}),
			     GI_ERROR_INVALID_MATERIAL);
	expect_error(gi_set_material(l.gi, l.ball, 1, good_material), GI_ERROR_INVALID_ARGUMENT);
	expect_error(gi_set_material(l.gi, l.ball, 0xFFFFFFFFu, good_material), GI_ERROR_INVALID_ARGUMENT);
	expect_unharmed(&l, "bad poses and materials");
	unload(&l);
}

static void poses_come_back(void **state)
{
	(void)state;
	loaded l = load();
	gi_mobility mobility;
	/* A pose that was got is one that was set, to the bit: it would count as a move. */
	for (int k = 1; k < 1000; k++) {
		const gi_pose turned = {.rotation = {sinf((float)k), cosf(3 * (float)k), .1f * (float)(k % 7), .3f}};
		gi_pose again;
		assert_gi(gi_set_pose(l.gi, l.ball, turned));
		assert_gi(gi_get_pose(l.gi, l.ball, &again));
		assert_gi(gi_set_pose(l.gi, l.ball, again));
		gi_pose third;
		assert_gi(gi_get_pose(l.gi, l.ball, &third));
		assert_memory_equal(&again, &third, sizeof again);
	}
	assert_gi(gi_get_mobility(l.gi, l.ball, &mobility));
	assert_int_equal(mobility, GI_MOBILITY_MOVABLE);
	unload(&l);
}

static void null_pointers(void **state)
{
	(void)state;
	loaded l = load();
	expect_error(gi_get_pose(l.gi, l.ball, NULL), GI_ERROR_INVALID_ARGUMENT);
	expect_error(gi_get_report(l.gi, NULL), GI_ERROR_INVALID_ARGUMENT);
	expect_error(gi_get_buffers(l.gi, NULL), GI_ERROR_INVALID_ARGUMENT);
	expect_error(gi_read_leaves(l.gi, NULL, 0, NULL), GI_ERROR_INVALID_ARGUMENT);
	expect_error(gi_read_entries(l.gi, NULL, 0, NULL), GI_ERROR_INVALID_ARGUMENT);
	expect_error(gi_read_links(l.gi, NULL, 0, NULL), GI_ERROR_INVALID_ARGUMENT);
	expect_error(gi_form_factor(l.gi, l.floor, l.ball, NULL), GI_ERROR_INVALID_ARGUMENT);
	expect_error(gi_draw(l.gi, NULL), GI_ERROR_INVALID_ARGUMENT);
	gi_pose pose = gi_pose_identity();
	gi_report report;
	uint64_t count;
	uint32_t leaves;
	double f;
	assert_int_equal(gi_set_pose(NULL, l.ball, pose), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_get_pose(NULL, l.ball, &pose), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_set_material(NULL, l.ball, 0, good_material), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_set_mobility(NULL, l.ball, GI_MOBILITY_STATIC), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_destroy_object(NULL, l.ball), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_commit(NULL), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_update(NULL, NULL), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_finish(NULL), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_get_report(NULL, &report), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_read_leaves(NULL, NULL, 0, &leaves), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_read_entries(NULL, NULL, 0, &count), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_form_factor(NULL, l.floor, l.ball, &f), GI_ERROR_INVALID_ARGUMENT);
	assert_false(gi_object_is_valid(NULL, l.ball));
	gi_invalidate(NULL);
	gi_reset_radiosity(NULL);
	for (int k = -1; k <= GI_RESULT_COUNT; k++)
		assert_non_null(gi_result_text((gi_result)k));
	for (int k = -1; k <= GI_PASS_COUNT; k++)
		assert_non_null(gi_pass_name((gi_pass)k));
	expect_unharmed(&l, "NULL pointers");
	unload(&l);
}

/* ---- order of calls ---- */

static void update_before_commit(void **state)
{
	(void)state;
	const gi_context_def def = loud_def();
	gi_context *fresh = harness_context(&def);
	expect_error(gi_update(fresh, NULL), GI_ERROR_NOT_COMMITTED);
	add_light(fresh);
	expect_error(gi_update(fresh, NULL), GI_ERROR_NOT_COMMITTED);
	snapshot nothing = snapshot_take(fresh);
	assert_int_equal(nothing.leaf_count + nothing.entry_count + nothing.link_count, 0);
	snapshot_free(&nothing);
	gi_context_destroy(fresh);

	loaded l = load();
	const gi_object extra = add_light(l.gi);
	double f;
	assert_gi(gi_update(l.gi, NULL)); /* without it */
	expect_error(gi_form_factor(l.gi, extra, l.floor, &f), GI_ERROR_INVALID_HANDLE);
	expect_error(gi_form_factor(l.gi, l.floor, extra, &f), GI_ERROR_INVALID_HANDLE);
	assert_gi(gi_destroy_object(l.gi, extra));
	assert_gi(gi_update(l.gi, NULL));
	snapshot same = snapshot_take(l.gi);
	snapshot_expect_same_rows(&l.before, &same, "before the commit");
	snapshot_free(&same);
	assert_gi(gi_commit(l.gi));
	harness_update(l.gi);
	expect_unharmed(&l, "an object that came and went before a commit");

	/* The scene that was uploaded can be read until the commit; handles of what is gone are null or stale, never
	 * another's. */
	assert_gi(gi_destroy_object(l.gi, l.ball));
	same = snapshot_take(l.gi);
	snapshot_expect_same_rows(&l.before, &same, "after destroying, before the commit");
	for (uint32_t k = 0; k < same.leaf_count; k++)
		assert_true(same.leaves[k].object.index1 != l.ball.index1 ||
			    !gi_object_is_valid(l.gi, same.leaves[k].object));
	snapshot_free(&same);
	unload(&l);
}

/* Between gi_commit and gi_update what is new has no rows yet, what was there has those of before, and there is
 * nothing of what else was in memory. */
static void read_before_update(void **state)
{
	(void)state;
	loaded l = load();
	for (int k = 0; k < 3; k++) {
		double before, after;
		snapshot was = snapshot_take(l.gi);
		assert_gi(gi_form_factor(l.gi, l.floor, l.ball, &before));
		const gi_object ball = add_ball(l.gi);
		assert_gi(gi_commit(l.gi));
		snapshot s = snapshot_take(l.gi);
		assert_int_equal(s.entry_count, was.entry_count);
		assert_int_equal(s.link_count, was.link_count);
		for (uint32_t leaf = 0; leaf < s.leaf_count; leaf++)
			if (s.leaves[leaf].object.index1 == ball.index1)
				assert_true(s.leaves[leaf].row_sum == 0 && s.leaves[leaf].irradiance[0] == 0);
		snapshot_free(&s);
		snapshot_free(&was);
		assert_gi(gi_form_factor(l.gi, l.floor, l.ball, &after));
		assert_true(after == before && (before > 0 || k > 0)); /* the next ball hides it */
		assert_gi(gi_form_factor(l.gi, ball, l.floor, &after));
		assert_true(after == 0);
		harness_update(l.gi);
	}
	unload(&l);
}

/* ---- small scenes ---- */

static void expect_empty(gi_context *gi)
{
	heard.count = 0;
	for (int frame = 0; frame < 3; frame++) {
		const gi_report r = harness_update(gi);
		assert_true(r.outcome == GI_OUTCOME_CONVERGED || r.outcome == GI_OUTCOME_AT_REST ||
			    r.outcome == GI_OUTCOME_NOT_RUN);
		assert_int_equal(r.objects + r.leaves, 0);
		assert_int_equal(r.entries + r.links, 0);
		assert_true(r.radiosity_max == 0 && r.residual == 0); /* nothing of the scene before */
		if (frame)
			assert_int_equal(r.dispatches + r.uploaded_bytes, 0);
	}
	snapshot s = snapshot_take(gi);
	assert_int_equal(s.leaf_count + s.entry_count + s.link_count, 0);
	snapshot_free(&s);
	assert_int_equal(heard.count, 0);
}

static void empty_scene(void **state)
{
	(void)state;
	for (int sky = GI_SKY_AUTO; sky <= GI_SKY_ON; sky++) {
		gi_context_def def = loud_def();
		def.sky = (gi_sky)sky;
		gi_context *gi = harness_context(&def);
		assert_gi(gi_commit(gi));
		expect_empty(gi);
		const gi_object light = add_light(gi);
		assert_gi(gi_commit(gi));
		assert_int_equal(harness_update(gi).leaves, 1);
		assert_gi(gi_destroy_object(gi, light));
		assert_gi(gi_commit(gi));
		expect_empty(gi);
		gi_context_destroy(gi);
	}
}

static void one_leaf(void **state)
{
	(void)state;
	const gi_context_def def = loud_def();
	gi_context *gi = harness_context(&def);
	const gi_object light = add_light(gi);
	assert_gi(gi_commit(gi));
	assert_int_equal(harness_update(gi).outcome, GI_OUTCOME_CONVERGED);
	gi_leaf leaf;
	uint32_t count;
	assert_gi(gi_read_leaves(gi, &leaf, 1, &count));
	assert_int_equal(count, 1);
	assert_float_equal(leaf.radiosity[0], 10, 0);
	assert_float_equal(leaf.irradiance[0], 0, 0);
	double f;
	assert_gi(gi_form_factor(gi, light, light, &f));
	assert_float_equal(f, 0, 0);
	assert_gi(gi_form_factor(gi, light, (gi_object){0}, &f));
	assert_float_equal(f, 0, 0);
	gi_context_destroy(gi);
}

/* A leaf that sees nothing at all has an empty row, and no sum of it. */
static void blind_leaf(void **state)
{
	(void)state;
	gi_context_def def = loud_def();
	def.sky = GI_SKY_OFF;
	gi_context *gi = harness_context(&def);
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-1, 0, -1}, (float[]){0, 0, 2}, (float[]){2, 0, 0}, 1, 1, &mesh));
	harness_add(gi, &(harness_object){.name = "alone", .rho = {.5f, .5f, .5f}, .exitance = {1, 2, 3}}, &mesh);
	assert_gi(gi_commit(gi));
	const gi_report r = harness_update(gi);
	assert_int_equal(r.outcome, GI_OUTCOME_CONVERGED);
	/* Nothing but the rounding that certified figures allow for. */
	assert_true(r.solve_bound <= 1e-6f && r.contraction <= 1e-6f);
	gi_leaf leaf;
	uint32_t count;
	assert_gi(gi_read_leaves(gi, &leaf, 1, &count));
	assert_true(leaf.row_sum == 0 && leaf.radiosity[2] == 3);
	gi_context_destroy(gi);
}

static void no_light(void **state)
{
	(void)state;
	const gi_context_def def = loud_def();
	gi_context *gi = harness_context(&def);
	add_floor(gi);
	add_ball(gi);
	assert_gi(gi_commit(gi));
	const gi_report r = harness_update(gi);
	assert_int_equal(r.outcome, GI_OUTCOME_CONVERGED);
	assert_float_equal(r.radiosity_max, 0, 0);
	assert_float_equal(r.solve_relative, 0, 0);
	snapshot s = snapshot_take(gi);
	assert_float_equal(snapshot_largest(&s), 0, 0);
	snapshot_free(&s);
	gi_context_destroy(gi);
}

/* Objects come and go: GPU memory and handles' places stay, and rows are those of the first time. */
static void many_lives(void **state)
{
	(void)state;
	loaded l = load();
	uint64_t bytes = 0;
	for (int life = 0; life < 20; life++) {
		assert_gi(gi_destroy_object(l.gi, l.ball));
		assert_gi(gi_commit(l.gi));
		const gi_report without = harness_update(l.gi);
		assert_true(without.entries < l.before.entry_count);
		/* One that never takes part. */
		assert_gi(gi_destroy_object(l.gi, add_ball(l.gi)));
		l.ball = add_ball(l.gi);
		assert_int_equal(l.ball.index1, 2);
		assert_gi(gi_commit(l.gi));
		const gi_report with = harness_update(l.gi);
		if (life == 0)
			bytes = with.gpu_bytes;
		assert_int_equal(with.gpu_bytes, bytes);
		assert_int_equal(with.objects, 3);
	}
	expect_unharmed(&l, "twenty lives of a ball");
	unload(&l);
}

/* ---- what does not fit ---- */

/* More materials than the largest buffer that was allowed holds. */
static void commit_that_fails(void **state)
{
	(void)state;
	loaded l = load();
	const uint32_t count = 8000000;
	gi_material *materials = calloc(count, sizeof *materials);
	assert_non_null(materials);
	engine_mesh mesh;
	assert_true(shape_quad((float[]){0, .5f, 0}, (float[]){1, 0, 0}, (float[]){0, 0, 1}, 1, 1, &mesh));
	gi_object_def def = gi_object_def_default();
	def.positions = mesh.positions;
	def.vertex_count = mesh.vertex_count;
	def.indices = mesh.indices;
	def.index_count = mesh.index_count;
	def.face_count = mesh.face_count;
	def.materials = materials;
	def.material_count = count;
	gi_object big;
	assert_gi(gi_create_object(l.gi, &def, &big));
	engine_mesh_free(&mesh);
	free(materials);
	assert_int_equal(gi_commit(l.gi), GI_ERROR_OUT_OF_MEMORY);
	double f;
	assert_gi(gi_form_factor(l.gi, l.floor, l.ball, &f));
	assert_gi(gi_destroy_object(l.gi, big));
	assert_gi(gi_commit(l.gi));
	harness_update(l.gi);
	expect_unharmed(&l, "a commit that failed");
	unload(&l);
}

/* Rows too large for the largest buffer that was allowed: an error from the first update and from every one after it,
 * never a converged picture. */
static void rows_that_do_not_fit(void **state)
{
	(void)state;
	gi_context_def def = harness_def();
	def.row_tolerance = 2e-5f;
	def.max_buffer_mib = 32;
	gi_context *gi = harness_context(&def);
	for (int k = 0; k < 2; k++) {
		engine_mesh mesh;
		const float a[3] = {1, 0, 0}, b[3] = {0, 0, 1};
		assert_true(shape_quad((float[]){0, (float)k, 0}, k ? a : b, k ? b : a, 1, 1, &mesh));
		harness_add(
		    gi, &(harness_object){.name = "square", .levels = 6, .rho = {.5f, .5f, .5f}, .exitance = {1, 1, 1}},
		    &mesh);
	}
	assert_gi(gi_commit(gi));
	for (int k = 0; k < 2; k++)
		assert_int_equal(gi_update(gi, NULL), GI_ERROR_OUT_OF_MEMORY);
	gi_context_destroy(gi);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(context_definitions),
	    cmocka_unit_test(environment),
	    cmocka_unit_test(object_definitions),
	    cmocka_unit_test(handles),
	    cmocka_unit_test(poses_and_materials),
	    cmocka_unit_test(poses_come_back),
	    cmocka_unit_test(null_pointers),
	    cmocka_unit_test(update_before_commit),
	    cmocka_unit_test(read_before_update),
	    cmocka_unit_test(empty_scene),
	    cmocka_unit_test(one_leaf),
	    cmocka_unit_test(blind_leaf),
	    cmocka_unit_test(no_light),
	    cmocka_unit_test(many_lives),
	    cmocka_unit_test(commit_that_fails),
	    cmocka_unit_test(rows_that_do_not_fit),
	};
	return cmocka_run_group_tests_name("bad input", tests, harness_open, harness_close);
}
