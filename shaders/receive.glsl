// What receivers get, by their rows, from the B of the solve. One thread a receiver; `first` is the first one's row,
// `count` how many there are. Light through mirrors and glass is all in the links here: photons fall on leaves.
//
// HARMONICS: of receivers without a normal, whose rows look all round: a link's weight w is a share of the sphere, and
// its light comes from radiance B / pi in a cone of solid angle 4 pi w about the mean way to its node. Radiance is
// projected to real spherical harmonics Y_lm, and each band is multiplied by what a cosine lobe leaves of it, A_l = pi,
// 2 pi / 3, pi / 4 (Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment Maps, 2001), so
// that E(n) = sum of c_lm Y_lm(n).
//
// PUNCTUAL: there are lights without a surface (punctual_trace.comp).
#define READ_FRAME
#define READ_OBJECTS
#define READ_LEAVES
#define READ_ROWS
#define READ_LINKS
#define READ_RADIOSITY
#ifdef HARMONICS
#define READ_TOPOLOGY
#define READ_WORLD
#define READ_VERTICES_WORLD
#endif
#ifdef PUNCTUAL
#ifdef HARMONICS
#define READ_PUNCTUAL_LIGHTS
#define READ_PUNCTUAL_SHARES
#else
#define READ_PUNCTUAL_SUMS
#endif
#endif
#define WRITE_RECEIVED
#include "buffers.glsl"
#include "dispatch.glsl"
#include "numbers.glsl"
#include "specular_link.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint first;
layout(location = 1) uniform uint count;
#ifdef PUNCTUAL
layout(location = 2) uniform uint light_count;
layout(location = 3) uniform uint rows; // leaves, then receivers
#endif

#ifdef HARMONICS
const uint COEFFICIENTS = 9u;

// The mean over a cone about an axis, which is a share w of the sphere, of band l: times this what it is on the axis.
vec2 of_cone(float w)
{
	float cosine = 1.0 - 2.0 * min(w, 1.0);
	return 0.5 * (1.0 + cosine) * vec2(1.0, cosine);
}

void add(inout vec3 sum[COEFFICIENTS], vec3 light, vec3 d, float w)
{
	vec2 bands = of_cone(w);
	vec3 one = light * bands.x, two = light * bands.y;
	sum[0] += light;
	sum[1] += one * d.y;
	sum[2] += one * d.z;
	sum[3] += one * d.x;
	sum[4] += two * (d.x * d.y);
	sum[5] += two * (d.y * d.z);
	sum[6] += two * (3.0 * d.z * d.z - 1.0);
	sum[7] += two * (d.x * d.z);
	sum[8] += two * (d.x * d.x - d.y * d.y);
}

// The mean direction of what a link of a larger share of the sphere brings is not that to the middle of its leaf: what
// is near of it counts most.
const float LARGE_SHARE = 1.0 / 256.0;

// Part of it by one edge of the contour.
vec3 of_edge(vec3 u, vec3 v)
{
	vec3 w = cross(u, v);
	float s = length(w);
	return s > 0.0 ? w * (atan(s, dot(u, v)) / s) : vec3(0.0);
}

// The sum of all directions to a leaf's points, by solid angle: half the sum over its edges of the angle that each
// spans, along the normal of the plane through it (Lambert). Only its line counts: of two sides either may be seen.
vec3 directions_to(uint node, vec3 from, vec3 middle)
{
	uvec4 corners = topology_corners(node);
	vec3 a = load_world_vertex(corners.x).xyz - from, b = load_world_vertex(corners.y).xyz - from,
	     c = load_world_vertex(corners.z).xyz - from, d = load_world_vertex(corners.w).xyz - from;
	vec3 sum = of_edge(a, b) + of_edge(b, c) + of_edge(c, d) + of_edge(d, a);
	return dot(sum, middle) < 0.0 ? -sum : sum;
}

// Of the node that a link of weight w leads to: a leaf, or a patch of sky.
vec3 way_to(uint node, float w, vec3 from)
{
	bool sky = (topology_range(node).w & GI_NODE_SKY) != 0u;
	vec3 centre = world_sphere(node).xyz, d = sky ? centre : centre - from;
	if (w > LARGE_SHARE && !sky)
		d = directions_to(node, from, d);
	return d * inversesqrt(max(dot(d, d), 1e-30));
}

// Of c_lm: the constant of Y_lm, A_l, and 4 for the light that a share of the sphere brings.
const float SCALE[COEFFICIENTS] =
    float[](4.0 * PI * 0.282095, 8.0 * PI / 3.0 * 0.488603, 8.0 * PI / 3.0 * 0.488603, 8.0 * PI / 3.0 * 0.488603,
	    PI * 1.092548, PI * 1.092548, PI * 0.315392, PI * 1.092548, PI * 0.546274);

#ifdef PUNCTUAL
// Each as a cone of no width. What faces it gets an irradiance of color times share, a share w of the sphere 4 w B.
void add_lights(inout vec3 sum[COEFFICIENTS], uint receiver, vec3 from)
{
	const uint ON = GI_PUNCTUAL_THERE | GI_PUNCTUAL_ENABLED;
	for (uint k = 0u; k < light_count; k++) {
		uint kind = punctual_light_kind(k).x;
		if ((kind & ON) != ON || (kind & (GI_PUNCTUAL_BY_LEAVES | GI_PUNCTUAL_BY_PIXELS)) == 0u)
			continue;
		vec3 place = punctual_light_place(k).xyz,
		     to = (kind & GI_PUNCTUAL_DIRECTIONAL) != 0u ? place : place - from;
		vec3 light = punctual_light_color(k).xyz * load_punctual_share(k * rows + receiver);
		add(sum, 0.25 * light, to * inversesqrt(max(dot(to, to), 1e-30)), 0.0);
	}
}
#endif

void receive(uvec4 row, vec3 from, uint at, uint coefficients, uint receiver)
{
	vec3 sum[COEFFICIENTS];
	for (uint k = 0u; k < COEFFICIENTS; k++)
		sum[k] = vec3(0.0);
#ifdef PUNCTUAL
	add_lights(sum, receiver, from);
#endif
	for (uint k = row.x / 2u; 2u * k < row.x + (row.y & GI_BLOCK_COUNT_MASK); k++) {
		uvec4 two = load_two_links(k);
		if (is_specular(two)) {
			// From where it comes to the receiver the link does not say.
			sum[0] += weights_of(two) * load_radiosity(node_of(two)).xyz;
			continue;
		}
		float a = uintBitsToFloat(two.y), b = uintBitsToFloat(two.w);
		add(sum, a * load_radiosity(two.x).xyz, way_to(two.x, a, from), a);
		add(sum, b * load_radiosity(two.z).xyz, way_to(two.z, b, from), b);
	}
	for (uint k = 0u; k < coefficients; k++)
		received[at + k] = vec4(SCALE[k] * sum[k], k == 0u ? uintBitsToFloat(row.w & ~GI_ROW_OPEN) : 0.0);
}
#else
void receive(uvec4 row, uint at, uint receiver)
{
	vec3 h = vec3(0.0);
#ifdef PUNCTUAL
	h = load_punctual_sum(GI_PUNCTUAL_PARTS * receiver + GI_PUNCTUAL_ALL).xyz;
#endif
	for (uint k = row.x / 2u; 2u * k < row.x + (row.y & GI_BLOCK_COUNT_MASK); k++) {
		uvec4 two = load_two_links(k);
		if (is_specular(two)) {
			h += weights_of(two) * load_radiosity(node_of(two)).xyz;
			continue;
		}
		h += uintBitsToFloat(two.y) * load_radiosity(two.x).xyz;
		h += uintBitsToFloat(two.w) * load_radiosity(two.z).xyz;
	}
	received[at] = vec4(h, uintBitsToFloat(row.w & ~GI_ROW_OPEN));
}
#endif

void main()
{
	uint t = thread_number();
	if (t >= count)
		return;
	uvec4 mine = load_leaf(first + t), row = load_row(first + t), place = object_ids(mine.y);
	uint number = first + t - object_nodes(mine.y).z;
#ifdef HARMONICS
	receive(row, world_sphere(mine.x).xyz, place.z + place.w * number, place.w, first + t);
#else
	receive(row, place.z + number, first + t);
#endif
}
