#version 450 core
// Under a budget: lists rows. STAGE 0: those to assess; 1: those to refresh, and counts those that wait. One thread a
// leaf. Whichever order a list comes in, the rows are the same.
#define READ_FRAME
#define READ_PENDING
#define WRITE_CHOICES
#define WRITE_PENDING
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint stage;

// Given time, an update takes no bucket that holds more than fits, only some of its rows.
bool fits(uint rays)
{
	if ((frame.update.w & GI_UPDATE_TIMED) == 0u)
		return true;
	uint before = atomicAdd(state.refresh.chosen_rays, rays);
	return before == 0u || float(before) + float(rays) <= frame.limit.x;
}

void main()
{
	uint leaf = thread_number();
	if (leaf >= frame.rows.x)
		return;
	uvec4 key = load_pending(leaf).key;
	if (stage == 0u) {
		uint k = frame.budget.z;
		if (key.w == 0u && key.x >= state.budget.lowest_assessed)
			k = atomicAdd(state.counts.assessed_rows, 1u);
		if (k < frame.budget.z)
			choices[GI_CHOICE_CHOSEN + frame.rows.x + k] = leaf;
		return;
	}
	if (key.w > 0u && key.x >= state.budget.lowest_chosen && fits(key.y)) {
		choices[GI_CHOICE_CHOSEN + atomicAdd(state.refresh.chosen_rows, 1u)] = leaf;
		pending[leaf].key = uvec4(0u);
	} else if (key.z > 0u) {
		atomicAdd(state.refresh.waiting_rows, 1u);
		atomicAdd(state.refresh.waiting_entries, key.z);
		if (key.x > 0u)
			atomicAdd(state.refresh.late_rows, 1u);
	}
}
