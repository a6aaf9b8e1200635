// What a leaf cannot have light from, whatever stands between: what lies below its plane, and what looks away from it.
// By the points that form factors are taken from and to (factor.glsl), where facing.glsl goes by balls and cones.

// The planes that a leaf's form factors are taken before, that of its mean normal or of its folded halves: normals, and
// in w the least height of a corner along them.
struct horizon {
	vec4 first, second;
};

vec4 plane_below(vec3 normal, vec3 a, vec3 b, vec3 c)
{
	return vec4(normal, min(dot(normal, a), min(dot(normal, b), dot(normal, c))));
}

horizon horizon_of(quad q, vec4 axis)
{
	vec3 abc = cross(q.b - q.a, q.c - q.a), acd = cross(q.c - q.a, q.d - q.a);
	bool folded = axis.w < FOLDED && length(abc) > 0.0 && length(acd) > 0.0;
	return horizon(plane_below(folded ? normalize(abc) : axis.xyz, q.a, q.b, q.c),
		       plane_below(folded ? normalize(acd) : axis.xyz, q.a, q.c, q.d));
}

// The most that any point of the leaf sees a point above it.
float height_above(horizon h, vec3 p)
{
	return max(dot(h.first.xyz, p) - h.first.w, dot(h.second.xyz, p) - h.second.w);
}

bool is_below(horizon h, quad q)
{
	return max(max(height_above(h, q.a), height_above(h, q.b)), max(height_above(h, q.c), height_above(h, q.d))) <=
	       0.0;
}

// Do both halves of a source look away from all of the receiver?
bool looks_away(quad source, quad receiver)
{
	vec3 abc = cross(source.b - source.a, source.c - source.a), acd = cross(source.c - source.a, source.d - source.a);
	vec3 a = receiver.a - source.a, b = receiver.b - source.a, c = receiver.c - source.a, d = receiver.d - source.a;
	return max(max(dot(abc, a), dot(abc, b)), max(dot(abc, c), dot(abc, d))) <= 0.0 &&
	       max(max(dot(acd, a), dot(acd, b)), max(dot(acd, c), dot(acd, d))) <= 0.0;
}
