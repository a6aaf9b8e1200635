#version 450 core
// How much of each light without a surface arrives at each leaf and receiver: what would with nothing in between,
// integrated over the leaf, times the share of it that rays find to arrive. One thread a light and row. Those that
// nothing changed since they were last looked at stay; of a light that is switched off it is but noted that something
// did.
//
// A pure function of the poses of the leaf's object and of all others, and of the light: an update's are a rebuild's.
#define READ_FRAME
#define READ_OBJECTS
#define READ_WORLD
#define READ_LEAVES
#define READ_LEAF_QUADS
#define READ_BVH
#define READ_PRIMITIVES
#define READ_TLAS
#define READ_OBJECT_LISTS
#define READ_PUNCTUAL_LIGHTS
#define WRITE_PUNCTUAL_SHARES
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"
#include "sampling.glsl"
#include "rays.glsl"
#include "segments.glsl"
#include "leaf_quad.glsl"
#include "punctual.glsl"
#include "punctual_leaf.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint light_count;
layout(location = 1) uniform uint seen; // update of the rows up to which shares know what moved
layout(location = 2) uniform uint all;  // 1: none is known
layout(location = 3) uniform uint rows; // leaves, then receivers

// Positions are rounded by less than this share of the coordinates.
const float MARGIN = 1e-5;

// Does a box meet the way between a leaf and a light: the hull of their balls, or of the leaf's ball and what goes on
// from it for ever? By a segment as thick as the thicker end.
bool box_is_between(vec4 ball, gi_punctual_light l, vec3 lower, vec3 upper)
{
	bool directional = is_directional(l);
	vec3 middle = 0.5 * (lower + upper);
	float far = distance(ball.xyz, middle) + 0.5 * distance(lower, upper) + ball.w;
	float thick = directional ? ball.w + far * l.place.w : max(ball.w, l.place.w);
	vec3 reach = max(abs(ball.xyz), max(abs(lower), abs(upper)));
	thick += MARGIN * (max(reach.x, max(reach.y, reach.z)) + ball.w);
	// The unit vector towards a sun, as long as the box is far.
	vec3 way = directional ? l.place.xyz * (2.0 * far) : l.place.xyz - ball.xyz, inverse = safe_inverse(way);
	vec3 a = (lower - thick - ball.xyz) * inverse, b = (upper + thick - ball.xyz) * inverse;
	vec3 near = min(a, b), away = max(a, b);
	return max(max(near.x, near.y), max(near.z, 0.0)) <= min(min(away.x, away.y), min(away.z, 1.0));
}

// Did anything that moved come between them, or go?
bool is_crossed(uint leaf, gi_punctual_light l)
{
	vec4 ball = world_sphere(load_leaf(leaf).x);
	bool crossed = false;
	for (uint k = 0u; k < frame.swept.y && !crossed; k++)
		crossed = load_swept_change(k).x > seen &&
			  box_is_between(ball, l, load_swept_corner(k, 2u).xyz, load_swept_corner(k, 3u).xyz);
	return crossed;
}

void main()
{
	uint t = thread_number(), leaf = t % rows, k = t / rows;
	if (k >= light_count)
		return;
	gi_punctual_light l = load_punctual_light(k);
	if ((l.kind.x & GI_PUNCTUAL_THERE) == 0u)
		return;
	uint object = load_leaf(leaf).y;
	bool anew = all != 0u || (l.kind.x & GI_PUNCTUAL_MOVED) != 0u || object_changed(object).x > seen ||
		    punctual_shares[t] == GI_PUNCTUAL_UNKNOWN || is_crossed(leaf, l);
	if (!anew)
		return;
	uint rays = 0u;
	bool on = (l.kind.x & GI_PUNCTUAL_ENABLED) != 0u;
	punctual_shares[t] = on ? share_of_leaf(leaf, l, rays) : GI_PUNCTUAL_UNKNOWN;
	if (rays > 0u) {
		atomicAdd(state.counts.rays, rays);
		atomicAdd(state.counts.light_rays, rays);
	}
}
