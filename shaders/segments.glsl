// Is a segment between two surfaces free?
//
// What an object does to a segment depends on the poses of that object and of the two at the ends alone, and is always
// computed in the blocker's rest frame; an end that lies on the blocker itself is used as it is, without a turn through
// the world. So the answer for a pair of points is the same bits whenever those poses are.

// A surface whose plane an end of the segment lies in, within rounding, does not lie between the ends: rounding of the
// plane's distance is below this share of the coordinates it is computed from. A share of the segment's length would do
// for that, but a wall just before the lamp, or a small sealed room in a large scene, would leak.
//
// Of surfaces that lie in one place the ray meets one: it arrives at a front before any back (of a sheet, or of two
// rooms that share a plane), and else at the surface of the highest rank (gi_primitive). Where it begins all of them
// receive, as if each were the one on top: the light there is the same for all, and none of them sends more than is
// seen of it.
const float PLANE_SLACK = 2.5e-7;

// How much farther than its end boxes are met, in units of the slack: a surface in the end's plane may lie behind it by
// the slack over the cosine there. What arrives more obliquely carries hardly any light.
const float END_REACH = 16.0;

// An object's pose, loaded once for all samples of an entry.
struct body {
	uint object; // GI_NONE: the sky
	uint flags;  // GI_OBJECT_
	vec4 row0, row1, row2; // world from rest
};

struct segment_end {
	uint leaf;  // the leaf it lies on, which cannot hide it
	vec3 rest;  // in its body's rest frame
	vec3 world; // in the world; a unit direction for the sky: such a segment never ends
};

body load_body(uint object)
{
	return body(object, object_bvh(object).z, object_row0(object), object_row1(object), object_row2(object));
}

// The sky where there is no object of that number (16 bits).
body load_source(uint object)
{
	if (object == 0xFFFFu)
		return body(GI_NONE, GI_OBJECT_FLAT, vec4(0.0), vec4(0.0), vec4(0.0));
	return load_body(object);
}

vec3 to_world(body b, vec3 p)
{
	vec4 q = vec4(p, 1.0);
	return vec3(dot(b.row0, q), dot(b.row1, q), dot(b.row2, q));
}

vec3 to_rest(body b, vec3 p)
{
	vec3 q = p - vec3(b.row0.w, b.row1.w, b.row2.w);
	return b.row0.xyz * q.x + b.row1.xyz * q.y + b.row2.xyz * q.z;
}

vec3 direction_to_rest(body b, vec3 d)
{
	return b.row0.xyz * d.x + b.row1.xyz * d.y + b.row2.xyz * d.z;
}

vec3 direction_to_world(body b, vec3 d)
{
	return vec3(dot(b.row0.xyz, d), dot(b.row1.xyz, d), dot(b.row2.xyz, d));
}

segment_end end_on(body on, uint leaf, vec3 rest_point)
{
	return segment_end(leaf, rest_point, on.object == GI_NONE ? rest_point : to_world(on, rest_point));
}

float reach_of(vec3 v)
{
	return max(abs(v.x), max(abs(v.y), abs(v.z)));
}

// What a segment is to meet, by the primitives at its ends: ranks, and on which side it arrives.
struct segment_goal {
	uvec2 ranks;
	bool front;
};

segment_goal goal_of(segment_end a, segment_end b, bool front)
{
	return segment_goal(uvec2(load_leaf(a.leaf).w, b.leaf == GI_NONE ? GI_NONE : load_leaf(b.leaf).w), front);
}

// An end that lies on the object is used as it is, without a turn through the world, and world coordinates play no part
// where both do.
tree_ray ray_for(body by, body body_a, segment_end a, body body_b, segment_end b, segment_goal goal)
{
	bool own_a = by.object == body_a.object, own_b = by.object == body_b.object, sky = body_b.object == GI_NONE;
	vec3 origin = own_a ? a.rest : to_rest(by, a.world);
	vec3 target = sky ? direction_to_rest(by, b.world) : (own_b ? b.rest : to_rest(by, b.world)) - origin;
	float near = reach_of(own_a ? a.rest : a.world) + reach_of(origin);
	float far = sky ? 0.0 : near + reach_of(own_b ? b.rest : b.world) + reach_of(target);
	vec2 slack = PLANE_SLACK * vec2(near, far);
	float end = sky ? 3e38 : 1.0, reach = sky ? 3e38 : 1.0 + END_REACH * slack.y / max(reach_of(target), 1e-30);
	return tree_ray(origin, target, end, reach, slack, goal.ranks, goal.front);
}

// Do both ends lie on one side of the plane that all of the object lies in? A beginning in the plane is on either side,
// an end in it on neither: the object may cover what is there.
bool same_side(uint object, segment_end a, segment_end b, bool sky)
{
	vec4 plane = object_plane(object);
	if (plane.xyz == vec3(0.0))
		return false;
	float from = dot(plane.xyz, a.world) - plane.w,
	      to = sky ? dot(plane.xyz, b.world) : dot(plane.xyz, b.world) - plane.w;
	float slack_a = PLANE_SLACK * reach_of(a.world),
	      slack_b = sky ? 0.0 : END_REACH * PLANE_SLACK * reach_of(b.world);
	return (from >= -slack_a && to >= slack_b) || (from <= slack_a && to <= -slack_b);
}

// Over the scene's tree for segments to the sky, and for others the one without what encloses the scene.
tree_walk walk_of_segment(segment_end a, segment_end b, bool sky)
{
	return walk_of_scene(a.world, sky ? b.world : b.world - a.world,
			     sky ? uvec2(0u, frame.misc.x) : frame.inner.xy);
}

// The next object that may cut the segment, other than the two at its ends; GI_NONE: no more. The bodies at the ends
// are asked without the test of world boxes, whose rounding depends on the pose: an object at rest relative to both
// ends must always answer the same.
uint next_third(inout tree_walk walk, body body_a, segment_end a, body body_b, segment_end b)
{
	bool sky = body_b.object == GI_NONE, passed_over = true;
	uint object = GI_NONE;
	while (passed_over) {
		object = next_object(walk, sky ? 3e38 : 1.0);
		bool third = object != body_a.object && object != body_b.object;
		passed_over = object != GI_NONE && !(third && !same_side(object, a, b, sky));
	}
	return object;
}
