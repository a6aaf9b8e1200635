#version 450 core
// A commit that keeps rows: objects came and went, so leaves, nodes and slots have other numbers. One thread a leaf of
// the scene of before: its header and its segments go to their new places, and what lies in the pools is renumbered
// where it is. What belonged to objects that went is given back; rows that lost something of it that they saw are
// marked, GI_ROW_OPEN.
#define READ_ENTRIES
#define READ_TARGETS
#define READ_OLD_SEGMENTS
#define READ_OLD_ROWS
#define READ_MOVES
#define READ_NODE_MOVES
#define WRITE_SEGMENTS
#define WRITE_ENTRIES
#define WRITE_TARGETS
#define WRITE_ROWS
#define WRITE_LINKS
#define WRITE_STATE
#define WRITE_ENTRY_POOL
#define WRITE_LINK_POOL
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint first;     // leaf of this dispatch
layout(location = 1) uniform uint count;     // leaves
layout(location = 2) uniform uint old_slots; // objects before, the sky too
layout(location = 3) uniform uint slots;     // and now
layout(location = 4) uniform uint blockers;  // 1: slots of objects that hide something are others too
layout(location = 5) uniform uint old_first; // the first source before
layout(location = 6) uniform uint new_first; // and now
layout(location = 7) uniform uint old_statics; // the static ones as a source before, GI_NONE: none whose nodes moved
layout(location = 8) uniform uint end_static;  // end of their nodes now
layout(location = 9) uniform uint shifted;    // 1: nodes of objects that stay have other numbers
layout(location = 10) uniform uint old_moves; // objects and sets of receivers before

// The object before, or set of receivers, that a leaf was of.
uint slot_of(uint leaf)
{
	uint low = 0u, high = old_moves;
	while (high - low > 1u) {
		uint middle = (low + high) >> 1u;
		if (load_move(middle).before.x <= leaf)
			low = middle;
		else
			high = middle;
	}
	return low;
}

// As pool.glsl does, for either pool.
void give_entries(uvec2 block)
{
	uint k = atomicAdd(entry_pool[GI_POOL_PENDING], 1u);
	entry_pool[GI_POOL_PENDING_LIST + 2u * k] = block.x;
	entry_pool[GI_POOL_PENDING_LIST + 2u * k + 1u] = block.y >> 24u;
}

void give_links(uvec2 block)
{
	uint k = atomicAdd(link_pool[GI_POOL_PENDING], 1u);
	link_pool[GI_POOL_PENDING_LIST + 2u * k] = block.x;
	link_pool[GI_POOL_PENDING_LIST + 2u * k + 1u] = block.y >> 24u;
}

bool has_block(uvec2 block)
{
	return block.y >> 24u != GI_BLOCK_NO_CLASS;
}

// An object that went is no blocker that could be asked for: such entries are retested where something was. So are
// those that static objects hid, where there are none any more; where these are only no longer the same flagging sees
// that.
uint new_blocker(uint blocker)
{
	if (blocker >= GI_BLOCKER_STATICS)
		return blocker == GI_BLOCKER_STATICS && end_static == 0u ? GI_BLOCKER_MIXED : blocker;
	uint now = load_move(blocker).now.x;
	return now == GI_NONE ? GI_BLOCKER_MIXED : now;
}

// nodes: what is added to those of an object; of static ones each goes its own way, and some are there no more.
void renumber_entries(uvec2 block, uint leaf, uint nodes, bool statics)
{
	uint end = block.x + (block.y & GI_BLOCK_COUNT_MASK);
	for (uint k = block.x; k < end; k++) {
		uvec4 e = load_entry(k);
		uint hidden_by = blockers != 0u || old_statics != GI_NONE ? new_blocker(e.z >> 16u) : e.z >> 16u;
		uint black = load_target(k) & GI_TARGET_BLACK, before = load_target(k) & ~GI_TARGET_BLACK;
		uint node = e.x + nodes, target = before + nodes, gone = 0u;
		if (statics) {
			node = load_node_move(e.x);
			target = load_node_move(before);
			gone = node >= end_static ? GI_ENTRY_GONE : 0u;
			// What is read of such an entry is only its light.
			target = target == GI_NONE ? 0u : target;
			node = gone != 0u || (e.w & GI_ENTRY_GONE) != 0u ? target : node;
		}
		entries[k] =
		    uvec4(node, e.y, (e.z & 0xFFFFu) | hidden_by << 16u, (e.w & ~GI_ENTRY_LEAF_MASK) | gone | leaf);
		targets[k] = target | black;
	}
}

struct loss {
	uint entries;
	bool seen; // some of them: the row is another now
};

loss move_segments(uint leaf, gi_move mine)
{
	loss went = loss(0u, false);
	for (uint s = old_first; s < old_slots; s++) {
		uvec4 segment = load_old_segment(leaf * (old_slots - old_first) + s - old_first), to = load_move(s).now;
		if (mine.now.x == GI_NONE || to.x == GI_NONE || to.x < new_first) {
			if (has_block(segment.xy))
				give_entries(segment.xy);
			went.entries += segment.y & GI_BLOCK_COUNT_MASK;
			went.seen =
			    went.seen || ((segment.y & GI_BLOCK_COUNT_MASK) > 0u && uintBitsToFloat(segment.z) > 0.0);
			continue;
		}
		segments[(leaf + mine.now.y) * (slots - new_first) + to.x - new_first] = segment;
		if (to.z != 0u || mine.now.y != 0u || blockers != 0u || old_statics != GI_NONE)
			renumber_entries(segment.xy, leaf + mine.now.y, to.z, s == old_statics);
	}
	return went;
}

// Returns how many stay. One through mirrors and glass is in the place of two.
uint move_links(uvec4 row)
{
	uint links_before = row.y & GI_BLOCK_COUNT_MASK, stay = 0u;
	for (uint k = 0u, size = 1u; k < links_before; k += size) {
		uvec2 l = links[row.x + k];
		bool specular = (l.x & GI_LINK_SPECULAR) != 0u;
		size = specular ? 2u : 1u;
		uint node = load_node_move(specular ? l.x & GI_LINK_NODE : l.x);
		if (node == GI_NONE)
			continue;
		links[row.x + stay] = uvec2(specular ? node | (l.x & ~GI_LINK_NODE) : node, l.y);
		if (specular)
			links[row.x + stay + 1u] = links[row.x + k + 1u];
		stay += size;
	}
	if (((row.x + stay) & 1u) == 1u && links_before > 0u)
		links[row.x + stay] = uvec2(0u); // they are read in pairs
	return stay;
}

void main()
{
	uint t = thread_number();
	if (t >= count)
		return;
	uint leaf = first + t;
	gi_move mine = load_move(slot_of(leaf));
	uvec4 row = load_old_row(leaf);
	uint links_before = row.y & GI_BLOCK_COUNT_MASK, stay = 0u;
	loss went = move_segments(leaf, mine);
	if (mine.now.x != GI_NONE) {
		// Links to what went are of segments that went with it, but borrowed ones (lend.comp), whose row is
		// open.
		bool others =
		    shifted != 0u || old_statics != GI_NONE || went.entries > 0u || (row.w & GI_ROW_OPEN) != 0u;
		stay = others ? move_links(row) : links_before;
		row.y = stay | (row.y & ~GI_BLOCK_COUNT_MASK);
		row.w |= went.seen || stay < links_before ? GI_ROW_OPEN : 0u;
		rows[leaf + mine.now.y] = row;
	} else if (has_block(row.xy)) {
		give_links(row.xy);
	}
	if (went.entries > 0u)
		atomicAdd(state.rows.entries, 0u - went.entries);
	if (stay < links_before)
		atomicAdd(state.rows.links, 0u - (links_before - stay));
}
