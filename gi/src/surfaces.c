#include "surfaces.h"

#include "context.h"
#include "host_memory.h"
#include "vec3d.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* Where the drawn surface lies below the leaves' planes, it is taken this much higher when it looks for its shadows. */
static const double SINK_FACTOR = 1.1;

/* Attributes of vertices (draw.glsl). */
enum { UV_LOCATION = 5 };

typedef struct draw_vertex {
	float position[3];
	float normal[3];
	float sink;
	uint32_t leaf;
	uint32_t light[4];
	float weight[4];
} draw_vertex;

static float sink_of(const gi_hierarchy *h, const gi_draw_vertex *v)
{
	const uint32_t node = h->leaf_node[v->leaf];
	const gi_vec3d normal = gi_vec3d_from(h->geometry[node].axis);
	const uint32_t *corners = &h->topology[node].corners.x;
	double plane = 0;
	for (int k = 0; k < 4; k++)
		plane += 0.25 * gi_vec3d_dot(normal, gi_vec3d_from(h->vertices[corners[k]]));
	const double height = gi_vec3d_dot(normal, (gi_vec3d){v->position[0], v->position[1], v->position[2]}) - plane;
	return height < 0 ? (float)(-SINK_FACTOR * height) : 0.0f;
}

static uint32_t vertices_of(const object_record *o)
{
	return o->textures ? o->chart.vertex_count : o->drawn.vertex_count;
}

/* bases: of leaves and light vertices. */
static void fill_drawn(const object_record *o, const uint32_t bases[2], draw_vertex *vertices)
{
	const uint32_t count = o->drawn.vertex_count;
	for (uint32_t k = 0; k < count; k++) {
		const gi_draw_vertex *from = &o->drawn.vertices[k];
		draw_vertex *to = &vertices[k];
		memcpy(to->position, from->position, sizeof to->position);
		memcpy(to->normal, from->normal, sizeof to->normal);
		memcpy(to->weight, from->weight, sizeof to->weight);
		to->sink = sink_of(&o->hierarchy, from);
		to->leaf = bases[0] + from->leaf;
		for (int i = 0; i < 4; i++)
			to->light[i] = bases[1] + from->light[i];
	}
	for (uint32_t k = count; k < vertices_of(o); k++)
		vertices[k] = vertices[o->chart.source[k - count]];
}

/* ---- the mesh while it is built ---- */

/* Objects of one shape of fewer vertices have each their own: on a software renderer a draw call more takes some 40 us,
 * which is a third of the time of 2,000 vertices and nothing beside that of these. */
enum { LEAST_SHARED = 8000 };

/* An object in the order of drawing. */
typedef struct sized {
	double size;
	uint32_t slot;
	uint32_t home; /* the first that has the same vertices, as a place in the order: its own where no other has */
	bool shared;
	size_t first_vertex, first_index;
} sized;

typedef struct building {
	const gi_scene *scene;
	sized *order;
	uint32_t count;
	size_t vertex_count, index_count, part_count;
	bool by_parts;
	draw_vertex *vertices;
	float (*uvs)[2]; /* NULL: no object has textures */
	uint32_t *indices;
} building;

static int by_size(const void *a, const void *b)
{
	const sized *x = a, *y = b;
	return x->size < y->size ? -1 : x->size > y->size ? 1 : (x->slot > y->slot) - (x->slot < y->slot);
}

/* Slots of the objects, small ones first; the sky is none. */
static uint32_t order_slots(const gi_scene *s, sized *order)
{
	uint32_t count = 0;
	for (uint32_t slot = 0; slot < s->slot_count; slot++)
		if (scene_slot_is_seen(s, slot))
			order[count++] = (sized){.size = s->object_data[slot].sphere.w, .slot = slot};
	qsort(order, count, sizeof *order, by_size);
	return count;
}

static const object_record *object_at(const building *b, uint32_t place)
{
	return &b->scene->objects[b->scene->slots[b->order[place].slot]];
}

/* Of one shape, and with textures or without: the same vertices. */
typedef struct likeness {
	const uint32_t *sharers;
	bool textured;
	uint32_t place;
} likeness;

static int by_likeness(const void *a, const void *b)
{
	const likeness *x = a, *y = b;
	if (x->sharers != y->sharers)
		return (uintptr_t)x->sharers < (uintptr_t)y->sharers ? -1 : 1;
	if (x->textured != y->textured)
		return x->textured ? 1 : -1;
	return (x->place > y->place) - (x->place < y->place);
}

/* What lies in the mesh once for several objects. False: out of memory. */
static bool find_homes(building *b)
{
	likeness *list = gi_malloc(sizeof *list * ((size_t)b->count + 1));
	uint32_t count = 0;
	for (uint32_t k = 0; list && k < b->count; k++) {
		const object_record *o = object_at(b, k);
		b->order[k].home = k;
		if (*o->sharers > 1 && !o->deform && vertices_of(o) >= LEAST_SHARED)
			list[count++] = (likeness){o->sharers, o->textures != NULL, k};
	}
	if (count)
		qsort(list, count, sizeof *list, by_likeness);
	for (uint32_t k = 1; k < count; k++) {
		if (list[k].sharers != list[k - 1].sharers || list[k].textured != list[k - 1].textured)
			continue;
		sized *before = &b->order[list[k - 1].place], *one = &b->order[list[k].place];
		one->home = before->home;
		one->shared = before->shared = b->by_parts = true;
	}
	gi_free(list);
	return list;
}

/* Room for all there is. */
static bool allocate(gi_surfaces *s, building *b)
{
	for (uint32_t k = 0; k < b->count; k++) {
		const object_record *o = object_at(b, k);
		b->vertex_count += b->order[k].home == k ? vertices_of(o) : 0;
		b->index_count += b->order[k].home == k ? o->drawn.index_count : 0;
		b->part_count += o->textures ? o->chart.material_count : 1;
		s->textured = s->textured || o->textures;
	}
	b->by_parts = b->by_parts || s->textured;
	b->vertices = gi_malloc(sizeof *b->vertices * (b->vertex_count + 1));
	b->indices = gi_malloc(sizeof *b->indices * (b->index_count + 1));
	b->uvs = s->textured ? gi_calloc(b->vertex_count + 1, sizeof *b->uvs) : NULL;
	s->parts = b->by_parts ? gi_malloc(sizeof *s->parts * (b->part_count + 1)) : NULL;
	s->first_vertex = gi_malloc(sizeof *s->first_vertex * (b->scene->slot_count + 1));
	return b->vertices && b->indices && s->first_vertex && (b->uvs || !s->textured) && (s->parts || !b->by_parts);
}

static bool follows(const surfaces_part *last, const surfaces_part *part)
{
	return !last->shared && !part->shared && last->material == GI_NONE && part->material == GI_NONE &&
	       last->range.first + last->range.count == part->range.first;
}

/* `like`: all but its range and material. */
static void add_part(gi_surfaces *s, surfaces_part like, uint32_t first, uint32_t count, uint32_t material)
{
	surfaces_part *last = s->part_count ? &s->parts[s->part_count - 1] : NULL;
	if (!count)
		return;
	like.range = (gpu_range){first, count};
	like.material = material;
	if (last && follows(last, &like))
		last->range.count += count;
	else
		s->parts[s->part_count++] = like;
}

static void add_parts(gi_surfaces *s, const object_record *o, const sized *place)
{
	const uint32_t first = (uint32_t)place->first_index;
	surfaces_part like = {.slot = place->slot, .shared = place->shared};
	if (place->shared) {
		like.bases[0] = o->leaf_base;
		like.bases[1] = o->light_base;
	}
	if (!o->textures) {
		add_part(s, like, first, o->drawn.index_count, GI_NONE);
		return;
	}
	for (uint32_t m = 0; m < o->chart.material_count; m++)
		add_part(s, like, first + o->chart.first[m], o->chart.first[m + 1] - o->chart.first[m],
			 object_is_textured(o, m) ? m : GI_NONE);
}

/* One that no other lies in the mesh for. */
static void fill_object(building *b, const object_record *o, const sized *place)
{
	const uint32_t own[2] = {0, 0}, scene[2] = {o->leaf_base, o->light_base};
	const uint32_t *indices = o->textures ? o->chart.indices : o->drawn.indices;
	fill_drawn(o, place->shared ? own : scene, b->vertices + place->first_vertex);
	for (uint32_t i = 0; i < o->drawn.index_count; i++)
		b->indices[place->first_index + i] = (uint32_t)place->first_vertex + indices[i];
	if (o->textures)
		memcpy(b->uvs + place->first_vertex, o->chart.uvs, sizeof *b->uvs * o->chart.vertex_count);
}

static void fill(gi_surfaces *s, building *b)
{
	size_t vertex = 0, index = 0;
	for (uint32_t slot = 0; slot < b->scene->slot_count; slot++)
		s->first_vertex[slot] = GI_NONE;
	for (uint32_t k = 0; k < b->count; k++) {
		const object_record *o = object_at(b, k);
		sized *place = &b->order[k], *home = &b->order[place->home];
		if (place == home) {
			place->first_vertex = vertex;
			place->first_index = index;
			vertex += vertices_of(o);
			index += o->drawn.index_count;
			fill_object(b, o, place);
		}
		place->first_index = home->first_index;
		if (b->by_parts)
			add_parts(s, o, place);
		s->first_vertex[place->slot] = (uint32_t)home->first_vertex;
	}
}

static gi_result upload(gi_context *gi, gi_surfaces *s, const building *b)
{
	static const gpu_attribute attributes[] = {{3, false, 0},
						   {4, false, offsetof(draw_vertex, normal)},
						   {1, true, offsetof(draw_vertex, leaf)},
						   {4, true, offsetof(draw_vertex, light)},
						   {4, false, offsetof(draw_vertex, weight)},
						   {0}};
	gi_result result = gpu_mesh_create(&gi->gpu, &s->mesh, "drawn surfaces", attributes, sizeof *b->vertices,
					   b->vertex_count, b->vertices, b->index_count, b->indices);
	if (!result && b->uvs)
		result = gpu_buffer_allocate(&gi->gpu, &s->uvs, "texture coordinates", sizeof *b->uvs * b->vertex_count,
					     b->uvs);
	if (!result && b->uvs)
		gpu_mesh_add_floats(&gi->gpu, &s->mesh, UV_LOCATION, 2, &s->uvs);
	return result;
}

gi_result surfaces_build(gi_context *gi, gi_surfaces *s)
{
	building b = {.scene = &gi->scene, .order = gi_calloc(gi->scene.slot_count + 1, sizeof *b.order)};
	b.count = b.order ? order_slots(b.scene, b.order) : 0;
	const bool enough = b.order && find_homes(&b) && allocate(s, &b);
	if (enough)
		fill(s, &b);
	const gi_result result =
	    enough ? upload(gi, s, &b) : gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	gi_free(b.order);
	gi_free(b.vertices);
	gi_free(b.uvs);
	gi_free(b.indices);
	if (result)
		surfaces_invalidate(gi, s);
	s->built = result == GI_OK;
	return result;
}

bool surfaces_redraw(gi_context *gi, gi_surfaces *s, uint32_t slot)
{
	const object_record *o = scene_object_in(&gi->scene, slot);
	const uint32_t first = s->first_vertex[slot], count = vertices_of(o);
	if (count > s->staging_room) {
		draw_vertex *grown = gi_realloc(s->staging, sizeof *grown * count);
		if (!grown)
			return false;
		s->staging = grown;
		s->staging_room = count;
	}
	if (first != GI_NONE) {
		const uint32_t scene[2] = {o->leaf_base,
					   o->light_base}; /* what has a shape of its own shares nothing */
		fill_drawn(o, scene, s->staging);
		gpu_buffer_upload(&gi->gpu, &s->mesh.vertices, sizeof(draw_vertex) * first, sizeof(draw_vertex) * count,
				  s->staging);
	}
	return true;
}

void surfaces_invalidate(gi_context *gi, gi_surfaces *s)
{
	gpu_mesh_free(&gi->gpu, &s->mesh);
	gpu_buffer_free(&gi->gpu, &s->uvs);
	gi_free(s->first_vertex);
	gi_free(s->parts);
	s->first_vertex = NULL;
	s->parts = NULL;
	s->part_count = 0;
	s->built = s->textured = false;
}

void surfaces_free(gi_context *gi, gi_surfaces *s)
{
	surfaces_invalidate(gi, s);
	gi_free(s->staging);
	s->staging = NULL;
	s->staging_room = 0;
}
