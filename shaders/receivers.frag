#version 450 core
// A receiver as a white surface that gives back what falls on it: radiance, W/m2/sr. A ball is lit by its normal.
#define GI_PROBE_LIGHT_STORAGE GI_BIND_RECEIVED
#define GI_PROBE_PLANE_STORAGE GI_BIND_PROBE_PLANES
#include "gi_shared.h"
#include "gi_probe.glsl"
#include "numbers.glsl"

layout(location = 0) in vec2 at;
layout(location = 1) flat in vec4 centre;
layout(location = 2) flat in vec3 right;
layout(location = 3) flat in vec3 up;
layout(location = 4) flat in vec3 front;
layout(location = 5) flat in uvec2 light;

layout(location = 0) uniform mat4 clip_from_world;
layout(location = 4) uniform bool zero_to_one; // depths in clip space

layout(location = 0) out vec4 result;

// Dark round the edge, or it is not seen before what has the same light.
const float RIM = 0.85, RIM_SHADE = 0.3;

void main()
{
	float square = dot(at, at);
	if (square > 1.0)
		discard;
	bool ball = light.y > 1u;
	vec3 normal = at.x * right + at.y * up + (ball ? sqrt(1.0 - square) : 0.0) * front;
	vec4 clip = clip_from_world * vec4(centre.xyz + centre.w * normal, 1.0);
	float depth = clip.z / clip.w;
	gl_FragDepth = clamp(zero_to_one ? depth : 0.5 * depth + 0.5, 0.0, 1.0);
	vec3 e = ball ? gi_sh_irradiance(light.x, light.y, normal) : gi_probe_light(light.x).xyz;
	result = vec4(e * INVERSE_PI * (square > RIM * RIM ? RIM_SHADE : 1.0), 1.0);
}
