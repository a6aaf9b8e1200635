#version 450 core
// Takes from flagged entries the mark that they bear while a row is asked for several movers (flag.comp). One thread an
// entry queued.
#define READ_FRAME
#define READ_QUEUE
#define WRITE_ENTRIES
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

void main()
{
	uint t = thread_number();
	if (t >= state.counts.new_entries && t < min(state.counts.queued, frame.limits.y))
		entries[load_queued(t)].y &= ~GI_ENTRY_FLAGGED;
}
