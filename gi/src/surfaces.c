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

static void fill_drawn(const object_record *o, draw_vertex *vertices)
{
	const uint32_t count = o->drawn.vertex_count;
	for (uint32_t k = 0; k < count; k++) {
		const gi_draw_vertex *from = &o->drawn.vertices[k];
		draw_vertex *to = &vertices[k];
		memcpy(to->position, from->position, sizeof to->position);
		memcpy(to->normal, from->normal, sizeof to->normal);
		memcpy(to->weight, from->weight, sizeof to->weight);
		to->sink = sink_of(&o->hierarchy, from);
		to->leaf = o->leaf_base + from->leaf;
		for (int i = 0; i < 4; i++)
			to->light[i] = o->light_base + from->light[i];
	}
	for (uint32_t k = count; k < vertices_of(o); k++)
		vertices[k] = vertices[o->chart.source[k - count]];
}

/* ---- the mesh while it is built ---- */

typedef struct sized {
	double size;
	uint32_t slot;
} sized;

typedef struct building {
	const gi_scene *scene;
	sized *order;
	uint32_t count;
	size_t vertex_count, index_count, part_count;
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
			order[count++] = (sized){s->object_data[slot].sphere.w, slot};
	qsort(order, count, sizeof *order, by_size);
	return count;
}

static const object_record *object_at(const building *b, uint32_t place)
{
	return &b->scene->objects[b->scene->slots[b->order[place].slot]];
}

/* Room for all there is. */
static bool allocate(gi_surfaces *s, building *b)
{
	bool textured = false;
	for (uint32_t k = 0; k < b->count; k++) {
		const object_record *o = object_at(b, k);
		b->vertex_count += vertices_of(o);
		b->index_count += o->drawn.index_count;
		b->part_count += o->textures ? o->chart.material_count : 1;
		textured = textured || o->textures;
	}
	b->vertices = gi_malloc(sizeof *b->vertices * (b->vertex_count + 1));
	b->indices = gi_malloc(sizeof *b->indices * (b->index_count + 1));
	b->uvs = textured ? gi_calloc(b->vertex_count + 1, sizeof *b->uvs) : NULL;
	s->parts = textured ? gi_malloc(sizeof *s->parts * (b->part_count + 1)) : NULL;
	s->first_vertex = gi_malloc(sizeof *s->first_vertex * (b->scene->slot_count + 1));
	return b->vertices && b->indices && s->first_vertex && (!textured || (b->uvs && s->parts));
}

static void add_part(gi_surfaces *s, uint32_t first, uint32_t count, uint32_t slot, uint32_t material)
{
	surfaces_part *last = s->part_count ? &s->parts[s->part_count - 1] : NULL;
	if (!count)
		return;
	if (last && last->material == GI_NONE && material == GI_NONE)
		last->range.count += count;
	else
		s->parts[s->part_count++] = (surfaces_part){{first, count}, slot, material};
}

static void add_parts(gi_surfaces *s, const object_record *o, uint32_t slot, uint32_t first)
{
	if (!o->textures) {
		add_part(s, first, o->drawn.index_count, slot, GI_NONE);
		return;
	}
	for (uint32_t m = 0; m < o->chart.material_count; m++)
		add_part(s, first + o->chart.first[m], o->chart.first[m + 1] - o->chart.first[m], slot,
			 object_is_textured(o, m) ? m : GI_NONE);
}

static void fill(gi_surfaces *s, building *b)
{
	size_t vertex = 0, index = 0;
	for (uint32_t slot = 0; slot < b->scene->slot_count; slot++)
		s->first_vertex[slot] = GI_NONE;
	for (uint32_t k = 0; k < b->count; k++) {
		const object_record *o = object_at(b, k);
		const uint32_t *indices = o->textures ? o->chart.indices : o->drawn.indices;
		fill_drawn(o, b->vertices + vertex);
		for (uint32_t i = 0; i < o->drawn.index_count; i++)
			b->indices[index + i] = (uint32_t)vertex + indices[i];
		if (o->textures)
			memcpy(b->uvs + vertex, o->chart.uvs, sizeof *b->uvs * o->chart.vertex_count);
		if (b->uvs)
			add_parts(s, o, b->order[k].slot, (uint32_t)index);
		s->first_vertex[b->order[k].slot] = (uint32_t)vertex;
		vertex += vertices_of(o);
		index += o->drawn.index_count;
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
	const bool enough = b.order && allocate(s, &b);
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
		fill_drawn(o, s->staging);
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
	s->built = false;
}

void surfaces_free(gi_context *gi, gi_surfaces *s)
{
	surfaces_invalidate(gi, s);
	gi_free(s->staging);
	s->staging = NULL;
	s->staging_room = 0;
}
