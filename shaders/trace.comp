#version 450 core
// Visibility of the queued entries, one thread an entry: one ray for most; more for near leaves; for emitters four, and the rest
// where those disagree.
// An entry's samples are always taken from the first, so the result does not depend on what was known before.
#define USE_FRAME
#define USE_OBJECTS
#define USE_TOPOLOGY
#define USE_REST
#define USE_VERTICES_REST
#define USE_LEAVES
#define USE_BVH
#define USE_PRIMITIVES
#define USE_TLAS
#define USE_ENTRIES
#define USE_QUEUE
#define USE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"
#include "sampling.glsl"
#include "rays.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

// Below this form factor an entry carries nothing and is not worth a ray.
const float FACTOR_FLOOR = 1e-12;

const uint PROBES = 4u;

// Segments that leave a surface at its back are drawn again, this often.
const uint TRIES = 8u;

segment_end end_on(uint object, uint leaf, vec3 rest_point)
{
	segment_end e;
	e.object = object;
	e.leaf = leaf;
	e.rest = rest_point;
	e.world = world_from_rest(object, rest_point);
	e.size = 0.0;
	return e;
}

// Blocker of sample k of the entry.
uint trace_sample(uint leaf, uint node, gi_node_topology source, bool back, uint k)
{
	uvec4 mine = leaves[leaf];
	uvec4 corners = topology[mine.x].corners;
	bool sky = (source.range.w & GI_NODE_SKY) != 0u;
	segment_end a, b;
	for (uint attempt = 0u; attempt < TRIES; attempt++) {
		vec4 u = sample_numbers(leaf, node, k + 16u * attempt);
		a = end_on(mine.y, leaf, rest_point_on_node(corners, u.xy));
		a.size = rest[mine.x].sphere.w;
		if (sky) {
			b.object = GI_NONE;
			b.leaf = GI_NONE;
			b.rest = vec3(0.0);
			b.world = normalize(rest_point_on_node(source.corners, u.zw));
			b.size = 0.0;
			if (dot(b.world, world_direction_from_rest(mine.y, rest[mine.x].axis.xyz)) > 0.0)
				break;
			continue;
		}
		uint source_leaf;
		vec3 point = rest_point_on_surface(source, u.zw, source_leaf);
		uvec4 other = leaves[source_leaf];
		b = end_on(other.y, source_leaf, point);
		// Facing is tested in the rest frame when both ends are of one object: it must not depend on the pose.
		bool same = other.y == mine.y;
		vec3 n = rest[mine.x].axis.xyz, m = rest[other.x].axis.xyz;
		vec3 d = b.rest - a.rest;
		if (!same) {
			n = world_direction_from_rest(mine.y, n);
			m = world_direction_from_rest(other.y, m);
			d = b.world - a.world;
		}
		if (dot(n, d) > 0.0 && (dot(m, d) < 0.0) != back)
			break;
	}
	return segment_blocker(a, b);
}

void main()
{
	uint t = thread_number();
	if (t >= min(state[GI_STATE_QUEUED], frame.limits.y))
		return;
	uint slot = queue[t];
	uvec4 entry = entries[slot];
	if (uintBitsToFloat(entry.y) <= FACTOR_FLOOR)
		return;
	uint leaf = entry.w & GI_ENTRY_LEAF_MASK;
	gi_node_topology source = topology[entry.x];
	bool emitter = (source.range.w & GI_NODE_EMITTER) != 0u;
	bool back = (entry.w & GI_ENTRY_BACK) != 0u;
	// Rays go where much light may come from: to emitters, and to what is so near that even a leaf is more than the tolerance.
	uint near = uint(clamp(uintBitsToFloat(entry.y) / frame.tolerance.x, 1.0, float(frame.limits.z)));
	bool dark_sky = (source.range.w & GI_NODE_SKY) != 0u && frame.misc.w == 0u;
	uint wanted = emitter ? frame.limits.w : dark_sky ? (near + 3u) / 4u : near;
	// Stopping early sharpens penumbrae a little; only emitters, cut so fine that it does not show, have so many rays to save.
	uint probes = emitter ? min(wanted, PROBES) : wanted;
	uint visible = 0u, blocker = GI_BLOCKER_NONE, taken = 0u;
	while (taken < wanted) {
		uint by = trace_sample(leaf, entry.x, source, back, taken);
		if (by == GI_BLOCKER_NONE)
			visible |= 1u << taken;
		else
			blocker = blocker == GI_BLOCKER_NONE || blocker == by ? by : GI_BLOCKER_MIXED;
		taken++;
		if (taken == probes && (visible == 0u || visible == (1u << probes) - 1u))
			break;
	}
	entries[slot].z = visible | (blocker << 16u);
	entries[slot].w = leaf | (taken << GI_ENTRY_SAMPLE_SHIFT) | (entry.w & GI_ENTRY_BACK);
	atomicAdd(state[GI_STATE_RAYS], taken);
}
