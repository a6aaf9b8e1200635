// Where visibility rays begin and end: pure functions of (id of the receiver leaf, id of the source node, sample
// number), in the rest frames of their objects, so that a segment is the same in every frame, after every rebuild and
// every commit.

uint hash(uint x)
{
	// The finaliser of MurmurHash3 (Appleby): every input bit changes every output bit with probability near 1/2.
	x ^= x >> 16;
	x *= 0x85ebca6bu;
	x ^= x >> 13;
	x *= 0xc2b2ae35u;
	return x ^ (x >> 16);
}

float unit_float(uint x)
{
	return float(x >> 8) * (1.0 / 16777216.0);
}

uvec4 hashed_start(uint h)
{
	return uvec4(h, hash(h ^ 1u), hash(h ^ 2u), hash(h ^ 3u));
}

vec4 unit_floats(uvec4 x)
{
	return vec4(unit_float(x.x), unit_float(x.y), unit_float(x.z), unit_float(x.w));
}

// The R4 sequence (Roberts), which fills the square pair evenly.
const uvec4 R4 = uvec4(0xDB4F2A00u, 0xBBE05633u, 0xA0F2EC75u, 0x89E18285u);

// Fractions of the roots of 2, 3, 5 and 7: a Kronecker sequence, also over every fifth and every 21st node, as
// quadtrees number them.
const uvec4 ROOTS = uvec4(0x6A09E668u, 0xBB67AE86u, 0x3C6EF373u, 0xA54FF53Au);

// Of the k-th sample of a pair: a hash of it, then R4 over its samples.
vec4 sample_numbers(uint leaf, uint node, uint k)
{
	return unit_floats(hashed_start(hash(leaf * 0x9e3779b9u ^ hash(node + 0x7f4a7c15u))) + k * R4);
}

// Of the k-th segment from a leaf to a node, and of the attempts to draw it: a hash of the leaf, even over the nodes
// too. Entries side by side have a ray or two each, and what a wall with a hole lets through of them all is their sum.
vec4 segment_numbers(uint leaf, uint node, uint attempt, uint k)
{
	return unit_floats(hashed_start(hash(leaf * 0x9e3779b9u ^ hash(attempt + 0x7f4a7c15u))) + node * ROOTS +
			   k * R4);
}

// The unit square onto the two triangles a b c and a c d: they, not a bilinear patch, are the surface that rays meet.
vec3 point_on_quad(vec3 a, vec3 b, vec3 c, vec3 d, vec2 u)
{
	if (c == d)
		u = vec2(max(u.x, u.y), min(u.x, u.y)); // a triangle
	return u.x >= u.y ? a + (b - a) * (u.x - u.y) + (c - a) * u.y : a + (d - a) * (u.y - u.x) + (c - a) * u.x;
}
