/* Instances of one shape: rows, light and picture are those of objects created each for itself, to the bit, whatever
 * becomes of the others; what they take; what is refused.
 */
#include "snapshot.h"

#include "faults.h"
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

/* ---- shapes ---- */

typedef enum kind {
	BALL,
	SMOOTH,
	SIDES,   /* two, faces there twice */
	SPLIT,   /* by a leaf size, of two materials, one a mirror */
	MARBLE,  /* subsurface */
	TEXTURE, /* leaf materials and texture coordinates */
	SCAN,    /* drawn as another mesh */
	BLANK,   /* not drawn */
	FIXED,   /* static */
	SKIN,    /* deforms, by joints */
	KINDS
} kind;

static const char *const NAMES[KINDS] = {"ball",    "smooth", "sides", "split", "marble",
					 "texture", "scan",   "blank", "fixed", "skin"};

enum { MOST_CORNERS = 512, MOST_DRAWN = 8300 };

typedef struct thing {
	engine_mesh mesh, drawn;
	gi_material materials[2];
	gi_specular specular[2];
	uint32_t draw_indices[6 * MOST_DRAWN], face_materials[MOST_CORNERS], joints[MOST_CORNERS];
	float uvs[2 * MOST_CORNERS], draw_uvs[6 * MOST_DRAWN][2], weights[MOST_CORNERS];
	gi_object_def def;
} thing;

static const gi_subsurface MARBLE_MEDIUM = {{14, 12, 10}, {.2f, .3f, .5f}, 1.5f};

static void make_scan(thing *t)
{
	/* So many vertices that they lie in the picture's mesh once. */
	assert_true(shape_sphere(.22f, 37, &t->drawn));
	assert_in_range(t->drawn.vertex_count, 8000, MOST_DRAWN);
	assert_in_range(t->drawn.face_count, 1, MOST_DRAWN);
	for (uint32_t f = 0; f < t->drawn.face_count; f++) {
		const uint32_t *q = t->drawn.indices + 4 * f;
		memcpy(t->draw_indices + 6 * f, (uint32_t[]){q[0], q[1], q[2], q[0], q[2], q[3]}, 6 * sizeof *q);
	}
	t->def.draw_positions = t->drawn.positions;
	t->def.draw_vertex_count = t->drawn.vertex_count;
	t->def.draw_indices = t->draw_indices;
	t->def.draw_index_count = 6 * t->drawn.face_count;
	for (uint32_t k = 0; k < t->def.draw_index_count; k++)
		memcpy(t->draw_uvs[k], t->drawn.positions + 3 * (size_t)t->draw_indices[k], sizeof t->draw_uvs[k]);
	t->def.draw_uvs = t->draw_uvs[0];
}

static void make_skin(thing *t)
{
	assert_in_range(t->mesh.vertex_count, 1, MOST_CORNERS / 4);
	for (uint32_t v = 0; v < t->mesh.vertex_count; v++) {
		t->joints[4 * v + 1] = 1;
		t->weights[4 * v] = t->mesh.positions[3 * v + 1] > 0 ? 1 : 0;
		t->weights[4 * v + 1] = 1 - t->weights[4 * v];
	}
	t->def.deforms = true;
	t->def.joints = t->joints;
	t->def.joint_weights = t->weights;
	t->def.joint_count = 2;
}

static void make_thing(kind kind, thing *t)
{
	static const float lower[3] = {-.2f, -.2f, -.2f}, upper[3] = {.2f, .3f, .2f};
	const bool round = kind == BALL || kind == SMOOTH || kind == SCAN || kind == SKIN;
	*t = (thing){.materials = {{{.6f, .5f, .4f}, {0}}, {{.1f, .2f, .3f}, {kind == BLANK ? 3 : 0, 0, 1}}},
		     .specular = {{{0}, {0}, 0}, {{.5f, .5f, .5f}, {0}, 0}}};
	assert_true(round ? shape_sphere(.2f, 1, &t->mesh) : shape_box(lower, upper, 1, false, &t->mesh));
	assert_in_range(t->mesh.index_count, 1, MOST_CORNERS);
	for (uint32_t f = 0; f < t->mesh.face_count; f++)
		t->face_materials[f] = f == 2;
	for (uint32_t k = 0; k < 2 * t->mesh.index_count; k++)
		t->uvs[k] = (float)(k % 7);
	t->def = scene_mesh_def(&t->mesh);
	t->def.name = NAMES[kind];
	t->def.face_materials = t->face_materials;
	t->def.materials = t->materials;
	t->def.material_count = 2;
	t->def.levels = kind == SPLIT ? 0 : 1;
	t->def.leaf_size = kind == SPLIT ? .25f : 0;
	t->def.scheme = kind == SMOOTH || kind == SKIN ? GI_SCHEME_CATMULL_CLARK : GI_SCHEME_BILINEAR;
	t->def.specular = kind == SPLIT ? t->specular : NULL;
	t->def.double_sided = kind == SIDES;
	t->def.subsurface = kind == MARBLE ? &MARBLE_MEDIUM : NULL;
	t->def.uvs = kind == TEXTURE ? t->uvs : NULL;
	t->def.leaf_materials = kind == TEXTURE;
	t->def.undrawn = kind == BLANK;
	t->def.mobility = kind == FIXED ? GI_MOBILITY_STATIC : GI_MOBILITY_AUTOMATIC;
	memcpy(t->def.scale, (float[]){1, kind == BALL ? 1.4f : 1, 1}, sizeof t->def.scale);
	if (kind == SCAN)
		make_scan(t);
	if (kind == SKIN)
		make_skin(t);
}

static void free_thing(thing *t)
{
	engine_mesh_free(&t->mesh);
	engine_mesh_free(&t->drawn);
}

/* ---- two contexts alike ---- */

static gi_context_def coarse_def(void)
{
	gi_context_def def = harness_def();
	def.row_tolerance = .1f;
	def.caustic_photons = 64;
	def.fine_shadows = true;
	return def;
}

static gi_context *open_room(const gi_context_def *def)
{
	gi_context *gi = harness_context(def);
	engine_mesh mesh;
	assert_true(shape_box((float[]){-2, 0, -2}, (float[]){2, 2.5f, 2}, 2, true, &mesh));
	harness_add(gi, &(harness_object){.name = "room", .rho = {.5f, .5f, .5f}}, &mesh);
	assert_true(shape_quad((float[]){-.5f, 2.4f, -.5f}, (float[]){1, 0, 0}, (float[]){0, 0, 1}, 1, 1, &mesh));
	harness_add(gi, &(harness_object){.name = "lamp", .exitance = {20, 20, 20}}, &mesh);
	return gi;
}

static gi_pose pose_of(uint32_t number)
{
	const float turn = .3f * (float)number;
	return (gi_pose){{.75f * (float)(number % 5) - 1.5f, .5f + .07f * (float)(number % 3),
			  .75f * (float)(number / 5 % 5) - 1.5f},
			 {0, sinf(turn), 0, cosf(turn)}};
}

static void compare(gi_context *a, gi_context *b, const char *what)
{
	static target left, right;
	snapshot x = snapshot_take(a), y = snapshot_take(b);
	gi_view view = gi_view_default();
	assert_int_equal(x.leaf_count, y.leaf_count);
	snapshot_expect_same_rows(&x, &y, what);
	for (uint32_t k = 0; k < x.leaf_count; k++) {
		x.leaves[k].object = y.leaves[k].object; /* each context's own */
		if (memcmp(&x.leaves[k], &y.leaves[k], sizeof x.leaves[k]) != 0)
			fail_msg("%s: leaf %u is another", what, k);
	}
	look_at((float[]){1.9f, 2.2f, 1.9f}, (float[]){-.2f, .6f, -.1f}, 75, 1, view.view_from_world,
		view.clip_from_view);
	left = target_make(SIZE);
	right = target_make(SIZE);
	for (gi_overlay overlay = GI_OVERLAY_NONE; overlay <= GI_OVERLAY_WIREFRAME; overlay++) {
		view.overlay = overlay;
		target_draw(&left, a, view);
		target_draw(&right, b, view);
		if (memcmp(left.pixels, right.pixels, sizeof(float) * 4 * SIZE * SIZE) != 0)
			fail_msg("%s: the picture is another", what);
	}
	printf("  %s: %u leaves, %llu entries, the same bits\n", what, x.leaf_count, (unsigned long long)x.entry_count);
	target_free(&left);
	target_free(&right);
	snapshot_free(&x);
	snapshot_free(&y);
}

enum { COPIES = 3, COUNT = KINDS * COPIES };

/* The same objects in the same order: in the first context each for itself, in the second instances of instances. */
typedef struct pair {
	gi_context *gi[2];
	gi_object objects[2][COUNT];
} pair;

static void create_pair(pair *p, const gi_context_def *def)
{
	p->gi[0] = open_room(def);
	p->gi[1] = open_room(def);
	for (uint32_t k = 0; k < COUNT; k++) {
		thing t;
		make_thing((kind)(k % KINDS), &t);
		t.def.pose = pose_of(k);
		assert_gi(gi_create_object(p->gi[0], &t.def, &p->objects[0][k]));
		if (k < KINDS)
			assert_gi(gi_create_object(p->gi[1], &t.def, &p->objects[1][k]));
		else
			assert_gi(
			    gi_create_instance(p->gi[1], p->objects[1][k - KINDS], t.def.pose, &p->objects[1][k]));
		free_thing(&t);
	}
}

static void settle(pair *p, bool commits, const char *what)
{
	for (int side = 0; side < 2; side++) {
		if (commits)
			assert_gi(gi_commit(p->gi[side]));
		harness_update(p->gi[side]);
	}
	compare(p->gi[0], p->gi[1], what);
}

static void free_pair(pair *p)
{
	for (int side = 0; side < 2; side++)
		gi_context_destroy(p->gi[side]);
}

static void bend(gi_context *gi, gi_object skin, float shift)
{
	const float joints[32] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, shift, 0, 0, 1,
				  1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,     0, 0, 1};
	assert_gi(gi_set_joints(gi, skin, joints, 2));
}

/* Each its own values: of one of them, between two others. */
static void change_one_of_each(pair *p)
{
	const gi_material red = {{.7f, .1f, .1f}, {0, 0, 0}}, lamp = {{.1f, .1f, .1f}, {2, 1, 0}};
	const gi_specular mirror = {{.3f, .3f, .3f}, {0}, 0};
	for (int side = 0; side < 2; side++) {
		gi_context *gi = p->gi[side];
		const gi_object *o = p->objects[side] + KINDS;
		for (uint32_t k = 0; k < KINDS; k++)
			assert_gi(gi_set_material(gi, o[k], 0, k % 2 ? red : lamp));
		assert_gi(gi_set_specular(gi, o[SPLIT], 0, mirror));
		assert_gi(gi_set_leaf_materials(gi, o[TEXTURE], 3, 1, &lamp));
		assert_gi(gi_set_pose(gi, o[BALL], pose_of(24)));
		assert_gi(gi_set_hidden(gi, o[SMOOTH], true));
		bend(gi, o[SKIN], .15f);
	}
}

/* The scan of each set of objects has textures from one on. */
static void show_textures(pair *p, uint32_t texture, int copies)
{
	gi_textures t = gi_textures_default();
	t.base_color = texture;
	for (int side = 0; side < 2; side++)
		for (int k = 0; k < copies; k++)
			assert_gi(gi_set_textures(p->gi[side], p->objects[side][k * KINDS + SCAN], 0, &t));
}

static GLuint make_texture(void)
{
	static const float texels[4][4] = {
	    {.1f, .2f, .7f, 1}, {.7f, .2f, .1f, 1}, {.3f, .8f, .1f, 1}, {.5f, .5f, .5f, 1}};
	GLuint name;
	glCreateTextures(GL_TEXTURE_2D, 1, &name);
	glTextureStorage2D(name, 1, GL_RGBA32F, 2, 2);
	glTextureSubImage2D(name, 0, 0, 0, 2, 2, GL_RGBA, GL_FLOAT, texels);
	glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	return name;
}

/* Of those that lie in the mesh of the picture once, some have textures. */
static void as_created_with_textures(void **state)
{
	(void)state;
	static pair p;
	const gi_context_def def = coarse_def();
	const GLuint texture = make_texture();
	create_pair(&p, &def);
	settle(&p, true, "no textures so far");
	for (int copies = 1; copies <= COPIES; copies++) {
		show_textures(&p, texture, copies);
		compare(p.gi[0], p.gi[1], "textures");
	}
	free_pair(&p);
	glDeleteTextures(1, &texture);
}

static void as_created(void **state)
{
	(void)state;
	pair p;
	const gi_context_def def = coarse_def();
	create_pair(&p, &def);
	settle(&p, true, "created");
	change_one_of_each(&p);
	settle(&p, false, "one of each has other values");
	gi_invalidate(p.gi[0]);
	gi_invalidate(p.gi[1]);
	settle(&p, true, "taken in and built anew");
	free_pair(&p);
}

/* First, last, between; before a commit and after. */
static void go_in_any_order(void **state)
{
	(void)state;
	pair p;
	const gi_context_def def = coarse_def();
	create_pair(&p, &def);
	for (int side = 0; side < 2; side++)
		for (uint32_t k = 0; k < KINDS; k += 3)
			assert_gi(gi_destroy_object(p.gi[side], p.objects[side][k]));
	settle(&p, true, "some of the first went before the commit");
	for (int side = 0; side < 2; side++)
		for (uint32_t k = 1; k < COUNT; k += 2)
			if (gi_object_is_valid(p.gi[side], p.objects[side][k]))
				assert_gi(gi_destroy_object(p.gi[side], p.objects[side][k]));
	settle(&p, false, "every other one went");
	settle(&p, true, "and its place");
	free_pair(&p);
}

/* ---- what it begins with ---- */

/* Values of now, those of the definition gone; and a shape of its own from then on. */
static void present_values(void **state)
{
	(void)state;
	thing t;
	gi_object first, second;
	gi_pose pose;
	gi_mobility mobility;
	gi_material material;
	bool hidden;
	const gi_material blue = {{.1f, .1f, .9f}, {1, 2, 3}};
	const gi_context_def def = coarse_def();
	gi_context *a = open_room(&def), *b = open_room(&def);
	make_thing(SKIN, &t);
	assert_gi(gi_create_object(a, &t.def, &first));
	assert_gi(gi_commit(a));
	harness_update(a);
	assert_gi(gi_set_material(a, first, 1, blue));
	assert_gi(gi_set_scale(a, first, (float[]){1, 2, 1}));
	bend(a, first, .1f);
	harness_update(a);
	bend(a, first, .2f); /* which no update took */
	assert_gi(gi_set_hidden(a, first, true));
	assert_gi(gi_create_instance(a, first, pose_of(7), &second));
	bend(a, first, .3f);
	assert_gi(gi_destroy_object(a, first));
	assert_gi(gi_get_hidden(a, second, &hidden));
	assert_false(hidden);
	assert_gi(gi_get_mobility(a, second, &mobility));
	assert_int_equal(mobility, GI_MOBILITY_MOVABLE);
	assert_int_equal(gi_material_count(a, second), 2);
	assert_gi(gi_get_material(a, second, 1, &material));
	assert_memory_equal(&material, &blue, sizeof blue);
	assert_gi(gi_get_pose(a, second, &pose));
	assert_memory_equal(pose.position, pose_of(7).position, sizeof pose.position);
	assert_gi(gi_commit(a));
	harness_update(a);
	/* The same by itself, with a place before it that was given away. */
	assert_gi(gi_create_object(b, &t.def, &first));
	assert_gi(gi_create_object(b, &t.def, &second));
	assert_gi(gi_destroy_object(b, first));
	assert_gi(gi_set_pose(b, second, pose_of(7)));
	assert_gi(gi_set_material(b, second, 1, blue));
	assert_gi(gi_set_scale(b, second, (float[]){1, 2, 1}));
	bend(b, second, .2f);
	assert_gi(gi_commit(b));
	harness_update(b);
	gi_reset_radiosity(a);
	gi_reset_radiosity(b);
	harness_update(a);
	harness_update(b);
	compare(a, b, "an instance of a shape of now");
	free_thing(&t);
	gi_context_destroy(a);
	gi_context_destroy(b);
}

/* What else a host asks of an object. */
static void same_answers(void **state)
{
	(void)state;
	enum { POINTS = 24 };
	const gi_context_def def = coarse_def();
	gi_context *gi = open_room(&def);
	for (kind kind = 0; kind < KINDS; kind++) {
		static gi_leaf_uvs uvs[2][1024];
		gi_vertex_light map[2][POINTS] = {{{{0}, {0}}}};
		uint32_t count[2] = {0};
		gi_object objects[2];
		thing t;
		make_thing(kind, &t);
		const uint32_t points = t.mesh.vertex_count < POINTS ? t.mesh.vertex_count : POINTS;
		assert_gi(gi_create_object(gi, &t.def, &objects[0]));
		assert_gi(gi_create_instance(gi, objects[0], pose_of(kind), &objects[1]));
		for (int k = 0; k < 2; k++) {
			assert_gi(gi_map_vertices(gi, objects[k], t.mesh.positions, NULL, points, map[k]));
			if (kind == TEXTURE)
				assert_gi(gi_get_leaf_uvs(gi, objects[k], uvs[k], 1024, &count[k]));
			else
				assert_int_equal(gi_get_leaf_uvs(gi, objects[k], uvs[k], 1024, &count[k]),
						 GI_ERROR_INVALID_ARGUMENT);
		}
		assert_memory_equal(map[0], map[1], sizeof map[0]);
		assert_int_equal(count[0], count[1]);
		assert_memory_equal(uvs[0], uvs[1], sizeof uvs[0]);
		free_thing(&t);
	}
	gi_context_destroy(gi);
}

static void misuse(void **state)
{
	(void)state;
	thing t;
	const gi_context_def def = coarse_def();
	gi_context *gi = open_room(&def), *other = open_room(&def);
	gi_object ball, none = {0}, out = {1, 2, 3};
	gi_pose pose = gi_pose_identity(), broken = pose;
	broken.rotation[3] = 0;
	make_thing(BALL, &t);
	assert_gi(gi_create_object(gi, &t.def, &ball));
	assert_int_equal(gi_create_instance(NULL, ball, pose, &out), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(out.index1, 0);
	assert_int_equal(gi_create_instance(gi, ball, pose, NULL), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_create_instance(gi, none, pose, &out), GI_ERROR_INVALID_HANDLE);
	assert_int_equal(gi_create_instance(other, ball, pose, &out), GI_ERROR_INVALID_HANDLE);
	assert_int_equal(gi_create_instance(gi, ball, broken, &out), GI_ERROR_INVALID_POSE);
	assert_int_equal(out.index1, 0);
	/* Its own handle may be where the first one was. */
	const gi_object first = ball;
	assert_gi(gi_create_instance(gi, ball, pose, &ball));
	assert_true(gi_object_is_valid(gi, first) && gi_object_is_valid(gi, ball));
	assert_gi(gi_destroy_object(gi, first));
	assert_int_equal(gi_create_instance(gi, first, pose, &out), GI_ERROR_INVALID_HANDLE);
	assert_gi(gi_create_instance(gi, ball, pose, &out));
	assert_int_equal(out.index1, first.index1);
	free_thing(&t);
	gi_context_destroy(gi);
	gi_context_destroy(other);
}

/* ---- what it takes ---- */

static void memory_is_shared(void **state)
{
	(void)state;
	enum { MANY = 64 };
	gi_context_def def = coarse_def();
	faults_in(&def);
	gi_context *gi = open_room(&def);
	static gi_object objects[MANY];
	for (kind kind = 0; kind < KINDS; kind++) {
		thing t;
		make_thing(kind, &t);
		const int64_t before = faults_memory_now().bytes;
		assert_gi(gi_create_object(gi, &t.def, &objects[0]));
		const int64_t one = faults_memory_now().bytes - before;
		for (int k = 1; k < MANY; k++)
			assert_gi(gi_create_instance(gi, objects[0], pose_of((uint32_t)k), &objects[k]));
		const int64_t each = (faults_memory_now().bytes - before - one) / (MANY - 1);
		printf("  %-7s %7lld bytes, an instance %6lld\n", NAMES[kind], (long long)one, (long long)each);
		/* Its place in the list of objects, which grows by twice; a shape, or values of leaves, of its own. */
		if (kind != SKIN && kind != TEXTURE)
			assert_true(each < 2500);
		else
			assert_true(each < one);
		for (int k = 0; k < MANY; k++)
			assert_gi(gi_destroy_object(gi, objects[k]));
		free_thing(&t);
	}
	gi_context_destroy(gi);
	assert_int_equal(faults_memory_now().blocks, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(as_created_with_textures),
	    cmocka_unit_test(as_created),
	    cmocka_unit_test(go_in_any_order),
	    cmocka_unit_test(present_values),
	    cmocka_unit_test(same_answers),
	    cmocka_unit_test(misuse),
	    cmocka_unit_test(memory_is_shared),
	};
	return cmocka_run_group_tests_name("instances", tests, harness_open, harness_close);
}
