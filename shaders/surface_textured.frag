#version 450 core
// The same as surface_albedo.frag, of what has textures.
#include "textured.glsl"
#include "octahedron.glsl"

layout(location = 0) out vec4 place;
layout(location = 1) out uvec4 look;
layout(location = 2) out vec4 albedo;

void main()
{
	textured_look seen = textured();
	place = vec4(world_position, float(material));
	look = uvec4(floatBitsToUint(seen.own), packSnorm2x16(octahedron_from_direction(world_normal)));
	albedo = vec4(seen.rho, 1.0);
}
