#version 450 core
// Irradiance of each leaf and receiver by all lights without a surface, in the order of their places. One thread a row.
#define READ_FRAME
#define READ_PUNCTUAL_LIGHTS
#define READ_PUNCTUAL_SHARES
#define WRITE_PUNCTUAL_SUMS
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint light_count;
layout(location = 3) uniform uint rows; // leaves, then receivers

void main()
{
	uint leaf = thread_number();
	if (leaf >= rows)
		return;
	const uint ON = GI_PUNCTUAL_THERE | GI_PUNCTUAL_ENABLED;
	bool receives = leaf >= frame.counts.x;
	vec3 sum = vec3(0.0), shown = vec3(0.0);
	for (uint k = 0u; k < light_count; k++) {
		uint kind = punctual_light_kind(k).x;
		bool shown_by_us = (kind & (GI_PUNCTUAL_BY_LEAVES | GI_PUNCTUAL_BY_PIXELS)) != 0u;
		if ((kind & ON) != ON || (receives && !shown_by_us))
			continue;
		vec3 light = punctual_light_color(k).xyz * load_punctual_share(k * rows + leaf);
		sum += light;
		shown += (kind & GI_PUNCTUAL_BY_LEAVES) != 0u ? light : vec3(0.0);
	}
	punctual_sums[GI_PUNCTUAL_PARTS * leaf + GI_PUNCTUAL_ALL] = vec4(sum, 0.0);
	punctual_sums[GI_PUNCTUAL_PARTS * leaf + GI_PUNCTUAL_SHOWN] = vec4(shown, 0.0);
}
