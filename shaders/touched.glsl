// What an update touches of rows: three words a leaf in `touched`, part after part. How many of its entries were cut or flagged; 1 where
// what closing reads of it is not what it was; and a list of leaves, of the rows that something that moved may concern (concern.comp), later
// of those to close (changed.comp).

void note_dirty(uint leaf, uint entries)
{
	if (atomicAdd(touched[leaf], entries) == 0u)
		atomicAdd(state[GI_STATE_DIRTY_ROWS], 1u);
}

void note_changed(uint leaf)
{
	touched[frame.counts.x + leaf] = 1u;
}

void list_row(uint leaf, uint counter)
{
	touched[2u * frame.counts.x + atomicAdd(state[counter], 1u)] = leaf;
}
