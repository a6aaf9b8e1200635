// Group counts of indirect dispatches, written to the state buffer.

uint groups_for(uint threads)
{
	return (threads + GI_GROUP_SIZE - 1u) / GI_GROUP_SIZE;
}

// Folded into y as thread_number expects.
void set_groups(uint at, uint groups)
{
	state[at] = min(groups, 32768u);
	state[at + 1u] = (groups + 32767u) / 32768u;
	state[at + 2u] = 1u;
}
