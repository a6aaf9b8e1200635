#version 450 core
// Closes the rows that changed: the visible entries of a row partition the hemisphere, so what their sum lacks to 1 is sampling error.
// It is given back in proportion to the variance of each entry (the least correction in that norm), and the row never
// exceeds 1. Then the row's links, what the solve reads, are written: entries that are visible and not black.
#include "buffers.glsl"
#define POOL link_pool
#include "pool.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

// An entry is never changed by more than this factor or its inverse: what lies hidden wholly (a row inside a solid) stays dark.
const float CLOSE_FACTOR = 2.0;

// A row that still lacks more than this share was not sampled badly but is not a whole hemisphere.
const float CLOSE_SHARE = 0.2;

// Sums stay this much below 1, whatever the rounding of their links: energy is never created.
const float BELOW_ONE = 1.0 - 4e-7;

// Relative standard error of form factors: contours are exact but for their receiver's points, discs are not.
const float FACTOR_ERROR_POLYGON = 0.01;
const float FACTOR_ERROR_DISC = 0.1;

struct visible_entry {
	float weight;   // F V
	float variance; // of F V
};

visible_entry read_entry(uvec4 e)
{
	float f = uintBitsToFloat(e.y);
	float taken = float((e.w >> GI_ENTRY_SAMPLE_SHIFT) & GI_ENTRY_SAMPLE_MASK);
	float seen = float(bitCount(e.z & 0xFFFFu));
	if (taken == 0.0 || seen == 0.0)
		return visible_entry(0.0, 0.0);
	// Laplace's estimate keeps a doubt even where all samples agree.
	float p = (seen + 1.0) / (taken + 2.0);
	uint flags = topology[e.x].range.w;
	float error = (flags & (GI_NODE_POLYGON | GI_NODE_SKY)) != 0u ? FACTOR_ERROR_POLYGON : FACTOR_ERROR_DISC;
	return visible_entry(f * seen / taken, f * f * (p * (1.0 - p) / taken + error * error));
}

float corrected(visible_entry v, float per_variance)
{
	return v.weight <= 0.0 ? 0.0 : v.weight * clamp(1.0 + per_variance * v.variance / v.weight, 1.0 / CLOSE_FACTOR, CLOSE_FACTOR);
}

bool carries_light(uvec4 e)
{
	if ((e.w & GI_ENTRY_BACK) != 0u)
		return false;
	// Black patches only count in the sum; rho of a node is in the w of its exitance.
	vec4 exitance = node_exitance[e.x];
	return exitance.w > 0.0 || exitance.x + exitance.y + exitance.z > 0.0;
}

void main()
{
	uint leaf = thread_number();
	if (leaf >= frame.counts.x)
		return;
	uvec4 row = rows[leaf];
	if (touched[leaf] == 0u)
		return;
	atomicAdd(state[GI_STATE_DIRTY_ROWS], 1u);
	uint base = leaf * frame.counts.z;

	float sum = 0.0, variance = 0.0;
	uint needed = 0u;
	for (uint s = 0u; s < frame.counts.z; s++) {
		uvec2 block = segments[base + s];
		uint end = block.x + (block.y & GI_BLOCK_COUNT_MASK);
		for (uint k = block.x; k < end; k++) {
			visible_entry v = read_entry(entries[k]);
			sum += v.weight;
			variance += v.variance;
			needed += v.weight > 0.0 && carries_light(entries[k]) ? 1u : 0u;
		}
	}
	float per_variance = variance > 0.0 ? (1.0 - sum) / variance : 0.0;
	float closed = 0.0;
	for (uint s = 0u; s < frame.counts.z; s++) {
		uvec2 block = segments[base + s];
		uint end = block.x + (block.y & GI_BLOCK_COUNT_MASK);
		for (uint k = block.x; k < end; k++)
			closed += corrected(read_entry(entries[k]), per_variance);
	}
	float scale = closed > 1.0 - CLOSE_SHARE ? BELOW_ONE / closed : 1.0;

	uint old_count = row.y & GI_BLOCK_COUNT_MASK, size_class = row.y >> 24u;
	if (needed > 0u && (size_class == GI_BLOCK_NO_CLASS || needed > GI_BLOCK_SMALLEST << size_class)) {
		if (size_class != GI_BLOCK_NO_CLASS)
			pool_give(row.x, size_class);
		size_class = class_of(needed);
		row.x = pool_take(size_class);
		if (row.x == GI_NONE) {
			size_class = GI_BLOCK_NO_CLASS;
			needed = 0u;
		}
	}
	uint at = 0u;
	float row_sum = 0.0;
	for (uint s = 0u; needed > 0u && s < frame.counts.z; s++) {
		uvec2 block = segments[base + s];
		uint end = block.x + (block.y & GI_BLOCK_COUNT_MASK);
		for (uint k = block.x; k < end; k++) {
			float weight = scale * corrected(read_entry(entries[k]), per_variance);
			if (weight <= 0.0 || !carries_light(entries[k]))
				continue;
			links[row.x + at++] = uvec2(entries[k].x, floatBitsToUint(weight));
			row_sum += weight;
		}
	}
	rows[leaf].x = row.x;
	rows[leaf].y = needed | (size_class << 24u);
	rows[leaf].w = floatBitsToUint(row_sum);
	if (needed != old_count)
		atomicAdd(state[GI_STATE_LINKS], needed - old_count);
}
