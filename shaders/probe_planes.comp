#version 450 core
// What each probe sees near it, as planes of the surfaces that rays in directions over an octahedron meet
// (gi_probe.glsl looks them up): a plane's unit normal, towards the probe, and its height along that over the probe,
// below 0; normal 0 and height -1: nothing is near. One thread a direction of a probe.
//
// What is farther than the diagonal of a cell hides nothing from the cell's places; so only probes are asked again that
// something that moved is or was so near to.
#define READ_FRAME
#define READ_OBJECTS
#define READ_LEAVES
#define READ_WORLD
#define READ_BVH
#define READ_PRIMITIVES
#define READ_TLAS
#define READ_OBJECT_LISTS
#define WRITE_PROBE_PLANES
#include "buffers.glsl"
#include "dispatch.glsl"
#include "octahedron.glsl"
#include "rays.glsl"
#include "closest.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint first_row;   // of the first probe
layout(location = 1) uniform uint first_plane;
layout(location = 2) uniform uint count;       // of threads
layout(location = 3) uniform uint all;         // 1: whatever moved
layout(location = 4) uniform float reach;      // diagonal of a cell
layout(location = 5) uniform float lift;

const uint SIDE = 16u; // GI_PROBE_SIDE of gi_probe.glsl

// More than the rounding of boxes.
const float REACH_SLACK = 1e-4;

bool is_near_to_change(vec3 place)
{
	bool found = false;
	for (uint k = 0u; k < frame.swept.y && !found; k++) {
		vec3 lower = load_swept_corner(k, 2u).xyz, upper = load_swept_corner(k, 3u).xyz;
		vec3 off = max(max(lower - place, place - upper), vec3(0.0));
		float slack = REACH_SLACK * (reach + length(place) + length(upper - lower));
		found = load_swept_change(k).x == frame.update.x && length(off) <= reach + slack;
	}
	return found;
}

vec4 plane_of(nearest hit, vec3 direction)
{
	gi_primitive q = load_primitive(hit.primitive);
	vec3 n = hit.second ? cross(q.c.xyz - q.a.xyz, q.d.xyz - q.a.xyz) : cross(q.b.xyz - q.a.xyz, q.c.xyz - q.a.xyz);
	n = normalize(world_direction_from_rest(hit.object, n));
	n = dot(n, direction) > 0.0 ? -n : n;
	return vec4(n, hit.distance * dot(n, direction));
}

void main()
{
	uint t = thread_number();
	if (t >= count)
		return;
	uint probe = t / (SIDE * SIDE), texel = t % (SIDE * SIDE);
	vec3 place = world_sphere(load_leaf(first_row + probe).x).xyz;
	if (all == 0u && !is_near_to_change(place))
		return;
	vec2 at = (vec2(texel % SIDE, texel / SIDE) + 0.5) * (2.0 / float(SIDE)) - 1.0;
	vec3 direction = direction_from_octahedron(at);
	nearest hit = find_nearest(place, direction, lift);
	bool near = hit.object != GI_NONE && hit.distance <= reach;
	probe_planes[first_plane + t] = near ? plane_of(hit, direction) : vec4(0.0, 0.0, 0.0, -1.0);
}
