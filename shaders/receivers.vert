#version 450 core
// Receivers over the picture: a disc across its normal, or a ball of one that looks all round. An instance a receiver,
// a triangle about the unit disc.
#define READ_OBJECTS
#define READ_LEAVES
#define READ_WORLD
#include "buffers.glsl"

layout(location = 0) in vec2 corner;

layout(location = 0) uniform mat4 clip_from_world;
layout(location = 1) uniform uint first; // the set's first one as a leaf
layout(location = 2) uniform vec4 eye;   // w 0: a direction
layout(location = 3) uniform vec2 size;  // radius: metres, and at most so many of them times clip w

layout(location = 0) out vec2 at;         // on the unit disc
layout(location = 1) flat out vec4 centre; // world; w: radius
layout(location = 2) flat out vec3 right;
layout(location = 3) flat out vec3 up;
layout(location = 4) flat out vec3 front;
layout(location = 5) flat out uvec2 light; // where it begins, how many vec4

// Discs lie on what they belong to: by so much of their radius nearer to the eye they are seen.
const float LIFT = 0.1;

void main()
{
	uvec4 leaf = load_leaf(first + uint(gl_InstanceID));
	uvec4 ids = object_ids(leaf.y);
	vec3 p = world_sphere(leaf.x).xyz, to_eye = normalize(eye.xyz - p * eye.w);
	light = uvec2(ids.z + ids.w * uint(gl_InstanceID), ids.w);
	bool ball = ids.w > 1u;
	front = ball ? to_eye : world_axis(leaf.x).xyz;
	vec3 a = abs(front);
	bool x_least = a.x <= a.y && a.x <= a.z;
	vec3 least = x_least ? vec3(1, 0, 0) : a.y <= a.z ? vec3(0, 1, 0) : vec3(0, 0, 1);
	right = normalize(cross(least, front));
	up = cross(front, right);
	vec4 middle = clip_from_world * vec4(p, 1.0);
	float radius = min(size.x, size.y * middle.w);
	centre = vec4(ball ? p : p + LIFT * radius * to_eye, radius);
	at = corner;
	gl_Position = clip_from_world * vec4(centre.xyz + radius * (corner.x * right + corner.y * up), 1.0);
	// Backs of discs are not seen, as backs of surfaces are not.
	if (!ball && dot(front, to_eye) <= 0.0)
		gl_Position = vec4(0.0, 0.0, 0.0, -1.0);
}
