#version 450 core
// Visibility of the queued entries, one thread an entry: one ray for most; more for near leaves; for emitters four, and
// the rest where those disagree.
// An entry's samples are always taken from the first, so the result does not depend on what was known before.
#define USE_FRAME
#define USE_OBJECTS
#define USE_TOPOLOGY
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
#include "visibility.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

const uint PROBES = 4u;

uint trace_sample(pair p, uint k)
{
	segment_end a, b;
	bool facing = false;
	for (uint attempt = 0u; attempt < TRIES && !facing; attempt++) {
		vec4 u = sample_numbers(p.leaf, p.node, k + 16u * attempt);
		vec3 m;
		a = end_on(p.receiver, p.leaf, point_on(p.mine, u.xy));
		b = source_end(p, u.zw, m);
		facing = faces(p, a, b, u.xy, m);
	}
	// Hardly any of the source is before the receiver: what is not must not shine through its back.
	if (!facing)
		return p.receiver.object;
	return segment_blocker(p.receiver, a, p.source, b);
}

void main()
{
	uint t = thread_number();
	if (t >= min(state[GI_STATE_QUEUED], frame.limits.y))
		return;
	uint slot = queue[t];
	uvec4 entry = entries[slot];
	float factor = uintBitsToFloat(entry.y);
	if (factor <= 0.0)
		return; // however small, a bright lamp may be behind it
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
	while (taken < wanted) {
		uint by = trace_sample(p, taken);
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
