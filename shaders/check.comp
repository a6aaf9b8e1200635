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

// What the solve goes by, as registers: read at the start, written at the end. In place, its hundred loads and stores
// took llvmpipe 0.2 s to compile (Mesa 22.3), 0.3 s (25.0).
gi_state_solve solve;
gi_state_found found;
uint gather_groups, double_groups; // of the next sweep, one of them 0
bool over;                         // no sweep follows

void read_state()
{
	solve = state_before.solve;
	found = state_before.found;
	gather_groups = double_groups = 0u;
	over = false;
}

void write_state()
{
	state.solve = solve;
	state.found = found;
	state.gather = folded(gather_groups);
	state.gather_double = folded(double_groups);
	state.hand_over = folded(over ? 0u : groups_for(frame.counts.x));
	state.check = folded(over ? 0u : 1u);
}

float largest_of(vec3 x)
{
	return max(x.x, max(x.y, x.z));
}

void clear_findings()
{
	const uint INFINITY = 0x7F800000u;
	found = gi_state_found(uvec4(0u), 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u, INFINITY, INFINITY, 0u, 0u);
}

// ---- the solve's pace ----

// What GI_ACTION_ says in a sweep's place the gather in single precision does.
void queue_sweep(bool in_double)
{
	bool chosen = in_double && solve.action <= GI_ACTION_KEEP;
	uint groups = groups_for(frame.counts.x);
	gather_groups = chosen ? 0u : groups;
	double_groups = chosen ? groups : 0u;
	solve.in_double = chosen ? 1u : 0u;
}

void stop(uint verdict)
{
	// Solved without failing: a narrower ellipse may do for the next rows.
	if (verdict != GI_SOLVE_GOES_ON && solve.failings == 0u && solve.ellipse > 0u)
		solve.ellipse -= 1u;
	solve.verdict = verdict;
	solve.start = GI_START_NONE;
	gather_groups = double_groups = 0u;
	over = true;
}

// Of a sweep about which nothing else is known.
void queue_next()
{
	queue_sweep(solve.seen > AMPLIFIED);
}

// The largest light reflected, as far as it is known before the first sweep. A cold start has v = 1.
void note_first_scale()
{
	if (largest_of(solve.scale.xyz) == 0.0)
		solve.theta = GI_DARK_SHARE;
	solve.scale.xyz = max(solve.scale.xyz, uintBitsToFloat(state_before.emitted.direct_bits.xyz));
}

void begin_anew()
{
	solve.action = 0u;
	solve.manner = GI_MANNER_JACOBI;
	solve.window = solve.failings = solve.recalls = 0u;
	solve.reach = 0.0;
	// A narrower ellipse may do for these rows.
	solve.ellipse =
	    (frame.update.w & GI_UPDATE_REBUILD) != 0u ? 0u : max(solve.ellipse, 1u) - 1u;
	solve.omega = 1.0;
	solve.amplification = HUGE;
	note_first_scale();
}

// From the light first reflected and v = 1, as where nothing was reflected before, and with nothing that depends on
// what was: the same scene, the same bits.
void begin_cold()
{
	solve.sweeps = solve.ellipse = 0u;
	solve.seen = 0.0;
	solve.scale = vec4(0.0);
	begin_anew();
	solve.start = GI_START_COLD;
	solve.action = GI_ACTION_COLD;
}

void begin_warm()
{
	begin_anew();
	solve.start = GI_START_WARM;
}

// Sweeps of this frame, and what came in the place of sweeps: solver.c queues no more than max_sweeps of both and
// SPARE_SWEEPS.
uint spent()
{
	return solve.sweeps + solve.recalls;
}

void begin()
{
	solve.sweeps = solve.recalls = 0u;
	solve.start = GI_START_NONE;
	solve.verdict = GI_SOLVE_GOES_ON;
	if (stage == STAGE_BEGIN && largest_of(solve.scale.xyz) == 0.0)
		begin_cold();
	else if (stage == STAGE_BEGIN)
		begin_warm();
	else if (solve.manner == GI_MANNER_CHEBYSHEV && solve.action == 0u)
		solve.action = GI_ACTION_KEEP;
	clear_findings();
	queue_next();
	if (frame.counts.x == 0u) {
		solve.bound = 0.0;
		stop(GI_SOLVE_CONVERGED); // an empty scene
	}
	// Which rows did not fit is chance: B waits for the larger pool, and stays what it was.
	if (state_before.counts.overflow != 0u)
		stop(GI_SOLVE_GOES_ON);
}

// ---- what a sweep found ----

float amplification()
{
	float a = 1.0 / min(uintBitsToFloat(found.gap_bits), 1.0), m = uintBitsToFloat(found.descent_bits);
	if (m > 0.0)
		a = min(a, uintBitsToFloat(found.largest_v_bits) / m);
	return min(max(a, 1.0) * OUTWARD, HUGE);
}

// What errors count by is R + GI_DARK_SHARE * scale; the largest R may be less than the scale by now.
float shrunk()
{
	float most = 1.0;
	for (uint c = 0u; c < 3u; c++) {
		float scale = solve.scale[c], now = uintBitsToFloat(found.largest_r_bits[c]);
		most = max(most, scale <= now ? 1.0 : now > scale / HUGE ? scale / now * OUTWARD : HUGE);
	}
	return most;
}

// Bound on what T R is off by, of the light reflected; HUGE: none is known.
float relative_bound()
{
	return min(uintBitsToFloat(found.kappa_bits) * uintBitsToFloat(found.spread_bits) * shrunk() * OUTWARD, HUGE);
}

void certify()
{
	float amplified = min(solve.amplification, amplification()), relative = relative_bound();
	float most = largest_of(uintBitsToFloat(found.largest_r_bits.xyz)),
	      bound = uintBitsToFloat(found.residual_bits) * (amplified - 1.0);
	if (relative < 1.0)
		bound = min(bound, relative * (1.0 + GI_DARK_SHARE) * most);
	bound = (bound + uintBitsToFloat(found.write_bits)) * OUTWARD;
	solve.amplification = amplified;
	solve.bound = min(bound, HUGE);
	solve.bound_relative = min((relative + uintBitsToFloat(found.stray_bits) * shrunk()) * OUTWARD, HUGE);
	solve.rounding = min(bound, FLOOR * most * amplified);
}

bool meets_tolerance()
{
	return solve.bound_relative <= frame.tolerance.w;
}

// ---- Chebyshev ----

// Half axes of the ellipse: q, and b, none at first, then doubling from half of sqrt(1 - q^2), the scale of its cost.
vec2 half_axes()
{
	float q = 1.0 - 1.0 / solve.reach;
	float widened = float(solve.ellipse);
	return vec2(q, widened == 0.0 ? 0.0 : 0.25 * exp2(widened) * sqrt((1.0 - q) * (1.0 + q)));
}

// What a sweep leaves of the error in the long run.
float rate(vec2 axes)
{
	return (axes.x + axes.y) / (1.0 + sqrt(1.0 - axes.x * axes.x + axes.y * axes.y));
}

void open_window(float residual)
{
	solve.window = 0u;
	solve.window_residual = residual;
}

void settle_for(uint manner, float residual)
{
	solve.manner = manner;
	solve.omega = manner == GI_MANNER_POLISH ? 0.5 : 1.0;
	open_window(residual);
}

void start_chebyshev(float amplified, uint widened, float residual)
{
	solve.ellipse = widened;
	solve.reach = amplified;
	vec2 axes = half_axes();
	settle_for(axes.y < axes.x ? GI_MANNER_CHEBYSHEV : GI_MANNER_GIVEN_UP, residual);
	solve.action = GI_ACTION_KEEP;
}

// Back to where the window began, and on in a wider ellipse.
void fail_chebyshev()
{
	solve.failings += 1u;
	solve.recalls += 1u;
	start_chebyshev(solve.reach, solve.ellipse + 1u, solve.kept_residual);
	solve.action = GI_ACTION_RECALL;
}

void step_chebyshev(float amplified, float residual, bool near_floor)
{
	vec2 axes = half_axes();
	float omega = solve.omega, c2 = axes.x * axes.x - axes.y * axes.y;
	solve.omega = 1.0 / (1.0 - c2 * (omega == 1.0 ? 0.5 : 0.25 * omega));
	solve.window += 1u;
	float s = pow(rate(axes), float(solve.window - 1u)), begun = solve.window_residual;
	bool judged = 2.0 * s / (1.0 + s * s) <= JUDGED;
	bool bad = residual > BLOWN_UP * begun || (judged && residual > GOOD_ENOUGH * begun);
	bool last = spent() + 1u >= max_sweeps;
	if (amplified < 0.5 * solve.reach) {
		start_chebyshev(amplified, solve.ellipse, residual);
	} else if (bad && near_floor) {
		settle_for(GI_MANNER_POLISH, residual);
	} else if (bad || (last && residual > solve.kept_residual)) {
		fail_chebyshev();
	} else if (judged) {
		open_window(residual);
		solve.action = GI_ACTION_KEEP;
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
	solve.window += 1u;
	uint enough = polished ? POLISH_SWEEPS : POLISH_SWEEPS + uint(min(amplified, 1e6));
	if (in_double && solve.window < enough)
		return false;
	bool stuck = in_double && residual > (polished ? 0.5 : 0.9) * solve.window_residual;
	open_window(residual);
	return stuck;
}

// ---- after a sweep ----

// What is left of the bound by the next sweep: by the last one's progress, or the theory's.
float foretold(float amplified, float last_residual, float residual)
{
	if (solve.manner == GI_MANNER_CHEBYSHEV)
		return rate(half_axes());
	float left = 1.0 - 1.0 / amplified;
	return last_residual > 0.0 ? min(left, residual / last_residual) : left;
}

// How the next sweep goes. False: more bring nothing.
bool go_on(bool in_double, bool near_floor, float residual)
{
	float amplified = solve.amplification, seen = solve.seen;
	bool steady = amplified >= 0.9 * seen && amplified <= 1.1 * seen;
	uint more = foretell_jacobi(amplified, relative_bound()), manner = solve.manner;
	if (manner == GI_MANNER_JACOBI || manner == GI_MANNER_GIVEN_UP)
		solve.jacobi_sweeps = solve.sweeps + more;
	if (manner == GI_MANNER_CHEBYSHEV) {
		step_chebyshev(amplified, residual, near_floor);
	} else if (manner == GI_MANNER_JACOBI && steady && solve.sweeps >= LOCAL_SWEEPS &&
		   more > JACOBI_MOST) {
		start_chebyshev(amplified, solve.ellipse, residual);
	} else if (is_stuck(amplified, residual, in_double, near_floor && manner == GI_MANNER_POLISH)) {
		if (manner == GI_MANNER_POLISH)
			return false;
		settle_for(GI_MANNER_POLISH, residual);
	}
	return true;
}

void judge(bool in_double, float last_residual, float residual)
{
	float kappa = uintBitsToFloat(found.kappa_bits), least = uintBitsToFloat(found.noise_bits),
	      amplified = solve.amplification;
	bool at_floor = in_double && kappa <= AT_FLOOR * least && kappa < HUGE;
	if (at_floor || !go_on(in_double, in_double && kappa <= NEAR_FLOOR * least, residual)) {
		stop(GI_SOLVE_ROUNDING);
		return;
	}
	solve.seen = amplified;
	// What a step adds to T R counts against the bound; Chebyshev begins anew behind it where it was not enough.
	bool enough = foretold(amplified, last_residual, residual) * relative_bound() <= frame.tolerance.w;
	if (enough && solve.manner == GI_MANNER_CHEBYSHEV)
		solve.omega = 1.0;
	queue_sweep(amplified > AMPLIFIED || in_double || (kappa < HUGE && kappa <= IN_DOUBLE * least));
}

// ---- where a solve begins ----

// Is R of before no help in a channel, as far as what is left of the residual tells?
bool is_colder(uint c, float a)
{
	float astray = state_before.start.warm_mean[c], local = state_before.start.warm_most[c];
	float mean = state_before.start.cold_mean[c], most = state_before.start.cold_most[c];
	return !(astray <= NEARER * mean && a * astray + local <= NEARER * (a * mean + most));
}

// Does R of before leave no less than nothing would, in some channel? A cold start has nothing to be compared with.
bool is_refused(float a)
{
	return solve.start == GI_START_WARM && (is_colder(0u, a) || is_colder(1u, a) || is_colder(2u, a));
}

// What the sweep would have made of the start that weigh.comp found, instead of what it made of R before. v anew, as of
// a sweep from v = 1, where that of other rows is no start.
void begin_from_start(float a, float seen)
{
	bool other_rows = solve.start == GI_START_WARM && (a > OTHER_ROWS * seen || seen > OTHER_ROWS * a);
	solve.keeps_v = other_rows ? 0u : 1u;
	solve.seen = other_rows ? 0.0 : seen;
	if (other_rows) {
		solve.ellipse = 0u;
		solve.scale = vec4(0.0);
	}
	solve.residual = 0.0;
	begin_anew();
	solve.sweeps = max_sweeps > 1u ? 1u : 0u;
	solve.action = GI_ACTION_SCALE;
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
	if (solve.action != GI_ACTION_RECALL)
		stop(GI_SOLVE_GOES_ON);
	else if (spent() > max_sweeps)
		solve.sweeps -= 1u;
}

// ---- after a sweep, or what came in its place ----

// What a sweep found of the light, for the one that follows.
void note_light()
{
	solve.scale.xyz = uintBitsToFloat(found.largest_r_bits.xyz);
	solve.theta = GI_DARK_SHARE / max(uintBitsToFloat(found.largest_v_bits), 1.0);
}

void finish_sweep()
{
	bool in_double = solve.in_double != 0u;
	float residual = uintBitsToFloat(found.residual_bits), seen = solve.seen;
	float last_residual = solve.sweeps > 0u ? solve.residual : 0.0;
	// Of the R that this sweep kept, if it kept one.
	if (solve.action == GI_ACTION_KEEP)
		solve.kept_residual = residual;
	bool weighed = solve.start != GI_START_NONE;
	solve.action = 0u;
	solve.sweeps += 1u;
	solve.residual = residual;
	solve.contraction = 1.0 - min(uintBitsToFloat(found.gap_bits), 1.0);
	solve.largest_b = uintBitsToFloat(found.largest_b_bits);
	certify();
	if (meets_tolerance())
		stop(GI_SOLVE_CONVERGED);
	else if (spent() > max_sweeps)
		stop(GI_SOLVE_GOES_ON);
	else
		judge(in_double, last_residual, residual);
	note_light();
	if (solve.verdict == GI_SOLVE_GOES_ON && weighed)
		begin_weighed(seen);
	else if (solve.verdict == GI_SOLVE_GOES_ON && spent() >= max_sweeps)
		end_frame();
	clear_findings();
}

void finish_action()
{
	if (solve.action == GI_ACTION_SCALE)
		solve.start = GI_START_NONE;
	solve.action = 0u;
	queue_next();
}

void main()
{
	read_state();
	if (stage != STAGE_SWEPT)
		begin();
	else if (solve.action > GI_ACTION_KEEP)
		finish_action();
	else
		finish_sweep();
	write_state();
}
