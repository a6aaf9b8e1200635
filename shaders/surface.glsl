// Reads what surface.frag wrote of the surface in a pixel.
#include "octahedron.glsl"

layout(binding = GI_UNIT_PLACE) uniform sampler2D places; // xyz world position, w material
layout(binding = GI_UNIT_LOOK) uniform usampler2D looks;  // xyz bits of (rho * H_indirect + E) / pi, w normal

struct surface {
	vec3 p, n;
	vec3 own;
	uint material;
};

surface surface_at(ivec2 pixel)
{
	vec4 place = texelFetch(places, pixel, 0);
	uvec4 look = texelFetch(looks, pixel, 0);
	return surface(place.xyz, direction_from_octahedron(unpackSnorm2x16(look.w)), uintBitsToFloat(look.xyz),
		       uint(place.w));
}

// Its reflectance to what lights pixels, for the last pass: which includes buffers.glsl with READ_MATERIALS before, or
// defines ALBEDO in a scene with textures.
#ifdef ALBEDO
layout(binding = GI_UNIT_ALBEDO) uniform sampler2D albedos;

vec3 reflectance_of(surface s, ivec2 pixel)
{
	return texelFetch(albedos, pixel, 0).xyz;
}
#elif defined(READ_MATERIALS)
vec3 reflectance_of(surface s, ivec2 pixel)
{
	return load_material(s.material).rho.xyz;
}
#endif
