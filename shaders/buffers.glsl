// The storage blocks of gi, by the binding numbers of gi_shared.h. A shader uses a few; the linker drops the rest.
#include "gi_shared.h"

layout(std430, binding = GI_BIND_FRAME) restrict readonly buffer frame_block { gi_frame frame; };
layout(std430, binding = GI_BIND_OBJECTS) restrict readonly buffer object_block { gi_object_data objects[]; };
layout(std430, binding = GI_BIND_TOPOLOGY) restrict readonly buffer topology_block { gi_node_topology topology[]; };
layout(std430, binding = GI_BIND_REST) restrict readonly buffer rest_block { gi_node_geometry rest[]; };
layout(std430, binding = GI_BIND_WORLD) restrict buffer world_block { gi_node_geometry world[]; };
layout(std430, binding = GI_BIND_VERTICES_REST) restrict readonly buffer vertices_rest_block { vec4 vertices_rest[]; };
layout(std430, binding = GI_BIND_VERTICES_WORLD) restrict buffer vertices_world_block { vec4 vertices_world[]; };
layout(std430, binding = GI_BIND_LEAVES) restrict readonly buffer leaf_block { uvec4 leaves[]; };
layout(std430, binding = GI_BIND_MATERIALS) restrict readonly buffer material_block { gi_material_data materials[]; };
layout(std430, binding = GI_BIND_BVH) restrict readonly buffer bvh_block { gi_bvh_node bvh[]; };
layout(std430, binding = GI_BIND_PRIMITIVES) restrict readonly buffer primitive_block { gi_primitive primitives[]; };
layout(std430, binding = GI_BIND_TLAS) restrict readonly buffer tlas_block { gi_bvh_node tlas[]; };
layout(std430, binding = GI_BIND_SEGMENTS) restrict buffer segment_block { uvec2 segments[]; };
layout(std430, binding = GI_BIND_ENTRIES) restrict buffer entry_block { uvec4 entries[]; };
layout(std430, binding = GI_BIND_ENTRY_POOL) restrict buffer entry_pool_block { uint entry_pool[]; };
layout(std430, binding = GI_BIND_QUEUE) restrict buffer queue_block { uint queue[]; };
layout(std430, binding = GI_BIND_ROWS) restrict buffer row_block { uvec4 rows[]; };
layout(std430, binding = GI_BIND_LINKS) restrict buffer link_block { uvec2 links[]; };
layout(std430, binding = GI_BIND_LINK_POOL) restrict buffer link_pool_block { uint link_pool[]; };
layout(std430, binding = GI_BIND_RADIOSITY) restrict buffer radiosity_block { vec4 radiosity[]; };
layout(std430, binding = GI_BIND_LEAF_RADIOSITY) restrict buffer leaf_radiosity_block { vec4 leaf_radiosity[]; };
layout(std430, binding = GI_BIND_NODE_EXITANCE) restrict readonly buffer node_exitance_block { vec4 node_exitance[]; };
layout(std430, binding = GI_BIND_STATE) restrict buffer state_block { uint state[]; };
layout(std430, binding = GI_BIND_RUNS) restrict readonly buffer run_block { uvec4 runs[]; };
layout(std430, binding = GI_BIND_SUSPECTS) restrict readonly buffer suspect_block { uint suspects[]; };
layout(std430, binding = GI_BIND_WIDE_NODES) restrict readonly buffer wide_block { uint wide_nodes[]; };
layout(std430, binding = GI_BIND_LEAF_INDIRECT) restrict buffer leaf_indirect_block { vec4 leaf_indirect[]; };
layout(std430, binding = GI_BIND_LIGHT_LINKS) restrict readonly buffer light_link_block { uvec2 light_links[]; };
layout(std430, binding = GI_BIND_LIGHT_FIRST) restrict readonly buffer light_first_block { uint light_first[]; };
layout(std430, binding = GI_BIND_TOUCHED) restrict buffer touched_block { uint touched[]; };
layout(std430, binding = GI_BIND_LIGHT) restrict buffer light_block { vec4 light[]; };

// Dispatches of many groups are folded into y: OpenGL promises only 65,535 groups in x.
uint thread_number()
{
	return (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
}

// The run that thread `t` is in: the last one in runs[first, first + count) that begins at or before t.
uvec4 find_run(uint first, uint count, uint t)
{
	uint low = first, high = first + count;
	while (high - low > 1u) {
		uint middle = (low + high) >> 1u;
		if (runs[middle].x <= t)
			low = middle;
		else
			high = middle;
	}
	return runs[low];
}

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
