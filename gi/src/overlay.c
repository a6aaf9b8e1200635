#include "overlay.h"

#include "binding.h"
#include "context.h"
#include "host_memory.h"
#include "view.h"

#include <stddef.h>
#include <string.h>

/* Lines are drawn this share of a leaf's radius nearer to the eye: a curved surface rises above its leaves. */
static const float LIFT = 0.12f;

/* Flat leaves have nothing to rise; this much wins over their own depths. */
static const float FLAT_LIFT = 0.01f;

typedef struct overlay_vertex {
	float position[3];
	float normal[3];
	float lift;
	uint32_t leaf;
} overlay_vertex;

static void add_leaves(const object_record *o, overlay_vertex *vertices, uint32_t *faces, uint32_t *edges)
{
	const gi_hierarchy *h = &o->hierarchy;
	for (uint32_t leaf = 0; leaf < h->leaf_count; leaf++) {
		const uint32_t node = h->leaf_node[leaf], number = o->leaf_base + leaf, first = 4 * number;
		const gi_node_geometry *g = &h->geometry[node];
		const uint32_t *corners = &h->topology[node].corners.x;
		for (uint32_t k = 0; k < 4; k++) {
			overlay_vertex *v = &vertices[first + k];
			memcpy(v->position, &h->vertices[corners[k]], sizeof v->position);
			memcpy(v->normal, &g->axis, sizeof v->normal);
			/* Leaves drawn flat have four corners and a centre. */
			v->lift = g->sphere.w * (o->drawn.vertex_count > 5 * h->leaf_count ? LIFT : FLAT_LIFT);
			v->leaf = number;
			edges[8 * (size_t)number + 2 * k] = first + k;
			edges[8 * (size_t)number + 2 * k + 1] = first + (k + 1) % 4;
		}
		const uint32_t six[6] = {first, first + 1, first + 2, first, first + 2, first + 3};
		memcpy(faces + 6 * (size_t)number, six, sizeof six);
	}
}

static gi_result build(gi_context *gi, gi_overlays *overlays)
{
	const gi_scene *s = &gi->scene;
	const size_t leaves = s->leaf_count;
	overlay_vertex *vertices = gi_calloc(4 * leaves + 1, sizeof *vertices);
	uint32_t *faces = gi_calloc(6 * leaves + 1, sizeof *faces), *edges = gi_calloc(8 * leaves + 1, sizeof *edges);
	gi_result result = GI_OK;
	if (!vertices || !faces || !edges)
		result = gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	for (uint32_t slot = 0; !result && slot < s->slot_count; slot++)
		if (scene_slot_is_seen(s, slot))
			add_leaves(&s->objects[s->slots[slot]], vertices, faces, edges);
	static const gpu_attribute attributes[] = {{3, false, 0},
						   {4, false, offsetof(overlay_vertex, normal)},
						   {1, true, offsetof(overlay_vertex, leaf)},
						   {0}};
	if (!result)
		result = gpu_mesh_create(&gi->gpu, &overlays->faces, "leaves", attributes, sizeof *vertices, 4 * leaves,
					 vertices, 6 * leaves, faces);
	if (!result)
		result = gpu_mesh_create(&gi->gpu, &overlays->edges, "edges of leaves", attributes, sizeof *vertices,
					 4 * leaves, vertices, 8 * leaves, edges);
	gi_free(vertices);
	gi_free(faces);
	gi_free(edges);
	return result;
}

/* Uniforms. */
enum { CLIP_FROM_WORLD = 0, OVERLAY = 1, EYE = 2, AT_REST = 3, DEPTH = 4, PICKED = 3 };

static gi_result want_program(gi_context *gi, gi_overlays *overlays, gi_overlay overlay, uint32_t *program)
{
	const bool row = overlay >= GI_OVERLAY_SENDERS;
	uint32_t *wanted = row ? &overlays->row_program : &overlays->program;
	const gi_result result =
	    gpu_program_want(&gi->gpu, row ? "overlay_row.vert" : "overlay.vert", "overlay.frag", wanted);
	*program = *wanted;
	return result;
}

static void set_uniforms(gi_context *gi, uint32_t program, const gi_view *view, const float clip_from_world[16])
{
	float eye[4];
	view_eye(view, eye);
	gpu_set_matrices(&gi->gpu, program, CLIP_FROM_WORLD, 1, clip_from_world);
	gpu_set_uint(&gi->gpu, program, OVERLAY, (uint32_t)view->overlay);
	gpu_set_floats(&gi->gpu, program, EYE, 4, 1, eye);
	if (view->overlay >= GI_OVERLAY_SENDERS) {
		gpu_set_uint(&gi->gpu, program, PICKED, view->overlay_leaf);
		return;
	}
	gpu_set_uint(&gi->gpu, program, AT_REST, gi->issued_frame != gi->frame_number);
	gpu_set_uint(&gi->gpu, program, DEPTH, view->overlay_depth);
}

gi_result overlay_draw(gi_context *gi, gi_overlays *overlays, const gi_view *view, const float clip_from_world[16])
{
	uint32_t program = 0;
	gi_result result = overlays->edges.array ? GI_OK : build(gi, overlays);
	if (!result)
		result = want_program(gi, overlays, view->overlay, &program);
	if (result)
		return result;
	const gpu_convention convention = view_convention(view);
	bind_rows(gi);
	set_uniforms(gi, program, view, clip_from_world);
	if (view->overlay != GI_OVERLAY_WIREFRAME) {
		gpu_mesh_draw(&gi->gpu, &overlays->faces, program);
		return GI_OK;
	}
	gpu_draw_multiplied(&gi->gpu, true, convention);
	gpu_mesh_draw_lines(&gi->gpu, &overlays->edges, program);
	gpu_draw_multiplied(&gi->gpu, false, convention);
	return GI_OK;
}

void overlay_invalidate(gi_context *gi, gi_overlays *overlays)
{
	gpu_mesh_free(&gi->gpu, &overlays->faces);
	gpu_mesh_free(&gi->gpu, &overlays->edges);
}

void overlay_free(gi_context *gi, gi_overlays *overlays)
{
	overlay_invalidate(gi, overlays);
	gpu_program_free(&gi->gpu, &overlays->program);
	gpu_program_free(&gi->gpu, &overlays->row_program);
}
