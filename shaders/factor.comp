#version 450 core
// Form factors of the entries cut anew: one thread an entry. Mean over points of the receiver of the point-to-source
// factor.
#define READ_FRAME
#define READ_OBJECTS
#define READ_SPREAD
#define READ_TOPOLOGY
#define READ_REST
#define READ_WORLD
#define READ_VERTICES_REST
#define READ_VERTICES_WORLD
#define READ_LEAVES
#define READ_ENTRIES
#define READ_QUEUE
#define WRITE_ENTRIES
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"
#include "polygon.glsl"
#include "spread.glsl"
#include "sampling.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

// Gauss-Legendre points and weights on [0,1], two and four per side.
const float GAUSS_2[2] = float[](0.2113248654, 0.7886751346);
const float GAUSS_4[4] = float[](0.0694318442, 0.3300094782, 0.6699905218, 0.9305681558);
const float WEIGHT_4[4] = float[](0.1739274226, 0.3260725774, 0.3260725774, 0.1739274226);

// Leaves whose halves' normals differ from the mean by more than this cosine (2.5 degrees) are folded.
const float FOLDED = 0.999;

// Receivers larger than these shares of the distance are averaged over 2 x 2 and 4 x 4 points.
const float RECEIVER_2 = 0.08;
const float RECEIVER_4 = 0.35;

vec3 corner_of(uint vertex, bool same)
{
	if (same)
		return rest_vertex(vertex);
	return world_vertex(vertex);
}

// 1 / 2^e for x in [2^e, 2^(e+1)): scaling by it rounds nothing.
float inverse_power_of_two(float x)
{
	return uintBitsToFloat((254u << 23) - (floatBitsToUint(x) & 0x7F800000u));
}

void main()
{
	uint t = thread_number();
	if (t >= min(state[GI_STATE_NEW], frame.limits.y))
		return;
	uint slot = load_queued(t);
	uvec4 entry = load_entry(slot);
	uint leaf = entry.w & GI_ENTRY_LEAF_MASK;
	uint receiver = load_leaf(leaf).x;
	gi_node_topology source = load_topology(entry.x);
	uvec4 flags = source.range;
	bool sky = (flags.w & GI_NODE_SKY) != 0u;
	// What a folded leaf sees of itself is the other half; its whole contour, seen from within, is rounding. So are
	// points on the edge between the halves: one point each.
	bool self = entry.x == receiver;
	bool top = (flags.w & GI_NODE_TOP) != 0u;
	bool same = !sky && !top && load_leaf(leaf).y == load_leaf(source.range.y).y;

	gi_node_geometry p, g;
	if (same) {
		p = load_rest(receiver);
		g = load_rest(entry.x);
	} else {
		p = load_world(receiver);
		g = load_world(entry.x);
	}
	// Lengths in units of the largest: their fourth powers, which the contour sum takes, stay in the range of
	// floats.
	float unit = sky ? inverse_power_of_two(p.sphere.w)
			 : inverse_power_of_two(max(length(g.sphere.xyz - p.sphere.xyz), max(g.sphere.w, p.sphere.w)));
	p.sphere *= unit;
	uvec4 mine = load_corners(receiver);
	vec3 a = unit * corner_of(mine.x, same), b = unit * corner_of(mine.y, same), c = unit * corner_of(mine.z, same),
	     d = unit * corner_of(mine.w, same);
	// A folded leaf has two normals: the mean of what its halves see is not what their mean normal sees.
	vec3 fold_abc = cross(b - a, c - a), fold_acd = cross(c - a, d - a);
	float area_abc = length(fold_abc), area_acd = length(fold_acd);
	// Where the corners are so far away that a half has no area left in floats, the mean is all there is.
	bool folded = (p.axis.w < FOLDED || self) && area_abc > 0.0 && area_acd > 0.0;
	vec3 normal_abc = folded ? fold_abc / area_abc : p.axis.xyz;
	vec3 normal_acd = folded ? fold_acd / area_acd : p.axis.xyz;

	float source_unit = sky ? 1.0 : unit;
	g.sphere *= source_unit;
	float far = length(g.sphere.xyz - p.sphere.xyz);
	int side = sky || self || p.sphere.w < RECEIVER_2 * far ? 1 : p.sphere.w < RECEIVER_4 * far ? 2 : 4;
	bool contour = (flags.w & GI_NODE_LEAF) != 0u || ((flags.w & GI_NODE_POLYGON) != 0u && g.axis.w >= FLAT_CONE);
	bool disc = !sky && (!contour || g.sphere.w < POINT_SOURCE * (far - g.sphere.w));
	float shown = 0.0;
	if (disc && !contour) {
		vec3 view = (p.sphere.xyz - g.sphere.xyz) / far;
		vec2 sides =
		    shown_area(load_spread(entry.x), g.moment, view,
			       same || top ? view : rest_direction_from_world(load_leaf(source.range.y).y, view));
		bool back_side = (flags.w & GI_NODE_BACK) != 0u && sides.y > sides.x;
		shown = (back_side ? -sides.y : sides.x) * unit * unit;
	}

	// A source's plane may part the receiver: points behind it see no front, and take nothing from those before it.
	float front = 0.0, behind = 0.0, weight_sum = 0.0;
	int points = side == 1 && folded ? 2 : side * side;
	for (int k = 0; k < points; k++) {
		int i = k % side, j = k / side;
		vec2 u = mine.z == mine.w || folded ? vec2(2.0, 1.0) / 3.0 : vec2(0.5);
		float weight = 1.0;
		if (side == 2) {
			u = vec2(GAUSS_2[i], GAUSS_2[j]);
		} else if (side == 4) {
			u = vec2(GAUSS_4[i], GAUSS_4[j]);
			weight = WEIGHT_4[i] * WEIGHT_4[j];
		}
		if (side == 1 && k == 1)
			u = u.yx;
		// Halves of the unit square become the two triangles, whose areas differ.
		bool first = u.x >= u.y;
		weight *= folded ? (first ? area_abc : area_acd) : 1.0;
		vec3 n = first ? normal_abc : normal_acd;
		vec3 x = point_on_quad(a, b, c, d, u);
		float f;
		if (disc) {
			vec3 to = g.sphere.xyz - x;
			f = disc_factor(to, n, contour ? -dot(g.moment.xyz, normalize(to)) * unit * unit : shown);
		} else {
			vec3 origin = sky ? vec3(0.0) : x;
			vec3 v[4] =
			    self ? first ? vec3[](a - x, c - x, d - x, d - x) : vec3[](a - x, b - x, c - x, c - x)
				 : vec3[](source_unit * corner_of(source.corners.x, same) - origin,
					  source_unit * corner_of(source.corners.y, same) - origin,
					  source_unit * corner_of(source.corners.z, same) - origin,
					  source_unit * corner_of(source.corners.w, same) - origin);
			f = polygon_factor(v, n);
		}
		front += weight * max(f, 0.0);
		behind += weight * max(-f, 0.0);
		weight_sum += weight;
	}
	bool back = (flags.w & GI_NODE_BACK) != 0u && behind > front;
	entries[slot].y = floatBitsToUint((back ? behind : front) / weight_sum);
	if (back)
		entries[slot].w = entry.w | GI_ENTRY_BACK;
}
