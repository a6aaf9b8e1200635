// The rows that an update under a budget refreshes: those in the list that enlist.comp made.

// The leaf of the k-th of them; GI_NONE past the last.
uint chosen_leaf(uint k)
{
	return k < state.refresh.chosen_rows ? load_choice(GI_CHOICE_CHOSEN + k) : GI_NONE;
}

// The leaf of this thread, in passes of a thread a row; GI_NONE: none.
uint chosen_row()
{
	return chosen_leaf(spread_number(state.refresh.chosen_rows));
}
