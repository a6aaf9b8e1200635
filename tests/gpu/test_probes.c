/* Probes: the look-up of gi_probe.glsl in a host's shader. No light through a wall of 10 cm; what it says where there
 * is light; planes of updates that are those of a rebuild. */
#include "moving_scene.h"
#include "pieces.h"

#include "scenes/shapes.h"

#include <glad/gl.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- a host's shader ---- */

static const char *const MAIN =
    "layout(local_size_x = 64) in;\n"
    "layout(std140, binding = 5) uniform grid_block { gi_probe_grid grid; };\n"
    "layout(std430, binding = 2) readonly buffer asked_block { vec4 asked[]; };\n"
    "layout(std430, binding = 3) buffer found_block { vec4 found[]; };\n"
    "void main()\n"
    "{\n"
    "	uint t = gl_GlobalInvocationID.x;\n"
    "	if (t >= uint(found.length()) / 2u)\n"
    "		return;\n"
    "	float weight;\n"
    "	vec3 h = gi_probe_irradiance(grid, asked[2u * t].xyz, asked[2u * t + 1u].xyz, weight);\n"
    "	found[2u * t] = vec4(h, weight);\n"
    "	found[2u * t + 1u] = vec4(gi_probe_mean_radiance(grid, asked[2u * t].xyz, weight), weight);\n"
    "}\n";

static GLuint compile(void)
{
	const char *text[] = {"#version 450 core\n#define GI_PROBE_LIGHT_STORAGE 0\n#define GI_PROBE_PLANE_STORAGE 1\n",
			      gi_glsl("gi_probe.glsl"), MAIN};
	assert_non_null(text[1]);
	const GLuint shader = glCreateShader(GL_COMPUTE_SHADER), program = glCreateProgram();
	char log[1024] = "";
	GLint linked;
	glShaderSource(shader, 3, text, NULL);
	glCompileShader(shader);
	glGetShaderInfoLog(shader, sizeof log, NULL, log);
	glAttachShader(program, shader);
	glLinkProgram(program);
	glGetProgramiv(program, GL_LINK_STATUS, &linked);
	glDeleteShader(shader);
	if (!linked)
		fail_msg("gi_probe.glsl: %s", log);
	return program;
}

typedef struct question {
	float place[4], normal[4];
} question;

typedef struct answer {
	float irradiance[3], weight;
	float radiance[3], air_weight;
} answer;

static void ask(gi_context *gi, gi_receivers probes, GLuint program, const question *questions, uint32_t count,
		answer *answers)
{
	gi_probe_buffers b;
	assert_gi(gi_get_probe_buffers(gi, probes, &b));
	GLuint buffers[3];
	glCreateBuffers(3, buffers);
	glNamedBufferStorage(buffers[0], (GLsizeiptr)(sizeof *questions * count), questions, 0);
	glNamedBufferStorage(buffers[1], (GLsizeiptr)(sizeof *answers * count), NULL, 0);
	glNamedBufferStorage(buffers[2], sizeof b.grid, &b.grid, 0);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, b.light);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, b.planes);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, buffers[0]);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, buffers[1]);
	glBindBufferBase(GL_UNIFORM_BUFFER, 5, buffers[2]);
	glUseProgram(program);
	glDispatchCompute((count + 63) / 64, 1, 1);
	glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
	glGetNamedBufferSubData(buffers[1], 0, (GLsizeiptr)(sizeof *answers * count), answers);
	glDeleteBuffers(3, buffers);
}

/* ---- two sealed rooms ---- */

static const float HALF_WALL = .05f;
static const float DIRECTIONS[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};

static gi_context *open_rooms(void)
{
	gi_context_def def = harness_def();
	def.sky = GI_SKY_OFF;
	gi_context *gi = harness_context(&def);
	const harness_object white = {.name = "room", .levels = 1, .rho = {.6f, .6f, .6f}};
	add_room(gi, &white, (box){{-3, 0, -2}, {-HALF_WALL, 2.5f, 2}});
	add_room(gi, &white, (box){{HALF_WALL, 0, -2}, {3, 2.5f, 2}});
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-2, 2.4f, -.5f}, (float[]){1, 0, 0}, (float[]){0, 0, 1}, 1, 1, &mesh));
	harness_add(gi, &(harness_object){.name = "lamp", .levels = 2, .exitance = {40, 30, 20}}, &mesh);
	return gi;
}

/* Places all over a room, up to 2 cm from its walls and on them, along six normals. */
static uint32_t place_questions(float lower, float upper, question *out)
{
	static const float ALONG[7] = {0, .01f, .1f, .3f, .5f, .8f, 1};
	uint32_t count = 0;
	for (int k = 0; k < 7 * 7 * 7 * 6; k++) {
		const float x = ALONG[k / 6 % 7], y = ALONG[k / 42 % 7], z = ALONG[k / 294];
		question q = {.place = {lower + (upper - lower) * x, 2.5f * y, -2 + 4 * z}};
		memcpy(q.normal, DIRECTIONS[k % 6], sizeof DIRECTIONS[0]);
		out[count++] = q;
	}
	return count;
}

static void wall_between(void **state)
{
	(void)state;
	enum { MOST = 7 * 7 * 7 * 6 };
	static question questions[MOST];
	static answer answers[MOST];
	gi_context *gi = open_rooms();
	gi_receivers grids[3];
	/* Probes beside the wall, in it, and far apart. */
	static const float SPACING[3] = {.8f, .5f, 1.3f}, FIRST[3] = {-2.7f, -2.5f, -2.8f};
	for (uint32_t k = 0; k < 3; k++) {
		gi_probes_def def = gi_probes_def_default();
		memcpy(def.lower, (float[]){FIRST[k], .2f, -1.8f}, sizeof def.lower);
		def.spacing = SPACING[k];
		const float size[3] = {-2 * FIRST[k], 2.2f, 3.7f};
		for (int c = 0; c < 3; c++)
			def.count[c] = 1 + (uint32_t)(size[c] / SPACING[k]);
		assert_gi(gi_create_probes(gi, &def, &grids[k]));
	}
	assert_gi(gi_commit(gi));
	harness_update(gi);
	const GLuint program = compile();
	for (uint32_t k = 0; k < 3; k++) {
		float bright = 0;
		uint32_t count = place_questions(-3, -HALF_WALL, questions), unseen = 0;
		ask(gi, grids[k], program, questions, count, answers);
		for (uint32_t n = 0; n < count; n++)
			bright += answers[n].irradiance[0] / (float)count;
		count = place_questions(HALF_WALL, 3, questions);
		ask(gi, grids[k], program, questions, count, answers);
		for (uint32_t n = 0; n < count; n++) {
			unseen += answers[n].weight == 0;
			if (answers[n].irradiance[0] + answers[n].radiance[0] > 0)
				fail_msg("spacing %g: light %g at (%g %g %g)", (double)SPACING[k],
					 (double)answers[n].irradiance[0], (double)questions[n].place[0],
					 (double)questions[n].place[1], (double)questions[n].place[2]);
		}
		printf("  spacing %.1f m: mean H of the lit room %.2f W/m2, of the dark one 0; %.1f %% see no probe\n",
		       (double)SPACING[k], (double)bright, 100.0 * unseen / count);
		assert_true(bright > 1);
		assert_true(unseen < count / 5);
	}
	glDeleteProgram(program);
	gi_context_destroy(gi);
}

/* The look-up in the lit room against receivers at the same places, 0.8 m below the lamp and more. At the probes
 * themselves it is 3.9 % off: what bands above 2 have of a lamp in a dim room. */
static void between_probes(void **state)
{
	(void)state;
	enum { SIDE = 5, COUNT = SIDE * SIDE * SIDE * 6 };
	static question questions[COUNT];
	static answer answers[COUNT];
	static float positions[COUNT][3], normals[COUNT][3], light[COUNT][4];
	gi_context *gi = open_rooms();
	for (int k = 0; k < COUNT; k++) {
		const float at[3] = {(float)(k / 6 % SIDE), (float)(k / 6 / SIDE % SIDE), (float)(k / 6 / SIDE / SIDE)};
		memcpy(positions[k], (float[]){-2.8f + .65f * at[0], .2f + .35f * at[1], -1.8f + .9f * at[2]},
		       sizeof positions[k]);
		memcpy(normals[k], DIRECTIONS[k % 6], sizeof normals[k]);
		memcpy(questions[k].place, positions[k], sizeof positions[k]);
		memcpy(questions[k].normal, normals[k], sizeof normals[k]);
	}
	gi_receivers_def r = gi_receivers_def_default();
	r.positions = positions[0];
	r.normals = normals[0];
	r.count = COUNT;
	gi_receivers exact, probes;
	assert_gi(gi_create_receivers(gi, &r, &exact));
	gi_probes_def def = gi_probes_def_default();
	memcpy(def.lower, (float[]){-2.75f, .25f, -1.75f}, sizeof def.lower);
	def.spacing = .5f;
	memcpy(def.count, (uint32_t[]){6, 5, 8}, sizeof def.count);
	assert_gi(gi_create_probes(gi, &def, &probes));
	assert_gi(gi_commit(gi));
	harness_update(gi);
	const GLuint program = compile();
	ask(gi, probes, program, questions, COUNT, answers);
	uint32_t count;
	assert_gi(gi_read_receivers(gi, exact, light[0], COUNT, &count));
	double off = 0, all = 0;
	for (int k = 0; k < COUNT; k++)
		for (int c = 0; c < 3; c++) {
			off += pow((double)answers[k].irradiance[c] - (double)light[k][c], 2);
			all += pow((double)light[k][c], 2);
		}
	printf("  between probes 0.5 m apart: %.1f %% off receivers in the same places\n", 100 * sqrt(off / all));
	assert_true(sqrt(off / all) < .08);
	glDeleteProgram(program);
	gi_context_destroy(gi);
}

/* ---- what moves ---- */

static float *read_planes(gi_context *gi, gi_receivers probes, uint32_t count)
{
	gi_probe_buffers b;
	assert_gi(gi_finish(gi));
	assert_gi(gi_get_probe_buffers(gi, probes, &b));
	float *planes = malloc(256 * 16 * (size_t)count);
	assert_non_null(planes);
	glGetNamedBufferSubData(b.planes, 256 * 16 * (GLintptr)b.grid.first_plane / 256, 256 * 16 * (GLsizeiptr)count,
				planes);
	return planes;
}

static void planes_follow(void **state)
{
	(void)state;
	enum { COUNT = 4 * 4 * 4 };
	const gi_context_def context_def = harness_def();
	scene s;
	open_box(&s, &context_def);
	gi_receivers probes;
	gi_probes_def def = gi_probes_def_default();
	memcpy(def.lower, (float[]){-2, .5f, -2}, sizeof def.lower);
	def.spacing = 1.3f;
	def.count[0] = def.count[1] = def.count[2] = 4;
	assert_gi(gi_create_probes(s.gi, &def, &probes));
	assert_gi(gi_commit(s.gi));
	harness_update(s.gi);
	seed_motion(9);
	motion m = start_motion(false);
	uint32_t changes = 0;
	float *before = read_planes(s.gi, probes, COUNT);
	for (uint32_t frame = 0; frame < 6; frame++) {
		bool moved[MOVERS];
		next_poses(&m, moved);
		for (int k = 0; k < MOVERS; k++)
			if (moved[k])
				assert_gi(gi_set_pose(s.gi, s.mover[k], m.pose[k]));
		harness_update(s.gi);
		float *kept = read_planes(s.gi, probes, COUNT);
		gi_invalidate(s.gi);
		harness_update(s.gi);
		float *anew = read_planes(s.gi, probes, COUNT);
		assert_memory_equal(kept, anew, 256 * 16 * COUNT);
		changes += memcmp(before, anew, 256 * 16 * COUNT) != 0;
		free(before);
		free(kept);
		before = anew;
	}
	free(before);
	assert_true(changes >= 3);
	gi_context_destroy(s.gi);
}

static void bad_definitions(void **state)
{
	(void)state;
	const gi_context_def context_def = harness_def();
	gi_context *gi = harness_context(&context_def);
	gi_probes_def good = gi_probes_def_default(), bad;
	good.spacing = 1;
	good.count[0] = good.count[1] = good.count[2] = 2;
	gi_receivers out;
	bad = good, bad.internal = 0;
	assert_int_equal(gi_create_probes(gi, &bad, &out), GI_ERROR_INVALID_DEF);
	bad = good, bad.spacing = 0;
	assert_int_equal(gi_create_probes(gi, &bad, &out), GI_ERROR_INVALID_ARGUMENT);
	bad = good, bad.count[1] = 0;
	assert_int_equal(gi_create_probes(gi, &bad, &out), GI_ERROR_INVALID_ARGUMENT);
	bad = good, bad.count[1] = bad.count[0] = 1u << 31;
	assert_int_equal(gi_create_probes(gi, &bad, &out), GI_ERROR_INVALID_ARGUMENT);
	bad = good, bad.harmonics = 0;
	assert_int_equal(gi_create_probes(gi, &bad, &out), GI_ERROR_INVALID_ARGUMENT);
	bad = good, bad.refinement = 0;
	assert_int_equal(gi_create_probes(gi, &bad, &out), GI_ERROR_INVALID_ARGUMENT);
	bad = good, bad.samples = 17;
	assert_int_equal(gi_create_probes(gi, &bad, &out), GI_ERROR_INVALID_ARGUMENT);
	bad = good, bad.lower[2] = NAN;
	assert_int_equal(gi_create_probes(gi, &bad, &out), GI_ERROR_INVALID_ARGUMENT);
	assert_gi(gi_create_probes(gi, &good, &out));
	assert_int_equal(gi_set_receivers_pose(gi, out, gi_pose_identity()), GI_ERROR_INVALID_ARGUMENT);
	gi_probe_buffers buffers;
	assert_int_equal(gi_get_probe_buffers(gi, out, &buffers), GI_ERROR_NOT_COMMITTED);
	gi_context_destroy(gi);
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(bad_definitions), cmocka_unit_test(wall_between),
					   cmocka_unit_test(between_probes), cmocka_unit_test(planes_follow)};
	return cmocka_run_group_tests_name("probes", tests, harness_open, harness_close);
}
