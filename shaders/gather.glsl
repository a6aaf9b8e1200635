// A sweep, the gather: T R of every leaf, T R_i = s_i + rho_i * sum over links of weight * R_node, and the next R from it.
// One thread a leaf. R = B - E is the light reflected, s = rho * irradiance by exitance that first reflected (emitted.comp):
// what a lamp gives is in no sum, so rounding is relative to the light that arrives, however bright the lamp.
//
// Next is T R for omega 1 (Jacobi), for more a step of Chebyshev's, omega (T R - R_before) + R_before, for less a
// damped one, omega (T R - R) + R (check.comp). It stays where the solution is known to be: no less than s, no more than
// the ceilings. Sums have terms of one sign only.
//
// SUM is what links are summed in, REAL everything else. With CERTIFY the irradiance of everything but what is drawn per
// pixel comes with it, at the R before the sweep and at no walk of its own.
//
// The fourth channel solves v = 1 + rho_max * sum of weight * v_node along with R: how much the scene amplifies.
#define READ_FRAME
#define READ_LEAVES
#define READ_MATERIALS
#define READ_ROWS
#define READ_LINKS
#define READ_RADIOSITY
#define READ_LEAF_RADIOSITY
#define READ_STATE
#define WRITE_LEAF_RADIOSITY
#define WRITE_STATE
#ifdef CERTIFY
#define WRITE_LEAF_INDIRECT
#endif
#include "buffers.glsl"
#include "dispatch.glsl"
#include "solve.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

shared uint group_largest[GI_STATE_LARGEST];
shared uint group_least[GI_STATE_LEAST];

const uint INFINITY_BITS = 0x7F800000u;
const float HUGE = 3e38;

struct gathered {
	SUM4 sum;    // of weight * R_node, and of weight * v_node
	SUM row_sum; // of weights
	uint count;  // of links
};

gathered gather(uint leaf)
{
	uvec4 row = load_row(leaf);
	gathered g = gathered(SUM4(0.0), SUM(0.0), row.y & GI_BLOCK_COUNT_MASK);
	uint reflected = GI_NODE_R * frame.counts.y;
	for (uint k = row.x / 2u; 2u * k < row.x + g.count; k++) {
		uvec4 two = load_two_links(k);
		SUM first = SUM(uintBitsToFloat(two.y)), second = SUM(uintBitsToFloat(two.w));
		g.sum += first * SUM4(load_radiosity(reflected + two.x));
		g.sum += second * SUM4(load_radiosity(reflected + two.z));
#ifdef CERTIFY
		g.row_sum += first;
		g.row_sum += second;
#endif
	}
#ifndef CERTIFY
	g.row_sum = uintBitsToFloat(row.w);
#endif
	return g;
}

// Floats >= 0 order as their bits do, so the results have no order.
void report_largest(uint word, float value)
{
	atomicMax(group_largest[word - GI_STATE_RESIDUAL_BITS], floatBitsToUint(value));
}

void report_least(uint word, float value)
{
	atomicMin(group_least[word - GI_STATE_GAP_BITS], floatBitsToUint(max(value, 0.0)));
}

// A float no less, and one no greater: the conversion is off by 2^-24 of it, or lost below the least normal float.
float outward(REAL x)
{
	return x > REAL(0.0) ? min(float(x), HUGE) * (1.0 + 2.3841858e-7) + LEAST_NORMAL : 0.0;
}

float inward(REAL x)
{
	return max(float(x) * (1.0 - 2.3841858e-7) - LEAST_NORMAL, 0.0);
}

// Of a x >= 0; what is nothing is no part of nothing.
float ratio(REAL x, REAL of)
{
	return x <= REAL(0.0) ? 0.0 : of > x / REAL(HUGE) ? outward(x / of) : HUGE;
}

// What a sweep worked with: the leaf's, and bounds on how far the results may be off.
struct swept {
	REAL4 rho, source, before, arrived, image;
	REAL4 link_doubt, doubt, floor; // of arrived, of image; what sums in double precision would leave of the residual
	REAL relative;                  // by how much terms of one sign may sum to more
};

#ifdef CERTIFY
// A term of a sum rounds by this share of the sum, and what is less than this of it is lost.
#ifdef SUM_IN_SINGLE
const double TERM_ROUNDING = 5.9604701e-8lf, TERM_LOST = 1.17549435e-38lf;
#else
const double TERM_ROUNDING = 1.1102230246251565e-16lf, TERM_LOST = 0.0lf;
#endif

dvec4 lost_of(dvec4 x)
{
	return mix(dvec4(0.0lf), dvec4(2.0 * LEAST_NORMAL), greaterThan(x, dvec4(0.0lf)));
}

// Nodes are off by ROUNDING of their means, all terms of the sums are >= 0 and n of them add n TERM_ROUNDING, a node below
// the least normal float is off by no more than that. The irradiance by exitance is off by ROUNDING twice: means and store.
void doubt(inout swept s, uint count)
{
	// A leaf that sees nothing has R = 0, exactly.
	double terms = count == 0u ? 0.0lf : double(count + 8u);
	s.relative = terms * TERM_ROUNDING;
	dvec4 storing = ROUNDING * s.arrived + lost_of(s.arrived);
	dvec4 given = dvec4((2.001lf * ROUNDING + terms * 1.1102230246251565e-16lf) * s.source.xyz, 0.0lf);
	given.xyz += lost_of(s.source).xyz;
	s.link_doubt = storing + s.relative * s.arrived + terms * TERM_LOST;
	s.doubt = s.link_doubt + given;
	s.floor = ROUNDING * s.image + storing + given + terms * 1.1102230246251565e-16lf * s.image;
}
#else
// Where floats are summed, about the square root of hundreds of terms' worth of 2^-24 of R is noise.
const float SUM_NOISE = 32.0 / 16777216.0;

void doubt(inout swept s, uint count)
{
	s.relative = 0.0;
	s.link_doubt = s.doubt = vec4(0.0);
	s.floor = SUM_NOISE * s.image;
}
#endif

REAL root(REAL x)
{
	return sqrt(sqrt(x));
}

// More than the rounding of a few roots and products.
const REAL ROOTS = REAL(1e-6);

// What a leaf says of channel c by which errors count (check.comp): M u, twice, and (I - M) u, twice.
struct weighed {
	REAL mu, own_mu, after, own_after;
};

weighed weigh(swept s, uint c, REAL row, float scale, float theta)
{
	REAL mix_in = REAL(theta * scale), unit = root(REAL(scale)), more = s.arrived[c] + s.link_doubt[c];
	REAL own = unit * s.before[c] / max(root(s.before[c]), REAL(LEAST_NORMAL));
	REAL seen = unit * root(row) * more / max(root(more), REAL(LEAST_NORMAL)) * (REAL(1.0) + ROOTS);
	REAL lit = s.source[c] - (s.doubt[c] - s.link_doubt[c]);
	weighed w;
	w.mu = lit + mix_in * (s.before.w - s.arrived.w - s.link_doubt.w);
	w.own_mu = w.mu + own - seen;
	w.after = more + mix_in * (s.arrived.w + s.link_doubt.w);
	w.own_after = w.after + seen;
	return w;
}

void report(swept s, gathered g, vec4 next, REAL3 b_off)
{
	vec3 scale = uintBitsToFloat(uvec3(load_state(GI_STATE_SCALE_BITS), load_state(GI_STATE_SCALE_BITS + 1u),
					   load_state(GI_STATE_SCALE_BITS + 2u)));
	float theta = uintBitsToFloat(load_state(GI_STATE_THETA_BITS));
	REAL4 residual = abs(s.image - s.before) + s.doubt;
	REAL3 row = s.rho.xyz * REAL(g.row_sum) * (REAL(1.0) + s.relative);
	vec4 kappas = vec4(0.0); // and noises
#ifdef CERTIFY
	dvec4 written = abs(dvec4(next) - s.image) + s.doubt;
	vec3 spreads = vec3(0.0); // and stray
	float share = HUGE;
#endif
	for (uint c = 0u; c < 3u; c++) {
		weighed w = weigh(s, c, row[c], scale[c], theta);
		kappas = max(kappas, vec4(ratio(residual[c], w.mu), ratio(s.floor[c], w.mu), ratio(residual[c], w.own_mu),
					  ratio(s.floor[c], w.own_mu)));
#ifdef CERTIFY
		double light = double(next[c]) + double(GI_DARK_SHARE * scale[c]);
		spreads = max(spreads, vec3(ratio(w.after, light), ratio(w.own_after, light), ratio(written[c], light)));
		if (scale[c] > 0.0)
			share = min(share, float(light) / (scale[c] * max(next.w, float(s.before.w))));
		report_largest(GI_STATE_RESIDUAL_BITS + c, outward(residual[c]));
		report_largest(GI_STATE_R_MAX_BITS + c, next[c]);
		report_least(GI_STATE_GAP_BITS + c, inward(1.0lf - row[c]));
#endif
	}
	report_largest(GI_STATE_KAPPA_BITS, kappas.x);
	report_largest(GI_STATE_NOISE_BITS, kappas.y);
	report_largest(GI_STATE_OWN_BITS, kappas.z);
	report_largest(GI_STATE_OWN_BITS + 2u, kappas.w);
	report_largest(GI_STATE_U_MAX_BITS, float(s.before.w));
	report_least(GI_STATE_DESCENT_BITS, inward(s.before.w - s.arrived.w - s.link_doubt.w));
#ifdef CERTIFY
	dvec3 off = written.xyz + b_off;
	report_largest(GI_STATE_SPREAD_BITS, spreads.x);
	report_largest(GI_STATE_OWN_BITS + 1u, spreads.y);
	report_largest(GI_STATE_STRAY_BITS, spreads.z);
	report_largest(GI_STATE_WRITE_BITS, outward(max(off.x, max(off.y, off.z))));
	report_largest(GI_STATE_FLOOR_BITS, outward(max(s.floor.x, max(s.floor.y, s.floor.z))));
	report_least(GI_STATE_SHARE_BITS, share);
#else
	report_largest(GI_STATE_RESIDUAL_BITS, max(residual.x, max(residual.y, residual.z)));
	report_least(GI_STATE_GAP_BITS, 1.0 - max(row.x, max(row.y, row.z)));
#endif
}

// Within what the solution is within; v likewise.
REAL4 confined(REAL4 r, REAL4 source, vec3 exitance)
{
	vec3 ceiling = uintBitsToFloat(uvec3(load_state(GI_STATE_CEILING_BITS), load_state(GI_STATE_CEILING_BITS + 1u),
					     load_state(GI_STATE_CEILING_BITS + 2u)));
	vec4 most = vec4(max(min(ceiling, frame.ceiling.xyz - exitance), vec3(0.0)), frame.ceiling.w);
	return min(max(r, source), REAL4(most));
}

void store(uint leaf, vec4 before, vec4 next, vec3 b)
{
	leaf_radiosity[GI_LEAF_R * frame.counts.x + leaf] = next;
	leaf_radiosity[GI_LEAF_BEFORE * frame.counts.x + leaf] = before;
	leaf_radiosity[GI_LEAF_B * frame.counts.x + leaf] = vec4(b, 0.0);
}

void sweep(uint leaf, uint action)
{
	gathered g = gather(leaf);
	gi_material_data m = load_material(load_leaf(leaf).z);
	vec4 before = load_leaf_part(GI_LEAF_R, leaf), emitted = load_leaf_part(GI_LEAF_EMITTED, leaf);
	if ((action & GI_ACTION_KEEP) != 0u)
		leaf_radiosity[GI_LEAF_KEPT * frame.counts.x + leaf] = before;
#ifdef CERTIFY
	leaf_indirect[leaf] = vec4(vec3(g.sum.xyz) + load_leaf_part(GI_LEAF_UNDRAWN, leaf).xyz, 0.0);
#endif
	swept s;
	s.rho = REAL4(vec4(m.rho.xyz, max(m.rho.x, max(m.rho.y, m.rho.z))));
	s.source = REAL4(vec4(m.rho.xyz, 1.0)) * REAL4(vec4(emitted.xyz, 1.0));
	s.before = REAL4(before);
	s.arrived = s.rho * REAL4(g.sum);
	s.image = s.source + s.arrived;
	REAL omega = REAL(uintBitsToFloat(load_state(GI_STATE_OMEGA_BITS)));
	REAL4 step_to = s.image;
	if (omega != REAL(1.0)) {
		REAL4 earlier = omega < REAL(1.0) ? s.before : REAL4(load_leaf_part(GI_LEAF_BEFORE, leaf));
		step_to = omega * (s.image - earlier) + earlier;
	}
	vec4 next = to_single(confined(step_to, s.source, m.exitance.xyz));
	bool finite = !any(isnan(next)) && !any(isinf(next));
	if (!finite) {
		atomicOr(state[GI_STATE_NOT_FINITE], 1u);
		next = before = vec4(0.0, 0.0, 0.0, 1.0);
	}
	vec3 b = m.exitance.xyz + next.xyz;
	store(leaf, before, next, b);
	if (!finite)
		return;
#ifdef CERTIFY
	report_largest(GI_STATE_B_MAX_BITS, max(b.x, max(b.y, b.z)));
#endif
	doubt(s, g.count);
	report(s, g, next, abs(REAL3(m.exitance.xyz) + REAL3(next.xyz) - REAL3(b)));
}

#ifndef CERTIFY
// Instead of a sweep: the R that was kept, or a part of R; no part of R and v is a cold start.
void go_back(uint leaf, uint action)
{
	gi_material_data m = load_material(load_leaf(leaf).z);
	vec4 r = load_leaf_part((action & GI_ACTION_RECALL) != 0u ? GI_LEAF_KEPT : GI_LEAF_R, leaf);
	if ((action & GI_ACTION_SCALE) != 0u)
		r *= uintBitsToFloat(uvec4(load_state(GI_STATE_FACTOR_BITS), load_state(GI_STATE_FACTOR_BITS + 1u),
					   load_state(GI_STATE_FACTOR_BITS + 2u), load_state(GI_STATE_FACTOR_BITS + 3u)));
	vec4 next = to_single(vec4(r.xyz, max(r.w, 1.0)));
	store(leaf, next, next, m.exitance.xyz + next.xyz);
}
#endif

void work(uint leaf)
{
	uint action = load_state(GI_STATE_ACTION);
#ifndef CERTIFY
	if (action > GI_ACTION_KEEP) {
		go_back(leaf, action);
		return;
	}
#endif
	sweep(leaf, action);
}

void main()
{
	uint local = gl_LocalInvocationID.x;
	if (local < GI_STATE_LARGEST)
		group_largest[local] = 0u;
	if (local < GI_STATE_LEAST)
		group_least[local] = INFINITY_BITS;
	barrier();
	uint leaf = thread_number();
	if (leaf < frame.counts.x)
		work(leaf);
	barrier();
	if (local < GI_STATE_LARGEST)
		atomicMax(state[GI_STATE_RESIDUAL_BITS + local], group_largest[local]);
	if (local < GI_STATE_LEAST)
		atomicMin(state[GI_STATE_GAP_BITS + local], group_least[local]);
}
