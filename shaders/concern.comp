#version 450 core
// Of an exact update: lists the rows that something that moved may concern, those of leaves that moved or before whose
// front something was or is that moved and no static face hides (covered.comp). All others are current as they are. One
// thread a leaf.
#define READ_FRAME
#define READ_OBJECTS
#define READ_WORLD
#define READ_LEAVES
#define READ_ROWS
#define READ_OBJECT_LISTS
#define READ_TOUCHED
#define WRITE_ROWS
#define WRITE_TOUCHED
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"
#include "changed.glsl"
#include "swept.glsl"
#include "touched.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

bool is_concerned(uint leaf, uint since)
{
	gi_node_geometry p = load_world(load_leaf(leaf).x);
	bool found = moved_since(load_leaf(leaf).y, since);
	for (uint k = 0u; k < frame.swept.y && !found; k++)
		found = load_swept_change(k).x > since && !is_covered(leaf, k) &&
			reaches_before(ball_about(load_swept_corner(k, 2u), load_swept_corner(k, 3u)), p);
	return found;
}

void main()
{
	uint leaf = thread_number();
	if (leaf >= frame.rows.x)
		return;
	uvec4 row = load_row(leaf);
	if ((row.w & GI_ROW_OPEN) != 0u) {
		note_dirty(leaf, 1u);
		note_changed(leaf);
	}
	if (is_concerned(leaf, row.z))
		list_row(leaf, atomicAdd(state.counts.concerned_rows, 1u));
	else
		rows[leaf].z = frame.update.x;
}
