#version 450 core
// Coloured triangles in pixels from the top left corner.

layout(location = 0) in vec2 position;
layout(location = 1) in vec4 color;

layout(location = 0) uniform vec2 size; // of the picture, pixels

layout(location = 0) out vec4 vertex_color;

void main()
{
	vec2 unit = position / size;
	gl_Position = vec4(2.0 * unit.x - 1.0, 1.0 - 2.0 * unit.y, 0.0, 1.0);
	vertex_color = color;
}
