// One lamp's light on what is seen. All lamps but the last add their irradiance up; the last one's pass makes radiance
// of it, (rho * (H_direct + H_indirect) + E) / pi, and puts it where the host draws.
#if defined(LAST) && !defined(ALBEDO)
#define READ_MATERIALS
#endif
#include "buffers.glsl"
#include "direct.glsl"
#include "surface.glsl"
#include "numbers.glsl"

layout(location = 0) uniform ivec2 corner; // of the viewport, pixels

#ifdef LAST
layout(binding = GI_UNIT_DEPTH) uniform sampler2D depths;
layout(binding = GI_UNIT_SO_FAR) uniform sampler2D so_far; // irradiance from the other lamps
layout(location = 1) uniform bool first; // there are no others
layout(location = 2) uniform float farthest; // depth where nothing is seen
#endif

layout(location = 0) out vec4 result;

void main()
{
	ivec2 pixel = ivec2(gl_FragCoord.xy) - corner;
	surface s = surface_at(pixel);
	vec3 irradiance = direct_irradiance(s.p, s.n);
#ifdef LAST
	float depth = texelFetch(depths, pixel, 0).x;
	if (depth == farthest)
		discard; // nothing is seen
	if (!first)
		irradiance += texelFetch(so_far, pixel, 0).xyz;
	result = vec4(s.own + reflectance_of(s, pixel) * INVERSE_PI * irradiance, 1.0);
	gl_FragDepth = depth;
#else
	result = vec4(irradiance, 0.0);
#endif
}
