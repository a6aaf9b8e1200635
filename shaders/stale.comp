#version 450 core
// After the solve under a budget: what B may be off by since rows wait. STAGE 0: how far B went from what the bounds
// were made with; STAGE 1: the bounds d at the solution of the rows, each entry's B taken that much brighter and by the
// solve's own bound. One thread a leaf.
//
// No row sums to more than 1, so the leaf whose solution is off most, by e, has e <= d + rho e: e <= max d / (1 - rho).
// Where some may (frame.statics), e = M^-1 d <= max d * max M^-1 1, which the ceiling of v bounds.
#define READ_FRAME
#define READ_LEAVES
#define READ_MATERIALS
#define READ_LEAF_RADIOSITY
#define READ_PENDING
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint stage;

// More than the rounding of sums of a row's entries.
const float OUTWARD = 1.0001;

const float MOST = 3e38;

float largest(vec3 v)
{
	return max(v.x, max(v.y, v.z));
}

void main()
{
	uint leaf = thread_number();
	if (leaf >= frame.counts.x)
		return;
	gi_pending row = load_pending(leaf);
	if (stage == 0u) {
		float went = largest(abs(load_leaf_radiosity(leaf).xyz - row.before.xyz));
		atomicMax(state.budget.step_bits, floatBitsToUint(OUTWARD * went));
	} else if (row.key.z > 0u) {
		// A share of weight leaves one place and comes to another.
		float rho = largest(load_material(load_leaf(leaf).z).rho.xyz);
		float went = uintBitsToFloat(state.budget.step_bits) + state.solve.bound;
		float more = (frame.statics.z != 0u ? 4.0 : 2.0) * row.bound.w * went * rho;
		float off = OUTWARD * (largest(row.bound.xyz) + more);
		float most = frame.statics.z != 0u ? min(off * min(frame.ceiling.w, MOST), MOST) : off / (1.0 - rho);
		atomicMax(state.counts.stale_bits, floatBitsToUint(most));
	}
}
