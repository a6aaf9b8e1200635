#version 450 core
// Closes the rows that changed: the visible entries of a row partition the hemisphere, so what their sum lacks to 1 is sampling error.
// It is given back in proportion to the variance of each entry (the least correction in that norm), and the row never
// exceeds 1. Then the row's links, what the solve reads, are written: entries that are visible and not black.
#define USE_FRAME
#define USE_TOPOLOGY
#define USE_SEGMENTS
#define USE_ENTRIES
#define USE_ROWS
#define USE_LINKS
#define USE_NODE_EXITANCE
#define USE_STATE
#define USE_TOUCHED
#define USE_LINK_POOL
#include "buffers.glsl"
#include "dispatch.glsl"
#define POOL link_pool
#include "pool.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

// An entry is never raised by more than this factor: what lies hidden wholly (a row inside a solid) stays dark.
const float CLOSE_RAISE = 2.0;
const float CLOSE_LOWER = 0.05;

// A row that still lacks more than this share was not sampled badly but is not a whole hemisphere.
const float CLOSE_SHARE = 0.2;

// Sums stay this much below 1, whatever the rounding of their links: energy is never created.
const float BELOW_ONE = 1.0 - 2.5e-7;

// Relative standard error of form factors: contours are exact but for their receiver's points, discs are not.
const float FACTOR_ERROR_POLYGON = 0.01;
const float FACTOR_ERROR_DISC = 0.1;

// How often the correction is adjusted for entries that reached their limits; the last remainder goes to all alike.
const uint CLOSE_STEPS = 4u;

struct visible_entry {
	float weight;   // F V
	float variance; // of F V
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

uint samples_of(uvec4 e)
{
	return (e.w >> GI_ENTRY_SAMPLE_SHIFT) & GI_ENTRY_SAMPLE_MASK;
}

uvec2 block_of(uint slot)
{
	uvec2 block = segments[slot];
	return uvec2(block.x, block.x + (block.y & GI_BLOCK_COUNT_MASK));
}

// Visibility is mostly all or nothing: its prior is Beta(PRIOR, PRIOR), which weighs little against any sample.
const float PRIOR = 0.1;

// Share of the segment's samples that see their object: a wall seen by a hundred rays is hardly hidden anywhere.
float seen_share(uvec2 range)
{
	uint seen = 0u, taken = 0u;
	for (uint k = range.x; k < range.y; k++) {
		seen += uint(bitCount(entries[k].z & 0xFFFFu));
		taken += samples_of(entries[k]);
	}
	return (float(seen) + PRIOR) / (float(taken) + 2.0 * PRIOR);
}

visible_entry read_entry(uvec4 e, float share)
{
	float f = uintBitsToFloat(e.y);
	float taken = float(samples_of(e)), seen = float(bitCount(e.z & 0xFFFFu));
	if (seen == 0.0)
		return visible_entry(0.0, 0.0);
	float p = (seen + 2.0 * PRIOR * share) / (taken + 2.0 * PRIOR);
	uint flags = topology[e.x].range.w;
	float error = (flags & (GI_NODE_POLYGON | GI_NODE_SKY)) != 0u ? FACTOR_ERROR_POLYGON : FACTOR_ERROR_DISC;
	return visible_entry(f * seen / taken, f * f * (p * (1.0 - p) / taken + error * error));
}

float corrected(visible_entry v, float per_variance)
{
	if (v.weight <= 0.0)
		return 0.0;
	return v.weight * clamp(1.0 + per_variance * v.variance / v.weight, CLOSE_LOWER, CLOSE_RAISE);
}

bool carries_light(uvec4 e)
{
	if ((e.w & GI_ENTRY_BACK) != 0u)
		return false;
	// Black patches only count in the sum; rho of a node is in the w of its exitance.
	vec4 exitance = node_exitance[e.x];
	return exitance.w > 0.0 || exitance.x + exitance.y + exitance.z > 0.0;
}

struct row_sums {
	float weight;   // of all visible entries, corrected
	float variance; // of those the correction can still move the way it has to go
	uint lit;       // how many carry light
};

row_sums sum_row(uint leaf, float per_variance, bool raise)
{
	kahan weight = kahan(0.0, 0.0);
	float variance = 0.0;
	uint lit = 0u;
	for (uint s = 0u; s < frame.counts.z; s++) {
		uvec2 range = block_of(leaf * frame.counts.z + s);
		float share = seen_share(range);
		for (uint k = range.x; k < range.y; k++) {
			uvec4 e = entries[k];
			visible_entry v = read_entry(e, share);
			if (v.weight <= 0.0)
				continue;
			float w = corrected(v, per_variance);
			add(weight, w);
			bool at_limit = raise ? w >= CLOSE_RAISE * v.weight : w <= CLOSE_LOWER * v.weight;
			variance += at_limit ? 0.0 : v.variance;
			lit += carries_light(e) ? 1u : 0u;
		}
	}
	return row_sums(weight.sum, variance, lit);
}

float write_links(uint leaf, uint at, float per_variance, float scale)
{
	kahan sum = kahan(0.0, 0.0);
	for (uint s = 0u; s < frame.counts.z; s++) {
		uvec2 range = block_of(leaf * frame.counts.z + s);
		float share = seen_share(range);
		for (uint k = range.x; k < range.y; k++) {
			uvec4 e = entries[k];
			float weight = scale * corrected(read_entry(e, share), per_variance);
			if (weight <= 0.0 || !carries_light(e))
				continue;
			links[at++] = uvec2(e.x, floatBitsToUint(weight));
			add(sum, weight);
		}
	}
	return sum.sum;
}

// A block that holds `needed` links; none, and so no light, when the pool is full.
uvec2 fit_block(uvec2 block, uint needed)
{
	uint size_class = block.y >> 24u;
	if (needed == 0u || (size_class != GI_BLOCK_NO_CLASS && needed <= GI_BLOCK_SMALLEST << size_class))
		return block;
	if (size_class != GI_BLOCK_NO_CLASS)
		pool_give(block.x, size_class);
	size_class = class_of(needed);
	uint offset = pool_take(size_class);
	return uvec2(offset, (offset == GI_NONE ? GI_BLOCK_NO_CLASS : size_class) << 24u);
}

void main()
{
	uint leaf = thread_number();
	if (leaf >= frame.counts.x || touched[leaf] == 0u)
		return;
	atomicAdd(state[GI_STATE_DIRTY_ROWS], 1u);

	float per_variance = 0.0;
	row_sums sums = sum_row(leaf, 0.0, true);
	bool raise = sums.weight < 1.0;
	if (!raise)
		sums = sum_row(leaf, 0.0, false);
	for (uint step = 0u; step < CLOSE_STEPS && sums.variance > 0.0 && abs(1.0 - sums.weight) > 1e-6; step++) {
		per_variance += (1.0 - sums.weight) / sums.variance;
		sums = sum_row(leaf, per_variance, raise);
	}
	float scale = sums.weight > 1.0 - CLOSE_SHARE ? BELOW_ONE / sums.weight : 1.0;

	uvec4 row = rows[leaf];
	uint old_count = row.y & GI_BLOCK_COUNT_MASK;
	uvec2 block = fit_block(row.xy, sums.lit);
	bool room = block.y >> 24u != GI_BLOCK_NO_CLASS && sums.lit > 0u;
	float row_sum = room ? write_links(leaf, block.x, per_variance, scale) : 0.0;
	uint count = room ? sums.lit : 0u;
	rows[leaf] = uvec4(block.x, count | (block.y & ~GI_BLOCK_COUNT_MASK), 0u, floatBitsToUint(row_sum));
	if (count != old_count)
		atomicAdd(state[GI_STATE_LINKS], count - old_count);
}
