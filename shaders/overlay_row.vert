#version 450 core
// What the row of one leaf, the picked one, has of each other: the light that comes from there, how much of it is seen,
// what hides others.
#define READ_FRAME
#define READ_OBJECTS
#define READ_TOPOLOGY
#define READ_LEAVES
#define READ_SEGMENTS
#define READ_ENTRIES
#define READ_TARGETS
#define READ_RADIOSITY
#include "buffers.glsl"
#include "entry.glsl"
#include "overlay.glsl"

layout(location = 3) uniform uint picked;

const vec3 PICKED_COLOUR = vec3(0.05, 0.8, 0.9), NOTHING = vec3(0.01, 0.015, 0.04);

// Scale of shares: from 10^-4 to 1.
const float DECADES = 4.0;

float decade(float share)
{
	return share > 0.0 ? 1.0 + log2(share) * 0.30103 / DECADES : 0.0;
}

float form_factor_of(uvec4 entry)
{
	return uintBitsToFloat(entry.y & ~GI_ENTRY_FLAGGED);
}

float visibility_of(uvec4 entry)
{
	return float(seen_of(entry)) / float(max(samples_of(entry), 1u));
}

// Mean over the channels of the irradiance that an entry brings.
float light_of(uint entry)
{
	uint target = load_target(entry);
	if (seen_of(load_entry(entry)) == 0u || (target & GI_TARGET_BLACK) != 0u)
		return 0.0;
	vec3 b = load_radiosity(GI_NODE_B * frame.counts.y + target).xyz;
	return form_factor_of(load_entry(entry)) * visibility_of(load_entry(entry)) * (b.x + b.y + b.z) / 3.0;
}

// x, y: the picked leaf's entries of a source begin and end.
uvec2 entries_of(uint source)
{
	uvec2 block = load_segment(segment_of(picked, source)).xy;
	return uvec2(block.x, block.x + (block.y & GI_BLOCK_COUNT_MASK));
}

// Static objects are one source.
uint source_of(uint slot)
{
	return slot >= frame.swept.z ? slot : frame.swept.w;
}

// The entry that stands for the leaf; GI_NONE: there is none.
uint find_entry(uvec4 mine)
{
	uvec2 entries = entries_of(source_of(mine.y));
	for (uint k = entries.x; k < entries.y; k++) {
		uint node = load_entry(k).x;
		bool gone = (load_entry(k).w & GI_ENTRY_GONE) != 0u;
		if (!gone && node <= mine.x && mine.x < topology_range(node).x)
			return k;
	}
	return GI_NONE;
}

// x: irradiance of the whole row, y: its form factors, z: those of what the blocker hides; a black sky does not count.
vec3 whole_row(uint blocker)
{
	vec3 sums = vec3(0.0);
	for (uint s = frame.swept.z; s < frame.counts.z; s++) {
		uvec2 entries = s == frame.inner.z ? uvec2(0u) : entries_of(s);
		for (uint k = entries.x; k < entries.y; k++) {
			uvec4 entry = load_entry(k);
			float f = form_factor_of(entry);
			float hidden = entry.z >> 16u == blocker ? 1.0 - visibility_of(entry) : 0.0;
			sums += vec3(light_of(k), f, f * hidden);
		}
	}
	return sums;
}

vec3 leaf_colour()
{
	if (leaf == picked)
		return PICKED_COLOUR;
	if (picked >= frame.counts.x)
		return NOTHING;
	uvec4 mine = load_leaf(leaf);
	uint entry = find_entry(mine);
	if (overlay == OVERLAY_VISIBILITY)
		return entry == GI_NONE ? NOTHING : heat_colour(visibility_of(load_entry(entry)));
	vec3 row = whole_row(mine.y >= frame.swept.z ? mine.y : GI_BLOCKER_STATICS);
	float share = overlay == OVERLAY_SENDERS ? (entry == GI_NONE ? 0.0 : light_of(entry)) / max(row.x, 1e-30)
						 : row.z / max(row.y, 1e-30);
	return share > 0.0 ? heat_colour(decade(share)) : NOTHING;
}
