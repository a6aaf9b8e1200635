// How a shader gets at the library's buffers. It defines READ_name for those it reads and WRITE_name for those it
// writes before it includes this file, and calls load_...() or assigns to ...[n]; which kind of access is behind that
// is decided here:
//
//   READ_name   a buffer texture of four words a texel (gpu.c), at unit GI_TEXEL_UNIT + binding. llvmpipe up to Mesa
//   READ_name   a buffer texture of four words a texel (gpu.c), at unit GI_TEXEL_UNIT + binding. llvmpipe up to Mesa
//               vector load a lane, some 1 ns. A texture holds 2^27 texels (2 GiB) where a storage block is promised
//               128 MiB there. On GPUs both go through the same caches.
//   WRITE_name  a storage block, for stores and atomics. A shader that reads what it wrote in the same dispatch reads
//   it
//               there: a texture does not promise to show it.
//   READ_FRAME  a uniform block: the same for all threads.
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

// Of a buffer of gi_node_geometry.
gi_node_geometry geometry_texels(usamplerBuffer from, uint n)
{
	return gi_node_geometry(float_texel(from, 3u * n), float_texel(from, 3u * n + 1u),
				float_texel(from, 3u * n + 2u));
}

#define TEXELS(binding_number) layout(binding = GI_TEXEL_UNIT + binding_number) uniform usamplerBuffer
#define STORAGE(binding_number) layout(std430, binding = binding_number) restrict buffer

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

// ---- reads ----

#ifdef READ_OBJECTS
TEXELS(GI_BIND_OBJECTS) object_texels;
vec4 object_row0(uint n)
{
	return float_texel(object_texels, 14u * n);
}

vec4 object_row1(uint n)
{
	return float_texel(object_texels, 14u * n + 1u);
}

vec4 object_row2(uint n)
{
	return float_texel(object_texels, 14u * n + 2u);
}

vec4 object_lower(uint n)
{
	return float_texel(object_texels, 14u * n + 3u);
}

vec4 object_upper(uint n)
{
	return float_texel(object_texels, 14u * n + 4u);
}

vec4 object_grid(uint n)
{
	return float_texel(object_texels, 14u * n + 5u);
}

vec4 object_cells(uint n)
{
	return float_texel(object_texels, 14u * n + 6u);
}

vec4 object_sphere(uint n)
{
	return float_texel(object_texels, 14u * n + 7u);
}

vec4 object_plane(uint n)
{
	return float_texel(object_texels, 14u * n + 8u);
}

uvec4 object_nodes(uint n)
{
	return texel(object_texels, 14u * n + 9u);
}

uvec4 object_bvh(uint n)
{
	return texel(object_texels, 14u * n + 10u);
}

uvec4 object_extra(uint n)
{
	return texel(object_texels, 14u * n + 11u);
}

uvec4 object_changed(uint n)
{
	return texel(object_texels, 14u * n + 12u);
}

uvec2 object_ids(uint n)
{
	return texel(object_texels, 14u * n + 13u).xy;
}
#endif

#ifdef READ_TOPOLOGY
TEXELS(GI_BIND_TOPOLOGY) topology_texels;
uvec4 load_range(uint n)
{
	return texel(topology_texels, 2u * n);
}

uvec4 load_corners(uint n)
{
	return texel(topology_texels, 2u * n + 1u);
}

gi_node_topology load_topology(uint n)
{
	return gi_node_topology(load_range(n), load_corners(n));
}
#endif

#ifdef READ_REST
TEXELS(GI_BIND_REST) rest_texels;
gi_node_geometry load_rest(uint n)
{
	return geometry_texels(rest_texels, n);
}

vec4 load_rest_sphere(uint n)
{
	return float_texel(rest_texels, 3u * n);
}

float load_area(uint n)
{
	return float_texel(rest_texels, 3u * n + 2u).w;
}
#endif

#ifdef READ_WORLD
TEXELS(GI_BIND_WORLD) world_texels;
gi_node_geometry load_world(uint n)
{
	return geometry_texels(world_texels, n);
}

vec4 load_sphere(uint n)
{
	return float_texel(world_texels, 3u * n);
}
#endif

#ifdef READ_SPREAD
TEXELS(GI_BIND_SPREAD) spread_texels;
gi_node_spread load_spread(uint n)
{
	return gi_node_spread(float_texel(spread_texels, 2u * n), float_texel(spread_texels, 2u * n + 1u));
}
#endif

#ifdef READ_VERTICES_REST
TEXELS(GI_BIND_VERTICES_REST) rest_vertex_texels;
vec3 rest_vertex(uint n)
{
	return float_texel(rest_vertex_texels, n).xyz;
}
#endif

#ifdef READ_VERTICES_WORLD
TEXELS(GI_BIND_VERTICES_WORLD) world_vertex_texels;
vec3 world_vertex(uint n)
{
	return float_texel(world_vertex_texels, n).xyz;
}
#endif

#ifdef READ_LEAVES
TEXELS(GI_BIND_LEAVES) leaf_texels;
uvec4 load_leaf(uint n)
{
	return texel(leaf_texels, n);
}
#endif

#ifdef READ_LEAF_QUADS
TEXELS(GI_BIND_LEAF_QUADS) leaf_quad_texels;
vec4 load_leaf_corner(uint n, uint corner)
{
	return float_texel(leaf_quad_texels, 4u * n + corner);
}

float load_area_up_to(uint n)
{
	return load_leaf_corner(n, 0u).w;
}
#endif

#ifdef READ_MATERIALS
TEXELS(GI_BIND_MATERIALS) material_texels;
gi_material_data load_material(uint n)
{
	return gi_material_data(float_texel(material_texels, 2u * n), float_texel(material_texels, 2u * n + 1u));
}
#endif

#ifdef READ_BVH
TEXELS(GI_BIND_BVH) bvh_texels;
#endif

#ifdef READ_PRIMITIVES
TEXELS(GI_BIND_PRIMITIVES) primitive_texels;
gi_primitive load_primitive(uint n)
{
	return gi_primitive(float_texel(primitive_texels, 4u * n), float_texel(primitive_texels, 4u * n + 1u),
			    float_texel(primitive_texels, 4u * n + 2u), float_texel(primitive_texels, 4u * n + 3u));
}
#endif

#ifdef READ_TLAS
TEXELS(GI_BIND_TLAS) tlas_texels;
#endif

#ifdef READ_SEGMENTS
TEXELS(GI_BIND_SEGMENTS) segment_texels;
uvec4 load_segment(uint n)
{
	return texel(segment_texels, n);
}
#endif

#ifdef READ_ENTRIES
TEXELS(GI_BIND_ENTRIES) entry_texels;
uvec4 load_entry(uint n)
{
	return texel(entry_texels, n);
}
#endif

#ifdef READ_TARGETS
TEXELS(GI_BIND_TARGETS) target_texels;
uint load_target(uint n)
{
	return word(target_texels, n);
}
#endif

#ifdef READ_QUEUE
TEXELS(GI_BIND_QUEUE) queue_texels;
uint load_queued(uint n)
{
	return word(queue_texels, n);
}
#endif

#ifdef READ_ROWS
TEXELS(GI_BIND_ROWS) row_texels;
uvec4 load_row(uint n)
{
	return texel(row_texels, n);
}
#endif

#ifdef READ_LINKS
TEXELS(GI_BIND_LINKS) link_texels;
// Links 2 n and 2 n + 1: node and weight bits, twice. Blocks begin at multiples of four, and behind an odd last link is
// one of weight 0.
uvec4 load_two_links(uint n)
{
	return texel(link_texels, n);
}
#endif

#ifdef READ_RADIOSITY
TEXELS(GI_BIND_RADIOSITY) radiosity_texels;
vec4 load_radiosity(uint n)
{
	return float_texel(radiosity_texels, n);
}
#endif

#ifdef READ_LEAF_RADIOSITY
TEXELS(GI_BIND_LEAF_RADIOSITY) leaf_radiosity_texels;
vec4 load_leaf_radiosity(uint n)
{
	return float_texel(leaf_radiosity_texels, n);
}

#ifdef READ_FRAME
vec4 load_leaf_part(uint part, uint leaf)
{
	return load_leaf_radiosity(part * frame.counts.x + leaf);
}
#endif
#endif

#ifdef READ_NODE_EXITANCE
TEXELS(GI_BIND_NODE_EXITANCE) exitance_texels;
vec4 load_exitance(uint n)
{
	return float_texel(exitance_texels, n);
}
#endif

#ifdef READ_STATE
layout(std140, binding = GI_UNIFORM_STATE) uniform state_before_block { gi_state state_before; };
#endif

#ifdef READ_RUNS
TEXELS(GI_BIND_RUNS) run_texels;
uvec4 load_run(uint n)
{
	return texel(run_texels, n);
}
#endif

#ifdef READ_SUSPECTS
TEXELS(GI_BIND_SUSPECTS) suspect_texels;
uint load_suspect(uint n)
{
	return word(suspect_texels, n);
}

// Of what the k-th mover swept: the update that saw it, its slot and whether it was elsewhere; corners of the box of
// where it was, 0 and 1, and of that and where it is, 2 and 3.
uvec4 load_swept_change(uint k)
{
	return texel(suspect_texels, frame.swept.x + GI_SWEPT_PARTS * k);
}

vec4 load_swept_corner(uint k, uint corner)
{
	return float_texel(suspect_texels, frame.swept.x + GI_SWEPT_PARTS * k + 1u + corner);
}
#endif

#ifdef READ_WIDE_NODES
TEXELS(GI_BIND_WIDE_NODES) wide_node_texels;
uint load_wide_node(uint n)
{
	return word(wide_node_texels, n);
}
#endif

#ifdef READ_LEAF_INDIRECT
TEXELS(GI_BIND_LEAF_INDIRECT) leaf_indirect_texels;
vec4 load_leaf_indirect(uint n)
{
	return float_texel(leaf_indirect_texels, n);
}
#endif

#ifdef READ_LIGHT_LINKS
TEXELS(GI_BIND_LIGHT_LINKS) light_link_texels;
uvec2 load_light_link(uint n)
{
	return half_texel(light_link_texels, n);
}
#endif

#ifdef READ_LIGHT_FIRST
TEXELS(GI_BIND_LIGHT_FIRST) light_first_texels;
uint load_light_first(uint n)
{
	return word(light_first_texels, n);
}
#endif

#ifdef READ_LIGHT
TEXELS(GI_BIND_LIGHT) light_texels;
vec4 load_light(uint n)
{
	return float_texel(light_texels, n);
}
#endif

#ifdef READ_TOUCHED
TEXELS(GI_BIND_TOUCHED) touched_texels;
uint load_touched(uint n)
{
	return word(touched_texels, n);
}
#endif

#ifdef READ_CHOICES
TEXELS(GI_BIND_CHOICES) choice_texels;
uint load_choice(uint n)
{
	return word(choice_texels, n);
}
#endif

#ifdef READ_PENDING
TEXELS(GI_BIND_PENDING) pending_texels;
gi_pending load_pending(uint n)
{
	return gi_pending(texel(pending_texels, 3u * n), float_texel(pending_texels, 3u * n + 1u),
			  float_texel(pending_texels, 3u * n + 2u));
}
#endif

#ifdef READ_SHINE
TEXELS(GI_BIND_SHINE) shine_texels;
uint load_shine(uint n)
{
	return word(shine_texels, n);
}
#endif

#ifdef READ_ESTIMATE_ITEMS
TEXELS(GI_BIND_ESTIMATE_ITEMS) item_texels;
uvec4 load_item(uint n)
{
	return texel(item_texels, n);
}
#endif

#ifdef READ_ESTIMATE_SHARES
TEXELS(GI_BIND_ESTIMATE_SHARES) share_texels;
float load_share(uint n)
{
	return uintBitsToFloat(word(share_texels, n));
}
#endif

#ifdef READ_ESTIMATE_CHANCES
TEXELS(GI_BIND_ESTIMATE_CHANCES) chance_texels;
vec2 load_chance(uint n)
{
	return uintBitsToFloat(half_texel(chance_texels, n));
}
#endif

#ifdef READ_ESTIMATE_RESULTS
TEXELS(GI_BIND_ESTIMATE_RESULTS) result_texels;
gi_estimate_leaf load_result(uint n)
{
	return gi_estimate_leaf(float_texel(result_texels, 3u * n), float_texel(result_texels, 3u * n + 1u),
				float_texel(result_texels, 3u * n + 2u));
}
#endif

#ifdef READ_PATH_LIGHTS
TEXELS(GI_BIND_PATH_LIGHTS) path_light_texels;
uvec4 load_light_triangle(uint n)
{
	return texel(path_light_texels, n);
}
#endif

#ifdef READ_PATH_SOBOL
TEXELS(GI_BIND_PATH_SOBOL) sobol_texels;
uint load_sobol(uint n)
{
	return word(sobol_texels, n);
}
#endif

#ifdef READ_SMOOTH
TEXELS(GI_BIND_SMOOTH) smooth_texels;
uvec4 load_smooth_normals(uint n)
{
	return texel(smooth_texels, n);
}

TEXELS(GI_BIND_SMOOTH_MATERIALS) smooth_material_texels;
gi_smooth_material load_smooth_material(uint n)
{
	return gi_smooth_material(float_texel(smooth_material_texels, 2u * n),
				  float_texel(smooth_material_texels, 2u * n + 1u));
}
#endif

#ifdef READ_CORNER_LIGHTS
TEXELS(GI_BIND_CORNER_LIGHTS) corner_light_texels;
uvec4 load_corner_lights(uint n)
{
	return texel(corner_light_texels, n);
}
#endif

#ifdef READ_PHOTONS
TEXELS(GI_BIND_PHOTONS) photon_texels;
gi_photon load_photon(uint n)
{
	return gi_photon(float_texel(photon_texels, 2u * n), float_texel(photon_texels, 2u * n + 1u));
}
#endif

#ifdef READ_CAUSTIC_PAIRS
TEXELS(GI_BIND_CAUSTIC_PAIRS) caustic_pair_texels;
gi_caustic_pair load_caustic_pair(uint n)
{
	return gi_caustic_pair(float_texel(caustic_pair_texels, 3u * n), float_texel(caustic_pair_texels, 3u * n + 1u),
			       texel(caustic_pair_texels, 3u * n + 2u));
}
#endif

#ifdef READ_CAUSTIC_PATHS
TEXELS(GI_BIND_CAUSTIC_PATHS) caustic_path_texels;
// Of a pair, how many there are.
uint load_packets(uint pair)
{
	return word(caustic_path_texels, GI_CAUSTIC_PATH_WORDS * pair + GI_CAUSTIC_NOW);
}
#endif

#ifdef READ_CAUSTIC_LIGHT
TEXELS(GI_BIND_CAUSTIC_LIGHT) caustic_light_texels;
vec4 load_caustic_light(uint n)
{
	return float_texel(caustic_light_texels, n);
}
#endif

#ifdef READ_CAUSTIC_CELLS
TEXELS(GI_BIND_CAUSTIC_CELLS) caustic_cell_texels;
uint load_caustic_cell(uint n)
{
	return word(caustic_cell_texels, n);
}
#endif

#ifdef READ_OLD_SEGMENTS
TEXELS(GI_BIND_OLD_SEGMENTS) old_segment_texels;
uvec4 load_old_segment(uint n)
{
	return texel(old_segment_texels, n);
}
#endif

#ifdef READ_OLD_ROWS
TEXELS(GI_BIND_OLD_ROWS) old_row_texels;
uvec4 load_old_row(uint n)
{
	return texel(old_row_texels, n);
}
#endif

#ifdef READ_MOVES
TEXELS(GI_BIND_MOVES) move_texels;
gi_move load_move(uint n)
{
	return gi_move(texel(move_texels, 2u * n), texel(move_texels, 2u * n + 1u));
}
#endif

#ifdef READ_LOANS
TEXELS(GI_BIND_LOANS) loan_texels;
uvec2 load_loan(uint n)
{
	uvec4 two = texel(loan_texels, n / 2u);
	return (n & 1u) == 0u ? two.xy : two.zw;
}
#endif

#ifdef READ_NODE_MOVES
TEXELS(GI_BIND_NODE_MOVES) node_move_texels;
uint load_node_move(uint n)
{
	return word(node_move_texels, n);
}
#endif

// ---- writes ----

#ifdef WRITE_WORLD
STORAGE(GI_BIND_WORLD) world_block { gi_node_geometry world[]; };
#endif
#ifdef WRITE_VERTICES_WORLD
STORAGE(GI_BIND_VERTICES_WORLD) vertices_world_block { vec4 vertices_world[]; };
#endif
#ifdef WRITE_SEGMENTS
STORAGE(GI_BIND_SEGMENTS) segments_block { uvec4 segments[]; };
#endif
#ifdef WRITE_ENTRIES
STORAGE(GI_BIND_ENTRIES) entries_block { uvec4 entries[]; };
#endif
#ifdef WRITE_TARGETS
STORAGE(GI_BIND_TARGETS) targets_block { uint targets[]; };
#endif
#ifdef WRITE_ENTRY_POOL
STORAGE(GI_BIND_ENTRY_POOL) entry_pool_block { uint entry_pool[]; };
#endif
#ifdef WRITE_QUEUE
STORAGE(GI_BIND_QUEUE) queue_block { uint queue[]; };
#endif
#ifdef WRITE_ROWS
STORAGE(GI_BIND_ROWS) rows_block { uvec4 rows[]; };
#endif
#ifdef WRITE_LINKS
STORAGE(GI_BIND_LINKS) links_block { uvec2 links[]; };
#endif
#ifdef WRITE_LINK_POOL
STORAGE(GI_BIND_LINK_POOL) link_pool_block { uint link_pool[]; };
#endif
#ifdef WRITE_RADIOSITY
STORAGE(GI_BIND_RADIOSITY) radiosity_block { vec4 radiosity[]; };
#endif
#ifdef WRITE_LEAF_RADIOSITY
STORAGE(GI_BIND_LEAF_RADIOSITY) leaf_radiosity_block { vec4 leaf_radiosity[]; };
#endif
#ifdef WRITE_STATE
STORAGE(GI_BIND_STATE) state_block { gi_state state; };
#endif
#ifdef WRITE_LEAF_INDIRECT
STORAGE(GI_BIND_LEAF_INDIRECT) leaf_indirect_block { vec4 leaf_indirect[]; };
#endif
#ifdef WRITE_LIGHT
STORAGE(GI_BIND_LIGHT) light_block { vec4 light[]; };
#endif
#ifdef WRITE_TOUCHED
STORAGE(GI_BIND_TOUCHED) touched_block { uint touched[]; };
#endif
#ifdef WRITE_CHOICES
STORAGE(GI_BIND_CHOICES) choices_block { uint choices[]; };
#endif
#ifdef WRITE_PENDING
STORAGE(GI_BIND_PENDING) pending_block { gi_pending pending[]; };
#endif
#ifdef WRITE_SHINE
STORAGE(GI_BIND_SHINE) shine_block { uint shine[]; };
#endif
#ifdef WRITE_ESTIMATE_ITEMS
STORAGE(GI_BIND_ESTIMATE_ITEMS) estimate_items_block { uvec4 items[]; };
#endif
#ifdef WRITE_ESTIMATE_SHARES
STORAGE(GI_BIND_ESTIMATE_SHARES) estimate_shares_block { float shares[]; };
#endif
#ifdef WRITE_ESTIMATE_RESULTS
STORAGE(GI_BIND_ESTIMATE_RESULTS) estimate_results_block { gi_estimate_leaf results[]; };
#endif
#ifdef WRITE_PATH_SLOTS
STORAGE(GI_BIND_PATH_SLOTS) path_slots_block { gi_path_slot slots[]; };
#endif

#ifdef WRITE_PHOTONS
STORAGE(GI_BIND_PHOTONS) photons_block { gi_photon photons[]; };
#endif
#ifdef WRITE_CAUSTIC_PATHS
STORAGE(GI_BIND_CAUSTIC_PATHS) caustic_paths_block { uint caustic_paths[]; };
#endif
#ifdef WRITE_CAUSTIC_SUMS
STORAGE(GI_BIND_CAUSTIC_SUMS) caustic_sums_block { uint caustic_sums[]; };
#endif
#ifdef WRITE_CAUSTIC_LIGHT
STORAGE(GI_BIND_CAUSTIC_LIGHT) caustic_light_block { vec4 caustic_light[]; };
#endif
#ifdef WRITE_CAUSTIC_CELLS
STORAGE(GI_BIND_CAUSTIC_CELLS) caustic_cells_block { uint caustic_cells[]; };
#endif

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
