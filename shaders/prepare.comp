#version 450 core
// Group counts for the indirect dispatches that work through the queue. STAGE 0: after the cuts; 1: after flagging; 2:
// after closing.
#define READ_FRAME
#define WRITE_ENTRY_POOL
#define WRITE_LINK_POOL
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = 1) in;
layout(location = 0) uniform uint stage;

void main()
{
	if (stage == 0u) {
		uint count = min(state[GI_STATE_NEW], frame.limits.y);
		state[GI_STATE_QUEUED] = count;
		set_groups(GI_STATE_ARGS_FACTOR, groups_for(count));
	} else if (stage == 1u) {
		set_groups(GI_STATE_ARGS_TRACE, groups_for(min(state[GI_STATE_QUEUED], frame.limits.y)));
	} else {
		set_groups(GI_STATE_ARGS_RECYCLE, groups_for(min(max(entry_pool[GI_POOL_PENDING], link_pool[GI_POOL_PENDING]), GI_POOL_PENDING_MAX)));
	}
}
