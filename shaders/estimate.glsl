// The estimate's samples: one thread a group of a chosen leaf. A leaf is chosen by chance; its row's entries are drawn
// in proportion to the light they may bring, and each is replaced by a leaf below its node, drawn by area / d2. What
// these pairs of leaves say of H, point by point and by fresh rays (estimate_trace.comp), is right on average and knows
// no nodes.
#define READ_FRAME
#define READ_TOPOLOGY
#define READ_WORLD
#define READ_LEAVES
#define READ_SEGMENTS
#define READ_ENTRIES
#define READ_ROWS
#define READ_LINKS
#define READ_RADIOSITY
#define READ_ESTIMATE_CHANCES
#define WRITE_ESTIMATE_ITEMS
#define WRITE_ESTIMATE_SHARES
#define WRITE_ESTIMATE_RESULTS
#include "buffers.glsl"
#include "dispatch.glsl"
#include "entry.glsl"
#include "row_light.glsl"
#include "sampling.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint salt;
layout(location = 1) uniform uint first; // of this dispatch
layout(location = 2) uniform uint count;
layout(location = 3) uniform uint all;   // chosen leaves of all dispatches

// Entries that no ray of the row reached are drawn this much less often.
const float HIDDEN = 0.5;

// A unit of a row's weight counts as bringing no less than this part of what it would if nothing were hidden.
const float UNHIDDEN = 0.5;

// Rows whose entries see less than this share of the hemisphere were not closed: no entry more than doubles, and what
// then still lacks a fifth is left as it is (close.comp).
const float CLOSED = 0.4;

float random(uint a, uint b)
{
	return unit_float(hash(a ^ hash(b ^ salt)));
}

// The first leaf whose part of [0,1] ends beyond u.
uint leaf_at(float u)
{
	uint low = 0u, high = frame.counts.x - 1u;
	while (low < high) {
		uint middle = (low + high) >> 1u;
		if (load_chance(middle).x > u)
			high = middle;
		else
			low = middle + 1u;
	}
	return low;
}

float seen_share(uvec4 e)
{
	return float(seen_of(e)) / float(max(samples_of(e), 1u));
}

float light_of(uvec4 e)
{
	vec3 b = (e.w & GI_ENTRY_BACK) != 0u ? vec3(0.0) : load_radiosity(e.x).xyz;
	return b.x + b.y + b.z;
}

// How often an entry is drawn: its light if it were seen, and its part of the sum that closes the row.
float importance(uvec4 e, float mean_light)
{
	return uintBitsToFloat(e.y) * (light_of(e) + mean_light) * (seen_share(e) > 0.0 ? 1.0 : HIDDEN);
}

// What a unit of a row's weight brings. A row that sees hardly more than the black back of a lamp has to find that
// back.
float mean_light_of(uint leaf, vec3 h)
{
	float light = 0.0, weight = 0.0;
	for (uint s = frame.swept.z; s < frame.counts.z; s++) {
		uvec2 segment = load_segment(segment_of(leaf, s)).xy;
		for (uint k = segment.x; k < segment.x + (segment.y & GI_BLOCK_COUNT_MASK); k++) {
			light += uintBitsToFloat(load_entry(k).y) * light_of(load_entry(k));
			weight += uintBitsToFloat(load_entry(k).y);
		}
	}
	float open = weight > 0.0 ? light / weight : 0.0;
	return max(max(h.x + h.y + h.z, UNHIDDEN * open), 1e-20);
}

// What a node may bring to the receiver, about: what is near brings most.
float part_of(gi_node_geometry p, uint node)
{
	gi_node_geometry g = load_world(node);
	vec3 to = g.sphere.xyz - p.sphere.xyz;
	float near = g.sphere.w + p.sphere.w;
	return g.moment.w / max(dot(to, to), near * near);
}

// A leaf below the entry's node, drawn by what the parts of each node may bring.
void write_item(uint at, uint leaf, uvec4 entry, float per_entry)
{
	gi_node_geometry p = load_world(load_leaf(leaf).x);
	uint node = entry.x;
	float share = per_entry;
	for (uint depth = 0u; (topology_range(node).w & (GI_NODE_LEAF | GI_NODE_SKY)) == 0u; depth++) {
		uint end = topology_range(node).x, child = node + 1u;
		float sum = 0.0;
		for (uint next = child; next < end; next = topology_range(next).x)
			sum += part_of(p, next);
		float left = random(at + 0x51ed270bu, depth) * sum, part = 0.0;
		for (uint next = child; next < end && left >= 0.0; next = topology_range(next).x) {
			child = next;
			part = part_of(p, next);
			left -= part;
		}
		share *= sum / part;
		node = child;
	}
	estimate_items[at] = uvec4(node, 0u, 0u, leaf);
	estimate_shares[at] = share;
}

struct row_totals {
	float importance;
	float seen; // sum of F V
};

row_totals total_row(uint leaf, float mean_light)
{
	row_totals t = row_totals(0.0, 0.0);
	for (uint s = frame.swept.z; s < frame.counts.z; s++) {
		uvec2 segment = load_segment(segment_of(leaf, s)).xy;
		for (uint k = segment.x; k < segment.x + (segment.y & GI_BLOCK_COUNT_MASK); k++) {
			t.importance += importance(load_entry(k), mean_light);
			t.seen += uintBitsToFloat(load_entry(k).y) * seen_share(load_entry(k));
		}
	}
	return t;
}

// Systematic sampling: GI_ESTIMATE_GROUP_ITEMS equal steps over the row's importance, from a random start.
void draw_items(uint leaf, uint at, float mean_light, float total)
{
	float pitch = total / float(GI_ESTIMATE_GROUP_ITEMS), from = random(at, 0x2545f491u) * pitch, sum = 0.0;
	uint drawn = 0u;
	for (uint s = frame.swept.z; s < frame.counts.z; s++) {
		uvec2 segment = load_segment(segment_of(leaf, s)).xy;
		for (uint k = segment.x; k < segment.x + (segment.y & GI_BLOCK_COUNT_MASK); k++) {
			float part = importance(load_entry(k), mean_light);
			sum += part;
			for (; drawn < GI_ESTIMATE_GROUP_ITEMS && from + pitch * float(drawn) < sum; drawn++)
				write_item(at + drawn, leaf, load_entry(k), pitch / part);
		}
	}
	// Rounding may lose the last sample; a row that sees nothing has no samples.
	for (; drawn < GI_ESTIMATE_GROUP_ITEMS; drawn++) {
		estimate_items[at + drawn] = uvec4(0u, 0u, 0u, leaf);
		estimate_shares[at + drawn] = 0.0;
	}
}

void main()
{
	uint t = thread_number();
	if (t >= count * GI_ESTIMATE_GROUPS)
		return;
	uint local = t / GI_ESTIMATE_GROUPS, chosen = first + local;
	uint leaf = leaf_at((float(chosen) + random(chosen, 0x7feb352du)) / float(all));
	vec3 h = light_of_row(leaf);
	float mean_light = mean_light_of(leaf, h);
	row_totals totals = total_row(leaf, mean_light);
	draw_items(leaf, t * GI_ESTIMATE_GROUP_ITEMS, mean_light, totals.importance);
	if (t % GI_ESTIMATE_GROUPS == 0u)
		estimate_results[chosen] = gi_estimate_leaf(vec4(h, totals.seen > CLOSED ? 1.0 : 0.0),
						   vec4(0.0, 0.0, 0.0, uintBitsToFloat(leaf)), vec4(0.0));
}
