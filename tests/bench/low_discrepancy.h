/* Points that fill the unit square evenly, and number after number more finely: Sobol's (0,2)-sequence, shuffled and
 * scrambled as Owen does, by a hash (Burley, "Practical hash-based Owen scrambling", JCGT 9 (4), 2020). Pairs of
 * dimensions are padded: each has a shuffle of its own, so that a path may take as many as it likes. */
#ifndef TESTS_BENCH_LOW_DISCREPANCY_H
#define TESTS_BENCH_LOW_DISCREPANCY_H

#include <stdint.h>

static inline uint32_t reverse_bits(uint32_t x)
{
	x = (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
	x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
	x = (x >> 4 & 0x0f0f0f0fu) | (x & 0x0f0f0f0fu) << 4;
	x = (x >> 8 & 0x00ff00ffu) | (x & 0x00ff00ffu) << 8;
	return x >> 16 | x << 16;
}

/* Bits depend on lower ones alone (Laine and Karras, "Stratified sampling for stochastic transparency", 2011; constants
 * of Burley). */
static inline uint32_t hash_upwards(uint32_t x, uint32_t seed)
{
	x += seed;
	x ^= x * 0x6c50b47cu;
	x ^= x * 0xb82f1e52u;
	x ^= x * 0xc7afe638u;
	x ^= x * 0x8d22f6e6u;
	return x;
}

static inline uint32_t owen_scramble(uint32_t x, uint32_t seed)
{
	return reverse_bits(hash_upwards(reverse_bits(x), seed));
}

/* A hash of two numbers (O'Neill's PCG, "Hash functions for GPU rendering", Jarzynski and Olano, JCGT 9 (3), 2020). */
static inline uint32_t hash_pair(uint32_t a, uint32_t b)
{
	uint32_t x = (a * 747796405u + 2891336453u) ^ (b * 277803737u + 0x9e3779b9u);
	x = (x >> ((x >> 28) + 4) ^ x) * 277803737u;
	return x >> 22 ^ x;
}

/* The second dimension of Sobol's sequence; the first is reverse_bits (Kollig and Keller, "Efficient multidimensional
 * sampling", 2002). */
static inline uint32_t sobol_second(uint32_t index)
{
	uint32_t out = 0;
	for (uint32_t v = 1u << 31; index; index >>= 1, v ^= v >> 1)
		if (index & 1)
			out ^= v;
	return out;
}

static inline float unit_float(uint32_t x)
{
	return (float)(x >> 8) * 0x1p-24f; /* [0, 1) */
}

/* Point `index` of the pair of dimensions that `seed` names. */
static inline void low_discrepancy_point(uint32_t index, uint32_t seed, float out[2])
{
	const uint32_t shuffled = owen_scramble(index, seed);
	out[0] = unit_float(owen_scramble(reverse_bits(shuffled), hash_pair(seed, 0)));
	out[1] = unit_float(owen_scramble(sobol_second(shuffled), hash_pair(seed, 1)));
}

#endif
