#version 450 core
// One triangle over the whole picture, as far away as depth goes.

layout(location = 0) out vec2 place; // clip space

void main()
{
	place = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0;
	gl_Position = vec4(place, 1.0, 1.0);
}
