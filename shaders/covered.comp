#version 450 core
// Of rows whose leaf did not move: which of what was swept lies wholly, and always did, behind one static face
// (cover.glsl). What moved there is of no concern to the row: what crosses the swept box is hidden with it and without
// it, and entries of the mover need no rays (trace.glsl). One thread a row; a bit for each of what was swept.
//
// Which face that is hardly changes from one update to the next: where the row sees nothing of the mover, its segment
// keeps it.
#define READ_FRAME
#define READ_OBJECTS
#define READ_WORLD
#define READ_LEAVES
#define READ_LEAF_QUADS
#define READ_BVH
#define READ_PRIMITIVES
#define READ_TLAS
#define READ_ROWS
#define READ_OBJECT_LISTS
#define READ_CHOICES
#define WRITE_SEGMENTS
#define WRITE_TOUCHED
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"
#include "changed.glsl"
#include "chosen.glsl"
#include "cover.glsl"
#include "rays.glsl"
#include "swept.glsl"
#include "touched.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

// So many faces on the way to the middle of the box are tried; where none will do, that is asked again every so many
// updates: among things of the mover's own size it mostly stays so.
const uint TRIES = 8u;
const uint AGAIN = 32u;

struct receiver {
	uint leaf, since;
	vec3 corners[4];
	vec3 middle;
};

receiver load_receiver(uint leaf, uint mine, uint since)
{
	receiver r;
	r.leaf = leaf;
	r.since = since;
	for (uint k = 0u; k < 4u; k++)
		r.corners[k] = world_from_rest(mine, load_leaf_corner(leaf, k).xyz);
	r.middle = world_sphere(load_leaf(leaf).x).xyz;
	return r;
}

// Of a primitive of a static object that is as it was when the row was refreshed.
bool face_covers(receiver r, cover_box box, uint primitive)
{
	gi_primitive q = load_primitive(primitive);
	uint object = load_leaf(floatBitsToUint(q.a.w)).y;
	if ((object_bvh(object).z & GI_OBJECT_UNSEEN) != 0u || moved_since(object, r.since))
		return false;
	vec3 face[4] = vec3[](world_from_rest(object, q.a.xyz), world_from_rest(object, q.b.xyz),
			      world_from_rest(object, q.c.xyz), world_from_rest(object, q.d.xyz));
	return covers(r.corners, box, face);
}

// A face on the way from the leaf's middle to the box's; GI_NONE: none was found. Static objects come first in the tree
// (tlas.c).
uint find_face(receiver r, cover_box box)
{
	vec3 way = box.middle - r.middle;
	tree_walk scene = walk_of_scene(r.middle, way, frame.inner.xy);
	tree_walk inside = tree_walk(scene.ray, 0u, 0u); // of no object yet
	uint tries = 0u, found = GI_NONE;
	while (found == GI_NONE && tries < TRIES) {
		uint primitive = next_primitive(inside, 1.0);
		if (primitive != GI_NONE) {
			found = face_covers(r, box, primitive) ? primitive : GI_NONE;
			tries++;
			continue;
		}
		uint object = next_object(scene, 1.0);
		if (object >= frame.swept.z)
			break;
		inside =
		    walk_of_object(object, rest_from_world(object, r.middle), rest_direction_from_world(object, way));
	}
	return found;
}

bool is_covered(receiver r, gi_node_geometry p, uint k)
{
	uvec4 change = load_swept_change(k);
	vec4 lower = load_swept_corner(k, 2u), upper = load_swept_corner(k, 3u);
	bool movable = change.y != GI_NONE && change.y >= frame.swept.z;
	if (!movable || change.x <= r.since || !reaches_before(ball_about(lower, upper), p))
		return false;
	cover_box box = cover_box(0.5 * lower.xyz + 0.5 * upper.xyz, 0.5 * upper.xyz - 0.5 * lower.xyz);
	uint slot = segment_of(r.leaf, change.y), known = segments[slot].z;
	if ((known & GI_SEGMENT_FACE) == 0u)
		return false; // it is seen
	uint face = known & ~GI_SEGMENT_FACE;
	if (face < frame.statics.x && face_covers(r, box, face))
		return true;
	if (face == GI_SEGMENT_NO_FACE && (r.leaf + frame.update.x) % AGAIN != 0u)
		return false;
	face = find_face(r, box);
	segments[slot].z = GI_SEGMENT_FACE | min(face, GI_SEGMENT_NO_FACE);
	return face != GI_NONE;
}

void main()
{
	uint leaf = (frame.update.w & GI_UPDATE_PART) != 0u ? chosen_row() : thread_number();
	if (leaf >= frame.rows.x)
		return;
	uint mine = load_leaf(leaf).y, since = load_row(leaf).z, bits = 0u;
	if (!moved_since(mine, since)) {
		gi_node_geometry p = load_world(load_leaf(leaf).x);
		receiver r = load_receiver(leaf, mine, since);
		for (uint k = 0u; k < min(frame.swept.y, MOST_COVERED); k++)
			bits |= is_covered(r, p, k) ? 1u << k : 0u;
	}
	note_covered(leaf, bits);
}
