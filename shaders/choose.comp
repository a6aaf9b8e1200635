#version 450 core
// Under a budget: the lowest bucket that is still refreshed. STAGE 0: one group adds up the rays from the top bucket
// on; the first bucket that holds any is always taken, so every update gets on. STAGE 1: group counts for the rows
// that enlist.comp listed.
#define READ_FRAME
#define READ_CHOICES
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint stage;

const uint SHARE = GI_BUCKETS / GI_GROUP_SIZE;

shared uint rays_of[GI_GROUP_SIZE];

uint threshold(uint budget)
{
	uint sum = 0u, lowest = GI_BUCKETS;
	for (uint group = GI_GROUP_SIZE; group-- > 0u;) {
		if (rays_of[group] == 0u)
			continue;
		if (sum + rays_of[group] <= budget) {
			sum += rays_of[group];
			lowest = group * SHARE;
			continue;
		}
		for (uint k = (group + 1u) * SHARE; k-- > group * SHARE;) {
			if (sum > 0u && sum + load_choice(k) > budget)
				return k + 1u;
			sum += load_choice(k);
		}
		return group * SHARE;
	}
	return lowest;
}

void main()
{
	uint local = gl_LocalInvocationID.x;
	if (stage == 1u) {
		if (local == 0u) {
			set_groups(GI_STATE_ARGS_CHOSEN, groups_for(state[GI_STATE_CHOSEN]));
			set_groups(GI_STATE_ARGS_PAIRS, groups_for(state[GI_STATE_CHOSEN] * frame.counts.z));
		}
		return;
	}
	uint sum = 0u;
	for (uint k = 0u; k < SHARE; k++)
		sum += load_choice(local * SHARE + k);
	rays_of[local] = sum;
	barrier();
	if (local == 0u)
		state[GI_STATE_THRESHOLD] = max(threshold(uint(min(frame.limit.x, 4e9))), 1u);
}
