// A sweep, the gather: T R of every leaf, T R_i = s_i + rho_i * sum over links of weight * R_node, and the next R from
// it. One thread a leaf. R = B - E is the light reflected, s = rho * irradiance by exitance that first reflected
// (emitted.comp): what a lamp gives is in no sum, so rounding is relative to the light that arrives, however bright the
// lamp.
//
// Next is T R for omega 1 (Jacobi), for more a step of Chebyshev's, omega (T R - R_before) + R_before, for less a
// damped one, omega (T R - R) + R (check.comp). It stays where the solution is known to be: no less than s, no more
// than the ceilings. Sums have terms of one sign only.
//
// The fourth channel solves v = 1 + rho_max * sum of weight * v_node along with R: how much the scene amplifies.
//
// With it comes the irradiance of everything but what is drawn per pixel, at the R before the sweep, and what bounds
// the error: all that is reported holds however REAL rounds: a sum by ROUNDING_OF_REAL a term, a few operations and
// roots by SLACK_OF_REAL.
#define READ_FRAME
#define READ_LEAVES
#define READ_MATERIALS
#define READ_ROWS
#define READ_LINKS
#define READ_RADIOSITY
#define READ_LEAF_RADIOSITY
#define READ_STATE
#define WRITE_LEAF_RADIOSITY
#define WRITE_LEAF_INDIRECT
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"
#include "solve.glsl"
#include "numbers.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

// What the group's leaves found, value by value of gi_state_found; of the last two the least is wanted.
const uint FOUND_LARGEST_R = 0u, FOUND_LARGEST_B = 3u, FOUND_LARGEST_V = 4u, FOUND_RESIDUAL = 5u, FOUND_KAPPA = 6u;
const uint FOUND_NOISE = 7u, FOUND_SPREAD = 8u, FOUND_WRITE = 9u, FOUND_STRAY = 10u, FOUND_GAP = 11u;
const uint FOUND_DESCENT = 12u, FOUND_COUNT = 13u;
shared float found[FOUND_COUNT * GI_GROUP_SIZE];

// More than a float is off by after a conversion, a division and a root.
const float SLACK = 1e-6;

struct gathered {
	REAL4 sum;  // of weight * R_node, and of weight * v_node
	uint count; // of links
};

gathered gather(uint leaf)
{
	uvec4 row = load_row(leaf);
	gathered g = gathered(REAL4(0.0), row.y & GI_BLOCK_COUNT_MASK);
	uint reflected = GI_NODE_R * frame.counts.y;
	for (uint k = row.x / 2u; 2u * k < row.x + g.count; k++) {
		uvec4 two = load_two_links(k);
		g.sum += REAL(uintBitsToFloat(two.y)) * REAL4(load_radiosity(reflected + two.x));
		g.sum += REAL(uintBitsToFloat(two.w)) * REAL4(load_radiosity(reflected + two.z));
	}
	return g;
}

void report_exactly(uint which, float value)
{
	found[which * GI_GROUP_SIZE + gl_LocalInvocationID.x] = value;
}

void report_largest(uint which, REAL value)
{
	report_exactly(which, value > REAL(0.0) ? min(float(value) * (1.0 + SLACK), HUGE) + LEAST_NORMAL : 0.0);
}

REAL largest(REAL3 x)
{
	return max(x.x, max(x.y, x.z));
}

// Of x >= 0, the largest of three; what is nothing is no part of nothing.
REAL ratio(REAL3 x, REAL3 of)
{
	REAL most = REAL(0.0);
	for (uint c = 0u; c < 3u; c++)
		if (x[c] > REAL(0.0))
			most = max(most, of[c] > x[c] / REAL(HUGE) ? x[c] / of[c] : REAL(HUGE));
	return most;
}

// What a sweep worked with, and bounds on how far arrived and image may be off.
struct swept {
	REAL4 before, arrived, image; // R and v; rho * sum; T R
	REAL4 arrived_doubt, doubt;
	REAL3 row_sum, gap;           // rho * the row's sum, rounded up; 1 - that, rounded down
};

// Nodes are off by ROUNDING of their means, all terms of the sums are >= 0 and n of them, and what is done with the
// sum, add n ROUNDING_OF_REAL; what is below the least normal float may be lost, and nodes are off by as much. The
// irradiance by exitance is off by ROUNDING twice: means and store. A leaf that sees nothing has R = 0, exactly, and so
// have all where nothing is lit.
swept work_out(gathered g, REAL lacks, REAL4 rho, REAL4 source, vec4 before, vec3 ceiling)
{
	swept s;
	s.before = REAL4(before);
	s.arrived = rho * g.sum;
	s.image = source + s.arrived;
	REAL terms = g.count == 0u ? REAL(0.0) : REAL(g.count + 16u), relative = terms * ROUNDING_OF_REAL;
	REAL4 lost = terms * REAL(LEAST_NORMAL) * REAL4(vec4(greaterThan(vec4(ceiling, 1.0), vec4(0.0))));
	s.arrived_doubt = (REAL(ROUNDING) + relative) * s.arrived + lost;
	s.doubt = s.arrived_doubt + REAL(4.0) * ROUNDING_OF_REAL * s.image + lost;
	s.doubt.xyz += REAL(2.1 * ROUNDING) * source.xyz;
	s.row_sum = rho.xyz * (REAL(1.0) - lacks) * (REAL(1.0) + REAL(4.0) * ROUNDING_OF_REAL);
	s.gap = ((REAL(1.0) - rho.xyz) + rho.xyz * lacks) * (REAL(1.0) - REAL(4.0) * ROUNDING_OF_REAL);
	return s;
}

// Errors count by u = R + sqrt(largest R * R) + theta * largest R * v, channel by channel (check.comp). Means of a root
// are at most the root of the mean, so that M u is at least what u has of its own less what is seen of others'.
void report_errors(swept s, vec3 next, vec3 b)
{
	REAL3 scale = REAL3(state_before.solve.scale.xyz),
	      mix_in = REAL(state_before.solve.theta) * scale;
	REAL4 most = s.arrived + s.arrived_doubt;
	REAL3 own = s.before.xyz + sqrt(scale) * sqrt(s.before.xyz) + mix_in * s.before.w;
	REAL3 seen = most.xyz + sqrt(scale) * sqrt(s.row_sum * most.xyz) + mix_in * most.w;
	own *= REAL(1.0) - SLACK_OF_REAL;
	seen *= REAL(1.0) + SLACK_OF_REAL;
	REAL3 mu = own - seen;
	REAL3 light = REAL3(next) + REAL(GI_DARK_SHARE) * scale;
	REAL3 residual = abs(s.image.xyz - s.before.xyz) + s.doubt.xyz,
	      off = abs(REAL3(next) - s.image.xyz) + s.doubt.xyz;
	report_largest(FOUND_RESIDUAL, largest(residual));
	report_largest(FOUND_KAPPA, ratio(residual, mu));
	report_largest(FOUND_NOISE, ratio(REAL(ROUNDING) * s.image.xyz + s.doubt.xyz, mu));
	report_largest(FOUND_SPREAD, ratio(seen, light));
	report_largest(FOUND_STRAY, ratio(off, light));
	report_largest(FOUND_WRITE,
		       largest(off + REAL(ROUNDING) * REAL3(mix(vec3(0.0), b, greaterThan(next, vec3(0.0))))));
}

void report(swept s, vec4 next, vec3 b)
{
	report_errors(s, next.xyz, b);
	for (uint c = 0u; c < 3u; c++)
		report_exactly(FOUND_LARGEST_R + c, next[c]);
	report_exactly(FOUND_LARGEST_B, max(b.x, max(b.y, b.z)));
	report_exactly(FOUND_LARGEST_V, float(s.before.w));
	// Rounded on the way to a float, which check.comp allows for.
	report_exactly(FOUND_GAP, float(min(s.gap.x, min(s.gap.y, s.gap.z))));
	REAL descent = s.before.w * (REAL(1.0) - SLACK_OF_REAL) - s.arrived.w - s.arrived_doubt.w;
	report_exactly(FOUND_DESCENT, max(float(descent), 0.0));
}

// Within what the solution is within; v likewise.
REAL4 confined(REAL4 r, REAL4 source, vec3 ceiling, vec3 exitance)
{
	vec4 most = vec4(max(min(ceiling, frame.ceiling.xyz - exitance), vec3(0.0)), frame.ceiling.w);
	return min(max(r, source), REAL4(most));
}

void store(uint leaf, vec4 before, vec4 next, vec3 b, float lacks)
{
	leaf_radiosity[GI_LEAF_R * frame.counts.x + leaf] = next;
	leaf_radiosity[GI_LEAF_BEFORE * frame.counts.x + leaf] = before;
	leaf_radiosity[GI_LEAF_B * frame.counts.x + leaf] = vec4(b, lacks);
}

// R and v, by what T makes of them.
REAL4 step_from(swept s, uint leaf)
{
	REAL omega = REAL(state_before.solve.omega);
	if (omega == REAL(1.0))
		return s.image;
	REAL4 earlier = omega < REAL(1.0) ? s.before : REAL4(load_leaf_part(GI_LEAF_BEFORE, leaf));
	return omega * (s.image - earlier) + earlier;
}

void sweep(uint leaf, uint action)
{
	gathered g = gather(leaf);
	gi_material_data m = load_material(load_leaf(leaf).z);
	vec4 before = load_leaf_part(GI_LEAF_R, leaf);
	if ((action & GI_ACTION_KEEP) != 0u)
		leaf_radiosity[GI_LEAF_KEPT * frame.counts.x + leaf] = before;
	leaf_indirect[leaf] = vec4(vec3(g.sum.xyz) + load_leaf_part(GI_LEAF_UNDRAWN, leaf).xyz, 0.0);
	vec3 ceiling = uintBitsToFloat(state_before.emitted.ceiling_bits.xyz);
	REAL4 rho = REAL4(vec4(m.rho.xyz, max(m.rho.x, max(m.rho.y, m.rho.z))));
	REAL4 source = REAL4(vec4(m.rho.xyz, 1.0)) * REAL4(vec4(load_leaf_part(GI_LEAF_EMITTED, leaf).xyz, 1.0));
	float lacks = load_leaf_part(GI_LEAF_B, leaf).w;
	swept s = work_out(g, REAL(lacks), rho, source, before, ceiling);
	vec4 next = to_single(confined(step_from(s, leaf), source, ceiling, m.exitance.xyz));
	bool finite = !any(isnan(next)) && !any(isinf(next));
	if (!finite) {
		atomicOr(state.counts.not_finite, 1u);
		next = before = vec4(0.0, 0.0, 0.0, 1.0);
	}
	vec3 b = m.exitance.xyz + next.xyz;
	store(leaf, before, next, b, lacks);
	if (finite)
		report(s, next, b);
}

// Of T R and T v of the last sweep, T (a R + b v + c): T R - s and T v - 1 are linear in R and v. Channel by channel it
// stays 0 where no light came to, for 1 and v are positive in rooms that no light reaches too; and what light of before
// there is, in rooms that may be sealed by now, is raised only where light first arrives: no more than R or T R
// elsewhere.
vec4 scaled(vec4 before, vec4 swept, vec3 rho, vec3 source, float row_sum)
{
	vec3 by_v = rho * ((swept.w - 1.0) / max(max(rho.x, max(rho.y, rho.z)), 1e-20));
	vec3 r =
	    source + state_before.start.factor.xyz * (swept.xyz - source) + state_before.start.lift.xyz * by_v;
	r += state_before.start.base.xyz * rho * row_sum;
	if (state_before.solve.start == GI_START_WARM)
		r = mix(min(r, max(before.xyz, swept.xyz)), r, greaterThan(source, vec3(0.0)));
	r = mix(vec3(0.0), r, greaterThan(swept.xyz, vec3(0.0)));
	float v = state_before.solve.keeps_v != 0u ? swept.w : 1.0 + max(rho.x, max(rho.y, rho.z)) * row_sum;
	return vec4(r, v);
}

// Instead of a sweep: the R that was kept, what the last sweep would have made of another R, or a cold start.
void go_back(uint leaf, uint action)
{
	gi_material_data m = load_material(load_leaf(leaf).z);
	vec4 r = load_leaf_part((action & GI_ACTION_RECALL) != 0u ? GI_LEAF_KEPT : GI_LEAF_R, leaf);
	float lacks = load_leaf_part(GI_LEAF_B, leaf).w;
	vec4 source = vec4(m.rho.xyz * load_leaf_part(GI_LEAF_EMITTED, leaf).xyz, 1.0);
	if ((action & GI_ACTION_COLD) != 0u)
		r = source;
	else if ((action & GI_ACTION_SCALE) != 0u)
		r = scaled(load_leaf_part(GI_LEAF_BEFORE, leaf), r, m.rho.xyz, source.xyz, 1.0 - lacks);
	vec4 next = to_single(vec4(
	    confined(REAL4(r), REAL4(source), uintBitsToFloat(state_before.emitted.ceiling_bits.xyz), m.exitance.xyz)));
	store(leaf, next, next, m.exitance.xyz + next.xyz, lacks);
}

// Of a leaf that is none.
void report_nothing()
{
	for (uint k = 0u; k < FOUND_COUNT; k++)
		report_exactly(k, k < FOUND_GAP ? 0.0 : HUGE);
}

// Of the group, in its first place.
void join(uint which)
{
	float value = found[which * GI_GROUP_SIZE];
	for (uint k = 1u; k < GI_GROUP_SIZE; k++) {
		float other = found[which * GI_GROUP_SIZE + k];
		value = which < FOUND_GAP ? max(value, other) : min(value, other);
	}
	found[which * GI_GROUP_SIZE] = value;
}

uint joined_bits(uint which)
{
	return floatBitsToUint(found[which * GI_GROUP_SIZE]);
}

// Floats >= 0 order as their bits do, so the results have no order.
void report_group()
{
	atomicMax(state.found.largest_r_bits.x, joined_bits(FOUND_LARGEST_R));
	atomicMax(state.found.largest_r_bits.y, joined_bits(FOUND_LARGEST_R + 1u));
	atomicMax(state.found.largest_r_bits.z, joined_bits(FOUND_LARGEST_R + 2u));
	atomicMax(state.found.largest_b_bits, joined_bits(FOUND_LARGEST_B));
	atomicMax(state.found.largest_v_bits, joined_bits(FOUND_LARGEST_V));
	atomicMax(state.found.residual_bits, joined_bits(FOUND_RESIDUAL));
	atomicMax(state.found.kappa_bits, joined_bits(FOUND_KAPPA));
	atomicMax(state.found.noise_bits, joined_bits(FOUND_NOISE));
	atomicMax(state.found.spread_bits, joined_bits(FOUND_SPREAD));
	atomicMax(state.found.write_bits, joined_bits(FOUND_WRITE));
	atomicMax(state.found.stray_bits, joined_bits(FOUND_STRAY));
	atomicMin(state.found.gap_bits, joined_bits(FOUND_GAP));
	atomicMin(state.found.descent_bits, joined_bits(FOUND_DESCENT));
}

void main()
{
	report_nothing();
	uint leaf = thread_number(), action = state_before.solve.action;
	if (leaf < frame.counts.x && action > GI_ACTION_KEEP)
		go_back(leaf, action);
	else if (leaf < frame.counts.x)
		sweep(leaf, action);
	barrier();
	if (gl_LocalInvocationID.x < FOUND_COUNT)
		join(gl_LocalInvocationID.x);
	barrier();
	if (gl_LocalInvocationID.x == 0u)
		report_group();
}
