// What an update touches of rows. Behind the leaves' words of `touched` lie two lists of leaves: the rows that closing may bring
// otherwise than they were, and those that something that moved may concern.

// What closing reads of a row is not what it was. Once a row.
void note_changed(uint leaf)
{
	if ((atomicOr(touched[leaf], GI_TOUCHED_CHANGED) & GI_TOUCHED_CHANGED) == 0u)
		touched[frame.counts.x + atomicAdd(state[GI_STATE_CHANGED_ROWS], 1u)] = leaf;
}

void note_dirty(uint leaf, uint entries)
{
	if ((atomicAdd(touched[leaf], entries) & GI_TOUCHED_COUNT_MASK) == 0u)
		atomicAdd(state[GI_STATE_DIRTY_ROWS], 1u);
}

void note_concerned(uint leaf)
{
	touched[2u * frame.counts.x + atomicAdd(state[GI_STATE_CONCERNED_ROWS], 1u)] = leaf;
}
