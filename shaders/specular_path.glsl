// What entries see in mirrors and through glass: each listed one's ray, that of the sample whose leaf is its target,
// goes on by reflection and refraction to the leaf, or the sky, where its light comes from. One thread an entry
// (specular_list.comp).
//
// At glass it goes one way, as often as that carries of the light; which is drawn by the entry's ids, evenly over those
// of a row: the same scene has the same paths. All of them are followed whenever anything changed.
//
// TOPS: as trace.glsl.
#define ROUND
#define READ_FRAME
#define READ_OBJECTS
#define READ_TOPOLOGY
#define READ_REST
#define READ_WORLD
#define READ_VERTICES_REST
#define READ_LEAVES
#define READ_LEAF_QUADS
#define READ_BVH
#define READ_PRIMITIVES
#define READ_TLAS
#define READ_ENTRIES
#define READ_QUEUE
#define READ_SMOOTH
#define READ_SMOOTH_MATERIALS
#define WRITE_SPECULAR_ENDS
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"
#include "entry.glsl"
#include "octahedron.glsl"
#include "sampling.glsl"
#include "rays.glsl"
#include "segments.glsl"
#include "visibility.glsl"
#include "samples.glsl"
#include "closest.glsl"
#include "locate.glsl"
#include "specular.glsl"
#include "sky_patch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform float lift;
layout(location = 1) uniform bool photons; // bring what emitters send through mirrors and glass (caustics.c)

// Surfaces that a path meets, the last one too: as many as photons do (caustic_trace.comp).
const uint STEPS = 16u;

// The sample whose leaf is the entry's target.
uint sample_taken(pair p, uvec4 entry)
{
	uint visible = entry.z & 0xFFFFu, seen = 0u, found = 0u;
	for (uint taken = 0u; taken < samples_of(entry); taken++) {
		if ((visible & (1u << taken)) == 0u)
			continue;
		found = takes_over(p.ids, taken, seen) ? taken : found;
		seen++;
	}
	return found;
}

// The ray of that sample, lifted off its leaf.
light_ray ray_of(pair p, uvec4 entry, uint k, bool emitter)
{
	segment_end a, b;
	body on = p.source;
	choose_segment(p, k, candidates_of(p, emitter), a, b, on);
	vec3 from = a.world + load_world(load_leaf(p.leaf).x).axis.xyz * lift;
	return light_ray(from, normalize(b.world - from), vec3(1.0));
}

float chance_of(uvec2 ids, uint k, uint step)
{
	uint start = hash(ids.x * 0x9e3779b9u ^ hash(step + 0x68bc21ebu));
	return unit_float(start + ids.y * ROOTS[step & 3u] + k * R4[step & 3u]);
}

struct path_end {
	uint node; // as x of a link
	vec3 throughput;
};

const path_end NOWHERE = path_end(0u, vec3(0.0));

// What lies beyond all objects.
path_end end_in_sky(vec3 direction, vec3 throughput)
{
	uint sky = frame.counts.z - 1u;
	bool there = (object_bvh(sky).z & GI_OBJECT_SKY) != 0u;
	return there ? path_end(sky_patch_towards(object_nodes(sky).x, direction), throughput) : NOWHERE;
}

// Behind the last mirror or glass, of object `last`. Photons go from an emitting object to others alone.
path_end end_on_leaf(nearest hit, uint first, light_ray r, uint last)
{
	if (!hit.front)
		return NOWHERE;
	uint leaf = leaf_at(hit.object, first, rest_from_world(hit.object, r.origin + r.direction * hit.distance));
	return path_end(load_leaf(leaf).x | (photons && last != hit.object ? GI_LINK_PHOTONS : 0u), r.throughput);
}

path_end follow(light_ray r, uvec2 ids, uint k, out uint rays)
{
	path_end end = NOWHERE;
	uint last = GI_NONE;
	bool on = true;
	rays = 0u;
	for (uint step = 0u; step < STEPS && on; step++) {
		nearest hit = find_nearest(r.origin, r.direction, lift);
		rays++;
		if (hit.object == GI_NONE) {
			end = last == GI_NONE ? NOWHERE : end_in_sky(r.direction, r.throughput);
			break;
		}
		uint first = floatBitsToUint(load_primitive(hit.primitive).a.w);
		gi_smooth_material m = load_smooth_material(load_leaf(first).z);
		if (is_smooth(m)) {
			last = hit.object;
			float chance = chance_of(ids, k, step);
			on = go_on(smooth_point_of(hit, r.direction), m, WAY_BY_CHANCE, chance, lift, r);
		} else {
			on = false;
			// A ray that rounding led past the mirror that its entry sees is no light through it.
			end = last == GI_NONE ? NOWHERE : end_on_leaf(hit, first, r, last);
		}
	}
	return end;
}

void main()
{
	uint t = thread_number();
	if (t >= state.counts.specular_paths)
		return;
	uint slot = load_queued(t);
	uvec4 entry = load_entry(slot), source = topology_range(entry.x);
	if (((source.w & GI_NODE_TOP) != 0u) != (TOPS == 1))
		return;
	pair p = load_pair(entry);
	bool emitter = is_bright(source.w);
	sampling rays = sampling_of(entry, source.w);
	uint k = sample_of(sample_taken(p, entry), is_reordered(rays, emitter, p.sky)), count;
	path_end end = follow(ray_of(p, entry, k, emitter), p.ids, k, count);
	uvec3 bits = uvec3(clamp(end.throughput, 0.0, 1.0) * 1023.0 + 0.5);
	specular_ends[slot] = uvec2(end.node | GI_LINK_SPECULAR, bits.x | bits.y << 10u | bits.z << 20u);
	atomicAdd(state.counts.rays, count);
}
