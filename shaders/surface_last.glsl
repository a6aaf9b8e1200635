// What is seen, where no lamp lights it per pixel.
#include "buffers.glsl"
#include "shade_shared.h"
#include "surface.glsl"
#include "numbers.glsl"

layout(location = 0) uniform ivec2 corner; // of the viewport, pixels
layout(location = 1) uniform bool alone;  // there are no caustics
layout(location = 2) uniform float farthest; // depth where nothing is seen
layout(binding = GI_UNIT_DEPTH) uniform sampler2D depths;
layout(binding = GI_UNIT_SO_FAR) uniform sampler2D so_far; // irradiance by them

layout(location = 0) out vec4 result;

void main()
{
	ivec2 pixel = ivec2(gl_FragCoord.xy) - corner;
	float depth = texelFetch(depths, pixel, 0).x;
	if (depth == farthest)
		discard;
	gl_FragDepth = depth;
	surface s = surface_at(pixel);
	result = vec4(s.own, 1.0);
	if (!alone)
		result.xyz += reflectance_of(s, pixel) * INVERSE_PI * texelFetch(so_far, pixel, 0).xyz;
}
