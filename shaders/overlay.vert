#version 450 core
// Leaves over the picture or instead of it: their edges as lines, a heat map with one value a leaf, or the nodes that
// they belong to.
#define READ_FRAME
#define READ_OBJECTS
#define READ_TOPOLOGY
#define READ_LEAVES
#define READ_SEGMENTS
#define READ_TOUCHED
#define READ_LEAF_RADIOSITY
#define READ_STATE
#include "buffers.glsl"
#include "sampling.glsl"
#include "overlay.glsl"

layout(location = 3) uniform uint at_rest; // the last update touched nothing
layout(location = 4) uniform uint depth;   // of the nodes that are shown, levels below their objects' roots

// The residual's scale: from 10^-8 of the largest light reflected to a tenth of it.
const float RESIDUAL_DECADES = 7.0, RESIDUAL_TOP = -1.0;

float dirty_share()
{
	if (at_rest != 0u)
		return 0.0;
	uint entries = 0u;
	for (uint s = frame.swept.z; s < frame.counts.z; s++)
		entries += load_segment(segment_of(leaf, s)).y & GI_BLOCK_COUNT_MASK;
	return float(load_touched(leaf)) / float(max(entries, 1u));
}

float residual_decade()
{
	vec3 scale = state_before.solve.scale.xyz;
	float largest = max(scale.x, max(scale.y, scale.z));
	vec3 change = abs(load_leaf_part(GI_LEAF_R, leaf).xyz - load_leaf_part(GI_LEAF_BEFORE, leaf).xyz);
	float step = max(change.x, max(change.y, change.z));
	if (!(step > 0.0 && largest > 0.0))
		return 0.0;
	return (log2(step / largest) * 0.30103 - RESIDUAL_TOP) / RESIDUAL_DECADES + 1.0;
}

// The leaf's ancestor so many levels below the root, or the leaf itself where there are fewer.
uint ancestor()
{
	uvec4 mine = load_leaf(leaf);
	uint node = object_nodes(mine.y).x;
	for (uint k = 0u; k < depth && node != mine.x; k++) {
		node++;
		while (topology_range(node).x <= mine.x)
			node = topology_range(node).x;
	}
	return node;
}

vec3 node_colour(uint node)
{
	uint h = hash(node);
	float hue = unit_float(h), value = 0.35 + 0.65 * unit_float(hash(h));
	return value * (0.5 + 0.5 * cos(6.2831853 * (hue + vec3(0.0, 1.0, 2.0) / 3.0)));
}

vec3 leaf_colour()
{
	if (overlay == OVERLAY_HIERARCHY)
		return node_colour(ancestor());
	return heat_colour(overlay == OVERLAY_DIRTY ? dirty_share() : residual_decade());
}
