// Of each leaf's row, the irradiance by exitance, which stays what it is while the solve works on reflected light: sum
// over links of weight * E, in double precision, the part of it by what is not drawn per pixel, and what the weights
// sum to less than 1, rounded down. Walks the rows that were closed, or with ALL every row. One thread a leaf.
//
// PUNCTUAL: lights without a surface light leaves too, and change more often than rows: what links bring is kept apart.
//
// Of all leaves: the largest light first reflected, s = rho * that, and the largest s / (1 - rho), which no reflected
// light exceeds: no row sums to more than 1, so what is brightest has R <= s + rho R.
#define READ_FRAME
#define READ_TOPOLOGY
#define READ_REST
#define READ_LEAVES
#define READ_MATERIALS
#define READ_ROWS
#define READ_LINKS
#define READ_NODE_EXITANCE
#define READ_LEAF_RADIOSITY
#define READ_TOUCHED
#ifdef SPECULAR
#define READ_CAUSTIC_LIGHT
#endif
#ifdef PUNCTUAL
#define READ_PUNCTUAL_SUMS
#define WRITE_LINKED_LIGHT
#endif
#define WRITE_LEAF_RADIOSITY
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"
#include "solve.glsl"
#include "numbers.glsl"
#ifdef SPECULAR
#include "specular_link.glsl"
#endif
#ifdef PUNCTUAL
#include "packed_light.glsl"
#endif

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint all;
#ifdef SPECULAR
layout(location = 1) uniform uint caustics_undrawn; // 1: no pixel is lit by them
layout(location = 2) uniform uint caustics;         // 1: there are some
#endif

const uint FOUND = 6u;
shared uint found[FOUND]; // rgb of gi_state_emitted: direct_bits, ceiling_bits

// More than a double's sum of ten thousand weights is off by, and than a float's rounding.
const double SUMMED = 1e-12lf, ROUNDED_DOWN = 1.0lf - 1.0lf / 4194304.0lf;

void add(inout dvec3 sum, inout dvec3 undrawn, uint node, uint weight)
{
	vec3 exitance = load_exitance(node).xyz;
	if (exitance == vec3(0.0))
		return;
	dvec3 light = double(uintBitsToFloat(weight)) * dvec3(exitance);
	sum += light;
	if ((topology_range(node).w & GI_NODE_LAMP) == 0u)
		undrawn += light;
}

#ifdef PUNCTUAL
void keep(uint leaf, dvec3 sum, dvec3 undrawn)
{
	vec3 high = to_single(dvec4(sum, 0.0lf)).xyz;
	linked_light[GI_LINKED_PARTS * leaf + GI_LINKED_HIGH] = vec4(high, 0.0);
	linked_light[GI_LINKED_PARTS * leaf + GI_LINKED_LOW] = vec4(vec3(sum - dvec3(high)), 0.0);
	linked_light[GI_LINKED_PARTS * leaf + GI_LINKED_UNDRAWN] = vec4(vec3(undrawn), 0.0);
}

// What links bring, as it was kept, and the lights.
vec3 add_lights(uint leaf)
{
	dvec3 sum = dvec3(linked_light[GI_LINKED_PARTS * leaf + GI_LINKED_HIGH].xyz) +
		    dvec3(linked_light[GI_LINKED_PARTS * leaf + GI_LINKED_LOW].xyz);
	vec3 undrawn = linked_light[GI_LINKED_PARTS * leaf + GI_LINKED_UNDRAWN].xyz;
	vec3 lights = load_punctual_sum(GI_PUNCTUAL_PARTS * leaf + GI_PUNCTUAL_ALL).xyz,
	     shown = load_punctual_sum(GI_PUNCTUAL_PARTS * leaf + GI_PUNCTUAL_SHOWN).xyz;
	vec3 emitted = to_single(dvec4(sum + dvec3(lights), 0.0lf)).xyz;
	float area = load_rest(load_leaf(leaf).x).moment.w;
	leaf_radiosity[GI_LEAF_EMITTED * frame.counts.x + leaf] = vec4(emitted, pack_light(lights));
	leaf_radiosity[GI_LEAF_UNDRAWN * frame.counts.x + leaf] = vec4(undrawn + shown, area);
	return emitted;
}
#endif

// heavy: the weights sum to more than 1.
vec3 walk(uint leaf, uvec4 row, out bool heavy)
{
	heavy = false;
	dvec3 sum = dvec3(0.0lf), undrawn = dvec3(0.0lf);
	double weights = 0.0lf;
	uint end = row.x + (row.y & GI_BLOCK_COUNT_MASK);
	uint k = row.x / 2u;
#ifdef SPECULAR
	for (; 2u * k < end; k++) {
		uvec4 link = load_two_links(k);
		if (!is_specular(link))
			break;
		bool counts = (link.x & GI_LINK_PHOTONS) == 0u;
		vec3 exitance = counts ? load_exitance(node_of(link)).xyz : vec3(0.0);
		dvec3 light = dvec3(weights_of(link)) * dvec3(exitance);
		sum += light;
		undrawn += light;
		weights += double(largest_weight_of(link));
	}
#endif
	for (; 2u * k < end; k++) {
		uvec4 two = load_two_links(k);
		add(sum, undrawn, two.x, two.y);
		add(sum, undrawn, two.z, two.w);
		weights += double(uintBitsToFloat(two.y));
		weights += double(uintBitsToFloat(two.w));
	}
#ifdef SPECULAR
	if (caustics != 0u) {
		sum += dvec3(load_caustic_light(leaf).xyz);
		undrawn += dvec3(caustics_undrawn != 0u ? load_caustic_light(leaf).xyz : vec3(0.0));
	}
#endif
	double lacks = 1.0lf - weights - SUMMED;
#ifdef SPECULAR
	// Less than nothing, of a row that sees a mirror in its own light.
	lacks *= lacks < 0.0lf ? 2.0lf - ROUNDED_DOWN : ROUNDED_DOWN;
	heavy = weights > 1.0lf;
#else
	lacks = max(lacks, 0.0lf) * ROUNDED_DOWN;
#endif
	leaf_radiosity[GI_LEAF_B * frame.counts.x + leaf].w = float(lacks);
#ifdef PUNCTUAL
	keep(leaf, sum, undrawn);
	return vec3(0.0);
#else
	vec3 emitted = to_single(dvec4(sum, 0.0lf)).xyz;
	leaf_radiosity[GI_LEAF_EMITTED * frame.counts.x + leaf] = vec4(emitted, 0.0);
	float area = load_rest(load_leaf(leaf).x).moment.w;
	leaf_radiosity[GI_LEAF_UNDRAWN * frame.counts.x + leaf] = vec4(undrawn, area);
	return emitted;
#endif
}

void report(uint leaf, vec3 emitted, bool heavy)
{
	vec3 rho = load_material(load_leaf(leaf).z).rho.xyz, s = OUTWARD * rho * emitted,
	     ceiling = OUTWARD * s / (1.0 - rho);
	if (heavy)
		ceiling = vec3(HUGE);
	for (uint c = 0u; c < 3u; c++) {
		atomicMax(found[c], floatBitsToUint(s[c]));
		atomicMax(found[3u + c], floatBitsToUint(ceiling[c]));
	}
}

void report_group()
{
	atomicMax(state.emitted.direct_bits.x, found[0]);
	atomicMax(state.emitted.direct_bits.y, found[1]);
	atomicMax(state.emitted.direct_bits.z, found[2]);
	atomicMax(state.emitted.ceiling_bits.x, found[3]);
	atomicMax(state.emitted.ceiling_bits.y, found[4]);
	atomicMax(state.emitted.ceiling_bits.z, found[5]);
}

void main()
{
	uint local = gl_LocalInvocationID.x, leaf = thread_number();
	if (local < FOUND)
		found[local] = 0u;
	barrier();
	if (leaf < frame.counts.x) {
		uvec4 row = load_row(leaf);
		bool stays = all == 0u && load_touched(frame.rows.x + leaf) == 0u;
		bool heavy = false;
		vec3 emitted = stays ? load_leaf_part(GI_LEAF_EMITTED, leaf).xyz : walk(leaf, row, heavy);
#ifdef PUNCTUAL
		emitted = add_lights(leaf);
#endif
		report(leaf, emitted, heavy);
	}
	barrier();
	if (local == 0u)
		report_group();
}
