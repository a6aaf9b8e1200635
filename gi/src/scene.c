/* All objects together, frame by frame: poses, materials, bindings. scene_upload.c lays them
 * end to end. */
#include "context.h"

#include "memory.h"

#include <math.h>
#include <string.h>

bool scene_is_alive(const scene_object *o)
{
	return o->generation & 1;
}

bool scene_is_seen(const scene_object *o)
{
	return scene_is_alive(o) && !o->hidden;
}

uint32_t scene_source_count(const gi_scene *s)
{
	return s->slot_count - s->first_source;
}

bool scene_slot_is_seen(const gi_scene *s, uint32_t slot)
{
	return s->slots[slot] != GI_NONE && !(s->object_data[slot].bvh.z & GI_OBJECT_UNSEEN);
}

/* ---- poses ---- */

/* Rows of the rotation matrix of a unit quaternion, in double so that a turn by 1e-7 does not scale. */
static void rotation_rows(const float q[4], double m[3][3])
{
	const double x = q[0], y = q[1], z = q[2], w = q[3];
	const double rows[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
				   {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
				   {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
	memcpy(m, rows, sizeof rows);
}

/* World box of the turned rest box, and sphere about it, each a little larger than rounding needs: a ray is never lost.
 */
static void place_bounds(scene_object *o, gi_object_data *data, double m[3][3])
{
	const float *lower = &o->hierarchy.lower.x, *upper = &o->hierarchy.upper.x;
	float *world_lower = &o->world_lower.x, *world_upper = &o->world_upper.x;
	double half[3], radius = 0;
	for (int k = 0; k < 3; k++) {
		half[k] = 0.5 * ((double)upper[k] - lower[k]);
		radius += half[k] * half[k];
	}
	float *centre_out = &data->sphere.x;
	for (int r = 0; r < 3; r++) {
		double centre = o->pose.position[r], extent = 0;
		for (int k = 0; k < 3; k++) {
			centre += m[r][k] * 0.5 * ((double)upper[k] + lower[k]);
			extent += fabs(m[r][k]) * half[k];
		}
		const double pad = 1e-5 * (fabs(centre) + extent + sqrt(radius)) + 1e-20;
		world_lower[r] = (float)(centre - extent - pad);
		world_upper[r] = (float)(centre + extent + pad);
		centre_out[r] = (float)centre;
	}
	data->sphere.w = (float)(sqrt(radius) * 1.00001);
}

static gi_vec4 world_plane(const scene_object *o, double m[3][3])
{
	const gi_vec4 axis = o->hierarchy.geometry[0].axis, centre = o->hierarchy.geometry[0].sphere;
	double normal[3], height = 0;
	for (int r = 0; r < 3; r++) {
		normal[r] = m[r][0] * axis.x + m[r][1] * axis.y + m[r][2] * axis.z;
		height +=
		    normal[r] * (m[r][0] * centre.x + m[r][1] * centre.y + m[r][2] * centre.z + o->pose.position[r]);
	}
	return (gi_vec4){(float)normal[0], (float)normal[1], (float)normal[2], (float)height};
}

void scene_place_object(scene_object *o, gi_object_data *data)
{
	double m[3][3];
	rotation_rows(o->pose.rotation, m);
	gi_vec4 *rows[3] = {&data->row0, &data->row1, &data->row2};
	for (int r = 0; r < 3; r++)
		*rows[r] = (gi_vec4){(float)m[r][0], (float)m[r][1], (float)m[r][2], o->pose.position[r]};
	place_bounds(o, data, m);
	data->plane = o->plane ? world_plane(o, m) : (gi_vec4){0, 0, 0, 0};
}

static void include(gi_vec4 lower, gi_vec4 upper, gi_vec4 *to_lower, gi_vec4 *to_upper)
{
	for (int k = 0; k < 3; k++) {
		(&to_lower->x)[k] = fminf((&to_lower->x)[k], (&lower.x)[k]);
		(&to_upper->x)[k] = fmaxf((&to_upper->x)[k], (&upper.x)[k]);
	}
}

void scene_leave_trail(scene_object *o)
{
	if (o->trails) {
		include(o->world_lower, o->world_upper, &o->trail_lower, &o->trail_upper);
		return;
	}
	o->trail_lower = o->world_lower;
	o->trail_upper = o->world_upper;
	o->trails = true;
}

void scene_include_box(const scene_object *o, gi_vec4 *lower, gi_vec4 *upper)
{
	include(o->world_lower, o->world_upper, lower, upper);
	if (o->trails)
		include(o->trail_lower, o->trail_upper, lower, upper);
}

uint32_t scene_object_flags(const scene_object *o)
{
	return (o->plane && !o->overlaps ? GI_OBJECT_FLAT : 0) | (scene_is_seen(o) ? 0 : GI_OBJECT_UNSEEN);
}

void scene_place_sky(gi_object_data *data)
{
	data->row0 = (gi_vec4){1, 0, 0, 0};
	data->row1 = (gi_vec4){0, 1, 0, 0};
	data->row2 = (gi_vec4){0, 0, 1, 0};
}

/* ---- materials ---- */

static void set_emitter(uint32_t *flags, bool emits, uint32_t steps)
{
	*flags &= ~SCENE_EMITTER_BITS;
	if (emits)
		*flags |= GI_NODE_EMITTER | steps << GI_NODE_FINER_SHIFT;
}

static void include_ceiling(gi_vec4 *ceiling, const gi_material *m)
{
	float *most[] = {&ceiling->x, &ceiling->y, &ceiling->z};
	for (int c = 0; c < 3; c++) {
		const double left = 1 - (double)m->rho[c];
		*most[c] = fmaxf(*most[c], nextafterf((float)(m->exitance[c] / left), INFINITY));
		ceiling->w = fmaxf(ceiling->w, nextafterf((float)(1 / left), INFINITY));
	}
}

/* Area means of E (rgb) and rho (w, the largest channel's) over the leaves of each node, and the emitter flags: a node
 * is cut as fine as the finest of its leaves that emit. Objects that are not seen are black. */
void scene_update_exitance(gi_context *gi, scene_object *o)
{
	gi_scene *s = &gi->scene;
	const gi_hierarchy *h = &o->hierarchy;
	const bool seen = scene_is_seen(o);
	o->ceiling = (gi_vec4){0};
	for (uint32_t leaf = 0; seen && leaf < h->leaf_count; leaf++)
		include_ceiling(&o->ceiling, &o->materials[h->leaf_material[leaf]]);
	for (uint32_t n = 0; n < h->node_count; n++) {
		const gi_uvec4 range = h->topology[n].range;
		double sum[4] = {0}, area = 0;
		uint32_t steps = 0;
		for (uint32_t leaf = range.y; leaf < range.y + range.z; leaf++) {
			const gi_material *m = &o->materials[h->leaf_material[leaf]];
			const double a = h->geometry[h->leaf_node[leaf]].moment.w;
			for (int c = 0; seen && c < 3; c++)
				sum[c] += a * m->exitance[c];
			sum[3] += a * fmaxf(m->rho[0], fmaxf(m->rho[1], m->rho[2]));
			area += a;
			const uint32_t finer = o->emission[h->leaf_material[leaf]].steps;
			steps = scene_emits(m) && finer > steps ? finer : steps;
		}
		s->node_exitance[o->node_base + n] = (gi_vec4){(float)(sum[0] / area), (float)(sum[1] / area),
							       (float)(sum[2] / area), (float)(sum[3] / area)};
		set_emitter(&s->topology[o->node_base + n].range.w, sum[0] + sum[1] + sum[2] > 0, steps);
	}
}

void scene_update_top(gi_context *gi, const scene_top *top)
{
	gi_scene *s = &gi->scene;
	double sum[4] = {0}, area = 0;
	uint32_t *flags = &s->topology[top->node].range.w, emits = 0, steps = 0;
	for (uint32_t slot = top->first_slot; slot < top->end_slot; slot++) {
		const scene_object *o = &s->objects[s->slots[slot]];
		const gi_vec4 e = s->node_exitance[o->node_base];
		const uint32_t own = s->topology[o->node_base].range.w;
		for (int c = 0; c < 4; c++)
			sum[c] += o->hierarchy.area * (&e.x)[c];
		area += o->hierarchy.area;
		emits |= own & GI_NODE_EMITTER;
		const uint32_t finer = own >> GI_NODE_FINER_SHIFT & GI_NODE_FINER_MOST;
		steps = finer > steps ? finer : steps;
	}
	s->node_exitance[top->node] =
	    (gi_vec4){(float)(sum[0] / area), (float)(sum[1] / area), (float)(sum[2] / area), (float)(sum[3] / area)};
	set_emitter(flags, emits, steps);
}

gi_material_data scene_material_data(const scene_object *o, uint32_t material)
{
	const gi_material *m = &o->materials[material];
	const float e = scene_is_seen(o) ? 1 : 0;
	return (gi_material_data){{m->rho[0], m->rho[1], m->rho[2], 0},
				  {e * m->exitance[0], e * m->exitance[1], e * m->exitance[2], 0}};
}

/* ---- per frame ---- */

static void upload_material(gi_context *gi, scene_object *o)
{
	gi_scene *s = &gi->scene;
	for (uint32_t m = 0; m < o->material_count; m++) {
		const gi_material_data data = scene_material_data(o, m);
		gpu_buffer_upload(&gi->gpu, &s->materials_gpu, sizeof data * (o->material_base + m), sizeof data,
				  &data);
	}
	scene_update_exitance(gi, o);
	const uint64_t count = o->hierarchy.node_count;
	gpu_buffer_upload(&gi->gpu, &s->node_exitance_gpu, sizeof(gi_vec4) * o->node_base, sizeof(gi_vec4) * count,
			  s->node_exitance + o->node_base);
	gpu_buffer_upload(&gi->gpu, &s->topology_gpu, sizeof(gi_node_topology) * o->node_base,
			  sizeof(gi_node_topology) * count, s->topology + o->node_base);
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

gi_result scene_upload_materials(gi_context *gi)
{
	gi_scene *s = &gi->scene;
	bool changed = gi->light_changed;
	for (uint32_t slot = 0; slot < s->slot_count; slot++)
		changed = changed || (s->slots[slot] != GI_NONE && s->objects[s->slots[slot]].material_changed);
	if (!changed)
		return GI_OK;
	if (scene_weigh_emitters(gi))
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

gi_result scene_upload_changes(gi_context *gi)
{
	gi_scene *s = &gi->scene;
	if (scene_upload_materials(gi))
		return GI_ERROR_OUT_OF_MEMORY;
	bool shown = false;
	for (uint32_t slot = 0; slot < s->slot_count; slot++) {
		if (s->slots[slot] == GI_NONE)
			continue;
		gi_object_data *data = &s->object_data[slot];
		scene_object *o = &s->objects[s->slots[slot]];
		shown = shown || scene_is_seen(o) != scene_slot_is_seen(s, slot);
		data->bvh.z = scene_object_flags(o);
		if (o->moved) {
			scene_leave_trail(o);
			scene_place_object(o, data);
		}
	}
	if (shown) {
		shade_invalidate(gi);
		estimate_invalidate(gi);
	}
	return tlas_upload(gi);
}

#define BUFFERS(X)                                                                                                     \
	X(OBJECTS, objects_gpu)                                                                                        \
	X(TOPOLOGY, topology_gpu)                                                                                      \
	X(REST, rest_gpu)                                                                                              \
	X(SPREAD, spread_gpu)                                                                                          \
	X(WORLD, world_gpu)                                                                                            \
	X(VERTICES_REST, vertices_rest_gpu)                                                                            \
	X(VERTICES_WORLD, vertices_world_gpu)                                                                          \
	X(LEAVES, leaves_gpu)                                                                                          \
	X(MATERIALS, materials_gpu)                                                                                    \
	X(BVH, bvh_gpu)                                                                                                \
	X(PRIMITIVES, primitives_gpu)                                                                                  \
	X(TLAS, tlas_gpu)                                                                                              \
	X(LEAF_QUADS, leaf_quads_gpu)                                                                                  \
	X(NODE_EXITANCE, node_exitance_gpu)                                                                            \
	X(WIDE_NODES, wide_nodes_gpu)                                                                                  \
	X(LIGHT_LINKS, light_links_gpu)                                                                                \
	X(LIGHT_FIRST, light_first_gpu)

void scene_bind(const gi_context *gi)
{
#define BIND(name, buffer) gpu_bind(&gi->gpu, GI_BIND_##name, &gi->scene.buffer);
	BUFFERS(BIND)
#undef BIND
}

void scene_release(gi_context *gi, gi_scene *s)
{
#define FREE(name, buffer) gpu_buffer_free(&gi->gpu, &s->buffer);
	BUFFERS(FREE)
#undef FREE
	gi_arena_free(&s->arrays);
}

void scene_retire(gi_context *gi, gi_scene *s)
{
#define RETIRE(name, buffer) gpu_buffer_retire(&gi->gpu, &s->buffer, GI_BIND_##name);
	BUFFERS(RETIRE)
#undef RETIRE
	gi_arena_free(&gi->spare_arrays);
	gi->spare_arrays = s->arrays;
	s->arrays = (gi_arena){0};
}

void scene_free(gi_context *gi)
{
	for (uint32_t k = 0; k < gi->scene.object_count; k++)
		scene_free_object(&gi->scene.objects[k]);
	gi_free(gi->scene.objects);
	scene_release(gi, &gi->scene);
	gi_arena_free(&gi->spare_arrays);
	gi_arena_free(&gi->passing);
	gi_arena_free(&gi->undo);
	gi_arena_free(&gi->tree_arena);
}
