/* Textures in the picture: texels under known light against closed forms, whatever the cage, the light that is added
 * pixel by pixel and what draws them; what is refused, and what is given back.
 */
#include "faults.h"
#include "snapshot.h"
#include "target.h"

#include "scenes/body.h"
#include "scenes/shapes.h"

#include <glad/gl.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const float PI = 3.14159265f;

enum { SIZE = 32, PIXEL_BYTES = 4 * SIZE * SIZE * sizeof(float) };

/* All that the sky gives, W/m2: a plate below it that sees nothing else receives as much. */
static const float SKY[3] = {2, 3, 5};

/* Two texels side by side, and their coverage. */
static const float TEXELS[2][4] = {{.2f, .4f, .6f, 1}, {.8f, .1f, .3f, .25f}};

/* ---- the host's OpenGL ---- */

static GLuint make_texture(GLenum format, GLsizei width, GLsizei height, const void *texels, GLenum filter, GLenum wrap)
{
	GLuint name;
	glCreateTextures(GL_TEXTURE_2D, 1, &name);
	glTextureStorage2D(name, 1, format, width, height);
	glTextureSubImage2D(name, 0, 0, 0, width, height, GL_RGBA, format == GL_RGBA32F ? GL_FLOAT : GL_UNSIGNED_BYTE,
			    texels);
	glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, (GLint)filter);
	glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, (GLint)filter);
	glTextureParameteri(name, GL_TEXTURE_WRAP_S, (GLint)wrap);
	glTextureParameteri(name, GL_TEXTURE_WRAP_T, (GLint)wrap);
	return name;
}

static GLuint two_texels(void)
{
	return make_texture(GL_RGBA32F, 2, 1, TEXELS, GL_NEAREST, GL_CLAMP_TO_EDGE);
}

static target picture;

/* Of a pixel, columns from the left and rows from below: r g b a. */
static const float *pixel_at(int i, int j)
{
	return picture.pixels + 4 * (j * SIZE + i);
}

static gi_result try_to_draw(gi_context *gi, const gi_view *view)
{
	if (!picture.framebuffer)
		picture = target_make(SIZE);
	const gi_result result = target_try(&picture, gi, *view);
	assert_int_equal(glGetError(), GL_NO_ERROR);
	return result;
}

static void draw_mode(gi_context *gi, gi_mode mode)
{
	gi_view view = target_look_down(SIZE);
	view.mode = mode;
	assert_gi(try_to_draw(gi, &view));
}

static void draw(gi_context *gi)
{
	draw_mode(gi, GI_MODE_GLOBAL);
}

/* Of the middle of a pixel. */
static void place_of(int i, int j, float p[3])
{
	p[0] = 2 * ((float)i + .5f) / SIZE - 1;
	p[1] = 0;
	p[2] = -(2 * ((float)j + .5f) / SIZE - 1);
}

/* ---- scenes ---- */

/* What lights the plate beside the sky. */
typedef enum lit { BY_SKY, BY_LIGHT, LITS } lit;

static const float LIGHT_AT[3] = {.25f, 1.5f, -.5f}, INTENSITY = 4;

static gi_context *open_scene(lit by)
{
	gi_context_def def = harness_def();
	def.sky = GI_SKY_ON;
	memcpy(def.sky_exitance, SKY, sizeof SKY);
	gi_context *gi = harness_context(&def);
	gi_light_def light = gi_light_def_default();
	gi_light handle;
	memcpy(light.position, LIGHT_AT, sizeof LIGHT_AT);
	light.intensity[0] = light.intensity[1] = light.intensity[2] = INTENSITY;
	if (by == BY_LIGHT)
		assert_gi(gi_create_light(gi, &light, &handle));
	return gi;
}

/* H at a place of the plate y = 0. */
static float irradiance(lit by, const float p[3], int channel)
{
	const float to[3] = {LIGHT_AT[0] - p[0], LIGHT_AT[1] - p[1], LIGHT_AT[2] - p[2]};
	const float square = to[0] * to[0] + to[1] * to[1] + to[2] * to[2];
	return SKY[channel] + (by == BY_LIGHT ? INTENSITY * to[1] / (square * sqrtf(square)) : 0);
}

/* u = x and v = z, both from 0 to 1 over a plate of -1..1. */
static void place_uv(const float p[3], float uv[2])
{
	uv[0] = .5f * p[0] + .5f;
	uv[1] = .5f * p[2] + .5f;
}

static float *place_uvs(const engine_mesh *mesh)
{
	float *uvs = calloc(2 * (size_t)mesh->index_count + 1, sizeof *uvs);
	assert_non_null(uvs);
	for (uint32_t k = 0; k < mesh->index_count; k++)
		place_uv(mesh->positions + 3 * (size_t)mesh->indices[k], uvs + 2 * (size_t)k);
	return uvs;
}

static void make_plate(uint32_t n, engine_mesh *out)
{
	assert_true(shape_quad((float[]){-1, 0, -1}, (float[]){0, 0, 2}, (float[]){2, 0, 0}, n, n, out));
}

typedef struct plate_kind {
	const char *name;
	gi_scheme scheme;
	uint32_t faces, levels;
	float leaf_size;
	bool triangles, polygon, skewed, leaf_materials, double_sided, deforms;
} plate_kind;

static const gi_material GREY = {.rho = {.5f, .5f, .5f}, .exitance = {.1f, .2f, .3f}};

/* One face of eight corners: those of a square and the middles of its edges. */
static void to_polygon(engine_mesh *mesh)
{
	static const uint32_t round[8] = {0, 1, 2, 5, 8, 7, 6, 3}; /* of 3 x 3 vertices */
	assert_true(mesh->vertex_count == 9 && mesh->index_count == 16);
	memcpy(mesh->indices, round, sizeof round);
	mesh->face_counts[0] = mesh->index_count = 8;
	mesh->face_count = 1;
}

static gi_object add_plate(gi_context *gi, const plate_kind *kind)
{
	engine_mesh mesh;
	gi_object object;
	make_plate(kind->faces, &mesh);
	if (kind->triangles)
		harness_cut_quads(&mesh);
	if (kind->polygon)
		to_polygon(&mesh);
	if (kind->skewed) /* faces that are no parallelograms */
		memcpy(mesh.positions + 3 * 4, (float[]){.4f, 0, -.3f}, 3 * sizeof *mesh.positions);
	float *uvs = place_uvs(&mesh);
	gi_object_def def = scene_mesh_def(&mesh);
	def.name = kind->name;
	def.scheme = kind->scheme;
	def.levels = kind->levels;
	def.leaf_size = kind->leaf_size;
	def.leaf_materials = kind->leaf_materials;
	def.double_sided = kind->double_sided;
	def.deforms = kind->deforms;
	def.materials = &GREY;
	def.material_count = 1;
	def.uvs = uvs;
	assert_gi(gi_create_object(gi, &def, &object));
	free(uvs);
	engine_mesh_free(&mesh);
	return object;
}

static const plate_kind PLAIN = {.name = "plate", .faces = 2, .levels = 1};

static void light(gi_context *gi)
{
	assert_gi(gi_commit(gi));
	harness_update(gi);
}

/* ---- what should be seen ---- */

/* The texel at a place in the texture of two, beside which it is clamped. */
static const float *texel_at(float u)
{
	return TEXELS[u >= .5f];
}

static void expect_pixel(const char *name, int i, int j, const float wanted[3], float tolerance)
{
	const float *found = pixel_at(i, j);
	for (int c = 0; c < 3; c++)
		if (!(fabsf(found[c] - wanted[c]) <= tolerance * fmaxf(fabsf(wanted[c]), 1e-3f)))
			fail_msg("%s: pixel %d %d, channel %d: %.8g is not %.8g", name, i, j, c, (double)found[c],
				 (double)wanted[c]);
}

/* Float error, of H too: that of the sky is a sum of form factors. A light's is also that of normals of 16 bits. */
static float tolerance_of(lit by)
{
	return by == BY_LIGHT ? 2e-4f : 2e-5f;
}

/* rho from a texel, and the plate's own E. */
static void expect_texels(const char *name, lit by, float (*u_of)(const float p[3]))
{
	for (int j = 0; j < SIZE; j++)
		for (int i = 0; i < SIZE; i++) {
			float p[3], wanted[3];
			place_of(i, j, p);
			const float *rho = texel_at(u_of(p));
			for (int c = 0; c < 3; c++)
				wanted[c] = (GREY.exitance[c] + rho[c] * irradiance(by, p, c)) / PI;
			expect_pixel(name, i, j, wanted, tolerance_of(by));
		}
}

static float plain_u(const float p[3])
{
	float uv[2];
	place_uv(p, uv);
	return uv[0];
}

static gi_textures base_color(GLuint name)
{
	gi_textures t = gi_textures_default();
	t.base_color = name;
	return t;
}

/* ---- tests ---- */

static void texels_are_lit_as_they_are(void **state)
{
	static const plate_kind kinds[] = {
	    {.name = "one quad", .faces = 1},
	    {.name = "quads, levels", .faces = 2, .levels = 2},
	    {.name = "leaf sizes", .faces = 1, .leaf_size = .3f},
	    {.name = "triangles", .faces = 2, .leaf_size = .4f, .triangles = true},
	    {.name = "polygon", .faces = 2, .polygon = true},
	    {.name = "polygon, leaf sizes", .faces = 2, .polygon = true, .leaf_size = .3f},
	    {.name = "skewed", .faces = 2, .skewed = true},
	    {.name = "skewed, levels", .faces = 2, .levels = 1, .skewed = true},
	    {.name = "skewed, leaf sizes", .faces = 2, .leaf_size = .4f, .skewed = true},
	    {.name = "materials of leaves", .faces = 2, .levels = 1, .leaf_materials = true},
	    {.name = "two sides", .faces = 2, .levels = 1, .double_sided = true},
	    {.name = "Catmull-Clark", .scheme = GI_SCHEME_CATMULL_CLARK, .faces = 2, .levels = 1},
	    {.name = "Loop", .scheme = GI_SCHEME_LOOP, .faces = 4, .levels = 1, .triangles = true},
	    {.name = "deforming", .faces = 2, .levels = 1, .deforms = true},
	};
	(void)state;
	harness_require_context();
	const GLuint texture = two_texels();
	for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
		for (lit by = BY_SKY; by < LITS; by++) {
			gi_context *gi = open_scene(by);
			const gi_object plate = add_plate(gi, &kinds[k]);
			const gi_textures t = base_color(texture);
			light(gi);
			assert_gi(gi_set_textures(gi, plate, 0, &t));
			draw(gi);
			/* Loop draws in the corners of its triangles together. */
			if (kinds[k].scheme != GI_SCHEME_LOOP)
				expect_texels(kinds[k].name, by, plain_u);
			else
				for (int i = 8; i < 24; i++) {
					float p[3], wanted[3];
					place_of(i, 16, p);
					for (int c = 0; c < 3; c++)
						wanted[c] = (GREY.exitance[c] +
							     texel_at(plain_u(p))[c] * irradiance(by, p, c)) /
							    PI;
					expect_pixel("Loop", i, 16, wanted, tolerance_of(by));
				}
			gi_context_destroy(gi);
		}
	glDeleteTextures(1, &texture);
}

/* Linear filters show where in the texture each pixel is: between the middles of two texels it is a ramp. */
static void filters_are_the_textures_own(void **state)
{
	(void)state;
	harness_require_context();
	const float ends[2][4] = {{0, 0, 0, 1}, {1, .5f, .25f, 1}};
	const GLuint texture = make_texture(GL_RGBA32F, 2, 1, ends, GL_LINEAR, GL_CLAMP_TO_EDGE);
	gi_context *gi = open_scene(BY_SKY);
	const gi_object plate = add_plate(gi, &(plate_kind){.name = "ramp", .faces = 1, .leaf_size = .3f});
	gi_textures t = base_color(texture);
	t.base_color_factor[0] = .5f;
	light(gi);
	assert_gi(gi_set_textures(gi, plate, 0, &t));
	draw(gi);
	for (int j = 0; j < SIZE; j++)
		for (int i = 0; i < SIZE; i++) {
			float p[3], wanted[3];
			place_of(i, j, p);
			const float share = fminf(fmaxf(2 * plain_u(p) - .5f, 0), 1);
			for (int c = 0; c < 3; c++)
				wanted[c] = (GREY.exitance[c] + (c ? 1 : .5f) * share * ends[1][c] * SKY[c]) / PI;
			expect_pixel("ramp", i, j, wanted, 1e-3f);
		}
	gi_context_destroy(gi);
	glDeleteTextures(1, &texture);
}

/* Bytes of sRGB become what they mean. */
static void srgb_is_the_formats_business(void **state)
{
	(void)state;
	harness_require_context();
	const uint8_t grey[4] = {188, 128, 64, 255};
	const float meant[3] = {.50289f, .21586f, .051269f};
	const GLuint texture = make_texture(GL_SRGB8_ALPHA8, 1, 1, grey, GL_NEAREST, GL_REPEAT);
	gi_context *gi = open_scene(BY_SKY);
	const gi_object plate = add_plate(gi, &PLAIN);
	const gi_textures t = base_color(texture);
	light(gi);
	assert_gi(gi_set_textures(gi, plate, 0, &t));
	draw(gi);
	float wanted[3];
	for (int c = 0; c < 3; c++)
		wanted[c] = (GREY.exitance[c] + meant[c] * SKY[c]) / PI;
	expect_pixel("sRGB", 16, 16, wanted, 1e-2f); /* llvmpipe is off by up to half a step of the bytes */
	gi_context_destroy(gi);
	glDeleteTextures(1, &texture);
}

static void emissive_textures_shine(void **state)
{
	(void)state;
	harness_require_context();
	const GLuint texture = two_texels();
	for (lit by = BY_SKY; by < LITS; by++) {
		gi_context *gi = open_scene(by);
		const gi_object plate = add_plate(gi, &PLAIN);
		gi_textures t = gi_textures_default();
		t.emissive = texture;
		t.emissive_factor[0] = 10;
		light(gi);
		assert_gi(gi_set_textures(gi, plate, 0, &t));
		for (gi_mode mode = GI_MODE_GLOBAL; mode <= GI_MODE_INDIRECT; mode++) {
			draw_mode(gi, mode);
			for (int i = 0; i < SIZE; i++) {
				float p[3], wanted[3];
				place_of(i, 5, p);
				for (int c = 0; c < 3; c++) {
					const float direct = irradiance(by, p, c) - SKY[c];
					const float h = (mode == GI_MODE_DIRECT ? 0 : SKY[c]) +
							(mode == GI_MODE_INDIRECT ? 0 : direct);
					const float e = (c ? 1 : 10) * texel_at(plain_u(p))[c];
					wanted[c] = ((mode == GI_MODE_INDIRECT ? 0 : e) + GREY.rho[c] * h) / PI;
				}
				expect_pixel("emissive", i, 5, wanted, tolerance_of(by));
			}
		}
		gi_context_destroy(gi);
	}
	glDeleteTextures(1, &texture);
}

static float turned_u(const float p[3])
{
	float uv[2];
	place_uv(p, uv);
	return -uv[1] + .9f;
}

static float wrapped_u(const float p[3])
{
	const float u = 3 * plain_u(p) + .25f;
	return u - floorf(u);
}

static void transforms_and_samplers(void **state)
{
	(void)state;
	harness_require_context();
	const GLuint texture = two_texels();
	GLuint sampler;
	gi_context *gi = open_scene(BY_LIGHT);
	const gi_object plate = add_plate(gi, &PLAIN);
	gi_textures t = base_color(texture);
	light(gi);
	const float turn[2][3] = {{0, -1, .9f}, {1, 0, 0}}, repeat[2][3] = {{3, 0, .25f}, {0, 1, 0}};
	memcpy(t.base_color_transform, turn, sizeof turn);
	assert_gi(gi_set_textures(gi, plate, 0, &t));
	draw(gi);
	expect_texels("turned", BY_LIGHT, turned_u);

	memcpy(t.base_color_transform, repeat, sizeof repeat);
	glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_REPEAT);
	assert_gi(gi_set_textures(gi, plate, 0, &t));
	draw(gi);
	expect_texels("repeated", BY_LIGHT, wrapped_u);

	glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	glCreateSamplers(1, &sampler);
	glSamplerParameteri(sampler, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	glSamplerParameteri(sampler, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	glSamplerParameteri(sampler, GL_TEXTURE_WRAP_S, GL_REPEAT);
	t.base_color_sampler = sampler;
	assert_gi(gi_set_textures(gi, plate, 0, &t));
	draw(gi);
	expect_texels("repeated by a sampler", BY_LIGHT, wrapped_u);
	gi_context_destroy(gi);
	glDeleteSamplers(1, &sampler);
	glDeleteTextures(1, &texture);
}

/* Of two plates the upper one has holes. */
static void what_is_cut_out_is_not_drawn(void **state)
{
	(void)state;
	harness_require_context();
	const GLuint texture = two_texels();
	for (lit by = BY_SKY; by < LITS; by++) {
		gi_context *gi = open_scene(by);
		const gi_object plate = add_plate(gi, &PLAIN);
		gi_textures t = base_color(texture);
		t.alpha_cutoff = .2f;
		t.base_color_factor[3] = .5f; /* of .25 an eighth */
		light(gi);
		assert_gi(gi_set_textures(gi, plate, 0, &t));
		draw(gi);
		for (int i = 0; i < SIZE; i++)
			assert_true((pixel_at(i, 7)[3] > 0) == (i < SIZE / 2));
		t.alpha_cutoff = .1f;
		assert_gi(gi_set_textures(gi, plate, 0, &t));
		draw(gi);
		expect_texels("whole", by, plain_u);
		gi_context_destroy(gi);
	}
	glDeleteTextures(1, &texture);
}

/* A texture goes with its object, wherever that is and whatever its shape. */
static float moved_u(const float p[3])
{
	return plain_u((float[]){p[0] - .5f, 0, p[2]});
}

static float stretched_u(const float p[3])
{
	return plain_u((float[]){p[0] / 2, 0, p[2]});
}

static void textures_move_and_deform(void **state)
{
	(void)state;
	harness_require_context();
	const GLuint texture = two_texels();
	gi_context *gi = open_scene(BY_SKY);
	const gi_object plate = add_plate(gi, &(plate_kind){.name = "cloth", .faces = 2, .levels = 1, .deforms = true});
	const gi_textures t = base_color(texture);
	light(gi);
	assert_gi(gi_set_textures(gi, plate, 0, &t));
	assert_gi(gi_set_pose(gi, plate, (gi_pose){{.5f, 0, 0}, {0, 0, 0, 1}}));
	assert_gi(gi_set_scale(gi, plate, (float[]){1.5f, 1, 1}));
	harness_update(gi);
	draw(gi);
	for (int i = 0; i < SIZE; i++) {
		float p[3], wanted[3];
		place_of(i, 9, p);
		const float u = plain_u((float[]){(p[0] - .5f) / 1.5f, 0, p[2]});
		for (int c = 0; c < 3; c++)
			wanted[c] = (GREY.exitance[c] + texel_at(u)[c] * SKY[c]) / PI;
		expect_pixel("moved and scaled", i, 9, wanted, 2e-5f);
	}
	assert_gi(gi_set_pose(gi, plate, gi_pose_identity()));
	assert_gi(gi_set_scale(gi, plate, (float[]){2, 1, 1}));
	harness_update(gi);
	draw(gi);
	expect_texels("stretched", BY_SKY, stretched_u);
	gi_context_destroy(gi);

	gi = open_scene(BY_SKY);
	const gi_object wide = add_plate(gi, &PLAIN);
	light(gi);
	assert_gi(gi_set_textures(gi, wide, 0, &t));
	assert_gi(gi_set_pose(gi, wide, (gi_pose){{.5f, 0, 0}, {0, 0, 0, 1}}));
	harness_update(gi);
	draw(gi);
	for (int i = SIZE / 2; i < SIZE; i++) {
		float p[3], wanted[3];
		place_of(i, 20, p);
		for (int c = 0; c < 3; c++)
			wanted[c] = (GREY.exitance[c] + texel_at(moved_u(p))[c] * SKY[c]) / PI;
		expect_pixel("moved", i, 20, wanted, 2e-5f);
	}
	gi_context_destroy(gi);
	glDeleteTextures(1, &texture);
}

/* Left and right half of the plate, each with all of the texture, so that the vertices between have two coordinates. */
static void make_halves(engine_mesh *mesh, float **uvs, uint32_t **materials)
{
	make_plate(2, mesh);
	*uvs = calloc(2 * (size_t)mesh->index_count, sizeof **uvs);
	*materials = calloc(mesh->face_count, sizeof **materials);
	assert_true(*uvs && *materials);
	for (uint32_t f = 0; f < mesh->face_count; f++) {
		float middle = 0;
		for (int k = 0; k < 4; k++)
			middle += .25f * mesh->positions[3 * mesh->indices[4 * f + (uint32_t)k]];
		(*materials)[f] = middle > 0;
		for (uint32_t k = 4 * f; k < 4 * f + 4; k++)
			(*uvs)[2 * k] = mesh->positions[3 * mesh->indices[k]] + (middle > 0 ? 0 : 1);
	}
}

static float halves_u(const float p[3])
{
	return p[0] < 0 ? p[0] + 1 : p[0];
}

static void expect_halves(const char *name, lit by, const float *right)
{
	for (int i = 0; i < SIZE; i++) {
		float p[3], wanted[3];
		place_of(i, 11, p);
		const float *rho = p[0] > 0 && right ? right : texel_at(halves_u(p));
		for (int c = 0; c < 3; c++)
			wanted[c] = (GREY.exitance[c] + rho[c] * irradiance(by, p, c)) / PI;
		expect_pixel(name, i, 11, wanted, tolerance_of(by));
	}
}

/* The halves as a cage, or as a mesh that is drawn instead of one quad. */
static gi_object add_halves(gi_context *gi, bool drawn, bool leaf_materials, bool deforms)
{
	engine_mesh mesh, cage;
	float *uvs;
	uint32_t *materials;
	gi_object object;
	const gi_material both[2] = {GREY, GREY};
	make_halves(&mesh, &uvs, &materials);
	make_plate(1, &cage);
	uint32_t triangles[8 * 3], of_triangle[8];
	float triangle_uvs[8 * 3][2];
	for (uint32_t t = 0; t < 8; t++)
		for (uint32_t k = 0; k < 3; k++) {
			const uint32_t corner = 4 * (t / 2) + (t % 2 ? (k ? k + 1 : 0) : k);
			triangles[3 * t + k] = mesh.indices[corner];
			memcpy(triangle_uvs[3 * t + k], uvs + 2 * corner, sizeof *triangle_uvs);
			of_triangle[t] = materials[t / 2];
		}
	gi_object_def def = scene_mesh_def(drawn ? &cage : &mesh);
	def.levels = 1;
	def.materials = both;
	def.material_count = 2;
	def.leaf_materials = leaf_materials;
	def.deforms = deforms;
	if (drawn) {
		def.draw_positions = mesh.positions;
		def.draw_vertex_count = mesh.vertex_count;
		def.draw_indices = triangles;
		def.draw_index_count = 8 * 3;
		def.draw_uvs = triangle_uvs[0];
		def.draw_face_materials = of_triangle;
	} else {
		def.uvs = uvs;
		def.face_materials = materials;
	}
	assert_gi(gi_create_object(gi, &def, &object));
	free(uvs);
	free(materials);
	engine_mesh_free(&mesh);
	engine_mesh_free(&cage);
	return object;
}

static void materials_have_textures_of_their_own(void **state)
{
	(void)state;
	harness_require_context();
	const GLuint texture = two_texels();
	for (int k = 0; k < 4 * LITS; k++) {
		const lit by = k / 4;
		const bool drawn = k & 1, leaf_materials = k & 2;
		gi_context *gi = open_scene(by);
		const gi_object plate = add_halves(gi, drawn, leaf_materials, false);
		const gi_textures t = base_color(texture);
		assert_gi(gi_set_textures(gi, plate, 0, &t)); /* before the commit */
		light(gi);
		draw(gi);
		expect_halves("one half", by, GREY.rho);
		assert_gi(gi_set_textures(gi, plate, 1, &t));
		draw(gi);
		expect_halves("both halves", by, NULL);
		assert_gi(gi_set_textures(gi, plate, 1, NULL));
		draw(gi);
		expect_halves("one half again", by, GREY.rho);
		assert_int_equal(gi_set_textures(gi, plate, 2, &t), GI_ERROR_INVALID_ARGUMENT);
		gi_context_destroy(gi);
	}
	glDeleteTextures(1, &texture);
}

static float squeezed_u(const float p[3])
{
	return halves_u((float[]){2 * p[0], 0, p[2]});
}

/* Vertices with two coordinates go together. */
static void seams_deform(void **state)
{
	(void)state;
	harness_require_context();
	const GLuint texture = two_texels();
	for (int drawn = 0; drawn < 2; drawn++) {
		gi_context *gi = open_scene(BY_SKY);
		const gi_object plate = add_halves(gi, drawn, false, true);
		const gi_textures t = base_color(texture);
		light(gi);
		for (uint32_t k = 0; k < 2; k++)
			assert_gi(gi_set_textures(gi, plate, k, &t));
		draw(gi);
		expect_halves("before", BY_SKY, NULL);
		assert_gi(gi_set_scale(gi, plate, (float[]){.5f, 1, 1}));
		harness_update(gi);
		draw(gi);
		for (int i = 0; i < SIZE; i++) {
			float p[3], wanted[3];
			place_of(i, 9, p);
			const float *found = pixel_at(i, 9);
			for (int c = 0; c < 3; c++)
				wanted[c] = (GREY.exitance[c] + texel_at(squeezed_u(p))[c] * SKY[c]) / PI;
			if (fabsf(p[0]) < .5f)
				expect_pixel("squeezed", i, 9, wanted, 2e-5f);
			else
				assert_true(found[3] == 0);
		}
		gi_context_destroy(gi);
	}
	glDeleteTextures(1, &texture);
}

/* Two plates in turn: an instance has the textures that the other has, until it is given others. */
static void instances_have_textures(void **state)
{
	(void)state;
	harness_require_context();
	const GLuint texture = two_texels();
	gi_context *gi = open_scene(BY_LIGHT);
	const gi_object first = add_halves(gi, false, false, false);
	const gi_textures t = base_color(texture);
	gi_object second;
	for (uint32_t k = 0; k < 2; k++)
		assert_gi(gi_set_textures(gi, first, k, &t));
	assert_gi(gi_create_instance(gi, first, (gi_pose){{0, .01f, 0}, {0, 0, 0, 1}}, &second));
	light(gi);
	assert_gi(gi_set_textures(gi, first, 0, NULL));
	assert_gi(gi_set_textures(gi, second, 1, NULL));
	assert_gi(gi_set_pose(gi, first, (gi_pose){{-2, 0, 0}, {0, 0, 0, 1}}));
	assert_gi(gi_set_pose(gi, second, gi_pose_identity()));
	harness_update(gi);
	draw(gi);
	expect_halves("the second", BY_LIGHT, GREY.rho);
	assert_gi(gi_destroy_object(gi, first));
	light(gi);
	assert_gi(gi_set_textures(gi, second, 1, &t));
	draw(gi);
	expect_halves("the second alone", BY_LIGHT, NULL);
	gi_context_destroy(gi);
	glDeleteTextures(1, &texture);
}

/* Light and picture of a scene are what they were once its textures are taken back, to the bit. */
static void textures_are_taken_back(void **state)
{
	static float before[SIZE * SIZE][4];
	(void)state;
	harness_require_context();
	const GLuint texture = two_texels();
	for (lit by = BY_SKY; by < LITS; by++) {
		gi_context *gi = open_scene(by);
		const gi_object plate = add_plate(gi, &PLAIN);
		gi_textures t = base_color(texture), got;
		gi_report first, last;
		light(gi);
		draw(gi);
		memcpy(before, picture.pixels, sizeof before);
		assert_gi(gi_get_report(gi, &first));
		snapshot light_before = snapshot_take(gi);
		t.emissive = texture;
		t.alpha_cutoff = .125f;
		assert_gi(gi_set_textures(gi, plate, 0, &t));
		assert_gi(gi_get_textures(gi, plate, 0, &got));
		assert_memory_equal(&got, &t, sizeof t);
		draw(gi);
		assert_memory_not_equal(before, picture.pixels, sizeof before);
		assert_int_equal(harness_update(gi).dispatches, 0); /* the light has nothing of it */
		assert_gi(gi_set_textures(gi, plate, 0, NULL));
		assert_gi(gi_get_textures(gi, plate, 0, &got));
		assert_true(got.base_color == 0 && got.emissive == 0 && got.alpha_cutoff == 0);
		draw(gi);
		assert_memory_equal(before, picture.pixels, sizeof before);
		snapshot light_after = snapshot_take(gi);
		snapshot_expect_same_rows(&light_before, &light_after, "taken back");
		assert_true(snapshot_hash_radiosity(&light_before) == snapshot_hash_radiosity(&light_after));
		snapshot_free(&light_before);
		snapshot_free(&light_after);
		assert_gi(gi_get_report(gi, &last));
		assert_true(last.gpu_bytes == first.gpu_bytes);
		gi_context_destroy(gi);
	}
	glDeleteTextures(1, &texture);
}

static void expect_refused(gi_context *gi, gi_object object, const gi_textures *t, gi_result wanted, const char *why)
{
	assert_int_equal(gi_set_textures(gi, object, 0, t), wanted);
	if (!strstr(harness_last_message(), why))
		fail_msg("'%s' does not say '%s'", harness_last_message(), why);
}

static void wrong_values_are_refused(void **state)
{
	(void)state;
	harness_require_context();
	const GLuint texture = two_texels();
	GLuint cube, named, integers;
	glCreateTextures(GL_TEXTURE_CUBE_MAP, 1, &cube);
	glGenTextures(1, &named);
	glCreateTextures(GL_TEXTURE_2D, 1, &integers);
	glTextureStorage2D(integers, 1, GL_RGBA8UI, 2, 2);
	gi_context *gi = open_scene(BY_SKY);
	const gi_object plate = add_plate(gi, &PLAIN);
	engine_mesh mesh;
	make_plate(1, &mesh);
	const gi_object bare = harness_add(gi, &(harness_object){.name = "bare", .rho = {.5f, .5f, .5f}}, &mesh);
	const gi_object none = {0, 0, 0};
	const gi_textures good = base_color(texture);
	gi_textures t = good, zero;
	memset(&zero, 0, sizeof zero);
	const int argument = GI_ERROR_INVALID_ARGUMENT;
	expect_refused(gi, none, &good, GI_ERROR_INVALID_HANDLE, "handle");
	expect_refused(gi, bare, &good, argument, "'bare' is drawn without texture coordinates");
	expect_refused(gi, plate, &zero, GI_ERROR_INVALID_DEF, "gi_textures_default");
	t.base_color = cube;
	expect_refused(gi, plate, &t, argument, "'plate', material 0: base_color or emissive is no texture");
	t.base_color = named;
	expect_refused(gi, plate, &t, argument, "no texture");
	t.base_color = integers;
	expect_refused(gi, plate, &t, argument, "integers");
	t = good, t.emissive = texture + 1000;
	expect_refused(gi, plate, &t, argument, "no texture");
	t = good, t.base_color_sampler = 1000;
	expect_refused(gi, plate, &t, argument, "no sampler");
	t = good, t.base_color_factor[3] = 1.5f;
	expect_refused(gi, plate, &t, argument, "base_color_factor");
	t = good, t.emissive_factor[2] = -1;
	expect_refused(gi, plate, &t, argument, "emissive_factor");
	t = good, t.emissive_transform[1][2] = NAN;
	expect_refused(gi, plate, &t, argument, "transform");
	t = good, t.alpha_cutoff = NAN;
	expect_refused(gi, plate, &t, argument, "alpha_cutoff");
	assert_int_equal(gi_set_textures(NULL, plate, 0, &good), argument);
	assert_int_equal(gi_get_textures(gi, plate, 0, NULL), argument);
	assert_int_equal(gi_get_textures(gi, plate, 1, &t), argument);
	assert_int_equal(glGetError(), GL_NO_ERROR);
	gi_context_destroy(gi);
	glDeleteTextures(1, &texture);
	glDeleteTextures(1, &cube);
	glDeleteTextures(1, &named);
	glDeleteTextures(1, &integers);
}

/* A texture that is deleted is missed by name, and nothing is drawn. */
static void deleted_textures_are_missed(void **state)
{
	(void)state;
	harness_require_context();
	GLuint texture = two_texels();
	gi_context *gi = open_scene(BY_SKY);
	const gi_object plate = add_plate(gi, &PLAIN);
	gi_textures t = base_color(texture);
	light(gi);
	assert_gi(gi_set_textures(gi, plate, 0, &t));
	draw(gi);
	glDeleteTextures(1, &texture);
	gi_view view = target_look_down(SIZE);
	assert_int_equal(try_to_draw(gi, &view), GI_ERROR_INVALID_ARGUMENT);
	assert_non_null(strstr(harness_last_message(), "'plate', material 0"));
	glGetTextureImage(picture.colour, 0, GL_RGBA, GL_FLOAT, PIXEL_BYTES, picture.pixels);
	assert_true(pixel_at(0, 0)[3] == 0);
	assert_gi(gi_set_textures(gi, plate, 0, NULL));
	draw(gi);

	/* What was destroyed needs none: neither before the update that takes it away nor after that. */
	texture = two_texels();
	t = base_color(texture);
	assert_gi(gi_set_textures(gi, plate, 0, &t));
	draw(gi);
	assert_gi(gi_destroy_object(gi, plate));
	assert_int_equal(gi_set_textures(gi, plate, 0, NULL), GI_ERROR_INVALID_HANDLE);
	glDeleteTextures(1, &texture);
	draw(gi);
	harness_update(gi);
	draw(gi);
	light(gi);
	draw(gi);
	gi_context_destroy(gi);
}

static void definitions_are_checked(void **state)
{
	static const float corners[4][3] = {{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}};
	static const uint32_t indices[4] = {0, 1, 2, 3}, triangle[3] = {0, 1, 2}, materials[1] = {1};
	static const float bad[3][2] = {{0, 0}, {1, 0}, {1, NAN}};
	(void)state;
	harness_require_context();
	gi_context *gi = open_scene(BY_SKY);
	gi_object_def def = gi_object_def_default();
	gi_object object;
	def.positions = def.draw_positions = corners[0];
	def.vertex_count = def.draw_vertex_count = def.index_count = 4;
	def.face_count = 1;
	def.indices = indices;
	def.draw_indices = triangle;
	def.draw_index_count = 3;
	def.draw_uvs = bad[0];
	assert_int_equal(gi_create_object(gi, &def, &object), GI_ERROR_INVALID_GEOMETRY);
	assert_non_null(strstr(harness_last_message(), "texture coordinate"));
	def.draw_uvs = corners[0];
	def.draw_face_materials = materials;
	assert_int_equal(gi_create_object(gi, &def, &object), GI_ERROR_INVALID_GEOMETRY);
	assert_non_null(strstr(harness_last_message(), "material number of the draw mesh"));
	def.draw_face_materials = NULL;
	assert_gi(gi_create_object(gi, &def, &object));
	gi_context_destroy(gi);
}

/* ---- beside other things ---- */

/* A mirror, glass and something translucent in a row at z = 0.6, and a lamp that shines down. */
static void add_others(gi_context *gi)
{
	static const gi_specular mirror = {.reflectance = {.5f, .5f, .5f}},
				 glass = {.transmittance = {.9f, .9f, .9f}, .index = 1.5f};
	static const gi_subsurface marble = {{2000, 2000, 2000}, {2, 2, 2}, 1.5f};
	static const gi_material lamp = {.exitance = {5, 5, 5}}, dark = {.rho = {.1f, .1f, .1f}};
	for (int k = 0; k < 4; k++) {
		engine_mesh mesh;
		gi_object object;
		if (k < 3)
			assert_true(shape_sphere(.2f, 2, &mesh));
		else
			assert_true(shape_quad((float[]){-.2f, 1, -.2f}, (float[]){.4f, 0, 0}, (float[]){0, 0, .4f}, 1,
					       1, &mesh));
		gi_object_def def = scene_mesh_def(&mesh);
		def.materials = k == 3 ? &lamp : &dark;
		def.material_count = 1;
		def.specular = k == 0 ? &mirror : k == 1 ? &glass : NULL;
		def.subsurface = k == 2 ? &marble : NULL;
		def.pose.position[0] = k < 3 ? -.6f + .6f * (float)k : 0;
		def.pose.position[1] = k < 3 ? .3f : 0;
		def.pose.position[2] = .6f;
		assert_gi(gi_create_object(gi, &def, &object));
		engine_mesh_free(&mesh);
	}
}

/* A textured floor beside all that pictures have passes for: one without the texture says what light each pixel has. */
static void textures_go_with_all_else(void **state)
{
	static float plain[SIZE * SIZE][4];
	(void)state;
	harness_require_context();
	const GLuint texture = two_texels();
	gi_context *gi = open_scene(BY_LIGHT);
	const gi_object plate = add_plate(gi, &PLAIN);
	add_others(gi);
	light(gi);
	draw(gi);
	memcpy(plain, picture.pixels, sizeof plain);
	const gi_textures t = base_color(texture);
	assert_gi(gi_set_textures(gi, plate, 0, &t));
	gi_view view = target_look_down(SIZE);
	for (int overlay = 0; overlay < 2; overlay++) {
		view.overlay = overlay ? GI_OVERLAY_WIREFRAME : GI_OVERLAY_NONE;
		assert_gi(try_to_draw(gi, &view));
	}
	draw(gi);
	int others = 0;
	for (int j = 0; j < SIZE; j++)
		for (int i = 0; i < SIZE; i++) {
			float p[3], wanted[3];
			place_of(i, j, p);
			const float *before = plain[j * SIZE + i];
			if (p[2] > .35f) {
				others += memcmp(before, pixel_at(i, j), sizeof *plain) == 0;
				continue;
			}
			for (int c = 0; c < 3; c++)
				wanted[c] = GREY.exitance[c] / PI +
					    (before[c] - GREY.exitance[c] / PI) / GREY.rho[c] * texel_at(plain_u(p))[c];
			expect_pixel("floor", i, j, wanted, 1e-5f);
		}
	assert_true(others > 20); /* the balls are as they were */
	gi_context_destroy(gi);
	glDeleteTextures(1, &texture);
}

/* A framebuffer of many samples has in each pixel what one of one sample has. */
static void multisampled_targets(void **state)
{
	static float wanted[SIZE * SIZE][4];
	(void)state;
	harness_require_context();
	const GLuint texture = two_texels();
	GLuint parts[2], framebuffer;
	glCreateRenderbuffers(2, parts);
	glNamedRenderbufferStorageMultisample(parts[0], 4, GL_RGBA32F, SIZE, SIZE);
	glNamedRenderbufferStorageMultisample(parts[1], 4, GL_DEPTH_COMPONENT32F, SIZE, SIZE);
	glCreateFramebuffers(1, &framebuffer);
	glNamedFramebufferRenderbuffer(framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, parts[0]);
	glNamedFramebufferRenderbuffer(framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, parts[1]);
	for (lit by = BY_SKY; by < LITS; by++) {
		gi_context *gi = open_scene(by);
		const gi_object plate = add_plate(gi, &PLAIN);
		const gi_textures t = base_color(texture);
		const gi_view view = target_look_down(SIZE);
		const float far = 1;
		light(gi);
		assert_gi(gi_set_textures(gi, plate, 0, &t));
		draw(gi);
		memcpy(wanted, picture.pixels, sizeof wanted);
		glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
		glClearBufferfv(GL_DEPTH, 0, &far);
		assert_gi(gi_draw(gi, &view));
		glBlitNamedFramebuffer(framebuffer, picture.framebuffer, 0, 0, SIZE, SIZE, 0, 0, SIZE, SIZE,
				       GL_COLOR_BUFFER_BIT, GL_NEAREST);
		glGetTextureImage(picture.colour, 0, GL_RGBA, GL_FLOAT, PIXEL_BYTES, picture.pixels);
		assert_int_equal(glGetError(), GL_NO_ERROR);
		for (int k = 0; k < SIZE * SIZE; k++)
			expect_pixel("samples", k % SIZE, k / SIZE, wanted[k], 1e-6f);
		gi_context_destroy(gi);
	}
	glDeleteFramebuffers(1, &framebuffer);
	glDeleteRenderbuffers(2, parts);
	glDeleteTextures(1, &texture);
}

/* Units beyond those of gi.h keep what is bound, and drawing state is as it was. */
static void the_hosts_state_is_given_back(void **state)
{
	(void)state;
	harness_require_context();
	const GLuint texture = two_texels(), own = two_texels();
	GLuint sampler;
	glCreateSamplers(1, &sampler);
	for (lit by = BY_SKY; by < LITS; by++) {
		gi_context *gi = open_scene(by);
		const gi_object plate = add_plate(gi, &PLAIN);
		gi_textures t = base_color(texture);
		t.emissive = texture;
		t.base_color_sampler = sampler;
		light(gi);
		assert_gi(gi_set_textures(gi, plate, 0, &t));
		glBindTextureUnit(44, own);
		glBindSampler(44, sampler);
		glDepthFunc(GL_ALWAYS);
		glEnable(GL_BLEND);
		draw(gi);
		GLint bound[2], depth = 0;
		glActiveTexture(GL_TEXTURE0 + 44);
		glGetIntegerv(GL_TEXTURE_BINDING_2D, &bound[0]);
		glGetIntegerv(GL_SAMPLER_BINDING, &bound[1]);
		glGetIntegerv(GL_DEPTH_FUNC, &depth);
		assert_true(bound[0] == (GLint)own && bound[1] == (GLint)sampler && depth == GL_ALWAYS);
		assert_true(glIsEnabled(GL_BLEND));
		glDepthFunc(GL_LESS);
		glDisable(GL_BLEND);
		glBindSampler(44, 0);
		glActiveTexture(GL_TEXTURE0);
		gi_context_destroy(gi);
	}
	assert_true(glIsTexture(texture) && glIsSampler(sampler)); /* they are the host's */
	glDeleteSamplers(1, &sampler);
	glDeleteTextures(1, &texture);
	glDeleteTextures(1, &own);
}

/* ---- memory ---- */

static void memory_runs_out(void **state)
{
	(void)state;
	harness_require_context();
	const GLuint texture = two_texels();
	for (fault_kind kind = FAULT_CPU; kind < FAULT_KINDS; kind++) {
		gi_context_def def = harness_def();
		def.sky = GI_SKY_ON;
		memcpy(def.sky_exitance, SKY, sizeof SKY);
		faults_in(&def);
		gi_context *gi = harness_context(&def);
		gi_light_def sun = gi_light_def_default();
		gi_light handle;
		memcpy(sun.position, LIGHT_AT, sizeof LIGHT_AT);
		sun.intensity[0] = sun.intensity[1] = sun.intensity[2] = INTENSITY;
		assert_gi(gi_create_light(gi, &sun, &handle));
		const gi_object plate = add_halves(gi, false, false, false);
		const gi_textures t = base_color(texture);
		const gi_view view = target_look_down(SIZE);
		light(gi);
		draw(gi);
		uint32_t failed = 1, number = 0;
		for (; failed; number++) {
			faults_begin(kind, number, false);
			gi_result result = gi_set_textures(gi, plate, 0, &t);
			result = result ? result : try_to_draw(gi, &view);
			failed = faults_end();
			assert_true(failed ? result == GI_ERROR_OUT_OF_MEMORY : result == GI_OK);
			assert_true(!failed || strstr(harness_last_message(), "memory"));
			assert_gi(gi_set_textures(gi, plate, 0, &t));
			draw(gi);
			expect_halves("there is memory again", BY_LIGHT, GREY.rho);
			assert_gi(gi_set_textures(gi, plate, 0, NULL));
			draw(gi);
		}
		assert_true(number > 4);
		gi_context_destroy(gi);
	}
	glDeleteTextures(1, &texture);
	assert_int_equal(faults_memory_now().blocks, 0);
}

/* An object with coordinates is made whole or not at all. */
static void memory_runs_out_for_objects(void **state)
{
	static const float corners[4][3] = {{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}};
	static const float uvs[4][2] = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
	static const uint32_t indices[4] = {0, 1, 2, 3}, triangle[3] = {0, 1, 2};
	(void)state;
	harness_require_context();
	gi_context_def def = harness_def();
	faults_in(&def);
	gi_context *gi = harness_context(&def);
	for (int mesh = 0; mesh < 2; mesh++) {
		gi_object_def of = gi_object_def_default();
		of.positions = corners[0];
		of.vertex_count = of.index_count = 4;
		of.face_count = 1;
		of.indices = indices;
		of.levels = 1;
		of.uvs = uvs[0];
		if (mesh) {
			of.draw_positions = corners[0];
			of.draw_vertex_count = 4;
			of.draw_indices = triangle;
			of.draw_index_count = 3;
			of.draw_uvs = uvs[0];
		}
		uint32_t failed = 1;
		for (uint32_t number = 0; failed; number++) {
			gi_object object;
			faults_begin(FAULT_CPU, number, false);
			const gi_result result = gi_create_object(gi, &of, &object);
			failed = faults_end();
			assert_true(result == GI_OK || (failed && result == GI_ERROR_OUT_OF_MEMORY));
		}
	}
	gi_context_destroy(gi);
	assert_int_equal(faults_memory_now().blocks, 0);
}

static int close_all(void **state)
{
	if (picture.framebuffer)
		target_free(&picture);
	return harness_close(state);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(texels_are_lit_as_they_are),
	    cmocka_unit_test(filters_are_the_textures_own),
	    cmocka_unit_test(srgb_is_the_formats_business),
	    cmocka_unit_test(emissive_textures_shine),
	    cmocka_unit_test(transforms_and_samplers),
	    cmocka_unit_test(what_is_cut_out_is_not_drawn),
	    cmocka_unit_test(textures_move_and_deform),
	    cmocka_unit_test(materials_have_textures_of_their_own),
	    cmocka_unit_test(seams_deform),
	    cmocka_unit_test(instances_have_textures),
	    cmocka_unit_test(textures_are_taken_back),
	    cmocka_unit_test(wrong_values_are_refused),
	    cmocka_unit_test(deleted_textures_are_missed),
	    cmocka_unit_test(definitions_are_checked),
	    cmocka_unit_test(textures_go_with_all_else),
	    cmocka_unit_test(multisampled_targets),
	    cmocka_unit_test(the_hosts_state_is_given_back),
	    cmocka_unit_test(memory_runs_out),
	    cmocka_unit_test(memory_runs_out_for_objects),
	};
	return cmocka_run_group_tests_name("textures", tests, harness_open, close_all);
}
