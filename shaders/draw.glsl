// Radiance of the drawn surface: (rho * (H_direct + H_indirect) + E) / pi. The vertices bring all but the direct light.
#include "direct.glsl"

layout(location = 0) in vec4 world_sink;
layout(location = 1) in vec3 world_normal;
layout(location = 2) in vec3 own; // (rho * H_indirect + E) / pi
layout(location = 3) flat in vec3 albedo; // rho / pi

layout(location = 0) out vec4 radiance;

void main()
{
	radiance = vec4(own + albedo * direct_irradiance(world_sink.xyz, normalize(world_normal), world_sink.w), 1.0);
}
