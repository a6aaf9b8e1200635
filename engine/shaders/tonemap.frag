#version 450 core
// Linear radiance to 8-bit sRGB: exposure, tone map, transfer function of IEC 61966-2-1.
//
// The tone map is Khronos' "PBR Neutral" without its first step (that one takes off the 4 % specular reflection of
// dielectrics, which a diffuse world does not have). Up to START colours are shown as they are; above, the largest
// channel is compressed towards 1 and the other two keep their ratios to it, which keeps the hue; far above, colours
// fade to white, as film and eyes do.

layout(binding = 0) uniform sampler2D radiance;
layout(location = 0) uniform float exposure; // display value 1 per W/(m2 sr)

layout(location = 0) out vec4 color;

const float START = 0.76;
const float DESATURATION = 0.15;

vec3 tone_map(vec3 c)
{
	float peak = max(c.r, max(c.g, c.b));
	if (peak <= START)
		return c;
	float range = 1.0 - START;
	float new_peak = 1.0 - range * range / (peak + range - START);
	float white = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
	return mix(c * (new_peak / peak), vec3(new_peak), white);
}

vec3 srgb(vec3 c)
{
	vec3 high = 1.055 * pow(max(c, vec3(0.0031308)), vec3(1.0 / 2.4)) - 0.055;
	return mix(high, 12.92 * c, lessThanEqual(c, vec3(0.0031308)));
}

void main()
{
	vec3 c = texelFetch(radiance, ivec2(gl_FragCoord.xy), 0).rgb * exposure;
	// 65504 is the largest half float: an infinity would become inf / inf = NaN in the tone map.
	c = mix(clamp(c, vec3(0.0), vec3(65504.0)), vec3(0.0), isnan(c));
	color = vec4(srgb(tone_map(c)), 1.0);
}
