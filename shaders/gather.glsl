// A sweep, the gather: T B of every leaf, T B_i = E_i + rho_i * sum over links of weight * B_node, and the next B from
// it. One thread a leaf.
//
// Next is T B for omega 1 (Jacobi), for more a step of Chebyshev's, omega (T B - B_before) + B_before, for less a
// damped one, omega (T B - B) + B (check.comp). Never below 0, which no solution is, so that sums have terms of one
// sign only and rounding is relative to them.
//
// SUM is what links are summed in, REAL everything else. With LIGHT the irradiance of everything but lamps' own exitance comes
// with it, at the B before the sweep and at no walk of its own (indirect.comp).
//
// The fourth channel solves u = 1 + rho_max * sum of weight * u_node along with B: how much the scene amplifies.
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
#ifdef LIGHT
#define READ_PENDING
#define WRITE_LEAF_INDIRECT
#endif
#include "buffers.glsl"
#include "dispatch.glsl"
#include "solve.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

shared uint group_largest[GI_STATE_LARGEST];
shared uint group_least[GI_STATE_LEAST];

// Where the words of the state are in those arrays.
const uint RESIDUAL = 0u;
const uint B_MAX = GI_STATE_B_MAX_BITS - GI_STATE_RESIDUAL_BITS;
const uint U_MAX = GI_STATE_U_MAX_BITS - GI_STATE_RESIDUAL_BITS;
const uint WRITE = GI_STATE_WRITE_BITS - GI_STATE_RESIDUAL_BITS;
const uint FLOOR = GI_STATE_FLOOR_BITS - GI_STATE_RESIDUAL_BITS;
const uint GAP = 0u;
const uint DESCENT = GI_STATE_DESCENT_BITS - GI_STATE_GAP_BITS;

const uint INFINITY_BITS = 0x7F800000u;

struct gathered {
	SUM4 sum;    // of weight * B_node, and of weight * u_node
	SUM row_sum; // of weights
	uint count;  // of links
};

gathered gather(uint leaf)
{
	uvec4 row = load_row(leaf);
	gathered g = gathered(SUM4(0.0), SUM(0.0), row.y & GI_BLOCK_COUNT_MASK);
	for (uint k = row.x / 2u; 2u * k < row.x + g.count; k++) {
		uvec4 two = load_two_links(k);
		SUM first = SUM(uintBitsToFloat(two.y)), second = SUM(uintBitsToFloat(two.w));
		g.sum += first * SUM4(load_radiosity(two.x));
		g.sum += second * SUM4(load_radiosity(two.z));
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
	atomicMax(group_largest[word], floatBitsToUint(value));
}

void report_least(uint word, float value)
{
	atomicMin(group_least[word], floatBitsToUint(max(value, 0.0)));
}

#ifdef CERTIFY
// A float no less, and one no greater: the conversion is off by 2^-24 of it, or lost below the least normal float.
float outward(double x)
{
	return x > 0.0lf ? float(x) * (1.0 + 2.3841858e-7) + LEAST_NORMAL : 0.0;
}

float inward(double x)
{
	return max(float(x) * (1.0 - 2.3841858e-7) - LEAST_NORMAL, 0.0);
}

// A term of a sum rounds by this share of the sum, and what is less than this of it is lost.
#ifdef SUM_IN_SINGLE
const double TERM_ROUNDING = 5.9604701e-8lf, TERM_LOST = 1.17549435e-38lf;
#else
const double TERM_ROUNDING = 1.1102230246251565e-16lf, TERM_LOST = 0.0lf;
#endif

// Bounds, channel by channel; doubt bounds |computed T B - T B|: nodes are off by ROUNDING of their means, all terms of
// the sums are >= 0 and n of them add n TERM_ROUNDING, a node below the least normal float is off by no more than that.
void report(gathered g, dvec4 rho, dvec4 image, dvec4 before, vec4 next)
{
	// A leaf that sees nothing has B = E, exactly.
	double terms = g.count == 0u ? 0.0lf : double(g.count + 8u), sum_rounding = terms * TERM_ROUNDING;
	dvec4 arrived = rho * dvec4(g.sum);
	dvec4 lost = mix(dvec4(0.0lf), dvec4(2.0 * LEAST_NORMAL), greaterThan(arrived, dvec4(0.0lf)));
	dvec4 storing = ROUNDING * arrived + lost;
	dvec4 doubt = storing + sum_rounding * image + terms * TERM_LOST;
	dvec4 residual = abs(image - before) + doubt, written = abs(dvec4(next) - image) + doubt;
	double least_left = 0.0lf;
	for (uint c = 0u; c < 3u; c++) {
		report_largest(RESIDUAL + c, outward(residual[c]));
		report_largest(B_MAX + c, next[c]);
		report_largest(WRITE + c, outward(written[c]));
		report_least(GAP + c, g.count == 0u ? 1.0 : inward(1.0lf - rho[c] * double(g.row_sum) * (1.0lf + sum_rounding)));
		// Sums in double precision would leave this.
		least_left = max(least_left, ROUNDING * double(next[c]) + storing[c] + terms * 1.1102230246251565e-16lf * image[c]);
	}
	report_largest(FLOOR, outward(least_left));
	report_largest(U_MAX, float(before.w));
	report_least(DESCENT, inward(before.w - arrived.w - doubt.w));
}
#else
void report(gathered g, vec4 rho, vec4 image, vec4 before, vec4 next)
{
	vec4 residual = abs(image - before);
	for (uint c = 0u; c < 3u; c++) {
		report_largest(RESIDUAL + c, residual[c]);
		report_largest(B_MAX + c, next[c]);
		report_least(GAP + c, 1.0 - rho[c] * g.row_sum);
	}
	report_largest(U_MAX, before.w);
	report_least(DESCENT, 1.0 + before.w - image.w);
}
#endif

void sweep(uint leaf)
{
	gathered g = gather(leaf);
#ifdef LIGHT
	leaf_indirect[leaf] = vec4(max(vec3(g.sum.xyz) - load_pending(leaf).lamps.xyz, vec3(0.0)), 0.0);
#endif
	gi_material_data m = load_material(load_leaf(leaf).z);
	REAL4 rho = REAL4(vec4(m.rho.xyz, max(m.rho.x, max(m.rho.y, m.rho.z))));
	REAL4 image = REAL4(vec4(m.exitance.xyz, 1.0)) + rho * REAL4(g.sum);
	vec4 before = load_leaf_radiosity(leaf);
	REAL omega = REAL(uintBitsToFloat(load_state(GI_STATE_OMEGA_BITS)));
	REAL4 step_to = image;
	if (omega != REAL(1.0)) {
		REAL4 earlier = omega < REAL(1.0) ? REAL4(before) : REAL4(load_leaf_radiosity(frame.counts.x + leaf));
		step_to = omega * (image - earlier) + earlier;
	}
	vec4 next = to_single(max(step_to, REAL4(0.0)));
	bool finite = !any(isnan(next)) && !any(isinf(next));
	if (!finite) {
		atomicOr(state[GI_STATE_NOT_FINITE], 1u);
		next = before = vec4(m.exitance.xyz, 1.0);
	}
	leaf_radiosity[leaf] = next;
	leaf_radiosity[frame.counts.x + leaf] = before;
	if (finite)
		report(g, rho, image, REAL4(before), next);
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
		sweep(leaf);
	barrier();
	if (local < GI_STATE_LARGEST)
		atomicMax(state[GI_STATE_RESIDUAL_BITS + local], group_largest[local]);
	if (local < GI_STATE_LEAST)
		atomicMin(state[GI_STATE_GAP_BITS + local], group_least[local]);
}
