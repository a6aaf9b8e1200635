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
#include "row_sum.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

#include "sweep.glsl"

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
	REAL3 gap = (REAL(1.0) - rho.xyz) + rho.xyz * lacks;
	s.gap = max(gap, REAL3(0.0)) * (REAL(1.0) - REAL(4.0) * ROUNDING_OF_REAL);
	return s;
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
	finish(leaf, s, source, before, ceiling, m.exitance.xyz, lacks);
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

#ifdef TRANSLUCENT
// What light does below its surface other passes know (diffusion_sweep.comp).
bool is_left_out(uint leaf)
{
	return load_material(load_leaf(leaf).z).exitance.w > 0.0;
}
#else
bool is_left_out(uint leaf)
{
	return false;
}
#endif

void main()
{
	report_nothing();
	uint leaf = thread_number(), action = state_before.solve.action;
	if (leaf < frame.counts.x && action > GI_ACTION_KEEP)
		go_back(leaf, action);
	else if (leaf < frame.counts.x && !is_left_out(leaf))
		sweep(leaf, action);
	barrier();
	if (gl_LocalInvocationID.x < FOUND_COUNT)
		join(gl_LocalInvocationID.x);
	barrier();
	if (gl_LocalInvocationID.x == 0u)
		report_group();
}
