#include "reshape.h"

#include "context.h"
#include "rank.h"
#include "scene_object.h"

/* `count` elements, the first of them the object's element `first` in the scene. */
static void upload(gi_context *gi, gpu_buffer *buffer, uint64_t size, uint64_t first, uint64_t count, const void *data)
{
	gpu_buffer_upload(&gi->gpu, buffer, size * first, size * count, data);
}

static void upload_nodes(gi_context *gi, const object_record *o)
{
	gi_scene *s = &gi->scene;
	const gi_hierarchy *h = &o->hierarchy;
	const scene_base base = {o->node_base, o->vertex_base, o->leaf_base};
	gi_node_topology *topology = s->topology + o->node_base;
	for (uint32_t n = 0; n < h->node_count; n++) {
		const uint32_t lamp = topology[n].range.w & GI_NODE_LAMP;
		topology[n] = scene_topology_of(h, n, base);
		topology[n].range.w |= lamp;
	}
	upload(gi, &s->rest_gpu, sizeof *h->geometry, o->node_base, h->node_count, h->geometry);
	upload(gi, &s->spread_gpu, sizeof *h->spread, o->node_base, h->node_count, h->spread);
	upload(gi, &s->vertices_rest_gpu, sizeof *h->vertices, o->vertex_base, h->vertex_count, h->vertices);
}

/* What nodes emit is the mean over their leaves' areas; that sets flags of the topology too. */
static void upload_exitance(gi_context *gi, object_record *o)
{
	gi_scene *s = &gi->scene;
	const uint32_t nodes = o->hierarchy.node_count;
	scene_update_exitance(gi, o);
	upload(gi, &s->node_exitance_gpu, sizeof *s->node_exitance, o->node_base, nodes,
	       s->node_exitance + o->node_base);
	upload(gi, &s->topology_gpu, sizeof *s->topology, o->node_base, nodes, s->topology + o->node_base);
}

static void upload_rays(gi_context *gi, const object_record *o)
{
	gi_scene *s = &gi->scene;
	gi_object_data *data = &s->object_data[o->slot];
	const gi_hierarchy *h = &o->hierarchy;
	void *scratch = o->deform->scratch;
	data->lower = h->lower;
	data->upper = h->upper;
	scene_fill_tree(o, data, scratch);
	upload(gi, &s->bvh_gpu, sizeof(gi_uvec4), o->bvh_base, o->bvh.node_count, scratch);
	scene_fill_primitives(o, scratch);
	rank_again(o, scratch);
	upload(gi, &s->primitives_gpu, sizeof(gi_primitive), o->primitive_base, o->bvh.primitive_count, scratch);
	scene_fill_quads(h, scratch);
	upload(gi, &s->leaf_quads_gpu, 4 * sizeof(gi_vec4), o->leaf_base, h->leaf_count, scratch);
}

void reshape_objects(gi_context *gi)
{
	gi_scene *s = &gi->scene;
	bool any = false, emits = false, smooth = false;
	for (uint32_t slot = 0; slot < s->slot_count; slot++) {
		object_record *o = scene_object_in(s, slot);
		if (!o || !o->reshapes)
			continue;
		object_apply_shape(o);
		upload_nodes(gi, o);
		upload_exitance(gi, o);
		upload_rays(gi, o);
		any = true;
		emits = emits || s->topology[o->node_base].range.w & GI_NODE_EMITTER;
		smooth = smooth || object_is_smooth(o);
	}
	if (emits)
		lamps_select(gi, true);
	if (smooth)
		specular_invalidate(gi);
	if (any)
		estimate_invalidate(gi); /* chances are by area */
}
