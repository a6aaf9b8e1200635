#include "scene_limits.h"

/* Entries of a row that there must at least be room for, on average: any closed scene of some detail has more. A commit
 * that fails for lack of them fails before anything is built. */
static const uint64_t LEAST_ENTRIES = 16;

uint64_t limits_table_bytes(uint64_t leaves, uint64_t sources)
{
	return sizeof(gi_uvec4) * leaves * (sources > LEAST_ENTRIES ? sources : LEAST_ENTRIES);
}

bool limits_can_hold(gpu *g, uint64_t leaves, uint64_t sources)
{
	const uint64_t bytes = limits_table_bytes(leaves, sources);
	return leaves <= GI_ENTRY_LEAF_MASK && bytes <= gpu_buffer_limit(g, bytes);
}
