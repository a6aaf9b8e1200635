#version 450 core
// What light there is before the solve. Of each object's leaves the largest B, that of those that emit nothing, the
// least; and the same of the whole scene, the sky's among it. One group an object.
#define READ_FRAME
#define READ_OBJECTS
#define READ_TOPOLOGY
#define READ_LEAVES
#define READ_RADIOSITY
#define READ_LEAF_RADIOSITY
#define WRITE_LIGHT_BOUNDS
#include "buffers.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

shared uint found[GI_LIGHT_BOUND_WORDS];

struct extremes {
	vec3 all, others, least;
};

void include(inout extremes e, vec3 b, bool emitter)
{
	e = extremes(max(e.all, b), max(e.others, emitter ? vec3(0.0) : b), min(e.least, b));
}

// Floats >= 0 order as their bits do.
void share(extremes e)
{
	for (uint c = 0u; c < 3u; c++) {
		atomicMax(found[GI_LIGHT_BOUND_ALL + c], floatBitsToUint(e.all[c]));
		atomicMax(found[GI_LIGHT_BOUND_OTHERS + c], floatBitsToUint(e.others[c]));
		atomicMax(found[GI_LIGHT_BOUND_LEAST + c], ~floatBitsToUint(e.least[c]));
	}
}

void main()
{
	uint local = gl_LocalInvocationID.x, object = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
	bool there = object < frame.counts.z;
	uvec4 nodes = there ? object_nodes(object) : uvec4(0u);
	if (local < GI_LIGHT_BOUND_WORDS)
		found[local] = 0u;
	barrier();
	extremes e = extremes(vec3(0.0), vec3(0.0), vec3(3e38));
	for (uint leaf = nodes.z + local; leaf < nodes.w; leaf += GI_GROUP_SIZE)
		include(e, load_leaf_radiosity(leaf).xyz,
			(topology_range(load_leaf(leaf).x).w & GI_NODE_EMITTER) != 0u);
	bool sky = there && (object_bvh(object).z & GI_OBJECT_SKY) != 0u;
	for (uint node = nodes.x + local; sky && node < nodes.y; node += GI_GROUP_SIZE)
		include(e, load_radiosity(node).xyz, false);
	if (there)
		share(e);
	barrier();
	if (there && local < GI_LIGHT_BOUND_WORDS) {
		light_bounds[GI_LIGHT_BOUND_WORDS * object + local] = found[local];
		atomicMax(light_bounds[GI_LIGHT_BOUND_WORDS * frame.counts.z + local], found[local]);
	}
}
