// The share of a light without a surface that a point sees, by the light's depth maps (shade_shared.h).
//
// Percentage-closer soft shadows (Fernando, 2005): looks around the point's place in the map say how far off what hides
// the light is, and with that how wide the penumbra is that further looks average over. Texels are compared with the
// plane of the point's own surface, or it would hide itself where looks are wide.
//
// No light comes in along the edges of a room whose walls have no thickness: a look sees the light where all four
// texels about it do, so that no look does from behind an edge; and of looks no wider than texels, half of which may
// lie beyond the edge of what is next to the point, half have to see it before any light arrives.

layout(std140, binding = GI_UNIFORM_LAMP) uniform view_block { gi_punctual_view view; };
layout(binding = GI_UNIT_MAP_VALUES) uniform sampler2DArray depth_values;

const uint SEARCHES = 16u, LOOKS = 32u;

// Looks of a light of no size reach so far, texels: enough to hide the texels.
const float SHARP = 1.25;

// A point is moved along its normal by so many texels, times the sine to the light, and towards it by so many.
const float NORMAL_TEXELS = 1.0, DEPTH_TEXELS = 0.1;

// Steeper surfaces than this get hardly any light, and their planes would reach through others.
const float LEAST_FACING = 0.1;

// How much nearer than the point what hides it may be for its penumbra to be told: farther light is wider than maps
// show.
const float WIDEST_SEARCH = 3.0;

// A point as the maps see it.
struct map_place {
	float layer;
	vec2 uv;
	float distance; // e, or of a sun q.z
	float depth;
	vec2 slope;     // of the depth of the surface's plane, by uv
};

vec3 in_frame(vec4 p)
{
	return vec3(dot(view.frame_x, p), dot(view.frame_y, p), dot(view.frame_z, p));
}

map_place place_in_sun(vec3 q, vec3 m)
{
	vec2 t = (q.xy - view.tiles.xy) / view.tiles.z;
	vec2 tile = clamp(floor(t), vec2(0.0), vec2(float(GI_SUN_TILES - 1u)));
	float facing = min(m.z, -LEAST_FACING); // the light shines along +z
	map_place at;
	at.layer = float(view.layers.x) + tile.y * float(GI_SUN_TILES) + tile.x;
	at.uv = 0.5 + view.map.x * (t - tile - 0.5);
	at.distance = q.z;
	at.depth = view.depth.x + view.depth.y * (q.z - DEPTH_TEXELS * view.map.y);
	at.slope = -view.depth.y * m.xy / facing * (view.tiles.z / view.map.x);
	return at;
}

// On the plane m . p = c of the surface 1 / e is linear in uv.
map_place place_in_cube(vec3 q, vec3 m)
{
	vec3 size = abs(q);
	bool x = view.layers.y > 1u && size.x >= max(size.y, size.z), y = view.layers.y > 1u && !x && size.y >= size.z;
	vec3 turned = x ? q.yzx : y ? q.zxy : q, n = x ? m.yzx : y ? m.zxy : m;
	float face = x ? 0.0 : y ? 2.0 : 4.0, e = abs(turned.z);
	map_place at;
	at.layer = float(view.layers.x) + (view.layers.y > 1u ? face + (turned.z < 0.0 ? 1.0 : 0.0) : 0.0);
	at.uv = 0.5 + view.map.x * turned.xy / e;
	at.distance = e;
	at.depth = view.depth.x + view.depth.y / (e * (1.0 - DEPTH_TEXELS * view.map.y));
	float c = min(dot(m, q), -LEAST_FACING * length(q));
	at.slope = view.depth.y * n.xy / (c * view.map.x);
	return at;
}

// Even over the unit disc: Vogel's spiral.
vec2 on_spiral(uint k, uint count)
{
	float angle = 2.39996323 * float(k);
	return sqrt((float(k) + 0.5) / float(count)) * vec2(cos(angle), sin(angle));
}

// Depth of the surface's plane there, or of the point where that is nearer: what lies behind it hides nothing.
float depth_beside(map_place at, vec2 aside)
{
	return min(at.depth + min(dot(at.slope, aside), 0.0), 1.0);
}

bool sees_light(map_place at, vec2 aside)
{
	float size = view.map.w;
	vec2 first = floor((at.uv + aside) * size - 0.5);
	vec4 depth = textureGather(depth_values, vec3((first + 1.0) / size, at.layer));
	vec2 from = (first + 0.5) / size - at.uv, to = from + 1.0 / size;
	vec4 own = vec4(depth_beside(at, vec2(from.x, to.y)), depth_beside(at, to),
			depth_beside(at, vec2(to.x, from.y)), depth_beside(at, from));
	return all(greaterThanEqual(depth, own));
}

// How far off what hides the light is in the mean. False: nothing does.
bool find_blocker(map_place at, float reach, bool wanted, out float distance)
{
	float sum = 0.0, count = 0.0;
	for (uint k = wanted ? 0u : SEARCHES; k < SEARCHES; k++) {
		vec2 aside = reach * on_spiral(k, SEARCHES);
		float depth = texture(depth_values, vec3(at.uv + aside, at.layer)).x;
		bool hides = depth < depth_beside(at, aside);
		sum += hides ? depth : 0.0;
		count += hides ? 1.0 : 0.0;
	}
	float depth = sum / max(count, 1.0) - view.depth.x;
	distance = is_directional(view.light) ? depth / view.depth.y : view.depth.y / depth;
	return count > 0.0;
}

// Radius of the looks, uv, for a light of some size.
float penumbra(map_place at, float blocker)
{
	bool sun = is_directional(view.light);
	float behind = max(at.distance - blocker, 0.0);
	float wide = sun ? view.depth.z * behind * view.map.x / view.tiles.z
			 : view.map.x * view.depth.z * behind / (at.distance * blocker);
	return clamp(wide, SHARP / view.map.w, view.map.z - 1.0 / view.map.w);
}

float search_reach(map_place at)
{
	float wide = is_directional(view.light)
			 ? view.depth.z / abs(view.depth.y) * view.map.x / view.tiles.z
			 : WIDEST_SEARCH * view.map.x * view.depth.z / at.distance;
	return clamp(wide, SHARP / view.map.w, view.map.z - 1.0 / view.map.w);
}

float punctual_visibility(vec3 p, vec3 n, float cosine, bool wanted)
{
	bool sun = is_directional(view.light), soft = view.depth.z > 0.0;
	vec3 q = in_frame(vec4(p, 1.0)), m = in_frame(vec4(n, 0.0));
	float far = sun ? 1.0 : length(q);
	q += m * (view.map.y * far * NORMAL_TEXELS * sqrt(max(1.0 - cosine * cosine, 0.0)));
	map_place at;
	if (sun)
		at = place_in_sun(q, m);
	else
		at = place_in_cube(q, m);
	float blocker = at.distance;
	bool looks = wanted && (!soft || find_blocker(at, search_reach(at), wanted && soft, blocker));
	float reach = soft ? penumbra(at, blocker) : SHARP / view.map.w;
	float lit = 0.0;
	for (uint k = looks ? 0u : LOOKS; k < LOOKS; k++) {
		vec2 aside = reach * on_spiral(k, LOOKS);
		lit += sees_light(at, aside) ? 1.0 : 0.0;
	}
	float beyond = 0.5 * SHARP / (view.map.w * reach);
	return looks ? max(lit / float(LOOKS) - beyond, 0.0) / (1.0 - beyond) : 1.0;
}
