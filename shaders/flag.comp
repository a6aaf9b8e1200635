#version 450 core
// Which entries between bodies at rest to each other may see differently now that something moved: those that a suspect
// hid, and visible ones whose segments may cross a suspect's new bounds. One thread a leaf; conservative, so that what
// is not flagged would come out of the rays with the same bits.
#define USE_FRAME
#define USE_OBJECTS
#define USE_TOPOLOGY
#define USE_WORLD
#define USE_LEAVES
#define USE_BVH
#define USE_SEGMENTS
#define USE_ENTRIES
#define USE_QUEUE
#define USE_STATE
#define USE_SUSPECTS
#define USE_TOUCHED
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

// Every sample lies within this much more than the radii of its ends; covers rounding of a turn into the box's frame.
const float BOX_SLACK = 1e-4;

bool object_moved(uint object)
{
	return (objects[object].bvh.z & GI_OBJECT_MOVED) != 0u;
}

// Narrows the interval to where slope * t <= limit.
void keep_below(float slope, float limit, inout vec2 interval)
{
	if (slope > 0.0)
		interval.y = min(interval.y, limit / slope);
	else if (slope < 0.0)
		interval.x = max(interval.x, limit / slope);
	else if (limit < 0.0)
		interval.y = -1.0;
}

// Can a segment from within a ball about `origin` to within one about `origin + direction` meet the object's box? At
// share t of its way it is within the radius between the two, so each side of the box bounds t.
bool crosses_bounds(uint object, vec3 origin, vec3 direction, float radius, float end_radius)
{
	vec3 o = rest_from_world(object, origin);
	vec3 d = rest_direction_from_world(object, direction);
	vec3 lower = objects[object].lower.xyz, upper = objects[object].upper.xyz;
	float slack = BOX_SLACK * (length(o) + length(d) + length(upper - lower));
	float grown = radius + slack, growth = end_radius - radius;
	vec2 interval = vec2(0.0, 1.0);
	for (int k = 0; k < 3; k++) {
		keep_below(d[k] - growth, upper[k] - o[k] + grown, interval);
		keep_below(-d[k] - growth, o[k] - lower[k] + grown, interval);
	}
	return interval.x <= interval.y;
}

// Can the cone of directions about `axis` (half the chord of its edge: `spread`) from a ball about x meet the object's
// sphere?
bool crosses_cone(uint object, vec3 x, float radius, vec3 axis, float spread)
{
	vec4 ball = objects[object].sphere;
	vec3 to = ball.xyz - x;
	float d = length(to), r = (ball.w + radius) * (1.0 + BOX_SLACK);
	if (d <= r)
		return true;
	float angle = acos(clamp(dot(to, axis) / d, -1.0, 1.0));
	return angle <= asin(min(1.0, r / d)) + 2.0 * asin(min(1.0, 0.5 * spread)) + BOX_SLACK;
}

bool may_change(gi_node_geometry p, uint node, uint flags, uvec2 list)
{
	vec4 ball = world[node].sphere;
	for (uint k = list.x; k < list.y; k++) {
		uint object = suspects[k];
		bool crosses = (flags & GI_NODE_SKY) != 0u
				       ? crosses_cone(object, p.sphere.xyz, p.sphere.w, ball.xyz, ball.w)
				       : crosses_bounds(object, p.sphere.xyz, ball.xyz - p.sphere.xyz, p.sphere.w, ball.w);
		if (crosses)
			return true;
	}
	return false;
}

void main()
{
	uint leaf = thread_number();
	if (leaf >= frame.counts.x)
		return;
	uint mine = leaves[leaf].y;
	bool moved = object_moved(mine);
	gi_node_geometry p = world[leaves[leaf].x];
	uvec2 list = uvec2(objects[mine].bvh.w, objects[mine].extra.x);
	uint flagged = 0u;
	for (uint source = 0u; source < frame.counts.z; source++) {
		if (moved ? source != mine : object_moved(source))
			continue; // cut anew
		uvec4 block = segments[leaf * frame.counts.z + source];
		uint count = block.y & GI_BLOCK_COUNT_MASK;
		for (uint k = 0u; k < count; k++) {
			uvec4 entry = entries[block.x + k];
			uint taken = (entry.w >> GI_ENTRY_SAMPLE_SHIFT) & GI_ENTRY_SAMPLE_MASK;
			if (taken == 0u)
				continue; // form factor zero
			uint visible = entry.z & 0xFFFFu, blocker = entry.z >> 16u;
			bool blocker_moved = blocker == GI_BLOCKER_MIXED ||
					     (blocker != GI_BLOCKER_NONE && (moved ? blocker != mine : object_moved(blocker)));
			if (!blocker_moved && !(visible != 0u && may_change(p, entry.x, topology[entry.x].range.w, list)))
				continue;
			uint q = atomicAdd(state[GI_STATE_QUEUED], 1u);
			if (q < frame.limits.y)
				queue[q] = block.x + k;
			else
				atomicOr(state[GI_STATE_OVERFLOW], 1u);
			flagged++;
		}
	}
	if (flagged > 0u)
		touched[leaf] += flagged;
}
