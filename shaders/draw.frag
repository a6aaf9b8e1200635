#version 450 core
// Radiance of the drawn surface: (rho * (H_direct + H_indirect) + E) / pi.
#include "direct.glsl"
#include "shade_modes.glsl"

layout(location = 0) in vec4 world_sink;
layout(location = 1) in vec3 world_normal;
layout(location = 2) in vec3 indirect;
layout(location = 3) flat in vec3 rho;
layout(location = 4) flat in vec3 exitance;

layout(location = 1) uniform uint mode;

layout(location = 0) out vec4 radiance;

const float INVERSE_PI = 0.318309886183791;

void main()
{
	vec3 irradiance = indirect;
	if (mode != MODE_INDIRECT)
		irradiance += direct_irradiance(world_sink.xyz, normalize(world_normal), world_sink.w);
	radiance = vec4((rho * irradiance + exitance) * INVERSE_PI, 1.0);
}
