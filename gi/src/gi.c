/* The public functions about contexts and objects: arguments are checked here, work is done by the modules (context.h).
 */
#include "caustics.h"
#include "commit.h"
#include "context.h"
#include "handles.h"
#include "host_memory.h"
#include "probes.h"
#include "programs.h"
#include "receive.h"
#include "sky.h"
#include "sky_image.h"
#include "specular.h"
#include "statics.h"

#include <math.h>
#include <string.h>

static const uint32_t MOST_CAUSTIC_PHOTONS = 1u << 20;

static const uint32_t CONTEXT_COOKIE = 0x47493031u, OBJECT_COOKIE = 0x47494f31u;

gi_context_def gi_context_def_default(void)
{
	return (gi_context_def){
	    .row_tolerance = 0.01f,
	    .emitter_refinement = 20.0f,
	    .emitter_samples = 16,
	    .near_samples = 4,
	    .solve_tolerance = .1f,
	    .max_sweeps = 100,
	    .pixel_lamps = GI_LAMP_MAX,
	    .shadow_map_size = 512,
	    .caustic_photons = 16384,
	    .profile = true,
	    .internal = CONTEXT_COOKIE,
	};
}

gi_object_def gi_object_def_default(void)
{
	return (gi_object_def){
	    .draw_levels = 2,
	    .scale = {1, 1, 1},
	    .pose = gi_pose_identity(),
	    .internal = OBJECT_COOKIE,
	};
}

gi_pose gi_pose_identity(void)
{
	return (gi_pose){.rotation = {0, 0, 0, 1}};
}

/* ---- context ---- */

static gi_result check_solve(const gi_log *log, const gi_context_def *def)
{
	if (!(def->solve_tolerance > 0.0f && def->solve_tolerance <= 1.0f))
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "solve_tolerance %g is outside (0, 1]",
			       (double)def->solve_tolerance);
	if (def->max_sweeps < 1 || def->max_sweeps > 1000)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "max_sweeps %u is outside 1..1000", def->max_sweeps);
	return GI_OK;
}

static gi_result check_rows(const gi_log *log, const gi_context_def *def)
{
	if (!(def->row_tolerance > 1e-6f && def->row_tolerance <= 1.0f))
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "row_tolerance %g is outside (1e-6, 1]",
			       (double)def->row_tolerance);
	if (!(def->emitter_refinement >= 1.0f && isfinite(def->emitter_refinement)))
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "emitter_refinement %g is below 1",
			       (double)def->emitter_refinement);
	if (def->emitter_samples < 4 || def->emitter_samples > 16)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "emitter_samples %u is outside 4..16",
			       def->emitter_samples);
	if (def->near_samples < 1 || def->near_samples > 16)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "near_samples %u is outside 1..16", def->near_samples);
	return GI_OK;
}

static gi_result check_sky(const gi_log *log, const gi_context_def *def)
{
	if ((unsigned)def->sky > GI_SKY_ON)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "sky %d is none of gi_sky", (int)def->sky);
	for (int c = 0; c < 3; c++)
		if (!(def->sky_exitance[c] >= 0.0f && def->sky_exitance[c] <= MATERIAL_MAX_EXITANCE))
			return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "sky_exitance is outside [0, 1e12] W/m2");
	return GI_OK;
}

static gi_result check_lamps(const gi_log *log, const gi_context_def *def)
{
	if (def->pixel_lamps > GI_LAMP_MAX)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "pixel_lamps %u is outside 0..%u", def->pixel_lamps,
			       GI_LAMP_MAX);
	if (def->shadow_map_size < 64 || def->shadow_map_size > 4096)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "shadow_map_size %u is outside 64..4096",
			       def->shadow_map_size);
	return GI_OK;
}

static gi_result check_estimate(const gi_log *log, const gi_context_def *def)
{
	if (def->estimate_leaves > 65536)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "estimate_leaves %u is outside 0..65536",
			       def->estimate_leaves);
	return GI_OK;
}

static bool allocator_is_whole(const gi_allocator *a)
{
	return !a->allocate == !a->reallocate && !a->allocate == !a->free;
}

static gi_result check_caustics(const gi_log *log, const gi_context_def *def)
{
	if (def->caustic_photons > MOST_CAUSTIC_PHOTONS)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "caustic_photons %u is outside 0..%u",
			       def->caustic_photons, MOST_CAUSTIC_PHOTONS);
	return GI_OK;
}

static gi_result check_context_def(const gi_log *log, const gi_context_def *def)
{
	if (def->internal != CONTEXT_COOKIE)
		return gi_fail(log, GI_ERROR_INVALID_DEF, "start from gi_context_def_default()");
	if (!def->get_proc_address)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "get_proc_address is required");
	if (!allocator_is_whole(&def->allocator))
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "allocator has some of its functions, not all");
	const bool right = !check_rows(log, def) && !check_solve(log, def) && !check_lamps(log, def) &&
			   !check_caustics(log, def) && !check_estimate(log, def) && !check_sky(log, def);
	return right ? GI_OK : GI_ERROR_INVALID_ARGUMENT;
}

static gi_result start_context(gi_context *gi)
{
	gi_result result = gpu_init(&gi->gpu, gi->def.get_proc_address, gi->def.get_proc_user);
	if (!result)
		result = programs_begin(gi, ROWS_ALWAYS);
	if (!result)
		result = gpu_buffer_allocate(&gi->gpu, &gi->state, "state", sizeof(gi_state), NULL);
	if (!result)
		result = gpu_readback_create(&gi->gpu, &gi->readback, sizeof(gi_state));
	if (!result)
		result = rows_init(gi);
	if (!result)
		gpu_buffer_clear(&gi->gpu, &gi->state, 0, gi->state.size, 0);
	return result;
}

/* The host's definition is gone when shaders are read later. */
static gi_result copy_texts(gi_context *gi, const gi_context_def *def)
{
	if (!def->shader_directory)
		return GI_OK;
	const size_t size = strlen(def->shader_directory) + 1;
	gi->gpu.shader_directory = gi_malloc(size);
	if (!gi->gpu.shader_directory)
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	memcpy(gi->gpu.shader_directory, def->shader_directory, size);
	gi->def.shader_directory = gi->gpu.shader_directory;
	return GI_OK;
}

static gi_result create_context(const gi_log *log, const gi_context_def *def, gi_context **out)
{
	gi_context *gi = gi_calloc(1, sizeof *gi);
	if (!gi)
		return gi_fail(log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	static uint32_t contexts;
	gi->number = GI_COUNT_UP(&contexts);
	gi->def = *def;
	gi->gpu = (gpu){.log = *log, .profile = def->profile, .host_limit = (uint64_t)def->max_buffer_mib << 20};
	for (int k = 0; k < GI_PASS_COUNT; k++)
		gi->timers[k].name = gi_pass_name((gi_pass)k);
	gi->budget.assess_timer.name = "assess";
	gi_result result = copy_texts(gi, def);
	if (!result)
		result = start_context(gi);
	if (result)
		gi_context_destroy(gi);
	else
		*out = gi;
	return result;
}

gi_result gi_context_create(const gi_context_def *def, gi_context **out)
{
	const bool known = def && def->internal == CONTEXT_COOKIE;
	const gi_log log = known ? (gi_log){def->message, def->progress, def->user} : (gi_log){0};
	if (out)
		*out = NULL;
	if (!def || !out)
		return gi_fail(&log, GI_ERROR_INVALID_ARGUMENT, "gi_context_create: def and out must not be NULL");
	gi_result result = check_context_def(&log, def);
	if (result)
		return result;
	const gi_allocator *before = gi_memory_from(&def->allocator);
	result = create_context(&log, def, out);
	gi_memory_from(before);
	return result;
}

void gi_context_destroy(gi_context *gi)
{
	if (!gi)
		return;
	/* Names of another context's objects must not be deleted in the one that is current. */
	gi->gpu.lost = gi->gpu.mark && !gpu_is_current(&gi->gpu);
	if (gi->gpu.lost)
		gi_fail(
		    &gi->gpu.log, GI_ERROR_WRONG_CONTEXT,
		    "gi_context_destroy: its OpenGL context is not current: what it holds on the GPU goes with that "
		    "context");
	shade_free(gi);
	paths_free(gi);
	caustics_free(gi);
	punctual_free(gi);
	light_list_free(&gi->light_list);
	specular_free(gi);
	diffusion_free(gi);
	receive_free(gi);
	probes_free(gi);
	receiver_sets_free(gi);
	specular_rows_free(gi);
	estimate_free(gi);
	scene_free(gi);
	rows_free(gi);
	budget_free(gi);
	solver_release(gi, &gi->solver);
	programs_free(gi);
	sky_free(gi);
	gpu_readback_free(&gi->gpu, &gi->readback);
	gpu_buffer_free(&gi->gpu, &gi->state);
	gpu_spares_free(&gi->gpu);
	for (int k = 0; k < GI_PASS_COUNT; k++)
		gpu_timer_free(&gi->gpu, &gi->timers[k]);
	gpu_close(&gi->gpu);
	gi_free(gi);
}

gi_result gi_get_context_def(const gi_context *gi, gi_context_def *out)
{
	if (!gi || !out)
		return gi_fail_null(gi, "gi_get_context_def: out");
	*out = gi->def;
	return GI_OK;
}

gi_result gi_set_solve(gi_context *gi, float solve_tolerance, uint32_t max_sweeps)
{
	if (!gi)
		return gi_fail_null(gi, "");
	gi_context_def def = gi->def;
	def.solve_tolerance = solve_tolerance;
	def.max_sweeps = max_sweeps;
	if (check_solve(&gi->gpu.log, &def))
		return GI_ERROR_INVALID_ARGUMENT;
	gi->solve_changed =
	    gi->solve_changed || solve_tolerance != gi->def.solve_tolerance || max_sweeps != gi->def.max_sweeps;
	gi->def = def;
	return GI_OK;
}

gi_result gi_set_sky(gi_context *gi, gi_sky sky, const float exitance[3])
{
	if (!gi || !exitance)
		return gi_fail_null(gi, "gi_set_sky: exitance");
	gi_context_def def = gi->def;
	def.sky = sky;
	memcpy(def.sky_exitance, exitance, sizeof def.sky_exitance);
	if (check_sky(&gi->gpu.log, &def))
		return GI_ERROR_INVALID_ARGUMENT;
	const bool seen = gi->scene.slot_count && gi->scene.sky_slot != GI_NONE;
	const bool changed = memcmp(def.sky_exitance, gi->def.sky_exitance, sizeof def.sky_exitance) != 0;
	gi->light_changed = gi->light_changed || (seen && changed);
	gi->rows.rebuild = gi->rows.rebuild || (seen && sky_is_lit(gi, &def) != sky_is_lit(gi, &gi->def));
	gi->def = def;
	return GI_OK;
}

static gi_result check_sky_image(const gi_log *log, const float *radiance, uint32_t width, uint32_t height)
{
	if (width < 1 || width > SKY_IMAGE_MOST_SIDE || height < 1 || height > SKY_IMAGE_MOST_SIDE)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "gi_set_sky_image: %u x %u texels: each is 1..%d", width,
			       height, SKY_IMAGE_MOST_SIDE);
	for (size_t k = 0; k < 3 * (size_t)width * height; k++)
		if (!(radiance[k] >= 0.0f && radiance[k] <= SKY_IMAGE_MOST_RADIANCE))
			return gi_fail(log, GI_ERROR_INVALID_ARGUMENT,
				       "gi_set_sky_image: radiance is outside [0, 3e11] W/m2/sr");
	return GI_OK;
}

/* False where it is none. */
static bool read_rotation(const float rotation[4], double out[4])
{
	static const float identity[4] = {0, 0, 0, 1};
	const float *q = rotation ? rotation : identity;
	const double length =
	    sqrt((double)q[0] * q[0] + (double)q[1] * q[1] + (double)q[2] * q[2] + (double)q[3] * q[3]);
	for (int k = 0; k < 4; k++)
		out[k] = q[k] / length;
	return length > 0 && isfinite(length);
}

gi_result gi_set_sky_image(gi_context *gi, const float *radiance, uint32_t width, uint32_t height,
			   const float rotation[4])
{
	double turned[4];
	if (!gi)
		return gi_fail_null(gi, "");
	if (radiance && check_sky_image(&gi->gpu.log, radiance, width, height))
		return GI_ERROR_INVALID_ARGUMENT;
	if (!read_rotation(rotation, turned))
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_ARGUMENT, "gi_set_sky_image: rotation is no quaternion");
	const gi_allocator *before = gi_memory_from(&gi->def.allocator);
	sky_image *image = radiance ? sky_image_make(radiance, width, height, turned) : NULL;
	const gi_result result = radiance && !image ? gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory")
						    : sky_set_image(gi, image);
	gi_memory_from(before);
	return result;
}

gi_result gi_set_rows(gi_context *gi, float row_tolerance, float emitter_refinement, uint32_t emitter_samples,
		      uint32_t near_samples)
{
	if (!gi)
		return gi_fail_null(gi, "");
	gi_context_def def = gi->def;
	def.row_tolerance = row_tolerance;
	def.emitter_refinement = emitter_refinement;
	def.emitter_samples = emitter_samples;
	def.near_samples = near_samples;
	if (check_rows(&gi->gpu.log, &def))
		return GI_ERROR_INVALID_ARGUMENT;
	if (row_tolerance == gi->def.row_tolerance && emitter_refinement == gi->def.emitter_refinement &&
	    emitter_samples == gi->def.emitter_samples && near_samples == gi->def.near_samples)
		return GI_OK;
	gi->def = def;
	gi->light_changed = gi->rows.rebuild = true;
	gi->rows.fitted = false; /* how large they are is not known */
	return GI_OK;
}

gi_result gi_set_pixel_lamps(gi_context *gi, uint32_t pixel_lamps)
{
	if (!gi)
		return gi_fail_null(gi, "");
	gi_context_def def = gi->def;
	def.pixel_lamps = pixel_lamps;
	if (check_lamps(&gi->gpu.log, &def))
		return GI_ERROR_INVALID_ARGUMENT;
	gi->light_changed = gi->light_changed || pixel_lamps != gi->def.pixel_lamps;
	gi->def = def;
	return GI_OK;
}

gi_result gi_set_estimate_leaves(gi_context *gi, uint32_t estimate_leaves)
{
	if (!gi)
		return gi_fail_null(gi, "");
	gi_context_def def = gi->def;
	def.estimate_leaves = estimate_leaves;
	if (check_estimate(&gi->gpu.log, &def))
		return GI_ERROR_INVALID_ARGUMENT;
	gi->def = def;
	return GI_OK;
}

static void begin_anew(gi_context *gi)
{
	programs_reloaded(gi);
	gi->rows.rebuild = gi->light_changed = gi->solver.cold = true;
	gi->rows.fitted = false;
	shade_invalidate(gi);
	caustics_invalidate(gi);
	punctual_invalidate(gi);
}

gi_result gi_reload_shaders(gi_context *gi)
{
	if (!gi)
		return gi_fail_null(gi, "");
	if (gpu_check_current(&gi->gpu, "gi_reload_shaders"))
		return GI_ERROR_WRONG_CONTEXT;
	const gi_allocator *before = gi_memory_from(&gi->def.allocator);
	const gi_result result = gpu_programs_reload(&gi->gpu);
	if (!result)
		begin_anew(gi);
	gi_memory_from(before);
	return result;
}

/* ---- objects ---- */

/* What may move takes programs of its own, which the driver compiles while the host goes on. Where it could not be
 * asked, or one is missing, the commit sees to it. */
static void expect_motion(gi_context *gi, gi_object object)
{
	const bool moves = handles_find(gi, object)->mobility != GI_MOBILITY_STATIC;
	if (moves && gi->programs[ROWS_MOTION] == PROGRAMS_NONE && gpu_is_current(&gi->gpu))
		programs_begin(gi, ROWS_MOTION);
}

gi_result gi_create_object(gi_context *gi, const gi_object_def *def, gi_object *out)
{
	if (out)
		*out = (gi_object){0};
	if (!gi || !def || !out)
		return gi_fail_null(gi, "gi_create_object: def and out");
	if (def->internal != OBJECT_COOKIE)
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_DEF, "start from gi_object_def_default()");
	const gi_allocator *before = gi_memory_from(&gi->def.allocator);
	const gi_result result = handles_create(gi, def, out);
	if (!result)
		expect_motion(gi, *out);
	gi_memory_from(before);
	return result;
}

gi_result gi_prepare_object(const gi_object_def *def, gi_message_fn *message, void *user, const gi_allocator *allocator,
			    gi_prepared_object **out)
{
	const gi_log log = {.message = message, .user = user};
	if (out)
		*out = NULL;
	if (!def || !out)
		return gi_fail(&log, GI_ERROR_INVALID_ARGUMENT, "gi_prepare_object: def and out must not be NULL");
	if (def->internal != OBJECT_COOKIE)
		return gi_fail(&log, GI_ERROR_INVALID_DEF, "start from gi_object_def_default()");
	if (allocator && !allocator_is_whole(allocator))
		return gi_fail(&log, GI_ERROR_INVALID_ARGUMENT, "allocator has some of its functions, not all");
	const gi_allocator *before = gi_memory_from(allocator);
	const gi_result result = handles_prepare(&log, def, out);
	gi_memory_from(before);
	return result;
}

gi_result gi_create_prepared_object(gi_context *gi, gi_prepared_object **prepared, gi_object *out)
{
	if (out)
		*out = (gi_object){0};
	if (!gi || !prepared || !*prepared || !out)
		return gi_fail_null(gi, "gi_create_prepared_object: prepared, *prepared and out");
	const gi_allocator *before = gi_memory_from(&gi->def.allocator);
	const gi_result result = handles_create_prepared(gi, *prepared, out);
	if (!result)
		expect_motion(gi, *out);
	gi_memory_from(before);
	if (!result)
		*prepared = NULL;
	return result;
}

gi_result gi_create_instance(gi_context *gi, gi_object of, gi_pose pose, gi_object *out)
{
	if (out)
		*out = (gi_object){0};
	if (!gi || !out)
		return gi_fail_null(gi, "gi_create_instance: out");
	const object_record *o = handles_find(gi, of);
	if (!o)
		return gi_fail_stale(gi, "gi_create_instance", "object");
	if (!object_normalise_pose(&gi->gpu.log, &pose, o->name))
		return GI_ERROR_INVALID_POSE;
	const gi_allocator *before = gi_memory_from(&gi->def.allocator);
	const gi_result result = handles_create_instance(gi, o, &pose, out);
	if (!result)
		expect_motion(gi, *out);
	gi_memory_from(before);
	return result;
}

static gi_result no_material(const gi_context *gi, const object_record *o, uint32_t material)
{
	return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_ARGUMENT, "object '%s' has %u materials, there is no number %u",
		       o->name, o->material_count, material);
}

gi_result gi_destroy_object(gi_context *gi, gi_object object)
{
	if (!gi)
		return gi_fail_null(gi, "");
	object_record *o = handles_find(gi, object);
	if (!o)
		return gi_fail_stale(gi, "gi_destroy_object", "object");
	/* Its place is reused only after the commit that takes it out of the uploaded scene, if it is in it. */
	o->generation++;
	o->moved = o->relit = o->material_changed = true;
	gi->scene.regroup = gi->scene.regroup || o->grouped;
	if (!o->committed)
		handles_free_place(&gi->scene, o);
	return GI_OK;
}

gi_result gi_set_hidden(gi_context *gi, gi_object object, bool hidden)
{
	if (!gi)
		return gi_fail_null(gi, "");
	object_record *o = handles_find(gi, object);
	if (!o)
		return gi_fail_stale(gi, "gi_set_hidden", "object");
	if (o->hidden != hidden) {
		o->moved = o->relit = o->material_changed = true;
		gi->scene.regroup =
		    gi->scene.regroup || o->grouped || (o->committed && statics_hold(&gi->scene, o->mobility));
	}
	o->arrives = o->committed && !hidden && (o->arrives || o->hidden);
	o->hidden = hidden;
	return GI_OK;
}

gi_result gi_get_hidden(const gi_context *gi, gi_object object, bool *out)
{
	if (!gi || !out)
		return gi_fail_null(gi, "gi_get_hidden: out");
	const object_record *o = handles_find(gi, object);
	if (!o)
		return gi_fail_stale(gi, "gi_get_hidden", "object");
	*out = o->hidden;
	return GI_OK;
}

bool gi_object_is_valid(const gi_context *gi, gi_object object)
{
	return gi && handles_find(gi, object);
}

gi_result gi_set_pose(gi_context *gi, gi_object object, gi_pose pose)
{
	if (!gi)
		return gi_fail_null(gi, "");
	object_record *o = handles_find(gi, object);
	if (!o)
		return gi_fail_stale(gi, "gi_set_pose", "object");
	if (!object_normalise_pose(&gi->gpu.log, &pose, o->name))
		return GI_ERROR_INVALID_POSE;
	if (memcmp(&pose, &o->pose, sizeof pose) == 0)
		return GI_OK;
	o->pose = pose;
	o->moved = true;
	if (o->committed)
		o->mobility = GI_MOBILITY_MOVABLE;
	gi->scene.regroup = gi->scene.regroup || o->grouped;
	return GI_OK;
}

gi_result gi_set_mobility(gi_context *gi, gi_object object, gi_mobility mobility)
{
	if (!gi)
		return gi_fail_null(gi, "");
	object_record *o = handles_find(gi, object);
	if (!o)
		return gi_fail_stale(gi, "gi_set_mobility", "object");
	if ((unsigned)mobility > GI_MOBILITY_STATIC)
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_ARGUMENT,
			       "object '%s': mobility %d is none of gi_mobility", o->name, (int)mobility);
	if (o->deform && mobility == GI_MOBILITY_STATIC)
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_ARGUMENT,
			       "object '%s' deforms: it is movable, never static", o->name);
	o->mobility = o->deform ? GI_MOBILITY_MOVABLE : mobility;
	return GI_OK;
}

gi_result gi_get_mobility(const gi_context *gi, gi_object object, gi_mobility *out)
{
	if (!gi || !out)
		return gi_fail_null(gi, "gi_get_mobility: out");
	const object_record *o = handles_find(gi, object);
	if (!o)
		return gi_fail_stale(gi, "gi_get_mobility", "object");
	*out = o->mobility;
	return GI_OK;
}

gi_result gi_get_pose(const gi_context *gi, gi_object object, gi_pose *out)
{
	if (!gi || !out)
		return gi_fail_null(gi, "gi_get_pose: out");
	const object_record *o = handles_find(gi, object);
	if (!o)
		return gi_fail_stale(gi, "gi_get_pose", "object");
	*out = o->pose;
	return GI_OK;
}

uint32_t gi_material_count(const gi_context *gi, gi_object object)
{
	const object_record *o = gi ? handles_find(gi, object) : NULL;
	return o ? o->material_count : 0;
}

gi_result gi_get_material(const gi_context *gi, gi_object object, uint32_t material, gi_material *out)
{
	if (!gi || !out)
		return gi_fail_null(gi, "gi_get_material: out");
	const object_record *o = handles_find(gi, object);
	if (!o)
		return gi_fail_stale(gi, "gi_get_material", "object");
	if (material >= o->material_count)
		return no_material(gi, o, material);
	*out = o->materials[material];
	return GI_OK;
}

static const gi_specular *specular_of(const object_record *o, uint32_t material)
{
	static const gi_specular none;
	return o->specular ? &o->specular[material] : &none;
}

gi_result gi_get_specular(const gi_context *gi, gi_object object, uint32_t material, gi_specular *out)
{
	if (!gi || !out)
		return gi_fail_null(gi, "gi_get_specular: out");
	const object_record *o = handles_find(gi, object);
	if (!o)
		return gi_fail_stale(gi, "gi_get_specular", "object");
	if (material >= o->material_count)
		return no_material(gi, o, material);
	*out = *specular_of(o, material);
	return GI_OK;
}

gi_result gi_set_specular(gi_context *gi, gi_object object, uint32_t material, gi_specular value)
{
	if (!gi)
		return gi_fail_null(gi, "");
	object_record *o = handles_find(gi, object);
	if (!o)
		return gi_fail_stale(gi, "gi_set_specular", "object");
	if (material >= o->material_count)
		return no_material(gi, o, material);
	if (!material_specular_is_valid(&gi->gpu.log, &value, &o->materials[material], o->name, material))
		return GI_ERROR_INVALID_MATERIAL;
	if (object_is_translucent(o) && (material_is_mirror(&value) || material_is_glass(&value)))
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_MATERIAL,
			       "object '%s' has subsurface scattering: no material of it can be a mirror or glass",
			       o->name);
	if (memcmp(specular_of(o, material), &value, sizeof value) == 0)
		return GI_OK;
	const gi_allocator *before = gi_memory_from(&gi->def.allocator);
	o->specular = o->specular ? o->specular : gi_calloc(o->material_count, sizeof *o->specular);
	gi_memory_from(before);
	if (!o->specular)
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	o->specular[material] = value;
	o->relit = o->material_changed = true; /* what is seen in it is seen otherwise */
	return GI_OK;
}

static bool reflects(const gi_material *m)
{
	return m->rho[0] + m->rho[1] + m->rho[2] > 0;
}

gi_result gi_set_material(gi_context *gi, gi_object object, uint32_t material, gi_material value)
{
	if (!gi)
		return gi_fail_null(gi, "");
	object_record *o = handles_find(gi, object);
	if (!o)
		return gi_fail_stale(gi, "gi_set_material", "object");
	if (material >= o->material_count)
		return no_material(gi, o, material);
	if (!material_is_valid(&gi->gpu.log, &value, o->name, material) ||
	    !material_specular_is_valid(&gi->gpu.log, specular_of(o, material), &value, o->name, material))
		return GI_ERROR_INVALID_MATERIAL;
	gi_material *m = &o->materials[material];
	object_take_albedo(o, &value);
	if (memcmp(m, &value, sizeof value) == 0)
		return GI_OK;
	if (material_emits(m) != material_emits(&value) || reflects(m) != reflects(&value))
		o->relit = true;
	*m = value;
	o->material_changed = true;
	return GI_OK;
}

gi_result gi_commit(gi_context *gi)
{
	if (!gi)
		return gi_fail_null(gi, "");
	if (gpu_check_current(&gi->gpu, "gi_commit"))
		return GI_ERROR_WRONG_CONTEXT;
	const gi_allocator *before = gi_memory_from(&gi->def.allocator);
	gpu_group_begin(&gi->gpu, "gi_commit");
	const gi_result result = commit_objects(gi);
	gpu_group_end(&gi->gpu);
	gi_memory_from(before);
	return result;
}
