#version 450 core
// What each pixel shows.

layout(location = 0) in vec3 world_position;
layout(location = 1) in vec3 world_normal;
layout(location = 2) flat in uint number;

layout(location = 0) out vec4 place;
layout(location = 1) out vec4 normal;

void main()
{
	place = vec4(world_position, float(number + 1u));
	normal = vec4(normalize(world_normal), 0.0);
}
