/* The arrays of all objects laid end to end, and uploaded.
 *
 *   leaves     | object 0 | object 1 | ...            (the sky has none)
 *   nodes      | object 0 | object 1 | ... | sky
 *   vertices   | object 0 | object 1 | ... | sky
 */
#include "scene_upload.h"

#include "context.h"
#include "emitters.h"
#include "frames.h"
#include "host_memory.h"
#include "rank.h"
#include "receiver_sets.h"
#include "scene_limits.h"
#include "scene_object.h"
#include "sky.h"
#include "statics.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* Ids of the sky's nodes begin here, far above all objects'. */
static const uint32_t FIRST_SKY_ID = 0xFFFF0000u;

/* Does one closed room hold all other objects? */
static bool one_encloses_all(const gi_context *gi)
{
	const gi_scene *s = &gi->scene;
	for (uint32_t k = 0; k < s->object_count; k++) {
		const object_record *room = &s->objects[k];
		if (!object_is_alive(room) || !room->hierarchy.closed || !(room->hierarchy.volume < 0))
			continue;
		/* Boxes are rounded, and things stand a little inside a wall: a share of the room's size. */
		float slack = 0;
		for (int c = 0; c < 3; c++)
			slack = fmaxf(slack, 1e-4f * ((&room->world_upper.x)[c] - (&room->world_lower.x)[c]));
		bool all = true;
		for (uint32_t j = 0; j < s->object_count && all; j++) {
			const object_record *o = &s->objects[j];
			for (int c = 0; c < 3 && object_is_alive(o); c++)
				all = all && (&o->world_lower.x)[c] >= (&room->world_lower.x)[c] - slack &&
				      (&o->world_upper.x)[c] <= (&room->world_upper.x)[c] + slack;
		}
		if (all)
			return true;
	}
	return false;
}

/* Everything an upload gathers before it touches the old scene, so that a failure leaves that whole. */
typedef struct gathered {
	gi_scene next; /* counts and CPU arrays only */
	gi_hierarchy sky;
	static_tree statics;
	uint32_t *order, order_count; /* handle index of each object's slot: static ones first */
	gi_node_geometry *rest;
	gi_node_spread *spread;
	gi_vec4 *vertices, *vertices_world;
	gi_uvec4 *leaves;
	gi_vec4 *leaf_quads; /* four corners each */
	gi_material_data *materials;
	gi_uvec4 *bvh; /* packed */
	gi_primitive *primitives;
	uint32_t *large;
	gi_uvec4 *light_links; /* two uint pairs each */
	uint32_t *light_first;
	uint32_t bvh_count, primitive_count, material_count, light_link_count;
} gathered;

static void gathered_free(gathered *g)
{
	gi_hierarchy_free(&g->sky);
	gi_free(g->order);
}

static bool order_objects(gi_scene *s, const gi_scene *was, gi_arena *memory, gathered *g)
{
	g->order = gi_calloc((size_t)s->object_count + 1, sizeof *g->order);
	if (!g->order || !statics_build(s, was, memory, &g->statics))
		return false;
	for (uint32_t k = 0; k < s->object_count; k++)
		s->objects[k].grouped = false;
	for (; g->order_count < g->statics.object_count; g->order_count++) {
		g->order[g->order_count] = g->statics.objects[g->order_count];
		s->objects[g->order[g->order_count]].grouped = true;
	}
	for (uint32_t k = 0; k < s->object_count; k++)
		if (object_is_alive(&s->objects[k]) && !s->objects[k].grouped)
			g->order[g->order_count++] = k;
	return true;
}

static void count_all(const gi_context *gi, gathered *g)
{
	gi_scene *n = &g->next;
	for (uint32_t k = 0; k < gi->scene.object_count; k++) {
		object_record *o = &gi->scene.objects[k];
		if (!object_is_alive(o))
			continue;
		n->slot_count++;
		n->leaf_count += o->hierarchy.leaf_count;
		n->node_count += o->hierarchy.node_count;
		n->vertex_count += o->hierarchy.vertex_count;
		n->light_count += o->drawn.light_count;
		g->bvh_count += o->bvh.node_count;
		g->primitive_count += o->bvh.primitive_count;
		g->material_count += object_material_slots(o);
		n->translucent_leaves += o->subsurface.leaf_count;
		g->light_link_count += o->drawn.light_first[o->drawn.light_count];
	}
	n->tlas_count = n->slot_count ? 2 * n->slot_count - 1 : 0;
	n->sky_slot = n->statics_slot = GI_NONE;
	if (g->statics.count) {
		n->first_source = n->statics_slot = g->statics.object_count;
		n->slot_count++;
		n->top_count = g->statics.object_count - 1;
		n->node_count += n->top_count;
	}
	if (g->sky.node_count) {
		n->sky_slot = n->slot_count++;
		n->node_count += g->sky.node_count;
		n->vertex_count += g->sky.vertex_count;
	}
	receiver_sets_count(gi, n);
	g->material_count += n->set_count ? 1 : 0;
}

/* What the scene keeps, and what goes to the GPU alone. */
static void lay_out(gathered *g, gi_arena *stays, gi_arena *passes)
{
	gi_scene *n = &g->next;
	const size_t nodes = (size_t)n->node_count + n->receiver_count, rows = scene_row_count(n),
		     vertices = scene_vertex_count(n), places = scene_place_count(n);
	n->slots = gi_arena_take(stays, n->slot_count, sizeof *n->slots);
	n->object_data = gi_arena_take(stays, places, sizeof *n->object_data);
	n->topology = gi_arena_take(stays, nodes, sizeof *n->topology);
	n->node_exitance = gi_arena_take(stays, n->node_count, sizeof *n->node_exitance);
	n->tlas = gi_arena_take(stays, n->tlas_count, sizeof *n->tlas);
	n->tlas_packed = gi_arena_take(stays, 2 * (size_t)n->tlas_count, sizeof *n->tlas_packed);
	n->sets = gi_arena_take(stays, n->set_count, sizeof *n->sets);
	n->tops = gi_arena_take(stays, n->top_count, sizeof *n->tops);
	n->sums = gi_arena_take(stays, n->top_count, sizeof *n->sums);
	n->changed_slots = gi_arena_take(stays, n->first_source, sizeof *n->changed_slots);
	g->rest = gi_arena_take(passes, nodes, sizeof *g->rest);
	g->spread = gi_arena_take(passes, n->node_count, sizeof *g->spread);
	g->vertices = gi_arena_take(passes, vertices, sizeof *g->vertices);
	g->vertices_world = gi_arena_take(passes, vertices, sizeof *g->vertices_world);
	g->leaves = gi_arena_take(passes, rows, sizeof *g->leaves);
	g->materials = gi_arena_take(passes, g->material_count, sizeof *g->materials);
	g->bvh = gi_arena_take(passes, g->bvh_count, sizeof *g->bvh);
	g->primitives = gi_arena_take(passes, g->primitive_count, sizeof *g->primitives);
	g->leaf_quads = gi_arena_take(passes, 4 * rows, sizeof *g->leaf_quads);
	g->large = gi_arena_take(passes, n->node_count, sizeof *g->large);
	g->light_links = gi_arena_take(passes, g->light_link_count / 2 + 1, sizeof *g->light_links);
	g->light_first = gi_arena_take(passes, (size_t)n->light_count + 1, sizeof *g->light_first);
}

static bool allocate_all(gi_context *gi, gathered *g)
{
	gi_scene *n = &g->next;
	n->arrays = gi->spare_arrays;
	gi->spare_arrays = (gi_arena){0};
	gi_arena_measure(&n->arrays);
	gi_arena_measure(&gi->passing);
	lay_out(g, &n->arrays, &gi->passing);
	if (!gi_arena_reserve(&n->arrays) || !gi_arena_reserve(&gi->passing))
		return false;
	lay_out(g, &n->arrays, &gi->passing);
	/* Not all of these is written below. */
	memset(n->object_data, 0, sizeof *n->object_data * scene_place_count(n));
	memset(n->changed_slots, 0, sizeof *n->changed_slots * n->first_source);
	memset(n->tlas_packed, 0, sizeof *n->tlas_packed * 2 * n->tlas_count);
	memset(g->spread, 0, sizeof *g->spread * n->node_count);
	return true;
}

static void gather_hierarchy(gathered *g, const gi_hierarchy *h, uint32_t node_base, uint32_t vertex_base,
			     uint32_t leaf_base)
{
	memcpy(g->rest + node_base, h->geometry, sizeof *g->rest * h->node_count);
	if (h->spread)
		memcpy(g->spread + node_base, h->spread, sizeof *g->spread * h->node_count);
	memcpy(g->vertices + vertex_base, h->vertices, sizeof *g->vertices * h->vertex_count);
	for (uint32_t k = 0; k < h->node_count; k++) {
		const gi_node_topology t = scene_topology_of(h, k, (scene_base){node_base, vertex_base, leaf_base});
		g->next.topology[node_base + k] = t;
		if (t.range.z > GI_LARGE_NODE_LEAVES)
			g->large[g->next.large_count++] = node_base + k;
	}
}

static void gather_rays(gathered *g, const object_record *o, gi_object_data *data)
{
	scene_fill_tree(o, data, g->bvh + o->bvh_base);
	scene_fill_primitives(o, g->primitives + o->primitive_base);
}

static void gather_leaves(gathered *g, const object_record *o)
{
	const gi_hierarchy *h = &o->hierarchy;
	scene_fill_quads(h, g->leaf_quads + 4 * (size_t)o->leaf_base);
	for (uint32_t l = 0; l < h->leaf_count; l++)
		g->leaves[o->leaf_base + l] =
		    (gi_uvec4){o->node_base + h->leaf_node[l], o->slot, o->material_base + h->leaf_material[l], 0};
}

static void gather_light(gathered *g, const object_record *o, uint32_t link_base)
{
	const gi_drawn_surface *drawn = &o->drawn;
	uint32_t *links = (uint32_t *)g->light_links;
	for (uint32_t k = 0; k < drawn->light_count; k++)
		g->light_first[o->light_base + k] = link_base + drawn->light_first[k];
	for (uint32_t k = 0; k < drawn->light_first[drawn->light_count]; k++) {
		links[2 * (link_base + k)] = o->leaf_base + drawn->light_leaf[k];
		memcpy(&links[2 * (link_base + k) + 1], &drawn->light_weight[k], sizeof(float));
	}
}

/* Is it where the scene before has it? */
static bool is_placed(const object_record *o)
{
	return o->committed && !o->moved;
}

static void place(object_record *o, const gi_object_data *before, gi_object_data *data)
{
	if (!before) {
		object_place(o, data);
		return;
	}
	data->row0 = before->row0;
	data->row1 = before->row1;
	data->row2 = before->row2;
	data->sphere = before->sphere;
	data->plane = before->plane;
}

/* Tops, and what all of it is as one source, in the world's frame. */
static void gather_statics(gathered *g, uint32_t slot, uint32_t leaf_count)
{
	gi_scene *n = &g->next;
	const static_tree *t = &g->statics;
	for (uint32_t k = 0, top = 0; k < t->count; k++)
		if (t->nodes[k].top)
			n->tops[top++] = (scene_top){.node = t->nodes[k].node,
						     .first_slot = t->nodes[k].first_slot,
						     .end_slot = t->nodes[k].end_slot,
						     .id = t->nodes[k].id};
	gi_object_data *data = &n->object_data[slot];
	n->slots[slot] = GI_NONE;
	data->nodes = (gi_uvec4){0, t->node_count, 0, leaf_count};
	data->bvh = (gi_uvec4){0, 0, GI_OBJECT_STATICS, 0};
	scene_place_sky(data);
}

/* The last slot, behind all others' nodes and vertices. */
static void gather_sky(const gi_context *gi, gathered *g, uint32_t slot, uint32_t node, uint32_t vertex, uint32_t leaf)
{
	gi_scene *n = &g->next;
	gi_object_data *data = &n->object_data[slot];
	n->slots[slot] = GI_NONE;
	gather_hierarchy(g, &g->sky, node, vertex, 0);
	data->nodes = (gi_uvec4){node, node + g->sky.node_count, leaf, leaf};
	data->bvh = (gi_uvec4){0, 0, GI_OBJECT_SKY, 0};
	data->extra = (gi_uvec4){0, vertex, vertex + g->sky.vertex_count, 0};
	data->ids = (gi_uvec4){0, FIRST_SKY_ID - node, 0, 0};
	scene_place_sky(data);
	for (uint32_t k = 0; k < g->sky.node_count; k++)
		n->node_exitance[node + k] = sky_exitance(gi, k);
}

static void gather_receivers(const gi_context *gi, gathered *g, uint32_t material)
{
	gi_scene *n = &g->next;
	double area = 0;
	for (uint32_t k = 0; k < gi->scene.object_count; k++)
		if (object_is_alive(&gi->scene.objects[k]))
			area += gi->scene.objects[k].hierarchy.area;
	n->mean_area = n->leaf_count ? (float)(area / n->leaf_count) : 1;
	receiver_sets_gather(gi, n,
			     &(receiver_arrays){.rest = g->rest,
						.vertices = g->vertices,
						.leaves = g->leaves,
						.leaf_quads = g->leaf_quads,
						.material = &g->materials[material],
						.material_number = material});
}

static void gather_objects(gi_context *gi, const gi_scene *before, gathered *g, carried *old, uint32_t *old_count)
{
	gi_scene *n = &g->next;
	uint32_t slot = 0, node = 0, vertex = 0, leaf = 0, material = 0, bvh = 0, primitive = 0, light = 0, link = 0;
	const uint32_t statics = g->statics.object_count;
	uint32_t along = 0; /* the tree of the static ones */
	for (uint32_t number = 0; number < g->order_count; number++) {
		const uint32_t k = g->order[number];
		object_record *o = &gi->scene.objects[k];
		if (o->committed)
			old[(*old_count)++] = (carried){k, o->node_base, o->leaf_base};
		for (; number < statics && g->statics.nodes[along].top; along++)
			;
		if (number < statics)
			node = g->statics.nodes[along++].node;
		const gi_object_data *placed = is_placed(o) ? &before->object_data[o->slot] : NULL;
		o->slot = slot;
		o->node_base = node;
		o->vertex_base = vertex;
		o->leaf_base = leaf;
		o->material_base = material;
		o->bvh_base = bvh;
		o->primitive_base = primitive;
		o->light_base = light;
		n->slots[slot] = k;
		gather_hierarchy(g, &o->hierarchy, node, vertex, leaf);
		gather_light(g, o, link);
		for (uint32_t m = 0; m < object_material_slots(o); m++)
			g->materials[material + m] = object_material_data(o, m);
		gather_leaves(g, o);
		gi_object_data *data = &n->object_data[slot];
		gather_rays(g, o, data);
		data->lower = o->hierarchy.lower;
		data->upper = o->hierarchy.upper;
		data->nodes = (gi_uvec4){node, node + o->hierarchy.node_count, leaf, leaf + o->hierarchy.leaf_count};
		data->bvh = (gi_uvec4){bvh, bvh + o->bvh.node_count, object_flags(o), 0};
		data->extra = (gi_uvec4){0, vertex, vertex + o->hierarchy.vertex_count, 0};
		data->ids = (gi_uvec4){o->leaf_id - leaf, o->node_id - node, 0, 0};
		place(o, placed, data);
		slot++;
		node += o->hierarchy.node_count;
		vertex += o->hierarchy.vertex_count;
		leaf += o->hierarchy.leaf_count;
		material += object_material_slots(o);
		bvh += o->bvh.node_count;
		primitive += o->bvh.primitive_count;
		light += o->drawn.light_count;
		link += o->drawn.light_first[o->drawn.light_count];
		if (number + 1 == statics) {
			gather_statics(g, slot++, leaf);
			node = g->statics.node_count;
		}
	}
	g->light_first[light] = link;
	if (n->sky_slot != GI_NONE)
		gather_sky(gi, g, slot, node, vertex, leaf);
	if (n->set_count)
		gather_receivers(gi, g, material);
}

/* As pose.comp does in the first update: what is read before it is where it belongs. */
static void place_vertices(gathered *g)
{
	for (uint32_t slot = 0; slot < scene_place_count(&g->next); slot++) {
		const gi_object_data *d = &g->next.object_data[slot];
		for (uint32_t k = d->extra.y; k < d->extra.z; k++) {
			const gi_vec3d p = gi_point_to_world(d, gi_vec3d_from(g->vertices[k]));
			g->vertices_world[k] = (gi_vec4){(float)p.x, (float)p.y, (float)p.z, 0};
		}
	}
}

static gi_result upload_gathered(gi_context *gi, gathered *g)
{
	gpu *gpu = &gi->gpu;
	gi_scene *s = &gi->scene, *n = &g->next;
	const uint64_t nodes = (uint64_t)n->node_count + n->receiver_count, rows = scene_row_count(n),
		       vertices = scene_vertex_count(n);
	const struct {
		uint32_t binding;
		gpu_buffer *buffer;
		uint64_t size;
		const void *data;
	} uploads[] = {
	    {GI_BIND_OBJECTS, &s->objects_gpu, sizeof(gi_object_data) * scene_place_count(n), n->object_data},
	    {GI_BIND_TOPOLOGY, &s->topology_gpu, sizeof(gi_node_topology) * nodes, n->topology},
	    {GI_BIND_REST, &s->rest_gpu, sizeof(gi_node_geometry) * nodes, g->rest},
	    {GI_BIND_SPREAD, &s->spread_gpu, sizeof(gi_node_spread) * n->node_count, g->spread},
	    {GI_BIND_WORLD, &s->world_gpu, sizeof(gi_node_geometry) * nodes, NULL},
	    {GI_BIND_VERTICES_REST, &s->vertices_rest_gpu, sizeof(gi_vec4) * vertices, g->vertices},
	    {GI_BIND_VERTICES_WORLD, &s->vertices_world_gpu, sizeof(gi_vec4) * vertices, g->vertices_world},
	    {GI_BIND_LEAVES, &s->leaves_gpu, sizeof(gi_uvec4) * rows, g->leaves},
	    {GI_BIND_MATERIALS, &s->materials_gpu, sizeof(gi_material_data) * g->material_count, g->materials},
	    {GI_BIND_BVH, &s->bvh_gpu, sizeof(gi_uvec4) * g->bvh_count, g->bvh},
	    {GI_BIND_PRIMITIVES, &s->primitives_gpu, sizeof(gi_primitive) * g->primitive_count, g->primitives},
	    {GI_BIND_LEAF_QUADS, &s->leaf_quads_gpu, 4 * sizeof(gi_vec4) * rows, g->leaf_quads},
	    {GI_BIND_TLAS, &s->tlas_gpu, 2 * sizeof(gi_uvec4) * n->tlas_count, NULL},
	    {GI_BIND_NODE_EXITANCE, &s->node_exitance_gpu, sizeof(gi_vec4) * n->node_count, n->node_exitance},
	    {GI_BIND_LARGE_NODES, &s->large_nodes_gpu, sizeof(uint32_t) * n->large_count, g->large},
	    {GI_BIND_LIGHT_LINKS, &s->light_links_gpu, sizeof(uint32_t) * 2 * g->light_link_count, g->light_links},
	    {GI_BIND_LIGHT_FIRST, &s->light_first_gpu, sizeof(uint32_t) * (n->light_count + 1), g->light_first},
	};
	for (size_t k = 0; k < sizeof uploads / sizeof *uploads; k++) {
		gi_result result =
		    gpu_buffer_renew(gpu, uploads[k].buffer, uploads[k].binding, uploads[k].size, uploads[k].data);
		if (result)
			return result;
	}
	return GI_OK;
}

static bool wants_sky(const gi_context *gi)
{
	return gi->def.sky == GI_SKY_ON || (gi->def.sky == GI_SKY_AUTO && !one_encloses_all(gi));
}

/* What nodes emit, of those objects that are as they were from the scene before. */
static void take_exitance(gi_context *gi, const gi_scene *before, const carried *old, uint32_t old_count)
{
	gi_scene *s = &gi->scene;
	for (uint32_t k = 0; k < s->object_count; k++) {
		object_record *o = &s->objects[k];
		if (object_is_alive(o) && (!o->committed || o->material_changed || o->reshaped))
			scene_update_exitance(gi, o);
	}
	for (uint32_t k = 0; k < old_count; k++) {
		const object_record *o = &s->objects[old[k].index];
		if (o->material_changed || o->reshaped) /* means are by area */
			continue;
		memcpy(s->node_exitance + o->node_base, before->node_exitance + old[k].node_base,
		       sizeof *s->node_exitance * o->hierarchy.node_count);
		for (uint32_t n = 0; n < o->hierarchy.node_count; n++)
			s->topology[o->node_base + n].range.w |=
			    before->topology[old[k].node_base + n].range.w & SCENE_MATERIAL_BITS;
	}
}

static uint64_t larger_of(uint64_t a, uint64_t b)
{
	return a > b ? a : b;
}

/* Is every buffer of the scene within what the renderer binds? Asked before any work. */
static gi_result check_sizes(gi_context *gi, const gathered *g)
{
	const gi_scene *n = &g->next;
	const uint64_t leaves = scene_row_count(n), sources = n->slot_count - n->first_source;
	const uint64_t table = limits_table_bytes(leaves, sources);
	uint64_t largest = sizeof(gi_vec4) * GI_LEAF_PARTS * leaves;
	largest = larger_of(largest, sizeof(gi_node_geometry) * ((uint64_t)n->node_count + n->receiver_count));
	largest = larger_of(largest, sizeof(gi_vec4) * (uint64_t)scene_vertex_count(n));
	largest = larger_of(largest, sizeof(gi_primitive) * g->primitive_count);
	largest = larger_of(largest, sizeof(gi_object_data) * scene_place_count(n));
	largest = larger_of(largest, 2 * sizeof(uint32_t) * (uint64_t)g->light_link_count);
	const bool by_table = table >= largest;
	const uint64_t needed = larger_of(largest, table), limit = gpu_buffer_limit(&gi->gpu, needed);
	if (leaves <= GI_ENTRY_LEAF_MASK && needed <= limit)
		return GI_OK;
	if (leaves > GI_ENTRY_LEAF_MASK)
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY,
			       "%u leaves are more than the %u that entries can name: use fewer levels or a larger "
			       "leaf_size",
			       (uint32_t)leaves, GI_ENTRY_LEAF_MASK);
	return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY,
		       "%u leaves of %u objects need a buffer of %" PRIu64 " MiB and %s: use fewer levels or a larger "
		       "leaf_size%s",
		       (uint32_t)leaves, g->order_count, (needed >> 20) + 1, gpu_limit_text(&gi->gpu, limit),
		       by_table && limits_table_bytes(leaves, 0) < table
			   ? ", or make what does not move GI_MOBILITY_STATIC: the table is of leaves times what moves"
			   : "");
}

void scene_keep_objects(const gi_scene *from, gi_scene *to)
{
	to->objects = from->objects;
	to->object_count = from->object_count;
	to->first_free = from->first_free;
	to->created_count = from->created_count;
	to->automatic_static = from->automatic_static;
	to->next_leaf_id = from->next_leaf_id;
	to->next_node_id = from->next_node_id;
	to->ever_committed = from->ever_committed;
}

static gi_result upload_scene(gi_context *gi, const scene_before *before, gathered *g, carried *old,
			      uint32_t *old_count)
{
	gi_scene *s = &gi->scene;
	for (uint32_t k = 0; k < s->object_count; k++)
		if (object_is_alive(&s->objects[k]) && s->objects[k].reshapes)
			object_apply_shape(&s->objects[k]);
	receiver_sets_changed(gi); /* poses of what they are fixed to */
	/* Boxes first: whether there is a sky depends on them. */
	for (uint32_t k = 0; k < s->object_count; k++)
		if (object_is_alive(&s->objects[k]) && !is_placed(&s->objects[k])) {
			gi_object_data scratch;
			if (s->objects[k].committed)
				object_leave_trail(&s->objects[k]);
			object_place(&s->objects[k], &scratch);
		}
	if ((wants_sky(gi) && !sky_build(gi->sky.image, &g->sky)) || !order_objects(s, before->scene, &gi->grouping, g))
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	count_all(gi, g);
	if (check_sizes(gi, g))
		return GI_ERROR_OUT_OF_MEMORY;
	const bool ready = allocate_all(gi, g);
	scene_keep_objects(s, &g->next);
	*s = g->next;
	if (!ready)
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	gather_objects(gi, before->scene, g, old, old_count);
	s->large_count = g->next.large_count;
	s->mean_area = g->next.mean_area;
	statics_follow(s, before->scene, before->objects, gi->rows.update + 1);
	s->statics_update = statics_are_same(before->scene, s) ? before->scene->statics_update : gi->rows.update + 1;
	statics_place(&g->statics, s, g->rest, g->spread, s->topology);
	place_vertices(g);
	if (!rank_primitives(s, g->primitives, g->leaves))
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	if (emitters_weigh(gi))
		return GI_ERROR_OUT_OF_MEMORY;
	take_exitance(gi, before->scene, old, *old_count);
	for (uint32_t k = 0; k < s->top_count; k++)
		scene_update_top(gi, &s->tops[k]);
	lamps_select(gi, false);
	return upload_gathered(gi, g);
}

gi_result scene_upload(gi_context *gi, const scene_before *before, carried *old, uint32_t *old_count)
{
	gathered g = {0};
	*old_count = 0;
	const gi_result result = upload_scene(gi, before, &g, old, old_count);
	gathered_free(&g);
	return result;
}
