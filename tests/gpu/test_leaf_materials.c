/* Leaves with materials of their own, as textures give them: where leaves lie in a texture, and the light of a
 * checkerboard and of a screen against paths and against scenes made at once. */
#include "snapshot.h"

#include "scenes/body.h"
#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void *allocate(size_t count, size_t size)
{
	void *data = calloc(count + 1, size);
	assert_non_null(data);
	return data;
}

/* ---- where leaves lie ---- */

/* Texture coordinates that are places: u = 3 x + 1, v = 2 z - y. */
static void place_uv(const float p[3], float uv[2])
{
	uv[0] = 3 * p[0] + 1;
	uv[1] = 2 * p[2] - p[1];
}

static float *place_uvs(const engine_mesh *mesh)
{
	float *uvs = allocate(2 * (size_t)mesh->index_count, sizeof *uvs);
	for (uint32_t k = 0; k < mesh->index_count; k++)
		place_uv(mesh->positions + 3 * mesh->indices[k], uvs + 2 * k);
	return uvs;
}

typedef struct kind {
	const char *name;
	gi_scheme scheme;
	uint32_t levels;
	float leaf_size;
	bool triangles, double_sided, twice; /* twice: a face is there twice */
} kind;

static bool is_inner(const gi_leaf *leaf)
{
	bool inner = true;
	for (int c = 0; c < 4; c++)
		inner = inner && fabsf(leaf->corners[c][0] - 1) < .4f && fabsf(leaf->corners[c][2] - 1) < .4f;
	return inner;
}

static void expect_places(const kind *k)
{
	gi_context_def context_def = harness_def();
	context_def.row_tolerance = .5f;
	gi_context *gi = harness_context(&context_def);
	engine_mesh mesh;
	assert_true(shape_quad((float[]){0, .5f, 0}, (float[]){0, 0, 2}, (float[]){2, -.5f, 0}, 3, 3, &mesh));
	if (k->triangles)
		harness_cut_quads(&mesh);
	if (k->twice) /* the second face is the first again */
		memcpy(mesh.indices + mesh.face_counts[0], mesh.indices, sizeof(uint32_t) * mesh.face_counts[0]);
	float *uvs = place_uvs(&mesh);
	gi_object_def def = scene_mesh_def(&mesh);
	def.name = k->name;
	def.scheme = k->scheme;
	def.levels = k->levels;
	def.leaf_size = k->leaf_size;
	def.double_sided = k->double_sided;
	def.uvs = uvs;
	gi_object object;
	assert_gi(gi_create_object(gi, &def, &object));
	assert_gi(gi_commit(gi));
	harness_update(gi);
	uint32_t count, leaf_count;
	assert_gi(gi_get_leaf_uvs(gi, object, NULL, 0, &count));
	assert_gi(gi_read_leaves(gi, NULL, 0, &leaf_count));
	assert_int_equal(count, leaf_count);
	gi_leaf_uvs *found = allocate(count, sizeof *found);
	gi_leaf *leaves = allocate(count, sizeof *leaves);
	assert_gi(gi_get_leaf_uvs(gi, object, found, count, &count));
	assert_gi(gi_read_leaves(gi, leaves, count, &count));
	uint32_t compared = 0;
	for (uint32_t leaf = 0; leaf < count; leaf++) {
		/* Loop rounds those corners of the square where two triangles meet. */
		if (k->scheme == GI_SCHEME_LOOP && !is_inner(&leaves[leaf]))
			continue;
		compared++;
		assert_true(found[leaf].face < mesh.face_count && !(k->twice && found[leaf].face == 1));
		for (int c = 0; c < 4; c++) {
			float wanted[2];
			place_uv(leaves[leaf].corners[c], wanted);
			for (int i = 0; i < 2; i++)
				if (fabsf(found[leaf].uvs[c][i] - wanted[i]) > 1e-5f)
					fail_msg("%s: leaf %u, corner %d: %g is not %g", k->name, leaf, c,
						 (double)found[leaf].uvs[c][i], (double)wanted[i]);
		}
	}
	assert_true(compared > 0);
	free(found);
	free(leaves);
	free(uvs);
	engine_mesh_free(&mesh);
	gi_context_destroy(gi);
}

static void places(void **state)
{
	(void)state;
	static const kind kinds[] = {
	    {.name = "plain"},
	    {.name = "levels", .levels = 2},
	    {.name = "leaf size", .leaf_size = .21f},
	    {.name = "triangles", .levels = 1, .triangles = true},
	    {.name = "triangles by size", .leaf_size = .3f, .triangles = true},
	    {.name = "Catmull-Clark", .levels = 2, .scheme = GI_SCHEME_CATMULL_CLARK},
	    {.name = "Loop", .levels = 2, .scheme = GI_SCHEME_LOOP, .triangles = true},
	    {.name = "two sides", .leaf_size = .3f, .double_sided = true},
	    {.name = "two smooth sides", .levels = 1, .scheme = GI_SCHEME_CATMULL_CLARK, .double_sided = true},
	    {.name = "a face twice", .leaf_size = .3f, .twice = true},
	};
	for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
		expect_places(&kinds[k]);
}

/* A line, a triangle as a quad, an arrowhead and a square, apart from each other in x. */
static const float ODD_PLACES[11][3] = {{0, 0, 0},     {0, 0, 1}, {1, 0, 0}, {2, 0, 0}, {2.5f, 0, .2f}, {3, 0, 0},
					{2.5f, 0, -1}, {4, 0, 0}, {4, 0, 1}, {5, 0, 1}, {5, 0, 0}};
static const uint32_t ODD_FACES[4][4] = {{0, 0, 1, 1}, {0, 1, 2, 2}, {3, 4, 5, 6}, {7, 8, 9, 10}};

static gi_context *open_odd(const kind *k, const float *uvs, gi_object *out)
{
	gi_context_def context_def = harness_def();
	gi_context *gi = harness_context(&context_def);
	gi_object_def def = gi_object_def_default();
	def.name = k->name;
	def.positions = ODD_PLACES[0];
	def.vertex_count = 11;
	def.indices = ODD_FACES[0];
	def.index_count = 16;
	def.face_count = 4;
	def.scheme = k->scheme;
	def.levels = k->levels;
	def.leaf_size = k->leaf_size;
	def.double_sided = k->double_sided;
	def.uvs = uvs;
	if (gi_create_object(gi, &def, out))
		fail_msg("%s: %s", k->name, harness_last_message());
	assert_gi(gi_commit(gi));
	harness_update(gi);
	return gi;
}

enum { ODD_LEAVES = 256 };

static void expect_odd_faces(const kind *k)
{
	static gi_leaf_uvs found[ODD_LEAVES];
	static gi_leaf leaves[ODD_LEAVES];
	float uvs[16][2];
	uint32_t count, met[4] = {0};
	gi_object object;
	for (int c = 0; c < 16; c++)
		place_uv(ODD_PLACES[ODD_FACES[c / 4][c % 4]], uvs[c]);
	gi_context *gi = open_odd(k, uvs[0], &object);
	assert_gi(gi_get_leaf_uvs(gi, object, found, ODD_LEAVES, &count));
	assert_gi(gi_read_leaves(gi, leaves, ODD_LEAVES, &count));
	assert_in_range(count, 3, ODD_LEAVES);
	for (uint32_t leaf = 0; leaf < count; leaf++) {
		const float(*at)[3] = leaves[leaf].corners, x = .25f * (at[0][0] + at[1][0] + at[2][0] + at[3][0]);
		const uint32_t face = x < 1.5f ? 1 : x < 3.5f ? 2 : 3;
		met[face]++;
		if (found[leaf].face != face)
			fail_msg("%s: leaf %u lies on face %u, not %u", k->name, leaf, face, found[leaf].face);
		for (int c = 0; c < 4; c++) {
			float wanted[2];
			place_uv(leaves[leaf].corners[c], wanted);
			for (int i = 0; i < 2; i++)
				if (fabsf(found[leaf].uvs[c][i] - wanted[i]) > 1e-5f)
					fail_msg("%s: leaf %u of face %u, corner %d: %g is not %g", k->name, leaf, face,
						 c, (double)found[leaf].uvs[c][i], (double)wanted[i]);
		}
	}
	assert_true(met[1] && met[2] && met[3]);
	gi_context_destroy(gi);
}

/* Refining leaves faces without area out, takes what is written as a quad as the triangle it is and cuts notches. */
static void odd_faces(void **state)
{
	(void)state;
	static const kind kinds[] = {
	    {.name = "odd"},
	    {.name = "odd, levels", .levels = 1},
	    {.name = "odd, by size", .leaf_size = .3f},
	    {.name = "odd sides", .levels = 1, .double_sided = true},
	    {.name = "odd, smooth", .levels = 1, .scheme = GI_SCHEME_CATMULL_CLARK},
	    {.name = "odd smooth sides", .levels = 1, .scheme = GI_SCHEME_CATMULL_CLARK, .double_sided = true},
	};
	for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
		expect_odd_faces(&kinds[k]);
}

/* In a texture a face may cross itself, or be a point. */
static void odd_coordinates(void **state)
{
	(void)state;
	static const kind smooth = {.name = "crossed", .levels = 1, .scheme = GI_SCHEME_CATMULL_CLARK};
	static const float crossed[4][4][2] = {{{0}},
					       {{0, 0}, {1, 0}, {0, 1}, {9, 9}},
					       {{.5f, .5f}, {.5f, .5f}, {.5f, .5f}, {.5f, .5f}},
					       {{0, 0}, {1, 1}, {1, 0}, {0, 1}}};
	static gi_leaf_uvs found[ODD_LEAVES];
	uint32_t count;
	gi_object object;
	gi_context *gi = open_odd(&smooth, crossed[0][0], &object);
	assert_gi(gi_get_leaf_uvs(gi, object, found, ODD_LEAVES, &count));
	assert_int_equal(count, 3 + 4 + 4);
	for (uint32_t leaf = 0; leaf < count; leaf++) {
		const float middle = found[leaf].face == 1 ? 1.f / 3 : .5f;
		bool reaches = false;
		for (int c = 0; c < 4; c++)
			reaches = reaches || (fabsf(found[leaf].uvs[c][0] - middle) < 1e-6f &&
					      fabsf(found[leaf].uvs[c][1] - middle) < 1e-6f);
		if (!reaches)
			fail_msg("leaf %u does not reach the middle of face %u", leaf, found[leaf].face);
	}
	gi_context_destroy(gi);
}

/* ---- light ---- */

static const float WHITE[3] = {.8f, .8f, .8f}, LAMP[3] = {10, 10, 10}, BLACK[3] = {0, 0, 0};

typedef struct room {
	gi_context *gi;
	gi_object patterned;
	uint32_t count; /* its leaves */
} room;

static void add(gi_context *gi, const char *name, engine_mesh *mesh, const float *rho, const float *exitance)
{
	const scene_body body = {.name = name, .rho = rho, .exitance = exitance};
	gi_object out;
	assert_gi(scene_add_body(gi, &body, mesh, &out));
}

/* A wall on a floor, below a lamp or not; the floor, or the wall, has a pattern. One primitive to rays. */
static room open_room(bool screen)
{
	gi_context_def def = harness_def();
	def.row_tolerance = .01f;
	def.solve_tolerance = 1e-3f;
	def.sky = GI_SKY_ON;
	room r = {.gi = harness_context(&def)};
	engine_mesh mesh;
	assert_true(shape_quad((float[]){0, 0, 0}, (float[]){0, 0, 1}, (float[]){1, 0, 0}, 1, 1, &mesh));
	gi_object_def object = scene_mesh_def(&mesh);
	const gi_material plain = {.rho = {.5f, .5f, .5f}};
	object.name = "patterned";
	object.leaf_size = .125f;
	object.leaf_materials = true;
	object.materials = &plain;
	object.material_count = 1;
	assert_gi(gi_create_object(r.gi, &object, &r.patterned));
	engine_mesh_free(&mesh);
	assert_true(shape_quad((float[]){0, 0, 0}, (float[]){0, 1, 0}, (float[]){0, 0, 1}, 6, 6, &mesh));
	add(r.gi, "wall", &mesh, WHITE, NULL);
	if (!screen) {
		assert_true(
		    shape_quad((float[]){.3f, 1, .3f}, (float[]){.4f, 0, 0}, (float[]){0, 0, .4f}, 2, 2, &mesh));
		add(r.gi, "lamp", &mesh, BLACK, LAMP);
	}
	assert_gi(gi_get_leaf_uvs(r.gi, r.patterned, NULL, 0, &r.count));
	assert_int_equal(gi_material_count(r.gi, r.patterned), r.count);
	return r;
}

/* In the order of leaves, a pattern of two values. */
static gi_material *pattern(const room *r, const gi_material *a, const gi_material *b)
{
	gi_material *values = allocate(r->count, sizeof *values);
	for (uint32_t k = 0; k < r->count; k++)
		values[k] = k / 3 & 1 ? *a : *b;
	return values;
}

static void set(const room *r, const gi_material *values)
{
	assert_gi(gi_set_leaf_materials(r->gi, r->patterned, 0, r->count, values));
}

static void expect_below(const char *what, double value, double limit)
{
	printf("  %s: %.4f (%.4f)\n", what, value, limit);
	if (!(value < limit))
		fail_msg("%s: %g is not below %g", what, value, limit);
}

static double error_against_paths(gi_context *gi, const snapshot *s)
{
	return snapshot_light_error(gi, s, harness_paths(1024));
}

/* The leaves are what they were told to be, and what the wall gets is what paths say. */
static void expect_light(const char *what, bool screen, const gi_material *a, const gi_material *b)
{
	room r = open_room(screen);
	gi_material *values = pattern(&r, a, b);
	set(&r, values);
	assert_gi(gi_commit(r.gi));
	harness_update(r.gi);
	snapshot s = snapshot_take(r.gi);
	for (uint32_t k = 0; k < r.count; k++) {
		assert_memory_equal(s.leaves[k].rho, values[k].rho, sizeof values[k].rho);
		assert_memory_equal(s.leaves[k].exitance, values[k].exitance, sizeof values[k].exitance);
	}
	expect_below(what, error_against_paths(r.gi, &s), .05); /* of leaves this large */
	snapshot_free(&s);
	free(values);
	gi_context_destroy(r.gi);
}

static const gi_material RED = {.rho = {.9f, .1f, .1f}}, GREEN = {.rho = {.1f, .8f, .2f}},
			 BRIGHT = {.rho = {.1f, .1f, .1f}, .exitance = {20, 15, 5}}, DARK = {.rho = {.1f, .1f, .1f}};

static void checkerboard(void **state)
{
	(void)state;
	expect_light("a checkerboard, against paths", false, &RED, &GREEN);
}

static void striped_screen(void **state)
{
	(void)state;
	expect_light("a striped screen, against paths", true, &BRIGHT, &DARK);
}

/* ---- changes ---- */

static void expect_as_created(const room *r, bool screen, const gi_material *values, const char *what)
{
	room other = open_room(screen);
	set(&other, values);
	assert_gi(gi_commit(other.gi));
	harness_update(other.gi);
	snapshot a = snapshot_take(r->gi), b = snapshot_take(other.gi);
	snapshot_expect_same_rows(&a, &b, what);
	if (snapshot_hash_radiosity(&a) != snapshot_hash_radiosity(&b))
		fail_msg("%s: B is another", what);
	snapshot_free(&a);
	snapshot_free(&b);
	gi_context_destroy(other.gi);
}

static void changes(void **state)
{
	(void)state;
	const struct {
		const char *what;
		bool screen, rays;
		const gi_material *a, *b;
	} steps[] = {{"a checkerboard", false, false, &RED, &GREEN},
		     {"its colours change places", false, false, &GREEN, &RED},
		     {"stripes light up", true, true, &BRIGHT, &DARK},
		     {"others do", true, true, &DARK, &BRIGHT}};
	room r = {0};
	for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
		if (!r.gi || steps[k].screen != steps[k - 1].screen) {
			gi_context_destroy(r.gi);
			r = open_room(steps[k].screen);
			assert_gi(gi_commit(r.gi));
			harness_update(r.gi);
		}
		gi_material *values = pattern(&r, steps[k].a, steps[k].b);
		set(&r, values);
		gi_reset_radiosity(r.gi);
		const gi_report report = harness_update(r.gi);
		printf("  %s: %llu rays\n", steps[k].what, (unsigned long long)report.rays);
		assert_true((report.rays > 0) == steps[k].rays);
		expect_as_created(&r, steps[k].screen, values, steps[k].what);
		set(&r, values); /* the same again is nothing */
		assert_int_equal(harness_update(r.gi).outcome, GI_OUTCOME_AT_REST);
		free(values);
	}
	gi_context_destroy(r.gi);
}

/* ---- what is refused ---- */

static void refused(void **state)
{
	(void)state;
	room r = open_room(false);
	const gi_material fine = {.rho = {.5f, .5f, .5f}}, white = {.rho = {1, 1, 1}};
	gi_material two[2] = {fine, white}, got;
	gi_leaf_uvs uvs;
	uint32_t count;
	gi_object plain;
	engine_mesh mesh;
	assert_true(shape_quad((float[]){0, 3, 0}, (float[]){0, 0, 1}, (float[]){1, 0, 0}, 1, 1, &mesh));
	const scene_body body = {.name = "plain", .rho = WHITE};
	assert_gi(scene_add_body(r.gi, &body, &mesh, &plain));
	assert_int_equal(gi_set_leaf_materials(r.gi, plain, 0, 1, &fine), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_get_leaf_uvs(r.gi, plain, &uvs, 1, &count), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_set_leaf_materials(r.gi, (gi_object){0}, 0, 1, &fine), GI_ERROR_INVALID_HANDLE);
	assert_int_equal(gi_get_leaf_uvs(r.gi, (gi_object){0}, &uvs, 1, &count), GI_ERROR_INVALID_HANDLE);
	assert_int_equal(gi_set_leaf_materials(r.gi, r.patterned, r.count, 1, &fine), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_set_leaf_materials(r.gi, r.patterned, 1, r.count, &fine), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_set_leaf_materials(r.gi, r.patterned, 0, 1, NULL), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_set_leaf_materials(r.gi, r.patterned, 0, 2, two), GI_ERROR_INVALID_MATERIAL);
	assert_gi(gi_get_material(r.gi, r.patterned, 0, &got)); /* nothing was set */
	assert_memory_equal(&got, &fine, sizeof got);
	assert_gi(gi_set_leaf_materials(r.gi, r.patterned, r.count, 0, NULL));
	gi_context_destroy(r.gi);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(places),          cmocka_unit_test(checkerboard), cmocka_unit_test(striped_screen),
	    cmocka_unit_test(changes),         cmocka_unit_test(refused),      cmocka_unit_test(odd_faces),
	    cmocka_unit_test(odd_coordinates),
	};
	return cmocka_run_group_tests(tests, harness_open, harness_close);
}
