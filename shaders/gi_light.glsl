// The light of Relume's leaves in a host's own shaders (gi.h, "light for a host's own meshes and shaders"). For vertex
// and fragment shaders of GLSL 3.30 and newer: to be pasted or included behind #version and #extension lines. All names
// begin with gi_ or GI_.
//
// Where the light comes from is said by macros before it:
//
//   GI_LIGHT_UNIT n           light_indirect_texture is bound to texture unit n (GLSL 4.20)
//   GI_LIGHT_STORAGE n        light_indirect is bound to storage block n (GLSL 4.30)
//   neither                   light_indirect_texture is bound to the unit that the host gives the sampler uniform
//                             gi_light_texels
//   GI_MAP_UNIT n             the host's array of gi_vertex_light is a GL_RGBA32UI buffer texture bound to unit n,
//                             where it is no vertex attribute; GI_MAP likewise to the unit of the uniform
//                             gi_map_texels
//   GI_LEAF_UNIT n            leaf_indirect_texture is bound to unit n, for gi_light_at_leaf; GI_LEAF likewise to the
//                             unit of the uniform gi_leaf_texels
//
// H is irradiance, W/m2, rgb: of everything but what gi_draw lights per pixel. Of a diffuse surface of reflectance rho
// and exitance E the radiance, W/m2/sr, is (rho H + E) / pi: gi_radiance.
#ifndef GI_LIGHT_GLSL
#define GI_LIGHT_GLSL

#ifdef GI_LIGHT_STORAGE
layout(std430, binding = GI_LIGHT_STORAGE) readonly buffer gi_light_block
{
	vec4 gi_light_values[];
};
// H at a light vertex, counted from the first of all objects.
vec3 gi_light(uint n)
{
	return gi_light_values[n].xyz;
}
#else
#ifdef GI_LIGHT_UNIT
layout(binding = GI_LIGHT_UNIT)
#endif
uniform usamplerBuffer gi_light_texels;
vec3 gi_light(uint n)
{
	return uintBitsToFloat(texelFetch(gi_light_texels, int(n)).xyz);
}
#endif

// H at a vertex: a gi_vertex_light, of an object whose gi_object_range has first_light. Of the values at the vertices
// pixels have what lies between.
vec3 gi_light_at_vertex(uint first_light, uvec4 light, vec4 weight)
{
	return gi_light(first_light + light.x) * weight.x + gi_light(first_light + light.y) * weight.y +
	       gi_light(first_light + light.z) * weight.z + gi_light(first_light + light.w) * weight.w;
}

#if defined(GI_MAP_UNIT) || defined(GI_MAP)
#ifdef GI_MAP_UNIT
layout(binding = GI_MAP_UNIT)
#endif
uniform usamplerBuffer gi_map_texels;
// The same by the number of the gi_vertex_light: gl_VertexID, or that of a lightmap's texel.
vec3 gi_light_at_mapped(uint first_light, uint vertex)
{
	uvec4 light = texelFetch(gi_map_texels, int(2u * vertex));
	uvec4 weight = texelFetch(gi_map_texels, int(2u * vertex + 1u));
	return gi_light_at_vertex(first_light, light, uintBitsToFloat(weight));
}
#endif

#if defined(GI_LEAF_UNIT) || defined(GI_LEAF)
#ifdef GI_LEAF_UNIT
layout(binding = GI_LEAF_UNIT)
#endif
uniform usamplerBuffer gi_leaf_texels;
// H of a leaf, the same all over it: first_leaf + n of the object's.
vec3 gi_light_at_leaf(uint leaf)
{
	return uintBitsToFloat(texelFetch(gi_leaf_texels, int(leaf)).xyz);
}
#endif

vec3 gi_radiance(vec3 rho, vec3 exitance, vec3 irradiance)
{
	return (rho * irradiance + exitance) * 0.318309886;
}

#endif
