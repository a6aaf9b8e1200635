#include "cells.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

/* Cells are 2^32 to 2^-20 units wide: coordinates are below 2^30, and what is smaller is parted at that size. */
enum { COARSEST = 32, FINEST = -20, LEVELS = COARSEST - FINEST, WORDS = 4 };

/* The way to a box from the coarsest cell, a bit a turn: 0 and three halves for each cell that it goes down, then 1 and
 * the halves that its centre is in from there on; its tie is the last word's half. */
typedef struct key_writer {
	cells_key *key;
	unsigned at;
} key_writer;

static void write_bits(key_writer *w, uint64_t bits, unsigned count)
{
	const unsigned room = 64 - w->at % 64;
	uint64_t *word = &w->key->word[w->at / 64];
	if (count <= room) {
		word[0] |= bits << (room - count);
	} else {
		word[0] |= bits >> (count - room);
		word[1] |= bits << (64 - (count - room));
	}
	w->at += count;
}

static cells_key key_of(const float *lower, const float *upper, uint32_t tie, uint32_t box)
{
	cells_key key = {.box = box};
	key_writer w = {&key, 0};
	uint64_t place[3];
	double extent = 0;
	for (int c = 0; c < 3; c++) {
		const double centre = .5 * ((double)lower[c] + upper[c]);
		const double most = ldexp(1, COARSEST - 1) - 1;
		place[c] = (uint64_t)ldexp(fmax(-most, fmin(most, centre)) + ldexp(1, COARSEST - 1), -FINEST);
		extent = fmax(extent, (double)upper[c] - lower[c]);
	}
	bool stays = false;
	double half = ldexp(1, LEVELS - 1 + FINEST);
	for (int level = LEVELS - 1; level >= 0; level--, half *= .5) {
		const uint64_t halves =
		    (place[0] >> level & 1) << 2 | (place[1] >> level & 1) << 1 | (place[2] >> level & 1);
		const bool stayed = stays;
		stays = stays || extent > half;
		write_bits(&w, (uint64_t)(stays && !stayed) << 3 | halves, stayed ? 3 : 4);
	}
	key.word[WORDS - 1] |= tie;
	return key;
}

static int compare_keys(const void *a, const void *b)
{
	const cells_key *x = a, *y = b;
	for (int k = 0; k < WORDS; k++)
		if (x->word[k] != y->word[k])
			return x->word[k] < y->word[k] ? -1 : 1;
	return 0;
}

static bool bit_of(const cells_key *key, unsigned bit)
{
	return key->word[bit / 64] >> (63 - bit % 64) & 1;
}

/* The first key of [first, end) behind the highest bit in which they differ, which is no higher than *bit. */
static uint32_t parting(const cells_key *keys, uint32_t first, uint32_t end, unsigned *bit)
{
	while (bit_of(&keys[first], *bit) == bit_of(&keys[end - 1], *bit))
		++*bit;
	uint32_t low = first, high = end - 1;
	while (high - low > 1) {
		const uint32_t middle = low + (high - low) / 2;
		if (bit_of(&keys[middle], *bit))
			high = middle;
		else
			low = middle;
	}
	return high;
}

/* Keys that agree above `bit`. No deeper than a key has bits. Returns the node after the subtree. */
static uint32_t build(const cells_key *keys, uint32_t first, uint32_t end, unsigned bit, uint32_t node,
		      cells_node *nodes)
{
	uint32_t skip = node + 1;
	if (end - first > 1) {
		const uint32_t middle = parting(keys, first, end, &bit);
		skip = build(keys, first, middle, bit + 1, node + 1, nodes);
		skip = build(keys, middle, end, bit + 1, skip, nodes);
	}
	nodes[node] = (cells_node){skip, first, end};
	return skip;
}

/* What is in order already is not sorted: the rest is, and merged with it behind them. Returns where they are. */
static const cells_key *sort(cells_key *keys, uint32_t count)
{
	uint32_t ready = 1, at = 0;
	while (ready < count && compare_keys(&keys[ready - 1], &keys[ready]) < 0)
		ready++;
	if (ready >= count)
		return keys;
	qsort(keys + ready, count - ready, sizeof *keys, compare_keys);
	cells_key *merged = keys + count;
	for (uint32_t k = 0, next = ready; at < count; at++) {
		const bool first = next == count || (k < ready && compare_keys(&keys[k], &keys[next]) < 0);
		merged[at] = keys[first ? k++ : next++];
	}
	return merged;
}

void cells_build(const gi_vec4 *lower, const gi_vec4 *upper, const uint32_t *ties, uint32_t count, cells_key *keys,
		 cells_node *nodes, uint32_t *order)
{
	for (uint32_t k = 0; k < count; k++)
		keys[k] = key_of(&lower[k].x, &upper[k].x, ties[k], k);
	const cells_key *sorted = sort(keys, count);
	for (uint32_t k = 0; k < count; k++)
		order[k] = sorted[k].box;
	if (count)
		build(sorted, 0, count, 0, 0, nodes);
}
