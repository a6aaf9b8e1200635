// The storage blocks of gi, by the binding numbers of gi_shared.h. A shader defines USE_name for those it wants before
// it includes this file: OpenGL counts every declared block, and promises only 16 a stage.
#include "gi_shared.h"

#ifdef USE_FRAME
layout(std430, binding = GI_BIND_FRAME) restrict readonly buffer frame_block { gi_frame frame; };
#endif
#ifdef USE_OBJECTS
layout(std430, binding = GI_BIND_OBJECTS) restrict readonly buffer object_block { gi_object_data objects[]; };
#endif
#ifdef USE_TOPOLOGY
layout(std430, binding = GI_BIND_TOPOLOGY) restrict readonly buffer topology_block { gi_node_topology topology[]; };
#endif
#ifdef USE_REST
layout(std430, binding = GI_BIND_REST) restrict readonly buffer rest_block { gi_node_geometry rest[]; };
#endif
#ifdef USE_WORLD
layout(std430, binding = GI_BIND_WORLD) restrict buffer world_block { gi_node_geometry world[]; };
#endif
#ifdef USE_SPREAD
layout(std430, binding = GI_BIND_SPREAD) restrict readonly buffer spread_block { gi_node_spread spread[]; };
#endif
#ifdef USE_VERTICES_REST
layout(std430, binding = GI_BIND_VERTICES_REST) restrict readonly buffer vertices_rest_block { vec4 vertices_rest[]; };
#endif
#ifdef USE_VERTICES_WORLD
layout(std430, binding = GI_BIND_VERTICES_WORLD) restrict buffer vertices_world_block { vec4 vertices_world[]; };
#endif
#ifdef USE_LEAVES
layout(std430, binding = GI_BIND_LEAVES) restrict readonly buffer leaf_block { uvec4 leaves[]; };
#endif
#ifdef USE_MATERIALS
layout(std430, binding = GI_BIND_MATERIALS) restrict readonly buffer material_block { gi_material_data materials[]; };
#endif
#ifdef USE_BVH
layout(std430, binding = GI_BIND_BVH) restrict readonly buffer bvh_block { uvec4 bvh[]; };
#endif
#ifdef USE_PRIMITIVES
layout(std430, binding = GI_BIND_PRIMITIVES) restrict readonly buffer primitive_block { gi_primitive primitives[]; };
#endif
#ifdef USE_TLAS
layout(std430, binding = GI_BIND_TLAS) restrict readonly buffer tlas_block { uvec4 tlas[]; };
#endif
#ifdef USE_SEGMENTS
layout(std430, binding = GI_BIND_SEGMENTS) restrict buffer segment_block { uvec4 segments[]; };
#endif
#ifdef USE_ENTRIES
layout(std430, binding = GI_BIND_ENTRIES) restrict buffer entry_block { uvec4 entries[]; };
#endif
#ifdef USE_TARGETS
layout(std430, binding = GI_BIND_TARGETS) restrict buffer target_block { uint targets[]; };
#endif
#ifdef USE_ENTRY_POOL
layout(std430, binding = GI_BIND_ENTRY_POOL) restrict buffer entry_pool_block { uint entry_pool[]; };
#endif
#ifdef USE_QUEUE
layout(std430, binding = GI_BIND_QUEUE) restrict buffer queue_block { uint queue[]; };
#endif
#ifdef USE_ROWS
layout(std430, binding = GI_BIND_ROWS) restrict buffer row_block { uvec4 rows[]; };
#endif
#ifdef USE_LINKS
layout(std430, binding = GI_BIND_LINKS) restrict buffer link_block { uvec2 links[]; };
#endif
#ifdef USE_LINK_POOL
layout(std430, binding = GI_BIND_LINK_POOL) restrict buffer link_pool_block { uint link_pool[]; };
#endif
#ifdef USE_RADIOSITY
layout(std430, binding = GI_BIND_RADIOSITY) restrict buffer radiosity_block { vec4 radiosity[]; };
#endif
#ifdef USE_LEAF_RADIOSITY
layout(std430, binding = GI_BIND_LEAF_RADIOSITY) restrict buffer leaf_radiosity_block { vec4 leaf_radiosity[]; };
#endif
#ifdef USE_NODE_EXITANCE
layout(std430, binding = GI_BIND_NODE_EXITANCE) restrict readonly buffer node_exitance_block { vec4 node_exitance[]; };
#endif
#ifdef USE_STATE
layout(std430, binding = GI_BIND_STATE) restrict buffer state_block { uint state[]; };
#endif
#ifdef USE_RUNS
layout(std430, binding = GI_BIND_RUNS) restrict readonly buffer run_block { uvec4 runs[]; };
#endif
#ifdef USE_SUSPECTS
layout(std430, binding = GI_BIND_SUSPECTS) restrict readonly buffer suspect_block { uint suspects[]; };
#endif
#ifdef USE_WIDE_NODES
layout(std430, binding = GI_BIND_WIDE_NODES) restrict readonly buffer wide_block { uint wide_nodes[]; };
#endif
#ifdef USE_LEAF_INDIRECT
layout(std430, binding = GI_BIND_LEAF_INDIRECT) restrict buffer leaf_indirect_block { vec4 leaf_indirect[]; };
#endif
#ifdef USE_LIGHT_LINKS
layout(std430, binding = GI_BIND_LIGHT_LINKS) restrict readonly buffer light_link_block { uvec2 light_links[]; };
#endif
#ifdef USE_LIGHT_FIRST
layout(std430, binding = GI_BIND_LIGHT_FIRST) restrict readonly buffer light_first_block { uint light_first[]; };
#endif
#ifdef USE_TOUCHED
layout(std430, binding = GI_BIND_TOUCHED) restrict buffer touched_block { uint touched[]; };
#endif
#ifdef USE_ESTIMATE_ITEMS
layout(std430, binding = GI_BIND_ESTIMATE_ITEMS) restrict buffer estimate_item_block { uvec4 items[]; };
#endif
#ifdef USE_ESTIMATE_SHARES
layout(std430, binding = GI_BIND_ESTIMATE_SHARES) restrict buffer estimate_share_block { float shares[]; };
#endif
#ifdef USE_ESTIMATE_CHANCES
layout(std430, binding = GI_BIND_ESTIMATE_CHANCES) restrict readonly buffer estimate_chance_block { vec2 chances[]; };
#endif
#ifdef USE_ESTIMATE_RESULTS
layout(std430, binding = GI_BIND_ESTIMATE_RESULTS) restrict buffer estimate_result_block { gi_estimate_leaf results[]; };
#endif
#ifdef USE_LIGHT
layout(std430, binding = GI_BIND_LIGHT) restrict buffer light_block { vec4 light[]; };
#endif

#ifdef USE_CHOICES
layout(std430, binding = GI_BIND_CHOICES) restrict buffer choice_block { uint choices[]; };
#endif
#ifdef USE_PENDING
layout(std430, binding = GI_BIND_PENDING) restrict buffer pending_block { gi_pending pending[]; };
#endif
#ifdef USE_SHINE
layout(std430, binding = GI_BIND_SHINE) restrict buffer shine_block { uint shine[]; };
#endif

#ifdef USE_OBJECTS
vec3 world_from_rest(uint object, vec3 p)
{
	vec4 q = vec4(p, 1.0);
	return vec3(dot(objects[object].row0, q), dot(objects[object].row1, q), dot(objects[object].row2, q));
}

// The rotation's inverse is its transpose.
vec3 rest_from_world(uint object, vec3 p)
{
	vec4 a = objects[object].row0, b = objects[object].row1, c = objects[object].row2;
	vec3 q = p - vec3(a.w, b.w, c.w);
	return a.xyz * q.x + b.xyz * q.y + c.xyz * q.z;
}

vec3 rest_direction_from_world(uint object, vec3 d)
{
	return objects[object].row0.xyz * d.x + objects[object].row1.xyz * d.y + objects[object].row2.xyz * d.z;
}

vec3 world_direction_from_rest(uint object, vec3 d)
{
	return vec3(dot(objects[object].row0.xyz, d), dot(objects[object].row1.xyz, d), dot(objects[object].row2.xyz, d));
}
#endif
