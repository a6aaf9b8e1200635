#version 450 core
// Ends the solve when the certified bound |B - B*| <= |r| q / (1 - q) (Banach; r = B_k+1 - B_k) meets the tolerance, by
// setting the group counts of the sweeps still queued to zero: the frame never waits for a read-back. INITIALISE sets
// them up.
#define USE_FRAME
#define USE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = 1) in;
layout(location = 0) uniform uint initialise;

void start()
{
	state[GI_STATE_SWEEPS] = 0u;
	state[GI_STATE_ACTIVE] = 1u;
	set_groups(GI_STATE_ARGS_GATHER, groups_for(frame.counts.x));
	set_groups(GI_STATE_ARGS_PULL, groups_for(frame.counts.y));
	set_groups(GI_STATE_ARGS_WIDE, frame.misc.y);
	set_groups(GI_STATE_ARGS_CHECK, 1u);
}

void stop()
{
	state[GI_STATE_ACTIVE] = 0u;
	state[GI_STATE_ARGS_GATHER] = 0u;
	state[GI_STATE_ARGS_PULL] = 0u;
	state[GI_STATE_ARGS_WIDE] = 0u;
	state[GI_STATE_ARGS_CHECK] = 0u;
}

void main()
{
	if (initialise != 0u) {
		start();
		// Which rows did not fit is chance: B waits for the larger pool, and stays what it was.
		if (state[GI_STATE_OVERFLOW] != 0u)
			stop();
	} else {
		float bound = 0.0, relative = 0.0, residual = 0.0, q_max = 0.0, b_max = 0.0;
		for (uint c = 0u; c < 3u; c++) {
			float r = uintBitsToFloat(state[GI_STATE_RESIDUAL_BITS + c]);
			float q = uintBitsToFloat(state[GI_STATE_Q_BITS + c]);
			residual = max(residual, r);
			q_max = max(q_max, q);
			b_max = max(b_max, uintBitsToFloat(state[GI_STATE_B_MAX_BITS + c]));
			bound = max(bound, q < 1.0 ? r * q / (1.0 - q) : 3e38);
		}
		state[GI_STATE_SWEEPS] += 1u;
		state[GI_STATE_BOUND_BITS] = floatBitsToUint(bound);
		state[GI_STATE_BOUND_RELATIVE_BITS] = floatBitsToUint(b_max > 0.0 ? bound / b_max : 0.0);
		state[GI_STATE_DONE_RESIDUAL_BITS] = floatBitsToUint(residual);
		state[GI_STATE_DONE_Q_BITS] = floatBitsToUint(q_max);
		state[GI_STATE_DONE_B_MAX_BITS] = floatBitsToUint(b_max);
		if (bound <= frame.tolerance.w * b_max)
			stop();
	}
	for (uint k = 0u; k < 9u; k++)
		state[GI_STATE_RESIDUAL_BITS + k] = 0u;
}
