#include "diffusion.h"

#include "context.h"
#include "host_memory.h"
#include "state.h"

#include <string.h>

/* Uniforms. */
enum { LEAVES = 0, BY_EXITANCE = 1 };
enum { MEAN_FIRST = 0, MEAN_END = 1 };

enum { PROGRAMS = 6 };

/* Values of all objects: leaves, small clusters, large ones. */
typedef struct counts {
	uint32_t leaves, small, large, links;
} counts;

struct gi_diffusion {
	bool built;    /* for the committed scene */
	bool specular; /* the programs know links through mirrors and glass */
	counts counts;
	uint32_t gather_program, double_program, enter_program, mean_program, emitted_program, leave_program;
	DIFFUSION_BUFFERS(BUFFER_MEMBER)
};

static void list_programs(gi_diffusion *d, gpu_program_file list[PROGRAMS])
{
	const gpu_program_file programs[PROGRAMS] = {
	    {d->specular ? "gather_translucent_specular.comp" : "gather_translucent.comp", &d->gather_program},
	    {d->specular ? "gather_double_translucent_specular.comp" : "gather_double_translucent.comp",
	     &d->double_program},
	    {d->specular ? "diffusion_enter_specular.comp" : "diffusion_enter.comp", &d->enter_program},
	    {"diffusion_mean.comp", &d->mean_program},
	    {"diffusion_emitted.comp", &d->emitted_program},
	    {"diffusion_leave.comp", &d->leave_program}};
	memcpy(list, programs, sizeof programs);
}

static gi_result out_of_memory(const gi_context *gi)
{
	return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
}

static const gi_subsurface_links *links_in(const gi_scene *s, uint32_t slot)
{
	const object_record *o = scene_object_in(s, slot);
	return o && object_is_translucent(o) ? &o->subsurface : NULL;
}

static uint32_t rows_of(const gi_subsurface_links *l)
{
	return l->leaf_count + l->small_count + l->large_count;
}

static counts count_all(const gi_scene *s)
{
	counts all = {0, 0, 0, 0};
	for (uint32_t slot = 0; slot < s->slot_count; slot++) {
		const gi_subsurface_links *l = links_in(s, slot);
		if (!l)
			continue;
		all.leaves += l->leaf_count;
		all.small += l->small_count;
		all.large += l->large_count;
		all.links += l->first[rows_of(l)];
	}
	return all;
}

/* Where the values of an object begin among those of all: its leaves, small clusters and large ones. */
typedef struct places {
	uint32_t leaf, small, large, link;
} places;

static uint32_t value_among_all(const gi_subsurface_links *l, const places *at, uint32_t value)
{
	if (value < l->leaf_count)
		return at->leaf + value;
	if (value < l->leaf_count + l->small_count)
		return at->small + value - l->leaf_count;
	return at->large + value - l->leaf_count - l->small_count;
}

static void fill(const gi_scene *s, const counts *all, gi_uvec4 *rows, gi_uvec4 *links)
{
	places at = {0, all->leaves, all->leaves + all->small, 0};
	for (uint32_t slot = 0; slot < s->slot_count; slot++) {
		const gi_subsurface_links *l = links_in(s, slot);
		if (!l)
			continue;
		for (uint32_t row = 0; row < rows_of(l); row++) {
			const uint32_t leaf = row < l->leaf_count ? scene_object_in(s, slot)->leaf_base + row : GI_NONE;
			rows[value_among_all(l, &at, row)] =
			    (gi_uvec4){at.link + l->first[row], l->first[row + 1] - l->first[row], leaf, 0};
		}
		for (uint32_t k = 0; k < l->first[rows_of(l)]; k++) {
			const gi_uvec4 link = l->links[k];
			links[at.link + k] = (gi_uvec4){value_among_all(l, &at, link.x), link.y, link.z, link.w};
		}
		at.leaf += l->leaf_count;
		at.small += l->small_count;
		at.large += l->large_count;
		at.link += l->first[rows_of(l)];
	}
}

static gi_result upload(gi_context *gi)
{
	gi_diffusion *d = gi->diffusion;
	const counts *all = &d->counts;
	const uint64_t count = (uint64_t)all->leaves + all->small + all->large;
	gi_uvec4 *rows = gi_malloc(sizeof *rows * count), *links = gi_malloc(sizeof *links * ((size_t)all->links + 1));
	gi_result result = rows && links ? GI_OK : out_of_memory(gi);
	if (!result)
		fill(&gi->scene, all, rows, links);
	if (!result)
		result =
		    gpu_buffer_replace(&gi->gpu, &d->rows, buffer_labels.DIFFUSION_ROWS, sizeof *rows * count, rows);
	if (!result)
		result = gpu_buffer_replace(&gi->gpu, &d->links, buffer_labels.DIFFUSION_LINKS,
					    sizeof *links * all->links, links);
	if (!result && d->values.size != sizeof(gi_vec4) * count)
		result = gpu_buffer_allocate(&gi->gpu, &d->values, buffer_labels.DIFFUSION_VALUES,
					     sizeof(gi_vec4) * count, NULL);
	gi_free(rows);
	gi_free(links);
	return result;
}

static gi_result make(gi_context *gi)
{
	gi->diffusion = gi_calloc(1, sizeof *gi->diffusion);
	if (!gi->diffusion)
		return out_of_memory(gi);
	gi->diffusion->specular = gi->specular_rows != NULL;
	gpu_program_file list[PROGRAMS];
	list_programs(gi->diffusion, list);
	const gi_result result = gpu_programs_compute(&gi->gpu, list, PROGRAMS);
	if (result)
		diffusion_free(gi);
	return result;
}

gi_result diffusion_update(gi_context *gi)
{
	if (!gi->scene.translucent_leaves) {
		diffusion_free(gi);
		return GI_OK;
	}
	if (gi->diffusion && gi->diffusion->specular != (gi->specular_rows != NULL))
		diffusion_free(gi);
	gi_result result = gi->diffusion ? GI_OK : make(gi);
	if (result || gi->diffusion->built)
		return result;
	gi->diffusion->counts = count_all(&gi->scene);
	result = upload(gi);
	gi->diffusion->built = !result;
	return result;
}

void diffusion_invalidate(gi_context *gi)
{
	if (gi->diffusion)
		gi->diffusion->built = false;
}

bool diffusion_gathers(const gi_context *gi, uint32_t *single_precision, uint32_t *double_precision)
{
	if (!gi->diffusion)
		return false;
	*single_precision = gi->diffusion->gather_program;
	*double_precision = gi->diffusion->double_program;
	return true;
}

void diffusion_bind(const gi_context *gi)
{
	const gi_diffusion *owner = gi->diffusion;
	const uint32_t programs[] = {owner->enter_program, owner->emitted_program, owner->leave_program};
	DIFFUSION_BUFFERS(BUFFER_BIND)
	for (size_t k = 0; k < sizeof programs / sizeof *programs; k++)
		gpu_set_uint(&gi->gpu, programs[k], LEAVES, owner->counts.leaves);
}

static void set_mean(const gi_context *gi, uint32_t first, uint32_t end)
{
	gpu_set_uint(&gi->gpu, gi->diffusion->mean_program, MEAN_FIRST, first);
	gpu_set_uint(&gi->gpu, gi->diffusion->mean_program, MEAN_END, end);
}

void diffusion_emitted(gi_context *gi)
{
	const gi_diffusion *d = gi->diffusion;
	const uint32_t small = d->counts.leaves, large = small + d->counts.small, end = large + d->counts.large;
	gpu_set_uint(&gi->gpu, d->enter_program, BY_EXITANCE, 1);
	gpu_dispatch(&gi->gpu, d->enter_program, d->counts.leaves);
	gpu_set_uint(&gi->gpu, d->enter_program, BY_EXITANCE, 0);
	set_mean(gi, small, large);
	gpu_dispatch(&gi->gpu, d->mean_program, d->counts.small);
	set_mean(gi, large, end);
	gpu_dispatch(&gi->gpu, d->mean_program, d->counts.large);
	gpu_dispatch(&gi->gpu, d->emitted_program, d->counts.leaves);
}

void diffusion_sweep(gi_context *gi)
{
	const gi_diffusion *d = gi->diffusion;
	const uint32_t small = d->counts.leaves, large = small + d->counts.small, end = large + d->counts.large;
	const uint64_t groups = STATE_OFFSET(hand_over);
	gpu_dispatch_indirect(&gi->gpu, d->enter_program, &gi->state, groups);
	if (large > small) {
		set_mean(gi, small, large);
		gpu_dispatch_indirect(&gi->gpu, d->mean_program, &gi->state, groups);
	}
	if (end > large) {
		set_mean(gi, large, end);
		gpu_dispatch_indirect(&gi->gpu, d->mean_program, &gi->state, groups);
	}
	gpu_dispatch_indirect(&gi->gpu, d->leave_program, &gi->state, groups);
}

void diffusion_free(gi_context *gi)
{
	gi_diffusion *owner = gi->diffusion;
	if (!owner)
		return;
	gpu_program_file list[PROGRAMS];
	list_programs(owner, list);
	gpu_programs_free(&gi->gpu, list, PROGRAMS);
	DIFFUSION_BUFFERS(BUFFER_FREE)
	gi_free(owner);
	gi->diffusion = NULL;
}
