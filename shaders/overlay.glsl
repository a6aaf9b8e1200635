// Leaves over the picture or instead of it. A shader that includes this says what is shown of one: leaf_colour().
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 normal_lift; // of the leaf; w: how far the drawn surface may rise above it
layout(location = 2) in uint leaf;

layout(location = 0) uniform mat4 clip_from_world;
layout(location = 1) uniform uint overlay; // gi_overlay of gi.h
layout(location = 2) uniform vec4 eye;     // w 0: a direction

layout(location = 0) flat out vec3 shown; // display colour, linear
layout(location = 1) out vec2 facing_and_light;

const uint OVERLAY_WIREFRAME = 1u, OVERLAY_DIRTY = 2u, OVERLAY_HIERARCHY = 4u, OVERLAY_SENDERS = 5u,
	   OVERLAY_VISIBILITY = 6u;

vec3 leaf_colour();

// Black, violet, red, orange, pale yellow: as bright as the value is large, also in grey and to the colour-blind. Fit
// of matplotlib's inferno (van der Walt and Smith). The darkest step is kept off black, so that shapes can be told.
vec3 heat_colour(float heat)
{
	float t = 0.08 + 0.92 * clamp(heat, 0.0, 1.0);
	vec3 c0 = vec3(0.00022, 0.00165, -0.01948), c1 = vec3(0.10651, 0.56396, 3.93271);
	vec3 c2 = vec3(11.60249, -3.97285, -15.94239);
	vec3 c3 = vec3(-41.70400, 17.43640, 44.35415), c4 = vec3(77.16294, -33.40236, -81.80731);
	vec3 c5 = vec3(-71.31943, 32.62606, 73.20952), c6 = vec3(25.13113, -12.24267, -23.07033);
	vec3 ramp = c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * (c5 + t * c6)))));
	return pow(clamp(ramp, 0.0, 1.0), vec3(2.2));
}

void main()
{
	uint slot = load_leaf(leaf).y;
	vec3 p = world_from_rest(slot, position), n = world_direction_from_rest(slot, normal_lift.xyz);
	vec3 to_eye = normalize(eye.xyz - p * eye.w);
	float facing = dot(n, to_eye);
	shown = vec3(0.0);
	facing_and_light = vec2(facing, 0.55 + 0.45 * max(facing, 0.0));
	if (overlay == OVERLAY_WIREFRAME)
		p += to_eye * normal_lift.w;
	else
		shown = leaf_colour();
	gl_Position = clip_from_world * vec4(p, 1.0);
}
