#version 450 core
#include "realtime.glsl"
// One step of the edge-avoiding a-trous filter (Dammertz et al., 2010), led by the variance of the light (Schied et
// al., 2017, section 4.3): nine pixels, `spacing` apart. Irradiance, not radiance: colours of surfaces are not blurred.

layout(local_size_x = 8, local_size_y = 8) in;

layout(location = 0) uniform int spacing;

layout(binding = 4) uniform sampler2D directs; // w: variance of the luminance
layout(binding = 5) uniform sampler2D indirects;

layout(rgba32f, binding = 0) writeonly uniform image2D direct_out;
layout(rgba32f, binding = 1) writeonly uniform image2D indirect_out;

void main()
{
	ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = textureSize(places, 0);
	if (any(greaterThanEqual(pixel, size)))
		return;
	vec4 place = texelFetch(places, pixel, 0);
	vec4 direct = texelFetch(directs, pixel, 0), indirect = texelFetch(indirects, pixel, 0);
	vec3 n = texelFetch(normals, pixel, 0).xyz;
	uint object = object_of(place);
	vec2 light = vec2(luminance(direct.xyz), luminance(indirect.xyz)), all = vec2(1.0);
	vec2 narrow = 1.0 / (edges.z * sqrt(max(vec2(direct.w, indirect.w), 0.0)) + 1e-4 * light + 1e-9);
	float width = distance(place.xyz, camera.eye.xyz) * 2.0 * length(camera.up.xyz) / float(size.y);
	for (int k = object == NOTHING ? 9 : 0; k < 9; k++) {
		ivec2 step = ivec2(k % 3 - 1, k / 3 - 1), at = pixel + spacing * step;
		if (k == 4 || any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size)))
			continue;
		vec4 other = texelFetch(places, at, 0);
		vec4 d = texelFetch(directs, at, 0), i = texelFetch(indirects, at, 0);
		float kernel = step.x == 0 || step.y == 0 ? 0.5 : 0.25;
		float same = pow(max(dot(n, texelFetch(normals, at, 0).xyz), 0.0), edges.y) *
			     exp(-abs(dot(n, other.xyz - place.xyz)) / (edges.x * width * float(spacing)));
		vec2 apart = abs(vec2(luminance(d.xyz), luminance(i.xyz)) - light) * narrow;
		vec2 weight = (object_of(other) == object ? kernel * same : 0.0) * exp(-apart);
		direct += vec4(weight.xxx, weight.x * weight.x) * d;
		indirect += vec4(weight.yyy, weight.y * weight.y) * i;
		all += weight;
	}
	imageStore(direct_out, pixel, direct / vec4(all.xxx, all.x * all.x));
	imageStore(indirect_out, pixel, indirect / vec4(all.yyy, all.y * all.y));
}
