#version 450 core
// The drawn surface without direct light.
layout(location = 2) in vec3 own; // (rho * H_indirect + E) / pi

layout(location = 0) out vec4 radiance;

void main()
{
	radiance = vec4(own, 1.0);
}
