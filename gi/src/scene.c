/* All objects together: what their nodes emit, and their memory. */
#include "scene.h"

#include "context.h"
#include "host_memory.h"

#include <math.h>
#include <string.h>

/* A ray that starts on a surface starts this far above it, in parts of the scene's largest coordinate: 32 float
 * steps there or more, above the rounding of a point and of its turn between frames, and 20 micrometres in a room of
 * 5 m. */
static const float RAY_LIFT = 0x1p-18f;

float scene_ray_lift(const gi_scene *s)
{
	const float *lower = &s->tlas[0].lower.x, *upper = &s->tlas[0].upper.x;
	float largest = 0;
	for (int k = 0; k < 3; k++)
		largest = fmaxf(largest, fmaxf(fabsf(lower[k]), fabsf(upper[k])));
	return RAY_LIFT * largest;
}

uint32_t scene_source_count(const gi_scene *s)
{
	return s->slot_count - s->first_source;
}

uint32_t scene_row_count(const gi_scene *s)
{
	return s->leaf_count + s->receiver_count;
}

uint32_t scene_vertex_count(const gi_scene *s)
{
	return s->vertex_count + GI_RECEIVER_CORNERS * s->receiver_count;
}

uint32_t scene_place_count(const gi_scene *s)
{
	return s->slot_count + s->set_count;
}

bool scene_has_rows(const gi_scene *s, uint32_t place)
{
	return place >= s->slot_count || s->slots[place] != GI_NONE;
}

object_record *scene_object_in(const gi_scene *s, uint32_t slot)
{
	return s->slots[slot] == GI_NONE ? NULL : &s->objects[s->slots[slot]];
}

void scene_sky_exitance(const gi_scene *s, float out[3])
{
	const gi_vec4 none = {0};
	const gi_vec4 *e = s->sky_slot == GI_NONE ? &none : &s->node_exitance[s->object_data[s->sky_slot].nodes.x];
	memcpy(out, e, 3 * sizeof *out);
}

bool scene_slot_is_seen(const gi_scene *s, uint32_t slot)
{
	return s->slots[slot] != GI_NONE && !(s->object_data[slot].bvh.z & GI_OBJECT_UNSEEN);
}

void scene_place_sky(gi_object_data *data)
{
	data->row0 = (gi_vec4){1, 0, 0, 0};
	data->row1 = (gi_vec4){0, 1, 0, 0};
	data->row2 = (gi_vec4){0, 0, 1, 0};
}

/* ---- materials ---- */

/* smooth: GI_NODE_SMOOTH or 0. */
static void set_flags(uint32_t *flags, bool emits, uint32_t steps, uint32_t smooth)
{
	*flags = (*flags & ~SCENE_MATERIAL_BITS) | smooth;
	if (emits)
		*flags |= GI_NODE_EMITTER | steps << GI_NODE_FINER_SHIFT;
}

/* What a leaf gives off over what it keeps: of mirrors and glass that shine or are not black, what is seen in them adds
 * to their own light. INFINITY: they keep nothing. */
static float most_of(double light, double rho, double passed)
{
	static const double ROUNDED = 1e-6;
	const double left = passed > 0 ? 1 - rho - passed - ROUNDED : 1 - rho;
	return !(light > 0) ? 0 : left > 0 ? nextafterf((float)(light / left), INFINITY) : INFINITY;
}

static void include_ceiling(gi_vec4 *ceiling, const gi_material *m, const gi_specular *s)
{
	float *most[] = {&ceiling->x, &ceiling->y, &ceiling->z};
	const bool mixed = material_is_mixed(m, s);
	for (int c = 0; c < 3; c++) {
		const double passed = mixed ? fmax(s->reflectance[c], s->transmittance[c]) : 0;
		*most[c] = fmaxf(*most[c], most_of(m->exitance[c], m->rho[c], passed));
		ceiling->w = fmaxf(ceiling->w, most_of(1, m->rho[c], passed));
	}
}

/* Area means of E (rgb) and rho (w, the largest channel's) over the leaves of each node, and the flags by material: a
 * node is cut as fine as the finest of its leaves that emit. Objects that are not seen are black. */
void scene_update_exitance(gi_context *gi, object_record *o)
{
	gi_scene *s = &gi->scene;
	const gi_hierarchy *h = &o->hierarchy;
	const bool seen = object_is_seen(o);
	o->ceiling = (gi_vec4){0};
	for (uint32_t leaf = 0; seen && leaf < h->leaf_count; leaf++)
		include_ceiling(&o->ceiling, &o->materials[h->leaf_material[leaf]],
				o->specular ? &o->specular[h->leaf_material[leaf]] : NULL);
	for (uint32_t n = 0; n < h->node_count; n++) {
		const gi_uvec4 range = h->topology[n].range;
		double sum[4] = {0}, area = 0;
		uint32_t steps = 0, smooth = 0;
		for (uint32_t leaf = range.y; leaf < range.y + range.z; leaf++) {
			const gi_material *m = &o->materials[h->leaf_material[leaf]];
			const double a = h->geometry[h->leaf_node[leaf]].moment.w;
			for (int c = 0; seen && c < 3; c++)
				sum[c] += a * m->exitance[c];
			sum[3] += a * fmaxf(m->rho[0], fmaxf(m->rho[1], m->rho[2]));
			area += a;
			const uint32_t finer = o->emission[h->leaf_material[leaf]].steps;
			steps = material_emits(m) && finer > steps ? finer : steps;
			if (o->specular && material_is_smooth(&o->specular[h->leaf_material[leaf]]))
				smooth = GI_NODE_SMOOTH;
		}
		s->node_exitance[o->node_base + n] = (gi_vec4){(float)(sum[0] / area), (float)(sum[1] / area),
							       (float)(sum[2] / area), (float)(sum[3] / area)};
		set_flags(&s->topology[o->node_base + n].range.w, sum[0] + sum[1] + sum[2] > 0, steps, smooth);
	}
}

void scene_update_top(gi_context *gi, const scene_top *top)
{
	gi_scene *s = &gi->scene;
	double sum[4] = {0}, area = 0;
	uint32_t *flags = &s->topology[top->node].range.w, emits = 0, steps = 0, smooth = 0;
	for (uint32_t slot = top->first_slot; slot < top->end_slot; slot++) {
		const object_record *o = &s->objects[s->slots[slot]];
		const gi_vec4 e = s->node_exitance[o->node_base];
		const uint32_t own = s->topology[o->node_base].range.w;
		for (int c = 0; c < 4; c++)
			sum[c] += o->hierarchy.area * (&e.x)[c];
		area += o->hierarchy.area;
		emits |= own & GI_NODE_EMITTER;
		smooth |= own & GI_NODE_SMOOTH;
		const uint32_t finer = own >> GI_NODE_FINER_SHIFT & GI_NODE_FINER_MOST;
		steps = finer > steps ? finer : steps;
	}
	s->node_exitance[top->node] =
	    (gi_vec4){(float)(sum[0] / area), (float)(sum[1] / area), (float)(sum[2] / area), (float)(sum[3] / area)};
	set_flags(flags, emits, steps, smooth);
}

void scene_release(gi_context *gi, gi_scene *s)
{
	gi_scene *owner = s;
	SCENE_BUFFERS(BUFFER_FREE)
	gi_arena_free(&s->arrays);
}

void scene_retire(gi_context *gi, gi_scene *s)
{
	gi_scene *owner = s;
	SCENE_BUFFERS(BUFFER_RETIRE)
	gi_arena_free(&gi->spare_arrays);
	gi->spare_arrays = s->arrays;
	s->arrays = (gi_arena){0};
}

void scene_free(gi_context *gi)
{
	for (uint32_t k = 0; k < gi->scene.object_count; k++)
		object_free(&gi->scene.objects[k]);
	gi_free(gi->scene.objects);
	scene_release(gi, &gi->scene);
	gi_arena_free(&gi->spare_arrays);
	gi_arena_free(&gi->passing);
	gi_arena_free(&gi->grouping);
	gi_arena_free(&gi->undo);
	gi_arena_free(&gi->tree_arena);
	gi_arena_free(&gi->light_arena);
}
