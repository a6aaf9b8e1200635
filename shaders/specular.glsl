// Light at mirrors and glass: where a ray that met one goes on.

bool is_glass(gi_smooth_material m)
{
	return m.transmittance.xyz != vec3(0.0);
}

bool is_smooth(gi_smooth_material m)
{
	return is_glass(m) || m.specular.xyz != vec3(0.0);
}

// Share of unpolarised light that is reflected, by Fresnel's equations (Born and Wolf, Principles of Optics, 7th
// edition, 1.5.2); cosine of the angle of incidence, index of what is behind over that of what is before.
float fresnel(float cosine, float index)
{
	float sine2 = (1.0 - cosine * cosine) / (index * index);
	if (sine2 >= 1.0)
		return 1.0;
	float inside = sqrt(1.0 - sine2);
	float parallel = (index * cosine - inside) / (index * cosine + inside);
	float perpendicular = (cosine - index * inside) / (cosine + index * inside);
	return 0.5 * (parallel * parallel + perpendicular * perpendicular);
}

struct light_ray {
	vec3 origin, direction;
	vec3 throughput;
};

// Which of both ways: one by chance, as often as it carries of the light; or a given one, or the one that carries more,
// with what it carries.
const uint WAY_BY_CHANCE = 0u, WAY_REFLECTED = 1u, WAY_REFRACTED = 2u, WAY_LARGER = 3u;

vec3 smooth_normal(nearest hit)
{
	uvec4 corners = load_smooth_normals(hit.primitive);
	vec3 a = direction_from_octahedron(unpackSnorm2x16(corners.x)),
	     b = direction_from_octahedron(unpackSnorm2x16(hit.second ? corners.z : corners.y)),
	     c = direction_from_octahedron(unpackSnorm2x16(hit.second ? corners.w : corners.z));
	vec3 n = a + (b - a) * hit.barycentric.x + (c - a) * hit.barycentric.y;
	return normalize(world_direction_from_rest(hit.object, n));
}

// What a ray met, or a pixel shows: a point, its normals, both against the ray, and whether it is the front.
struct smooth_point {
	vec3 at, flat_normal, normal;
	bool front;
};

smooth_point smooth_point_of(nearest hit, vec3 direction)
{
	gi_primitive q = load_primitive(hit.primitive);
	vec3 a = q.a.xyz, b = hit.second ? q.c.xyz : q.b.xyz, c = hit.second ? q.d.xyz : q.c.xyz;
	vec3 at = world_from_rest(hit.object, a + (b - a) * hit.barycentric.x + (c - a) * hit.barycentric.y);
	float side = hit.front ? 1.0 : -1.0;
	vec3 flat_normal = side * normalize(world_direction_from_rest(hit.object, cross(b - a, c - a)));
	vec3 n = side * smooth_normal(hit);
	// At the rim of a round object the smooth normal may look away.
	return smooth_point(at, flat_normal, dot(n, direction) < 0.0 ? n : flat_normal, hit.front);
}

// False where the light ends: at the back of a mirror, or where the way is closed.
bool go_on(smooth_point p, gi_smooth_material m, uint way, float chance, float lift, inout light_ray r)
{
	bool glass = is_glass(m);
	if (!glass && !p.front)
		return false;
	float cosine = min(-dot(r.direction, p.normal), 1.0), index = p.front ? m.specular.w : 1.0 / m.specular.w;
	float reflected = glass ? fresnel(cosine, index) : 1.0;
	bool reflects = way == WAY_REFLECTED || (way == WAY_BY_CHANCE && chance < reflected) ||
			(way == WAY_LARGER && reflected >= 0.5);
	if (!reflects && reflected >= 1.0)
		return false;
	vec3 tint = reflects ? (glass ? vec3(1.0) : m.specular.xyz) : m.transmittance.xyz;
	r.throughput *= way == WAY_BY_CHANCE ? tint : tint * (reflects ? reflected : 1.0 - reflected);
	float inside = sqrt(max(1.0 - (1.0 - cosine * cosine) / (index * index), 0.0));
	vec3 ahead = reflects ? r.direction + 2.0 * cosine * p.normal
			      : r.direction / index + p.normal * (cosine / index - inside);
	// A smooth normal may lead through a leaf where light is reflected by it, or back where it is refracted.
	float along = dot(ahead, p.flat_normal), least = 1e-3;
	ahead += p.flat_normal * (reflects ? max(least - along, 0.0) : min(-least - along, 0.0));
	r.direction = normalize(ahead);
	r.origin = p.at + p.flat_normal * (reflects ? lift : -lift);
	return true;
}
