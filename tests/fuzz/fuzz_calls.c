/* Sequences of gi_ calls, decoded from bytes: handles that are stale or made up, floats that are none, scenes that are
 * empty, frames that are cut short. What must hold: a result of the list; a destroyed object is an invalid handle; an
 * outcome that is no failure; finite light.
 *
 * The library's context lives on from input to input, since shaders take seconds to compile; every input begins with
 * all objects destroyed, and some with a context of their own settings, which the next one replaces.
 */
#include "engine/context.h"
#include "fuzz_input.h"
#include "fuzz_more.h"

#include <glad/gl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

enum { MOST_CALLS = 64, PICTURE = 32 };

static engine_context *window;
static gi_context *gi;

/* ---- calls ------------------------------------------------------------------------------------------------------- */

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
	const gi_object_def def = next_definition(in, gi, &c);
	gi_object object = {1, 1, 1};
	const gi_result result = gi_create_object(gi, &def, &object);
	gi_free_leaf_choice(&c.choice);
	take(in, result, object, c.materials, def.material_count);
}

/* One that nobody took in goes for the next one. */
static void prepare(input *in)
{
	cube c = {0};
	const gi_object_def def = next_definition(in, gi, &c);
	gi_free_prepared_object(in->prepared);
	const gi_result result = gi_prepare_object(&def, check_message, NULL, NULL, &in->prepared);
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
	view.overlay = (gi_overlay)(kind & 16 ? next_below(in, 10) : 0);
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
	require(r.outcome <= GI_OUTCOME_NOT_RUN || !in->sane || in->unbounded ||
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

static void call_more(input *in)
{
	more_calls[next_below(in, MORE_CALLS)](in, gi);
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
					 create_prepared,
					 call_more,
					 call_more,
					 call_more,
					 call_more,
					 call_more,
					 call_more};

/* ---- contexts ---------------------------------------------------------------------------------------------------- */

static void open_context(gi_context_def def)
{
	gi_context *made = NULL;
	def.get_proc_address = engine_context_find_gl;
	def.get_proc_user = window;
	def.message = check_message;
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
	forget_more(in, gi);
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
	for (int i = 0; in.size > 0 && i < MOST_CALLS; i++)
		calls[next_below(&in, sizeof calls / sizeof calls[0])](&in);
	destroy_all(&in);
	own_settings = wants_own || in.settings;
	return 0;
}
