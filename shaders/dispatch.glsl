// Threads of compute dispatches and the group counts of indirect ones.

// Dispatches of many groups are folded into y: OpenGL promises only 65,535 groups in x.
uint thread_number()
{
	return (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * GI_GROUP_SIZE + gl_LocalInvocationID.x;
}

#ifdef READ_RUNS
// The run that thread `t` is in: the last one in runs[first, first + count) that begins at or before t.
uvec4 find_run(uint first, uint count, uint t)
{
	uint low = first, high = first + count;
	while (high - low > 1u) {
		uint middle = (low + high) >> 1u;
		if (load_run(middle).x <= t)
			low = middle;
		else
			high = middle;
	}
	return load_run(low);
}
#endif

uint groups_for(uint threads)
{
	return (threads + GI_GROUP_SIZE - 1u) / GI_GROUP_SIZE;
}

#ifdef WRITE_STATE
// Folded into y as thread_number expects.
void set_groups(uint at, uint groups)
{
	state[at] = min(groups, 32768u);
	state[at + 1u] = (groups + 32767u) / 32768u;
	state[at + 2u] = 1u;
}
#endif
