#version 450 core
// Under a budget: lists the rows to refresh and counts those that wait. One thread a leaf. Whichever order the list
// comes in, the rows are the same.
#define READ_FRAME
#define READ_PENDING
#define WRITE_CHOICES
#define WRITE_PENDING
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

void main()
{
	uint leaf = thread_number();
	if (leaf >= frame.counts.x)
		return;
	uvec4 key = load_pending(leaf).key;
	if (key.x >= state[GI_STATE_THRESHOLD]) {
		choices[GI_BUCKETS + atomicAdd(state[GI_STATE_CHOSEN], 1u)] = leaf;
		pending[leaf].key = uvec4(0u);
	} else if (key.z > 0u) {
		atomicAdd(state[GI_STATE_WAITING_ROWS], 1u);
		atomicAdd(state[GI_STATE_WAITING_ENTRIES], key.z);
		if (key.x > 0u)
			atomicAdd(state[GI_STATE_LATE_ROWS], 1u);
	}
}
