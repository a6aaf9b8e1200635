#include "changes.h"

#include "context.h"
#include "emitters.h"
#include "receiver_sets.h"
#include "sky.h"
#include "tlas.h"

static void upload_material(gi_context *gi, object_record *o)
{
	gi_scene *s = &gi->scene;
	enum { AT_ONCE = 128 }; /* an object may have one a leaf */
	gi_material_data data[AT_ONCE];
	const uint32_t slots = object_material_slots(o);
	for (uint32_t first = 0, count; first < slots; first += count) {
		count = slots - first < AT_ONCE ? slots - first : AT_ONCE;
		for (uint32_t m = 0; m < count; m++)
			data[m] = object_material_data(o, first + m);
		gpu_buffer_upload(&gi->gpu, &s->materials_gpu, sizeof *data * (o->material_base + first),
				  sizeof *data * count, data);
	}
	scene_update_exitance(gi, o);
	const uint64_t nodes = o->hierarchy.node_count;
	gpu_buffer_upload(&gi->gpu, &s->node_exitance_gpu, sizeof(gi_vec4) * o->node_base, sizeof(gi_vec4) * nodes,
			  s->node_exitance + o->node_base);
	gpu_buffer_upload(&gi->gpu, &s->topology_gpu, sizeof(gi_node_topology) * o->node_base,
			  sizeof(gi_node_topology) * nodes, s->topology + o->node_base);
}

static void upload_top(gi_context *gi, const scene_top *top)
{
	gi_scene *s = &gi->scene;
	bool changed = false;
	for (uint32_t slot = top->first_slot; slot < top->end_slot && !changed; slot++)
		changed = s->objects[s->slots[slot]].material_changed;
	if (!changed)
		return;
	scene_update_top(gi, top);
	gpu_buffer_upload(&gi->gpu, &s->node_exitance_gpu, sizeof(gi_vec4) * top->node, sizeof(gi_vec4),
			  &s->node_exitance[top->node]);
	gpu_buffer_upload(&gi->gpu, &s->topology_gpu, sizeof(gi_node_topology) * top->node, sizeof(gi_node_topology),
			  &s->topology[top->node]);
}

gi_result changes_upload_materials(gi_context *gi)
{
	gi_scene *s = &gi->scene;
	bool changed = gi->light_changed;
	for (uint32_t slot = 0; slot < s->slot_count; slot++)
		changed = changed || (s->slots[slot] != GI_NONE && s->objects[s->slots[slot]].material_changed);
	if (!changed)
		return GI_OK;
	if (emitters_weigh(gi))
		return GI_ERROR_OUT_OF_MEMORY;
	if (gi->light_changed)
		sky_relight(gi);
	for (uint32_t slot = 0; slot < s->slot_count; slot++)
		if (s->slots[slot] != GI_NONE && s->objects[s->slots[slot]].material_changed)
			upload_material(gi, &s->objects[s->slots[slot]]);
	for (uint32_t k = 0; k < s->top_count; k++)
		upload_top(gi, &s->tops[k]);
	lamps_select(gi, true);
	return GI_OK;
}

gi_result changes_upload(gi_context *gi)
{
	gi_scene *s = &gi->scene;
	if (changes_upload_materials(gi))
		return GI_ERROR_OUT_OF_MEMORY;
	bool shown = false;
	for (uint32_t slot = 0; slot < s->slot_count; slot++) {
		if (s->slots[slot] == GI_NONE)
			continue;
		gi_object_data *data = &s->object_data[slot];
		object_record *o = &s->objects[s->slots[slot]];
		shown = shown || object_is_seen(o) != scene_slot_is_seen(s, slot);
		data->bvh.z = object_flags(o);
		if (o->moved) {
			if (!o->came)
				object_leave_trail(o);
			object_place(o, data);
		}
	}
	s->shown_changed = s->shown_changed || shown;
	const gi_result result = receiver_sets_upload(gi);
	return result ? result : tlas_upload(gi);
}
