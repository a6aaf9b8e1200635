/* Which leaf a ray meets first: for tools, on the CPU. */
#include "context.h"
#include "frames.h"

/* A ray in an object's rest frame, and the nearest front that it met so far. */
typedef struct pick {
	gi_vec3d origin, direction; /* of length 1 */
	double distance;
	uint32_t leaf;
} pick;

/* Does the ray come within the ball, nearer than what it met? */
static bool meets_ball(const pick *p, gi_vec4 sphere)
{
	const gi_vec3d to = gi_vec3d_sub(gi_vec3d_from(sphere), p->origin);
	const double along = gi_vec3d_dot(to, p->direction), radius = (double)sphere.w * (1 + GI_TIE);
	const double square = gi_vec3d_dot(to, to) - along * along;
	return along + radius > 0 && along - radius < p->distance && square <= radius * radius;
}

/* Moeller and Trumbore, Fast, minimum storage ray/triangle intersection (1997); fronts alone. */
static bool meets_triangle(pick *p, gi_vec3d a, gi_vec3d b, gi_vec3d c)
{
	const gi_vec3d ab = gi_vec3d_sub(b, a), ac = gi_vec3d_sub(c, a), from = gi_vec3d_sub(p->origin, a);
	const gi_vec3d across = gi_vec3d_cross(p->direction, ac), along = gi_vec3d_cross(from, ab);
	const double volume = gi_vec3d_dot(ab, across);
	if (!(volume > 0))
		return false;
	const double u = gi_vec3d_dot(from, across) / volume, v = gi_vec3d_dot(p->direction, along) / volume;
	const double distance = gi_vec3d_dot(ac, along) / volume;
	if (!(u >= -GI_TIE && v >= -GI_TIE && u + v <= 1 + GI_TIE && distance > 0 && distance < p->distance))
		return false;
	p->distance = distance;
	return true;
}

static void pick_in(pick *p, const object_record *o)
{
	const gi_hierarchy *h = &o->hierarchy;
	for (uint32_t leaf = 0; leaf < h->leaf_count; leaf++) {
		const uint32_t node = h->leaf_node[leaf];
		if (!meets_ball(p, h->geometry[node].sphere))
			continue;
		const gi_uvec4 corners = h->topology[node].corners;
		const gi_vec3d a = gi_vec3d_from(h->vertices[corners.x]), c = gi_vec3d_from(h->vertices[corners.z]);
		const bool first = meets_triangle(p, a, gi_vec3d_from(h->vertices[corners.y]), c);
		if (meets_triangle(p, a, c, gi_vec3d_from(h->vertices[corners.w])) || first)
			p->leaf = o->leaf_base + leaf;
	}
}

static uint32_t pick_leaf(const gi_context *gi, gi_vec3d origin, gi_vec3d direction)
{
	const gi_scene *s = &gi->scene;
	pick nearest = {.distance = INFINITY, .leaf = GI_NO_LEAF};
	for (uint32_t slot = 0; slot < s->slot_count; slot++) {
		const object_record *o = scene_object_in(s, slot);
		if (!o || !scene_slot_is_seen(s, slot))
			continue;
		const gi_object_data *data = &s->object_data[slot];
		nearest.origin = origin;
		nearest.direction = direction;
		if (!meets_ball(&nearest, data->sphere))
			continue;
		nearest.origin = gi_point_to_rest(data, origin);
		nearest.direction = gi_direction_to_rest(data, direction);
		pick_in(&nearest, o);
	}
	return nearest.leaf;
}

gi_result gi_pick_leaf(gi_context *gi, const float origin[3], const float direction[3], uint32_t *leaf)
{
	if (leaf)
		*leaf = GI_NO_LEAF;
	if (!gi || !origin || !direction || !leaf)
		return gi_fail_null(gi, "gi_pick_leaf: origin, direction or leaf");
	const gi_vec3d from = gi_vec3d_load(origin), to = gi_vec3d_load(direction);
	const double length = gi_vec3d_length(to);
	if (!(length > 0) || !isfinite(length) || !isfinite(gi_vec3d_length(from)))
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_ARGUMENT,
			       "gi_pick_leaf: the origin is not finite, or the direction has no length");
	if (!gi->scene.ever_committed)
		return gi_fail(&gi->gpu.log, GI_ERROR_NOT_COMMITTED, "call gi_commit() before gi_pick_leaf()");
	*leaf = pick_leaf(gi, from, gi_vec3d_unit(to));
	return GI_OK;
}
