#include "lights.h"

#include "frames.h"

#include <math.h>
#include <string.h>

double lights_luminance(gi_vec4 e)
{
	return 0.2126 * e.x + 0.7152 * e.y + 0.0722 * e.z;
}

double lights_largest(gi_vec4 e)
{
	return fmax(e.x, fmax(e.y, e.z));
}

static void add_light(gi_lights *l, float corners[3][3], double measured, uint32_t material, uint32_t leaf)
{
	const double power = measured * gi_quad_area(corners[0], corners[1], corners[2], corners[2]);
	if (!(power > 0))
		return;
	gi_uvec4 *out = l->triangles + 3 * l->count;
	for (int k = 0; k < 3; k++)
		memcpy(&out[k], corners[k], sizeof corners[k]);
	out[1].w = material;
	out[2].w = leaf;
	l->powers[l->count++] = power;
	l->power += power;
}

/* What emits alike: a primitive's leaves are of one material, or each has its own. */
static uint32_t count_parts(const object_record *o)
{
	return o->leaf_materials ? o->hierarchy.leaf_count : o->bvh.primitive_count;
}

/* Returns its first leaf. */
static uint32_t load_part(const object_record *o, uint32_t part, gi_primitive *out)
{
	const gi_hierarchy *h = &o->hierarchy;
	uint32_t leaf = part;
	if (o->leaf_materials) {
		const gi_uvec4 v = h->topology[h->leaf_node[part]].corners;
		*out = (gi_primitive){h->vertices[v.x], h->vertices[v.y], h->vertices[v.z], h->vertices[v.w]};
	} else {
		*out = o->bvh.primitives[part];
		memcpy(&leaf, &out->a.w, sizeof leaf);
	}
	return leaf;
}

static void add_object(const gi_scene *s, const object_record *o, gi_light_measure *measure, gi_lights *l)
{
	const gi_object_data *place = &s->object_data[o->slot];
	for (uint32_t k = 0; k < count_parts(o); k++) {
		gi_primitive quad;
		const gi_primitive *p = &quad;
		const uint32_t leaf = load_part(o, k, &quad);
		const double measured = measure(s->node_exitance[o->node_base + o->hierarchy.leaf_node[leaf]]);
		if (!(measured > 0))
			continue;
		const gi_vec4 *const corners[2][3] = {{&p->a, &p->b, &p->c}, {&p->a, &p->c, &p->d}};
		for (int half = 0; half < 2; half++) {
			float world[3][3];
			for (int c = 0; c < 3; c++)
				gi_vec3d_store(world[c], gi_point_to_world(place, gi_vec3d_from(*corners[half][c])));
			add_light(l, world, measured, o->material_base + o->hierarchy.leaf_material[leaf],
				  o->leaf_base + leaf);
		}
	}
}

static void take(gi_arena *a, uint32_t most, uint32_t slots, gi_lights *l)
{
	*l = (gi_lights){.triangles = gi_arena_take(a, 3 * (size_t)most, sizeof *l->triangles),
			 .powers = gi_arena_take(a, most, sizeof *l->powers),
			 .first = gi_arena_take(a, (size_t)slots + 1, sizeof *l->first)};
}

bool lights_find(const gi_scene *s, gi_light_measure *measure, gi_arena *a, gi_lights *l)
{
	uint32_t most = 0;
	for (uint32_t slot = 0; slot < s->slot_count; slot++)
		most += scene_object_in(s, slot) ? 2 * count_parts(scene_object_in(s, slot)) : 0;
	gi_arena_measure(a);
	take(a, most, s->slot_count, l);
	if (!gi_arena_reserve(a))
		return false;
	take(a, most, s->slot_count, l);
	for (uint32_t slot = 0; slot < s->slot_count; slot++) {
		l->first[slot] = l->count;
		if (scene_object_in(s, slot))
			add_object(s, scene_object_in(s, slot), measure, l);
	}
	l->first[s->slot_count] = l->count;
	return true;
}

double lights_set_slices(gi_lights *l, uint32_t first, uint32_t end)
{
	double power = 0, running = 0;
	for (uint32_t k = first; k < end; k++)
		power += l->powers[k];
	for (uint32_t k = first; k < end; k++) {
		running += l->powers[k];
		const double top = running / power * 0x1p32;
		l->triangles[3 * k].w = k + 1 < end && top < UINT32_MAX ? (uint32_t)top : UINT32_MAX;
	}
	return power;
}
