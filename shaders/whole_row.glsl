// What a row may become, whatever its new entries say: weights of 1 in sum, shared out to surfaces whose B is known.

// Closing raises no entry more than twice, and scales rows that then lack less than a fifth to 1 (close.comp).
const float OPEN_RAISE = 2.5;

// More than the rounding of the sum of a row's links, and of the form factors of a segment.
const float SUM_SLACK = 1e-5;
const float FACTOR_SLACK = 1.001;

// Bounds on how much the H of a row may rise and fall.
struct limits {
	vec3 most; // that H can be
	vec3 rise, fall;
};

// dim: the largest B of what emits nothing; emitters: the largest weight of what does, before closing.
limits whole_row(received r, vec3 dim, vec3 emitting, float emitters)
{
	vec3 most = min(dim + OPEN_RAISE * emitters * emitting, max(dim, emitting));
	vec3 rise = max(most - r.h + r.slack, vec3(0.0)) + SUM_SLACK * r.h;
	return limits(most, rise, (r.h + r.slack) * (1.0 + SUM_SLACK));
}
