#version 450 core
// Lines darken what lies below them; colours instead of the picture are display colours, linear, in [0,1].

layout(location = 0) flat in vec3 shown;
layout(location = 1) in vec2 facing_and_light;

layout(location = 1) uniform uint overlay;

layout(location = 0) out vec4 colour;

void main()
{
	if (overlay == 1u) {
		// Edges of leaves that face away are not seen, whatever lies in front of them.
		if (facing_and_light.x <= 0.0)
			discard;
		colour = vec4(vec3(0.35), 1.0);
		return;
	}
	colour = vec4(shown * facing_and_light.y, 1.0);
}
