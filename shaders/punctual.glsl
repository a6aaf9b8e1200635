// Lights without a surface (gi_light): what one sends to a point, with nothing in between.

bool is_directional(gi_punctual_light l)
{
	return (l.kind.x & GI_PUNCTUAL_DIRECTIONAL) != 0u;
}

// Even over the unit disc about the direction n.
vec3 on_disc(vec3 n, vec2 u)
{
	vec3 x = normalize(abs(n.x) > 0.5 ? vec3(-n.y, n.x, 0.0) : vec3(0.0, -n.z, n.y));
	float radius = sqrt(u.x), turn = 6.28318530717959 * u.y;
	return radius * (cos(turn) * x + sin(turn) * cross(n, x));
}

// By which what arrives differs from that of a point that shines all round: a spot's falloff from its axis, and what
// the range leaves, both as glTF's KHR_lights_punctual has them. `to` goes from the light to the point.
float punctual_falloff(gi_punctual_light l, vec3 to)
{
	if (is_directional(l))
		return 1.0;
	float square = dot(to, to), cosine = dot(l.axis.xyz, to) * inversesqrt(max(square, 1e-30));
	float cone = clamp(cosine * l.cone.x + l.cone.y, 0.0, 1.0), far = square * l.axis.w;
	return cone * cone * max(1.0 - far * far, 0.0);
}
