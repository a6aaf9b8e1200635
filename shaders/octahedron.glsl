// Directions as points of the square [-1, 1]^2: the octahedron |x| + |y| + |z| = 1, its lower half folded out (Meyer,
// Suessmuth, Sussner, Stamminger and Greiner, On floating-point normal vectors, 2010).

vec2 folded(vec2 p)
{
	return (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
}

vec2 octahedron_from_direction(vec3 d)
{
	vec2 p = d.xy / max(abs(d.x) + abs(d.y) + abs(d.z), 1e-30);
	return d.z < 0.0 ? folded(p) : p;
}

// Unit.
vec3 direction_from_octahedron(vec2 p)
{
	float z = 1.0 - abs(p.x) - abs(p.y);
	return normalize(vec3(z < 0.0 ? folded(p) : p, z));
}
