/* Where features meet: lights without a surface, receivers, a picture of the sky, shapes that change, mirrors and
 * translucent objects, instances and textures in one scene.
 */
#include "snapshot.h"

#include "scenes/body.h"
#include "scenes/look_at.h"
#include "scenes/shapes.h"
#include "target.h"

#include <glad/gl.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- receivers and trees ---- */

static gi_receivers add_fine_points(gi_context *gi, const float *positions, uint32_t count, bool facing,
				    float refinement, uint32_t samples)
{
	static const float up[3 * 4] = {0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0};
	gi_receivers_def def = gi_receivers_def_default();
	gi_receivers out;
	def.positions = positions;
	def.normals = facing ? up : NULL;
	def.count = count;
	def.harmonics = facing ? 0 : 2;
	def.refinement = refinement;
	def.samples = samples;
	assert_gi(gi_create_receivers(gi, &def, &out));
	return out;
}

static gi_receivers add_points(gi_context *gi, const float *positions, uint32_t count, bool facing)
{
	const gi_receivers_def def = gi_receivers_def_default();
	return add_fine_points(gi, positions, count, facing, def.refinement, def.samples);
}

static gi_light add_light(gi_context *gi, gi_light_type type, const float position[3], const float direction[3])
{
	gi_light_def def = gi_light_def_default();
	gi_light out;
	def.type = type;
	memcpy(def.position, position, sizeof def.position);
	memcpy(def.direction, direction, sizeof def.direction);
	memcpy(def.intensity, (float[]){9, 9, 9}, sizeof def.intensity);
	if (type == GI_LIGHT_DIRECTIONAL)
		memcpy(def.intensity, (float[]){3, 2, 1}, sizeof def.intensity);
	if (gi_create_light(gi, &def, &out))
		fail_msg("gi_create_light: %s", harness_last_message());
	return out;
}

/* Red light of the first of some points; of round ones its first coefficient. */
static double first_light(gi_context *gi, gi_receivers points)
{
	float light[4 * 36];
	uint32_t count;
	assert_gi(gi_read_receivers(gi, points, light, 36, &count));
	return (double)light[0];
}

/* A plate that would be in between, were it not far away: `there` is its place. */
static double light_below_plate(bool facing, float there, bool by_sky)
{
	gi_context_def def = harness_def();
	def.sky = GI_SKY_ON;
	if (by_sky)
		def.sky_exitance[0] = 1;
	gi_context *gi = harness_context(&def);
	engine_mesh m;
	assert_true(shape_quad((float[]){-2, 0, -2}, (float[]){4, 0, 0}, (float[]){0, 0, 4}, 1, 1, &m));
	harness_add(gi, &(harness_object){.name = "plate", .position = {there}}, &m);
	const gi_receivers points = add_points(gi, (float[]){0, -1, 0}, 1, facing);
	if (!by_sky)
		add_light(gi, GI_LIGHT_POINT, (float[]){0, 2, 0}, (float[]){0, 0, -1});
	assert_gi(gi_commit(gi));
	harness_update(gi);
	const double light = first_light(gi, points);
	gi_context_destroy(gi);
	return light;
}

/* What the numbers of a set's light are must not be taken for a tree of its own, which would be another object's. */
static void receivers_hide_nothing(void **state)
{
	(void)state;
	harness_require_context();
	for (int k = 0; k < 4; k++) {
		const bool facing = k & 1, by_sky = k & 2;
		const double below = light_below_plate(facing, 0, by_sky),
			     clear = light_below_plate(facing, 1e4f, by_sky);
		/* Of a sky of E = 1 a round one has 4 Y_00 pi, of a light that brings 1 the quarter of that. */
		const double wanted = facing ? 1 : (by_sky ? 4 : 1) * .282095 * 3.14159265;
		printf("%s by %s: %.5f below a plate, %.5f far from it\n", facing ? "facing" : "round",
		       by_sky ? "sky" : "light", below, clear);
		assert_true(by_sky ? below < .8 * wanted : below == 0);
		assert_float_equal(clear, wanted, 1e-3 * wanted);
	}
}

/* A floor with all else above it hides nothing between objects, but from points below it all of them. */
static void walls_hide_from_points_behind_them(void **state)
{
	(void)state;
	gi_context_def def = harness_def();
	gi_context *gi = harness_context(&def);
	engine_mesh m;
	assert_true(shape_quad((float[]){-2, 0, -2}, (float[]){0, 0, 4}, (float[]){4, 0, 0}, 1, 1, &m));
	gi_object floor = harness_add(gi, &(harness_object){.name = "floor", .rho = {.5f, .5f, .5f}}, &m);
	assert_true(shape_quad((float[]){-1, 1, -1}, (float[]){2, 0, 0}, (float[]){0, 0, 2}, 1, 1, &m));
	harness_add(gi, &(harness_object){.name = "lamp", .exitance = {1, 1, 1}}, &m);
	const gi_receivers below = add_points(gi, (float[]){0, -.2f, 0}, 1, true),
			   above = add_points(gi, (float[]){0, .2f, 0}, 1, true);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	const double lit = first_light(gi, above);
	printf("above the floor %g, below it %g W/m2\n", lit, first_light(gi, below));
	assert_true(lit > .1 && first_light(gi, below) == 0);
	assert_gi(gi_set_hidden(gi, floor, true));
	harness_update(gi);
	assert_true(first_light(gi, below) > .1);
	gi_context_destroy(gi);
}

/* There is no surface to light. */
static void receivers_alone(void **state)
{
	(void)state;
	gi_context_def def = harness_def();
	gi_context *gi = harness_context(&def);
	const gi_receivers facing = add_points(gi, (float[]){0, -1, 0}, 1, true),
			   round = add_points(gi, (float[]){0, -1, 0}, 1, false);
	add_light(gi, GI_LIGHT_POINT, (float[]){0, 2, 0}, (float[]){0, 0, -1});
	assert_gi(gi_commit(gi));
	harness_update(gi);
	printf("alone: %g %g\n", first_light(gi, facing), first_light(gi, round));
	assert_float_equal(first_light(gi, facing), 1, 1e-3);
	gi_context_destroy(gi);
}

/* ---- lights ---- */

static double largest_radiosity(gi_context *gi)
{
	snapshot s = snapshot_take(gi);
	const double largest = snapshot_largest(&s);
	for (uint32_t k = 0; k < s.leaf_count; k++)
		assert_true(isfinite(s.leaves[k].radiosity[0]));
	snapshot_free(&s);
	return largest;
}

/* A point shines all round, whatever its direction; moved out of the room it leaves the room dark, and at rest. */
static void turned_away(void **state)
{
	(void)state;
	gi_context_def def = harness_def();
	gi_context *gi = harness_context(&def);
	engine_mesh m;
	assert_true(shape_box((float[]){-1, -1, -1}, (float[]){1, 1, 1}, 4, true, &m));
	harness_add(gi, &(harness_object){.name = "room", .rho = {.9f, .9f, .9f}}, &m);
	gi_light light = add_light(gi, GI_LIGHT_POINT, (float[]){0, .5f, 0}, (float[]){NAN, INFINITY, 0});
	assert_gi(gi_commit(gi));
	gi_report r = harness_update(gi);
	printf("lit: outcome %d sweeps %u B %g\n", r.outcome, r.sweeps, largest_radiosity(gi));
	assert_true(largest_radiosity(gi) > 0);
	gi_light_def away;
	assert_gi(gi_get_light(gi, light, &away));
	away.position[1] = 5;
	assert_gi(gi_set_light(gi, light, &away));
	for (int k = 0; k < 3; k++) {
		r = harness_update(gi);
		printf("away: outcome %d sweeps %u B %g bound %g relative %g\n", r.outcome, r.sweeps,
		       largest_radiosity(gi), (double)r.solve_bound, (double)r.solve_relative);
	}
	assert_true(r.outcome == GI_OUTCOME_AT_REST);
	gi_context_destroy(gi);
}

/* ---- everything ---- */

enum { POINTS = 4, MOVERS = 4, LIGHTS = 3, COPIES = 3, SIZE = 48 };

typedef struct world {
	gi_context *gi;
	engine_mesh skin; /* as defined */
	gi_object floor, movers[MOVERS], visitor;
	gi_object copies[COPIES]; /* instances of movers, or of each other */
	bool bends[COPIES];       /* they are of the one that deforms */
	bool two_sided;           /* that is */
	gi_overlay overlay;
	gi_mode mode;
	GLuint textures[2];
	target target;
	gi_light lights[LIGHTS];
	gi_receivers facing, round, fixed, probes;
} world;

static uint32_t state_of_chance;

static uint32_t chance(uint32_t below)
{
	state_of_chance = state_of_chance * 1664525u + 1013904223u;
	return (state_of_chance >> 10) % below;
}

static float between(float low, float high)
{
	return low + (high - low) * (float)chance(1000) / 1000.0f;
}

static gi_object add_special(world *w, engine_mesh *m, const gi_specular *specular, const gi_subsurface *subsurface,
			     bool deforms, const float position[3])
{
	const gi_material material = {.rho = {.3f, .4f, .5f}};
	gi_object_def def = scene_mesh_def(m);
	gi_object out;
	float uvs[2 * 512];
	assert_in_range(m->index_count, 1, 512);
	for (uint32_t k = 0; k < m->index_count; k++) {
		uvs[2 * k] = m->positions[3 * m->indices[k]];
		uvs[2 * k + 1] = k % 5 ? m->positions[3 * m->indices[k] + 1] : 1;
	}
	def.uvs = uvs;
	def.name = "special";
	def.materials = &material;
	def.material_count = 1;
	def.specular = specular;
	def.subsurface = subsurface;
	def.deforms = deforms;
	def.double_sided = deforms && w->two_sided;
	def.leaf_materials = deforms && !w->two_sided;
	if (deforms)
		def.scheme = GI_SCHEME_CATMULL_CLARK;
	memcpy(def.pose.position, position, sizeof def.pose.position);
	if (gi_create_object(w->gi, &def, &out))
		fail_msg("gi_create_object: %s", harness_last_message());
	return out;
}

static void set_sky(world *w, uint32_t kind)
{
	float picture[3 * 8 * 4];
	for (int k = 0; k < 3 * 8 * 4; k++)
		picture[k] = .05f + .01f * (float)(k % 7);
	if (kind == 1)
		for (int c = 0; c < 3; c++)
			picture[3 * (int)chance(16) + c] = 40;
	assert_gi(gi_set_sky_image(w->gi, kind == 2 ? NULL : picture, 8, 4, NULL));
}

static GLuint make_texture(void)
{
	float texels[4 * 16];
	GLuint name;
	for (int k = 0; k < 4 * 16; k++)
		texels[k] = between(0, 1);
	glCreateTextures(GL_TEXTURE_2D, 1, &name);
	glTextureStorage2D(name, 1, GL_RGBA32F, 4, 4);
	glTextureSubImage2D(name, 0, 0, 0, 4, 4, GL_RGBA, GL_FLOAT, texels);
	glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	return name;
}

static void open_world(world *w, bool specular, bool two_sided)
{
	gi_context_def def = harness_def();
	def.row_tolerance = .08f;
	def.caustic_photons = 256;
	def.sky = GI_SKY_ON;
	*w = (world){.gi = harness_context(&def), .two_sided = two_sided, .target = target_make(SIZE)};
	for (int k = 0; k < 2; k++)
		w->textures[k] = make_texture();
	engine_mesh m;
	assert_true(shape_quad((float[]){-2, 0, -2}, (float[]){0, 0, 4}, (float[]){4, 0, 0}, 5, 5, &m));
	w->floor = harness_add(w->gi, &(harness_object){.name = "floor", .rho = {.5f, .5f, .5f}}, &m);
	assert_true(shape_sphere(.4f, 2, &w->skin));
	w->movers[0] = add_special(w, &w->skin, NULL, NULL, true, (float[]){-.6f, 1, 0});
	assert_true(shape_quad((float[]){-.8f, -.6f, 0}, (float[]){1.6f, 0, 0}, (float[]){0, 1.2f, 0}, 2, 2, &m));
	const gi_specular mirror = {.reflectance = {.5f, .4f, .3f}};
	w->movers[1] = add_special(w, &m, specular ? &mirror : NULL, NULL, false, (float[]){0, .8f, -1.5f});
	engine_mesh_free(&m);
	assert_true(shape_sphere(.3f, 2, &m));
	const gi_subsurface milk = {{100, 120, 140}, {1, 2, 3}, 1.3f};
	w->movers[2] = add_special(w, &m, NULL, &milk, false, (float[]){.7f, .5f, .3f});
	engine_mesh_free(&m);
	assert_true(shape_box((float[]){-.3f, -.3f, -.3f}, (float[]){.3f, .3f, .3f}, 1, false, &m));
	w->movers[3] = harness_add(
	    w->gi, &(harness_object){.name = "block", .rho = {.2f, .5f, .7f}, .position = {.2f, 1.5f, .5f}}, &m);
	w->lights[0] = add_light(w->gi, GI_LIGHT_POINT, (float[]){.3f, 2.5f, .2f}, (float[]){0, 0, -1});
	w->lights[1] = add_light(w->gi, GI_LIGHT_DIRECTIONAL, (float[]){0, 0, 0}, (float[]){.3f, -1, .2f});
	w->lights[2] = add_light(w->gi, GI_LIGHT_SPOT, (float[]){-1, 2, 1}, (float[]){.4f, -1, -.5f});
	static const float at[3 * POINTS] = {0, .5f, 0, .5f, .1f, .5f, -.9f, .9f, -.2f, .2f, 1, 1};
	w->facing = add_points(w->gi, at, POINTS, true);
	w->round = add_points(w->gi, at, POINTS, false);
	gi_receivers_def on = gi_receivers_def_default();
	on.positions = at;
	on.normals = at;
	on.count = POINTS;
	on.object = w->movers[3];
	assert_gi(gi_create_receivers(w->gi, &on, &w->fixed));
	gi_probes_def grid = gi_probes_def_default();
	grid.spacing = 1;
	memcpy(grid.lower, (float[]){-.9f, .2f, -.9f}, sizeof grid.lower);
	for (int c = 0; c < 3; c++)
		grid.count[c] = 2;
	assert_gi(gi_create_probes(w->gi, &grid, &w->probes));
	set_sky(w, 0);
	assert_gi(gi_commit(w->gi));
	harness_update(w->gi);
}

/* One of the movers or of the copies that are there. */
static gi_object *any_object(world *w)
{
	const uint32_t which = chance(MOVERS + COPIES);
	gi_object *copy = which < MOVERS ? NULL : &w->copies[which - MOVERS];
	return copy && gi_object_is_valid(w->gi, *copy) ? copy : &w->movers[which % MOVERS];
}

static bool deforms(const world *w, gi_object object)
{
	bool is = object.index1 == w->movers[0].index1;
	for (int k = 0; k < COPIES; k++)
		is = is || (w->bends[k] && object.index1 == w->copies[k].index1);
	return is;
}

static void bend(world *w)
{
	float positions[3 * 200];
	const uint32_t which = chance(2 * COPIES);
	gi_object object = w->movers[0];
	assert_true(w->skin.vertex_count <= 200);
	if (which < COPIES && w->bends[which])
		object = w->copies[which];
	const float a = between(.6f, 1.6f), b = between(-.3f, .3f);
	for (uint32_t v = 0; v < w->skin.vertex_count; v++) {
		const float *p = w->skin.positions + 3 * v;
		positions[3 * v] = a * p[0] + b * p[1];
		positions[3 * v + 1] = p[1] + .1f * sinf(5 * p[0] + 10 * b);
		positions[3 * v + 2] = p[2] / a;
	}
	assert_gi(gi_set_positions(w->gi, object, positions));
}

static void move(world *w)
{
	const gi_pose pose = {{between(-1, 1), between(.5f, 1.6f), between(-1, 1)},
			      {between(-1, 1), between(-1, 1), between(-1, 1), 1.1f}};
	assert_gi(gi_set_pose(w->gi, *any_object(w), pose));
}

static void change_light(world *w)
{
	const uint32_t k = chance(LIGHTS);
	gi_light_def def;
	assert_gi(gi_get_light(w->gi, w->lights[k], &def));
	switch (chance(4)) {
	case 0:
		def.enabled = !def.enabled;
		break;
	case 1:
		def.intensity[chance(3)] = between(0, 5);
		break;
	case 2:
		def.position[chance(3)] += between(-.3f, .3f);
		def.direction[0] += between(-.1f, .1f);
		break;
	default:
		def.type = k == 1 ? def.type : (gi_light_type)chance(2);
		def.radius = between(0, .2f);
	}
	if (chance(5) == 0) {
		assert_gi(gi_destroy_light(w->gi, w->lights[k]));
		assert_gi(gi_create_light(w->gi, &def, &w->lights[k]));
	} else {
		assert_gi(gi_set_light(w->gi, w->lights[k], &def));
	}
}

static void move_points(world *w)
{
	float at[3 * POINTS];
	for (int k = 0; k < 3 * POINTS; k++)
		at[k] = between(-1, 1) + (k % 3 == 1 ? 1.05f : 0);
	assert_gi(gi_set_receivers(w->gi, chance(2) ? w->facing : w->round, at, NULL));
}

static void come_or_go(world *w)
{
	if (gi_object_is_valid(w->gi, w->visitor)) {
		assert_gi(gi_destroy_object(w->gi, w->visitor));
	} else {
		engine_mesh m;
		assert_true(shape_box((float[]){-.2f, -.2f, -.2f}, (float[]){.2f, .2f, .2f}, 1, false, &m));
		w->visitor = harness_add(w->gi,
					 &(harness_object){.name = "visitor",
							   .rho = {.6f, .6f, .6f},
							   .position = {between(-1, 1), between(.4f, 2), .4f}},
					 &m);
	}
	if (chance(3)) {
		static const float at[3 * POINTS] = {0, .5f, 0, .5f, .1f, .5f, -.9f, .9f, -.2f, .2f, 1, 1};
		assert_gi(gi_destroy_receivers(w->gi, w->facing));
		w->facing = add_points(w->gi, at, 1 + chance(POINTS), true);
	}
	if (chance(4))
		assert_gi(gi_commit(w->gi));
}

/* An instance comes or goes, or takes its original's place. */
static void copy_or_drop(world *w)
{
	const uint32_t which = chance(COPIES);
	gi_object *copy = &w->copies[which];
	const gi_pose pose = {{between(-1, 1), between(.5f, 1.6f), between(-1, 1)}, {0, between(-1, 1), 0, 1.1f}};
	if (!gi_object_is_valid(w->gi, *copy)) {
		const gi_object of = *any_object(w);
		w->bends[which] = deforms(w, of);
		assert_gi(gi_create_instance(w->gi, of, pose, copy));
	} else if (w->bends[which] && chance(2)) {
		assert_gi(gi_destroy_object(w->gi, w->movers[0]));
		w->movers[0] = *copy;
		*copy = (gi_object){0};
		w->bends[which] = false;
	} else {
		assert_gi(gi_destroy_object(w->gi, *copy));
		w->bends[which] = false;
	}
	if (chance(3))
		assert_gi(gi_commit(w->gi));
}

/* Of what has coordinates and is not translucent. */
static void set_textures(world *w)
{
	const gi_object object = *any_object(w);
	gi_textures t;
	if (gi_get_textures(w->gi, object, 0, &t))
		return;
	t.base_color = chance(3) ? w->textures[chance(2)] : 0;
	t.emissive = chance(4) ? 0 : w->textures[chance(2)];
	t.alpha_cutoff = chance(3) ? 0 : .5f;
	t.base_color_factor[chance(3)] = between(0, 1);
	t.base_color_transform[chance(2)][chance(3)] = between(-2, 2);
	assert_gi(gi_set_textures(w->gi, object, 0, chance(5) ? &t : NULL));
}

/* Points of another fineness, or fixed to another object, or to the same that went. */
static void renew_points(world *w)
{
	static const float at[3 * POINTS] = {0, .5f, 0, .5f, .1f, .5f, -.9f, .9f, -.2f, .2f, 1, 1};
	gi_receivers_def on = gi_receivers_def_default();
	on.positions = at;
	on.normals = chance(2) ? at : NULL;
	on.harmonics = on.normals ? chance(3) : 1 + chance(2);
	on.count = 1 + chance(POINTS);
	on.object = *any_object(w);
	on.refinement = between(1, chance(2) ? 3 : 40);
	on.samples = 1 + chance(16);
	on.offset = between(0, .1f);
	assert_gi(gi_destroy_receivers(w->gi, w->fixed));
	assert_gi(gi_create_receivers(w->gi, &on, &w->fixed));
	if (chance(3))
		assert_gi(gi_commit(w->gi));
}

static void set_mobility(world *w)
{
	const gi_object object = chance(3) ? *any_object(w) : w->floor;
	const gi_mobility mobility = (gi_mobility)chance(3);
	if (!deforms(w, object) || mobility != GI_MOBILITY_STATIC)
		assert_gi(gi_set_mobility(w->gi, object, mobility));
}

static void act(world *w, char *done)
{
	bool hidden;
	const uint32_t what = chance(14);
	*done = "bmlphcsxritnyo"[what];
	switch (what) {
	case 0:
		bend(w);
		break;
	case 1:
		move(w);
		break;
	case 2:
		change_light(w);
		break;
	case 3:
		move_points(w);
		break;
	case 4: {
		const gi_object o = chance(3) ? *any_object(w) : w->floor;
		assert_gi(gi_get_hidden(w->gi, o, &hidden));
		assert_gi(gi_set_hidden(w->gi, o, !hidden));
		break;
	}
	case 5:
		come_or_go(w);
		break;
	case 6:
		if (chance(3) == 0)
			set_sky(w, chance(3));
		else
			assert_gi(gi_set_sky(w->gi, GI_SKY_ON, (float[]){between(0, 1), .2f, chance(2) ? .1f : 0}));
		break;
	case 7: {
		const gi_material m = {.rho = {between(0, .4f), .3f, .3f}, .exitance = {chance(3) ? 0 : 4, 0, 0}};
		assert_gi(gi_set_material(w->gi, w->movers[3], 0, m));
		break;
	}
	case 9:
		copy_or_drop(w);
		break;
	case 10:
		set_textures(w);
		break;
	case 11:
		renew_points(w);
		break;
	case 12:
		set_mobility(w);
		break;
	case 13:
		w->overlay = (gi_overlay)chance(GI_OVERLAY_RECEIVERS + 1);
		w->mode = (gi_mode)chance(3);
		break;
	default:
		assert_gi(gi_set_scale(w->gi, w->movers[0], (float[]){between(.5f, 1.5f), 1, between(.5f, 1.5f)}));
	}
}

typedef struct picture {
	snapshot rows;
	float light[4][4 * 9 * 8];
	uint32_t counts[4];
	float pixels[SIZE * SIZE][4];
} picture;

static picture look(world *w)
{
	picture p = {0};
	gi_view view = gi_view_default();
	view.overlay = w->overlay;
	view.mode = w->mode;
	gi_reset_radiosity(w->gi);
	harness_update(w->gi);
	p.rows = snapshot_take(w->gi);
	const gi_receivers sets[4] = {w->facing, w->round, w->fixed, w->probes};
	for (int k = 0; k < 4; k++) {
		gi_receiver_buffer b;
		if (gi_get_receiver_buffer(w->gi, sets[k], &b) == GI_OK)
			assert_gi(gi_read_receivers(w->gi, sets[k], p.light[k], 72, &p.counts[k]));
	}
	look_at((float[]){1.5f, 2.5f, 2.5f}, (float[]){0, .6f, 0}, 60, 1, view.view_from_world, view.clip_from_view);
	target_draw(&w->target, w->gi, view);
	/* What the last update did is another matter, and which of several that hide one thing it met first. */
	if (view.overlay != GI_OVERLAY_DIRTY && view.overlay != GI_OVERLAY_RESIDUAL &&
	    view.overlay != GI_OVERLAY_BLOCKERS)
		memcpy(p.pixels, w->target.pixels, sizeof p.pixels);
	return p;
}

static void expect_same(const picture *a, const picture *b, const char *when)
{
	snapshot_expect_same_rows(&a->rows, &b->rows, when);
	assert_int_equal(a->rows.leaf_count, b->rows.leaf_count);
	for (uint32_t k = 0; k < a->rows.leaf_count; k++)
		if (memcmp(a->rows.leaves[k].radiosity, b->rows.leaves[k].radiosity, 12) != 0 ||
		    memcmp(a->rows.leaves[k].irradiance, b->rows.leaves[k].irradiance, 12) != 0)
			fail_msg("%s: leaf %u of object %u: B %.9g %.9g, H %.9g %.9g", when, k,
				 a->rows.leaves[k].object.index1, (double)a->rows.leaves[k].radiosity[0],
				 (double)b->rows.leaves[k].radiosity[0], (double)a->rows.leaves[k].irradiance[0],
				 (double)b->rows.leaves[k].irradiance[0]);
	for (int k = 0; k < 4; k++)
		for (uint32_t i = 0; i < 4 * a->counts[k]; i++)
			if (memcmp(&a->light[k][i], &b->light[k][i], 4) != 0)
				fail_msg("%s: receivers %d, number %u: %.9g %.9g", when, k, i, (double)a->light[k][i],
					 (double)b->light[k][i]);
	for (int k = 0; k < SIZE * SIZE; k++)
		if (memcmp(a->pixels[k], b->pixels[k], sizeof a->pixels[k]) != 0)
			fail_msg("%s: pixel %d %d: %.9g %.9g %.9g, %.9g %.9g %.9g", when, k % SIZE, k / SIZE,
				 (double)a->pixels[k][0], (double)a->pixels[k][1], (double)a->pixels[k][2],
				 (double)b->pixels[k][0], (double)b->pixels[k][1], (double)b->pixels[k][2]);
}

/* Everything new: lights too, by another set of lights that are the same. */
static void rebuild(world *w)
{
	for (int k = 0; k < LIGHTS; k++) {
		gi_light_def def;
		assert_gi(gi_get_light(w->gi, w->lights[k], &def));
		const gi_light_def was = def;
		def.radius += .1f;
		def.angular_radius += .1f;
		assert_gi(gi_set_light(w->gi, w->lights[k], &def));
		assert_gi(gi_set_light(w->gi, w->lights[k], &was));
	}
	gi_invalidate(w->gi);
	/* What is drawn is uploaded anew. */
	gi_textures was, other = gi_textures_default();
	assert_gi(gi_get_textures(w->gi, w->movers[1], 0, &was));
	other.base_color = w->textures[0];
	for (int k = 0; k < 2; k++)
		assert_gi(gi_set_textures(w->gi, w->movers[1], 0, k ? NULL : &other));
	assert_gi(gi_set_textures(w->gi, w->movers[1], 0, &was));
}

static void play(uint32_t seed, int frames, bool specular)
{
	world w;
	char done[512] = "";
	size_t at = 0;
	state_of_chance = seed;
	open_world(&w, specular, seed % 3 == 0);
	for (int frame = 0; frame < frames; frame++) {
		for (uint32_t k = 1 + chance(3); k > 0 && at < 500; k--)
			act(&w, &done[at++]);
		done[at++] = ' ';
		const gi_budget some = {.rays = chance(2) ? 200 : 0, .error = .3f};
		if (chance(3) == 0) {
			assert_gi(gi_update(w.gi, &some));
			assert_gi(gi_finish(w.gi));
			move_points(&w);
			assert_gi(gi_update(w.gi, &some));
			done[at++] = '$';
		}
		gi_report r = harness_update(w.gi);
		if (chance(3) == 0) {
			uint32_t leaf;
			assert_gi(gi_pick_leaf(w.gi, (float[]){0, 3, 0}, (float[]){.1f, -1, .1f}, &leaf));
		}
		char when[700];
		snprintf(when, sizeof when, "seed %u frame %d: %s", seed, frame, done);
		assert_true(r.outcome >= 0);
		picture kept = look(&w);
		rebuild(&w);
		picture anew = look(&w);
		expect_same(&kept, &anew, when);
		snapshot_free(&kept.rows);
		snapshot_free(&anew.rows);
	}
	engine_mesh_free(&w.skin);
	gi_context_destroy(w.gi);
	glDeleteTextures(2, w.textures);
	target_free(&w.target);
}

static void updates_are_rebuilds(void **state)
{
	(void)state;
	harness_require_context();
	for (uint32_t seed = 1; seed <= (harness_is_long() ? 60 : 1); seed++)
		play(seed, harness_is_long() ? 25 : 8, seed % 2);
	play(22, harness_is_long() ? 25 : 6, false);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(receivers_hide_nothing), cmocka_unit_test(turned_away),
	    cmocka_unit_test(receivers_alone),        cmocka_unit_test(walls_hide_from_points_behind_them),
	    cmocka_unit_test(updates_are_rebuilds),
	};
	return cmocka_run_group_tests(tests, harness_open, harness_close);
}
