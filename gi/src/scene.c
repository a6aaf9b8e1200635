/* All objects together, as the GPU sees them: the per-object arrays laid end to end, slots, the world's boxes, materials.
 *
 *   leaves     | object 0 | object 1 | ...            (the sky has none)
 *   nodes      | object 0 | object 1 | ... | sky
 *   vertices   | object 0 | object 1 | ... | sky
 */
#include "context.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool is_alive(const scene_object *o)
{
	return o->generation & 1;
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

/* World box of the turned rest box, and sphere about it, each a little larger than rounding needs: a ray is never lost. */
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

static void place_object(scene_object *o, gi_object_data *data)
{
	double m[3][3];
	rotation_rows(o->pose.rotation, m);
	gi_vec4 *rows[3] = {&data->row0, &data->row1, &data->row2};
	for (int r = 0; r < 3; r++)
		*rows[r] = (gi_vec4){(float)m[r][0], (float)m[r][1], (float)m[r][2], o->pose.position[r]};
	place_bounds(o, data, m);
}

static void place_sky(gi_object_data *data)
{
	data->row0 = (gi_vec4){1, 0, 0, 0};
	data->row1 = (gi_vec4){0, 1, 0, 0};
	data->row2 = (gi_vec4){0, 0, 1, 0};
}

/* ---- packed trees ---- */

/* The grid of a packed tree over a box, a little larger so that flat boxes have cells too. */
static void set_grid(const gi_vec4 *lower, const gi_vec4 *upper, gi_vec4 *grid, gi_vec4 *cells)
{
	const float *l = &lower->x, *u = &upper->x;
	float largest = 0;
	for (int k = 0; k < 3; k++)
		largest = fmaxf(largest, fmaxf(fmaxf(fabsf(l[k]), fabsf(u[k])), u[k] - l[k]));
	const float pad = 1e-5f * largest + 1e-20f;
	for (int k = 0; k < 3; k++) {
		(&grid->x)[k] = l[k] - pad;
		(&cells->x)[k] = GI_PACKED_CELLS / (u[k] - l[k] + 2 * pad);
	}
	grid->w = cells->w = 0;
}

/* One cell more than rounding outward: the ray's turn onto the grid rounds by less than that. */
static uint32_t cell_of(float x, float grid, float cells, int outward)
{
	const float cell = (x - grid) * cells;
	const float rounded = outward < 0 ? floorf(cell) - 1 : ceilf(cell) + 1;
	return (uint32_t)fminf(fmaxf(rounded, 0), GI_PACKED_CELLS);
}

static gi_uvec4 pack_node(const gi_bvh_node *n, gi_vec4 grid, gi_vec4 cells, uint32_t node_base, uint32_t primitive_base)
{
	uint32_t skip, primitive, lower[3], upper[3];
	memcpy(&skip, &n->lower.w, sizeof skip);
	memcpy(&primitive, &n->upper.w, sizeof primitive);
	for (int k = 0; k < 3; k++) {
		lower[k] = cell_of((&n->lower.x)[k], (&grid.x)[k], (&cells.x)[k], -1);
		upper[k] = cell_of((&n->upper.x)[k], (&grid.x)[k], (&cells.x)[k], 1);
	}
	const uint32_t link = primitive == GI_NONE ? skip + node_base : GI_PACKED_LEAF | (primitive + primitive_base);
	return (gi_uvec4){lower[0] | lower[1] << 16, lower[2] | upper[0] << 16, upper[1] | upper[2] << 16, link};
}

/* ---- materials ---- */

/* Area means of E (rgb) and rho (w, the largest channel's) over the leaves of each node, and the emitter flags. */
void scene_update_exitance(gi_context *gi, scene_object *o)
{
	gi_scene *s = &gi->scene;
	const gi_hierarchy *h = &o->hierarchy;
	for (uint32_t n = 0; n < h->node_count; n++) {
		const gi_uvec4 range = h->topology[n].range;
		double sum[4] = {0}, area = 0;
		for (uint32_t leaf = range.y; leaf < range.y + range.z; leaf++) {
			const gi_material *m = &o->materials[h->leaf_material[leaf]];
			const double a = h->geometry[h->leaf_node[leaf]].moment.w;
			for (int c = 0; c < 3; c++)
				sum[c] += a * m->exitance[c];
			sum[3] += a * fmaxf(m->rho[0], fmaxf(m->rho[1], m->rho[2]));
			area += a;
		}
		s->node_exitance[o->node_base + n] = (gi_vec4){(float)(sum[0] / area), (float)(sum[1] / area),
							       (float)(sum[2] / area), (float)(sum[3] / area)};
		uint32_t *flags = &s->topology[o->node_base + n].range.w;
		*flags = sum[0] + sum[1] + sum[2] > 0 ? *flags | GI_NODE_EMITTER : *flags & ~GI_NODE_EMITTER;
	}
}

static gi_material_data material_data(const gi_material *m)
{
	return (gi_material_data){{m->rho[0], m->rho[1], m->rho[2], 0}, {m->exitance[0], m->exitance[1], m->exitance[2], 0}};
}

/* ---- commit ---- */

bool scene_encloses(const gi_context *gi)
{
	const gi_scene *s = &gi->scene;
	for (uint32_t k = 0; k < s->object_count; k++) {
		const scene_object *room = &s->objects[k];
		if (!is_alive(room) || !room->hierarchy.closed || !(room->hierarchy.volume < 0))
			continue;
		bool all = true;
		for (uint32_t j = 0; j < s->object_count && all; j++) {
			const scene_object *o = &s->objects[j];
			for (int c = 0; c < 3 && is_alive(o); c++)
				all = all && (&o->world_lower.x)[c] >= (&room->world_lower.x)[c] - 1e-4f * fabsf((&room->world_lower.x)[c]) &&
				      (&o->world_upper.x)[c] <= (&room->world_upper.x)[c] + 1e-4f * fabsf((&room->world_upper.x)[c]);
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
	gi_node_geometry *rest;
	gi_node_spread *spread;
	gi_vec4 *vertices;
	gi_uvec4 *leaves;
	gi_material_data *materials;
	gi_uvec4 *bvh; /* packed */
	gi_primitive *primitives;
	uint32_t *wide;
	gi_uvec4 *light_links; /* two uint pairs each */
	uint32_t *light_first;
	uint32_t bvh_count, primitive_count, material_count, light_link_count;
} gathered;

static void gathered_free(gathered *g)
{
	gi_hierarchy_free(&g->sky);
	free(g->rest);
	free(g->spread);
	free(g->vertices);
	free(g->leaves);
	free(g->materials);
	free(g->bvh);
	free(g->primitives);
	free(g->wide);
	free(g->light_links);
	free(g->light_first);
}

static void count_all(const gi_context *gi, gathered *g)
{
	gi_scene *n = &g->next;
	for (uint32_t k = 0; k < gi->scene.object_count; k++) {
		scene_object *o = &gi->scene.objects[k];
		if (!is_alive(o))
			continue;
		n->slot_count++;
		n->leaf_count += o->hierarchy.leaf_count;
		n->node_count += o->hierarchy.node_count;
		n->vertex_count += o->hierarchy.vertex_count;
		n->light_count += o->skin.light_count;
		g->bvh_count += o->bvh.node_count;
		g->primitive_count += o->bvh.primitive_count;
		g->material_count += o->material_count;
		g->light_link_count += o->skin.light_first[o->skin.light_count];
	}
	n->tlas_count = n->slot_count ? 2 * n->slot_count - 1 : 0;
	n->sky_slot = GI_NONE;
	if (g->sky.node_count) {
		n->sky_slot = n->slot_count++;
		n->node_count += g->sky.node_count;
		n->vertex_count += g->sky.vertex_count;
	}
}

/* One element more than asked: nothing is not a failure. */
static void *allocate(size_t count, size_t size)
{
	return calloc(count + 1, size);
}

static bool allocate_all(gathered *g)
{
	gi_scene *n = &g->next;
	n->slots = allocate(n->slot_count, sizeof *n->slots);
	n->object_data = allocate(n->slot_count, sizeof *n->object_data);
	n->topology = allocate(n->node_count, sizeof *n->topology);
	n->node_exitance = allocate(n->node_count, sizeof *n->node_exitance);
	n->tlas = allocate(n->tlas_count, sizeof *n->tlas);
	n->tlas_packed = allocate(n->tlas_count, sizeof *n->tlas_packed);
	n->tlas_order = allocate(n->slot_count, sizeof *n->tlas_order);
	g->rest = allocate(n->node_count, sizeof *g->rest);
	g->spread = allocate(n->node_count, sizeof *g->spread);
	g->vertices = allocate(n->vertex_count, sizeof *g->vertices);
	g->leaves = allocate(n->leaf_count, sizeof *g->leaves);
	g->materials = allocate(g->material_count, sizeof *g->materials);
	g->bvh = allocate(g->bvh_count, sizeof *g->bvh);
	g->primitives = allocate(g->primitive_count, sizeof *g->primitives);
	g->wide = allocate(n->node_count, sizeof *g->wide);
	g->light_links = allocate(g->light_link_count / 2, sizeof *g->light_links);
	g->light_first = allocate(n->light_count, sizeof *g->light_first);
	return n->slots && n->object_data && n->topology && n->node_exitance && n->tlas && n->tlas_packed && n->tlas_order && g->rest && g->spread &&
	       g->vertices && g->leaves && g->materials && g->bvh && g->primitives && g->wide && g->light_links && g->light_first;
}

static void gather_hierarchy(gathered *g, const gi_hierarchy *h, uint32_t node_base, uint32_t vertex_base, uint32_t leaf_base)
{
	memcpy(g->rest + node_base, h->geometry, sizeof *g->rest * h->node_count);
	if (h->spread)
		memcpy(g->spread + node_base, h->spread, sizeof *g->spread * h->node_count);
	memcpy(g->vertices + vertex_base, h->vertices, sizeof *g->vertices * h->vertex_count);
	for (uint32_t k = 0; k < h->node_count; k++) {
		gi_node_topology t = h->topology[k];
		t.range.x += node_base;
		t.range.y += leaf_base;
		uint32_t *corners = &t.corners.x;
		for (int c = 0; c < 4; c++)
			corners[c] += corners[c] == GI_NONE ? 0 : vertex_base;
		g->next.topology[node_base + k] = t;
		if (t.range.z > GI_WIDE_LEAVES)
			g->wide[g->next.wide_count++] = node_base + k;
	}
}

static float add_bits(float value, uint32_t base)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof bits);
	bits += bits == GI_NONE ? 0 : base;
	memcpy(&value, &bits, sizeof bits);
	return value;
}

static void gather_rays(gathered *g, const scene_object *o, gi_object_data *data)
{
	set_grid(&o->hierarchy.lower, &o->hierarchy.upper, &data->grid, &data->cells);
	for (uint32_t k = 0; k < o->bvh.node_count; k++)
		g->bvh[o->bvh_base + k] = pack_node(&o->bvh.nodes[k], data->grid, data->cells, o->bvh_base, o->primitive_base);
	for (uint32_t k = 0; k < o->bvh.primitive_count; k++) {
		gi_primitive p = o->bvh.primitives[k];
		p.a.w = add_bits(p.a.w, o->leaf_base);
		p.b.w = add_bits(p.b.w, o->leaf_base);
		g->primitives[o->primitive_base + k] = p;
	}
}

/* Does the whole object lie in one plane? To 1e-6 of its size, as rays' ends are. */
static bool is_plane(const gi_hierarchy *h)
{
	const gi_vec4 axis = h->geometry[0].axis, centre = h->geometry[0].sphere;
	if (axis.w < 0.999999f)
		return false;
	for (uint32_t k = 0; k < h->vertex_count; k++) {
		const gi_vec4 v = h->vertices[k];
		const double height = (double)axis.x * ((double)v.x - centre.x) + (double)axis.y * ((double)v.y - centre.y) +
				      (double)axis.z * ((double)v.z - centre.z);
		if (fabs(height) > 1e-6 * centre.w)
			return false;
	}
	return true;
}

static void gather_light(gathered *g, const scene_object *o, uint32_t link_base)
{
	const gi_skin *skin = &o->skin;
	uint32_t *links = (uint32_t *)g->light_links;
	for (uint32_t k = 0; k < skin->light_count; k++)
		g->light_first[o->light_base + k] = link_base + skin->light_first[k];
	for (uint32_t k = 0; k < skin->light_first[skin->light_count]; k++) {
		links[2 * (link_base + k)] = o->leaf_base + skin->light_leaf[k];
		memcpy(&links[2 * (link_base + k) + 1], &skin->light_weight[k], sizeof(float));
	}
}

/* What this object's part of the old scene was, to carry its B over. */
typedef struct carried {
	uint32_t index, node_base, leaf_base;
} carried;

static void gather_objects(gi_context *gi, gathered *g, carried *old, uint32_t *old_count)
{
	gi_scene *n = &g->next;
	uint32_t slot = 0, node = 0, vertex = 0, leaf = 0, material = 0, bvh = 0, primitive = 0, light = 0, link = 0;
	for (uint32_t k = 0; k < gi->scene.object_count; k++) {
		scene_object *o = &gi->scene.objects[k];
		if (!is_alive(o))
			continue;
		if (o->committed)
			old[(*old_count)++] = (carried){k, o->node_base, o->leaf_base};
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
		for (uint32_t m = 0; m < o->material_count; m++)
			g->materials[material + m] = material_data(&o->materials[m]);
		for (uint32_t l = 0; l < o->hierarchy.leaf_count; l++)
			g->leaves[leaf + l] = (gi_uvec4){node + o->hierarchy.leaf_node[l], slot,
							 material + o->hierarchy.leaf_material[l], 0};
		gi_object_data *data = &n->object_data[slot];
		gather_rays(g, o, data);
		o->plane = is_plane(&o->hierarchy);
		data->lower = o->hierarchy.lower;
		data->upper = o->hierarchy.upper;
		data->nodes = (gi_uvec4){node, node + o->hierarchy.node_count, leaf, leaf + o->hierarchy.leaf_count};
		data->bvh = (gi_uvec4){bvh, bvh + o->bvh.node_count, 0, 0};
		data->extra = (gi_uvec4){0, vertex, vertex + o->hierarchy.vertex_count, 0};
		place_object(o, data);
		slot++;
		node += o->hierarchy.node_count;
		vertex += o->hierarchy.vertex_count;
		leaf += o->hierarchy.leaf_count;
		material += o->material_count;
		bvh += o->bvh.node_count;
		primitive += o->bvh.primitive_count;
		light += o->skin.light_count;
		link += o->skin.light_first[o->skin.light_count];
	}
	g->light_first[light] = link;
	if (n->sky_slot == GI_NONE)
		return;
	gi_object_data *data = &n->object_data[slot];
	n->slots[slot] = GI_NONE;
	gather_hierarchy(g, &g->sky, node, vertex, 0);
	data->nodes = (gi_uvec4){node, node + g->sky.node_count, leaf, leaf};
	data->bvh = (gi_uvec4){0, 0, GI_OBJECT_SKY, 0};
	data->extra = (gi_uvec4){0, vertex, vertex + g->sky.vertex_count, 0};
	place_sky(data);
	for (uint32_t k = 0; k < g->sky.node_count; k++) {
		const float *e = gi->def.sky_exitance;
		n->node_exitance[node + k] = (gi_vec4){e[0], e[1], e[2], 0};
	}
}

static gi_result upload_gathered(gi_context *gi, gathered *g)
{
	gpu *gpu = &gi->gpu;
	gi_scene *s = &gi->scene, *n = &g->next;
	const struct {
		gpu_buffer *buffer;
		uint64_t size;
		const void *data;
	} uploads[] = {
		{&s->objects_gpu, sizeof(gi_object_data) * n->slot_count, n->object_data},
		{&s->topology_gpu, sizeof(gi_node_topology) * n->node_count, n->topology},
		{&s->rest_gpu, sizeof(gi_node_geometry) * n->node_count, g->rest},
		{&s->spread_gpu, sizeof(gi_node_spread) * n->node_count, g->spread},
		{&s->world_gpu, sizeof(gi_node_geometry) * n->node_count, NULL},
		{&s->vertices_rest_gpu, sizeof(gi_vec4) * n->vertex_count, g->vertices},
		{&s->vertices_world_gpu, sizeof(gi_vec4) * n->vertex_count, NULL},
		{&s->leaves_gpu, sizeof(gi_uvec4) * n->leaf_count, g->leaves},
		{&s->materials_gpu, sizeof(gi_material_data) * g->material_count, g->materials},
		{&s->bvh_gpu, sizeof(gi_uvec4) * g->bvh_count, g->bvh},
		{&s->primitives_gpu, sizeof(gi_primitive) * g->primitive_count, g->primitives},
		{&s->tlas_gpu, sizeof(gi_uvec4) * n->tlas_count, NULL},
		{&s->node_exitance_gpu, sizeof(gi_vec4) * n->node_count, n->node_exitance},
		{&s->wide_nodes_gpu, sizeof(uint32_t) * n->wide_count, g->wide},
		{&s->light_links_gpu, sizeof(uint32_t) * 2 * g->light_link_count, g->light_links},
		{&s->light_first_gpu, sizeof(uint32_t) * (n->light_count + 1), g->light_first},
	};
	for (size_t k = 0; k < sizeof uploads / sizeof *uploads; k++) {
		gi_result result = gpu_buffer_allocate(gpu, uploads[k].buffer, uploads[k].size, uploads[k].data);
		if (result)
			return result;
	}
	return GI_OK;
}

static void free_cpu_arrays(gi_scene *s)
{
	free(s->slots);
	free(s->object_data);
	free(s->topology);
	free(s->node_exitance);
	free(s->tlas);
	free(s->tlas_packed);
	free(s->tlas_order);
}

/* Takes over counts and CPU arrays; the buffers stay where they are. */
static void adopt(gi_scene *s, const gi_scene *n)
{
	free_cpu_arrays(s);
	s->slots = n->slots;
	s->object_data = n->object_data;
	s->topology = n->topology;
	s->node_exitance = n->node_exitance;
	s->tlas = n->tlas;
	s->tlas_packed = n->tlas_packed;
	s->tlas_order = n->tlas_order;
	s->tlas_count = n->tlas_count;
	s->slot_count = n->slot_count;
	s->sky_slot = n->sky_slot;
	s->leaf_count = n->leaf_count;
	s->node_count = n->node_count;
	s->vertex_count = n->vertex_count;
	s->light_count = n->light_count;
	s->wide_count = n->wide_count;
}

/* B of objects that stay moves from the old buffers to the new ones; new objects start from E (solver.c). */
static void carry_radiosity(gi_context *gi, gi_solver *before, const carried *old, uint32_t old_count)
{
	for (uint32_t k = 0; k < old_count; k++) {
		const scene_object *o = &gi->scene.objects[old[k].index];
		const uint64_t vec = sizeof(gi_vec4);
		gpu_buffer_copy(&before->radiosity, vec * old[k].node_base, &gi->solver.radiosity, vec * o->node_base,
				vec * o->hierarchy.node_count);
		gpu_buffer_copy(&before->leaf_radiosity, vec * old[k].leaf_base, &gi->solver.leaf_radiosity, vec * o->leaf_base,
				vec * o->hierarchy.leaf_count);
	}
}

static bool wants_sky(const gi_context *gi)
{
	return gi->def.sky == GI_SKY_ON || (gi->def.sky == GI_SKY_AUTO && !scene_encloses(gi));
}

gi_result scene_upload(gi_context *gi)
{
	gi_scene *s = &gi->scene;
	gathered g = {0};
	uint32_t old_count = 0;
	carried *old = allocate(s->object_count, sizeof *old);
	gi_result result = GI_ERROR_OUT_OF_MEMORY;
	/* Boxes first: whether there is a sky depends on them. */
	for (uint32_t k = 0; k < s->object_count; k++)
		if (is_alive(&s->objects[k])) {
			gi_object_data scratch;
			place_object(&s->objects[k], &scratch);
		}
	bool ready = old && (!wants_sky(gi) || sky_build(&g.sky));
	if (ready) {
		count_all(gi, &g);
		ready = allocate_all(&g);
	}
	if (!ready) {
		free_cpu_arrays(&g.next);
		gi_fail(&gi->gpu.log, result, "out of memory");
	} else {
		gather_objects(gi, &g, old, &old_count);
		adopt(s, &g.next);
		for (uint32_t k = 0; k < s->object_count; k++)
			if (is_alive(&s->objects[k]))
				scene_update_exitance(gi, &s->objects[k]);
		lamps_select(gi, false);
		result = upload_gathered(gi, &g);
	}
	gi_solver before = gi->solver;
	if (!result) {
		gi->solver.radiosity = gi->solver.leaf_radiosity = (gpu_buffer){0};
		result = solver_allocate(gi);
		if (!result && s->ever_committed)
			carry_radiosity(gi, &before, old, old_count);
		gpu_buffer_free(&gi->gpu, &before.radiosity);
		gpu_buffer_free(&gi->gpu, &before.leaf_radiosity);
	}
	free(old);
	gathered_free(&g);
	return result;
}

/* ---- per frame ---- */

static gi_result upload_tlas(gi_context *gi)
{
	gi_scene *s = &gi->scene;
	const uint32_t count = s->tlas_count ? (s->tlas_count + 1) / 2 : 0;
	gi_vec4 *lower = allocate(count, sizeof *lower), *upper = allocate(count, sizeof *upper);
	bool ok = lower && upper;
	for (uint32_t k = 0; ok && k < count; k++) {
		lower[k] = s->objects[s->slots[k]].world_lower;
		upper[k] = s->objects[s->slots[k]].world_upper;
	}
	ok = ok && gi_bvh_build_boxes(lower, upper, count, s->tlas, s->tlas_order);
	free(lower);
	free(upper);
	if (!ok)
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	if (!s->tlas_count)
		return GI_OK;
	set_grid(&(gi_vec4){s->tlas[0].lower.x, s->tlas[0].lower.y, s->tlas[0].lower.z, 0},
		 &(gi_vec4){s->tlas[0].upper.x, s->tlas[0].upper.y, s->tlas[0].upper.z, 0}, &s->tlas_grid, &s->tlas_cells);
	for (uint32_t k = 0; k < s->tlas_count; k++) {
		gi_uvec4 *packed = &s->tlas_packed[k];
		*packed = pack_node(&s->tlas[k], s->tlas_grid, s->tlas_cells, 0, 0);
		/* Leaves of the tree name slots directly. */
		if (packed->w & GI_PACKED_LEAF)
			packed->w = GI_PACKED_LEAF | s->tlas_order[packed->w & ~GI_PACKED_LEAF];
	}
	gpu_buffer_upload(&gi->gpu, &s->tlas_gpu, 0, sizeof *s->tlas_packed * s->tlas_count, s->tlas_packed);
	return GI_OK;
}

static void upload_material(gi_context *gi, scene_object *o)
{
	gi_scene *s = &gi->scene;
	for (uint32_t m = 0; m < o->material_count; m++) {
		const gi_material_data data = material_data(&o->materials[m]);
		gpu_buffer_upload(&gi->gpu, &s->materials_gpu, sizeof data * (o->material_base + m), sizeof data, &data);
	}
	scene_update_exitance(gi, o);
	const uint64_t count = o->hierarchy.node_count;
	gpu_buffer_upload(&gi->gpu, &s->node_exitance_gpu, sizeof(gi_vec4) * o->node_base, sizeof(gi_vec4) * count,
			  s->node_exitance + o->node_base);
	gpu_buffer_upload(&gi->gpu, &s->topology_gpu, sizeof(gi_node_topology) * o->node_base, sizeof(gi_node_topology) * count,
			  s->topology + o->node_base);
}

gi_result scene_upload_changes(gi_context *gi)
{
	gi_scene *s = &gi->scene;
	bool relit = false;
	for (uint32_t slot = 0; slot < s->slot_count; slot++) {
		gi_object_data *data = &s->object_data[slot];
		scene_object *o = s->slots[slot] == GI_NONE ? NULL : &s->objects[s->slots[slot]];
		data->bvh.z = o ? 0 : GI_OBJECT_SKY;
		if (o && o->plane)
			data->bvh.z |= GI_OBJECT_FLAT;
		if (o && o->moved) {
			place_object(o, data);
			data->bvh.z |= GI_OBJECT_MOVED;
		}
		if (o && o->material_changed)
			upload_material(gi, o);
		relit = relit || (o && o->material_changed);
	}
	if (relit)
		lamps_select(gi, true);
	return upload_tlas(gi);
}

void scene_bind(const gi_context *gi)
{
	const gi_scene *s = &gi->scene;
	gpu_bind_storage(GI_BIND_OBJECTS, &s->objects_gpu);
	gpu_bind_storage(GI_BIND_TOPOLOGY, &s->topology_gpu);
	gpu_bind_storage(GI_BIND_REST, &s->rest_gpu);
	gpu_bind_storage(GI_BIND_SPREAD, &s->spread_gpu);
	gpu_bind_storage(GI_BIND_WORLD, &s->world_gpu);
	gpu_bind_storage(GI_BIND_VERTICES_REST, &s->vertices_rest_gpu);
	gpu_bind_storage(GI_BIND_VERTICES_WORLD, &s->vertices_world_gpu);
	gpu_bind_storage(GI_BIND_LEAVES, &s->leaves_gpu);
	gpu_bind_storage(GI_BIND_MATERIALS, &s->materials_gpu);
	gpu_bind_storage(GI_BIND_BVH, &s->bvh_gpu);
	gpu_bind_storage(GI_BIND_PRIMITIVES, &s->primitives_gpu);
	gpu_bind_storage(GI_BIND_TLAS, &s->tlas_gpu);
	gpu_bind_storage(GI_BIND_NODE_EXITANCE, &s->node_exitance_gpu);
	gpu_bind_storage(GI_BIND_WIDE_NODES, &s->wide_nodes_gpu);
	gpu_bind_storage(GI_BIND_LIGHT_LINKS, &s->light_links_gpu);
	gpu_bind_storage(GI_BIND_LIGHT_FIRST, &s->light_first_gpu);
}

void scene_free(gi_context *gi)
{
	gi_scene *s = &gi->scene;
	for (uint32_t k = 0; k < s->object_count; k++)
		scene_free_object(&s->objects[k]);
	free(s->objects);
	free_cpu_arrays(s);
	gpu_buffer *buffers[] = {&s->objects_gpu,	&s->topology_gpu,	&s->rest_gpu,	     &s->world_gpu,
				 &s->vertices_rest_gpu, &s->vertices_world_gpu, &s->leaves_gpu,	     &s->materials_gpu,
				 &s->bvh_gpu,		&s->primitives_gpu,	&s->tlas_gpu,	     &s->node_exitance_gpu,
				 &s->wide_nodes_gpu,	&s->light_links_gpu,	&s->light_first_gpu,  &s->spread_gpu};
	for (size_t k = 0; k < sizeof buffers / sizeof *buffers; k++)
		gpu_buffer_free(&gi->gpu, buffers[k]);
}
