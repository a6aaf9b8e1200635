#version 450 core
#include "realtime.glsl"
// Temporal accumulation: what a pixel's place had before is found again and averaged with the new sample (Schied et
// al., "Spatiotemporal variance-guided filtering", 2017, section 4.1). Where something moves history is held to the
// range of the samples around (Salvi, "An excursion in temporal supersampling", 2016), and forgotten after some frames;
// at rest it grows.
//
// Out: mean of the light, and of its squared luminance; w of the direct light: how many samples; w of the indirect: 0.

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 4) uniform sampler2D new_direct;
layout(binding = 5) uniform sampler2D new_indirect;
layout(binding = 6) uniform sampler2D old_direct;
layout(binding = 7) uniform sampler2D old_indirect;
layout(binding = 8) uniform sampler2D old_squares;

layout(rgba32f, binding = 0) writeonly uniform image2D direct_out;
layout(rgba32f, binding = 1) writeonly uniform image2D indirect_out;
layout(rgba32f, binding = 2) writeonly uniform image2D squares_out;

struct history {
	vec4 direct, squares;
	vec3 indirect;
};

history find_history(vec3 p, vec3 n, uint object, ivec2 size)
{
	history h = history(vec4(0.0), vec4(0.0), vec3(0.0));
	vec3 before = (objects[object].before_from_now * vec4(p, 1.0)).xyz;
	vec3 was = mat3(objects[object].before_from_now) * n;
	vec3 at = find_pixel(camera_before, before, vec2(size));
	vec2 corner = floor(at.xy - 0.5), part = at.xy - 0.5 - corner;
	float width = 2.0 * at.z * length(camera_before.up.xyz) / float(size.y), sum = 0.0;
	// A step along a plane seen on edge is long: the distance to the plane counts.
	for (int k = 0; k < 4; k++) {
		ivec2 step = ivec2(k & 1, k >> 1), pixel = ivec2(corner) + step;
		if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, size)) || at.z <= 0.0)
			continue;
		vec4 place = texelFetch(places_before, pixel, 0);
		vec3 normal = texelFetch(normals_before, pixel, 0).xyz;
		vec2 w = mix(1.0 - part, part, vec2(step));
		bool same = object_of(place) == object && dot(normal, was) > 0.9 &&
			    abs(dot(place.xyz - before, was)) < width;
		float weight = same ? w.x * w.y : 0.0;
		h.direct += weight * texelFetch(old_direct, pixel, 0);
		h.indirect += weight * texelFetch(old_indirect, pixel, 0).xyz;
		h.squares += weight * texelFetch(old_squares, pixel, 0);
		sum += weight;
	}
	if (sum < 0.01)
		return history(vec4(0.0), vec4(0.0), vec3(0.0));
	return history(h.direct / sum, h.squares / sum, h.indirect / sum);
}

// Holds light to the mean of the samples around, and so many standard deviations of it.
vec3 hold(sampler2D samples, ivec2 pixel, uint object, ivec2 size, vec3 light)
{
	vec3 mean = vec3(0.0), square = vec3(0.0);
	float count = 0.0;
	for (int y = -3; y <= 3; y += 2)
		for (int x = -3; x <= 3; x += 2) {
			ivec2 at = clamp(pixel + ivec2(x, y), ivec2(0), size - 1);
			float same = object_of(texelFetch(places, at, 0)) == object ? 1.0 : 0.0;
			vec3 s = texelFetch(samples, at, 0).xyz;
			mean += same * s;
			square += same * s * s;
			count += same;
		}
	count = max(count, 1.0);
	mean /= count;
	vec3 range = settings.z * sqrt(max(square / count - mean * mean, 0.0));
	return count < 8.0 ? light : clamp(light, mean - range, mean + range);
}

void main()
{
	ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = textureSize(places, 0);
	if (any(greaterThanEqual(pixel, size)))
		return;
	vec4 place = texelFetch(places, pixel, 0);
	uint object = object_of(place);
	vec4 direct = vec4(0.0), squares = vec4(0.0);
	vec3 indirect = vec3(0.0);
	if (object != NOTHING) {
		history h = find_history(place.xyz, texelFetch(normals, pixel, 0).xyz, object, size);
		vec3 d = texelFetch(new_direct, pixel, 0).xyz, i = texelFetch(new_indirect, pixel, 0).xyz;
		if (flags.x != 0u && h.direct.w > 0.0) {
			h.direct.xyz = hold(new_direct, pixel, object, size, h.direct.xyz);
			h.indirect = hold(new_indirect, pixel, object, size, h.indirect);
		}
		float count = min(h.direct.w, (flags.x != 0u ? settings.y : edges.w) - 1.0) + 1.0, share = 1.0 / count;
		vec2 l = vec2(luminance(d), luminance(i));
		direct = vec4(mix(h.direct.xyz, d, share), count);
		indirect = mix(h.indirect, i, share);
		squares = vec4(mix(h.squares.xy, l * l, share), 0.0, 0.0);
	}
	imageStore(direct_out, pixel, direct);
	imageStore(indirect_out, pixel, vec4(indirect, 0.0));
	imageStore(squares_out, pixel, squares);
}
