// Which object hides a segment.

// The object that hides b from a, or GI_BLOCKER_NONE. `front`: the segment arrives at a front. `clear`: the bodies of a
// and b are known to hide nothing.
// One loop over all trees, whichever they are: lanes of a vector walk different ones together, and the walk is compiled
// once.
uint blocker_of(body body_a, segment_end a, body body_b, segment_end b, bool front, bool clear)
{
	bool first = !clear && (body_a.flags & GI_OBJECT_FLAT) == 0u;
	bool last = !clear && (body_b.flags & GI_OBJECT_FLAT) == 0u && body_b.object != body_a.object;
	bool sky = body_b.object == GI_NONE;
	segment_goal goal = goal_of(a, b, front);
	tree_walk walk = walk_of_segment(a, b, sky);
	uint blocker = GI_BLOCKER_NONE;
	while (blocker == GI_BLOCKER_NONE) {
		uint object = first ? body_a.object : body_b.object;
		if (!first && !last)
			object = next_third(walk, body_a, a, body_b, b);
		if (object == GI_NONE)
			break;
		last = last && first;
		first = false;
		if (object_hides(object, ray_for(load_body(object), body_a, a, body_b, b, goal)))
			blocker = object;
	}
	return blocker;
}
