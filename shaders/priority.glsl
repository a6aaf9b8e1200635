// Which rows an update assesses and refreshes first.

// Unless time is what an update is given, a row goes first after so many updates (and up to half as many more),
// whatever its bound.
const float OLDEST = 48.0;

bool is_timed()
{
	return (frame.update.w & GI_UPDATE_TIMED) != 0u;
}

// The largest light reflected, as of the solve before, of the three channels.
float largest_reflected()
{
	return max(state.solve.scale.x, max(state.solve.scale.y, state.solve.scale.z));
}

#ifdef SPECULAR
// The same, channel by channel: of emitters too.
vec3 reflected_most()
{
	return state.solve.scale.xyz;
}
#endif

// Rows of like bounds are parted by a hash, so that a bucket never holds too many; old ones go before new ones.
//
// Given time, what counts is the mean error in the long run. A row's error grows about as the movers go, and a bound
// that holds for any motion is large from the first: of rows whose errors grow alike those go first whose age squared
// over their cost is largest (the Whittle index of a linear cost of age; Kadota et al. 2018). So a row of a bound 16
// times smaller is refreshed a quarter as often, none waits for ever, and none breaks the budget.
uint bucket_of(uint leaf, float worth, uint since)
{
	float age = float(frame.update.x - since);
	float random = unit_float(hash(leaf ^ hash(since)));
	if (!is_timed() && age > OLDEST * (1.0 + 0.5 * random))
		return GI_BUCKETS - 1u;
	float octave = log2(max(worth / max(largest_reflected(), 1e-30), exp2(-40.0))) +
		       (is_timed() ? 2.0 : 1.0) * log2(age) + 2.0 * random;
	return uint(clamp(int(float(GI_BUCKETS_PER_OCTAVE) * (octave + 41.0)), 1, int(GI_BUCKETS) - 2));
}

// What a leaf counts for under a budget of time, where `size` is its share of the scene: its size, or with a camera
// what it fills of the picture.
float weight_of(gi_node_geometry p, float size)
{
	if ((frame.update.w & GI_UPDATE_VIEWED) == 0u)
		return size;
	return max(UNSEEN * size, may_be_seen(p) ? share_of_picture(p) : 0.0);
}

// What it is worth to look at a leaf that may be off by so much, at a cost in rays: under a budget of time what it
// counts for, and what is cheap comes first; otherwise the bound alone counts, of what a camera does not see a share.
float worth_of(float off, gi_node_geometry p, uint rays)
{
	if (!is_timed())
		return (frame.update.w & GI_UPDATE_VIEWED) == 0u || may_be_seen(p) ? off : UNSEEN * off;
	float cells = min(frame.cells.x, min(frame.cells.y, frame.cells.z)) / GI_PACKED_CELLS; // scenes per metre
	return off * sqrt(weight_of(p, cells * cells * p.moment.w) / float(max(rays, 1u)));
}

// Is a leaf that may be off by so much, W/m2, to be refreshed at all?
bool is_wanted(float off)
{
	return frame.limit.y == 0.0 || off > frame.limit.y * largest_reflected();
}

// What the leaf will count with in the end (stale.comp), if B goes about as far as it went in the update before.
float expected_off(vec4 bound, float rho)
{
	float more = 2.0 * bound.w * uintBitsToFloat(state.budget.step_bits) * rho;
	return (max(bound.x, max(bound.y, bound.z)) + more) / (1.0 - rho);
}
