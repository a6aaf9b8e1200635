// How finely a row is cut, and how many rays an entry at the tolerance has. All leaves' rows are alike; those of
// receivers say it themselves, in the flags of their node.

struct row_fineness {
	float refinement; // what the tolerance is divided by
	uint samples;
};

row_fineness fineness_of(uint row)
{
	if (row < frame.counts.x)
		return row_fineness(1.0, 1u);
	uint flags = topology_range(load_leaf(row).x).w;
	return row_fineness(float(1u << (flags >> GI_NODE_FINER_SHIFT & GI_NODE_FINER_MOST)),
			    1u + (flags >> GI_NODE_SAMPLES_SHIFT & GI_NODE_SAMPLES_MOST));
}
