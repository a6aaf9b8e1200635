// A sweep, the gather: T B of every leaf, T B_i = E_i + rho_i * sum over links of weight * B_node, and the next B from
// it. One thread a leaf.
//
// Next is T B for omega 1 (Jacobi), for more a step of Chebyshev's, omega (T B - B_before) + B_before, for less a
// damped one, omega (T B - B) + B (check.comp). Never below 0, which no solution is, so that sums have terms of one
// sign only and rounding is relative to them.
//
// The fourth channel solves u = 1 + rho_max * sum of weight * u_node along with B: how much the scene amplifies.
#define READ_FRAME
#define READ_LEAVES
#define READ_MATERIALS
#define READ_ROWS
#define READ_LINKS
#define READ_RADIOSITY
#define READ_LEAF_RADIOSITY
#define WRITE_LEAF_RADIOSITY
#define WRITE_STATE
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
	REAL4 sum;    // of weight * B_node, and of weight * u_node
	REAL row_sum; // of weights
	uint count;   // of links
};

gathered gather(uint leaf)
{
	uvec4 row = load_row(leaf);
	gathered g = gathered(REAL4(0.0), REAL(0.0), row.y & GI_BLOCK_COUNT_MASK);
	for (uint k = row.x / 2u; 2u * k < row.x + g.count; k++) {
		uvec4 two = load_two_links(k);
		REAL first = REAL(uintBitsToFloat(two.y)), second = REAL(uintBitsToFloat(two.w));
		g.sum += first * REAL4(load_radiosity(two.x));
		g.sum += second * REAL4(load_radiosity(two.z));
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

// Bounds, channel by channel; doubt bounds |computed T B - T B|: nodes are off by ROUNDING of their means, all terms of
// the sums are >= 0 and n of them add n 2^-53, a node below the least normal float is off by no more than that.
void report(gathered g, dvec4 rho, dvec4 image, dvec4 before, vec4 next)
{
	// A leaf that sees nothing has B = E, exactly.
	double sum_rounding = g.count == 0u ? 0.0lf : double(g.count + 8u) * 1.1102230246251565e-16lf;
	dvec4 arrived = rho * g.sum;
	dvec4 lost = mix(dvec4(0.0lf), dvec4(2.0 * LEAST_NORMAL), greaterThan(arrived, dvec4(0.0lf)));
	dvec4 doubt = ROUNDING * arrived + sum_rounding * image + lost;
	dvec4 residual = abs(image - before) + doubt, written = abs(dvec4(next) - image) + doubt;
	double least_left = 0.0lf;
	for (uint c = 0u; c < 3u; c++) {
		report_largest(RESIDUAL + c, outward(residual[c]));
		report_largest(B_MAX + c, next[c]);
		report_largest(WRITE + c, outward(written[c]));
		report_least(GAP + c, g.count == 0u ? 1.0 : inward(1.0lf - rho[c] * g.row_sum * (1.0lf + sum_rounding)));
		least_left = max(least_left, ROUNDING * double(next[c]) + doubt[c]);
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
	gi_material_data m = load_material(load_leaf(leaf).z);
	REAL4 rho = REAL4(vec4(m.rho.xyz, max(m.rho.x, max(m.rho.y, m.rho.z))));
	REAL4 image = REAL4(vec4(m.exitance.xyz, 1.0)) + rho * g.sum;
	vec4 before = load_leaf_radiosity(leaf);
	REAL omega = REAL(uintBitsToFloat(state[GI_STATE_OMEGA_BITS]));
	REAL4 step_to = image;
	if (omega != REAL(1.0)) {
		REAL4 earlier = omega < REAL(1.0) ? REAL4(before) : REAL4(load_leaf_radiosity(frame.counts.x + leaf));
		step_to = omega * (image - earlier) + earlier;
	}
	vec4 next = to_single(max(step_to, REAL4(0.0)));
	if (any(isnan(next)) || any(isinf(next))) {
		atomicOr(state[GI_STATE_NOT_FINITE], 1u);
		next = vec4(m.exitance.xyz, 1.0);
		leaf_radiosity[leaf] = leaf_radiosity[frame.counts.x + leaf] = next;
		return;
	}
	leaf_radiosity[leaf] = next;
	leaf_radiosity[frame.counts.x + leaf] = before;
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
