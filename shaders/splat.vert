#version 450 core
// A photon as a disc on the surface that it fell on. One instance a photon.
#define READ_OBJECTS
#define READ_LEAVES
#define READ_LEAF_QUADS
#define READ_PHOTONS
#define READ_CAUSTIC_PATHS
#include "buffers.glsl"
#include "numbers.glsl"

layout(location = 0) in vec2 corner; // of the square around the disc

layout(location = 0) uniform mat4 clip_from_world;
layout(location = 1) uniform uint photons_a_pair;

layout(location = 0) flat out vec4 disc;      // centre, radius
layout(location = 1) flat out vec3 normal;
layout(location = 2) flat out vec3 irradiance; // at its centre

void main()
{
	uint number = uint(gl_InstanceID), count = load_photon_count(number / photons_a_pair);
	gi_photon photon = load_photon(number);
	uint leaf = floatBitsToUint(photon.place.w);
	disc = vec4(photon.place.xyz, photon.flux.w);
	normal = vec3(0.0);
	irradiance = vec3(0.0);
	gl_Position = vec4(0.0, 0.0, 2.0, 1.0); // not seen
	if (leaf == GI_NONE || number % photons_a_pair >= count)
		return;
	vec3 a = load_leaf_corner(leaf, 0u).xyz, b = load_leaf_corner(leaf, 1u).xyz, c = load_leaf_corner(leaf, 2u).xyz,
	     d = load_leaf_corner(leaf, 3u).xyz;
	normal = normalize(world_direction_from_rest(load_leaf(leaf).y, cross(c - a, d - b)));
	// Epanechnikov's kernel: its integral over the disc is 1.
	irradiance = photon.flux.xyz * (2.0 / (PI * disc.w * disc.w * float(count)));
	vec3 across =
	    normalize(abs(normal.z) < 0.7 ? cross(normal, vec3(0.0, 0.0, 1.0)) : cross(normal, vec3(1.0, 0.0, 0.0)));
	vec3 up = cross(normal, across);
	gl_Position = clip_from_world * vec4(disc.xyz + disc.w * (across * corner.x + up * corner.y), 1.0);
}
