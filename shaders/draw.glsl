// The drawn surface: places a vertex, gathers its indirect light.
#define READ_OBJECTS
#define READ_LEAVES
#define READ_MATERIALS
#define READ_LIGHT
#include "buffers.glsl"
#include "shade_modes.glsl"
#include "numbers.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec4 normal_sink; // w: how far the vertex lies under the surface that casts shadows
layout(location = 2) in uint leaf_number;
layout(location = 3) in uvec4 light_vertex;
layout(location = 4) in vec4 light_weight;

layout(location = 0) uniform mat4 clip_from_world;
layout(location = 1) uniform uint mode;

layout(location = 0) out vec3 world_position; // on the surface that casts shadows
layout(location = 1) out vec3 world_normal;
layout(location = 2) out vec3 own; // (rho * H_indirect + E) / pi
#ifdef TRANSLUCENT
uint material;
layout(location = 3) flat out uint lit_material; // per pixel: black, of a translucent object
#else
layout(location = 3) flat out uint material;
#endif
#ifdef TEXTURED
layout(location = 5) in vec2 mesh_uv;
layout(location = 2) uniform uint textures; // GI_HAS_
layout(location = 4) out vec3 irradiance; // H_indirect; what textures say of rho and E is not in `own`
layout(location = 5) out vec2 uv;
#endif

void main()
{
	uvec4 leaf = load_leaf(leaf_number);
	vec3 p = world_from_rest(leaf.y, position);
	material = leaf.z;
#ifdef TRANSLUCENT
	lit_material = material + uint(load_material(material).exitance.w);
#endif
	world_normal = world_direction_from_rest(leaf.y, normal_sink.xyz);
	world_position = p + world_normal * normal_sink.w;
	vec3 exitance = load_material(material).exitance.xyz, rho = load_material(material).rho.xyz;
#ifdef TEXTURED
	rho = (textures & GI_HAS_BASE_COLOR) != 0u ? vec3(0.0) : rho;
	exitance = (textures & GI_HAS_EMISSIVE) != 0u ? vec3(0.0) : exitance;
	irradiance = vec3(0.0);
	uv = mesh_uv;
#endif
	vec3 sum = mode == MODE_INDIRECT ? vec3(0.0) : exitance;
	if (mode != MODE_DIRECT) {
		vec3 light =
		    load_light(light_vertex.x).xyz * light_weight.x + load_light(light_vertex.y).xyz * light_weight.y +
		    load_light(light_vertex.z).xyz * light_weight.z + load_light(light_vertex.w).xyz * light_weight.w;
		sum += rho * light;
#ifdef TEXTURED
		irradiance = light;
#endif
	}
	own = sum * INVERSE_PI;
	gl_Position = clip_from_world * vec4(p, 1.0);
}
