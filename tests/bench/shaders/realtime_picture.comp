#version 450 core
#include "realtime.glsl"
// Radiance: irradiance takes the colour of its surface.

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 4) uniform sampler2D directs;
layout(binding = 5) uniform sampler2D indirects;

layout(rgba32f, binding = 0) writeonly uniform image2D picture;

void main()
{
	ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = textureSize(places, 0);
	if (any(greaterThanEqual(pixel, size)))
		return;
	uint object = object_of(texelFetch(places, pixel, 0));
	vec3 radiance = vec3(0.0);
	if (object != NOTHING) {
		rt_object o = objects[object];
		vec3 rho = is_smooth(o) ? vec3(1.0) : o.rho.xyz;
		vec3 own = flags.z == MODE_INDIRECT ? vec3(0.0) : o.exitance.xyz;
		radiance = (own + rho * (texelFetch(directs, pixel, 0).xyz + texelFetch(indirects, pixel, 0).xyz)) / PI;
	}
	imageStore(picture, pixel, vec4(radiance, 1.0));
}
