#version 450 core
// One Jacobi sweep, the gather: B_i = E_i + rho_i * sum over links of weight * B_node. One thread a leaf.
#define USE_FRAME
#define USE_LEAVES
#define USE_MATERIALS
#define USE_ROWS
#define USE_LINKS
#define USE_RADIOSITY
#define USE_LEAF_RADIOSITY
#define USE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

shared uint group_residual[3];
shared uint group_q[3];
shared uint group_max[3];

// Largest values of the group into the state; floats >= 0 order as their bits do, so the result has no order.
void reduce_max(vec3 step_size, vec3 q, vec3 b)
{
	for (int c = 0; c < 3; c++) {
		atomicMax(group_residual[c], floatBitsToUint(step_size[c]));
		atomicMax(group_q[c], floatBitsToUint(q[c]));
		atomicMax(group_max[c], floatBitsToUint(b[c]));
	}
}

void main()
{
	uint local = gl_LocalInvocationID.x;
	if (local < 3u) {
		group_residual[local] = 0u;
		group_q[local] = 0u;
		group_max[local] = 0u;
	}
	barrier();
	uint leaf = thread_number();
	if (leaf < frame.counts.x) {
		uvec4 row = rows[leaf];
		uint end = row.x + (row.y & GI_BLOCK_COUNT_MASK);
		vec3 h = vec3(0.0);
		for (uint k = row.x; k < end; k++) {
			uvec2 link = links[k];
			h += uintBitsToFloat(link.y) * radiosity[link.x].xyz;
		}
		gi_material_data m = materials[leaves[leaf].z];
		vec3 b = m.exitance.xyz + m.rho.xyz * h;
		vec3 step_size = abs(b - leaf_radiosity[leaf].xyz);
		if (any(isnan(b)) || any(isinf(b))) {
			atomicOr(state[GI_STATE_NOT_FINITE], 1u);
			b = m.exitance.xyz;
			step_size = vec3(0.0);
		}
		leaf_radiosity[leaf] = vec4(b, max(step_size.x, max(step_size.y, step_size.z)));
		reduce_max(step_size, m.rho.xyz * uintBitsToFloat(row.w), b);
	}
	barrier();
	if (local < 3u) {
		atomicMax(state[GI_STATE_RESIDUAL_BITS + local], group_residual[local]);
		atomicMax(state[GI_STATE_Q_BITS + local], group_q[local]);
		atomicMax(state[GI_STATE_B_MAX_BITS + local], group_max[local]);
	}
}
