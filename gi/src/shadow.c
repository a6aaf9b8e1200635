#include "shadow.h"

#include "context.h"
#include "frames.h"
#include "host_memory.h"
#include "lamp_view.h"

#include <math.h>
#include <string.h>

/* Sectors of a hemisphere's map overlap by this share of its half width, an eighth of a texel: no texel between two is
 * missed. */
static const float SECTOR_OVERLAP = 5e-4f;

/* Texels of a map that a point's look may be off by, for filters and depths rounded at texels' middles. */
static const double MASK_TEXELS = 3;

gi_result shadow_create(gi_context *gi, gi_shadow *shadow)
{
	const uint32_t slots = gi->scene.slot_count;
	shadow->drawn_rows = gi_calloc(slots + 1, sizeof *shadow->drawn_rows);
	shadow->boxes = gi_calloc(slots + 1, sizeof *shadow->boxes);
	shadow->mask_rows = gi_calloc(GI_LAMP_MAX, OCCLUDER_MASK_BYTES);
	if (!shadow->drawn_rows || !shadow->boxes || !shadow->mask_rows)
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	gi_result result = casters_create(gi, &shadow->casters);
	if (!result && !shadow->program)
		result = gpu_program_draw(&gi->gpu, "shadow.vert", "shadow.frag", &shadow->program);
	if (!result)
		result = gpu_buffer_allocate(&gi->gpu, &shadow->uniforms, "lamps", sizeof shadow->lamps, NULL);
	if (!result)
		result = gpu_buffer_allocate(&gi->gpu, &shadow->mask_words, "occluder masks",
					     GI_LAMP_MAX * OCCLUDER_MASK_BYTES, NULL);
	return result;
}

void shadow_invalidate(gi_context *gi, gi_shadow *shadow)
{
	casters_free(gi, &shadow->casters);
	gi_free(shadow->drawn_rows);
	gi_free(shadow->boxes);
	gi_free(shadow->mask_rows);
	gpu_buffer_free(&gi->gpu, &shadow->uniforms);
	gpu_buffer_free(&gi->gpu, &shadow->mask_words);
	*shadow = (gi_shadow){.program = shadow->program, .maps = shadow->maps};
}

void shadow_free(gi_context *gi, gi_shadow *shadow)
{
	shadow_invalidate(gi, shadow);
	gpu_depth_maps_free(&gi->gpu, &shadow->maps);
	gpu_program_free(&gi->gpu, &shadow->program);
}

/* ---- lamps ---- */

/* A curved lamp does not hide itself: its surface lies about its polygons, and a sample on one would see the next one's
 * edge. */
static uint32_t own_shadow(const lamp_polygon *p, const gi_shadow *shadow)
{
	return p->bulge > 0 && p->slot < shadow->casters.count ? p->slot : GI_NONE;
}

/* Boxes of all that casts; how many. */
static uint32_t gather_boxes(gi_shadow *shadow, uint32_t hole)
{
	uint32_t count = 0;
	for (uint32_t k = 0; k < shadow->casters.count; k++) {
		const gi_caster *c = &shadow->casters.list[k];
		if (c->first_range < c->end_range && k != hole)
			memcpy(shadow->boxes[count++].corner, c->box, sizeof c->box);
	}
	return count;
}

static occluder_box no_box(void)
{
	return (occluder_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

static void grow_box(occluder_box *box, gi_vec3d q, double by)
{
	const double at[3] = {q.x, q.y, q.z};
	for (int axis = 0; axis < 3; axis++) {
		box->lower[axis] = fmin(box->lower[axis], at[axis] - by);
		box->upper[axis] = fmax(box->upper[axis], at[axis] + by);
	}
}

/* What one object hides. */
static void mask_caster(const gi_caster *c, const gi_object_data *d, const lamp_view *view, occluder_mask *mask)
{
	for (uint32_t k = 0; k < c->sphere_count && !c->wall_count; k++) {
		const gi_vec4 s = c->spheres[k];
		occluder_box box = no_box();
		grow_box(&box, lamp_view_point(view, gi_point_to_world(d, gi_vec3d_from(s))), (double)s.w + c->outside);
		occluder_mask_add(mask, &box);
	}
	for (uint32_t k = 0; k < c->wall_count; k++) {
		if (!c->walls[k].hides)
			continue;
		occluder_box box = no_box();
		for (int b = 0; b < 4; b++)
			grow_box(&box,
				 lamp_view_point(view, gi_point_to_world(d, gi_vec3d_load(c->walls[k].corner[b]))), 0);
		occluder_mask_add(mask, &box);
	}
}

static void mask_occluders(const gi_context *gi, const gi_shadow *shadow, uint32_t hole, const lamp_view *view,
			   gi_lamp *lamp, occluder_mask *mask)
{
	occluder_box scene = no_box();
	for (uint32_t k = 0; k < shadow->casters.count; k++)
		for (int b = 0; b < 8 && gi->scene.slots[k] != GI_NONE; b++)
			grow_box(&scene, lamp_view_point(view, shadow->casters.list[k].box[b]), 0);
	mask->texel = MASK_TEXELS * (double)lamp->depth.z;
	mask->bend = (double)lamp->map.y;
	for (int axis = 0; axis < 2; axis++) {
		mask->lamp_lower[axis] = view->sample_lower[axis];
		mask->lamp_upper[axis] = view->sample_upper[axis];
	}
	occluder_mask_clear(mask, &scene);
	for (uint32_t k = 0; k < shadow->casters.count; k++) {
		const gi_caster *c = &shadow->casters.list[k];
		if (k != hole && c->first_range < c->end_range)
			mask_caster(c, &gi->scene.object_data[k], view, mask);
	}
	lamp->grid_lower = (gi_vec4){(float)mask->lower[0], (float)mask->lower[1], (float)mask->lower[2], 0};
	lamp->grid_scale = (gi_vec4){(float)mask->scale[0], (float)mask->scale[1], (float)mask->scale[2], 0};
}

/* ---- drawing ---- */

/* A sample's sector (+x, -x, +y, -y) as matrices from the world, column-major: to clip coordinates of its map, x =
 * 2 u e - e and so on with the u and e of shade_shared.h; and to distances inside the sector's planes. A perspective
 * has no sectors, and all points are inside. */
static void sector_matrices(const gi_lamp *l, gi_vec4 sample, int sector, float clip[16], float planes[16])
{
	const float *x = &l->frame_x.x, *y = &l->frame_y.x, *z = &l->frame_z.x;
	const float along = 2 * l->depth.x - 1, sign = sector & 1 ? -1.0f : 1.0f;
	for (int k = 0; k < 4; k++) {
		const float last = k == 3 ? 1.0f : 0.0f;
		const float d[2] = {x[k] - last * sample.x, y[k] - last * sample.y};
		const float major = sign * d[sector / 2], minor = d[1 - sector / 2], e = z[k] + l->map.y * major;
		clip[4 * k + 0] = 2 * (d[0] * l->map.x + e * l->map.z) - e;
		clip[4 * k + 1] = 2 * (d[1] * l->map.x + e * l->map.w) - e;
		clip[4 * k + 2] = along * e + 2 * last * l->depth.y;
		clip[4 * k + 3] = e;
		const float inside[3] = {major - minor + SECTOR_OVERLAP * e, major + minor + SECTOR_OVERLAP * e,
					 z[k] - last * l->exitance.w};
		for (int row = 0; row < 3; row++)
			planes[4 * k + row] = l->map.y > 0 ? inside[row] : last;
		planes[4 * k + 3] = 0;
	}
}

/* Does the box lie outside of one of the planes as a whole? */
static bool is_outside(const gi_vec3d box[8], const float planes[16])
{
	for (int row = 0; row < 3; row++) {
		const float *m = planes + row;
		int outside = 0;
		for (int b = 0; b < 8; b++)
			outside += m[0] * box[b].x + m[4] * box[b].y + m[8] * box[b].z + m[12] < 0;
		if (outside == 8)
			return true;
	}
	return false;
}

/* Of solids that lie before a map's nearest depth as a whole backs are never seen; of others, the near plane may have
 * cut the front away. Maps look along +z: mirrored. */
static gpu_cull cull_of(const gi_caster *c, const gi_lamp *l)
{
	const double nearest = -(double)l->depth.y / (double)l->depth.x;
	for (int b = 0; b < 8; b++)
		if (gi_vec3d_dot(gi_vec3d_from(l->frame_z), c->box[b]) + l->frame_z.w < nearest)
			return GPU_CULL_NONE;
	return c->solid ? GPU_CULL_MIRRORED_BACKS : GPU_CULL_NONE;
}

/* The casters but `hole` and those outside. */
static void draw_casters(const gi_context *gi, const gi_shadow *shadow, const gi_lamp *lamp, uint32_t hole,
			 const float planes[16])
{
	for (uint32_t k = 0; k < shadow->casters.count; k++) {
		const gi_caster *c = &shadow->casters.list[k];
		if (k == hole || c->first_range == c->end_range || is_outside(c->box, planes))
			continue;
		gpu_draw_cull(&gi->gpu, cull_of(c, lamp));
		gpu_mesh_draw_ranges(&gi->gpu, &shadow->casters.mesh, shadow->program,
				     shadow->casters.ranges + c->first_range, c->end_range - c->first_range);
	}
}

static void draw_maps(const gi_context *gi, const gi_shadow *shadow, const lamp_polygon *polygon, const gi_lamp *lamp)
{
	const uint32_t hole = own_shadow(polygon, shadow);
	const bool hemisphere = lamp->map.y > 0;
	for (uint32_t k = 0; k < lamp->range.y; k++) {
		const uint32_t layer = lamp->range.x + k;
		gpu_depth_maps_begin_layer(&gi->gpu, &shadow->maps, layer, !hemisphere);
		for (int sector = 0; sector < (hemisphere ? 4 : 1); sector++) {
			float matrices[2][16];
			sector_matrices(lamp, lamp->samples[k], sector, matrices[0], matrices[1]);
			gpu_set_matrices(&gi->gpu, shadow->program, 0, 2, matrices[0]);
			draw_casters(gi, shadow, lamp, hole, matrices[1]);
		}
	}
}

bool shadow_reshape(gi_context *gi, gi_shadow *shadow, uint32_t slot)
{
	if (!shadow->drawn_rows)
		return true;
	shadow->reshaped = true;
	return casters_refit(gi, &shadow->casters, slot);
}

static bool poses_changed(const gi_context *gi, gi_shadow *shadow)
{
	bool changed = shadow->reshaped;
	shadow->reshaped = false;
	for (uint32_t slot = 0; slot < shadow->casters.count; slot++) {
		const gi_object_data *d = &gi->scene.object_data[slot];
		changed = changed || memcmp(shadow->drawn_rows[slot], &d->row0, sizeof *shadow->drawn_rows) != 0;
		memcpy(shadow->drawn_rows[slot], &d->row0, sizeof *shadow->drawn_rows);
	}
	shadow->poses += changed;
	return changed;
}

/* Lamps, maps and masks for the objects' poses. */
static void place_lamps(const gi_context *gi, gi_shadow *shadow)
{
	const gi_lamps *lamps = &gi->lamps;
	uint32_t samples[GI_LAMP_MAX], first = 0;
	lamp_share_samples(lamps, samples);
	shadow->lamp_count = lamps->count;
	for (uint32_t k = 0; k < lamps->count; k++) {
		const lamp_polygon *p = &lamps->polygon[k];
		const uint32_t hole = own_shadow(p, shadow), boxes = gather_boxes(shadow, hole);
		gi_lamp *lamp = &shadow->lamps[k];
		lamp_view view = {.map_size = gi->def.shadow_map_size};
		lamp_view_place(&view, p, &gi->scene.object_data[p->slot], samples[k], lamp->samples);
		const uint32_t wide = samples[k] == GI_LAMP_FEW_SAMPLES ? GI_LAMP_WIDE_PROBES : GI_LAMP_PROBES;
		lamp->range = (gi_uvec4){first, samples[k], 2 * k * OCCLUDER_MASK_ROWS, wide};
		const bool casts = lamp_view_fit(&view, p, shadow->boxes, boxes);
		lamp_view_fill(&view, p, casts, lamp);
		shadow->masks[k] = (occluder_mask){.rows = shadow->mask_rows + (size_t)k * OCCLUDER_MASK_ROWS,
						   .lowest = lamp_view_lowest(p, &view)};
		if (casts)
			mask_occluders(gi, shadow, hole, &view, lamp, &shadow->masks[k]);
		first += samples[k];
	}
	shadow->map_count = first;
	memset(shadow->seen, 0, sizeof shadow->seen);
}

static void draw_all_maps(const gi_context *gi, const gi_shadow *shadow)
{
	gpu_draw_clip(&gi->gpu, true);
	for (uint32_t k = 0; k < shadow->lamp_count; k++)
		draw_maps(gi, shadow, &gi->lamps.polygon[k], &shadow->lamps[k]);
	gpu_draw_clip(&gi->gpu, false);
	gpu_draw_cull(&gi->gpu, GPU_CULL_BACKS);
}

static gi_result redraw(gi_context *gi, gi_shadow *shadow)
{
	if (!casters_place(gi, &shadow->casters))
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	place_lamps(gi, shadow);
	gpu_buffer_upload(&gi->gpu, &shadow->uniforms, 0, sizeof *shadow->lamps * shadow->lamp_count, shadow->lamps);
	gpu_buffer_upload(&gi->gpu, &shadow->mask_words, 0, OCCLUDER_MASK_BYTES * (uint64_t)shadow->lamp_count,
			  shadow->mask_rows);
	gi_result result = gpu_depth_maps_create(&gi->gpu, &shadow->maps, gi->def.shadow_map_size, shadow->map_count);
	if (!result && shadow->map_count)
		draw_all_maps(gi, shadow);
	return result;
}

gi_result shadow_update(gi_context *gi, gi_shadow *shadow)
{
	const bool moved = poses_changed(gi, shadow);
	if (shadow->drawn && !moved && shadow->drawn_lamps == gi->lamps.generation)
		return GI_OK;
	gpu_timer_begin(&gi->gpu, &gi->timers[GI_PASS_SHADOW]);
	const gi_result result = redraw(gi, shadow);
	gpu_timer_end(&gi->gpu, &gi->timers[GI_PASS_SHADOW]);
	shadow->drawn = !result;
	shadow->drawn_lamps = gi->lamps.generation;
	return result;
}

/* Of one object: by its spheres. */
static void add_hidden(const gi_caster *c, const gi_object_data *d, const gi_lamp *l, const occluder_mask *mask,
		       const float clip_from_world[16], const uint32_t size[2], screen_rect *rect)
{
	for (uint32_t k = 0; k < c->sphere_count; k++) {
		const gi_vec3d p = gi_point_to_world(d, gi_vec3d_from(c->spheres[k]));
		const double radius = (double)c->spheres[k].w + c->off;
		const gi_vec3d q = {gi_vec3d_dot(gi_vec3d_from(l->frame_x), p) + l->frame_x.w,
				    gi_vec3d_dot(gi_vec3d_from(l->frame_y), p) + l->frame_y.w,
				    gi_vec3d_dot(gi_vec3d_from(l->frame_z), p) + l->frame_z.w};
		occluder_box box = no_box();
		grow_box(&box, q, radius);
		if (box.upper[2] > 0 && occluder_mask_any(mask, &box))
			screen_rect_add(rect, clip_from_world, size, p, radius);
	}
}

static screen_rect find_rect(const gi_context *gi, const gi_shadow *shadow, uint32_t lamp,
			     const float clip_from_world[16], const uint32_t size[2])
{
	screen_rect rect = screen_rect_empty();
	for (uint32_t k = 0; k < shadow->casters.count && shadow->lamps[lamp].range.y; k++)
		if (gi->scene.slots[k] != GI_NONE)
			add_hidden(&shadow->casters.list[k], &gi->scene.object_data[k], &shadow->lamps[lamp],
				   &shadow->masks[lamp], clip_from_world, size, &rect);
	return rect;
}

screen_rect shadow_rect(const gi_context *gi, gi_shadow *shadow, uint32_t lamp, const float clip_from_world[16],
			const uint32_t size[2])
{
	shadow_seen *seen = &shadow->seen[lamp];
	if (!seen->known || memcmp(seen->clip_from_world, clip_from_world, sizeof seen->clip_from_world) != 0 ||
	    memcmp(seen->size, size, sizeof seen->size) != 0) {
		seen->rect = find_rect(gi, shadow, lamp, clip_from_world, size);
		memcpy(seen->clip_from_world, clip_from_world, sizeof seen->clip_from_world);
		memcpy(seen->size, size, sizeof seen->size);
		seen->known = true;
	}
	return seen->rect;
}
