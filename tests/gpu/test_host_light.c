/* A host that draws for itself gets the light of the leaves: at the vertices of a mesh of its own, in its own shaders,
 * wherever commits put it. */
#include "harness.h"

#include "scenes/body.h"
#include "scenes/shapes.h"

#include <glad/gl.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 33, POINTS = SIDE * SIDE };

static const float LAMP_EXITANCE = 10;

static gi_object add_lamp(gi_context *gi, float x)
{
	engine_mesh mesh;
	assert_true(shape_quad((float[]){x - .5f, 2, -.5f}, (float[]){1, 0, 0}, (float[]){0, 0, 1}, 1, 1, &mesh));
	return harness_add(
	    gi, &(harness_object){.name = "lamp", .exitance = {LAMP_EXITANCE, LAMP_EXITANCE / 2, LAMP_EXITANCE / 4}},
	    &mesh);
}

static gi_object add_floor(gi_context *gi, uint32_t cells, bool double_sided)
{
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-2, 0, -2}, (float[]){0, 0, 4}, (float[]){4, 0, 0}, cells, cells, &mesh));
	return harness_add(gi, &(harness_object){.name = "floor", .rho = {.5f, .5f, .5f}, .double_sided = double_sided},
			   &mesh);
}

static gi_context *open_context(void)
{
	gi_context_def def = harness_def();
	def.pixel_lamps = 0;
	return harness_context(&def);
}

/* ---- points of a finer mesh, and what arrives there ---- */

static float points[POINTS][3], normals_up[POINTS][3], normals_down[POINTS][3];

/* Over [-1.9, 1.9], a little off the floor as a mesh with a relief is. */
static void make_points(void)
{
	for (uint32_t k = 0; k < POINTS; k++) {
		points[k][0] = 3.8f * (float)(k % SIDE) / (SIDE - 1) - 1.9f;
		points[k][1] = .01f * sinf((float)k);
		points[k][2] = 3.8f * (float)(k / SIDE) / (SIDE - 1) - 1.9f;
		normals_up[k][1] = 1;
		normals_down[k][1] = -1;
	}
}

static double corner_term(double x, double y)
{
	const double sx = sqrt(1 + x * x), sy = sqrt(1 + y * y);
	return (x / sx * atan(y / sx) + y / sy * atan(x / sy)) / (2 * 3.14159265358979);
}

/* Form factor of a point of the floor to the lamp above x = 0: a rectangle parallel to it, of four that have a corner
 * above the point (Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", B-4). */
static double factor_by_hand(const float p[3])
{
	const double h = 2, x0 = (-.5 - (double)p[0]) / h, x1 = (.5 - (double)p[0]) / h;
	const double z0 = (-.5 - (double)p[2]) / h, z1 = (.5 - (double)p[2]) / h;
	return corner_term(x1, z1) - corner_term(x0, z1) - corner_term(x1, z0) + corner_term(x0, z0);
}

/* H at the points as a host computes it, on the CPU. */
static void light_points(gi_context *gi, gi_object object, const gi_vertex_light *map, float (*out)[3])
{
	gi_buffers buffers;
	gi_object_range range;
	assert_gi(gi_get_buffers(gi, &buffers));
	assert_gi(gi_get_object_range(gi, object, &range));
	assert_true(range.first_light + range.light_count <= buffers.light_count);
	float(*light)[4] = malloc(sizeof *light * buffers.light_count);
	assert_non_null(light);
	glGetNamedBufferSubData(buffers.light_indirect, 0, (GLsizeiptr)(sizeof *light * buffers.light_count), light);
	for (uint32_t k = 0; k < POINTS; k++) {
		memset(out[k], 0, sizeof out[k]);
		for (int i = 0; i < 4; i++) {
			assert_true(map[k].light[i] < range.light_count);
			for (int c = 0; c < 3; c++)
				out[k][c] += map[k].weight[i] * light[range.first_light + map[k].light[i]][c];
		}
	}
	free(light);
}

static gi_vertex_light map_up[POINTS], map_again[POINTS];
static float seen[POINTS][3], seen_again[POINTS][3];

/* A floor of leaves of 0.125 m: to 2 % of the brightest everywhere. */
static void expect_by_hand(const float (*h)[3])
{
	double worst = 0;
	for (uint32_t k = 0; k < POINTS; k++)
		for (int c = 0; c < 3; c++)
			worst =
			    fmax(worst, fabs((double)h[k][c] * (1 << c) / LAMP_EXITANCE - factor_by_hand(points[k])));
	const double brightest = factor_by_hand((float[]){0, 0, 0});
	printf("  off by at most %.2f %% of the brightest\n", 100 * worst / brightest);
	assert_true(worst < .02 * brightest);
}

static void vertices_have_the_light_there(void **state)
{
	(void)state;
	gi_context *gi = open_context();
	const gi_object floor = add_floor(gi, 32, false);
	add_lamp(gi, 0);
	assert_gi(gi_map_vertices(gi, floor, points[0], normals_up[0], POINTS, map_up));
	assert_gi(gi_commit(gi));
	harness_update(gi);
	light_points(gi, floor, map_up, seen);
	expect_by_hand((const float(*)[3])seen);
	for (uint32_t k = 0; k < POINTS; k++) {
		float sum = 0;
		for (int i = 0; i < 4; i++) {
			assert_true(map_up[k].weight[i] >= 0);
			sum += map_up[k].weight[i];
		}
		assert_true(fabsf(sum - 1) < 1e-5f);
	}
	/* Without normals the floor is as near as with them. */
	assert_gi(gi_map_vertices(gi, floor, points[0], NULL, POINTS, map_again));
	assert_memory_equal(map_up, map_again, sizeof map_up);
	gi_context_destroy(gi);
}

/* Objects come before it in every buffer, go, and the floor moves with its lamp: the same map, the same light. */
static void a_map_outlives_commits(void **state)
{
	(void)state;
	gi_context *gi = open_context();
	const gi_object before = add_floor(gi, 5, false), floor = add_floor(gi, 32, false), lamp = add_lamp(gi, 0);
	gi_object_range first, range;
	gi_buffers one, other;
	assert_int_equal(gi_get_object_range(gi, floor, &range), GI_ERROR_NOT_COMMITTED);
	assert_gi(gi_set_pose(gi, before, (gi_pose){{0, -50, 0}, {0, 0, 0, 1}}));
	assert_gi(gi_map_vertices(gi, floor, points[0], normals_up[0], POINTS, map_up));
	assert_gi(gi_commit(gi));
	harness_update(gi);
	assert_gi(gi_get_object_range(gi, floor, &first));
	assert_gi(gi_get_buffers(gi, &one));
	assert_int_equal(first.first_leaf, 25);
	assert_int_equal(first.leaf_count, 32 * 32);
	assert_int_equal(first.light_count, 33 * 33);
	light_points(gi, floor, map_up, seen);
	expect_by_hand((const float(*)[3])seen);
	harness_update(gi);
	assert_gi(gi_get_buffers(gi, &other));
	assert_memory_equal(&one, &other, sizeof one);

	assert_gi(gi_destroy_object(gi, before));
	assert_gi(gi_set_pose(gi, floor, (gi_pose){{0, 0, 7}, {0, 0, 0, 1}}));
	assert_gi(gi_set_pose(gi, lamp, (gi_pose){{0, 0, 7}, {0, 0, 0, 1}}));
	assert_gi(gi_commit(gi));
	harness_update(gi);
	assert_gi(gi_get_buffers(gi, &other));
	assert_true(other.layout != one.layout);
	assert_gi(gi_get_object_range(gi, floor, &range));
	assert_int_equal(range.first_leaf, 0);
	assert_int_equal(range.first_light, 0);
	assert_int_equal(gi_get_object_range(gi, before, &range), GI_ERROR_INVALID_HANDLE);
	light_points(gi, floor, map_up, seen);
	expect_by_hand((const float(*)[3])seen);
	gi_context_destroy(gi);
}

/* Of two sides in one place the normal says which. */
static void normals_choose_the_side(void **state)
{
	(void)state;
	gi_context *gi = open_context();
	const gi_object floor = add_floor(gi, 8, true);
	add_lamp(gi, 0);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	assert_gi(gi_map_vertices(gi, floor, points[0], normals_up[0], POINTS, map_up));
	light_points(gi, floor, map_up, seen);
	assert_gi(gi_map_vertices(gi, floor, points[0], normals_down[0], POINTS, map_up));
	light_points(gi, floor, map_up, seen_again);
	for (uint32_t k = 0; k < POINTS; k++)
		assert_true(seen[k][0] > 0 && seen_again[k][0] == 0);
	gi_context_destroy(gi);
}

/* A scale is the library's business: positions and normals are those of the definition. And an object that was
 * prepared maps as one that was created. Light comes along x alone. */
static void prepared_and_scaled_objects_map(void **state)
{
	(void)state;
	engine_mesh box, lamp;
	gi_context *gi = open_context();
	assert_true(shape_box((float[]){0, 0, 0}, (float[]){1, 1, 1}, 8, false, &box));
	assert_true(shape_quad((float[]){30, .1f, -3}, (float[]){0, 0, 9}, (float[]){0, .3f, 0}, 1, 1, &lamp));
	harness_add(gi, &(harness_object){.name = "lamp", .exitance = {100, 0, 0}}, &lamp);
	gi_object_def def = scene_mesh_def(&box);
	memcpy(def.scale, (float[]){20, .5f, 3}, sizeof def.scale);
	def.undrawn = true;
	gi_prepared_object *prepared;
	gi_object object;
	/* 0.6 m from the lit face, 0.1 m from the dark one below. */
	const float at[6] = {.97f, .2f, .5f, .97f, .2f, .5f}, normals[6] = {1, 0, 0, 0, -1, 0};
	gi_vertex_light ahead[2], mapped[2];
	assert_gi(gi_prepare_object(&def, NULL, NULL, NULL, &prepared));
	engine_mesh_free(&box);
	assert_gi(gi_map_prepared_vertices(prepared, at, normals, 2, ahead, NULL, NULL));
	assert_int_equal(gi_map_prepared_vertices(NULL, at, normals, 2, ahead, NULL, NULL), GI_ERROR_INVALID_ARGUMENT);
	assert_gi(gi_create_prepared_object(gi, &prepared, &object));
	assert_gi(gi_map_vertices(gi, object, at, normals, 2, mapped));
	assert_memory_equal(ahead, mapped, sizeof mapped);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	for (uint32_t k = 0; k < POINTS; k++)
		map_up[k] = mapped[k % 2];
	assert_gi(gi_map_vertices(gi, object, at, NULL, 1, &map_up[2]));
	light_points(gi, object, map_up, seen);
	assert_true(seen[0][0] > .1f);
	assert_true(seen[1][0] == 0);
	assert_true(seen[2][0] == 0);
	gi_context_destroy(gi);
}

static void wrong_calls_are_refused(void **state)
{
	(void)state;
	gi_context *gi = open_context();
	const gi_object floor = add_floor(gi, 1, false);
	gi_vertex_light out;
	gi_object_range range;
	const float bad[3] = {0, NAN, 0}, good[3] = {0, 0, 0};
	assert_int_equal(gi_map_vertices(gi, floor, bad, NULL, 1, &out), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_map_vertices(gi, floor, good, bad, 1, &out), GI_ERROR_INVALID_ARGUMENT);
	assert_non_null(strstr(harness_last_message(), "floor"));
	assert_int_equal(gi_map_vertices(gi, floor, NULL, NULL, 1, &out), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_map_vertices(gi, floor, good, NULL, 1, NULL), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_map_vertices(NULL, floor, good, NULL, 1, &out), GI_ERROR_INVALID_ARGUMENT);
	assert_gi(gi_map_vertices(gi, floor, NULL, NULL, 0, NULL));
	assert_int_equal(gi_map_vertices(gi, (gi_object){0}, good, NULL, 1, &out), GI_ERROR_INVALID_HANDLE);
	assert_int_equal(gi_get_object_range(gi, floor, NULL), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_get_object_range(gi, (gi_object){0}, &range), GI_ERROR_INVALID_HANDLE);
	assert_null(gi_glsl(NULL));
	assert_null(gi_glsl("buffers.glsl"));
	assert_non_null(gi_glsl("gi_light.glsl"));
	gi_context_destroy(gi);
}

/* ---- in shaders ---- */

static GLuint compile(GLenum stage, const char *version, const char *defines, const char *body)
{
	char log[1024];
	GLint done = 0;
	const char *const text[] = {version, defines, gi_glsl("gi_light.glsl"), body};
	const GLuint shader = glCreateShader(stage);
	glShaderSource(shader, 4, text, NULL);
	glCompileShader(shader);
	glGetShaderiv(shader, GL_COMPILE_STATUS, &done);
	glGetShaderInfoLog(shader, sizeof log, NULL, log);
	if (!done)
		fail_msg("%s: %s", defines, log);
	return shader;
}

static GLuint link_program(const GLuint shaders[2])
{
	GLint done = 0;
	const GLuint program = glCreateProgram();
	for (int k = 0; k < 2; k++) {
		glAttachShader(program, shaders[k]);
		glDeleteShader(shaders[k]);
	}
	glLinkProgram(program);
	glGetProgramiv(program, GL_LINK_STATUS, &done);
	assert_true(done);
	return program;
}

/* A point a pixel: what the vertex shader found, or the fragment shader by the number of the point. */
static const char VERTEX_TEXT[] =
    "#if __VERSION__ >= 420\n#define AT(n) layout(location = n)\n#else\n#define AT(n)\n#endif\n"
    "uniform int first; flat out vec3 found; flat out int number;\n"
    "void main() { number = gl_VertexID; found = gi_light_at_mapped(uint(first), uint(gl_VertexID));\n"
    "gl_Position = vec4((vec2(gl_VertexID % 33, gl_VertexID / 33) + 0.5) / 16.5 - 1.0, 0, 1); }\n";
static const char FRAGMENT_FOUND[] = "flat in vec3 found; flat in int number; out vec4 c;\n"
				     "void main() { c = vec4(found, float(number)); }\n";
static const char FRAGMENT_FINDS[] =
    "uniform int first; flat in vec3 found; flat in int number; out vec4 c;\n"
    "void main() { c = vec4(gi_light_at_mapped(uint(first), uint(number)), float(number)); }\n";

/* Draws the points and reads them into seen_again. */
static void draw_points(GLuint program, uint32_t first_light)
{
	static float pixels[POINTS][4];
	GLuint array, color, framebuffer;
	glCreateVertexArrays(1, &array);
	glBindVertexArray(array);
	glCreateRenderbuffers(1, &color);
	glNamedRenderbufferStorage(color, GL_RGBA32F, SIDE, SIDE);
	glCreateFramebuffers(1, &framebuffer);
	glNamedFramebufferRenderbuffer(framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color);
	glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
	glViewport(0, 0, SIDE, SIDE);
	glUseProgram(program);
	glUniform1i(glGetUniformLocation(program, "first"), (GLint)first_light);
	if (glGetUniformLocation(program, "gi_light_texels") >= 0)
		glUniform1i(glGetUniformLocation(program, "gi_light_texels"), 3);
	if (glGetUniformLocation(program, "gi_map_texels") >= 0)
		glUniform1i(glGetUniformLocation(program, "gi_map_texels"), 5);
	glDrawArrays(GL_POINTS, 0, POINTS);
	glReadPixels(0, 0, SIDE, SIDE, GL_RGBA, GL_FLOAT, pixels);
	for (uint32_t k = 0; k < POINTS; k++) {
		assert_true(pixels[k][3] == (float)k);
		memcpy(seen_again[k], pixels[k], sizeof seen_again[k]);
	}
	assert_int_equal(glGetError(), GL_NO_ERROR);
	glDeleteFramebuffers(1, &framebuffer);
	glDeleteRenderbuffers(1, &color);
	glDeleteVertexArrays(1, &array);
	glUseProgram(0);
}

static void shaders_find_the_same(void **state)
{
	(void)state;
	static const struct {
		const char *version, *defines;
		bool in_fragment;
	} ways[] = {
	    {"#version 330 core\n", "#define GI_MAP\n", false},
	    {"#version 330 core\n", "#define GI_MAP\n", true},
	    {"#version 420 core\n", "#define GI_LIGHT_UNIT 3\n#define GI_MAP_UNIT 5\n#define GI_LEAF_UNIT 6\n", false},
	    {"#version 450 core\n", "#define GI_LIGHT_STORAGE 7\n#define GI_MAP_UNIT 5\n#define GI_LEAF\n", false},
	    {"#version 450 core\n", "#define GI_LIGHT_STORAGE 7\n#define GI_MAP_UNIT 5\n", true},
	};
	gi_context *gi = open_context();
	add_lamp(gi, 1);
	const gi_object floor = add_floor(gi, 32, false);
	add_lamp(gi, 0);
	gi_buffers buffers;
	gi_object_range range;
	GLuint map_buffer, map_texture;
	assert_gi(gi_commit(gi));
	assert_gi(gi_map_vertices(gi, floor, points[0], normals_up[0], POINTS, map_up));
	glCreateBuffers(1, &map_buffer);
	glNamedBufferStorage(map_buffer, sizeof map_up, map_up, 0);
	glCreateTextures(GL_TEXTURE_BUFFER, 1, &map_texture);
	glTextureBuffer(map_texture, GL_RGBA32UI, map_buffer);
	harness_update(gi);
	light_points(gi, floor, map_up, seen);
	assert_gi(gi_get_buffers(gi, &buffers));
	assert_gi(gi_get_object_range(gi, floor, &range));
	assert_true(range.first_light > 0);
	for (size_t k = 0; k < sizeof ways / sizeof *ways; k++) {
		const char *fragment = ways[k].in_fragment ? FRAGMENT_FINDS : FRAGMENT_FOUND;
		const GLuint program =
		    link_program((GLuint[]){compile(GL_VERTEX_SHADER, ways[k].version, ways[k].defines, VERTEX_TEXT),
					    compile(GL_FRAGMENT_SHADER, ways[k].version, ways[k].defines, fragment)});
		glBindTextureUnit(3, buffers.light_indirect_texture);
		glBindTextureUnit(5, map_texture);
		glBindTextureUnit(6, buffers.leaf_indirect_texture);
		glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 7, buffers.light_indirect);
		draw_points(program, range.first_light);
		for (uint32_t p = 0; p < POINTS; p++)
			for (int c = 0; c < 3; c++)
				assert_true(fabsf(seen_again[p][c] - seen[p][c]) <= 1e-5f * seen[p][c]);
		glDeleteProgram(program);
	}
	glDeleteTextures(1, &map_texture);
	glDeleteBuffers(1, &map_buffer);
	gi_context_destroy(gi);
}

/* What the host draws for itself is not drawn, and lights as before. */
static void undrawn_objects_light_alike(void **state)
{
	(void)state;
	gi_leaf leaves[2][1024];
	uint32_t count[2];
	for (int k = 0; k < 2; k++) {
		engine_mesh mesh;
		const gi_material grey = {.rho = {.5f, .5f, .5f}};
		gi_context *gi = open_context();
		assert_true(shape_sphere(.5f, 2, &mesh));
		gi_object_def def = scene_mesh_def(&mesh);
		def.scheme = GI_SCHEME_CATMULL_CLARK;
		def.levels = 2;
		def.materials = &grey;
		def.material_count = 1;
		def.undrawn = k;
		gi_object ball;
		assert_gi(gi_create_object(gi, &def, &ball));
		engine_mesh_free(&mesh);
		add_lamp(gi, 0);
		assert_gi(gi_commit(gi));
		harness_update(gi);
		assert_gi(gi_read_leaves(gi, leaves[k], 1024, &count[k]));
		for (uint32_t l = 0; l < count[k]; l++)
			leaves[k][l].object.context = 0;
		gi_context_destroy(gi);
	}
	assert_int_equal(count[0], count[1]);
	assert_memory_equal(leaves[0], leaves[1], count[0] * sizeof **leaves);
}

static int open_all(void **state)
{
	make_points();
	return harness_open(state);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(vertices_have_the_light_there), cmocka_unit_test(a_map_outlives_commits),
	    cmocka_unit_test(normals_choose_the_side),       cmocka_unit_test(prepared_and_scaled_objects_map),
	    cmocka_unit_test(wrong_calls_are_refused),       cmocka_unit_test(shaders_find_the_same),
	    cmocka_unit_test(undrawn_objects_light_alike),
	};
	return cmocka_run_group_tests_name("light for hosts", tests, open_all, harness_close);
}
