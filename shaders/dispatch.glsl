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

// Few long threads are spread over many groups, whose unused threads cost next to nothing: a software renderer gives a
// whole group to one processor, and eight threads fill its vectors.
const uint FEW = 1024u, SPREAD = 8u;

uint spread_groups(uint threads)
{
	return threads < FEW ? (threads + SPREAD - 1u) / SPREAD : groups_for(threads);
}

// Number of a thread among those; GI_NONE: none.
uint spread_number(uint threads)
{
	uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, local = gl_LocalInvocationID.x;
	if (threads >= FEW)
		return group * GI_GROUP_SIZE + local;
	return local < SPREAD ? group * SPREAD + local : GI_NONE;
}

// Folded into y as thread_number expects.
gi_groups folded(uint groups)
{
	return gi_groups(min(groups, 32768u), (groups + 32767u) / 32768u, 1u, 0u);
}

