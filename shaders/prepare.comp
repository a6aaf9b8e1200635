#version 450 core
// Group counts for the indirect dispatches that work through the queue and the lists of rows. STAGE 0: after the cuts;
// 1: after flagging; 2: after closing; 3: rows to flag are listed; 4: rows to close are; 5: entries that see a mirror
// or glass are. Where a pool was full the rows do not count, and nothing more is done about them: what is missing is
// known, and the next update makes room for it.
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
	uint threads, arguments;
	if (stage == 0u) {
		threads = min(state[GI_STATE_NEW], frame.limits.y);
		state[GI_STATE_QUEUED] = threads;
		arguments = GI_STATE_ARGS_FACTOR;
	} else if (stage == 1u) {
		threads = min(state[GI_STATE_QUEUED], frame.limits.y);
		arguments = GI_STATE_ARGS_TRACE;
	} else if (stage == 5u) {
		threads = state[GI_STATE_SPECULAR_PATHS];
		arguments = GI_STATE_ARGS_SPECULAR;
	} else if (stage >= 3u) {
		uint rows = state[stage == 3u ? GI_STATE_CONCERNED_ROWS : GI_STATE_CHANGED_ROWS];
		set_groups(stage == 3u ? GI_STATE_ARGS_FLAG : GI_STATE_ARGS_CLOSE, spread_groups(rows));
		return;
	} else {
		threads = min(max(entry_pool[GI_POOL_PENDING], link_pool[GI_POOL_PENDING]), GI_POOL_PENDING_MAX);
		arguments = GI_STATE_ARGS_RECYCLE;
	}
	if (stage < 2u && state[GI_STATE_OVERFLOW] != 0u)
		threads = 0u;
	set_groups(arguments, groups_for(threads));
}
