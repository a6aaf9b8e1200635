/* Sequences of gi_ calls, decoded from bytes: handles that are stale or made up, floats that are none, scenes that are
 * empty, frames that are cut short. What must hold: a result of the list; a destroyed object is an invalid handle; an
 * outcome that is no failure; finite light.
 *
 * The library's context lives on from input to input, since shaders take seconds to compile; every input begins with
 * all objects destroyed, and some with a context of their own settings, which the next one replaces.
 */
#include "engine/context.h"
#include "gi/gi.h"

#include <glad/gl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

enum { SLOTS = 8, MOST_CALLS = 64, PICTURE = 32, MOST_LEAVES = 4096 };

static engine_context *window;
static gi_context *gi;

typedef struct input {
	const uint8_t *bytes;
	size_t size;
	gi_object objects[SLOTS]; /* zero: none yet */
	bool destroyed[SLOTS];
	gi_prepared_object *prepared; /* NULL: none waits */
	gi_material prepared_materials[2];
	bool sane;           /* so far nothing that may overflow: large places, large lamps */
	float exitance, rho; /* the largest so far */
	bool updated;        /* the report is about this input's scene */
} input;

static void require(bool holds, const char *what)
{
	if (holds)
		return;
	fprintf(stderr, "broken promise: %s\n", what);
	abort();
}

/* ---- bytes to values --------------------------------------------------------------------------------------------- */

static uint8_t next_byte(input *in)
{
	if (in->size == 0)
		return 0;
	in->size--;
	return *in->bytes++;
}

static uint32_t next_below(input *in, uint32_t limit)
{
	return next_byte(in) % limit;
}

/* Mostly a quiet number; else one of those that break things, or any bits. */
static float next_float(input *in)
{
	static const float hostile[] = {0,     -0.0f, NAN,   INFINITY, -INFINITY, 1e-45f,    1e-20f, 1e9f,
					-1e9f, 1e12f, 3e38f, -3e38f,   1,         0.999999f, -1,     1e-3f};
	uint8_t kind = next_byte(in);
	float value;
	if (kind < 200)
		return ((float)kind - 100) / 25;
	if (kind < 250) {
		value = hostile[next_below(in, sizeof hostile / sizeof hostile[0])];
	} else {
		uint8_t raw[4];
		for (int i = 0; i < 4; i++)
			raw[i] = next_byte(in);
		memcpy(&value, raw, sizeof value);
	}
	if (!(fabsf(value) <= 100))
		in->sane = false;
	return value;
}

static void next_floats(input *in, float *out, int count)
{
	for (int i = 0; i < count; i++)
		out[i] = next_float(in);
}

/* In [0, 1): for materials that are good more often than not. */
static float next_share(input *in)
{
	uint8_t kind = next_byte(in);
	return kind < 250 ? (float)kind / 256 : next_float(in);
}

static gi_pose next_pose(input *in)
{
	gi_pose pose = gi_pose_identity();
	uint8_t parts = next_byte(in);
	if (parts & 1)
		next_floats(in, pose.position, 3);
	if (parts & 2)
		next_floats(in, pose.rotation, 4);
	return pose;
}

static gi_material next_material(input *in)
{
	gi_material material = {0};
	for (int c = 0; c < 3; c++)
		material.rho[c] = next_share(in);
	if (next_byte(in) & 1) {
		for (int c = 0; c < 3; c++)
			material.exitance[c] = 10 * next_share(in);
	}
	return material;
}

/* One of the slots, or a handle that nobody gave out. */
static gi_object next_object(input *in)
{
	uint8_t kind = next_byte(in);
	if (kind < 250)
		return in->objects[kind % SLOTS];
	gi_object forged = {.index1 = next_byte(in) * 16843009u};
	forged.generation = next_byte(in);
	return forged;
}

static void remember(input *in, const gi_material *materials, uint32_t count)
{
	for (uint32_t m = 0; m < count; m++) {
		for (int c = 0; c < 3; c++) {
			in->exitance = fmaxf(in->exitance, materials[m].exitance[c]);
			in->rho = fmaxf(in->rho, materials[m].rho[c]);
		}
	}
}

/* ---- calls ------------------------------------------------------------------------------------------------------- */

static void check(gi_result result)
{
	require(result >= GI_OK && result < GI_RESULT_COUNT, "a result of the list");
}

/* A cube on its way to the library: what its definition points to. */
typedef struct cube {
	float positions[24], sharpness[2], sizes[6];
	uint32_t indices[24], counts[6], face_materials[6];
	gi_material materials[2];
	gi_leaf_cut cuts[3];
	gi_leaf_choice choice;
} cube;

/* Outward or inward, of which faces may be missing, broken, or there twice. */
static void fill_cube(input *in, cube *c, uint8_t parts, uint8_t more)
{
	static const float positions[24] = {-1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1,
					    -1, -1, 1,  1, -1, 1,  1, 1, 1,  -1, 1, 1};
	static const uint32_t faces[24] = {0, 3, 2, 1, 4, 5, 6, 7, 0, 1, 5, 4, 3, 7, 6, 2, 0, 4, 7, 3, 1, 2, 6, 5};
	memcpy(c->positions, positions, sizeof positions);
	for (int i = 0; i < 24; i++)
		c->indices[i] = faces[parts & 1 ? 23 - i : i];
	for (uint32_t f = 0; f < 6; f++) {
		c->counts[f] = 4;
		c->face_materials[f] = next_below(in, more & 1 ? 3 : 2);
	}
	for (uint32_t i = next_below(in, 4); i > 0 && parts & 2; i--)
		c->positions[next_below(in, 24)] = next_float(in);
	for (uint32_t i = next_below(in, 4); i > 0 && parts & 4; i--)
		c->indices[next_below(in, 24)] = next_byte(in);
	if (parts & 8)
		c->counts[next_below(in, 6)] = next_byte(in);
	next_floats(in, c->sharpness, 2);
}

/* Sizes and cuts of single faces, one of which may be a copy, or what gi_choose_leaves finds. */
static void refine_faces(input *in, cube *c, gi_object_def *def)
{
	uint8_t parts = next_byte(in);
	for (uint32_t i = 0; i < 4 && parts & 1; i++)
		c->indices[4 + i] = c->indices[(i + parts) % 4];
	if (parts & 2) {
		def->leaf_sizes = c->sizes;
		for (int f = 0; f < 6; f++)
			c->sizes[f] = fabsf(next_float(in));
	}
	if (parts & 4) {
		def->leaf_cuts = c->cuts;
		def->leaf_cut_count = 1 + next_below(in, 3);
	}
	for (uint32_t k = 0; k < def->leaf_cut_count; k++) {
		c->cuts[k].face = next_below(in, parts & 32 ? 7 : def->face_count);
		next_floats(in, c->cuts[k].from, 3);
		next_floats(in, c->cuts[k].to, 3);
	}
	if (parts & 8) {
		gi_leaf_choice_def choice = gi_leaf_choice_def_default();
		choice.leaves = 1 + next_byte(in);
		choice.leaf_size = parts & 16 ? fabsf(next_float(in)) : 0;
		choice.most_leaves = MOST_LEAVES;
		choice.contact = next_share(in);
		def->levels = 0;
		def->leaf_size = 0;
		check(gi_choose_leaves(gi, &choice, def, 1, &c->choice));
	}
}

static gi_object_def define(input *in, cube *c)
{
	static const uint32_t levels[] = {0, 0, 0, 1, 1, 2, 9, UINT32_MAX}, creases[4] = {0, 3, 3, 2};
	gi_object_def def = gi_object_def_default();
	for (int m = 0; m < 2; m++)
		c->materials[m] = next_material(in);
	const uint8_t parts = next_byte(in), more = next_byte(in);
	fill_cube(in, c, parts, more);
	def.positions = more & 2 ? NULL : c->positions;
	def.vertex_count = more & 4 ? next_below(in, 9) : 8;
	def.indices = c->indices;
	def.face_counts = more & 8 ? NULL : c->counts;
	def.face_count = 1 + next_below(in, 6);
	def.index_count = more & 16 ? next_below(in, 25) : 4 * def.face_count;
	def.face_materials = c->face_materials;
	def.materials = c->materials;
	def.material_count = more & 32 ? next_below(in, 3) : 2;
	def.crease_vertices = creases;
	def.crease_sharpness = c->sharpness;
	def.crease_count = more & 64 ? 2 : 0;
	def.scheme = (gi_scheme)next_below(in, parts & 16 ? 5 : 2);
	def.boundary = (gi_boundary)next_below(in, 3);
	def.levels = levels[next_below(in, 8)];
	def.draw_levels = next_below(in, 6);
	def.double_sided = more & 128;
	def.mobility = (gi_mobility)next_below(in, 4);
	def.pose = next_pose(in);
	if (parts & 32)
		next_floats(in, def.scale, 3);
	if (parts & 64) {
		static const float sizes[] = {1, 0.7f, NAN, -1, INFINITY, 1e30f};
		const uint32_t kind = next_below(in, 12);
		def.leaf_size = sizes[kind % 6];
		if (kind >= 6)
			refine_faces(in, c, &def);
	}
	if (parts & 128) {
		def.draw_positions = c->positions;
		def.draw_vertex_count = 8;
		def.draw_indices = c->indices;
		def.draw_index_count = next_below(in, 25);
	}
	return def;
}

/* What creating it gave: an object, which takes the slot of another, or a reason and no handle. */
static void take(input *in, gi_result result, gi_object object, const gi_material *materials, uint32_t material_count)
{
	const uint32_t slot = next_below(in, SLOTS);
	check(result);
	require(result == GI_OK || object.index1 == 0, "a failed creation gives a handle of zero");
	if (result != GI_OK)
		return;
	remember(in, materials, material_count);
	if (in->objects[slot].index1 && !in->destroyed[slot])
		check(gi_destroy_object(gi, in->objects[slot]));
	in->objects[slot] = object;
	in->destroyed[slot] = false;
}

static void create(input *in)
{
	cube c = {0};
	const gi_object_def def = define(in, &c);
	gi_object object = {1, 1, 1};
	const gi_result result = gi_create_object(gi, &def, &object);
	gi_free_leaf_choice(&c.choice);
	take(in, result, object, c.materials, def.material_count);
}

static void ignore_message(gi_result result, const char *message, void *user);

/* One that nobody took in goes for the next one. */
static void prepare(input *in)
{
	cube c = {0};
	const gi_object_def def = define(in, &c);
	gi_free_prepared_object(in->prepared);
	const gi_result result = gi_prepare_object(&def, ignore_message, NULL, NULL, &in->prepared);
	gi_free_leaf_choice(&c.choice);
	check(result);
	require((result == GI_OK) == (in->prepared != NULL), "a prepared object or a reason");
	memcpy(in->prepared_materials, c.materials, sizeof c.materials);
}

static void create_prepared(input *in)
{
	gi_object object = {1, 1, 1};
	const bool waits = in->prepared;
	const gi_result result = gi_create_prepared_object(gi, &in->prepared, &object);
	require(waits || result == GI_ERROR_INVALID_ARGUMENT, "only what was prepared becomes an object");
	require((in->prepared != NULL) == (waits && result != GI_OK), "what was taken in is the caller's no more");
	take(in, result, object, in->prepared_materials, 2);
}

static void create_instance(input *in)
{
	gi_object object = {1, 1, 1};
	const gi_object of = next_object(in);
	const bool valid = gi_object_is_valid(gi, of);
	const gi_result result = gi_create_instance(gi, of, next_pose(in), &object);
	require(valid || result == GI_ERROR_INVALID_HANDLE, "only what is there has instances");
	take(in, result, object, NULL, 0); /* its materials were remembered */
}

/* Both in one call, or with others in between. */
static void prepare_and_create(input *in)
{
	prepare(in);
	if (next_byte(in) & 1)
		create_prepared(in);
}

static void destroy(input *in)
{
	uint32_t slot = next_below(in, SLOTS);
	if (in->objects[slot].index1 == 0)
		return;
	gi_result result = gi_destroy_object(gi, in->objects[slot]);
	require(result == (in->destroyed[slot] ? GI_ERROR_INVALID_HANDLE : GI_OK), "an object is destroyed once");
	in->destroyed[slot] = true;
}

static void commit(input *in)
{
	(void)in;
	check(gi_commit(gi));
}

static void set_pose(input *in)
{
	gi_object object = next_object(in);
	gi_pose pose = next_pose(in), now;
	gi_result result = gi_set_pose(gi, object, pose);
	check(result);
	if (result == GI_OK)
		require(gi_get_pose(gi, object, &now) == GI_OK, "a pose that was set can be got");
}

static void set_material(input *in)
{
	gi_object object = next_object(in);
	uint32_t number = next_below(in, 4);
	gi_material material = next_material(in);
	gi_result result = gi_set_material(gi, object, number, material);
	check(result);
	if (result == GI_OK)
		remember(in, &material, 1);
}

static void update(input *in)
{
	gi_budget budget = {0};
	uint8_t kind = next_byte(in);
	if (kind & 1)
		budget.ms = next_float(in);
	if (kind & 2)
		budget.rays = next_byte(in) * 8;
	if (kind & 4)
		budget.error = next_share(in);
	gi_result result = gi_update(gi, kind & 8 ? &budget : NULL);
	check(result);
	in->updated = in->updated || result == GI_OK;
	if (kind & 16)
		check(gi_finish(gi));
}

/* Destroyed and not yet committed: it takes part in nothing. */
static void destroy_and_update(input *in)
{
	destroy(in);
	update(in);
}

static void hide(input *in)
{
	gi_object object = next_object(in);
	bool hidden = next_byte(in) & 1, now = !hidden;
	gi_result result = gi_set_hidden(gi, object, hidden);
	check(result);
	require(gi_get_hidden(gi, object, &now) == result, "an object that is hidden or shown can be asked");
	require(result != GI_OK || now == hidden, "an object is hidden or it is not");
}

static void set_mobility(input *in)
{
	gi_object object = next_object(in);
	gi_mobility mobility = (gi_mobility)next_below(in, 4), now = GI_MOBILITY_AUTOMATIC;
	gi_result result = gi_set_mobility(gi, object, mobility);
	check(result);
	require((result == GI_ERROR_INVALID_ARGUMENT) <= (mobility > GI_MOBILITY_STATIC),
		"a mobility of the list is taken");
	if (result == GI_OK)
		require(gi_get_mobility(gi, object, &now) == GI_OK && now == mobility,
			"a mobility that was set can be got");
}

static void draw(input *in)
{
	gi_view view = gi_view_default();
	uint8_t kind = next_byte(in);
	view.width = kind & 1 ? next_byte(in) : PICTURE;
	view.height = kind & 1 ? next_byte(in) : PICTURE;
	view.view_from_world[14] = -4;
	if (kind & 2)
		next_floats(in, view.view_from_world, 16);
	if (kind & 4)
		next_floats(in, view.clip_from_view, 16);
	view.mode = (gi_mode)next_below(in, kind & 8 ? 5 : 3);
	view.overlay = (gi_overlay)(kind & 16 ? next_below(in, 6) : 0);
	check(gi_draw(gi, &view));
}

static void report(input *in)
{
	gi_report r;
	(void)in;
	check(gi_finish(gi));
	if (gi_get_report(gi, &r) != GI_OK || !in->updated)
		return;
	require(r.outcome >= GI_OUTCOME_NOT_RUN || r.outcome == GI_OUTCOME_TRUNCATED || !in->sane,
		"an outcome that is no failure");
	require(r.outcome <= GI_OUTCOME_NOT_RUN || (r.radiosity_max >= 0 && isfinite(r.radiosity_max)), "finite light");
	/* Energy is never created: no surface gives off more than the brightest with the whitest for walls. */
	require(r.outcome <= GI_OUTCOME_NOT_RUN || !in->sane ||
		    r.radiosity_max <= 1.001f * in->exitance / (1 - in->rho) + 1e-6f,
		"light within its bounds");
	require(r.outcome <= GI_OUTCOME_NOT_RUN || (r.solve_bound >= 0 && r.stale_bound >= 0), "bounds are numbers");
}

static void read_leaves(input *in)
{
	static gi_leaf leaves[MOST_LEAVES];
	uint32_t count = 0, capacity = 1 + next_below(in, 255);
	gi_result result = gi_read_leaves(gi, next_byte(in) & 1 ? NULL : leaves, capacity, &count);
	check(result);
	result = gi_read_leaves(gi, leaves, MOST_LEAVES, &count);
	for (uint32_t i = 0; result == GI_OK && i < count && i < MOST_LEAVES; i++) {
		require(leaves[i].area >= 0, "an area of a leaf");
		require(leaves[i].row_sum >= 0 && leaves[i].row_sum < 1.001f, "a row's sum is at most 1");
	}
}

static void read_rows(input *in)
{
	static gi_entry entries[256];
	static gi_link links[256];
	uint64_t count = 0;
	gi_result result = gi_read_entries(gi, entries, 1 + next_below(in, 255), &count);
	check(result);
	check(gi_read_links(gi, links, 1 + next_below(in, 255), &count));
}

static void form_factors(input *in)
{
	gi_object to[3] = {{0}};
	double factors[3] = {0};
	to[0] = next_object(in);
	to[1] = next_object(in);
	gi_object from = next_object(in);
	check(gi_form_factor(gi, from, to[0], factors));
	gi_result result = gi_form_factors(gi, from, to, 3, factors);
	check(result);
	for (int k = 0; result == GI_OK && k < 3; k++)
		require(factors[k] >= 0 && factors[k] < 1.001, "a form factor is in [0, 1]");
}

static void trace_paths(input *in)
{
	static float irradiance[3 * 64];
	static const uint32_t paths[] = {1, 2, 16, 0, UINT32_MAX};
	gi_path_options options = gi_path_options_default();
	uint32_t count = 0;
	options.paths = paths[next_below(in, 5)];
	options.seed = next_byte(in);
	check(gi_trace_paths(gi, &options, irradiance, next_below(in, 65), &count));
}

static void forget(input *in)
{
	if (next_byte(in) & 1)
		gi_invalidate(gi);
	else
		gi_reset_radiosity(gi);
}

static void get_buffers(input *in)
{
	gi_buffers buffers;
	gi_object object = next_object(in);
	gi_pose pose;
	gi_object_range range;
	gi_vertex_light light[3];
	float points[9], normals[9];
	next_floats(in, points, 9);
	next_floats(in, normals, 9);
	check(gi_get_buffers(gi, &buffers));
	check(gi_get_object_range(gi, object, &range));
	check(gi_map_vertices(gi, object, points, next_byte(in) & 1 ? normals : NULL, 3, light));
	check(gi_get_pose(gi, object, &pose));
	gi_object_is_valid(gi, object);
}

/* Those that make a scene move come up more often. */
static void (*const calls[])(input *) = {create,
					 create,
					 create,
					 set_pose,
					 set_pose,
					 set_material,
					 commit,
					 commit,
					 update,
					 update,
					 update,
					 report,
					 read_leaves,
					 destroy,
					 draw,
					 read_rows,
					 form_factors,
					 trace_paths,
					 get_buffers,
					 forget,
					 hide,
					 hide,
					 destroy_and_update,
					 set_mobility,
					 set_mobility,
					 create_instance,
					 create_instance,
					 prepare_and_create,
					 create_prepared};

/* ---- contexts ---------------------------------------------------------------------------------------------------- */

static void ignore_message(gi_result result, const char *message, void *user)
{
	(void)user;
	check(result);
	require(message && !strchr(message, '\n'), "a message is one line");
}

static void open_context(gi_context_def def)
{
	gi_context *made = NULL;
	def.get_proc_address = engine_context_find_gl;
	def.get_proc_user = window;
	def.message = ignore_message;
	gi_result result = gi_context_create(&def, &made);
	check(result);
	require((result == GI_OK) == (made != NULL), "a context or a reason");
	if (!made)
		return;
	gi_context_destroy(gi);
	gi = made;
}

/* Coarse, so that an update takes milliseconds. */
static gi_context_def coarse_def(void)
{
	gi_context_def def = gi_context_def_default();
	def.row_tolerance = 0.1f;
	def.emitter_refinement = 2;
	def.emitter_samples = 4;
	def.near_samples = 2;
	def.max_sweeps = 20;
	return def;
}

static gi_context_def next_def(input *in)
{
	gi_context_def def = coarse_def();
	uint8_t parts = next_byte(in);
	if (parts & 1)
		def.solve_tolerance = next_float(in);
	if (parts & 2)
		def.max_sweeps = next_byte(in);
	if (parts & 4)
		next_floats(in, def.sky_exitance, 3);
	for (int c = 0; c < 3; c++)
		in->exitance = fmaxf(in->exitance, def.sky_exitance[c]);
	if (parts & 8) {
		def.pixel_lamps = next_below(in, 40);
		def.shadow_map_size = 32u << next_below(in, 5);
	}
	if (parts & 16)
		def.estimate_leaves = next_byte(in);
	if (parts & 32)
		def.emitter_samples = next_below(in, 20);
	if (parts & 64)
		def.emitter_refinement = next_float(in);
	def.sky = (gi_sky)next_below(in, parts & 128 ? 5 : 3);
	return def;
}

/* A framebuffer to draw into, bound for good. */
static void make_framebuffer(void)
{
	GLuint framebuffer, buffers[2];
	glCreateRenderbuffers(2, buffers);
	glNamedRenderbufferStorage(buffers[0], GL_RGBA16F, 256, 256);
	glNamedRenderbufferStorage(buffers[1], GL_DEPTH_COMPONENT24, 256, 256);
	glCreateFramebuffers(1, &framebuffer);
	glNamedFramebufferRenderbuffer(framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffers[0]);
	glNamedFramebufferRenderbuffer(framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, buffers[1]);
	glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
}

static void open_window(void)
{
	char message[256];
	engine_context_def def = engine_context_def_default();
	def.kind = ENGINE_CONTEXT_OSMESA;
	def.width = def.height = PICTURE;
	window = engine_context_create(&def, message, sizeof message);
	if (!window) {
		def.kind = ENGINE_CONTEXT_EGL;
		window = engine_context_create(&def, message, sizeof message);
	}
	if (!window) {
		fprintf(stderr, "%s\n", message);
		exit(EXIT_FAILURE);
	}
	make_framebuffer();
	open_context(coarse_def());
	require(gi != NULL, "a context with sound settings");
}

static void destroy_all(input *in)
{
	for (int slot = 0; slot < SLOTS; slot++) {
		if (in->objects[slot].index1 && !in->destroyed[slot])
			require(gi_destroy_object(gi, in->objects[slot]) == GI_OK, "what was made can be destroyed");
	}
	gi_free_prepared_object(in->prepared);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	input in = {.bytes = bytes, .size = size, .sane = true};
	static bool own_settings;
	if (!window)
		open_window();
	bool wants_own = next_byte(&in) % 64 == 63;
	if (wants_own || own_settings)
		open_context(wants_own ? next_def(&in) : coarse_def());
	own_settings = wants_own;
	for (int i = 0; in.size > 0 && i < MOST_CALLS; i++)
		calls[next_below(&in, sizeof calls / sizeof calls[0])](&in);
	destroy_all(&in);
	return 0;
}
