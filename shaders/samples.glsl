// Which segments an entry's samples are: how many there are, in which order they are taken, and what each goes between.
#include "fineness.glsl"

// So many that agree are enough. Of hidden ones more: in shadow the little that comes in is all the light there is, and
// would come in at one go where the first of four is no longer hidden.
const uint PROBES = 4u;
const uint HIDDEN_PROBES = 8u;
const uint SKY_PROBES = 2u;

// The order that samples of a sequence of 16 are taken in, a hexadecimal digit each: the first four and eight of it
// fill both squares evenly (small wrap-around discrepancy, Hickernell 1998), so that those that agree seldom overlook
// an edge between them. In the sequence's own order the first four leave 0.43 of one coordinate without any.
const uvec2 ORDER = uvec2(0xf653c9a0u, 0xe4d1b278u);

// A patch of black sky has a ray for each so much of its form factor, up to four: a row that missed a large one by a
// single ray would be raised by half.
const float COARSE_SKY = 0.15;

// A larger form factor than this has more of them, in proportion, up to so many times as many: there are few such
// entries, and where they leave little for others, as below a block close above a floor, what is left is known by how
// well they are.
const float LARGE = 0.04;
const float MOST_LARGE = 4.0;
const float MOST_SAMPLES = 16.0; // a bit each in an entry

// A point of a source that is not small next to its distance brings the more light the nearer it is, and is the more
// seldom hidden; so V is wanted of the light, not of the area. Of so many segments one is traced, drawn in proportion
// to what they carry.
const uint CANDIDATES = 4u;

// From a flat source of less than this share of its distance, radius over distance, all points bring about the same.
const float FAR = 0.2;

// Where both ends are on one object its pose must not matter, not even by rounding.
vec4 sphere_of(pair p, uint node)
{
	if (p.same)
		return rest_sphere(node);
	return world_sphere(node);
}

// Emitters are cut fine as it is.
uint candidates_of(pair p, bool emitter)
{
	if (emitter || p.sky)
		return 1u;
	vec4 mine = sphere_of(p, load_leaf(p.leaf).x), theirs = sphere_of(p, p.node);
	bool far = (p.t.range.w & GI_NODE_FLAT) != 0u && theirs.w < FAR * distance(theirs.xyz, mine.xyz);
	return far ? 1u : CANDIDATES;
}

#if TOPS
// One of the objects below a top, by area; u becomes where in its share it was, uniform in [0, 1) again.
void choose_object(inout pair p, inout float u)
{
	uint n = p.node;
	while ((topology_range(n).w & GI_NODE_TOP) != 0u) {
		uint first = n + 1u, second = topology_range(first).x;
		float share = rest_moment(first).w / (rest_moment(first).w + rest_moment(second).w);
		bool one = u < share;
		u = clamp(one ? u / share : (u - share) / (1.0 - share), 0.0, 0.99999994);
		n = one ? first : second;
	}
	set_source(p, load_topology(n));
}
#endif

// False where hardly any of the source is before the receiver.
bool choose_segment(pair p, uint k, uint candidates, out segment_end a, out segment_end b, inout body on)
{
	float sum = 0.0;
	for (uint attempt = 0u; attempt < candidates || (sum == 0.0 && attempt < TRIES); attempt++) {
		vec4 u = segment_numbers(p.ids.x, p.ids.y, attempt, k);
		vec3 m;
#if TOPS
		choose_object(p, u.z);
#endif
		segment_end from = end_on(p.receiver, p.leaf, point_on(p.mine, u.xy));
		segment_end to = source_end(p, u.zw, m);
		float carried = transfer(p, from, to, u.xy, m);
		if (carried == 0.0)
			continue;
		sum += carried;
		// The first always, the next ones by their parts of the sum.
		if (unit_float(hash(p.ids.x * 0x9e3779b9u ^ hash(p.ids.y ^ hash(k + 16u * attempt)))) * sum <=
		    carried) {
			a = from;
			b = to;
#if TOPS
			on = p.source;
#endif
		}
	}
	return sum > 0.0;
}

// How many rays an entry has.
struct sampling {
	uint wanted;        // at most
	uint probes;        // so many where they agree,
	uint hidden_probes; // and where all are hidden
};

// An emitter, or a patch of sky with much of its light.
bool is_bright(uint flags)
{
	return (flags & (GI_NODE_EMITTER | GI_NODE_FINER_MOST << GI_NODE_FINER_SHIFT)) != 0u;
}

// Rays go where much light may come from: to emitters, and to what is so near that even a leaf is more than the
// tolerance. Stopping early sharpens penumbrae a little; only emitters, cut so fine that it does not show, have so many
// rays to save. Black sky is not seen at all.
sampling sampling_of(uvec4 entry, uint flags)
{
	uint leaf = entry.w & GI_ENTRY_LEAF_MASK;
	row_fineness row = fineness_of(leaf);
	float factor = uintBitsToFloat(entry.y);
#ifdef ROUND
	factor *= is_round(leaf) ? 4.0 : 1.0; // as if the source were before a normal
#endif
	bool emitter = is_bright(flags);
	bool dark_sky = (flags & GI_NODE_SKY) != 0u && frame.misc.w == 0u;
	float most = float(frame.limits.z) * clamp(factor / LARGE, 1.0, MOST_LARGE);
	float wished = float(row.samples);
	most = max(wished, min(most, MOST_SAMPLES));
	uint near = uint(clamp(wished * row.refinement * factor / frame.tolerance.x, 1.0, most));
	uint dark = max((near + 3u) / 4u, uint(clamp(factor / COARSE_SKY, 1.0, float(PROBES))));
	uint wanted = emitter ? frame.limits.w : dark_sky ? dark : near;
	uint probes = emitter ? min(wanted, PROBES) : dark_sky ? min(wanted, SKY_PROBES) : wanted;
	return sampling(wanted, probes, emitter ? min(wanted, HIDDEN_PROBES) : probes);
}

// The place in the sequence of the sample that is taken next.
uint sample_of(uint taken, bool reordered)
{
	return reordered ? ((taken < 8u ? ORDER.x : ORDER.y) >> (4u * (taken & 7u))) & 15u : taken;
}

bool is_reordered(sampling rays, bool emitter, bool sky)
{
	return emitter || (!sky && rays.wanted <= PROBES);
}

// Does a sample that is seen take the place of the one whose light the entry has? Each stays by the same chance.
bool takes_over(uvec2 ids, uint taken, uint seen_before)
{
	float pick = unit_float(hash(ids.x * 0x9e3779b9u ^ hash(ids.y ^ hash(~taken))));
	return pick * float(seen_before + 1u) < 1.0;
}
