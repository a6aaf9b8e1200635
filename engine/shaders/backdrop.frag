#version 450 core
// The sky in a pixel's direction: +y is the picture's first row, -z the middle of its columns.

layout(location = 0) in vec2 place;
layout(location = 0) uniform mat4 world_from_clip; // directions
layout(binding = 0) uniform sampler2D sky;

layout(location = 0) out vec4 color;

const float PI = 3.14159265358979;

void main()
{
	vec4 near = world_from_clip * vec4(place, -1.0, 1.0), far = world_from_clip * vec4(place, 1.0, 1.0);
	vec3 d = normalize(far.xyz * near.w - near.xyz * far.w);
	vec2 at = vec2(0.5 + atan(d.x, -d.z) * (0.5 / PI), acos(clamp(d.y, -1.0, 1.0)) / PI);
	// Above and below, a whole row is one place; explicit level: columns wrap, their derivative jumps.
	color = vec4(textureLod(sky, at, 0.0).rgb, 1.0);
}
