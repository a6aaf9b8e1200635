// The look of a surface with textures of the host, in a pixel.
#define READ_MATERIALS
#include "buffers.glsl"
#include "shade_shared.h"
#include "shade_modes.glsl"
#include "numbers.glsl"

layout(location = 0) in vec3 world_position;
layout(location = 1) in vec3 world_normal;
layout(location = 2) in vec3 own; // what no texture says, over pi
layout(location = 3) flat in uint material;
layout(location = 4) in vec3 irradiance;
layout(location = 5) in vec2 uv;

layout(location = 1) uniform uint mode;
layout(location = 2) uniform uint textures; // GI_HAS_
layout(location = 3) uniform vec4 base_color_factor;
layout(location = 4) uniform vec4 emissive_factor; // w: alpha cutoff
layout(location = 5) uniform vec3 base_color_uv[2]; // rows
layout(location = 7) uniform vec3 emissive_uv[2];
layout(binding = GI_UNIT_BASE_COLOR) uniform sampler2D base_color;
layout(binding = GI_UNIT_EMISSIVE) uniform sampler2D emissive;

struct textured_look {
	vec3 own; // (rho * H_indirect + E) / pi
	vec3 rho;
};

vec2 place_in(vec3 rows[2])
{
	return vec2(dot(rows[0], vec3(uv, 1.0)), dot(rows[1], vec3(uv, 1.0)));
}

// Discards what is cut out.
textured_look textured()
{
	textured_look look = textured_look(own, load_material(material).rho.xyz);
	float coverage = 1.0;
	if ((textures & GI_HAS_BASE_COLOR) != 0u) {
		vec4 texel = texture(base_color, place_in(base_color_uv)) * base_color_factor;
		look.rho = clamp(texel.xyz, 0.0, 1.0);
		look.own += look.rho * irradiance * INVERSE_PI;
		coverage = texel.w;
	}
	if ((textures & GI_HAS_EMISSIVE) != 0u && mode != MODE_INDIRECT) {
		vec3 texel = texture(emissive, place_in(emissive_uv)).xyz;
		look.own += max(texel, vec3(0.0)) * emissive_factor.xyz * INVERSE_PI;
	}
	if (coverage < emissive_factor.w)
		discard;
	return look;
}
