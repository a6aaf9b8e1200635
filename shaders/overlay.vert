#version 450 core
// Leaves over the picture or instead of it: their edges as lines, or a heat map with one value a leaf.
#define READ_FRAME
#define READ_OBJECTS
#define READ_LEAVES
#define READ_SEGMENTS
#define READ_TOUCHED
#define READ_LEAF_RADIOSITY
#define READ_STATE
#include "buffers.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec4 normal_lift; // of the leaf; w: how far the drawn surface may rise above it
layout(location = 2) in uint leaf;

layout(location = 0) uniform mat4 clip_from_world;
layout(location = 1) uniform uint overlay;  // gi_overlay of gi.h
layout(location = 2) uniform vec4 eye;      // w 0: a direction
layout(location = 3) uniform uint at_rest;  // the last update touched nothing

layout(location = 0) flat out float heat;
layout(location = 1) out vec2 facing_and_light;

const uint OVERLAY_WIREFRAME = 1u, OVERLAY_DIRTY = 2u;

// The residual's scale: from 10^-8 of the largest light reflected to a tenth of it.
const float RESIDUAL_DECADES = 7.0, RESIDUAL_TOP = -1.0;

float dirty_share()
{
	if (at_rest != 0u)
		return 0.0;
	uint entries = 0u;
	for (uint s = frame.swept.z; s < frame.counts.z; s++)
		entries += load_segment(segment_of(leaf, s)).y & GI_BLOCK_COUNT_MASK;
	return clamp(float(load_touched(leaf)) / float(max(entries, 1u)), 0.0, 1.0);
}

float residual_decade()
{
	vec3 scale = state_before.solve.scale.xyz;
	float largest = max(scale.x, max(scale.y, scale.z));
	vec3 change = abs(load_leaf_part(GI_LEAF_R, leaf).xyz - load_leaf_part(GI_LEAF_BEFORE, leaf).xyz);
	float step = max(change.x, max(change.y, change.z));
	if (!(step > 0.0 && largest > 0.0))
		return 0.0;
	return clamp((log2(step / largest) * 0.30103 - RESIDUAL_TOP) / RESIDUAL_DECADES + 1.0, 0.0, 1.0);
}

void main()
{
	uint slot = load_leaf(leaf).y;
	vec3 p = world_from_rest(slot, position), n = world_direction_from_rest(slot, normal_lift.xyz);
	vec3 to_eye = normalize(eye.xyz - p * eye.w);
	float facing = dot(n, to_eye);
	heat = 0.0;
	facing_and_light = vec2(facing, 0.55 + 0.45 * max(facing, 0.0));
	if (overlay == OVERLAY_WIREFRAME)
		p += to_eye * normal_lift.w;
	else
		heat = overlay == OVERLAY_DIRTY ? dirty_share() : residual_decade();
	gl_Position = clip_from_world * vec4(p, 1.0);
}
