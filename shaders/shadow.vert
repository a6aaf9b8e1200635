#version 450 core
// Depth as seen from one sample of a lamp.
#define USE_OBJECTS
#include "buffers.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in uint slot;

layout(location = 0) uniform mat4 clip_from_world;

void main()
{
	gl_Position = clip_from_world * vec4(world_from_rest(slot, position), 1.0);
}
