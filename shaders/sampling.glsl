// Where visibility rays begin and end: pure functions of (id of the receiver leaf, id of the source node, sample number), in
// the rest frames of their objects, so that a segment is the same in every frame, after every rebuild and every commit.

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

// Four numbers in [0,1): a hash of the pair, then the R4 sequence (Roberts) over the samples, which fills the square
// pair evenly.
vec4 sample_numbers(uint leaf, uint node, uint k)
{
	uint h = hash(leaf * 0x9e3779b9u ^ hash(node + 0x7f4a7c15u));
	uvec4 start = uvec4(h, hash(h ^ 1u), hash(h ^ 2u), hash(h ^ 3u));
	uvec4 next = start + k * uvec4(0xDB4F2A00u, 0xBBE05633u, 0xA0F2EC75u, 0x89E18285u);
	return vec4(unit_float(next.x), unit_float(next.y), unit_float(next.z), unit_float(next.w));
}

// The unit square onto the two triangles a b c and a c d: they, not a bilinear patch, are the surface that rays meet.
vec3 point_on_quad(vec3 a, vec3 b, vec3 c, vec3 d, vec2 u)
{
	if (c == d)
		u = vec2(max(u.x, u.y), min(u.x, u.y)); // a triangle
	return u.x >= u.y ? a + (b - a) * (u.x - u.y) + (c - a) * u.y : a + (d - a) * (u.y - u.x) + (c - a) * u.x;
}
