// How a shader gets at the library's buffers (buffer_list.h). It defines READ_name for those it reads and WRITE_name
// for those it writes before it includes this file, and calls load_...() or assigns to name[n]; which kind of access is
// behind that is decided here:
//
//   READ_name   a buffer texture of four words a texel (gpu.c), at unit GI_TEXEL_UNIT + binding. llvmpipe up to Mesa
//               25.0 loads from a storage block lane by lane and component by component, some 10 ns each; a texel is
//               one vector load a lane, some 1 ns. A texture holds 2^27 texels (2 GiB) where a storage block is
//               promised 128 MiB there. On GPUs both go through the same caches.
//   WRITE_name  a storage block, for stores and atomics. A shader that reads what it wrote in the same dispatch reads
//               it there: a texture does not promise to show it.
//   READ_FRAME, READ_STATE
//               uniform blocks: the same for all threads. state_before is the state as it was before the dispatch.
//
// OpenGL 4.5 promises 16 textures and 8 storage blocks a compute stage; gpu_init() asks for more where it needs more.
#include "gi_shared.h"

uvec4 texel(usamplerBuffer from, uint n)
{
	return texelFetch(from, int(n));
}

vec4 float_texel(usamplerBuffer from, uint n)
{
	return uintBitsToFloat(texelFetch(from, int(n)));
}

// Of a buffer of pairs of words.
uvec2 half_texel(usamplerBuffer from, uint n)
{
	uvec4 t = texelFetch(from, int(n >> 1u));
	return (n & 1u) == 0u ? t.xy : t.zw;
}

// Of a buffer of words.
uint word(usamplerBuffer from, uint n)
{
	return texelFetch(from, int(n >> 2u))[n & 3u];
}

#define TEXELS(binding_number) layout(binding = GI_TEXEL_UNIT + binding_number) uniform usamplerBuffer
#define STORAGE(binding_number) layout(std430, binding = binding_number) restrict buffer

#include "buffer_declarations.glsl"

#ifdef READ_FRAME
layout(std140, binding = GI_UNIFORM_FRAME) uniform frame_block { gi_frame frame; };

// Static objects are one source: the table of segments has a column for each slot from the first source on.
uint source_count()
{
	return frame.counts.z - frame.swept.z;
}

uint segment_of(uint leaf, uint source)
{
	return leaf * source_count() + source - frame.swept.z;
}
#endif

#ifdef READ_STATE
layout(std140, binding = GI_UNIFORM_STATE) uniform state_before_block { gi_state state_before; };
#endif
#ifdef WRITE_STATE
STORAGE(GI_BIND_STATE) state_block { gi_state state; };
#endif

// ---- what lies in an array otherwise than one a number ----

#ifdef READ_LEAF_QUADS
vec4 load_leaf_corner(uint leaf, uint corner)
{
	return load_leaf_corner(4u * leaf + corner);
}

float load_area_up_to(uint leaf)
{
	return load_leaf_corner(leaf, 0u).w;
}
#endif

#ifdef READ_LINKS
// Links 2 n and 2 n + 1: node and weight bits, twice. Blocks begin at multiples of four, and behind an odd last link is
// one of weight 0.
uvec4 load_two_links(uint n)
{
	return texel(links_texels, n);
}
#endif

#if defined(READ_LEAF_RADIOSITY) && defined(READ_FRAME)
vec4 load_leaf_part(uint part, uint leaf)
{
	return load_leaf_radiosity(part * frame.counts.x + leaf);
}
#endif

#ifdef READ_OBJECT_LISTS
// Of what the k-th mover swept: the update that saw it, its slot and whether it was elsewhere; corners of the box of
// where it was, 0 and 1, and of that and where it is, 2 and 3.
uvec4 load_swept_change(uint k)
{
	return texel(object_lists_texels, frame.swept.x + GI_SWEPT_PARTS * k);
}

vec4 load_swept_corner(uint k, uint corner)
{
	return float_texel(object_lists_texels, frame.swept.x + GI_SWEPT_PARTS * k + 1u + corner);
}
#endif

#ifdef READ_CAUSTIC_PATHS
// Of a pair, how many there are.
uint load_photon_count(uint pair)
{
	return load_caustic_path(GI_CAUSTIC_PATH_WORDS * pair + GI_CAUSTIC_NOW);
}
#endif

// ---- the poses of objects ----

#ifdef READ_OBJECTS
vec3 world_from_rest(uint object, vec3 p)
{
	vec4 q = vec4(p, 1.0);
	return vec3(dot(object_row0(object), q), dot(object_row1(object), q), dot(object_row2(object), q));
}

// The rotation's inverse is its transpose.
vec3 rest_from_world(uint object, vec3 p)
{
	vec4 a = object_row0(object), b = object_row1(object), c = object_row2(object);
	vec3 q = p - vec3(a.w, b.w, c.w);
	return a.xyz * q.x + b.xyz * q.y + c.xyz * q.z;
}

vec3 rest_direction_from_world(uint object, vec3 d)
{
	return object_row0(object).xyz * d.x + object_row1(object).xyz * d.y + object_row2(object).xyz * d.z;
}

vec3 world_direction_from_rest(uint object, vec3 d)
{
	return vec3(dot(object_row0(object).xyz, d), dot(object_row1(object).xyz, d), dot(object_row2(object).xyz, d));
}
#endif
