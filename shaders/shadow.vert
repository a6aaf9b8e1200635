#version 450 core
// Depth as seen from one sample of a lamp, in one sector of its map (shade_shared.h).
#define READ_OBJECTS
#include "buffers.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in uint slot;

layout(location = 0) uniform mat4 from_world[2]; // to clip coordinates; to distances inside the sector's planes

out gl_PerVertex {
	vec4 gl_Position;
	float gl_ClipDistance[3];
};

void main()
{
	vec4 p = vec4(world_from_rest(slot, position), 1.0);
	gl_Position = from_world[0] * p;
	vec4 inside = from_world[1] * p;
	gl_ClipDistance[0] = inside.x;
	gl_ClipDistance[1] = inside.y;
	gl_ClipDistance[2] = inside.z;
}
