// What an update touches of rows: four words a leaf in `touched`, part after part. How many of its entries were cut or
// flagged; 1 where what closing reads of it is not what it was; which of what was swept a static face hides from it
// (covered.comp); and a list of leaves, of the rows that something that moved may concern (concern.comp), later of
// those to close (changed.comp).

// Bits in a word: of what was swept the first ones.
const uint MOST_COVERED = 32u;

void note_dirty(uint leaf, uint entries)
{
	if (atomicAdd(touched[leaf], entries) == 0u)
		atomicAdd(state.counts.dirty_rows, 1u);
}

void note_changed(uint leaf)
{
	touched[frame.rows.x + leaf] = 1u;
}

void note_covered(uint leaf, uint bits)
{
	touched[2u * frame.rows.x + leaf] = bits;
}

#ifdef READ_TOUCHED
// The k-th of what was swept.
bool is_covered(uint leaf, uint k)
{
	return k < MOST_COVERED && (load_touched(2u * frame.rows.x + leaf) >> k & 1u) != 0u;
}

uint load_listed(uint k)
{
	return load_touched(3u * frame.rows.x + k);
}
#endif

void list_row(uint leaf, uint k)
{
	touched[3u * frame.rows.x + k] = leaf;
}
