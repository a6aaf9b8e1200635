// What the shaders of real-time ray tracing (realtime_tracer.h) share: the scene, and how images are read.

const float PI = 3.14159265358979;

struct rt_instance {
	mat4 object_from_world, world_from_object;
	uvec4 range; // first node, nodes an order, first triangle
};

struct rt_object {
	vec4 rho, exitance;
	vec4 reflectance;   // of a mirror; w: index of refraction
	vec4 transmittance; // of glass
	mat4 before_from_now; // in the world: where a point of it was a frame ago
};

struct rt_light {
	vec4 origin, u, v; // a triangle; w: power of this and all before, density of its points by area, 0
	vec4 exitance;
};

struct rt_camera {
	vec4 eye, forward, right, up; // trace_camera.h
};

layout(std140, binding = 0) uniform scene_block {
	rt_instance instances[8];
	rt_object objects[16];
	rt_light lights[16];
	rt_camera camera, camera_before;
	uvec4 counts;  // instances, lights, frame, bounces
	uvec4 flags;   // something moves, light is reused, mode, paths a pixel
	vec4 settings; // lift, metres; frames that count in motion; how far history may differ; largest sample
	vec4 edges;    // of the filter: depth, normal, light; largest history at rest
};

const uint MODE_GLOBAL = 0u, MODE_DIRECT = 1u, MODE_INDIRECT = 2u;
const uint NOTHING = 0xffffffffu;

// What a pixel shows: place.w is the object + 1, 0: nothing.
layout(binding = 0) uniform sampler2D places;
layout(binding = 1) uniform sampler2D normals;
layout(binding = 2) uniform sampler2D places_before;
layout(binding = 3) uniform sampler2D normals_before;

uint object_of(vec4 place)
{
	return place.w < 0.5 ? NOTHING : uint(place.w) - 1u;
}

bool is_smooth(rt_object o)
{
	return o.reflectance.xyz != vec3(0.0) || o.transmittance.xyz != vec3(0.0);
}

float luminance(vec3 c)
{
	return dot(c, vec3(0.2126, 0.7152, 0.0722));
}

// Where in a picture of that size a point is seen, pixels; z: its depth, below 0 behind the eye.
vec3 find_pixel(rt_camera c, vec3 p, vec2 size)
{
	vec3 to = p - c.eye.xyz;
	float depth = dot(to, c.forward.xyz);
	vec2 widths = vec2(dot(c.right.xyz, c.right.xyz), dot(c.up.xyz, c.up.xyz));
	vec2 at = vec2(dot(to, c.right.xyz), dot(to, c.up.xyz)) / (widths * depth);
	return vec3((at * 0.5 + 0.5) * size, depth);
}
