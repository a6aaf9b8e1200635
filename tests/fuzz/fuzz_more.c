#include "fuzz_more.h"

#include <glad/gl.h>
#include <math.h>
#include <string.h>

/* A cube with more of what a definition has, in the slot of another. */
static void create_rich(input *in, gi_context *gi)
{
	static const uint32_t numbers[8] = {0, 1, 1, 0, 1}, joints[32] = {0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0};
	cube c = {0};
	float weights[32] = {0}, uvs[48];
	gi_specular specular[2] = {{{0}, {0}, 0}};
	gi_subsurface medium = {{2, 3, 4}, {0.1f, 0.2f, 0.3f}, 1.3f};
	gi_object object = {1, 1, 1};
	gi_object_def def = next_definition(in, gi, &c);
	const uint8_t parts = next_byte(in);
	for (int i = 0; i < 48; i++)
		uvs[i] = (float)i / 8;
	for (int i = 0; i < 3 && parts & 1; i++)
		weights[next_below(in, 32)] = next_float(in);
	def.deforms = parts & 2;
	if (parts & 1) {
		def.joints = joints;
		def.joint_weights = weights;
		def.joint_count = next_below(in, 3);
	}
	def.leaf_materials = parts & 4;
	if (parts & 8) {
		def.uvs = def.draw_uvs = uvs;
		def.draw_face_materials = next_byte(in) & 1 ? numbers : NULL;
	}
	if (parts & 16) {
		for (int m = 0; m < 2; m++)
			next_floats(in, next_byte(in) & 1 ? specular[m].reflectance : specular[m].transmittance, 3);
		specular[0].index = specular[1].index = 1 + next_share(in);
		def.specular = specular;
	}
	if (parts & 32) {
		if (next_byte(in) & 1)
			medium.absorption[next_below(in, 3)] = next_float(in);
		def.subsurface = &medium;
		in->unbounded = true; /* its rho is the medium's */
	}
	def.undrawn = parts & 64;
	const gi_result result = gi_create_object(gi, &def, &object);
	gi_free_leaf_choice(&c.choice);
	check(result);
	require(result == GI_OK || object.index1 == 0, "a failed creation gives a handle of zero");
	if (result != GI_OK)
		return;
	const uint32_t slot = next_below(in, SLOTS);
	remember(in, c.materials, 2);
	if (in->objects[slot].index1 && !in->destroyed[slot])
		check(gi_destroy_object(gi, in->objects[slot]));
	in->objects[slot] = object;
	in->destroyed[slot] = false;
}

/* ---- shapes and materials ---------------------------------------------------------------------------------------- */

static void set_positions(input *in, gi_context *gi)
{
	static const float cube_positions[24] = {-1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1,
						 -1, -1, 1,  1, -1, 1,  1, 1, 1,  -1, 1, 1};
	float positions[24];
	const gi_object object = next_object(in);
	memcpy(positions, cube_positions, sizeof positions);
	for (uint32_t i = next_below(in, 6); i > 0; i--)
		positions[next_below(in, 24)] = next_float(in);
	check((next_byte(in) & 1 ? gi_set_draw_positions : gi_set_positions)(gi, object, positions));
}

static void set_joints(input *in, gi_context *gi)
{
	float matrices[32] = {0};
	const gi_object object = next_object(in);
	for (int i = 0; i < 32; i += 16)
		matrices[i] = matrices[i + 5] = matrices[i + 10] = matrices[i + 15] = 1;
	for (uint32_t i = next_below(in, 6); i > 0; i--)
		matrices[next_below(in, 32)] = next_float(in);
	check(gi_set_joints(gi, object, matrices, next_below(in, 3)));
}

static void set_scale(input *in, gi_context *gi)
{
	float scale[3];
	const gi_object object = next_object(in);
	next_floats(in, scale, 3);
	check(gi_set_scale(gi, object, scale));
}

static void set_specular(input *in, gi_context *gi)
{
	gi_specular value = {{0}, {0}, 1}, now;
	const gi_object object = next_object(in);
	const uint32_t material = next_below(in, 3);
	for (int c = 0; c < 3; c++)
		*(next_byte(in) & 1 ? &value.reflectance[c] : &value.transmittance[c]) = next_share(in);
	value.index = 1 + next_share(in);
	const gi_result result = gi_set_specular(gi, object, material, value);
	check(result);
	if (result == GI_OK)
		require(gi_get_specular(gi, object, material, &now) == GI_OK, "what was set can be got");
}

/* One of two dimensions, which is sometimes deleted while it is in use, one of another kind, or none. */
static GLuint next_texture(input *in)
{
	static GLuint plain, cube_map;
	const uint8_t kind = next_byte(in);
	if (!cube_map)
		glCreateTextures(GL_TEXTURE_CUBE_MAP, 1, &cube_map);
	if (kind & 16) {
		glDeleteTextures(1, &plain);
		plain = 0;
	}
	if (!plain) {
		glCreateTextures(GL_TEXTURE_2D, 1, &plain);
		glTextureStorage2D(plain, 2, GL_SRGB8_ALPHA8, 2, 3);
	}
	return kind & 7 ? plain : kind & 8 ? cube_map : 0;
}

static void set_textures(input *in, gi_context *gi)
{
	static GLuint sampler;
	gi_textures t = gi_textures_default(), now;
	const gi_object object = next_object(in);
	const uint32_t material = next_below(in, 3);
	const uint8_t parts = next_byte(in);
	if (!sampler)
		glCreateSamplers(1, &sampler);
	t.base_color = next_texture(in);
	t.emissive = parts & 1 ? next_texture(in) : 0;
	t.base_color_sampler = parts & 2 ? sampler : 0;
	t.emissive_sampler = parts & 4 ? next_byte(in) : 0;
	if (parts & 8)
		t.base_color_factor[next_below(in, 4)] = next_float(in);
	if (parts & 16)
		t.emissive_factor[next_below(in, 3)] = next_float(in);
	if (parts & 32)
		t.base_color_transform[next_below(in, 2)][next_below(in, 3)] = next_float(in);
	if (parts & 64)
		t.alpha_cutoff = next_float(in);
	const gi_result result = gi_set_textures(gi, object, material, parts & 128 ? NULL : &t);
	check(result);
	require(result != GI_OK || gi_get_textures(gi, object, material, &now) == GI_OK,
		"textures that were set can be got");
	require(glGetError() == GL_NO_ERROR, "names are tried without an error");
}

static void set_leaf_materials(input *in, gi_context *gi)
{
	gi_material values[8], now;
	gi_leaf_uvs uvs[4];
	uint32_t count = 0;
	const gi_object object = next_object(in);
	const uint32_t first = next_byte(in), many = next_below(in, 9);
	for (uint32_t k = 0; k < 8; k++)
		values[k] = next_material(in);
	check(gi_get_leaf_uvs(gi, object, uvs, next_below(in, 5), &count));
	const gi_result result = gi_set_leaf_materials(gi, object, first, many, values);
	check(result);
	if (result != GI_OK)
		return;
	remember(in, values, many);
	for (uint32_t k = 0; k < many; k++) {
		require(gi_get_material(gi, object, first + k, &now) == GI_OK, "a leaf's material can be got");
		require(!memcmp(&now, &values[k], sizeof now), "a leaf has the material that it was given");
	}
}

/* ---- lights, sky ------------------------------------------------------------------------------------------------- */

static gi_light next_light(input *in)
{
	const uint8_t kind = next_byte(in);
	if (kind < 250)
		return in->lights[kind % SLOTS];
	return (gi_light){.index1 = next_byte(in) * 16843009u, .generation = next_byte(in)};
}

static void shape_light(input *in, gi_light_def *def)
{
	const uint8_t parts = next_byte(in);
	def->type = (gi_light_type)next_below(in, parts & 1 ? 5 : 3);
	next_floats(in, def->position, 3);
	if (parts & 2)
		next_floats(in, def->direction, 3);
	for (int c = 0; c < 3 && parts & 4; c++)
		def->intensity[c] = fabsf(next_float(in));
	if (parts & 8) {
		def->inner_angle = next_share(in);
		def->outer_angle = next_float(in);
	}
	if (parts & 16)
		def->range = next_float(in);
	if (parts & 32) {
		def->radius = next_float(in);
		def->angular_radius = next_share(in);
	}
	def->shown = (gi_light_shown)next_below(in, parts & 64 ? 5 : 3);
	def->enabled = !(parts & 128);
}

static void create_light(input *in, gi_context *gi)
{
	const uint32_t slot = next_below(in, SLOTS);
	gi_light_def def = gi_light_def_default();
	gi_light light = {1, 1, 1};
	shape_light(in, &def);
	const gi_result result = gi_create_light(gi, &def, &light);
	check(result);
	require(result == GI_OK || light.index1 == 0, "a failed creation gives a light of zero");
	if (result != GI_OK)
		return;
	in->unbounded = true;
	if (gi_light_is_valid(gi, in->lights[slot]))
		check(gi_destroy_light(gi, in->lights[slot]));
	in->lights[slot] = light;
}

static void set_light(input *in, gi_context *gi)
{
	gi_light_def def;
	const gi_light light = next_light(in);
	if (next_byte(in) % 8 == 7) {
		const bool valid = gi_light_is_valid(gi, light);
		require(gi_destroy_light(gi, light) == (valid ? GI_OK : GI_ERROR_INVALID_HANDLE),
			"a light is destroyed once");
		return;
	}
	if (gi_get_light(gi, light, &def) != GI_OK)
		def = gi_light_def_default();
	shape_light(in, &def);
	check(gi_set_light(gi, light, &def));
}

static void set_sky_image(input *in, gi_context *gi)
{
	float texels[3 * 8], rotation[4];
	const uint32_t width = next_below(in, 5), height = next_below(in, 3);
	for (int i = 0; i < 24; i++)
		texels[i] = 10 * next_share(in);
	next_floats(in, rotation, 4);
	const uint8_t parts = next_byte(in);
	const gi_result result =
	    gi_set_sky_image(gi, parts & 1 ? NULL : texels, width, height, parts & 2 ? rotation : NULL);
	check(result);
	in->unbounded |= result == GI_OK;
}

/* ---- receivers --------------------------------------------------------------------------------------------------- */

static gi_receivers next_receivers(input *in)
{
	const uint8_t kind = next_byte(in);
	if (kind < 250)
		return in->receivers[kind % SLOTS];
	return (gi_receivers){.index1 = next_byte(in) * 16843009u, .generation = next_byte(in)};
}

static void keep_receivers(input *in, gi_context *gi, gi_result result, gi_receivers receivers)
{
	const uint32_t slot = next_below(in, SLOTS);
	check(result);
	require(result == GI_OK || receivers.index1 == 0, "a failed creation gives receivers of zero");
	if (result != GI_OK)
		return;
	if (gi_receivers_are_valid(gi, in->receivers[slot]))
		check(gi_destroy_receivers(gi, in->receivers[slot]));
	in->receivers[slot] = receivers;
}

static void create_receivers(input *in, gi_context *gi)
{
	gi_receivers_def def = gi_receivers_def_default();
	gi_receivers receivers = {1, 1, 1};
	float positions[12], normals[12];
	const uint8_t parts = next_byte(in);
	next_floats(in, positions, 12);
	next_floats(in, normals, 12);
	def.positions = parts & 1 ? NULL : positions;
	def.normals = parts & 2 ? NULL : normals;
	def.count = next_below(in, 5);
	def.harmonics = next_below(in, parts & 4 ? 5 : 3);
	if (parts & 8)
		def.size = next_float(in);
	if (parts & 16)
		def.offset = next_float(in);
	if (parts & 32)
		def.object = next_object(in);
	def.pose = next_pose(in);
	const gi_result result = gi_create_receivers(gi, &def, &receivers);
	keep_receivers(in, gi, result, receivers);
}

static void create_probes(input *in, gi_context *gi)
{
	gi_probes_def def = gi_probes_def_default();
	gi_receivers receivers = {1, 1, 1};
	next_floats(in, def.lower, 3);
	def.spacing = fabsf(next_float(in));
	for (int axis = 0; axis < 3; axis++)
		def.count[axis] = next_below(in, 4);
	def.harmonics = next_below(in, 4);
	const gi_result result = gi_create_probes(gi, &def, &receivers);
	keep_receivers(in, gi, result, receivers);
}

static void move_receivers(input *in, gi_context *gi)
{
	float positions[12], normals[12];
	const gi_receivers receivers = next_receivers(in);
	uint32_t count = 0;
	next_floats(in, positions, 12);
	next_floats(in, normals, 12);
	switch (next_below(in, 3)) {
	case 0:
		check(gi_set_receivers_pose(gi, receivers, next_pose(in)));
		break;
	case 1:
		/* No more points than there are values for. */
		if (gi_read_receivers(gi, receivers, NULL, 0, &count) == GI_OK && count <= 4)
			check(gi_set_receivers(gi, receivers, next_byte(in) & 1 ? NULL : positions,
					       next_byte(in) & 1 ? NULL : normals));
		break;
	default:
		check(gi_destroy_receivers(gi, receivers));
		require(!gi_receivers_are_valid(gi, receivers), "destroyed receivers are none");
	}
}

static void read_receivers(input *in, gi_context *gi)
{
	static float light[4 * 9 * 27];
	const gi_receivers receivers = next_receivers(in);
	gi_receiver_buffer buffer;
	gi_probe_buffers probes;
	uint32_t count = 0;
	check(gi_get_receiver_buffer(gi, receivers, &buffer));
	check(gi_get_probe_buffers(gi, receivers, &probes));
	const gi_result result = gi_read_receivers(gi, receivers, light, sizeof light / 4 / sizeof *light, &count);
	check(result);
	for (uint32_t i = 0; result == GI_OK && in->sane && i < 4 * count && i < sizeof light / sizeof *light; i++)
		require(isfinite(light[i]), "finite light of receivers");
}

/* ---- settings, tools --------------------------------------------------------------------------------------------- */

static void set_settings(input *in, gi_context *gi)
{
	gi_context_def def;
	float sky[3];
	in->settings = true;
	check(gi_get_context_def(gi, &def));
	switch (next_below(in, 5)) {
	case 0:
		check(gi_set_solve(gi, next_byte(in) & 1 ? next_float(in) : 0.1f, next_byte(in)));
		break;
	case 1:
		next_floats(in, sky, 3);
		if (gi_set_sky(gi, (gi_sky)next_below(in, 4), sky) == GI_OK)
			in->unbounded = true;
		break;
	case 2:
		/* Coarse ones alone: finer rows take the fuzzer's time. */
		check(gi_set_rows(gi, 0.1f + next_share(in), next_float(in), next_below(in, 20), next_below(in, 20)));
		break;
	case 3:
		check(gi_set_pixel_lamps(gi, next_below(in, 40)));
		break;
	default:
		check(gi_set_estimate_leaves(gi, next_byte(in)));
	}
}

static void pick_leaf(input *in, gi_context *gi)
{
	float origin[3], direction[3];
	uint32_t leaf = 0;
	next_floats(in, origin, 3);
	next_floats(in, direction, 3);
	check(gi_pick_leaf(gi, origin, direction, &leaf));
}

void (*const more_calls[MORE_CALLS])(input *, gi_context *) = {
    create_rich,    set_positions, set_joints,    set_scale,        set_specular,  set_leaf_materials,
    create_light,   set_light,     set_sky_image, create_receivers, create_probes, move_receivers,
    read_receivers, set_settings,  pick_leaf,     set_textures,     set_textures};

void forget_more(input *in, gi_context *gi)
{
	for (int slot = 0; slot < SLOTS; slot++) {
		gi_destroy_light(gi, in->lights[slot]);
		gi_destroy_receivers(gi, in->receivers[slot]);
	}
	check(gi_set_sky_image(gi, NULL, 0, 0, NULL));
}
