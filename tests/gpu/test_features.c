/* What a scene does not use is not compiled, not allocated and not run: programs, buffers, dispatches and milliseconds
 * of a scene with everything, and with everything but one thing.
 *
 * Whoever adds to the library adds a line to `features` and what the scene does with it to make_objects or play.
 */
#include "harness.h"

#include "scenes/body.h"
#include "scenes/shapes.h"

#include <glad/gl.h>

#include <stdio.h>
#include <string.h>

enum { NAMES = 8192, SIDE = 64, MOST_LABELS = 8, FRAMES = 3 };

typedef enum feature {
	MOTION,
	STATICS,
	KEPT_ROWS,
	SKY,
	SKY_IMAGE,
	SPECULAR,
	CAUSTICS,
	SUBSURFACE,
	TWO_SIDES,
	BUDGET,
	ESTIMATE,
	PIXEL_LAMPS,
	PICTURE,
	TEXTURES,
	RECEIVERS,
	HARMONICS,
	PROBES,
	MARKS,
	LIGHTS,
	DEFORMING,
	FEATURES
} feature;

#define OF(feature) (1u << (feature))
#define ALL (OF(FEATURES) - 1)

/* `labels`: how the labels of programs and buffers begin, behind "gi ", that are there for the feature alone. */
static const struct {
	const char *without;
	const char *labels[MOST_LABELS];
} features[FEATURES] = {
    [MOTION] = {"nothing moves", {"concern.comp", "flag.comp", "unmark.comp"}},
    [STATICS] = {"no static objects", {"trace_tops.comp", "covered.comp", "cut_kept.comp"}},
    [KEPT_ROWS] = {"no second commit", {"renumber.comp"}},
    [SKY] = {"no sky", {NULL}},
    [SKY_IMAGE] = {"no picture of the sky", {"texels of the sky", "mirror_sky"}},
    [SPECULAR] = {"no mirrors, no glass",
		  {"specular_path", "gather_specular", "close_specular", "smooth ", "ends of ways", "mirror"}},
    [CAUSTICS] = {"no caustics", {"caustic", "splat.frag"}},
    [SUBSURFACE] = {"nothing translucent", {"diffusion_", "gather_translucent", "rows below", "links below"}},
    [TWO_SIDES] = {"one-sided only", {NULL}},
    [BUDGET] = {"no budget", {"choose.comp", "enlist.comp", "stale.comp", "choices", "pending"}},
    [ESTIMATE] = {"no estimate", {"estimate"}},
    [PIXEL_LAMPS] = {"no lamps per pixel",
		     {"light_more", "light_last", "shadow.frag", "shadow casters", "lamps", "occluder masks"}},
    [PICTURE] = {"no drawing", {"surface", "drawn surfaces", "surfaces", "whole picture"}},
    [TEXTURES] = {"no textures in pictures",
		  {"surface_textured.frag", "surface_albedo.frag", "light_last_albedo", "texture coordinates"}},
    [RECEIVERS] = {"no receivers", {"receive", "light of receivers"}},
    [HARMONICS] = {"no harmonics", {"receive_harmonics", "trace_round.comp", "factor_round.comp"}},
    [PROBES] = {"no probes", {"probe_planes", "planes about probes"}},
    [MARKS] = {"no overlay of receivers", {"receivers.frag", "a receiver"}},
    [LIGHTS] = {"no lights but emitters",
		{"punctual_", "emitted_specular_punctual", "receive_punctual", "light_punctual.frag",
		 "lights without a surface", "lights: ", "lights of pictures"}},
    [DEFORMING] = {"nothing deforms", {"cut_own.comp"}},
};

/* ---- OpenGL's objects by name ---- */

static bool hosts_program[NAMES], hosts_buffer[NAMES], hosts_texture[NAMES];

static void note_hosts(void)
{
	for (GLuint name = 1; name < NAMES; name++) {
		hosts_program[name] = glIsProgram(name);
		hosts_buffer[name] = glIsBuffer(name);
		hosts_texture[name] = glIsTexture(name);
	}
}

typedef struct counts {
	uint32_t programs, buffers, nodes, leaves, dispatches;
	uint64_t bytes;
	float ms;
	bool seen[FEATURES][MOST_LABELS];
} counts;

static void note_label(GLenum kind, GLuint name, counts *out)
{
	char label[128] = "";
	glGetObjectLabel(kind, name, sizeof label, NULL, label);
	for (int f = 0; f < FEATURES; f++)
		for (int k = 0; k < MOST_LABELS && features[f].labels[k]; k++)
			out->seen[f][k] = out->seen[f][k] || strncmp(label + strlen("gi "), features[f].labels[k],
								     strlen(features[f].labels[k])) == 0;
}

static void count_objects(counts *out)
{
	for (GLuint name = 1; name < NAMES; name++) {
		GLint deleted = 0;
		GLint64 size = 0;
		if (glIsProgram(name) && !hosts_program[name]) {
			glGetProgramiv(name, GL_DELETE_STATUS, &deleted);
			out->programs += !deleted;
			if (!deleted)
				note_label(GL_PROGRAM, name, out);
		}
		if (glIsBuffer(name) && !hosts_buffer[name]) {
			glGetNamedBufferParameteri64v(name, GL_BUFFER_SIZE, &size);
			out->buffers++;
			out->bytes += (uint64_t)size;
			note_label(GL_BUFFER, name, out);
		}
		if (glIsTexture(name) && !hosts_texture[name])
			note_label(GL_TEXTURE, name, out);
	}
}

/* ---- the scene ---- */

typedef struct scene {
	gi_context *gi;
	uint32_t has; /* of features */
	gi_object floor, mover;
} scene;

static bool has(const scene *s, feature f)
{
	return s->has & OF(f);
}

static gi_context *open_context(uint32_t features_on)
{
	gi_context_def def = harness_def();
	def.row_tolerance = .1f;
	def.sky = features_on & OF(SKY) ? GI_SKY_ON : GI_SKY_OFF;
	def.sky_exitance[2] = features_on & OF(SKY) ? 1 : 0;
	def.estimate_leaves = features_on & OF(ESTIMATE) ? 8 : 0;
	def.pixel_lamps = features_on & OF(PIXEL_LAMPS) ? 4 : 0;
	def.caustic_photons = features_on & OF(CAUSTICS) ? 64 : 0;
	return harness_context(&def);
}

static gi_object add(const scene *s, const char *name, engine_mesh *cage, gi_mobility mobility, gi_object_def def)
{
	gi_object object;
	const gi_object_def of_cage = scene_mesh_def(cage);
	def.name = name;
	def.positions = of_cage.positions;
	def.vertex_count = of_cage.vertex_count;
	def.indices = of_cage.indices;
	def.index_count = of_cage.index_count;
	def.face_counts = of_cage.face_counts;
	def.face_count = of_cage.face_count;
	def.mobility = mobility;
	if (gi_create_object(s->gi, &def, &object))
		fail_msg("%s", harness_last_message());
	engine_mesh_free(cage);
	return object;
}

/* Up, or down. */
static void make_square(float x, float y, float half, bool up, uint32_t cells, engine_mesh *out)
{
	const float along_x[3] = {2 * half, 0, 0}, along_z[3] = {0, 0, 2 * half};
	assert_true(shape_quad((float[]){x - half, y, -half}, up ? along_z : along_x, up ? along_x : along_z, cells,
			       cells, out));
}

/* The same place of the texture everywhere. */
static const float no_place[2 * 4 * 8 * 8];
static GLuint texture;

static void set_texture(const scene *s)
{
	static const float grey[4] = {.5f, .5f, .5f, 1};
	gi_textures t = gi_textures_default();
	if (!has(s, TEXTURES))
		return;
	if (!texture) {
		glCreateTextures(GL_TEXTURE_2D, 1, &texture);
		glTextureStorage2D(texture, 1, GL_RGBA32F, 1, 1);
		glTextureSubImage2D(texture, 0, 0, 0, 1, 1, GL_RGBA, GL_FLOAT, grey);
	}
	t.base_color = texture;
	assert_gi(gi_set_textures(s->gi, s->floor, 0, &t));
}

static void make_objects(scene *s)
{
	static const gi_material lamp = {.exitance = {20, 20, 20}}, grey = {.rho = {.5f, .5f, .5f}};
	static const gi_specular mirror = {.reflectance = {.5f, .5f, .5f}};
	static const gi_subsurface marble = {{2000, 2000, 2000}, {2, 2, 2}, 1.5f};
	const gi_mobility still = has(s, STATICS) ? GI_MOBILITY_STATIC : GI_MOBILITY_MOVABLE;
	gi_object_def def = gi_object_def_default();
	engine_mesh mesh;
	def.materials = &grey;
	def.material_count = 1;
	make_square(0, 0, 2, true, 8, &mesh);
	def.uvs = has(s, TEXTURES) ? no_place : NULL;
	s->floor = add(s, "floor", &mesh, still, def);
	def.uvs = NULL;
	set_texture(s);
	make_square(-1, 1.5f, .4f, true, 3, &mesh);
	def.double_sided = has(s, TWO_SIDES);
	add(s, "sheet", &mesh, still, def);
	def.double_sided = false;
	make_square(0, 3, .5f, false, 1, &mesh);
	def.materials = &lamp;
	add(s, "lamp", &mesh, still, def);
	def.materials = &grey;
	assert_true(shape_box((float[]){-.2f, -.2f, -.2f}, (float[]){.2f, .2f, .2f}, 1, false, &mesh));
	def.specular = has(s, SPECULAR) ? &mirror : NULL;
	def.pose.position[1] = .5f;
	def.deforms = has(s, DEFORMING);
	s->mover = add(s, "mover", &mesh, has(s, MOTION) ? GI_MOBILITY_MOVABLE : GI_MOBILITY_STATIC, def);
	def.specular = NULL;
	def.deforms = false;
	assert_true(shape_sphere(.3f, 2, &mesh));
	def.subsurface = has(s, SUBSURFACE) ? &marble : NULL;
	def.pose.position[0] = 1;
	add(s, "ball", &mesh, still, def);
}

static void make_receivers(const scene *s)
{
	static const float points[6] = {-1, 1, 0, 1, 1, .5f}, normals[6] = {0, 1, 0, 0, 1, 0};
	gi_receivers_def def = gi_receivers_def_default();
	gi_receivers receivers;
	def.positions = points;
	def.normals = normals;
	def.count = 2;
	if (has(s, RECEIVERS))
		assert_gi(gi_create_receivers(s->gi, &def, &receivers));
	def.harmonics = 1;
	if (has(s, HARMONICS))
		assert_gi(gi_create_receivers(s->gi, &def, &receivers));
	gi_probes_def grid = gi_probes_def_default();
	grid.lower[1] = grid.spacing = 1;
	grid.count[0] = grid.count[1] = grid.count[2] = 2;
	if (has(s, PROBES))
		assert_gi(gi_create_probes(s->gi, &grid, &receivers));
}

/* Brighter at one side. */
static void set_sky_image(const scene *s)
{
	static float radiance[3 * 8 * 4];
	for (int k = 0; k < 3 * 8 * 4; k++)
		radiance[k] = k % 24 < 6 ? 1 : .2f;
	assert_gi(gi_set_sky_image(s->gi, radiance, 8, 4, NULL));
}

static void make_light(const scene *s)
{
	gi_light_def def = gi_light_def_default();
	gi_light light;
	def.position[1] = 2;
	def.shown = has(s, PIXEL_LAMPS) ? GI_LIGHT_BY_PIXELS : GI_LIGHT_BY_LEAVES;
	if (has(s, LIGHTS))
		assert_gi(gi_create_light(s->gi, &def, &light));
}

static void draw(const scene *s)
{
	const float world[16] = {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1},
		    clip[16] = {.5f, 0, 0, 0, 0, .5f, 0, 0, 0, 0, -.2f, 0, 0, 0, 0, 1};
	gi_view view = gi_view_default();
	memcpy(view.view_from_world, world, sizeof world);
	memcpy(view.clip_from_view, clip, sizeof clip);
	view.width = view.height = SIDE;
	glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
	assert_gi(gi_draw(s->gi, &view));
	/* Without receivers it makes nothing either. */
	view.overlay = GI_OVERLAY_RECEIVERS;
	if (has(s, MARKS))
		assert_gi(gi_draw(s->gi, &view));
}

static float milliseconds(const gi_report *r)
{
	float sum = 0;
	for (int k = 0; k < GI_PASS_COUNT; k++)
		sum += r->pass_ms[k];
	return sum;
}

/* The median of three. */
static float middle(const float ms[FRAMES])
{
	const float low = ms[0] < ms[1] ? ms[0] : ms[1], high = ms[0] < ms[1] ? ms[1] : ms[0];
	return ms[2] < low ? low : ms[2] > high ? high : ms[2];
}

/* Frames in which the mover moves, or else the floor has another colour. */
static void play(scene *s, counts *out)
{
	float ms[FRAMES];
	gi_report r;
	for (int frame = 0; frame < FRAMES; frame++) {
		const float at = .1f * (float)(frame + 1);
		if (has(s, MOTION))
			assert_gi(gi_set_pose(s->gi, s->mover, (gi_pose){{at, .5f, at}, {0, 0, 0, 1}}));
		else
			assert_gi(gi_set_material(s->gi, s->floor, 0, (gi_material){.rho = {at, .5f, .5f}}));
		if (has(s, DEFORMING))
			assert_gi(gi_set_scale(s->gi, s->mover, (float[]){1 + at, 1, 1}));
		if (has(s, BUDGET))
			assert_gi(gi_update(s->gi, &(gi_budget){.rays = 200}));
		else
			assert_gi(gi_update(s->gi, NULL));
		if (has(s, PICTURE))
			draw(s);
		assert_gi(gi_finish(s->gi));
		assert_gi(gi_get_report(s->gi, &r));
		ms[frame] = milliseconds(&r);
	}
	out->ms = middle(ms);
	out->dispatches = r.dispatches;
	out->nodes = r.nodes;
	out->leaves = r.leaves;
}

static counts count_scene(uint32_t features_on)
{
	counts c = {0};
	scene s = {.has = features_on};
	note_hosts();
	s.gi = open_context(features_on);
	make_objects(&s);
	make_receivers(&s);
	make_light(&s);
	if (has(&s, SKY_IMAGE))
		set_sky_image(&s);
	assert_gi(gi_commit(s.gi));
	harness_update(s.gi);
	if (has(&s, KEPT_ROWS)) {
		assert_gi(gi_commit(s.gi));
		harness_update(s.gi);
	}
	play(&s, &c);
	count_objects(&c);
	gi_context_destroy(s.gi);
	return c;
}

/* ---- what must not be there ---- */

static void expect_absent(const counts *c, uint32_t features_on, const char *row)
{
	for (int f = 0; f < FEATURES; f++)
		for (int k = 0; k < MOST_LABELS && features[f].labels[k]; k++)
			if (!(features_on & OF(f)) && c->seen[f][k])
				fail_msg("%s: there is a '%s'", row, features[f].labels[k]);
}

static void expect_present(const counts *c)
{
	for (int f = 0; f < FEATURES; f++)
		for (int k = 0; k < MOST_LABELS && features[f].labels[k]; k++)
			if (!c->seen[f][k])
				fail_msg("everything: there is no '%s'", features[f].labels[k]);
}

static void print_row(const char *name, const counts *c)
{
	printf("| %s | %u | %u | %.2f | %u | %.2f |\n", name, c->programs, c->buffers, (double)c->bytes / (1 << 20),
	       c->dispatches, (double)c->ms);
}

/* What goes with a feature: a commit that keeps rows takes what updates of moving scenes take, photons go through
 * mirrors, lamps light pixels. */
static uint32_t without(feature f)
{
	static const uint32_t takes[FEATURES] = {[MOTION] = OF(KEPT_ROWS) | OF(DEFORMING),
						 [SKY] = OF(SKY_IMAGE),
						 [SPECULAR] = OF(CAUSTICS),
						 [PICTURE] = OF(PIXEL_LAMPS) | OF(MARKS) | OF(TEXTURES),
						 [RECEIVERS] = OF(HARMONICS) | OF(PROBES),
						 [HARMONICS] = OF(PROBES)};
	return ALL & ~OF(f) & ~takes[f];
}

static GLuint open_framebuffer(GLuint parts[2])
{
	GLuint framebuffer;
	glCreateRenderbuffers(2, parts);
	glNamedRenderbufferStorage(parts[0], GL_RGBA32F, SIDE, SIDE);
	glNamedRenderbufferStorage(parts[1], GL_DEPTH_COMPONENT32F, SIDE, SIDE);
	glCreateFramebuffers(1, &framebuffer);
	glNamedFramebufferRenderbuffer(framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, parts[0]);
	glNamedFramebufferRenderbuffer(framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, parts[1]);
	glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
	glViewport(0, 0, SIDE, SIDE);
	return framebuffer;
}

static void what_is_not_used_is_not_there(void **state)
{
	(void)state;
	harness_require_context();
	GLuint parts[2], framebuffer = open_framebuffer(parts);
	printf("| scene | programs | buffers | MiB | dispatches a frame | ms a frame |\n|---|---|---|---|---|---|\n");
	const counts everything = count_scene(ALL);
	print_row("everything", &everything);
	expect_present(&everything);
	for (feature f = 0; f < FEATURES; f++) {
		if (!harness_is_long() && f != MOTION && f != PICTURE)
			continue;
		const counts c = count_scene(without(f));
		print_row(features[f].without, &c);
		expect_absent(&c, without(f), features[f].without);
		assert_true(f != SKY || c.nodes < everything.nodes);
		assert_true(f != TWO_SIDES || c.leaves < everything.leaves);
	}
	/* Where nothing moves all is static. */
	const counts bare = count_scene(OF(STATICS));
	print_row("none of these", &bare);
	expect_absent(&bare, OF(STATICS), "none of these");
	glDeleteFramebuffers(1, &framebuffer);
	glDeleteRenderbuffers(2, parts);
	glDeleteTextures(1, &texture);
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(what_is_not_used_is_not_there)};
	return cmocka_run_group_tests_name("features", tests, harness_open, harness_close);
}
