#version 450 core
// One light without a surface on what is seen: its irradiance, which the last pass of a picture makes radiance of.
#include "gi_shared.h"
#include "shade_shared.h"
#include "surface.glsl"
#include "punctual.glsl"
#include "punctual_shadow.glsl"

layout(location = 0) uniform ivec2 corner; // of the viewport, pixels

layout(location = 0) out vec4 result;

void main()
{
	surface s = surface_at(ivec2(gl_FragCoord.xy) - corner);
	bool sun = is_directional(view.light);
	vec3 to = sun ? view.light.place.xyz : view.light.place.xyz - s.p;
	float square = dot(to, to), cosine = dot(s.n, to) * inversesqrt(max(square, 1e-30));
	float factor = max(cosine, 0.0);
	if (!sun)
		factor *= punctual_falloff(view.light, -to) / max(square, 1e-30);
	factor *= punctual_visibility(s.p, s.n, cosine, factor > 0.0);
	result = vec4(view.light.color.xyz * factor, 0.0);
}
