#version 450 core
// Leaves of objects that came borrow the row of a leaf near them, until their own is built: its links are copied, and
// the row is marked, GI_ROW_OPEN. One thread a pair. Where the pool is full, or the leaf has a row, it stays as it is.
#define READ_LOANS
#define WRITE_ROWS
#define WRITE_LINKS
#define WRITE_LINK_POOL
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"
#define POOL link_pool
#include "pool.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint count;

// A block for so many links: the one there was, or another one; x GI_NONE: none is left.
uvec2 take_block(uvec2 block, uint needed)
{
	uint size_class = block.y >> 24u;
	bool has = size_class != GI_BLOCK_NO_CLASS;
	if (has && needed <= GI_BLOCK_SMALLEST << size_class)
		return block;
	uint at = pool_try(class_of(needed));
	if (at != GI_NONE && has)
		pool_give(block.x, size_class);
	return uvec2(at, class_of(needed) << 24u);
}

void main()
{
	uint k = thread_number();
	if (k >= count)
		return;
	uvec2 pair = load_loan(k);
	uvec4 mine = rows[pair.x], row = rows[pair.y];
	uint needed = row.y & GI_BLOCK_COUNT_MASK;
	if ((mine.y & GI_BLOCK_COUNT_MASK) > 0u || needed == 0u)
		return;
	uvec2 block = take_block(mine.xy, needed);
	if (block.x == GI_NONE)
		return;
	// They are read in pairs, and what is behind an odd number of them is none.
	for (uint l = 0u; l < (needed + 1u & ~1u); l++)
		links[block.x + l] = links[row.x + l];
	rows[pair.x] = uvec4(block.x, needed | (block.y & ~GI_BLOCK_COUNT_MASK), mine.z, row.w | GI_ROW_OPEN);
	atomicAdd(state.rows.links, needed);
}
