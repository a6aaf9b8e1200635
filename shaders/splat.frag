#version 450 core
// Adds a photon's light to what is seen within its disc, on surfaces that face as the one it fell on.
#include "shade_shared.h"
#include "surface.glsl"

layout(location = 0) flat in vec4 disc;
layout(location = 1) flat in vec3 normal;
layout(location = 2) flat in vec3 irradiance;

layout(location = 0) out vec4 result;

// Cosine between the normals, and height over the disc over its radius.
const float ALIKE = 0.7, FLAT = 0.3;

void main()
{
	surface s = surface_at(ivec2(gl_FragCoord.xy));
	vec3 from = s.p - disc.xyz;
	float share = dot(from, from) / (disc.w * disc.w), height = abs(dot(from, normal));
	if (share >= 1.0 || height > FLAT * disc.w || dot(s.n, normal) < ALIKE)
		discard;
	result = vec4(irradiance * (1.0 - share), 0.0);
}
