#version 450 core
#include "realtime.glsl"
// The variance of the accumulated light, for the filter: of its samples over time, or over the pixels around where
// there are few (Schied et al., 2017, section 4.2); over the number of samples, for that of their mean, so that the
// filter fades as a picture at rest converges. It becomes w.

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 4) uniform sampler2D directs;
layout(binding = 5) uniform sampler2D indirects;
layout(binding = 6) uniform sampler2D squares;

layout(rgba32f, binding = 0) writeonly uniform image2D direct_out;
layout(rgba32f, binding = 1) writeonly uniform image2D indirect_out;

const float FEW = 4.0;

void main()
{
	ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = textureSize(places, 0);
	if (any(greaterThanEqual(pixel, size)))
		return;
	vec4 direct = texelFetch(directs, pixel, 0), indirect = texelFetch(indirects, pixel, 0);
	vec2 mean = vec2(luminance(direct.xyz), luminance(indirect.xyz)), square = texelFetch(squares, pixel, 0).xy;
	float count = max(direct.w, 1.0);
	uint object = object_of(texelFetch(places, pixel, 0));
	if (direct.w < FEW && object != NOTHING) {
		vec2 m = vec2(0.0), s = vec2(0.0);
		float sum = 0.0;
		for (int y = -2; y <= 2; y++)
			for (int x = -2; x <= 2; x++) {
				ivec2 at = clamp(pixel + ivec2(x, y), ivec2(0), size - 1);
				float same = object_of(texelFetch(places, at, 0)) == object ? 1.0 : 0.0;
				vec2 l = vec2(luminance(texelFetch(directs, at, 0).xyz),
					      luminance(texelFetch(indirects, at, 0).xyz));
				m += same * l;
				s += same * l * l;
				sum += same;
			}
		mean = m / sum;
		square = s / sum;
		count = 1.0;
	}
	vec2 variance = max(square - mean * mean, 0.0) / count;
	imageStore(direct_out, pixel, vec4(direct.xyz, variance.x));
	imageStore(indirect_out, pixel, vec4(indirect.xyz, variance.y));
}
