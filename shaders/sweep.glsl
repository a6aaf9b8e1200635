// The end of a sweep, of what was gathered: the next R of a leaf, and what bounds the error (gather.glsl, check.comp).
// What the group's leaves found, word by word; first the largest values wanted, from GI_STATE_RESIDUAL_BITS on, then
// the least.
const uint FOUND = GI_STATE_LARGEST + GI_STATE_LEAST;
shared float found[FOUND * GI_GROUP_SIZE];

// More than a float is off by after a conversion, a division and a root.
const float SLACK = 1e-6;

vec3 load_three(uint word)
{
	return uintBitsToFloat(uvec3(load_state(word), load_state(word + 1u), load_state(word + 2u)));
}

void report_exactly(uint word, float value)
{
	found[(word - GI_STATE_RESIDUAL_BITS) * GI_GROUP_SIZE + gl_LocalInvocationID.x] = value;
}

void report_largest(uint word, REAL value)
{
	report_exactly(word, value > REAL(0.0) ? min(float(value) * (1.0 + SLACK), HUGE) + LEAST_NORMAL : 0.0);
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

// Errors count by u = R + sqrt(largest R * R) + theta * largest R * v, channel by channel (check.comp). Means of a root
// are at most the root of the mean, so that M u is at least what u has of its own less what is seen of others'.
void report_errors(swept s, vec3 next, vec3 b)
{
	REAL3 scale = REAL3(load_three(GI_STATE_SCALE_BITS)),
	      mix_in = REAL(uintBitsToFloat(load_state(GI_STATE_THETA_BITS))) * scale;
	REAL4 most = s.arrived + s.arrived_doubt;
	REAL3 own = s.before.xyz + sqrt(scale) * sqrt(s.before.xyz) + mix_in * s.before.w;
	REAL3 seen = most.xyz + sqrt(scale) * sqrt(s.row_sum * most.xyz) + mix_in * most.w;
	own *= REAL(1.0) - SLACK_OF_REAL;
	seen *= REAL(1.0) + SLACK_OF_REAL;
	REAL3 mu = own - seen;
	REAL3 light = REAL3(next) + REAL(GI_DARK_SHARE) * scale;
	REAL3 residual = abs(s.image.xyz - s.before.xyz) + s.doubt.xyz,
	      off = abs(REAL3(next) - s.image.xyz) + s.doubt.xyz;
	report_largest(GI_STATE_RESIDUAL_BITS, largest(residual));
	report_largest(GI_STATE_KAPPA_BITS, ratio(residual, mu));
	report_largest(GI_STATE_NOISE_BITS, ratio(REAL(ROUNDING) * s.image.xyz + s.doubt.xyz, mu));
	report_largest(GI_STATE_SPREAD_BITS, ratio(seen, light));
	report_largest(GI_STATE_STRAY_BITS, ratio(off, light));
	report_largest(GI_STATE_WRITE_BITS,
		       largest(off + REAL(ROUNDING) * REAL3(mix(vec3(0.0), b, greaterThan(next, vec3(0.0))))));
}

void report(swept s, vec4 next, vec3 b)
{
	report_errors(s, next.xyz, b);
	for (uint c = 0u; c < 3u; c++)
		report_exactly(GI_STATE_R_MAX_BITS + c, next[c]);
	report_exactly(GI_STATE_B_MAX_BITS, max(b.x, max(b.y, b.z)));
	report_exactly(GI_STATE_V_MAX_BITS, float(s.before.w));
	// Rounded on the way to a float, which check.comp allows for.
	report_exactly(GI_STATE_GAP_BITS, float(min(s.gap.x, min(s.gap.y, s.gap.z))));
	REAL descent = s.before.w * (REAL(1.0) - SLACK_OF_REAL) - s.arrived.w - s.arrived_doubt.w;
	report_exactly(GI_STATE_DESCENT_BITS, max(float(descent), 0.0));
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
	REAL omega = REAL(uintBitsToFloat(load_state(GI_STATE_OMEGA_BITS)));
	if (omega == REAL(1.0))
		return s.image;
	REAL4 earlier = omega < REAL(1.0) ? s.before : REAL4(load_leaf_part(GI_LEAF_BEFORE, leaf));
	return omega * (s.image - earlier) + earlier;
}

// What becomes of the leaf: the next R, stored, and what bounds the error.
void finish(uint leaf, swept s, REAL4 source, vec4 before, vec3 ceiling, vec3 exitance, float lacks)
{
	vec4 next = to_single(confined(step_from(s, leaf), source, ceiling, exitance));
	bool finite = !any(isnan(next)) && !any(isinf(next));
	if (!finite) {
		atomicOr(state[GI_STATE_NOT_FINITE], 1u);
		next = before = vec4(0.0, 0.0, 0.0, 1.0);
	}
	vec3 b = exitance + next.xyz;
	store(leaf, before, next, b, lacks);
	if (finite)
		report(s, next, b);
}

// Of a leaf that is none.
void report_nothing()
{
	for (uint k = 0u; k < FOUND; k++)
		report_exactly(GI_STATE_RESIDUAL_BITS + k, k < GI_STATE_LARGEST ? 0.0 : HUGE);
}

// Of the group. Floats >= 0 order as their bits do, so the results have no order.
void report_group(uint word)
{
	float value = found[word * GI_GROUP_SIZE];
	for (uint k = 1u; k < GI_GROUP_SIZE; k++) {
		float other = found[word * GI_GROUP_SIZE + k];
		value = word < GI_STATE_LARGEST ? max(value, other) : min(value, other);
	}
	if (word < GI_STATE_LARGEST)
		atomicMax(state[GI_STATE_RESIDUAL_BITS + word], floatBitsToUint(value));
	else
		atomicMin(state[GI_STATE_RESIDUAL_BITS + word], floatBitsToUint(value));
}
