// Blocks of power-of-two sizes from a pool of elements, for growing arrays. Within one dispatch blocks are only taken,
// and those given back wait in a pending list for recycle.comp: no block is ever given and taken at once.

// Where the free list of a class begins in a pool of `limit` elements: class c has at most limit / (4 << c) blocks.
uint pool_list_begin(uint limit, uint size_class)
{
	uint begin = 0u;
	for (uint c = 0u; c < size_class; c++)
		begin += limit / (GI_BLOCK_SMALLEST << c);
	return begin;
}

// Smallest class that holds n elements.
uint class_of(uint n)
{
	uint c = 0u;
	while ((GI_BLOCK_SMALLEST << c) < n)
		c++;
	return c;
}

// Shaders that take blocks define POOL, the array of the allocator's words (GI_POOL_*), before including this file.
#ifdef POOL
// GI_NONE when the pool is full.
uint pool_try(uint size_class)
{
	int left = int(atomicAdd(POOL[GI_POOL_FREE + size_class], 0xFFFFFFFFu));
	if (left > 0)
		return POOL[POOL[GI_POOL_LIST] + pool_list_begin(POOL[GI_POOL_LIMIT], size_class) + uint(left - 1)];
	atomicAdd(POOL[GI_POOL_FREE + size_class], 1u);
	uint size = GI_BLOCK_SMALLEST << size_class;
	uint offset = atomicAdd(POOL[GI_POOL_BUMP], size);
	if (offset + size <= POOL[GI_POOL_LIMIT])
		return offset;
	atomicAdd(POOL[GI_POOL_BUMP], 0u - size);
	return GI_NONE;
}

void pool_give(uint offset, uint size_class)
{
	uint k = atomicAdd(POOL[GI_POOL_PENDING], 1u);
	if (k < GI_POOL_PENDING_MAX) {
		POOL[GI_POOL_PENDING_LIST + 2u * k] = offset;
		POOL[GI_POOL_PENDING_LIST + 2u * k + 1u] = size_class;
	}
}

// Blocks that have become four times too large are changed for others: kept, each would grow to the most that its array
// ever held, and the pool with them.
bool is_too_large(uint size_class, uint n)
{
	return size_class >= class_of(n) + 2u;
}

// A block that holds `needed` elements: the one there was, its count untouched, another one, or none for none. Where
// the pool is full a block that is too large stays; one that is too small becomes GI_NONE, and the frame's rows do not
// count.
uvec2 fit_block(uvec2 block, uint needed)
{
	uint size_class = block.y >> 24u;
	bool has = size_class != GI_BLOCK_NO_CLASS, fits = has && needed <= GI_BLOCK_SMALLEST << size_class;
	if (fits && needed > 0u && !is_too_large(size_class, needed))
		return block;
	uvec2 next = uvec2(0u, GI_BLOCK_NO_CLASS << 24u);
	if (needed > 0u)
		next = uvec2(pool_try(class_of(needed)), class_of(needed) << 24u);
	if (next.x == GI_NONE && fits)
		return block;
	if (next.x == GI_NONE) {
		atomicOr(state.counts.overflow, 1u);
		atomicAdd(state.refresh.wanted, 1u << class_of(needed));
		return uvec2(GI_NONE, GI_BLOCK_NO_CLASS << 24u);
	}
	if (has)
		pool_give(block.x, size_class);
	return next;
}
#endif
