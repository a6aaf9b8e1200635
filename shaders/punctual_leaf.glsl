// What a light without a surface brings to a leaf or a receiver, were its intensity 1: of a receiver that sees all
// round the irradiance of what faces the light there.
//
// E = G sum V w f / sum w over points of the leaf: G is what a light that shines alike all round brings with nothing in
// between, exactly: the solid angle of the leaf over its area, of a directional one the cosine. w is the part of each
// point in that, f the falloff (punctual.glsl), V whether a ray arrives.

const uint PUNCTUAL_SAMPLES = 16u;

// Sobol's second sequence: with the first, bits reversed, a net of all boxes of area 1/16.
const uvec4 SECOND = uvec4(0x80000000u, 0xC0000000u, 0xA0000000u, 0xF0000000u);

// Stands for no object, where a ray ends in mid air; the sky is GI_NONE.
const uint NOWHERE = 0xFFFFFFFEu;

// Of the k-th sample, in the leaf's square, and in that of the light's disc: the same of every leaf but for a shift of
// bits by its hash.
vec4 punctual_numbers(uint leaf, uint light, uint k)
{
	uvec4 shift = hashed_start(hash(leaf * 0x9e3779b9u ^ hash(light + 0x7f4a7c15u)));
	uint second = 0u;
	for (uint bit = 0u; bit < 4u; bit++)
		second ^= (k >> bit & 1u) != 0u ? SECOND[bit] : 0u;
	return unit_floats(uvec4(uvec2(bitfieldReverse(k), second) ^ shift.xy, shift.zw + k * R4.zw));
}

// The end of a ray at the light.
segment_end light_end(gi_punctual_light l, vec3 from, vec2 u)
{
	if (is_directional(l)) {
		vec3 direction = normalize(l.place.xyz + l.place.w * on_disc(l.place.xyz, u));
		return segment_end(GI_NONE, direction, direction);
	}
	vec3 p = l.place.xyz;
	if (l.place.w > 0.0)
		p += l.place.w * on_disc(normalize(from - p), u);
	return segment_end(GI_NONE, p, p);
}

body light_body(gi_punctual_light l)
{
	uint object = is_directional(l) ? GI_NONE : NOWHERE;
	return body(object, GI_OBJECT_FLAT, vec4(0.0), vec4(0.0), vec4(0.0));
}

bool light_is_hidden(body on, segment_end a, body to, segment_end b)
{
	bool sky = to.object == GI_NONE, own = (on.flags & GI_OBJECT_FLAT) == 0u, hidden = false;
	segment_goal goal = segment_goal(uvec2(load_leaf(a.leaf).w, GI_NONE), true);
	// A light may be outside of what encloses the scene.
	tree_walk walk = walk_of_scene(a.world, sky ? b.world : b.world - a.world, uvec2(0u, frame.misc.x));
	while (!hidden) {
		uint object = own ? on.object : next_third(walk, on, a, to, b);
		own = false;
		if (object == GI_NONE)
			break;
		hidden = object_hides(object, ray_for(load_body(object), on, a, to, b, goal));
	}
	return hidden;
}

// Solid angle of a triangle (Van Oosterom and Strackee, 1983) from the origin; negative seen from behind.
float solid_angle(vec3 a, vec3 b, vec3 c)
{
	float x = length(a), y = length(b), z = length(c);
	float volume = dot(a, cross(b - a, c - a)), rest = x * y * z + dot(a, b) * z + dot(b, c) * x + dot(c, a) * y;
	float t = volume / rest, square = t * t;
	// Of what is small Taylor's series: renderers' own tangents are off by some 1e-5.
	if (rest > 0.0 && square < 0.0625)
		return -2.0 * t * (1.0 - square * (1.0 / 3.0 - square * (0.2 - square * (1.0 / 7.0 - square / 9.0))));
	return -2.0 * atan(volume, rest);
}

// What arrives at the triangle with nothing in between, from an intensity of 1 all round, W.
float triangle_flux(gi_punctual_light l, vec3 a, vec3 b, vec3 c)
{
	if (is_directional(l))
		return max(0.5 * dot(cross(b - a, c - a), l.place.xyz), 0.0);
	return max(solid_angle(a - l.place.xyz, b - l.place.xyz, c - l.place.xyz), 0.0);
}

// The part of a point in the flux, next to others of the leaf; n is the normal there, as long as the triangle is large.
float part_of(gi_punctual_light l, vec3 p, vec3 n)
{
	if (is_directional(l))
		return max(dot(n, l.place.xyz), 0.0);
	vec3 to = l.place.xyz - p;
	float square = dot(to, to);
	return max(dot(n, to), 0.0) * inversesqrt(square) / square;
}

// The same of a point whatever the way it faces.
float flux_at_point(gi_punctual_light l, vec3 p)
{
	vec3 to = l.place.xyz - p;
	return is_directional(l) ? 1.0 : 1.0 / max(dot(to, to), 1e-30);
}

float share_of_leaf(uint leaf, gi_punctual_light l, inout uint rays)
{
	body on = load_body(load_leaf(leaf).y), to = light_body(l);
	quad q = load_leaf_quad(leaf);
	vec3 first = direction_to_world(on, cross(q.b - q.a, q.c - q.a)),
	     second = direction_to_world(on, cross(q.c - q.a, q.d - q.a));
	vec3 a = to_world(on, q.a), b = to_world(on, q.b), c = to_world(on, q.c), d = to_world(on, q.d);
	bool triangle = q.c == q.d, round = q.a == q.b;
	float flux = round ? flux_at_point(l, a)
			   : triangle_flux(l, a, b, c) + (triangle ? 0.0 : triangle_flux(l, a, c, d));
	if (flux == 0.0 || (on.flags & GI_OBJECT_UNSEEN) != 0u)
		return 0.0;
	uint id = leaf + object_ids(on.object).x;
	float arrives = 0.0, sum = 0.0;
	for (uint k = 0u; k < PUNCTUAL_SAMPLES; k++) {
		vec4 u = punctual_numbers(id, l.kind.y, k);
		segment_end from = end_on(on, leaf, point_on(q, u.xy));
		float part = round ? 1.0 : part_of(l, from.world, triangle || u.x >= u.y ? first : second);
		sum += part;
		float sent = part * punctual_falloff(l, from.world - l.place.xyz);
		if (sent == 0.0)
			continue;
		rays++;
		if (!light_is_hidden(on, from, to, light_end(l, from.world, u.zw)))
			arrives += sent;
	}
	float area = round ? 1.0 : 0.5 * (length(first) + (triangle ? 0.0 : length(second)));
	return sum > 0.0 ? flux / area * (arrives / sum) : 0.0;
}
