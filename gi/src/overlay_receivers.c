#include "overlay_receivers.h"

#include "binding.h"
#include "context.h"
#include "view.h"

#include <math.h>

/* Radius where the view has none, pixels. */
static const double RADIUS = 6;

/* Where it has one, what is near takes no more of the picture's height than this. */
static const double MOST_SHARE = 0.05;

/* Uniforms. */
enum { CLIP_FROM_WORLD = 0, FIRST = 1, EYE = 2, SIZE = 3, ZERO_TO_ONE = 4 };

static gi_result prepare(gi_context *gi, gi_receiver_marks *marks)
{
	static const gpu_attribute attributes[] = {{2, false, 0}, {0}};
	static const float corners[3][2] = {{0, 2}, {-1.7320509f, -1}, {1.7320509f, -1}};
	static const uint32_t indices[3] = {0, 1, 2};
	gi_result result = GI_OK;
	if (!marks->triangle.array)
		result = gpu_mesh_create(&gi->gpu, &marks->triangle, "a receiver", attributes, sizeof *corners, 3,
					 corners, 3, indices);
	if (!result)
		result = gpu_program_want(&gi->gpu, "receivers.vert", "receivers.frag", &marks->program);
	return result;
}

/* Radius, metres, and what limits it: in metres, where clip w is 1. */
static void set_size(gi_context *gi, uint32_t program, const gi_view *view)
{
	const float *up = view->clip_from_view + 4;
	const double pixels = 0.5 * hypot((double)up[0] * view->width, (double)up[1] * view->height);
	const bool sized = view->overlay_radius > 0;
	const double most = sized ? MOST_SHARE * view->height : RADIUS;
	const float size[2] = {sized ? view->overlay_radius : INFINITY, pixels > 0 ? (float)(most / pixels) : 0};
	gpu_set_floats(&gi->gpu, program, SIZE, 2, 1, size);
}

gi_result overlay_receivers_draw(gi_context *gi, gi_receiver_marks *marks, const gi_view *view,
				 const float clip_from_world[16])
{
	gi_receive *owner = gi->receive;
	if (!owner || !owner->written)
		return GI_OK;
	const gi_result result = prepare(gi, marks);
	if (result)
		return result;
	const uint32_t program = marks->program;
	float eye[4];
	view_eye(view, eye);
	gpu_set_matrices(&gi->gpu, program, CLIP_FROM_WORLD, 1, clip_from_world);
	gpu_set_floats(&gi->gpu, program, EYE, 4, 1, eye);
	gpu_set_uint(&gi->gpu, program, ZERO_TO_ONE, view->clip_zero_to_one);
	set_size(gi, program, view);
	RECEIVER_BUFFERS(BUFFER_BIND)
	gpu_draw_cull(&gi->gpu, GPU_CULL_NONE);
	for (uint32_t k = 0; k < gi->scene.set_count; k++) {
		const receiver_place *place = &gi->scene.sets[k];
		if (!receiver_set_is_alive(&gi->receivers.list[place->set]))
			continue;
		gpu_set_uint(&gi->gpu, program, FIRST, gi->scene.leaf_count + place->first);
		gpu_mesh_draw_instances(&gi->gpu, &marks->triangle, program, place->count);
	}
	gpu_draw_cull(&gi->gpu, GPU_CULL_BACKS);
	bind_rows(gi);
	return GI_OK;
}

void overlay_receivers_free(gi_context *gi, gi_receiver_marks *marks)
{
	gpu_mesh_free(&gi->gpu, &marks->triangle);
	gpu_program_free(&gi->gpu, &marks->program);
}
