#version 450 core
// Adds a layer, lit, to the picture.
#include "shade_shared.h"
#include "surface.glsl"
#include "layer.glsl"

layout(location = 0) uniform ivec2 corner; // of the viewport, pixels
layout(location = 1) uniform bool lit;     // by lamps

layout(binding = GI_UNIT_DEPTH) uniform sampler2D depths; // of the picture
layout(binding = GI_UNIT_SO_FAR) uniform sampler2D so_far; // irradiance of the layer's surfaces

layout(location = 0) out vec4 result;

void main()
{
	ivec2 pixel = ivec2(gl_FragCoord.xy) - corner;
	vec3 light = uintBitsToFloat(texelFetch(looks, pixel, 0).xyz);
	if (lit)
		light += layer_albedo(texelFetch(places, pixel, 0).w) * texelFetch(so_far, pixel, 0).xyz / PI;
	if (light == vec3(0.0))
		discard;
	gl_FragDepth = texelFetch(depths, pixel, 0).x;
	result = vec4(light, 0.0);
}
