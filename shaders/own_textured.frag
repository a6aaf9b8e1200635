#version 450 core
// A surface with textures, without direct light.
#include "textured.glsl"

layout(location = 0) out vec4 radiance;

void main()
{
	radiance = vec4(textured().own, 1.0);
}
