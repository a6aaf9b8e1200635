// Next-event estimation towards lights without a surface, for path tracing. Few are all asked, of many a few, drawn
// alike.

const uint MOST_ASKED = 4u;

// Is nothing in the way from a point on, for ever?
bool direction_is_free(vec3 from, vec3 direction)
{
	tree_walk walk = walk_of_scene(from, direction, uvec2(0u, frame.misc.x));
	bool free = true;
	while (free) {
		uint object = next_object(walk, 3e38);
		if (object == GI_NONE)
			break;
		tree_ray ray = tree_ray(rest_from_world(object, from), rest_direction_from_world(object, direction),
					3e38, 3e38, vec2(0.0), uvec2(GI_NONE), true);
		free = !object_hides(object, ray);
	}
	return free;
}

vec3 light_from_one(vertex v, gi_punctual_light l, vec2 u)
{
	const uint ON = GI_PUNCTUAL_THERE | GI_PUNCTUAL_ENABLED;
	vec3 to = is_directional(l) ? l.place.xyz : l.place.xyz - v.origin;
	float square = dot(to, to), cosine = dot(v.normal, to) * inversesqrt(max(square, 1e-30));
	float factor = is_directional(l) ? 1.0 : punctual_falloff(l, -to) / max(square, 1e-30);
	if ((l.kind.x & ON) != ON || !(cosine > 0.0) || factor == 0.0)
		return vec3(0.0);
	vec3 aside = l.place.w > 0.0 ? l.place.w * on_disc(normalize(to), u) : vec3(0.0);
	bool free = is_directional(l) ? direction_is_free(v.origin, normalize(to + aside))
				      : segment_is_free(v.origin, l.place.xyz + aside, GI_NONE, sky_and_lift.w);
	return free ? l.color.xyz * (factor * cosine) : vec3(0.0);
}

// Irradiance of a path's vertex.
vec3 light_from_punctual(vertex v, numbers u, uint count)
{
	uvec4 n = pcg4d(uvec4(u.emitter, floatBitsToUint(u.roulette), seed, 0x9e3779b9u));
	uint asked = min(count, MOST_ASKED), first = count > MOST_ASKED ? n.z % count : 0u;
	vec3 sum = vec3(0.0);
	for (uint k = 0u; k < asked; k++) {
		sum += light_from_one(v, load_punctual_light((first + k) % count), vec2(unit(n.x), unit(n.y)));
		n = pcg4d(n);
	}
	return sum * (float(count) / float(asked));
}
