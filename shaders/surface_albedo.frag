#version 450 core
// What is seen in a pixel of a scene with textures: its reflectance too.
#define READ_MATERIALS
#include "buffers.glsl"
#include "octahedron.glsl"

layout(location = 0) in vec3 world_position;
layout(location = 1) in vec3 world_normal;
layout(location = 2) in vec3 own;
layout(location = 3) flat in uint material;

layout(location = 0) out vec4 place;
layout(location = 1) out uvec4 look;
layout(location = 2) out vec4 albedo;

void main()
{
	place = vec4(world_position, float(material));
	look = uvec4(floatBitsToUint(own), packSnorm2x16(octahedron_from_direction(world_normal)));
	albedo = vec4(load_material(material).rho.xyz, 1.0);
}
