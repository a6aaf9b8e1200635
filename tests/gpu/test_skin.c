/* What moves skin: joints and scales against closed forms, pictures, what is refused, budgets, and many lives.
 */
#include "snapshot.h"

#include "deforming_scene.h"
#include "scenes/body.h"
#include "scenes/look_at.h"
#include "scenes/shapes.h"
#include "target.h"

#include <glad/gl.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 64 };

static gi_context *open_context(void)
{
	gi_context_def def = harness_def();
	def.row_tolerance = .1f;
	return harness_context(&def);
}

static gi_object create(gi_context *gi, const gi_object_def *def)
{
	gi_object object;
	if (gi_create_object(gi, def, &object))
		fail_msg("gi_create_object: %s", harness_last_message());
	return object;
}

static void commit(gi_context *gi)
{
	assert_gi(gi_commit(gi));
	harness_update(gi);
}

/* ---- shapes ---- */

/* Floats of coordinates below 4, through one more turn. */
static const double PLACE = 2e-6;

static double off_corner(const float a[3], const double b[3])
{
	return fmax(fabs(a[0] - b[0]), fmax(fabs(a[1] - b[1]), fabs(a[2] - b[2])));
}

/* A strip of four faces along y whose upper end one joint turns by a quarter about z, and whose middle has half of
 * each. */
static void an_elbow(void **state)
{
	(void)state;
	engine_mesh m;
	assert_true(shape_quad((float[]){-.1f, -1, 0}, (float[]){.2f, 0, 0}, (float[]){0, 2, 0}, 1, 4, &m));
	uint32_t joints[4 * 10] = {0};
	float weights[4 * 10] = {0};
	assert_int_equal(m.vertex_count, 10);
	for (uint32_t v = 0; v < m.vertex_count; v++) {
		const float y = m.positions[3 * v + 1];
		joints[4 * v + 1] = 1;
		weights[4 * v] = y > .25f ? 0 : y < -.25f ? 3.f : 2.f; /* of any sum */
		weights[4 * v + 1] = y < -.25f ? 0 : y > .25f ? .5f : 2.f;
	}
	gi_object_def def = scene_mesh_def(&m);
	def.deforms = true;
	def.joints = joints;
	def.joint_weights = weights;
	def.joint_count = 2;
	gi_context *gi = open_context();
	const gi_object object = create(gi, &def);
	commit(gi);
	const float matrices[32] = {1, 0, 0, 0, 0,  1, 0, 0, 0, 0, 1, 0, 0,   0, 0, 1,
				    0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, .5f, 0, 0, 1};
	assert_gi(gi_set_joints(gi, object, matrices, 2));
	harness_update(gi);
	gi_leaf leaves[4];
	uint32_t count;
	assert_gi(gi_read_leaves(gi, leaves, 4, &count));
	assert_int_equal(count, 4);
	uint32_t found = 0;
	for (uint32_t k = 0; k < 4; k++)
		for (int c = 0; c < 4; c++)
			for (uint32_t v = 0; v < m.vertex_count; v++) {
				const double x = m.positions[3 * v], y = m.positions[3 * v + 1];
				const double lower = y > .25 ? 0 : y < -.25 ? 1 : .5, upper = 1 - lower;
				const double at[3] = {lower * x + upper * (.5 - y), lower * y + upper * x, 0};
				found += off_corner(leaves[k].corners[c], at) < PLACE;
			}
	assert_int_equal(found, 16);
	engine_mesh_free(&m);
	gi_context_destroy(gi);
}

/* All of it on one joint, and drawn, is a pose; a scale that is set is one that was there from the first. */
static void joints_that_are_poses(void **state)
{
	(void)state;
	engine_mesh m;
	assert_true(shape_sphere(.5f, 2, &m));
	uint32_t joints[4 * 64] = {0};
	float weights[4 * 64] = {0};
	assert_in_range(m.vertex_count, 8, 64);
	for (uint32_t v = 0; v < m.vertex_count; v++)
		weights[4 * v] = 1;
	gi_object_def def = scene_mesh_def(&m);
	def.scheme = GI_SCHEME_CATMULL_CLARK;
	def.levels = 1;
	def.deforms = true;
	gi_context *gi = open_context();
	const gi_object posed = create(gi, &def), scaled = create(gi, &def);
	memcpy(def.scale, (float[]){1, 1, 1}, sizeof def.scale);
	def.joints = joints;
	def.joint_weights = weights;
	def.joint_count = 1;
	const gi_object jointed = create(gi, &def);
	const float c = .8f, s = .6f; /* about y */
	assert_gi(gi_set_pose(gi, posed, (gi_pose){{.3f, .2f, -.1f}, {0, .31622777f, 0, .94868330f}}));
	assert_gi(gi_set_joints(gi, jointed, (float[]){c, 0, -s, 0, 0, 1, 0, 0, s, 0, c, 0, .3f, .2f, -.1f, 1}, 1));
	assert_gi(gi_set_scale(gi, scaled, (float[]){2, 1, .5f}));
	commit(gi);
	snapshot now = snapshot_take(gi);
	const uint32_t each = now.leaf_count / 3;
	for (uint32_t k = 0; k < each; k++)
		for (int corner = 0; corner < 4; corner++) {
			const float *p = now.leaves[k].corners[corner], *q = now.leaves[2 * each + k].corners[corner];
			assert_true(off_corner(q, (double[]){p[0], p[1], p[2]}) < PLACE);
			/* Back to where it was made. */
			const double x = p[0] - .3, z = p[2] + .1;
			const double at[3] = {2 * (.8 * x - .6 * z), p[1] - .2, .5 * (.6 * x + .8 * z)};
			assert_true(off_corner(now.leaves[each + k].corners[corner], at) < PLACE);
		}
	snapshot_free(&now);
	engine_mesh_free(&m);
	gi_context_destroy(gi);
}

/* ---- pictures ---- */

static void draw(gi_context *gi, target *t, gi_overlay overlay, float pixels[SIZE * SIZE * 4])
{
	gi_view view = gi_view_default();
	look_at((const float[]){1.9f, 2.2f, 1.9f}, (const float[]){-.2f, .9f, -.1f}, 75, 1, view.view_from_world,
		view.clip_from_view);
	view.overlay = overlay;
	target_draw(t, gi, view);
	memcpy(pixels, t->pixels, SIZE * SIZE * 4 * sizeof(float));
}

/* A picture shows the shape of the last update, not the one that was set since; and it is that of a context which knew
 * no other, but for where the solve began. */
static void pictures_follow(void **state)
{
	(void)state;
	static float before[SIZE * SIZE * 4], waiting[SIZE * SIZE * 4], after[SIZE * SIZE * 4], fresh[SIZE * SIZE * 4];
	target t = target_make(SIZE);
	deforming_scene s;
	deforming_scene_make(&s);
	s.gi = open_context();
	deforming_scene_create(&s);
	commit(s.gi);
	draw(s.gi, &t, GI_OVERLAY_NONE, before);
	for (int frame = 0; frame < 5; frame++)
		deforming_scene_play(&s, frame);
	draw(s.gi, &t, GI_OVERLAY_NONE, waiting);
	assert_memory_equal(before, waiting, sizeof before);
	harness_update(s.gi);
	/* In between others, so that what was drawn before has gone by. */
	draw(s.gi, &t, GI_OVERLAY_WIREFRAME, waiting);
	deforming_scene_play(&s, 5);
	gi_reset_radiosity(s.gi);
	harness_update(s.gi);
	deforming_scene other = s;
	other.gi = open_context();
	deforming_scene_create(&other);
	deforming_scene_set(&other);
	commit(other.gi);
	for (int overlay = GI_OVERLAY_NONE; overlay <= GI_OVERLAY_WIREFRAME; overlay++) {
		uint32_t changed = 0;
		draw(s.gi, &t, (gi_overlay)overlay, after);
		draw(other.gi, &t, (gi_overlay)overlay, fresh);
		for (int k = 0; k < SIZE * SIZE * 4; k++) {
			/* Rays of a warm and a cold solve end a tolerance apart. */
			assert_true(fabsf(after[k] - fresh[k]) <= 1e-3f * (1 + fabsf(fresh[k])));
			changed += fabsf(after[k] - before[k]) > .05f * (1 + fabsf(before[k]));
		}
		assert_true(changed > SIZE * SIZE / 20);
	}
	gi_context_destroy(other.gi);
	gi_context_destroy(s.gi);
	deforming_scene_free(&s);
	target_free(&t);
}

/* A ball whose cage is drawn as a finer mesh, all of it on one joint. */
typedef struct drawn_ball {
	engine_mesh cage, fine;
	uint32_t indices[6 * 216], joints[4 * 512];
	float weights[4 * 512];
} drawn_ball;

static gi_object_def make_drawn_ball(drawn_ball *b)
{
	assert_true(shape_sphere(.5f, 1, &b->cage) && shape_sphere(.5f, 6, &b->fine));
	assert_true(b->fine.face_count <= 216 && b->fine.vertex_count <= 512);
	for (uint32_t v = 0; v < b->fine.vertex_count; v++)
		b->weights[4 * v] = 1;
	for (uint32_t f = 0; f < b->fine.face_count; f++) {
		const uint32_t *q = b->fine.indices + 4 * f;
		memcpy(b->indices + 6 * f, (uint32_t[]){q[0], q[1], q[2], q[0], q[2], q[3]}, 6 * sizeof *b->indices);
	}
	gi_object_def def = scene_mesh_def(&b->cage);
	def.draw_positions = b->fine.positions;
	def.draw_vertex_count = b->fine.vertex_count;
	def.draw_indices = b->indices;
	def.draw_index_count = 6 * b->fine.face_count;
	return def;
}

static void lift(const engine_mesh *m, float out[3 * 512])
{
	for (uint32_t k = 0; k < 3 * m->vertex_count; k++)
		out[k] = m->positions[k] + (k % 3 == 1 ? .75f : 0);
}

enum { BY_POSE, BY_POSITIONS, BY_JOINTS, WAYS };

/* Its picture once it was lifted. */
static void draw_lifted(drawn_ball *b, gi_object_def def, int way, target *t, float pixels[SIZE * SIZE * 4])
{
	static const float lifted[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, .75f, 0, 1};
	static float positions[3 * 512];
	gi_context *gi = open_context();
	engine_mesh m;
	assert_true(shape_quad((float[]){-2, 3, -2}, (float[]){4, 0, 0}, (float[]){0, 0, 4}, 3, 3, &m));
	harness_add(gi, &(harness_object){.name = "lamp", .exitance = {3, 3, 3}}, &m);
	def.deforms = way != BY_POSE;
	if (way == BY_JOINTS) {
		def.joints = def.draw_joints = b->joints;
		def.joint_weights = def.draw_joint_weights = b->weights;
		def.joint_count = 1;
	}
	const gi_object object = create(gi, &def);
	commit(gi);
	if (way == BY_POSE) {
		assert_gi(gi_set_pose(gi, object, (gi_pose){{0, .75f, 0}, {0, 0, 0, 1}}));
	} else if (way == BY_JOINTS) {
		assert_gi(gi_set_joints(gi, object, lifted, 1));
	} else {
		lift(&b->cage, positions);
		assert_gi(gi_set_positions(gi, object, positions));
		lift(&b->fine, positions);
		assert_gi(gi_set_draw_positions(gi, object, positions));
	}
	gi_reset_radiosity(gi);
	harness_update(gi);
	draw(gi, t, GI_OVERLAY_NONE, pixels);
	gi_context_destroy(gi);
}

/* A detailed mesh goes where it is told, or with the cage's joints, as it would go with a pose. */
static void a_mesh_that_is_drawn(void **state)
{
	(void)state;
	static float pixels[WAYS][SIZE * SIZE * 4];
	static drawn_ball ball;
	target t = target_make(SIZE);
	const gi_object_def def = make_drawn_ball(&ball);
	for (int way = 0; way < WAYS; way++)
		draw_lifted(&ball, def, way, &t, pixels[way]);
	uint32_t lit = 0;
	double off = 0, all = 0;
	for (int k = 0; k < SIZE * SIZE * 4; k++) {
		lit += pixels[BY_POSE][k] > 0;
		/* Positions and joints say the same but for rounding. */
		assert_true(fabsf(pixels[BY_POSITIONS][k] - pixels[BY_JOINTS][k]) < 1e-3f);
		off += fabs((double)pixels[BY_POSE][k] - (double)pixels[BY_POSITIONS][k]);
		all += (double)pixels[BY_POSE][k];
	}
	/* Rows within the object have rays of their own, and a contour may fall a pixel aside. */
	assert_true(lit > 100 && off < .02 * all);
	target_free(&t);
	engine_mesh_free(&ball.cage);
	engine_mesh_free(&ball.fine);
}

/* ---- what is refused ---- */

static void expect_refused(gi_result got, gi_result wanted, const char *line)
{
	if (got != wanted || !strstr(harness_last_message(), line))
		fail_msg("%s: '%s' is not about '%s'", gi_result_text(got), harness_last_message(), line);
}

static void definitions_that_are_refused(void **state)
{
	(void)state;
	engine_mesh m;
	assert_true(shape_box((float[]){0, 0, 0}, (float[]){1, 1, 1}, 1, false, &m));
	gi_context *gi = open_context();
	uint32_t joints[4 * 24] = {0};
	float weights[4 * 24] = {0};
	const gi_subsurface jade = {{80, 80, 80}, {1, 1, 1}, 1.3f};
	const gi_object_def plain = scene_mesh_def(&m);
	gi_object object;
	gi_object_def def = plain;
	def.deforms = true;
	def.subsurface = &jade;
	expect_refused(gi_create_object(gi, &def, &object), GI_ERROR_INVALID_GEOMETRY, "cannot deform");
	def = plain;
	def.deforms = true;
	def.mobility = GI_MOBILITY_STATIC;
	expect_refused(gi_create_object(gi, &def, &object), GI_ERROR_INVALID_GEOMETRY, "never static");
	def = plain;
	def.joints = joints;
	def.joint_weights = weights;
	def.joint_count = 1;
	expect_refused(gi_create_object(gi, &def, &object), GI_ERROR_INVALID_GEOMETRY, "joints need deforms");
	def.deforms = true;
	def.joint_weights = NULL;
	expect_refused(gi_create_object(gi, &def, &object), GI_ERROR_INVALID_GEOMETRY, "joints need weights");
	def.joint_weights = weights;
	weights[5] = NAN;
	expect_refused(gi_create_object(gi, &def, &object), GI_ERROR_INVALID_GEOMETRY, "weight is negative");
	weights[5] = -1;
	expect_refused(gi_create_object(gi, &def, &object), GI_ERROR_INVALID_GEOMETRY, "weight is negative");
	weights[5] = 1;
	joints[7] = 1;
	expect_refused(gi_create_object(gi, &def, &object), GI_ERROR_INVALID_GEOMETRY, "below joint_count");
	engine_mesh_free(&m);
	gi_context_destroy(gi);
}

static void shapes_that_are_refused(void **state)
{
	(void)state;
	static const float bad[] = {NAN, INFINITY, -INFINITY, 2e9f};
	engine_mesh m;
	assert_true(shape_box((float[]){0, 0, 0}, (float[]){1, 1, 1}, 1, false, &m));
	gi_context *gi = open_context();
	gi_object_def def = scene_mesh_def(&m);
	def.name = "skin";
	def.levels = 1;
	const gi_object rigid = create(gi, &def);
	def.deforms = true;
	const gi_object object = create(gi, &def), gone = create(gi, &def);
	assert_gi(gi_destroy_object(gi, gone));
	commit(gi);
	snapshot before = snapshot_take(gi);
	float p[3 * 24];
	const size_t count = 3 * (size_t)m.vertex_count;
	assert_true(count <= sizeof p / sizeof *p);
	for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
		memcpy(p, m.positions, sizeof *p * count);
		p[count - 1] = bad[k];
		expect_refused(gi_set_positions(gi, object, p), GI_ERROR_INVALID_GEOMETRY, "finite");
		expect_refused(gi_set_scale(gi, object, (float[]){1, bad[k], 1}), GI_ERROR_INVALID_GEOMETRY, "finite");
	}
	expect_refused(gi_set_scale(gi, object, (float[]){1, 0, 1}), GI_ERROR_INVALID_GEOMETRY, "above zero");
	memset(p, 0, sizeof p);
	expect_refused(gi_set_positions(gi, object, p), GI_ERROR_INVALID_GEOMETRY, "face ");
	/* One face alone is a line. */
	memcpy(p, m.positions, sizeof *p * count);
	for (int k = 0; k < 4; k++) {
		const uint32_t v = m.indices[4 * 3 + k];
		memcpy(p + 3 * v, (float[]){.5f, .1f * (float)(k % 2), .5f}, 3 * sizeof *p);
	}
	expect_refused(gi_set_positions(gi, object, p), GI_ERROR_INVALID_GEOMETRY, "face 3 has collapsed");
	expect_refused(gi_set_positions(gi, rigid, p), GI_ERROR_INVALID_ARGUMENT, "without gi_object_def.deforms");
	expect_refused(gi_set_positions(gi, gone, p), GI_ERROR_INVALID_HANDLE, "destroyed");
	expect_refused(gi_set_positions(gi, object, NULL), GI_ERROR_INVALID_ARGUMENT, "positions");
	expect_refused(gi_set_draw_positions(gi, object, p), GI_ERROR_INVALID_ARGUMENT, "no mesh");
	expect_refused(gi_set_joints(gi, object, p, 1), GI_ERROR_INVALID_ARGUMENT, "0 joints, not 1");
	expect_refused(gi_set_mobility(gi, object, GI_MOBILITY_STATIC), GI_ERROR_INVALID_ARGUMENT, "never static");
	/* Nothing of it counts. */
	assert_gi(gi_set_positions(gi, object, m.positions));
	const gi_report r = harness_update(gi);
	assert_int_equal(r.outcome, GI_OUTCOME_AT_REST);
	snapshot after = snapshot_take(gi);
	snapshot_expect_same_rows(&before, &after, "shapes that were refused");
	snapshot_free(&before);
	snapshot_free(&after);
	engine_mesh_free(&m);
	gi_context_destroy(gi);
}

/* Turned inside out, folded flat on itself, thin as a hair: all of it is finite, and a rebuild's. */
static void shapes_that_are_strange(void **state)
{
	(void)state;
	deforming_scene s;
	deforming_scene_make(&s);
	s.gi = open_context();
	deforming_scene_create(&s);
	commit(s.gi);
	for (int way = 0; way < 3; way++) {
		for (int k = 0; k < BENT_KINDS; k++)
			for (uint32_t v = 0; v < s.bent[k].mesh.vertex_count; v++) {
				const float *p = s.bent[k].mesh.positions + 3 * (size_t)v;
				float *q = s.bent[k].positions + 3 * (size_t)v;
				q[0] = way == 0 ? -p[0] : way == 1 ? .9f * fabsf(p[0]) + .1f * p[0] : p[0];
				q[1] = p[1];
				q[2] = way == 2 ? 1e-4f * p[2] + 1e-5f * p[0] * p[1] : p[2];
			}
		deforming_scene_set(&s);
		const gi_report r = harness_update(s.gi);
		assert_true(r.outcome > 0);
		snapshot now = snapshot_take(s.gi);
		for (uint32_t k = 0; k < now.leaf_count; k++)
			for (int c = 0; c < 3; c++)
				assert_true(isfinite(now.leaves[k].radiosity[c]));
		snapshot_free(&now);
		snapshot_expect_rebuilt_rows(s.gi, "a strange shape");
	}
	gi_context_destroy(s.gi);
	deforming_scene_free(&s);
}

/* ---- budgets, commits, lives ---- */

/* Rows wait, objects come and go: an exact update then makes what a rebuild makes. */
static void rows_that_waited(void **state)
{
	(void)state;
	deforming_scene s;
	deforming_scene_make(&s);
	s.gi = open_context();
	deforming_scene_create(&s);
	commit(s.gi);
	uint64_t waited = 0;
	gi_object came = {0};
	for (int frame = 0; frame < (harness_is_long() ? 60 : 6); frame++) {
		deforming_scene_play(&s, frame);
		gi_report r;
		assert_gi(gi_update(s.gi, &(gi_budget){.rays = 2000}));
		assert_gi(gi_finish(s.gi));
		assert_gi(gi_get_report(s.gi, &r));
		assert_true(r.outcome > 0);
		waited += r.waiting_rows;
		if (frame % 6 == 1) {
			engine_mesh m;
			assert_true(shape_sphere(.2f, 2, &m));
			came = harness_add(
			    s.gi, &(harness_object){.name = "ball", .rho = {.5f, .5f, .5f}, .position = {0, 2, 0}}, &m);
			/* A shape that no update took yet, in a commit. */
			deforming_scene_play(&s, frame + 100);
			assert_gi(gi_commit(s.gi));
		}
		if (frame % 6 == 4) {
			assert_gi(gi_destroy_object(s.gi, came));
			deforming_scene_play(&s, frame + 100);
			assert_gi(gi_commit(s.gi));
		}
		if (frame % 2) {
			harness_update(s.gi);
			snapshot_expect_rebuilt_rows(s.gi, "rows that waited");
		}
	}
	assert_true(waited > 100);
	gi_context_destroy(s.gi);
	deforming_scene_free(&s);
}

/* What is deleted keeps its name for as long as the driver uses it. */
static bool is_kept_program(GLuint name)
{
	GLint deleted = GL_TRUE;
	if (glIsProgram(name))
		glGetProgramiv(name, GL_DELETE_STATUS, &deleted);
	return !deleted;
}

/* How many of the first names there are. */
static uint32_t count_gl_objects(void)
{
	uint32_t count = 0;
	for (GLuint name = 1; name < 8192; name++)
		count += (uint32_t)(glIsBuffer(name) + glIsTexture(name) + glIsVertexArray(name) +
				    glIsFramebuffer(name) + glIsQuery(name) + is_kept_program(name));
	return count;
}

/* Created, bent, drawn and destroyed a hundred times; nothing is left of it. */
static void a_hundred_lives(void **state)
{
	(void)state;
	static float pixels[SIZE * SIZE * 4];
	enum { LIVES = 100 };
	target t = target_make(SIZE);
	const uint32_t before = count_gl_objects();
	deforming_scene s;
	deforming_scene_make(&s);
	s.gi = open_context();
	uint64_t bytes = 0;
	for (int life = 0; life < LIVES; life++) {
		gi_object_def def = scene_mesh_def(&s.bent[life % BENT_KINDS].mesh);
		def.deforms = true;
		def.double_sided = life % BENT_KINDS == BENT_SHEET;
		def.leaf_size = life % BENT_KINDS == BENT_SPLIT ? .2f : 0;
		def.scheme = life % BENT_KINDS == BENT_BALL ? GI_SCHEME_CATMULL_CLARK : GI_SCHEME_BILINEAR;
		def.levels = 1;
		const gi_object object = create(s.gi, &def);
		deforming_scene at = s;
		at.gi = NULL;
		deforming_scene_play(&at, 3 * life + 4);
		assert_gi(gi_set_positions(s.gi, object, s.bent[life % BENT_KINDS].positions));
		if (life % 10 < 2) { /* others go before anybody saw them */
			assert_gi(gi_commit(s.gi));
			assert_gi(gi_update(s.gi, NULL));
			assert_gi(gi_set_scale(s.gi, object, (float[]){1, 2, 1}));
			assert_gi(gi_update(s.gi, NULL));
			if (life % 20 == 0)
				draw(s.gi, &t, GI_OVERLAY_WIREFRAME, pixels);
		}
		assert_gi(gi_destroy_object(s.gi, object));
		if (life % 10 == 2) {
			assert_gi(gi_commit(s.gi));
			gi_report r;
			assert_gi(gi_get_report(s.gi, &r));
			bytes = bytes ? bytes : r.gpu_bytes;
			assert_true(r.gpu_bytes <= 2 * bytes);
		}
	}
	gi_context_destroy(s.gi);
	assert_int_equal(count_gl_objects(), before);
	deforming_scene_free(&s);
	target_free(&t);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(an_elbow),
	    cmocka_unit_test(joints_that_are_poses),
	    cmocka_unit_test(pictures_follow),
	    cmocka_unit_test(a_mesh_that_is_drawn),
	    cmocka_unit_test(definitions_that_are_refused),
	    cmocka_unit_test(shapes_that_are_refused),
	    cmocka_unit_test(shapes_that_are_strange),
	    cmocka_unit_test(rows_that_waited),
	    cmocka_unit_test(a_hundred_lives),
	};
	return cmocka_run_group_tests(tests, harness_open, harness_close);
}
