#version 450 core
#include "realtime.glsl"
// A triangle of the scene as the rasteriser takes it.

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in uint object;

layout(location = 0) uniform mat4 clip_from_world;
layout(location = 1) uniform uint instance_number;

layout(location = 0) out vec3 world_position;
layout(location = 1) out vec3 world_normal;
layout(location = 2) flat out uint number;

void main()
{
	mat4 world = instances[instance_number].world_from_object;
	vec4 p = world * vec4(position, 1.0);
	world_position = p.xyz;
	world_normal = mat3(world) * normal;
	number = object;
	gl_Position = clip_from_world * p;
}
