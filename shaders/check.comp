#version 450 core
// Judges a sweep: does the certified bound meet the tolerance, is what is left rounding, and how does the next one go?
// The group counts of all sweeps lie in the state, so that ending the solve, or having the next gather in double
// precision instead of single, is a matter of zeroes: the frame never waits for a read-back.
//
// What is solved is the light reflected, R = B - E: with M = I - diag(rho) W (W: links and area means) and s = rho *
// the irradiance by exitance, M R = s. T R = s + R - M R, and r = T R - R; what R lacks to the solution R* is e = M^-1
// r.
//
// The bounds. M has no positive entry off its diagonal and row sums above 0, so M^-1 >= 0. Hence for any u with M u > 0
// (Collatz 1942)
//
//     kappa = max |r_i| / (M u)_i:    |R - R*| <= kappa u,    |T R - R*| = |(I - M) e| <= kappa (I - M) u
//
// leaf by leaf.
//
// - Everywhere alike: u = v, the fourth channel, which solves M v = 1 for the largest rho of the three; its M has the
//   largest inverse. |T R - R*| <= |r| (v_max / m - 1), m = min (M v)_i. u = 1 gives the row sums' norm, 1 / (1 - q).
//   Of A = v_max / m and that the lesser counts: the amplification. It bounds the spectrum too, whose radius is at most
//   1 - 1 / A.
// - By the light of each leaf, channel by channel: u = R + sqrt(R max R) + theta v max R. M R = s - r, much where light
//   comes first. Means of a root are at most the root of the mean, so M of the second is at least sqrt(max R)
//   (sqrt(R_i) - sqrt(S_i (rho W R)_i)), S_i rho times the row's sum: near the solution a share of sqrt(R_i) that is
//   the same however dark it is. M of the third is theta max R, with theta v <= GI_DARK_SHARE: what is left where R is
//   nothing yet. So u says that where much is missing it is where there is much light, and that little of it arrives
//   where it is dark.
//
// The tolerance is of the light reflected: the solve has converged when, leaf by leaf and channel by channel, it is
// certain that
//
//     |R - R*| <= tolerance * (R_i + GI_DARK_SHARE * max R)
//
// What is stored, R', is T R but for rounding (or Chebyshev's step), and the gather knows by how much, w:
//
//     |R' - R*| <= |r| (A - 1) + w,    |R' - R*| <= kappa (I - M) u + w,
//
// r, w with all doubts of the precision it summed in (gather.glsl). Once R' rounds to R again r is what half a unit in
// the last place makes of it, and more sweeps take nothing from the bound.
//
// A mirror or glass that shines or is not black counts twice in a row, with its own light and with what is seen in it:
// such rows may sum to up to 2, and only what M u > 0 proves is known of M. R is then not bound by what follows.
//
// No light from nothing. All other rows sum to at most 1. Where B is largest, B <= E + rho B, so B <= max E / (1 -
// rho); likewise R <= max s / (1 - rho); and R >= s. T maps what lies within these into itself, and the gather keeps R
// there whatever it steps to. The error of Jacobi's never grows, in no leaf beyond the largest there was. Chebyshev's
// may, cut short or set up for a narrower spectrum, and carried from rows to rows it would grow on: R is kept when a
// window of its steps begins, comes back when the window fails or the sweeps of the frame end in a larger residual, and
// what failed is remembered over frames.
//
// Where a solve begins. After the first sweep weigh.comp finds what of the span of 1, v and R before is nearest to the
// solution. No sweep is lost: T is linear, and what it makes of the start follows from what it made of 1, v and R.
// Cold, R before is s, so that only what light reached in a sweep, channel by channel, begins with more than 0, and the
// rest gets what links bring. Warm, what is left of the residual decides, all channels alike, flux amplified A times
// and what is local about once: where it is not clearly less than of the best multiple of 1, the solve begins again,
// cold, and the sweep does not count.
//
// Chebyshev (Golub and Varga 1961): with the spectrum of I - M in [-q, q],
//
//     R_k+1 = omega_k+1 (T R_k - R_k-1) + R_k-1
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
#include "numbers.glsl"

layout(local_size_x = 1) in;
layout(location = 0) uniform uint stage;
layout(location = 1) uniform uint max_sweeps;

const uint STAGE_SWEPT = 0u, STAGE_BEGIN = 1u, STAGE_GO_ON = 2u;

// Jacobi where it needs no more sweeps than this: it is then as good as Chebyshev, whose first steps are like it.
const uint JACOBI_MOST = 8u;

// After a move B is off near the mover and, reflected once, where that place is seen. Two sweeps of Jacobi take both
// away. Chebyshev begins after them, because its second step would bring four tenths of the error back.
const uint LOCAL_SWEEPS = 3u;

// Rounding of sums in floats, amplified more than AMPLIFIED times, would spoil a tolerance of 1e-4. From here on sweeps
// sum in double precision, and where what single precision may hide is more than a part in IN_DOUBLE of what was found.
const float AMPLIFIED = 100.0, IN_DOUBLE = 4.0;

// Progress is judged whenever this much is foretold of the residual, and half the decades will do: largest entries do
// not shrink as evenly as the norm of the theory.
const float JUDGED = 1.0 / 8.0, GOOD_ENOUGH = 0.36;
const float BLOWN_UP = 10.0;

// A warm start leaves so much less than a multiple of 1, of the flux astray and of all, or is refused: what nearly
// equal residuals come to depends on where they are, which nobody knows.
const float NEARER = 0.33;

// Where the amplification changed by more than this factor, v of the rows before says nothing of the rows now.
const float OTHER_ROWS = 16.0;

// Times what rounding alone may leave. Near: errors of rounding as Chebyshev collects them; damped sweeps, (T R + R) /
// 2, take them away, those of eigenvalue -1, which Jacobi leaves, too. At: nothing is left to gain but a factor of two.
const float NEAR_FLOOR = 64.0, AT_FLOOR = 2.0;
const uint POLISH_SWEEPS = 16u;

// What half a unit in the last place, of R as stored and of the nodes, leaves of the residual, of the largest R.
const float FLOOR = 2.0 / 16777216.0;

// The words of the state that the solve goes by, as registers: read at the start, written at the end. In place, their
// hundred loads and stores took llvmpipe 0.2 s to compile (Mesa 22.3), 0.3 s (25.0).
uint words[104];

void read_words()
{
	for (uint k = 0u; k < 26u; k++) {
		uvec4 four = load_four_words(k);
		for (uint c = 0u; c < 4u; c++)
			words[4u * k + c] = four[c];
	}
}

// Only those that may have changed, in loops short enough to be unrolled: an array with indices known only at run time
// is no registers.
void write_words()
{
	for (uint k = GI_STATE_SWEEPS; k <= GI_STATE_DONE_B_MAX_BITS; k++)
		state[k] = words[k];
	for (uint k = GI_STATE_ARGS_GATHER; k < GI_STATE_ARGS_RECYCLE; k++)
		state[k] = words[k];
	for (uint k = GI_STATE_ARGS_DOUBLE; k < GI_STATE_DIRECT_BITS; k++)
		state[k] = words[k];
	state[GI_STATE_START] = words[GI_STATE_START];
	for (uint k = GI_STATE_FACTOR_BITS; k < GI_STATE_LIFT_BITS; k++)
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

// What GI_ACTION_ says in a sweep's place the gather in single precision does.
void queue_sweep(bool in_double)
{
	bool chosen = in_double && words[GI_STATE_ACTION] <= GI_ACTION_KEEP;
	uint groups = groups_for(frame.counts.x);
	put_groups(GI_STATE_ARGS_GATHER, chosen ? 0u : groups);
	put_groups(GI_STATE_ARGS_DOUBLE, chosen ? groups : 0u);
	// Says which it was, after a sweep of no leaves too.
	words[GI_STATE_ARGS_DOUBLE + 2u] = chosen ? 1u : 0u;
}

void stop(uint verdict)
{
	// Solved without failing: a narrower ellipse may do for the next rows.
	if (verdict != GI_SOLVE_GOES_ON && words[GI_STATE_FAILINGS] == 0u && words[GI_STATE_ELLIPSE] > 0u)
		words[GI_STATE_ELLIPSE] -= 1u;
	words[GI_STATE_VERDICT] = verdict;
	words[GI_STATE_START] = GI_START_NONE;
	words[GI_STATE_ARGS_GATHER] = 0u;
	words[GI_STATE_ARGS_DOUBLE] = 0u;
	words[GI_STATE_ARGS_HAND_OVER] = 0u;
	words[GI_STATE_ARGS_CHECK] = 0u;
}

// Of a sweep about which nothing else is known.
void queue_next()
{
	queue_sweep(load(GI_STATE_SEEN_BITS) > AMPLIFIED);
}

// The largest light reflected, as far as it is known before the first sweep. A cold start has v = 1.
void note_first_scale()
{
	if (largest_of_three(GI_STATE_SCALE_BITS) == 0.0)
		store(GI_STATE_THETA_BITS, GI_DARK_SHARE);
	for (uint c = 0u; c < 3u; c++)
		store(GI_STATE_SCALE_BITS + c, max(load(GI_STATE_SCALE_BITS + c), load(GI_STATE_DIRECT_BITS + c)));
}

void begin_anew()
{
	words[GI_STATE_ACTION] = 0u;
	words[GI_STATE_MANNER] = GI_MANNER_JACOBI;
	words[GI_STATE_WINDOW] = words[GI_STATE_FAILINGS] = words[GI_STATE_RECALLS] = 0u;
	words[GI_STATE_REACH_BITS] = 0u;
	// A narrower ellipse may do for these rows.
	words[GI_STATE_ELLIPSE] =
	    (frame.update.w & GI_UPDATE_REBUILD) != 0u ? 0u : max(words[GI_STATE_ELLIPSE], 1u) - 1u;
	store(GI_STATE_OMEGA_BITS, 1.0);
	store(GI_STATE_AMPLIFICATION_BITS, HUGE);
	note_first_scale();
}

// From the light first reflected and v = 1, as where nothing was reflected before, and with nothing that depends on
// what was: the same scene, the same bits.
void begin_cold()
{
	words[GI_STATE_SWEEPS] = words[GI_STATE_ELLIPSE] = 0u;
	store(GI_STATE_SEEN_BITS, 0.0);
	for (uint c = 0u; c < 3u; c++)
		words[GI_STATE_SCALE_BITS + c] = 0u;
	begin_anew();
	words[GI_STATE_START] = GI_START_COLD;
	words[GI_STATE_ACTION] = GI_ACTION_COLD;
}

void begin_warm()
{
	begin_anew();
	words[GI_STATE_START] = GI_START_WARM;
}

// Sweeps of this frame, and what came in the place of sweeps: solver.c queues no more than max_sweeps of both and
// SPARE_SWEEPS.
uint spent()
{
	return words[GI_STATE_SWEEPS] + words[GI_STATE_RECALLS];
}

void begin()
{
	words[GI_STATE_SWEEPS] = words[GI_STATE_RECALLS] = 0u;
	words[GI_STATE_START] = GI_START_NONE;
	words[GI_STATE_VERDICT] = GI_SOLVE_GOES_ON;
	put_groups(GI_STATE_ARGS_HAND_OVER, groups_for(frame.counts.x));
	put_groups(GI_STATE_ARGS_CHECK, 1u);
	if (stage == STAGE_BEGIN && largest_of_three(GI_STATE_SCALE_BITS) == 0.0)
		begin_cold();
	else if (stage == STAGE_BEGIN)
		begin_warm();
	else if (words[GI_STATE_MANNER] == GI_MANNER_CHEBYSHEV && words[GI_STATE_ACTION] == 0u)
		words[GI_STATE_ACTION] = GI_ACTION_KEEP;
	clear_findings();
	queue_next();
	if (frame.counts.x == 0u) {
		store(GI_STATE_BOUND_BITS, 0.0);
		stop(GI_SOLVE_CONVERGED); // an empty scene
	}
	// Which rows did not fit is chance: B waits for the larger pool, and stays what it was.
	if (words[GI_STATE_OVERFLOW] != 0u)
		stop(GI_SOLVE_GOES_ON);
}

// ---- what a sweep found ----

float amplification()
{
	float a = 1.0 / min(load(GI_STATE_GAP_BITS), 1.0), m = load(GI_STATE_DESCENT_BITS);
	if (m > 0.0)
		a = min(a, load(GI_STATE_V_MAX_BITS) / m);
	return min(max(a, 1.0) * OUTWARD, HUGE);
}

// What errors count by is R + GI_DARK_SHARE * scale; the largest R may be less than the scale by now.
float shrunk()
{
	float most = 1.0;
	for (uint c = 0u; c < 3u; c++) {
		float scale = load(GI_STATE_SCALE_BITS + c), now = load(GI_STATE_R_MAX_BITS + c);
		most = max(most, scale <= now ? 1.0 : now > scale / HUGE ? scale / now * OUTWARD : HUGE);
	}
	return most;
}

// Bound on what T R is off by, of the light reflected; HUGE: none is known.
float relative_bound()
{
	return min(load(GI_STATE_KAPPA_BITS) * load(GI_STATE_SPREAD_BITS) * shrunk() * OUTWARD, HUGE);
}

void certify()
{
	float amplified = min(load(GI_STATE_AMPLIFICATION_BITS), amplification()), relative = relative_bound();
	float most = largest_of_three(GI_STATE_R_MAX_BITS), bound = load(GI_STATE_RESIDUAL_BITS) * (amplified - 1.0);
	if (relative < 1.0)
		bound = min(bound, relative * (1.0 + GI_DARK_SHARE) * most);
	bound = (bound + load(GI_STATE_WRITE_BITS)) * OUTWARD;
	store(GI_STATE_AMPLIFICATION_BITS, amplified);
	store(GI_STATE_BOUND_BITS, min(bound, HUGE));
	store(GI_STATE_BOUND_RELATIVE_BITS, min((relative + load(GI_STATE_STRAY_BITS) * shrunk()) * OUTWARD, HUGE));
	store(GI_STATE_ROUNDING_BITS, min(bound, FLOOR * most * amplified));
}

bool meets_tolerance()
{
	return load(GI_STATE_BOUND_RELATIVE_BITS) <= frame.tolerance.w;
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
	words[GI_STATE_ACTION] = GI_ACTION_KEEP;
}

// Back to where the window began, and on in a wider ellipse.
void fail_chebyshev()
{
	words[GI_STATE_FAILINGS] += 1u;
	words[GI_STATE_RECALLS] += 1u;
	start_chebyshev(load(GI_STATE_REACH_BITS), words[GI_STATE_ELLIPSE] + 1u, load(GI_STATE_KEPT_BITS));
	words[GI_STATE_ACTION] = GI_ACTION_RECALL;
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
	bool last = spent() + 1u >= max_sweeps;
	if (amplified < 0.5 * load(GI_STATE_REACH_BITS)) {
		start_chebyshev(amplified, words[GI_STATE_ELLIPSE], residual);
	} else if (bad && near_floor) {
		settle_for(GI_MANNER_POLISH, residual);
	} else if (bad || (last && residual > load(GI_STATE_KEPT_BITS))) {
		fail_chebyshev();
	} else if (judged) {
		open_window(residual);
		words[GI_STATE_ACTION] = GI_ACTION_KEEP;
	}
}

// ---- Jacobi ----

// How many more sweeps Jacobi takes to the tolerance when each leaves 1 - 1 / A of the bound.
uint foretell_jacobi(float amplified, float off)
{
	if (off <= frame.tolerance.w)
		return 0u;
	return uint(clamp(ceil(log(frame.tolerance.w / off) / log(1.0 - 1.0 / amplified)), 1.0, 1e6));
}

// Exact sweeps shrink the residual, in as many as the amplification by e: those that do not are rounding. Polishing
// takes away noise, or has nothing to take.
bool is_stuck(float amplified, float residual, bool in_double, bool polished)
{
	words[GI_STATE_WINDOW] += 1u;
	uint enough = polished ? POLISH_SWEEPS : POLISH_SWEEPS + uint(min(amplified, 1e6));
	if (in_double && words[GI_STATE_WINDOW] < enough)
		return false;
	bool stuck = in_double && residual > (polished ? 0.5 : 0.9) * load(GI_STATE_WINDOW_BITS);
	open_window(residual);
	return stuck;
}

// ---- after a sweep ----

// What is left of the bound by the next sweep: by the last one's progress, or the theory's.
float foretold(float amplified, float last_residual, float residual)
{
	if (words[GI_STATE_MANNER] == GI_MANNER_CHEBYSHEV)
		return rate(half_axes());
	float left = 1.0 - 1.0 / amplified;
	return last_residual > 0.0 ? min(left, residual / last_residual) : left;
}

// How the next sweep goes. False: more bring nothing.
bool go_on(bool in_double, bool near_floor, float residual)
{
	float amplified = load(GI_STATE_AMPLIFICATION_BITS), seen = load(GI_STATE_SEEN_BITS);
	bool steady = amplified >= 0.9 * seen && amplified <= 1.1 * seen;
	uint more = foretell_jacobi(amplified, relative_bound()), manner = words[GI_STATE_MANNER];
	if (manner == GI_MANNER_JACOBI || manner == GI_MANNER_GIVEN_UP)
		words[GI_STATE_JACOBI_SWEEPS] = words[GI_STATE_SWEEPS] + more;
	if (manner == GI_MANNER_CHEBYSHEV) {
		step_chebyshev(amplified, residual, near_floor);
	} else if (manner == GI_MANNER_JACOBI && steady && words[GI_STATE_SWEEPS] >= LOCAL_SWEEPS &&
		   more > JACOBI_MOST) {
		start_chebyshev(amplified, words[GI_STATE_ELLIPSE], residual);
	} else if (is_stuck(amplified, residual, in_double, near_floor && manner == GI_MANNER_POLISH)) {
		if (manner == GI_MANNER_POLISH)
			return false;
		settle_for(GI_MANNER_POLISH, residual);
	}
	return true;
}

void judge(bool in_double, float last_residual, float residual)
{
	float kappa = load(GI_STATE_KAPPA_BITS), least = load(GI_STATE_NOISE_BITS),
	      amplified = load(GI_STATE_AMPLIFICATION_BITS);
	bool at_floor = in_double && kappa <= AT_FLOOR * least && kappa < HUGE;
	if (at_floor || !go_on(in_double, in_double && kappa <= NEAR_FLOOR * least, residual)) {
		stop(GI_SOLVE_ROUNDING);
		return;
	}
	store(GI_STATE_SEEN_BITS, amplified);
	// What a step adds to T R counts against the bound; Chebyshev begins anew behind it where it was not enough.
	bool enough = foretold(amplified, last_residual, residual) * relative_bound() <= frame.tolerance.w;
	if (enough && words[GI_STATE_MANNER] == GI_MANNER_CHEBYSHEV)
		store(GI_STATE_OMEGA_BITS, 1.0);
	queue_sweep(amplified > AMPLIFIED || in_double || (kappa < HUGE && kappa <= IN_DOUBLE * least));
}

// ---- where a solve begins ----

// Is R of before no help in a channel, as far as what is left of the residual tells?
bool is_colder(uint c, float a)
{
	float astray = load(GI_STATE_WARM_MEAN_BITS + c), local = load(GI_STATE_WARM_MOST_BITS + c);
	float mean = load(GI_STATE_COLD_MEAN_BITS + c), most = load(GI_STATE_COLD_MOST_BITS + c);
	return !(astray <= NEARER * mean && a * astray + local <= NEARER * (a * mean + most));
}

// Does R of before leave no less than nothing would, in some channel? A cold start has nothing to be compared with.
bool is_refused(float a)
{
	return words[GI_STATE_START] == GI_START_WARM && (is_colder(0u, a) || is_colder(1u, a) || is_colder(2u, a));
}

// What the sweep would have made of the start that weigh.comp found, instead of what it made of R before. v anew, as of
// a sweep from v = 1, where that of other rows is no start.
void begin_from_start(float a, float seen)
{
	bool other_rows = words[GI_STATE_START] == GI_START_WARM && (a > OTHER_ROWS * seen || seen > OTHER_ROWS * a);
	store(GI_STATE_FACTOR_BITS + 3u, other_rows ? 0.0 : 1.0);
	store(GI_STATE_SEEN_BITS, other_rows ? 0.0 : seen);
	if (other_rows)
		words[GI_STATE_ELLIPSE] = 0u;
	for (uint c = 0u; other_rows && c < 3u; c++)
		words[GI_STATE_SCALE_BITS + c] = 0u;
	words[GI_STATE_DONE_RESIDUAL_BITS] = 0u;
	begin_anew();
	words[GI_STATE_SWEEPS] = max_sweeps > 1u ? 1u : 0u;
	words[GI_STATE_ACTION] = GI_ACTION_SCALE;
}

void begin_weighed(float seen)
{
	float a = amplification();
	if (is_refused(a))
		begin_cold();
	else
		begin_from_start(a, seen);
	queue_next();
}

// The sweeps of the frame are spent: no more, unless the last of them showed that they went astray. Then one follows
// the R that comes back, so that what is said is said of that R, and ends the frame whatever it finds (finish_sweep);
// the one that went astray does not count.
void end_frame()
{
	if (words[GI_STATE_ACTION] != GI_ACTION_RECALL)
		stop(GI_SOLVE_GOES_ON);
	else if (spent() > max_sweeps)
		words[GI_STATE_SWEEPS] -= 1u;
}

// ---- after a sweep, or what came in its place ----

// What a sweep found of the light, for the one that follows.
void note_light()
{
	for (uint c = 0u; c < 3u; c++)
		words[GI_STATE_SCALE_BITS + c] = words[GI_STATE_R_MAX_BITS + c];
	store(GI_STATE_THETA_BITS, GI_DARK_SHARE / max(load(GI_STATE_V_MAX_BITS), 1.0));
}

void finish_sweep()
{
	bool in_double = words[GI_STATE_ARGS_DOUBLE + 2u] != 0u;
	float residual = load(GI_STATE_RESIDUAL_BITS), seen = load(GI_STATE_SEEN_BITS);
	float last_residual = words[GI_STATE_SWEEPS] > 0u ? load(GI_STATE_DONE_RESIDUAL_BITS) : 0.0;
	// Of the R that this sweep kept, if it kept one.
	if (words[GI_STATE_ACTION] == GI_ACTION_KEEP)
		store(GI_STATE_KEPT_BITS, residual);
	bool weighed = words[GI_STATE_START] != GI_START_NONE;
	words[GI_STATE_ACTION] = 0u;
	words[GI_STATE_SWEEPS] += 1u;
	store(GI_STATE_DONE_RESIDUAL_BITS, residual);
	store(GI_STATE_DONE_Q_BITS, 1.0 - min(load(GI_STATE_GAP_BITS), 1.0));
	store(GI_STATE_DONE_B_MAX_BITS, load(GI_STATE_B_MAX_BITS));
	certify();
	if (meets_tolerance())
		stop(GI_SOLVE_CONVERGED);
	else if (spent() > max_sweeps)
		stop(GI_SOLVE_GOES_ON);
	else
		judge(in_double, last_residual, residual);
	note_light();
	if (words[GI_STATE_VERDICT] == GI_SOLVE_GOES_ON && weighed)
		begin_weighed(seen);
	else if (words[GI_STATE_VERDICT] == GI_SOLVE_GOES_ON && spent() >= max_sweeps)
		end_frame();
	clear_findings();
}

void finish_action()
{
	if (words[GI_STATE_ACTION] == GI_ACTION_SCALE)
		words[GI_STATE_START] = GI_START_NONE;
	words[GI_STATE_ACTION] = 0u;
	queue_next();
}

void main()
{
	read_words();
	if (stage != STAGE_SWEPT)
		begin();
	else if (words[GI_STATE_ACTION] > GI_ACTION_KEEP)
		finish_action();
	else
		finish_sweep();
	write_words();
}
