// One visibility ray: the two surfaces it goes between, its ends on them, and what it carries.

#include "leaf_quad.glsl"

// Segments that leave a surface at its back are drawn again, this often.
const uint TRIES = 8u;

quad load_quad(uvec4 corners)
{
	return quad(load_rest_vertex(corners.x).xyz, load_rest_vertex(corners.y).xyz, load_rest_vertex(corners.z).xyz,
		    load_rest_vertex(corners.w).xyz);
}

struct pair {
	uint leaf, node;
	uvec2 ids;          // of both
	bool back;          // the source is seen from behind
	bool same;          // both ends on one object: all is computed in its rest frame, whatever its pose
	body receiver, source;
	quad mine, theirs;  // theirs: of the source where `whole`
	gi_node_topology t; // of the source
	bool sky, whole;    // whole: a leaf, or a patch of sky; else each sample is on a leaf of its own
	// Where not whole: areas of the source's object before the node's first leaf, and up to and with its last.
	float area_before, area_all;
};

// Shaders of scenes with receivers that see all round, points without a normal (receiver_sets.h), define ROUND.

#ifdef ROUND
// Rows of such a receiver's are those of a quad whose corners are one.
bool is_round(uint leaf)
{
	return load_leaf_corner(leaf, 0u).xyz == load_leaf_corner(leaf, 1u).xyz;
}
#endif

// Shaders for nodes of several objects, whose samples are each on one of them (trace.glsl), define TOPS as 1.
#ifndef TOPS
#define TOPS 0
#endif

// What its samples ask of the source, a node of one object or a patch of sky.
void set_source(inout pair p, gi_node_topology t)
{
	p.t = t;
	p.whole = p.sky || t.range.z == 1u;
	p.source = load_source(p.sky ? 0xFFFFu : load_leaf(t.range.y).y);
	p.same = TOPS == 0 && p.source.object == p.receiver.object;
	if (p.sky)
		p.theirs = load_quad(t.corners);
	else if (p.whole)
		p.theirs = load_leaf_quad(t.range.y);
	p.area_before = p.whole || t.range.y == object_nodes(p.source.object).z ? 0.0 : load_area_up_to(t.range.y - 1u);
	p.area_all = p.whole ? 0.0 : load_area_up_to(t.range.y + t.range.z - 1u);
}

pair load_pair(uvec4 entry)
{
	pair p;
	p.leaf = entry.w & GI_ENTRY_LEAF_MASK;
	p.node = entry.x;
	p.back = (entry.w & GI_ENTRY_BACK) != 0u;
	gi_node_topology t = load_topology(entry.x);
	p.sky = (t.range.w & GI_NODE_SKY) != 0u;
	uvec4 mine = load_leaf(p.leaf);
	p.receiver = load_body(mine.y);
	p.mine = load_leaf_quad(p.leaf);
	set_source(p, t);
	// The sky is the last object.
	uint from = p.sky ? frame.counts.z - 1u : p.source.object;
	p.ids = uvec2(p.leaf + object_ids(mine.y).x, TOPS == 1 ? t.corners.x : p.node + object_ids(from).y);
	return p;
}

// Leaves smaller than this part of the area summed up before them are lost in its rounding.
const float LEAST_AREA = 1e-6;

// Chooses one of the node's leaves by u in [0, 1): by area, or by number where areas are lost in the rounding of their
// sum. u is set to its place within the leaf's share, which is uniform in [0, 1) again.
uint leaf_at(pair p, inout float u)
{
	uint low = p.t.range.y, high = low + p.t.range.z - 1u;
	float before = p.area_before, all = p.area_all, pick = mix(before, all, u);
	if (all - before < LEAST_AREA * float(p.t.range.z) * all) {
		float number = u * float(p.t.range.z);
		uint k = min(uint(number), p.t.range.z - 1u);
		u = clamp(number - float(k), 0.0, 0.99999994);
		return low + k;
	}
	// The first try is where it would be were all leaves alike, the second beside it, then halves: the same leaf
	// whatever is tried.
	uint middle = low + uint(u * float(p.t.range.z));
	float end = all;
	for (uint step = 0u; low < high; step++) {
		middle = clamp(middle, low, high - 1u);
		float area = load_area_up_to(middle);
		bool below = pick < area;
		if (below) {
			high = middle;
			end = area;
		} else {
			low = middle + 1u;
			before = area;
		}
		middle = step > 0u ? (low + high) >> 1u : below ? max(high, 1u) - 1u : low;
	}
	u = end > before ? clamp((pick - before) / (end - before), 0.0, 0.99999994) : 0.5;
	return low;
}

// The source's end for two numbers; m is the normal there, at rest.
segment_end source_end(pair p, vec2 u, out vec3 m)
{
	uint leaf = p.t.range.y;
	quad q = p.theirs;
	m = vec3(0.0);
	if (p.sky) {
		vec3 direction = normalize(point_on_quad(q.a, q.b, q.c, q.d, u));
		return segment_end(GI_NONE, direction, direction);
	}
	if (!p.whole) {
		leaf = leaf_at(p, u.x);
		q = load_leaf_quad(leaf);
	}
	m = cross(q.c - q.a, q.d - q.b);
	return end_on(p.source, leaf, point_on(q, u));
}

// Less than any transfer of light that counts.
const float LEAST_TRANSFER = 1e-30;

// How much light a segment carries, next to others of the same two surfaces, m: cos cos' area / d^2; 0 unless it leaves
// the front of the receiver and arrives on the side of the source that the entry is about.
float transfer(pair p, segment_end a, segment_end b, vec2 u, vec3 m)
{
	// Of the triangle of the receiver that the point is on (point_on_quad).
	vec3 normal = u.x >= u.y || p.mine.c == p.mine.d ? cross(p.mine.b - p.mine.a, p.mine.c - p.mine.a)
							 : cross(p.mine.c - p.mine.a, p.mine.d - p.mine.a);
	if (!p.same)
		normal = direction_to_world(p.receiver, normal);
#ifdef ROUND
	bool round = p.mine.a == p.mine.b;
	if (p.sky && round)
		return 1.0;
#endif
	if (p.sky)
		return max(dot(normal, b.world), 0.0);
	vec3 d = p.same ? b.rest - a.rest : b.world - a.world;
	vec3 n = p.same ? m : direction_to_world(p.source, m);
	float leaves_at = dot(normal, d), arrives_at = p.back ? dot(n, d) : -dot(n, d), d2 = dot(d, d);
#ifdef ROUND
	leaves_at = round ? sqrt(d2) : leaves_at;
#endif
	return leaves_at > 0.0 && arrives_at > 0.0 ? max((leaves_at / d2) * (arrives_at / d2), LEAST_TRANSFER) : 0.0;
}
