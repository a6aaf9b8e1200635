#version 450 core
// Visibility of the queued entries, one thread an entry: one ray for most; more for near leaves; for emitters four, and
// the rest where those disagree.
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

// 0 for rows. The estimate's rays are others: another salt for every item, since a pair may be in several.
layout(location = 0) uniform uint salt;

// Below this form factor an entry carries nothing and is not worth a ray.
const float FACTOR_FLOOR = 1e-12;

const uint PROBES = 4u;

// Segments that leave a surface at its back are drawn again, this often.
const uint TRIES = 8u;

// A quad in its object's rest frame, loaded once for all samples of an entry.
struct quad {
	vec3 a, b, c, d;
};

quad load_quad(uvec4 corners)
{
	return quad(vertices_rest[corners.x].xyz, vertices_rest[corners.y].xyz, vertices_rest[corners.z].xyz,
		    vertices_rest[corners.w].xyz);
}

struct pair {
	uint leaf, node;
	bool back;          // the source is seen from behind
	bool same;          // both ends on one object: all is computed in its rest frame, whatever its pose
	body receiver, source;
	quad mine, theirs;  // theirs: of the source node where `whole`
	float size;         // radius of the receiver
	gi_node_topology t; // of the source
	bool sky, whole;    // whole: one quad is the source's surface
};

pair load_pair(uvec4 entry)
{
	pair p;
	p.leaf = entry.w & GI_ENTRY_LEAF_MASK;
	p.node = entry.x;
	p.back = (entry.w & GI_ENTRY_BACK) != 0u;
	p.t = topology[entry.x];
	p.sky = (p.t.range.w & GI_NODE_SKY) != 0u;
	p.whole = p.sky || (p.t.range.w & GI_NODE_FLAT) != 0u || p.t.range.z == 1u;
	uvec4 mine = leaves[p.leaf];
	p.receiver = load_body(mine.y);
	p.mine = load_quad(topology[mine.x].corners);
	p.size = rest[mine.x].sphere.w;
	p.source.object = GI_NONE;
	p.source.flat_surface = true;
	if (!p.sky)
		p.source = load_body(leaves[p.t.range.y].y);
	p.same = p.source.object == p.receiver.object;
	if (p.whole)
		p.theirs = load_quad(p.t.corners);
	return p;
}

vec3 point_on(quad q, vec2 u)
{
	return point_on_quad(q.a, q.b, q.c, q.d, u);
}

segment_end end_on(body on, uint leaf, vec3 rest_point)
{
	return segment_end(leaf, rest_point, to_world(on, rest_point));
}

// The source's end for two numbers; m is the normal there, at rest.
segment_end source_end(pair p, vec2 u, out vec3 m)
{
	uint leaf = p.t.range.y;
	quad q = p.theirs;
	m = vec3(0.0);
	if (p.sky) {
		vec3 direction = normalize(point_on(q, u));
		return segment_end(GI_NONE, direction, direction);
	}
	if (!p.whole) {
		// One of the node's leaves, then a point on it with the digits that are left.
		float pick = u.x * float(p.t.range.z);
		uint k = min(uint(pick), p.t.range.z - 1u);
		leaf += k;
		u.x = clamp(pick - float(k), 0.0, 0.99999994);
		q = load_quad(topology[leaves[leaf].x].corners);
	}
	m = cross(q.c - q.a, q.d - q.b);
	return end_on(p.source, leaf, point_on(q, u));
}

// Does the segment leave the front of the receiver and arrive on the side of the source that the entry is about?
bool faces(pair p, segment_end a, segment_end b, vec2 u, vec3 m)
{
	// Of the triangle of the receiver that the point is on (point_on_quad).
	vec3 normal = u.x >= u.y || p.mine.c == p.mine.d ? cross(p.mine.b - p.mine.a, p.mine.c - p.mine.a) : cross(p.mine.c - p.mine.a, p.mine.d - p.mine.a);
	if (!p.same)
		normal = direction_to_world(p.receiver, normal);
	if (p.sky)
		return dot(normal, b.world) > 0.0;
	vec3 d = p.same ? b.rest - a.rest : b.world - a.world;
	vec3 n = p.same ? m : direction_to_world(p.source, m);
	return dot(normal, d) > 0.0 && (dot(n, d) < 0.0) != p.back;
}

uint trace_sample(pair p, uint k, uint own_salt)
{
	segment_end a, b;
	for (uint attempt = 0u; attempt < TRIES; attempt++) {
		vec4 u = sample_numbers(p.leaf, p.node, k + 16u * attempt, own_salt);
		vec3 m;
		a = end_on(p.receiver, p.leaf, point_on(p.mine, u.xy));
		b = source_end(p, u.zw, m);
		if (faces(p, a, b, u.xy, m))
			break;
	}
	return segment_blocker(p.receiver, a, p.source, b, p.size);
}

void main()
{
	uint t = thread_number();
	if (t >= min(state[GI_STATE_QUEUED], frame.limits.y))
		return;
	uint slot = queue[t];
	uvec4 entry = entries[slot];
	float factor = uintBitsToFloat(entry.y);
	if (factor <= FACTOR_FLOOR)
		return;
	pair p = load_pair(entry);
	bool emitter = (p.t.range.w & GI_NODE_EMITTER) != 0u;
	// Rays go where much light may come from: to emitters, and to what is so near that even a leaf is more than the
	// tolerance.
	uint near = uint(clamp(factor / frame.tolerance.x, 1.0, float(frame.limits.z)));
	bool dark_sky = p.sky && frame.misc.w == 0u;
	uint wanted = emitter ? frame.limits.w : dark_sky ? (near + 3u) / 4u : near;
	// Stopping early sharpens penumbrae a little; only emitters, cut so fine that it does not show, have so many
	// rays to save.
	uint probes = emitter ? min(wanted, PROBES) : wanted;
	uint visible = 0u, blocker = GI_BLOCKER_NONE, taken = 0u;
	uint own_salt = salt == 0u ? 0u : hash(salt + t);
	while (taken < wanted) {
		uint by = trace_sample(p, taken, own_salt);
		if (by == GI_BLOCKER_NONE)
			visible |= 1u << taken;
		else
			blocker = blocker == GI_BLOCKER_NONE || blocker == by ? by : GI_BLOCKER_MIXED;
		taken++;
		if (taken == probes && (visible == 0u || visible == (1u << probes) - 1u))
			break;
	}
	entries[slot].z = visible | (blocker << 16u);
	entries[slot].w = p.leaf | (taken << GI_ENTRY_SAMPLE_SHIFT) | (entry.w & GI_ENTRY_BACK);
	atomicAdd(state[GI_STATE_RAYS], taken);
}
