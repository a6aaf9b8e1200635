#version 450 core
// Lines darken what lies below them; heat maps are display colours, linear, in [0,1].

layout(location = 0) flat in float heat;
layout(location = 1) in vec2 facing_and_light;

layout(location = 1) uniform uint overlay;

layout(location = 0) out vec4 colour;

// Black, violet, red, orange, pale yellow: as bright as the value is large, also in grey and to the colour-blind. Fit
// of matplotlib's inferno (van der Walt and Smith).
vec3 heat_ramp(float t)
{
	vec3 c0 = vec3(0.00022, 0.00165, -0.01948), c1 = vec3(0.10651, 0.56396, 3.93271);
	vec3 c2 = vec3(11.60249, -3.97285, -15.94239);
	vec3 c3 = vec3(-41.70400, 17.43640, 44.35415), c4 = vec3(77.16294, -33.40236, -81.80731);
	vec3 c5 = vec3(-71.31943, 32.62606, 73.20952), c6 = vec3(25.13113, -12.24267, -23.07033);
	return clamp(c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * (c5 + t * c6))))), 0.0, 1.0);
}

void main()
{
	if (overlay == 1u) {
		// Edges of leaves that face away are not seen, whatever lies in front of them.
		if (facing_and_light.x <= 0.0)
			discard;
		colour = vec4(vec3(0.35), 1.0);
		return;
	}
	// The darkest step is kept off black, so that shapes can be told.
	vec3 shown = heat_ramp(0.08 + 0.92 * heat);
	colour = vec4(pow(shown, vec3(2.2)) * facing_and_light.y, 1.0);
}
