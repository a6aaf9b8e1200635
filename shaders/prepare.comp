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

gi_groups groups_of(uint threads)
{
	return folded(groups_for(state.counts.overflow != 0u ? 0u : threads));
}

void main()
{
	switch (stage) {
	case 0u:
		state.counts.queued = min(state.counts.new_entries, frame.limits.y);
		state.factor = groups_of(state.counts.queued);
		break;
	case 1u:
		state.trace = groups_of(min(state.counts.queued, frame.limits.y));
		break;
	case 2u:
		uint pending = max(entry_pool[GI_POOL_PENDING], link_pool[GI_POOL_PENDING]);
		state.recycle = folded(groups_for(min(pending, GI_POOL_PENDING_MAX)));
		break;
	case 3u:
		state.flag = folded(spread_groups(state.counts.concerned_rows));
		break;
	case 4u:
		state.close = folded(spread_groups(state.counts.changed_rows));
		break;
	case 5u:
		state.specular = folded(groups_for(state.counts.specular_paths));
		break;
	}
}
