#include "casters.h"

#include "context.h"
#include "frames.h"
#include "host_memory.h"

#include <math.h>
#include <string.h>

/* Of objects of at most this many flat polygons each polygon is asked whether it is a wall of the whole scene, which
 * hides nothing. */
enum { WALL_POLYGONS = 64 };

/* All objects share this many bounding spheres. Each costs a lamp some 0.5 us when something moves, and a look at its
 * mask in every picture. */
enum { SPHERES = 2048 };

/* And no object gets more. */
enum { MOST_SPHERES = 512 };

/* Vertices this share of the wall's own size behind it still lie on it. */
static const double WALL_SLACK = 1e-4;

typedef struct caster_vertex {
	float position[3];
	uint32_t slot;
} caster_vertex;

/* ---- the surface ---- */

/* The next of the coarsest flat polygons that tile the object, GI_NONE after the last; *node is where the walk is. What
 * is flat of a shape that changes need not stay so: leaves do. */
static uint32_t next_flat(const gi_hierarchy *h, uint32_t *node)
{
	while (*node < h->node_count) {
		const gi_uvec4 range = h->topology[*node].range;
		const uint32_t found = *node;
		if ((range.w & GI_NODE_LEAF) ||
		    (!h->deforms && (range.w & GI_NODE_POLYGON) && (range.w & GI_NODE_FLAT))) {
			*node = range.x;
			return found;
		}
		++*node;
	}
	return GI_NONE;
}

static uint32_t add_polygon(uint32_t *indices, const gi_node_topology *t, uint32_t base)
{
	const gi_uvec4 c = t->corners;
	const uint32_t six[6] = {c.x + base, c.y + base, c.z + base, c.x + base, c.z + base, c.w + base};
	const uint32_t count = c.z == c.w ? 3 : 6;
	memcpy(indices, six, sizeof *six * count);
	return count;
}

/* There is room for them. */
static void fill_walls(const gi_hierarchy *h, gi_caster *c)
{
	uint32_t at = c->range.first, node = 0, found;
	c->wall_count = 0;
	while ((found = next_flat(h, &node)) != GI_NONE) {
		caster_wall *w = &c->walls[c->wall_count++];
		const uint32_t *corners = &h->topology[found].corners.x;
		for (int k = 0; k < 4; k++)
			memcpy(w->corner[k], &h->vertices[corners[k]], sizeof w->corner[k]);
		w->range = (gpu_range){at, corners[2] == corners[3] ? 3 : 6};
		at += w->range.count;
	}
}

static bool add_walls(const gi_hierarchy *h, gi_caster *c, uint32_t polygons)
{
	c->walls = gi_calloc(polygons + 1, sizeof *c->walls);
	if (c->walls)
		fill_walls(h, c);
	return c->walls;
}

static uint32_t child_count(const gi_hierarchy *h, uint32_t node)
{
	uint32_t count = 0;
	for (uint32_t child = node + 1; child < h->topology[node].range.x; child = h->topology[child].range.x)
		count++;
	return count;
}

/* The largest of the nodes that have children, as its place in the list. */
static uint32_t largest_node(const gi_hierarchy *h, const uint32_t *nodes, uint32_t count)
{
	uint32_t largest = GI_NONE;
	for (uint32_t k = 0; k < count; k++)
		if (child_count(h, nodes[k]) &&
		    (largest == GI_NONE || h->geometry[nodes[k]].sphere.w > h->geometry[nodes[largest]].sphere.w))
			largest = k;
	return largest;
}

/* Nodes that tile the object, the largest parted until there are enough. */
static uint32_t part(const gi_hierarchy *h, uint32_t *nodes, uint32_t limit)
{
	uint32_t count = 1, largest;
	nodes[0] = 0;
	while ((largest = largest_node(h, nodes, count)) != GI_NONE) {
		const uint32_t parent = nodes[largest];
		if (count - 1 + child_count(h, parent) > limit)
			break;
		nodes[largest] = nodes[--count];
		for (uint32_t child = parent + 1; child < h->topology[parent].range.x;
		     child = h->topology[child].range.x)
			nodes[count++] = child;
	}
	return count;
}

static bool add_spheres(const gi_hierarchy *h, gi_caster *c, uint32_t limit)
{
	uint32_t nodes[MOST_SPHERES];
	c->sphere_count = part(h, nodes, limit);
	c->spheres = gi_malloc(sizeof *c->spheres * c->sphere_count);
	for (uint32_t k = 0; c->spheres && k < c->sphere_count; k++)
		c->spheres[k] = h->geometry[nodes[k]].sphere;
	if (!h->deforms)
		return c->spheres;
	c->sphere_nodes = gi_malloc(sizeof *nodes * c->sphere_count);
	if (c->sphere_nodes)
		memcpy(c->sphere_nodes, nodes, sizeof *nodes * c->sphere_count);
	return c->spheres && c->sphere_nodes;
}

static bool share_spheres(const gi_scene *s, gi_casters *casters)
{
	uint32_t objects = 0;
	for (uint32_t slot = 0; slot < casters->count; slot++)
		objects += casters->list[slot].range.count > 0;
	const uint32_t share = objects && objects < SPHERES ? SPHERES / objects : 1;
	bool ok = true;
	for (uint32_t slot = 0; ok && slot < casters->count; slot++)
		if (casters->list[slot].range.count)
			ok = add_spheres(&s->objects[s->slots[slot]].hierarchy, &casters->list[slot],
					 share < MOST_SPHERES ? share : MOST_SPHERES);
	return ok;
}

/* Flat surfaces are drawn where they are. Others: each drawn vertex lies so far from its leaf's middle, which is
 * inside. */
static double distance_of_drawn(const object_record *o, bool flat)
{
	double far = 0, outside = 0;
	for (uint32_t k = 0; k < o->drawn.vertex_count; k++) {
		const gi_draw_vertex *v = &o->drawn.vertices[k];
		const gi_vec4 s = o->hierarchy.geometry[o->hierarchy.leaf_node[v->leaf]].sphere;
		const double d = gi_vec3d_length(gi_vec3d_sub(gi_vec3d_load(v->position), gi_vec3d_from(s)));
		far = fmax(far, d);
		outside = fmax(outside, d - 1.001 * s.w);
	}
	return flat && outside <= 0 ? 0 : far;
}

/* Is anything drawn elsewhere than on the leaves' planes? */
static bool is_drawn_elsewhere(const object_record *o)
{
	static const double SLACK = 1e-3;
	bool elsewhere = false;
	for (uint32_t k = 0; k < o->drawn.vertex_count && !elsewhere; k++) {
		const gi_draw_vertex *v = &o->drawn.vertices[k];
		const gi_node_geometry *g = &o->hierarchy.geometry[o->hierarchy.leaf_node[v->leaf]];
		const gi_vec3d from = gi_vec3d_sub(gi_vec3d_load(v->position), gi_vec3d_from(g->sphere));
		elsewhere = fabs(gi_vec3d_dot(gi_vec3d_from(g->axis), from)) > SLACK * (double)g->sphere.w;
	}
	return elsewhere;
}

/* How far what is drawn reaches out of the box of the leaves. */
static double beyond_box(const object_record *o)
{
	const float *lower = &o->hierarchy.lower.x, *upper = &o->hierarchy.upper.x;
	double beyond = 0;
	for (uint32_t k = 0; k < o->drawn.vertex_count; k++)
		for (int axis = 0; axis < 3; axis++) {
			const double at = o->drawn.vertices[k].position[axis];
			beyond = fmax(beyond, fmax((double)lower[axis] - at, at - (double)upper[axis]));
		}
	return beyond;
}

/* All casters' triangles. */
typedef struct caster_mesh {
	caster_vertex *vertices;
	uint32_t *indices;
	uint32_t vertex_count, index_count;
} caster_mesh;

static void add_vertex(caster_mesh *mesh, const void *position, uint32_t slot)
{
	caster_vertex *v = &mesh->vertices[mesh->vertex_count++];
	memcpy(v->position, position, sizeof v->position);
	v->slot = slot;
}

/* The coarsest flat polygons of the leaves; how many. */
static uint32_t add_polygons(const gi_hierarchy *h, uint32_t slot, caster_mesh *mesh)
{
	const uint32_t base = mesh->vertex_count;
	for (uint32_t v = 0; v < h->vertex_count; v++)
		add_vertex(mesh, &h->vertices[v], slot);
	uint32_t node = 0, found, polygons = 0;
	for (; (found = next_flat(h, &node)) != GI_NONE; polygons++)
		mesh->index_count += add_polygon(mesh->indices + mesh->index_count, &h->topology[found], base);
	return polygons;
}

/* What is drawn. */
static void add_drawn(const gi_drawn_surface *drawn, uint32_t slot, caster_mesh *mesh)
{
	const uint32_t base = mesh->vertex_count;
	for (uint32_t v = 0; v < drawn->vertex_count; v++)
		add_vertex(mesh, drawn->vertices[v].position, slot);
	for (uint32_t k = 0; k < drawn->index_count; k++)
		mesh->indices[mesh->index_count++] = base + drawn->indices[k];
}

/* What is known of a caster besides its triangles. `many`: polygons, too many to look at. */
static void measure(const object_record *o, bool many, gi_caster *c)
{
	const gi_hierarchy *h = &o->hierarchy;
	/* Twice: points are moved along their normals when they look for their shadows. */
	const double far = distance_of_drawn(o, !many);
	c->solid = !c->as_drawn && h->closed && h->volume > 0; /* a detailed mesh may be open where its cage is not */
	c->off = 2 * far;
	c->outside = c->as_drawn ? far : 0;
	c->outside_box = c->as_drawn ? beyond_box(o) : 0;
}

static bool add_caster(const object_record *o, uint32_t slot, bool fine, gi_caster *c, caster_mesh *mesh)
{
	const gi_hierarchy *h = &o->hierarchy;
	c->first_vertex = mesh->vertex_count;
	c->range.first = mesh->index_count;
	const uint32_t polygons = add_polygons(h, slot, mesh);
	c->as_drawn = fine && o->drawn.index_count && (h->deforms || is_drawn_elsewhere(o));
	const bool many = c->as_drawn || polygons > WALL_POLYGONS;
	if (c->as_drawn) {
		mesh->vertex_count = c->first_vertex;
		mesh->index_count = c->range.first;
		add_drawn(&o->drawn, slot, mesh);
	}
	c->range.count = mesh->index_count - c->range.first;
	c->vertex_count = mesh->vertex_count - c->first_vertex;
	measure(o, many, c);
	return many || add_walls(h, c, polygons);
}

static bool reserve_staging(gi_casters *casters, uint32_t count)
{
	if (count <= casters->staging_room)
		return true;
	caster_vertex *grown = gi_realloc(casters->staging, sizeof *grown * count);
	if (!grown)
		return false;
	casters->staging = grown;
	casters->staging_room = count;
	return true;
}

bool casters_refit(gi_context *gi, gi_casters *casters, uint32_t slot)
{
	const object_record *o = &gi->scene.objects[gi->scene.slots[slot]];
	gi_caster *c = &casters->list[slot];
	if (!c->range.count)
		return true;
	if (!reserve_staging(casters, c->vertex_count))
		return false;
	for (uint32_t v = 0; v < c->vertex_count; v++) {
		const void *at = c->as_drawn ? (const void *)o->drawn.vertices[v].position : &o->hierarchy.vertices[v];
		memcpy(casters->staging[v].position, at, sizeof casters->staging[v].position);
		casters->staging[v].slot = slot;
	}
	gpu_buffer_upload(&gi->gpu, &casters->mesh.vertices, sizeof(caster_vertex) * c->first_vertex,
			  sizeof(caster_vertex) * c->vertex_count, casters->staging);
	measure(o, !c->wall_count, c);
	if (c->wall_count)
		fill_walls(&o->hierarchy, c);
	for (uint32_t k = 0; k < c->sphere_count; k++)
		c->spheres[k] = o->hierarchy.geometry[c->sphere_nodes[k]].sphere;
	return true;
}

static bool allocate_mesh(const gi_scene *s, bool fine, caster_mesh *mesh)
{
	size_t vertices = s->vertex_count, indices = 6 * (size_t)s->leaf_count;
	for (uint32_t slot = 0; fine && slot < s->slot_count; slot++)
		if (scene_slot_is_seen(s, slot)) {
			vertices += s->objects[s->slots[slot]].drawn.vertex_count;
			indices += s->objects[s->slots[slot]].drawn.index_count;
		}
	mesh->vertices = gi_calloc(vertices + 1, sizeof *mesh->vertices);
	mesh->indices = gi_calloc(indices + 1, sizeof *mesh->indices);
	return mesh->vertices && mesh->indices;
}

gi_result casters_create(gi_context *gi, gi_casters *casters)
{
	const gi_scene *s = &gi->scene;
	const bool fine = gi->def.fine_shadows;
	caster_mesh mesh = {0};
	casters->list = gi_calloc(s->slot_count + 1, sizeof *casters->list);
	casters->count = s->slot_count;
	bool ok = allocate_mesh(s, fine, &mesh) && casters->list;
	for (uint32_t slot = 0; ok && slot < s->slot_count; slot++)
		if (scene_slot_is_seen(s, slot))
			ok = add_caster(&s->objects[s->slots[slot]], slot, fine, &casters->list[slot], &mesh);
	ok = ok && share_spheres(s, casters);
	static const gpu_attribute attributes[] = {{3, false, 0}, {1, true, offsetof(caster_vertex, slot)}, {0}};
	gi_result result = GI_OK;
	if (ok)
		result = gpu_mesh_create(&gi->gpu, &casters->mesh, "shadow casters", attributes, sizeof *mesh.vertices,
					 mesh.vertex_count, mesh.vertices, mesh.index_count, mesh.indices);
	else
		result = gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	gi_free(mesh.vertices);
	gi_free(mesh.indices);
	return result;
}

void casters_free(gi_context *gi, gi_casters *casters)
{
	for (uint32_t k = 0; casters->list && k < casters->count; k++) {
		gi_free(casters->list[k].walls);
		gi_free(casters->list[k].spheres);
		gi_free(casters->list[k].sphere_nodes);
	}
	gi_free(casters->list);
	gi_free(casters->ranges);
	gi_free(casters->staging);
	gpu_mesh_free(&gi->gpu, &casters->mesh);
	*casters = (gi_casters){0};
}

/* ---- what can hide something ---- */

/* Corners of the rest box, in the world: a tighter hull than the world's box of a turned object. */
static void place_box(const gi_object_data *d, double outside, gi_vec3d box[8])
{
	double ends[2][3];
	for (int axis = 0; axis < 3; axis++) {
		ends[0][axis] = (&d->lower.x)[axis] - outside;
		ends[1][axis] = (&d->upper.x)[axis] + outside;
	}
	for (int k = 0; k < 8; k++)
		box[k] = gi_point_to_world(d, (gi_vec3d){ends[k & 1][0], ends[k >> 1 & 1][1], ends[k >> 2][2]});
}

/* Does the whole scene lie on the front of the polygon's plane? Then it comes between no two points. */
static bool hides_nothing(const gi_context *gi, const gi_casters *casters, uint32_t slot, const caster_wall *w)
{
	const gi_object_data *d = &gi->scene.object_data[slot];
	gi_vec3d c[4];
	for (int k = 0; k < 4; k++)
		c[k] = gi_point_to_world(d, gi_vec3d_load(w->corner[k]));
	const gi_vec3d normal = gi_vec3d_cross(gi_vec3d_sub(c[2], c[0]), gi_vec3d_sub(c[3], c[1]));
	const double length = gi_vec3d_length(normal);
	if (!(length > 0))
		return true;
	const double slack = -WALL_SLACK * sqrt(length) * length, plane = gi_vec3d_dot(normal, c[0]);
	for (uint32_t k = 0; k < casters->count; k++) {
		if (k == slot || !scene_slot_is_seen(&gi->scene, k))
			continue;
		for (int b = 0; b < 8; b++)
			if (gi_vec3d_dot(normal, casters->list[k].box[b]) - plane < slack)
				return false;
	}
	/* Its own object polygon by polygon: a room's walls are seen from inside only. */
	const gi_caster *own = &casters->list[slot];
	for (uint32_t k = 0; k < own->wall_count; k++)
		for (int b = 0; b < 4; b++)
			if (gi_vec3d_dot(normal, gi_point_to_world(d, gi_vec3d_load(own->walls[k].corner[b]))) - plane <
			    slack)
				return false;
	return true;
}

static bool add_range(gi_casters *casters, uint32_t *count, gpu_range range, bool may_merge)
{
	if (may_merge && *count &&
	    casters->ranges[*count - 1].first + casters->ranges[*count - 1].count == range.first) {
		casters->ranges[*count - 1].count += range.count;
		return true;
	}
	if (*count == casters->range_capacity) {
		const uint32_t capacity = 2 * *count + 64;
		gpu_range *grown = gi_realloc(casters->ranges, sizeof *grown * capacity);
		if (!grown)
			return false;
		casters->ranges = grown;
		casters->range_capacity = capacity;
	}
	casters->ranges[(*count)++] = range;
	return true;
}

bool casters_place(const gi_context *gi, gi_casters *casters)
{
	uint32_t count = 0;
	bool ok = true;
	for (uint32_t slot = 0; slot < casters->count; slot++)
		place_box(&gi->scene.object_data[slot], casters->list[slot].outside_box, casters->list[slot].box);
	for (uint32_t slot = 0; ok && slot < casters->count; slot++) {
		gi_caster *c = &casters->list[slot];
		c->first_range = count;
		if (!c->wall_count && c->range.count)
			ok = add_range(casters, &count, c->range, false);
		for (uint32_t k = 0; ok && k < c->wall_count; k++) {
			c->walls[k].hides = !hides_nothing(gi, casters, slot, &c->walls[k]);
			if (c->walls[k].hides)
				ok = add_range(casters, &count, c->walls[k].range, count > c->first_range);
		}
		c->end_range = count;
	}
	return ok;
}
