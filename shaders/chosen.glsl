// The rows that an update refreshes: all, or under a budget those in the list that enlist.comp made.

uint chosen_count()
{
	return (frame.update.w & GI_UPDATE_PART) != 0u ? state[GI_STATE_CHOSEN] : frame.counts.x;
}

// The leaf of the k-th of them; GI_NONE past the last.
uint chosen_leaf(uint k)
{
	if (k >= chosen_count())
		return GI_NONE;
	return (frame.update.w & GI_UPDATE_PART) != 0u ? load_choice(GI_CHOICE_CHOSEN + k) : k;
}

// The leaf of this thread, in passes of a thread a row; GI_NONE: none.
uint chosen_row()
{
	if ((frame.update.w & GI_UPDATE_PART) == 0u)
		return chosen_leaf(thread_number());
	return chosen_leaf(spread_number(state[GI_STATE_CHOSEN]));
}
