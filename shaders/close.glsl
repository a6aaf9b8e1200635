// Closes the rows that changed (changed.comp), one thread each: the visible entries of a row partition the hemisphere,
// so what their sum lacks to 1 is sampling error. It is given back in proportion to the variance of each entry (the
// least correction in that norm), and the row never exceeds 1. Then the row's links, what the solve reads, are written:
// entries that are visible and not black.
//
// SPECULAR: of a scene with mirrors or glass, what is seen in these has links too, first of all; what they take of the
// light is given to nobody.
#define READ_FRAME
#define READ_SEGMENTS
#define READ_ENTRIES
#define READ_TARGETS
#define READ_ROWS
#define READ_TOUCHED
#ifdef SPECULAR
#define READ_OBJECTS
#define READ_TOPOLOGY
#define READ_SPECULAR_ENDS
#endif
#define WRITE_TOUCHED
#define WRITE_SEGMENTS
#define WRITE_ROWS
#define WRITE_LINKS
#define WRITE_STATE
#define WRITE_LINK_POOL
#include "buffers.glsl"
#include "dispatch.glsl"
#include "entry.glsl"
#ifdef SPECULAR
#include "specular_entry.glsl"
#endif
#include "touched.glsl"
#define POOL link_pool
#include "pool.glsl"
#include "numbers.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

// An entry is never lowered by more than this factor (and raised by no more than CLOSE_RAISE).
const float CLOSE_LOWER = 0.05;

// A row that still lacks more than this share was not sampled badly but is not a whole hemisphere.
const float CLOSE_SHARE = 0.2;

// Sums stay this much below 1, whatever the rounding of their links: energy is never created.
const float BELOW_ONE = 1.0 - 2.5e-7;

// Relative standard error of form factors: contours are exact but for their receiver's points, discs are not.
const float FACTOR_ERROR_POLYGON = 0.001;
const float FACTOR_ERROR_DISC = 0.1;

// Weight of the segment's doubt about an entry whose own samples agree: visibility is mostly all or nothing (about what
// a Beta(0.1, 0.1) prior gives for one sample).
const float UNSEEN = 0.3;

// How much of that doubt is by the entry itself; the rest is by those before it, fading. Entries side by side are of
// what lies side by side: a wall that all rays see is not doubted because another one of its object is hidden behind
// it.
const float NEXT = 0.125;

// Newton's steps on the correction; each ends at an entry's limit or at the sum, so they are few.
const uint CLOSE_STEPS = 16u;
const float CLOSE_ENOUGH = 1e-5;
const uint LOOP_TURNS = 60000u;

// Corrected and scaled it must not round to zero: what is counted as a link is one.
const float LEAST_FACTOR = 1e-30;

struct visible_entry {
	float weight;   // F V
	float variance; // of F V
	float least, most; // what a correction leaves or makes of the weight
	bool emitter;
};

// What is given back for each unit of variance: to emitters, which have many rays, only when the others are at their
// limits: what a few samples of the walls say must not make a lamp brighter (assess.comp counts on it). Both have one
// sign, so that the corrections of a row add up to what it lacked and no more.
struct correction {
	float others;
	float emitters;
};

// A sum that keeps what rounding takes from it (Kahan): thousands of links must add up to 1 within 1e-7.
struct kahan {
	float sum;
	float lost;
};

void add(inout kahan s, float value)
{
	precise float y = value - s.lost;
	precise float t = s.sum + y;
	precise float lost = (t - s.sum) - y;
	s.lost = lost;
	s.sum = t;
}

uvec2 range_of(uint slot)
{
	uvec4 segment = load_segment(slot);
	return uvec2(segment.x, segment.x + (segment.y & GI_BLOCK_COUNT_MASK));
}

// Squared relative error of an entry's form factor.
float factor_variance(uvec4 e)
{
	float error = (e.w & GI_ENTRY_EXACT) != 0u ? FACTOR_ERROR_POLYGON : FACTOR_ERROR_DISC;
	return error * error;
}

// Of the samples up to an entry's, those near it most, the share that see their object; for the first that of all the
// segment.
float share_up_to(uvec4 e, float before)
{
	return mix(before, float(seen_of(e)) / max(float(samples_of(e)), 1.0), NEXT);
}

// Of V from its own samples. What they cannot tell, above all a single one, the samples of entries beside it do:
// `share` of them see their object, and one of a wall that a hundred rays see is hardly hidden.
float visibility_variance(float v, float per_sample, float share)
{
	return per_sample * (v * (1.0 - v) + UNSEEN * share * (1.0 - share) * per_sample);
}

// Black sky carries no light, so what closing takes from it or gives to it is nowhere seen; it may also be raised where
// no ray of its own saw it, as far as those of the patches before it do. What is lowered when a ray sees it and not
// raised when the ray misses makes all that shines too bright.
visible_entry read_entry(uvec4 e, float share, bool dark_sky)
{
	float seen = float(seen_of(e)), f = uintBitsToFloat(e.y);
	if (f < LEAST_FACTOR || (seen == 0.0 && !dark_sky))
		return visible_entry(0.0, 0.0, 0.0, 0.0, false);
	float per_sample = 1.0 / float(samples_of(e)), v = seen * per_sample, weight = f * v,
	      most = CLOSE_RAISE * weight;
	return visible_entry(weight, f * f * (visibility_variance(v, per_sample, share) + factor_variance(e)),
			     CLOSE_LOWER * weight, dark_sky ? max(f, most) : most, (e.w & GI_ENTRY_EMITTER) != 0u);
}

float corrected(visible_entry v, correction c)
{
	return clamp(v.weight + (v.emitter ? c.emitters : c.others) * v.variance, v.least, v.most);
}

// Backs and black patches only count in the sum.
bool carries_light(uvec4 e, uint target)
{
	return (e.w & GI_ENTRY_BACK) == 0u && (target & GI_TARGET_BLACK) == 0u;
}

struct row_sums {
	float weight;      // of all visible entries, corrected
	correction free;   // variance of those that the correction can still move the way it has to go
};

// What does not change while the row is closed.
struct row_counts {
	uint entries;
	uint lit;   // how many carry light
	uint paths; // on how many of the ways through mirrors and glass light comes
};

#ifdef SPECULAR
// What of the light arrives on an entry's way through mirrors and glass; 0: there is none, or nothing comes.
vec3 throughput_of(uint source, uint k, uvec4 e)
{
	if (!has_smooth(source) || !sees_smooth(e, load_target(k)) || uintBitsToFloat(e.y) < LEAST_FACTOR)
		return vec3(0.0);
	uint bits = load_specular_end(k).y;
	return vec3(bits & 1023u, bits >> 10u & 1023u, bits >> 20u & 1023u) / 1023.0;
}
#endif

// Leaves each segment's share of seen samples and the form factors of the fronts it shows with it.
row_counts count_row(uint leaf)
{
	row_counts count = row_counts(0u, 0u, 0u);
	for (uint s = frame.swept.z; s < frame.counts.z; s++) {
		uint slot = segment_of(leaf, s);
		uvec2 range = range_of(slot);
		uint seen = 0u, taken = 0u;
		float factors = 0.0;
		for (uint k = range.x; k < range.y; k++) {
			uvec4 e = load_entry(k);
			seen += seen_of(e);
			taken += samples_of(e);
			if (seen_of(e) > 0u && uintBitsToFloat(e.y) >= LEAST_FACTOR && carries_light(e, load_target(k)))
				count.lit++;
#ifdef SPECULAR
			count.paths += throughput_of(s, k, e) != vec3(0.0) ? 1u : 0u;
#endif
			factors += (e.w & GI_ENTRY_BACK) != 0u ? 0.0 : uintBitsToFloat(e.y);
		}
		// By Laplace's rule of succession: a few rays that all agree leave some doubt.
		float share = seen > 0u ? (float(seen) + 1.0) / (float(taken) + 2.0) : 0.0;
		uint kept = segments[slot].z; // which face hides it
		kept = (kept & GI_SEGMENT_FACE) != 0u ? kept : GI_SEGMENT_UNKNOWN;
		segments[slot].zw = uvec2(seen == 0u ? kept : floatBitsToUint(share), floatBitsToUint(factors));
		count.entries += range.y - range.x;
	}
	return count;
}

row_sums sum_corrected(uint leaf, correction c, bool raise)
{
	kahan weight = kahan(0.0, 0.0);
	row_sums row = row_sums(0.0, correction(0.0, 0.0));
	for (uint s = frame.swept.z; s < frame.counts.z; s++) {
		uint slot = segment_of(leaf, s);
		uvec2 range = range_of(slot);
		float share = max(uintBitsToFloat(segments[slot].z), 0.0);
		for (uint k = range.x; k < range.y; k++) {
			uvec4 e = load_entry(k);
			share = share_up_to(e, share);
			visible_entry v = read_entry(e, share, s == frame.inner.z);
			if (v.most <= 0.0)
				continue;
			float w = corrected(v, c);
			add(weight, w);
			if (raise ? w >= v.most : w <= v.least)
				continue;
			row.free.others += v.emitter ? 0.0 : v.variance;
			row.free.emitters += v.emitter ? v.variance : 0.0;
		}
	}
	row.weight = weight.sum;
	return row;
}

// From link `at` on; paths: how many ways through mirrors and glass there are, whose links come first.
float write_links(uint leaf, uint at, uint paths, correction c, float scale)
{
	uint path = at;
	at += 2u * paths;
	kahan sum = kahan(0.0, 0.0);
	for (uint s = frame.swept.z; s < frame.counts.z; s++) {
		uint slot = segment_of(leaf, s);
		uvec2 range = range_of(slot);
		float share = max(uintBitsToFloat(segments[slot].z), 0.0);
		for (uint k = range.x; k < range.y; k++) {
			uvec4 e = load_entry(k);
			share = share_up_to(e, share);
			float weight = scale * corrected(read_entry(e, share, s == frame.inner.z), c);
			uint target = load_target(k);
#ifdef SPECULAR
			vec3 w = weight * throughput_of(s, k, e);
			if (w != vec3(0.0)) {
				links[path] = uvec2(load_specular_end(k).x, floatBitsToUint(w.x));
				links[path + 1u] = floatBitsToUint(w.yz);
				path += 2u;
				add(sum, max(w.x, max(w.y, w.z)));
			}
#endif
			if (weight <= 0.0 || !carries_light(e, target))
				continue;
			links[at++] = uvec2(target, floatBitsToUint(weight));
			add(sum, weight);
		}
	}
	if ((at & 1u) == 1u)
		links[at] = uvec2(0u); // they are read in pairs
	return sum.sum;
}

void main()
{
	uint k = spread_number(state.counts.changed_rows);
	if (k >= state.counts.changed_rows || state.counts.overflow != 0u)
		return;
	uint leaf = load_listed(k);

	// llvmpipe ends all loops of a thread, wherever they are, after 65,535 turns in sum.
	row_counts counts = count_row(leaf);
	uint steps = min(CLOSE_STEPS, max(LOOP_TURNS / max(counts.entries, 1u), 4u) - 3u);
	correction c = correction(0.0, 0.0);
	row_sums sums;
	bool raise = true;
	for (uint step = 0u;; step++) {
		sums = sum_corrected(leaf, c, raise);
		raise = step == 0u ? sums.weight < 1.0 : raise;
		float lack = 1.0 - sums.weight;
		if (step == steps || abs(lack) <= CLOSE_ENOUGH)
			break;
		if (sums.free.others > 0.0)
			c.others += lack / sums.free.others;
		else if (sums.free.emitters > 0.0)
			c.emitters += lack / sums.free.emitters;
		else
			break;
	}
	float scale = 1.0;
	if (sums.weight > 1.0 - CLOSE_SHARE)
		scale = BELOW_ONE / sums.weight;
	else
		c = correction(0.0, 0.0); // open on purpose, or inside a solid: raised entries would make energy

	uvec4 row = load_row(leaf);
	uint old_count = row.y & GI_BLOCK_COUNT_MASK, lit = counts.lit + 2u * counts.paths;
	uvec2 block = fit_block(row.xy, lit);
	bool room = block.y >> 24u != GI_BLOCK_NO_CLASS && lit > 0u;
	float row_sum = room ? write_links(leaf, block.x, counts.paths, c, scale) : 0.0;
	uint count = room ? lit : 0u;
	// Where the pool is full the block is nowhere, GI_NONE, which sweeps must not take for a place.
	rows[leaf] =
	    uvec4(room ? block.x : 0u, count | (block.y & ~GI_BLOCK_COUNT_MASK), row.z, floatBitsToUint(row_sum));
	if (count != old_count)
		atomicAdd(state.rows.links, count - old_count);
}
