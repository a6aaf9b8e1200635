#version 450 core
// Judges a sweep: does the certified bound meet the tolerance, is what is left rounding, and how does the next one go?
// The group counts of all sweeps lie in the state, so that ending the solve, or choosing the certifying gather instead
// of the ordinary one, is a matter of zeroes: the frame never waits for a read-back.
//
// The bound. With M = I - diag(rho) W (W: links and area means), T B = E + B - M B, and r = T B - B, what B lacks to
// the solution B* is e = B* - B = M^-1 r. M has no positive entry off its diagonal and row sums above 0, so M^-1 >= 0.
// Any u with m = min (M u)_i > 0 then tells how large it is (Collatz 1942): m M^-1 1 <= u, so
//
//     |B - B*| <= |r| u_max / m,    |T B - B*| = |(I - M) e| <= |r| (u_max / m - 1)            (|.| the largest entry)
//
// u is the fourth channel of B; the M of the largest rho has the largest inverse of the three. u = 1 gives the row
// sums' norm, 1 / (1 - q). Of A = u_max / m and that the lesser counts: the amplification. It bounds the spectrum too, whose
// radius is at most 1 - 1 / A.
//
// What is stored, B', is T B but for rounding (or Chebyshev's step), and the certifying gather knows by how much, w:
//
//     |B' - B*| <= |r| (A - 1) + w,    r, w with all doubts of single and double precision (gather.glsl)
//
// Once B' rounds to B again, |r| is at most FLOOR, what half a unit in the last place makes of it, and more sweeps keep
// FLOOR * A of the bound.
//
// Chebyshev (Golub and Varga 1961): with the spectrum of I - M in [-q, q],
//
//     B_k+1 = omega_k+1 (T B_k - B_k-1) + B_k-1
//     omega_1 = 1, omega_2 = 1 / (1 - q^2 / 2), omega_k+1 = 1 / (1 - q^2 omega_k / 4)
//
// takes about sqrt(2 (1 - q)) off the error where Jacobi takes 1 - q. Rows are sampled, so eigenvalues stray from the
// real axis: where progress is not as foretold, the interval becomes an ellipse with the half axes q and b (Manteuffel
// 1977), c^2 = q^2 - b^2 in q^2's place; wider and wider, and c = 0 is Jacobi.
#define READ_FRAME
#define READ_STATE
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = 1) in;
layout(location = 0) uniform uint stage;
layout(location = 1) uniform uint max_sweeps;

const uint STAGE_SWEPT = 0u, STAGE_BEGIN = 1u, STAGE_GO_ON = 2u;

// Jacobi where it needs no more sweeps than this: it is then as good as Chebyshev, whose first steps are like it.
const uint JACOBI_MOST = 25u;

// Where floats are summed, about the square root of hundreds of terms' worth of 2^-24 of B is noise; amplified more
// than AMPLIFIED times it would spoil a tolerance of 1e-4. From here on sweeps sum in double precision.
const float SUM_NOISE = 32.0 / 16777216.0;
const float AMPLIFIED = 100.0;

// More than the rounding of a division (2.5 units in the last place) and of the few operations around it.
const float OUTWARD = 1.0 + 1.0 / 1048576.0;

// Progress is judged whenever this much is foretold of the residual, and half the decades will do: largest entries do
// not shrink as evenly as the norm of the theory.
const float JUDGED = 1.0 / 8.0, GOOD_ENOUGH = 0.36;
const float BLOWN_UP = 10.0;

// Times FLOOR. Near: errors of rounding as Chebyshev collects them; damped sweeps, (T B + B) / 2, take them away, those
// of eigenvalue -1, which Jacobi leaves, too. At: nothing is left to gain but a factor of two.
const float NEAR_FLOOR = 64.0, AT_FLOOR = 2.0;
const uint POLISH_SWEEPS = 16u;

// The words of the state that the solve goes by, as registers: read at the start, written at the end. In place, their
// hundred loads and stores took llvmpipe 0.2 s to compile (Mesa 22.3), 0.3 s (25.0).
uint words[64];

void read_words()
{
	for (uint k = 0u; k <= GI_STATE_MANNER / 4u; k++) {
		uvec4 four = load_four_words(k);
		for (uint c = 0u; c < 4u; c++)
			words[4u * k + c] = four[c];
	}
}

// Only those that may have changed, in loops short enough to be unrolled: an array with indices known only at run time is
// no registers.
void write_words()
{
	for (uint k = GI_STATE_SWEEPS; k <= GI_STATE_DONE_B_MAX_BITS; k++)
		state[k] = words[k];
	for (uint k = GI_STATE_ARGS_GATHER; k < GI_STATE_ARGS_RECYCLE; k++)
		state[k] = words[k];
	for (uint k = GI_STATE_ARGS_CERTIFY; k <= GI_STATE_MANNER; k++)
		state[k] = words[k];
}

float load(uint word)
{
	return uintBitsToFloat(words[word]);
}

void store(uint word, float value)
{
	words[word] = floatBitsToUint(value);
}

float largest_of_three(uint word)
{
	return max(load(word), max(load(word + 1u), load(word + 2u)));
}

void put_groups(uint at, uint groups)
{
	uvec3 g = folded(groups);
	words[at] = g.x;
	words[at + 1u] = g.y;
	words[at + 2u] = g.z;
}

void clear_findings()
{
	for (uint k = 0u; k < GI_STATE_LARGEST; k++)
		words[GI_STATE_RESIDUAL_BITS + k] = 0u;
	for (uint k = 0u; k < GI_STATE_LEAST; k++)
		words[GI_STATE_GAP_BITS + k] = 0x7F800000u; // infinity
}

// ---- the solve's pace ----

void queue_sweep(bool certify)
{
	uint groups = groups_for(frame.counts.x);
	put_groups(GI_STATE_ARGS_GATHER, certify ? 0u : groups);
	put_groups(GI_STATE_ARGS_CERTIFY, certify ? groups : 0u);
	// Says which it was, after a sweep of no leaves too.
	words[GI_STATE_ARGS_CERTIFY + 2u] = certify ? 1u : 0u;
}

void stop(uint verdict)
{
	words[GI_STATE_VERDICT] = verdict;
	words[GI_STATE_ARGS_GATHER] = 0u;
	words[GI_STATE_ARGS_CERTIFY] = 0u;
	words[GI_STATE_ARGS_PULL] = 0u;
	words[GI_STATE_ARGS_WIDE] = 0u;
	words[GI_STATE_ARGS_CHECK] = 0u;
}

void begin()
{
	words[GI_STATE_SWEEPS] = 0u;
	words[GI_STATE_VERDICT] = GI_SOLVE_GOES_ON;
	put_groups(GI_STATE_ARGS_PULL, groups_for(frame.counts.y));
	put_groups(GI_STATE_ARGS_WIDE, frame.misc.y);
	put_groups(GI_STATE_ARGS_CHECK, 1u);
	if (stage == STAGE_BEGIN) {
		words[GI_STATE_MANNER] = GI_MANNER_JACOBI;
		words[GI_STATE_WINDOW] = 0u;
		words[GI_STATE_REACH_BITS] = 0u;
		store(GI_STATE_OMEGA_BITS, 1.0);
		store(GI_STATE_AMPLIFICATION_BITS, 3e38);
		// Below 0: seen over the rows before, to compare with and not to count on (judge).
		store(GI_STATE_ESTIMATE_BITS, -abs(load(GI_STATE_ESTIMATE_BITS)));
	}
	clear_findings();
	queue_sweep(max_sweeps == 1u || load(GI_STATE_ESTIMATE_BITS) > AMPLIFIED);
	if (frame.counts.x == 0u) {
		store(GI_STATE_BOUND_BITS, 0.0);
		stop(GI_SOLVE_CONVERGED); // an empty scene
	}
	// Which rows did not fit is chance: B waits for the larger pool, and stays what it was.
	if (words[GI_STATE_OVERFLOW] != 0u)
		stop(GI_SOLVE_GOES_ON);
}

// ---- what a sweep found ----

float least_gap()
{
	float gap = min(load(GI_STATE_GAP_BITS), min(load(GI_STATE_GAP_BITS + 1u), load(GI_STATE_GAP_BITS + 2u)));
	return min(gap, 1.0);
}

float amplification()
{
	float a = 1.0 / least_gap(), m = load(GI_STATE_DESCENT_BITS);
	if (m > 0.0)
		a = min(a, load(GI_STATE_U_MAX_BITS) / m);
	return max(a, 1.0) * OUTWARD;
}

void certify(float b_max)
{
	float amplified = min(load(GI_STATE_AMPLIFICATION_BITS), amplification()), bound = 0.0;
	for (uint c = 0u; c < 3u; c++) {
		float a = min(amplified, OUTWARD / min(load(GI_STATE_GAP_BITS + c), 1.0));
		bound = max(bound, load(GI_STATE_RESIDUAL_BITS + c) * (a - 1.0) + load(GI_STATE_WRITE_BITS + c));
	}
	bound *= OUTWARD;
	store(GI_STATE_AMPLIFICATION_BITS, amplified);
	store(GI_STATE_BOUND_BITS, bound);
	store(GI_STATE_BOUND_RELATIVE_BITS, b_max > 0.0 ? bound / b_max * OUTWARD : 0.0);
	store(GI_STATE_ROUNDING_BITS, min(bound, load(GI_STATE_FLOOR_BITS) * amplified));
}

bool meets_tolerance()
{
	float bound = load(GI_STATE_BOUND_BITS), relative = load(GI_STATE_BOUND_RELATIVE_BITS);
	return relative > 0.0 ? relative <= frame.tolerance.w : bound == 0.0;
}

// ---- Chebyshev ----

// Half axes of the ellipse: q, and b, none at first, then doubling from half of sqrt(1 - q^2), the scale of its cost.
vec2 half_axes()
{
	float q = 1.0 - 1.0 / load(GI_STATE_REACH_BITS);
	float widened = float(words[GI_STATE_ELLIPSE]);
	return vec2(q, widened == 0.0 ? 0.0 : 0.25 * exp2(widened) * sqrt((1.0 - q) * (1.0 + q)));
}

// What a sweep leaves of the error in the long run.
float rate(vec2 axes)
{
	return (axes.x + axes.y) / (1.0 + sqrt(1.0 - axes.x * axes.x + axes.y * axes.y));
}

void open_window(float residual)
{
	words[GI_STATE_WINDOW] = 0u;
	store(GI_STATE_WINDOW_BITS, residual);
}

void settle_for(uint manner, float residual)
{
	words[GI_STATE_MANNER] = manner;
	store(GI_STATE_OMEGA_BITS, manner == GI_MANNER_POLISH ? 0.5 : 1.0);
	open_window(residual);
}

void start_chebyshev(float amplified, uint widened, float residual)
{
	words[GI_STATE_ELLIPSE] = widened;
	store(GI_STATE_REACH_BITS, amplified);
	vec2 axes = half_axes();
	settle_for(axes.y < axes.x ? GI_MANNER_CHEBYSHEV : GI_MANNER_GIVEN_UP, residual);
}

void step_chebyshev(float amplified, float residual, bool near_floor)
{
	vec2 axes = half_axes();
	float omega = load(GI_STATE_OMEGA_BITS), c2 = axes.x * axes.x - axes.y * axes.y;
	store(GI_STATE_OMEGA_BITS, 1.0 / (1.0 - c2 * (omega == 1.0 ? 0.5 : 0.25 * omega)));
	words[GI_STATE_WINDOW] += 1u;
	float s = pow(rate(axes), float(words[GI_STATE_WINDOW] - 1u)), begun = load(GI_STATE_WINDOW_BITS);
	bool judged = 2.0 * s / (1.0 + s * s) <= JUDGED;
	bool bad = residual > BLOWN_UP * begun || (judged && residual > GOOD_ENOUGH * begun);
	if (amplified < 0.5 * load(GI_STATE_REACH_BITS))
		start_chebyshev(amplified, words[GI_STATE_ELLIPSE], residual);
	else if (bad && near_floor)
		settle_for(GI_MANNER_POLISH, residual);
	else if (bad)
		start_chebyshev(load(GI_STATE_REACH_BITS), words[GI_STATE_ELLIPSE] + 1u, residual);
	else if (judged)
		open_window(residual);
}

// ---- Jacobi ----

// How many more sweeps Jacobi takes to the tolerance when each leaves q of the residual.
uint foretell_jacobi(float amplified, float residual, float tolerance)
{
	float bound = residual * (amplified - 1.0);
	if (bound <= tolerance)
		return 0u;
	return uint(clamp(ceil(log(tolerance / bound) / log(1.0 - 1.0 / amplified)), 1.0, 1e6));
}

// Exact sweeps shrink the residual, in as many as the amplification by e: those that do not are rounding. Polishing
// takes away noise, or has nothing to take.
bool is_stuck(float amplified, float residual, bool certified, bool polished)
{
	words[GI_STATE_WINDOW] += 1u;
	uint enough = polished ? POLISH_SWEEPS : POLISH_SWEEPS + uint(min(amplified, 1e6));
	if (certified && words[GI_STATE_WINDOW] < enough)
		return false;
	bool stuck = certified && residual > (polished ? 0.5 : 0.9) * load(GI_STATE_WINDOW_BITS);
	open_window(residual);
	return stuck;
}

// ---- after a sweep ----

void judge(bool certified, float last_residual, float residual, float b_max)
{
	float known = load(GI_STATE_ESTIMATE_BITS), now = amplification(), tolerance = frame.tolerance.w * b_max;
	float amplified = known > 0.0 ? min(known, now) : now;
	bool steady = amplified >= 0.9 * abs(known) && amplified <= 1.1 * abs(known);
	store(GI_STATE_ESTIMATE_BITS, amplified);

	float least = load(GI_STATE_FLOOR_BITS);
	bool near_floor = certified && residual <= NEAR_FLOOR * least;
	if (certified && residual <= AT_FLOOR * least && least * amplified > tolerance) {
		stop(GI_SOLVE_ROUNDING);
		return;
	}
	uint more = foretell_jacobi(amplified, residual, tolerance);
	uint manner = words[GI_STATE_MANNER];
	if (manner == GI_MANNER_JACOBI || manner == GI_MANNER_GIVEN_UP)
		words[GI_STATE_JACOBI_SWEEPS] = words[GI_STATE_SWEEPS] + more;
	if (manner == GI_MANNER_CHEBYSHEV) {
		step_chebyshev(amplified, residual, near_floor);
	} else if (manner == GI_MANNER_JACOBI && steady && more > JACOBI_MOST) {
		start_chebyshev(amplified, 0u, residual);
	} else if (is_stuck(amplified, residual, certified, near_floor && manner == GI_MANNER_POLISH)) {
		if (manner == GI_MANNER_POLISH) {
			stop(GI_SOLVE_ROUNDING);
			return;
		}
		settle_for(GI_MANNER_POLISH, residual);
	}
	// What the next sweep would certify: by the last one's progress, or the theory's.
	float left = 1.0 - 1.0 / amplified;
	if (manner == GI_MANNER_CHEBYSHEV)
		left = rate(half_axes());
	else if (last_residual > 0.0)
		left = min(left, residual / last_residual);
	bool last = words[GI_STATE_SWEEPS] + 1u >= max_sweeps;
	bool enough = left * residual * (amplified - 1.0) <= tolerance;
	queue_sweep(last || enough || amplified > AMPLIFIED || residual <= SUM_NOISE * b_max);
}

void finish_sweep()
{
	bool certified = words[GI_STATE_ARGS_CERTIFY + 2u] != 0u;
	float residual = largest_of_three(GI_STATE_RESIDUAL_BITS), b_max = largest_of_three(GI_STATE_B_MAX_BITS);
	float last_residual = words[GI_STATE_SWEEPS] > 0u ? load(GI_STATE_DONE_RESIDUAL_BITS) : 0.0;
	words[GI_STATE_SWEEPS] += 1u;
	store(GI_STATE_DONE_RESIDUAL_BITS, residual);
	store(GI_STATE_DONE_Q_BITS, 1.0 - least_gap());
	store(GI_STATE_DONE_B_MAX_BITS, b_max);
	if (certified)
		certify(b_max);
	if (certified && meets_tolerance())
		stop(GI_SOLVE_CONVERGED);
	else
		judge(certified, last_residual, residual, b_max);
	clear_findings();
}

void main()
{
	read_words();
	if (stage == STAGE_SWEPT)
		finish_sweep();
	else
		begin();
	write_words();
}
