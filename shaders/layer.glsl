// A surface that is seen in a mirror or through glass, in the form that surface.glsl reads. In the place of its
// material stands its rho, nine bits a channel, packed as the bits of a normal float.
#include "numbers.glsl"

void store_layer(vec3 p, vec3 n, vec3 own, vec3 albedo, out vec4 place, out uvec4 look)
{
	uvec3 bits = uvec3(clamp(albedo, 0.0, 1.0) * 511.0 + 0.5);
	place = vec4(p, uintBitsToFloat(0x40000000u | bits.x << 18u | bits.y << 9u | bits.z));
	look = uvec4(floatBitsToUint(own), packSnorm2x16(octahedron_from_direction(n)));
}

vec3 layer_albedo(float w)
{
	uint bits = floatBitsToUint(w);
	return vec3(bits >> 18u & 511u, bits >> 9u & 511u, bits & 511u) / 511.0;
}
