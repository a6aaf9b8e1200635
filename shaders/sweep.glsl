// The end of a sweep, of what was gathered: the next R of a leaf, and what bounds the error (gather.glsl, check.comp).

// What the group's leaves found, value by value of gi_state_found; of the last two the least is wanted.
const uint FOUND_LARGEST_R = 0u, FOUND_LARGEST_B = 3u, FOUND_LARGEST_V = 4u, FOUND_RESIDUAL = 5u, FOUND_KAPPA = 6u;
const uint FOUND_NOISE = 7u, FOUND_SPREAD = 8u, FOUND_WRITE = 9u, FOUND_STRAY = 10u, FOUND_GAP = 11u;
const uint FOUND_DESCENT = 12u, FOUND_COUNT = 13u;
shared float found[FOUND_COUNT * GI_GROUP_SIZE];

// More than a float is off by after a conversion, a division and a root.
const float SLACK = 1e-6;

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

// What becomes of the leaf: the next R, stored, and what bounds the error.
void finish(uint leaf, swept s, REAL4 source, vec4 before, vec3 ceiling, vec3 exitance, float lacks)
{
	vec4 next = to_single(confined(step_from(s, leaf), source, ceiling, exitance));
	bool finite = !any(isnan(next)) && !any(isinf(next));
	if (!finite) {
		atomicOr(state.counts.not_finite, 1u);
		next = before = vec4(0.0, 0.0, 0.0, 1.0);
	}
	vec3 b = exitance + next.xyz;
	store(leaf, before, next, b, lacks);
	if (finite)
		report(s, next, b);
}

// What a thread without a leaf found.
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

// By one thread, once all have joined. Floats >= 0 order as their bits do, so the results have no order.
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
