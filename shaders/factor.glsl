// Form factors of the entries cut anew: one thread an entry. Mean over points of the receiver of the point-to-source
// factor.
//
// ROUND: some rows are of receivers that see all round (receiver_sets.h), whose factors are shares of the sphere.
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

// Receivers larger than these shares of the distance are averaged over 2 x 2 and 4 x 4 points.
const float RECEIVER_2 = 0.08;
const float RECEIVER_4 = 0.35;

vec3 corner_of(uint vertex, bool same)
{
	if (same)
		return load_rest_vertex(vertex).xyz;
	return load_world_vertex(vertex).xyz;
}

// 1 / 2^e for x in [2^e, 2^(e+1)): scaling by it rounds nothing.
float inverse_power_of_two(float x)
{
	return uintBitsToFloat((254u << 23) - (floatBitsToUint(x) & 0x7F800000u));
}

gi_node_geometry geometry_of(uint node, bool same)
{
	if (same)
		return load_rest(node);
	return load_world(node);
}

// The leaf that receives.
struct receiver {
	gi_node_geometry g;
	vec3 a, b, c, d;
	bool triangle;
	bool folded; // it has two normals: the mean of what its halves see is not what their mean normal sees
	float area_abc, area_acd;
	vec3 normal_abc, normal_acd;
#ifdef ROUND
	bool round;
#endif
};

// The node that sends.
struct source {
	uint node;
	gi_node_topology t;
	gi_node_geometry g;
	bool sky;
	bool self;    // it is the receiver
	bool same;    // both are of one object, and all is computed in its rest frame
	bool top;
	float unit;   // its lengths are in units of 1 / unit
	bool contour; // its corners are its outline
	bool disc;    // so small from there that its outline does not matter
	float shown;  // area that it shows where it is a disc without an outline; below 0: of its back
};

source load_source(uint node, uint leaf, uint receiver_node)
{
	source s;
	s.node = node;
	s.t = load_topology(node);
	s.sky = (s.t.range.w & GI_NODE_SKY) != 0u;
	s.self = node == receiver_node;
	s.top = (s.t.range.w & GI_NODE_TOP) != 0u;
	s.same = !s.sky && !s.top && load_leaf(leaf).y == load_leaf(s.t.range.y).y;
	s.g = geometry_of(node, s.same);
	return s;
}

// Lengths are in units of the largest: their fourth powers, which the contour sum takes, stay in the range of floats.
float unit_of(gi_node_geometry p, source s)
{
	return s.sky ? inverse_power_of_two(p.sphere.w)
		     : inverse_power_of_two(max(length(s.g.sphere.xyz - p.sphere.xyz), max(s.g.sphere.w, p.sphere.w)));
}

receiver load_receiver(uint node, gi_node_geometry g, source s, float unit)
{
	receiver r;
	uvec4 corners = topology_corners(node);
	r.g = g;
	r.g.sphere *= unit;
	r.a = unit * corner_of(corners.x, s.same);
	r.b = unit * corner_of(corners.y, s.same);
	r.c = unit * corner_of(corners.z, s.same);
	r.d = unit * corner_of(corners.w, s.same);
	r.triangle = corners.z == corners.w;
#ifdef ROUND
	r.round = g.axis.w < 0.0; // no leaf's normals differ so much
#endif
	vec3 fold_abc = cross(r.b - r.a, r.c - r.a), fold_acd = cross(r.c - r.a, r.d - r.a);
	r.area_abc = length(fold_abc);
	r.area_acd = length(fold_acd);
	// Where the corners are so far away that a half has no area left in floats, the mean is all there is.
	r.folded = (g.axis.w < FOLDED || s.self) && r.area_abc > 0.0 && r.area_acd > 0.0;
	r.normal_abc = r.folded ? fold_abc / r.area_abc : g.axis.xyz;
	r.normal_acd = r.folded ? fold_acd / r.area_acd : g.axis.xyz;
	return r;
}

float shown_to(receiver r, source s, float far)
{
	vec3 view = (r.g.sphere.xyz - s.g.sphere.xyz) / far;
	vec3 rest_view = s.same || s.top ? view : rest_direction_from_world(load_leaf(s.t.range.y).y, view);
	vec2 sides = shown_area(load_spread(s.node), s.g.moment, view, rest_view);
	bool back_side = (s.t.range.w & GI_NODE_BACK) != 0u && sides.y > sides.x;
	return (back_side ? -sides.y : sides.x) * s.unit * s.unit;
}

// How the source is taken from the receiver: by its outline, or as a disc.
void choose_outline(receiver r, float far, inout source s)
{
	uint flags = s.t.range.w;
	s.contour = (flags & GI_NODE_LEAF) != 0u || ((flags & GI_NODE_POLYGON) != 0u && s.g.axis.w >= FLAT_CONE);
	s.disc = !s.sky && (!s.contour || s.g.sphere.w < POINT_SOURCE * (far - s.g.sphere.w));
	s.shown = s.disc && !s.contour ? shown_to(r, s, far) : 0.0;
}

// How many points a side of the receiver are averaged. A folded leaf's whole contour, seen from within, is rounding,
// and so are points on the edge between its halves: of itself one point each.
int points_a_side(receiver r, source s, float far)
{
	if (s.sky || s.self || r.g.sphere.w < RECEIVER_2 * far)
		return 1;
	return r.g.sphere.w < RECEIVER_4 * far ? 2 : 4;
}

// Of the k-th point: where in the unit square, and its weight.
vec3 point_and_weight(receiver r, int side, int k)
{
	int i = k % side, j = k / side;
	if (side == 2)
		return vec3(GAUSS_2[i], GAUSS_2[j], 1.0);
	if (side == 4)
		return vec3(GAUSS_4[i], GAUSS_4[j], WEIGHT_4[i] * WEIGHT_4[j]);
	vec2 u = r.triangle || r.folded ? vec2(2.0, 1.0) / 3.0 : vec2(0.5);
	return vec3(k == 1 ? u.yx : u, 1.0);
}

#ifdef ROUND
// From a point that sees all round.
float round_factor_from(receiver r, source s, vec3 x)
{
	if (s.disc) {
		vec3 to = s.g.sphere.xyz - x;
		float shown = s.contour ? -dot(s.g.moment.xyz, normalize(to)) * s.unit * s.unit : s.shown;
		return round_disc_factor(to, shown);
	}
	if (s.sky && s.g.sphere.w < POINT_SOURCE)
		return s.g.moment.w / (4.0 * PI);
	vec3 origin = s.sky ? vec3(0.0) : x;
	vec3 a = s.unit * corner_of(s.t.corners.x, s.same) - origin;
	vec3 b = s.unit * corner_of(s.t.corners.y, s.same) - origin;
	vec3 c = s.unit * corner_of(s.t.corners.z, s.same) - origin;
	vec3 d = s.unit * corner_of(s.t.corners.w, s.same) - origin;
	return share_of_sphere(a, b, c) + share_of_sphere(a, c, d);
}
#endif

// From a point of the receiver, of its half a b c or a c d, with the normal n.
float factor_from(receiver r, source s, vec3 x, vec3 n, bool abc)
{
#ifdef ROUND
	if (r.round)
		return round_factor_from(r, s, x);
#endif
	if (s.disc) {
		vec3 to = s.g.sphere.xyz - x;
		return disc_factor(to, n, s.contour ? -dot(s.g.moment.xyz, normalize(to)) * s.unit * s.unit : s.shown);
	}
	if (s.sky && s.g.sphere.w < POINT_SOURCE)
		return max(dot(n, s.g.sphere.xyz), 0.0) * s.g.moment.w / PI;
	vec3 origin = s.sky ? vec3(0.0) : x;
	vec3 v[4]; // what a folded leaf sees of itself is the other half
	if (s.self)
		v = abc ? vec3[](r.a - x, r.c - x, r.d - x, r.d - x) : vec3[](r.a - x, r.b - x, r.c - x, r.c - x);
	else
		v = vec3[](s.unit * corner_of(s.t.corners.x, s.same) - origin,
			   s.unit * corner_of(s.t.corners.y, s.same) - origin,
			   s.unit * corner_of(s.t.corners.z, s.same) - origin,
			   s.unit * corner_of(s.t.corners.w, s.same) - origin);
	return polygon_factor(v, n);
}

// Sums over the receiver's points of the factors to the source's front and to its back by weight, and of the weights.
// The source's plane may part the receiver: points behind it see no front, and take nothing from those before it.
struct factor_sums {
	float front, behind, weight;
};

factor_sums sum_factors(receiver r, source s, int side)
{
	factor_sums sums = factor_sums(0.0, 0.0, 0.0);
	int points = side == 1 && r.folded ? 2 : side * side;
	for (int k = 0; k < points; k++) {
		vec3 u = point_and_weight(r, side, k);
		// Halves of the unit square become the two triangles, whose areas differ.
		bool abc = u.x >= u.y;
		float weight = u.z * (r.folded ? (abc ? r.area_abc : r.area_acd) : 1.0);
		vec3 x = point_on_quad(r.a, r.b, r.c, r.d, u.xy);
		float f = factor_from(r, s, x, abc ? r.normal_abc : r.normal_acd, abc);
		sums.front += weight * max(f, 0.0);
		sums.behind += weight * max(-f, 0.0);
		sums.weight += weight;
	}
	return sums;
}

void main()
{
	uint t = thread_number();
	if (t >= min(state.counts.new_entries, frame.limits.y))
		return;
	uint slot = load_queued(t);
	uvec4 entry = load_entry(slot);
	uint leaf = entry.w & GI_ENTRY_LEAF_MASK, node = load_leaf(leaf).x;
	source s = load_source(entry.x, leaf, node);
	gi_node_geometry p = geometry_of(node, s.same);
	float unit = unit_of(p, s);
	receiver r = load_receiver(node, p, s, unit);
	s.unit = s.sky ? 1.0 : unit;
	s.g.sphere *= s.unit;
	float far = length(s.g.sphere.xyz - r.g.sphere.xyz);
	choose_outline(r, far, s);
	factor_sums sums = sum_factors(r, s, points_a_side(r, s, far));
	bool back = (s.t.range.w & GI_NODE_BACK) != 0u && sums.behind > sums.front;
	entries[slot].y = floatBitsToUint((back ? sums.behind : sums.front) / sums.weight);
	if (back)
		entries[slot].w = entry.w | GI_ENTRY_BACK;
}
