// The picture of the sky (gi/src/sky_image.h): what lies in a direction, and directions drawn by its light. SKY_IMAGE
// is the first of the three locations of its uniform.
layout(location = SKY_IMAGE) uniform vec4 sky_rows[3]; // from the world to the picture; w: columns, rows

uint sky_texel_towards(vec3 d)
{
	vec3 p = vec3(dot(sky_rows[0].xyz, d), dot(sky_rows[1].xyz, d), dot(sky_rows[2].xyz, d));
	vec2 size = vec2(sky_rows[0].w, sky_rows[1].w);
	vec2 at = vec2(0.5 + atan(p.x, -p.z) * (0.5 / PI), acos(clamp(p.y, -1.0, 1.0)) / PI);
	uvec2 texel = uvec2(clamp(at * size, vec2(0.0), size - 1.0));
	return texel.y * uint(size.x) + texel.x;
}

// pi times radiance, W/m2.
vec3 sky_texel_exitance(uint texel)
{
	return uintBitsToFloat(load_sky_texel(texel).xyz);
}

float sky_texel_height(float row)
{
	return cos(row * PI / sky_rows[1].w);
}

// Chance of a texel over its solid angle, 1/sr.
float sky_density(uint texel)
{
	float before = texel > 0u ? float(load_sky_texel(texel).w - load_sky_texel(texel - 1u).w)
				  : float(load_sky_texel(0u).w) + 1.0;
	float row = float(texel / uint(sky_rows[0].w));
	return before * (1.0 / 4294967296.0) /
	       (2.0 * PI / sky_rows[0].w * (sky_texel_height(row) - sky_texel_height(row + 1.0)));
}

// A texel by its share of the light.
uint pick_sky_texel(uint u)
{
	uint low = 0u, high = uint(sky_rows[0].w) * uint(sky_rows[1].w) - 1u;
	while (low < high) {
		uint middle = (low + high) >> 1u;
		if (u <= load_sky_texel(middle).w)
			high = middle;
		else
			low = middle + 1u;
	}
	return low;
}

// A direction within it, even over its solid angle.
vec3 sky_direction(uint texel, vec2 u)
{
	uint columns = uint(sky_rows[0].w);
	float row = float(texel / columns), around = 2.0 * PI * ((float(texel % columns) + u.x) / float(columns) - 0.5);
	float up = mix(sky_texel_height(row), sky_texel_height(row + 1.0), u.y);
	float out_of_axis = sqrt(max(0.0, 1.0 - up * up));
	vec3 p = vec3(sin(around) * out_of_axis, up, -cos(around) * out_of_axis);
	return sky_rows[0].xyz * p.x + sky_rows[1].xyz * p.y + sky_rows[2].xyz * p.z;
}
