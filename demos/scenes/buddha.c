/* How it works: the figure is a solid, given as a signed distance built from smoothly joined ellipsoids and tapered
 * capsules ("the clay", part by part: legs, trunk, arms, head). Around it lies a grid of RINGS x COLUMNS vertices,
 * closed at both ends by a grid of quads. Every vertex owns a ray from inside the body; where the ray last leaves the
 * clay is the vertex's target. The tables of rings and columns aim the rays, so that grid lines follow the features
 * (nose, brow, hem of the robe). The lotus is simple enough to be placed directly. At the end the cage is pushed out
 * until its limit surface, not the cage, passes through the targets.
 */
#include "scenes/buddha.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- The grid ---------------------------------------------------------------------------------------------------- */

enum {
	COLUMNS = 24,       /* around the figure: column 0 is the front, 6 its left (+x), 12 the back */
	HALF = COLUMNS / 2, /* columns 0..HALF are modelled, the others are their mirror images */
	LOTUS_RINGS = 8,
	BODY_RINGS = 32,
	NECK_RING = 16, /* the body ring from which on rays see the head */
	RINGS = LOTUS_RINGS + BODY_RINGS,
	FIT_ROUNDS = 8 /* corrections of the cage; what is left of a ripple from column to column is then 4 % */
};

static const double DEGREE = 0.017453292519943295, TURN = 6.283185307179586; /* radians */

typedef struct vec3 {
	double x, y, z;
} vec3;

static vec3 v3(double x, double y, double z)
{
	return (vec3){x, y, z};
}

static vec3 mirrored(vec3 a)
{
	return v3(-a.x, a.y, a.z);
}

static vec3 add(vec3 a, vec3 b)
{
	return v3(a.x + b.x, a.y + b.y, a.z + b.z);
}

static vec3 sub(vec3 a, vec3 b)
{
	return v3(a.x - b.x, a.y - b.y, a.z - b.z);
}

static vec3 scale(vec3 a, double s)
{
	return v3(a.x * s, a.y * s, a.z * s);
}

static double dot(vec3 a, vec3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

static vec3 cross(vec3 a, vec3 b)
{
	return v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

static double length(vec3 a)
{
	return sqrt(dot(a, a));
}

static double clamp(double x, double low, double high)
{
	return x < low ? low : x > high ? high : x;
}

static double mix(double a, double b, double t)
{
	return a + (b - a) * t;
}

/* ---- The clay ---------------------------------------------------------------------------------------------------- */

/* Signed distances, negative inside. The unit is nearly the height of the figure: at the end the whole is scaled so
 * that it becomes exactly that. */

static double ellipsoid(vec3 p, vec3 centre, vec3 radii)
{
	vec3 q = sub(p, centre);
	vec3 a = v3(q.x / radii.x, q.y / radii.y, q.z / radii.z);
	vec3 b = v3(a.x / radii.x, a.y / radii.y, a.z / radii.z);
	double k = length(a), gradient = length(b);

	/* First-order distance; at the very centre there is no gradient to divide by. */
	return gradient < 1e-9 ? -radii.y : k * (k - 1.0) / gradient;
}

/* A limb: radius ra at a, rb at b, straight in between. */
static double limb(vec3 p, vec3 a, double ra, vec3 b, double rb)
{
	vec3 ab = sub(b, a), ap = sub(p, a);
	double t = clamp(dot(ap, ab) / dot(ab, ab), 0.0, 1.0);

	return length(sub(ap, scale(ab, t))) - mix(ra, rb, t);
}

/* Union, the inner corner rounded over about `soft`. */
static double join(double a, double b, double soft)
{
	double h = fmax(soft - fabs(a - b), 0.0) / soft;

	return fmin(a, b) - h * h * soft * 0.25;
}

static double carve(double a, double hole, double soft)
{
	return -join(-a, hole, soft);
}

/* Only the half x >= 0 is modelled; all points come from there. Parts are given by centre and radii, or by both ends
 * and their radii; the last number of each join is the width of the rounding. */

static double legs(vec3 p)
{
	double thigh = limb(p, v3(0.08, 0.285, -0.06), 0.095, v3(0.285, 0.262, 0.10), 0.066);
	double shin = limb(p, v3(0.285, 0.256, 0.12), 0.060, v3(-0.03, 0.300, 0.218), 0.042); /* crosses the middle */
	double knee = ellipsoid(p, v3(0.288, 0.257, 0.11), v3(0.072, 0.060, 0.075));
	double foot = ellipsoid(p, v3(0.135, 0.338, 0.178), v3(0.065, 0.024, 0.030)); /* on the other leg's thigh */
	double d = join(join(thigh, shin, 0.012), knee, 0.03);

	/* The robe: under the shins, over the seat in front in pleats (one to every second column), across the lap, and
	 * from sleeve to thigh. It also fills the hollows that the rays could not reach. */
	double skirt = limb(p, v3(0.270, 0.230, 0.115), 0.043, v3(0.0, 0.235, 0.212), 0.048);
	double apron = ellipsoid(p, v3(0.0, 0.210, 0.225), v3(0.16, 0.040, 0.085));
	double pleat = 0.006 * cos(12.0 * atan2(p.x, p.z - 0.02));
	double lap = ellipsoid(p, v3(0.0, 0.285, 0.10), v3(0.26, 0.052, 0.11));
	double drape = ellipsoid(p, v3(0.18, 0.325, 0.08), v3(0.07, 0.035, 0.06));

	d = join(join(d, skirt, 0.035), apron - pleat, 0.02);
	d = join(join(d, lap, 0.02), drape, 0.04);
	return join(d, foot, 0.008);
}

static double trunk(vec3 p)
{
	double hips = ellipsoid(p, v3(0.0, 0.29, -0.05), v3(0.20, 0.12, 0.135));
	double belly = ellipsoid(p, v3(0.0, 0.41, -0.005), v3(0.138, 0.14, 0.112));
	double chest = ellipsoid(p, v3(0.0, 0.548, -0.015), v3(0.152, 0.125, 0.105));
	double breast = ellipsoid(p, v3(0.065, 0.575, 0.045), v3(0.07, 0.05, 0.034));
	double shoulders = limb(p, v3(0.0, 0.630, -0.03), 0.055, v3(0.150, 0.610, -0.03), 0.052);
	double slope = limb(p, v3(0.0, 0.664, -0.03), 0.045, v3(0.13, 0.632, -0.03), 0.030);
	double d = join(join(hips, belly, 0.08), chest, 0.07);

	d = join(d, breast, 0.05);
	return join(join(d, shoulders, 0.08), slope, 0.03);
}

static double arms(vec3 p)
{
	vec3 elbow = v3(0.222, 0.425, -0.015);
	double upper = limb(p, v3(0.176, 0.602, -0.028), 0.054, elbow, 0.054);
	double lower = limb(p, elbow, 0.054, v3(0.122, 0.384, 0.135), 0.052);
	double sleeve = limb(p, v3(0.225, 0.36, -0.02), 0.055, v3(0.15, 0.345, 0.10), 0.035);
	double fold = 0.005 * cos((p.y - 0.3 * p.z - 0.505) * TURN / 0.088); /* across the sleeve, every second ring */

	return join(join(upper, lower, 0.03), sleeve, 0.05) - fold;
}

/* One hand lies in the other, the thumbs meet above them. The palm lies deeper than one would see it: it is the floor
 * for the rays that pass beside the thumbs. */
static double hands(vec3 p)
{
	double fingers = ellipsoid(p, v3(0.030, 0.369, 0.192), v3(0.082, 0.024, 0.046));
	double thumb = ellipsoid(p, v3(0.020, 0.394, 0.180), v3(0.036, 0.026, 0.030));
	double wrist = limb(p, v3(0.060, 0.374, 0.165), 0.018, v3(0.120, 0.380, 0.140), 0.024);
	double palm = ellipsoid(p, v3(0.050, 0.380, 0.120), v3(0.075, 0.032, 0.034));

	return join(join(join(fingers, thumb, 0.010), wrist, 0.010), palm, 0.010);
}

/* Height of a fold that runs down the back, one to every second column; none near the shoulders and on the sides. */
static double back_fold(vec3 p)
{
	const double height = 0.010, spacing = 34.0 * DEGREE;
	double angle = atan2(p.x, -p.z - 0.02);
	double share = clamp(1.8 - 1.5 * angle, 0.0, 1.0) * clamp((0.66 - p.y) / 0.10, 0.0, 1.0);

	return height * share * cos(angle * TURN / spacing);
}

/* The robe is a second skin over the trunk. Its hems run down from the neck and meet in a bend above the belly; they
 * are rolled, less and less towards the bend. */
static double robe(vec3 p, double trunk_distance)
{
	const double cloth = 0.010, roll = 0.016, roll_width = 0.025, bend = 0.03;
	double from_hem = sqrt(p.x * p.x + bend * bend) * 0.909 - (p.y - 0.44) * 0.417; /* > 0: covered */
	double hem =
	    roll * exp(-from_hem * from_hem / (roll_width * roll_width)) * clamp((p.y - 0.47) / 0.10, 0.0, 1.0);
	bool has_opening = p.z > -0.02;

	return fmax(trunk_distance - cloth - hem - back_fold(p), has_opening ? -from_hem : -1.0);
}

static double neck(vec3 p)
{
	return limb(p, v3(0.0, 0.66, -0.025), 0.056, v3(0.0, 0.78, -0.01), 0.050);
}

static double face(vec3 p)
{
	double skull = ellipsoid(p, v3(0.0, 0.842, -0.008), v3(0.080, 0.080, 0.096));
	double jaw = ellipsoid(p, v3(0.0, 0.790, 0.020), v3(0.073, 0.078, 0.070));
	double chin = ellipsoid(p, v3(0.0, 0.725, 0.070), v3(0.024, 0.014, 0.018));
	double socket = ellipsoid(p, v3(0.036, 0.828, 0.102), v3(0.026, 0.014, 0.018));
	double lid = ellipsoid(p, v3(0.036, 0.825, 0.071), v3(0.022, 0.011, 0.014));
	double brow = join(limb(p, v3(0.010, 0.844, 0.089), 0.006, v3(0.036, 0.852, 0.080), 0.005),
			   limb(p, v3(0.036, 0.852, 0.080), 0.005, v3(0.060, 0.846, 0.060), 0.005), 0.004);
	double nose = limb(p, v3(0.0, 0.845, 0.090), 0.007, v3(0.0, 0.794, 0.110), 0.008);
	double wing = ellipsoid(p, v3(0.007, 0.793, 0.097), v3(0.007, 0.007, 0.010));
	double upper_lip = limb(p, v3(0.0, 0.765, 0.095), 0.006, v3(0.020, 0.765, 0.085), 0.004);
	double lower_lip = limb(p, v3(0.0, 0.746, 0.091), 0.007, v3(0.016, 0.748, 0.082), 0.005);
	double d = join(join(skull, jaw, 0.03), chin, 0.03);

	d = carve(d, socket, 0.010);
	d = join(d, lid, 0.004);
	d = join(d, brow, 0.008);
	d = join(join(d, nose, 0.008), wing, 0.006);
	return join(join(d, upper_lip, 0.006), lower_lip, 0.006);
}

static double ears(vec3 p)
{
	double shell = ellipsoid(p, v3(0.084, 0.822, -0.016), v3(0.015, 0.036, 0.020));
	double lobe = limb(p, v3(0.086, 0.80, -0.015), 0.012, v3(0.081, 0.747, -0.013), 0.012);

	return join(shell, lobe, 0.015);
}

static double hair(vec3 p)
{
	double cap = ellipsoid(p, v3(0.0, 0.848, -0.012), v3(0.086, 0.083, 0.106));
	double ushnisha = ellipsoid(p, v3(0.0, 0.940, -0.025), v3(0.047, 0.046, 0.049));
	double hairline = 0.872 + (p.z > 0.0 ? 0.15 : 1.1) * p.z; /* falls from the brow over the ears to the nape */

	return join(fmax(cap, hairline - p.y), ushnisha, 0.02);
}

static double body(vec3 p)
{
	double skin = trunk(p);
	double d = join(skin, robe(p, skin), 0.004);

	d = join(d, arms(p), 0.022);
	d = join(d, legs(p), 0.045);
	d = join(d, hands(p), 0.004);
	return join(d, neck(p), 0.025);
}

static double head(vec3 p)
{
	double d = join(neck(p), face(p), 0.015);

	d = join(d, hair(p), 0.004);
	return join(d, ears(p), 0.008);
}

/* Where the ray from `origin` (inside the clay) along `direction` leaves the clay for the last time. Rays of the head
 * and of the body each see their own part only, lest a ray that looks below the ear lobe ends on the shoulder. */
static vec3 last_exit(double (*clay)(vec3), vec3 origin, vec3 direction)
{
	const double far_away = 0.9, close_enough = 1e-5;
	const double careful = 0.6; /* share of the distance to step: the clay's distances are not exact */
	double t = far_away;
	int step;

	for (step = 0; step < 200 && t > 0.0; step++) {
		double d = clay(add(origin, scale(direction, t)));

		if (d < close_enough)
			break;
		t -= d * careful;
	}
	return add(origin, scale(direction, fmax(t, 0.0)));
}

/* ---- Aiming the rays --------------------------------------------------------------------------------------------- */

enum zone { ZONE_SEAT, ZONE_LAP, ZONE_BELLY, ZONE_CHEST, ZONE_COLLAR, ZONE_FACE, ZONE_CROWN, ZONES };

/* Azimuth of columns 0..HALF in degrees, 0 = front, 90 = side. On the trunk columns 1 and 2 run on either side of the
 * robe's hem; on the head column 1 is the side of the nose, 3 the outer corner of the eye, 7 the ear. */
/* clang-format off */
static const double azimuth[ZONES][HALF + 1] = {
	[ZONE_SEAT]   = {0, 15, 30, 45, 58, 70, 83, 97, 111, 126, 143, 161, 180},
	[ZONE_LAP]    = {0, 12, 24, 36, 48, 60, 75, 92, 108, 125, 142, 161, 180},
	[ZONE_BELLY]  = {0, 6, 15, 30, 46, 61, 77, 94, 110, 126, 143, 161, 180},
	[ZONE_CHEST]  = {0, 14, 24, 42, 58, 73, 88, 102, 116, 130, 146, 163, 180},
	[ZONE_COLLAR] = {0, 41, 51, 60, 69, 79, 90, 102, 115, 130, 146, 163, 180},
	[ZONE_FACE]   = {0, 8, 17, 28, 41, 57, 74, 87, 99, 114, 134, 157, 180},
	[ZONE_CROWN]  = {0, 14, 29, 45, 61, 76, 90, 104, 119, 135, 151, 166, 180},
};
/* clang-format on */

/* One ring of rays. */
typedef struct ring_aim {
	double y[3];        /* height of the origin for rays to the front, to the side and to the back */
	double pitch[3];    /* degrees above the horizon, likewise */
	double z;           /* of the origins */
	enum zone from, to; /* the columns' azimuths, */
	double share;       /* and how far they have moved from the one zone to the other */
} ring_aim;

/* clang-format off */
static const ring_aim aims[BODY_RINGS] = {
	/* legs */
	{{.212, .214, .210}, {0, 0, 0}, .02, ZONE_SEAT, ZONE_SEAT, 0},
	{{.238, .230, .235}, {0, 0, 0}, .02, ZONE_SEAT, ZONE_SEAT, 0},
	{{.272, .258, .275}, {0, 0, 0}, .02, ZONE_SEAT, ZONE_SEAT, 0},
	{{.300, .240, .315}, {4, 12, 0}, .02, ZONE_SEAT, ZONE_SEAT, 0},
	/* lap, hands, forearms */
	{{.298, .210, .350}, {10, 26, 0}, .02, ZONE_LAP, ZONE_LAP, 0},
	{{.310, .270, .385}, {15, 22, 0}, .0, ZONE_LAP, ZONE_LAP, 0},
	{{.330, .340, .420}, {15.5, 14, 0}, .0, ZONE_LAP, ZONE_LAP, 0},
	{{.350, .395, .450}, {14.5, 10, 0}, -.01, ZONE_LAP, ZONE_LAP, 0},
	{{.390, .425, .475}, {15, 10, 0}, -.02, ZONE_LAP, ZONE_BELLY, .8},
	/* belly and chest */
	{{.450, .460, .500}, {5, 5, 0}, -.02, ZONE_BELLY, ZONE_CHEST, 0},
	{{.500, .505, .535}, {0, 0, 0}, -.02, ZONE_BELLY, ZONE_CHEST, .35},
	{{.545, .550, .575}, {0, 0, 0}, -.02, ZONE_CHEST, ZONE_CHEST, 0},
	{{.586, .586, .605}, {0, 5, 0}, -.02, ZONE_CHEST, ZONE_COLLAR, .3},
	{{.620, .604, .628}, {0, 15, 5}, -.025, ZONE_CHEST, ZONE_COLLAR, .65},
	{{.645, .620, .645}, {5, 28, 15}, -.03, ZONE_COLLAR, ZONE_COLLAR, 0},
	{{.664, .640, .666}, {5, 42, 20}, -.03, ZONE_COLLAR, ZONE_FACE, .3},
	/* neck, chin, mouth, nose */
	{{.692, .702, .714}, {0, 0, 0}, -.02, ZONE_FACE, ZONE_FACE, 0},
	{{.765, .722, .742}, {-38, 0, 0}, -.01, ZONE_FACE, ZONE_FACE, 0},
	{{.727, .742, .760}, {0, 0, 0}, -.01, ZONE_FACE, ZONE_FACE, 0},
	{{.745, .757, .770}, {0, 0, 0}, -.01, ZONE_FACE, ZONE_FACE, 0},
	{{.755, .766, .780}, {0, 0, 0}, -.01, ZONE_FACE, ZONE_FACE, 0},
	{{.765, .776, .790}, {0, 0, 0}, -.01, ZONE_FACE, ZONE_FACE, 0},
	{{.778, .787, .800}, {0, 0, 0}, -.01, ZONE_FACE, ZONE_FACE, 0},
	{{.793, .800, .814}, {0, 0, 0}, -.01, ZONE_FACE, ZONE_FACE, 0},
	/* eyes, brow, hair */
	{{.817, .818, .828}, {0, 0, 0}, -.01, ZONE_FACE, ZONE_FACE, 0},
	{{.828, .830, .840}, {0, 0, 0}, -.01, ZONE_FACE, ZONE_FACE, 0},
	{{.839, .842, .852}, {0, 0, 0}, -.01, ZONE_FACE, ZONE_FACE, 0},
	{{.848, .852, .864}, {0, 0, 0}, -.01, ZONE_FACE, ZONE_FACE, 0},
	{{.858, .858, .860}, {6, 8, 8}, -.01, ZONE_FACE, ZONE_CROWN, .3},
	{{.858, .860, .860}, {20, 20, 22}, -.02, ZONE_FACE, ZONE_CROWN, .6},
	{{.860, .860, .860}, {40, 39, 38}, -.025, ZONE_CROWN, ZONE_CROWN, 0},
	{{.872, .872, .872}, {50, 49, 49}, -.025, ZONE_CROWN, ZONE_CROWN, 0},
};
/* clang-format on */

/* Blends a table's front, side and back value smoothly over the azimuth. */
static double around(const double value[3], double angle)
{
	double front = fmax(cos(angle), 0.0), back = fmax(-cos(angle), 0.0), side = sin(angle);

	return value[0] * front * front + value[1] * side * side + value[2] * back * back;
}

static vec3 direction_of(double angle, double pitch)
{
	return v3(sin(angle) * cos(pitch), sin(pitch), cos(angle) * cos(pitch));
}

static vec3 body_target(int ring, int column)
{
	const ring_aim *aim = &aims[ring];
	double angle = DEGREE * mix(azimuth[aim->from][column], azimuth[aim->to][column], aim->share);
	double pitch = DEGREE * around(aim->pitch, angle);
	vec3 target = last_exit(ring < NECK_RING ? body : head, v3(0.0, around(aim->y, angle), aim->z),
				direction_of(angle, pitch));

	if (column == 0 || column == HALF)
		target.x = 0.0;
	return target;
}

/* ---- The lotus --------------------------------------------------------------------------------------------------- */

/* One ring of the pedestal: height and radius, and what a petal's middle adds to both (a notch takes it away).
 * Petals are two columns wide. */
typedef struct lotus_ring {
	double y, radius, petal_y, petal_radius;
} lotus_ring;

/* clang-format off */
static const lotus_ring lotus[LOTUS_RINGS] = {
	{.000, .345, .000, -.015}, /* the foot, flat on the floor */
	{.020, .376, .000, -.028}, /* lower tier: tips point down, between those of the upper tier */
	{.060, .352, .000, -.024},
	{.098, .296, .000, .000}, /* waist */
	{.128, .345, -.006, .020},
	{.166, .384, .000, .028}, /* upper tier: tips point up */
	{.196, .402, .016, .028},
	{.194, .368, .003, .004}, /* the seat */
};
/* clang-format on */
static const double LOTUS_DEPTH = 0.86;     /* z radius over x radius */
static const double LOTUS_CENTRE_Z = 0.035; /* the knees reach further forward than the back reaches back */

static vec3 lotus_target(int ring, int column)
{
	const lotus_ring *l = &lotus[ring];
	double angle = DEGREE * 180.0 / HALF * column;
	double petal = column % 2 == 0 ? 1.0 : -1.0;
	double radius = l->radius + petal * l->petal_radius;
	double x = column == 0 || column == HALF ? 0.0 : radius * sin(angle);

	return v3(x, l->y + petal * l->petal_y, radius * LOTUS_DEPTH * cos(angle) + LOTUS_CENTRE_Z);
}

/* ---- The grids that close both ends ------------------------------------------------------------------------------ */

/* A cap is a grid of width x depth quads whose rim, 2 (width + depth) = COLUMNS edges long, is a whole ring. Both
 * numbers are even, so that a grid line lies in the plane of symmetry. The vertices that no ring owns are numbered
 * from `first`. */
typedef struct cap_grid {
	int width, depth, ring, first;
} cap_grid;

enum {
	BOTTOM_WIDTH = 2,
	BOTTOM_DEPTH = 10, /* never seen, so as few faces as will do */
	TOP_WIDTH = 6,
	TOP_DEPTH = 6,
	BOTTOM_FIRST = RINGS * COLUMNS,
	TOP_FIRST = BOTTOM_FIRST + (BOTTOM_WIDTH - 1) * (BOTTOM_DEPTH - 1),
	VERTICES = TOP_FIRST + (TOP_WIDTH - 1) * (TOP_DEPTH - 1),
	CROWN = TOP_FIRST + (TOP_WIDTH - 1) * (TOP_DEPTH - 1) / 2,
	FACES = (RINGS - 1) * COLUMNS + BOTTOM_WIDTH * BOTTOM_DEPTH + TOP_WIDTH * TOP_DEPTH
};

static const cap_grid bottom = {BOTTOM_WIDTH, BOTTOM_DEPTH, 0, BOTTOM_FIRST};
static const cap_grid top = {TOP_WIDTH, TOP_DEPTH, RINGS - 1, TOP_FIRST};

static bool is_inner(const cap_grid *cap, int i, int j)
{
	return i > 0 && i < cap->width && j > 0 && j < cap->depth;
}

/* The column of rim point (i, j); i = 0..width grows to +x, j = 0..depth to +z. Column 0 is the middle of the +z
 * side. */
static int rim_column(const cap_grid *cap, int i, int j)
{
	int right = cap->width / 2; /* the column of the corner (width, depth) */
	int column;

	if (j == cap->depth)
		column = i - right;
	else if (i == cap->width)
		column = right + cap->depth - j;
	else if (j == 0)
		column = right + cap->depth + cap->width - i;
	else
		column = right + cap->depth + cap->width + j;
	return (column + COLUMNS) % COLUMNS;
}

static int cap_vertex(const cap_grid *cap, int i, int j)
{
	if (is_inner(cap, i, j))
		return cap->first + (j - 1) * (cap->width - 1) + (i - 1);
	return cap->ring * COLUMNS + rim_column(cap, i, j);
}

/* An inner point of the bottom lies on the floor, on the line between the rim's points left and right of it. */
static vec3 bottom_target(int i, int j)
{
	vec3 right = lotus_target(0, rim_column(&bottom, bottom.width, j));

	return v3(right.x * (2.0 * i / bottom.width - 1.0), 0.0, right.z);
}

/* The top continues the last ring of rays up to the zenith; the square grid is mapped to a disc of openings. */
static vec3 top_target(int i, int j)
{
	const ring_aim *rim = &aims[BODY_RINGS - 1];
	double u = 2.0 * i / top.width - 1.0, v = 2.0 * j / top.depth - 1.0;
	double x = u * sqrt(1.0 - 0.5 * v * v), z = v * sqrt(1.0 - 0.5 * u * u);
	double angle = atan2(fabs(x), z);
	double pitch = 90.0 - sqrt(x * x + z * z) * (90.0 - around(rim->pitch, angle));
	vec3 target = last_exit(head, v3(0.0, around(rim->y, angle), rim->z), direction_of(angle, DEGREE * pitch));

	if (2 * i == top.width)
		target.x = 0.0;
	return x < 0.0 ? mirrored(target) : target;
}

/* ---- Targets and faces ------------------------------------------------------------------------------------------- */

/* Only the half x >= 0 is computed and then mirrored, so that symmetry is exact to the bit. */
static void place_targets(vec3 targets[VERTICES])
{
	int ring, column, i, j;

	for (ring = 0; ring < RINGS; ring++) {
		for (column = 0; column <= HALF; column++) {
			bool in_lotus = ring < LOTUS_RINGS;
			vec3 t = in_lotus ? lotus_target(ring, column) : body_target(ring - LOTUS_RINGS, column);

			targets[ring * COLUMNS + column] = t;
			targets[ring * COLUMNS + (COLUMNS - column) % COLUMNS] = mirrored(t);
		}
	}
	for (j = 1; j < bottom.depth; j++)
		for (i = 1; i < bottom.width; i++)
			targets[cap_vertex(&bottom, i, j)] = bottom_target(i, j);
	for (j = 1; j < top.depth; j++)
		for (i = 1; i < top.width; i++)
			targets[cap_vertex(&top, i, j)] = top_target(i, j);
}

static void put_quad(uint32_t **at, int a, int b, int c, int d)
{
	*(*at)++ = (uint32_t)a;
	*(*at)++ = (uint32_t)b;
	*(*at)++ = (uint32_t)c;
	*(*at)++ = (uint32_t)d;
}

static void list_faces(uint32_t indices[4 * FACES])
{
	uint32_t *at = indices;
	int ring, column, i, j;

	for (ring = 0; ring + 1 < RINGS; ring++) {
		for (column = 0; column < COLUMNS; column++) {
			int low = ring * COLUMNS, high = low + COLUMNS, next = (column + 1) % COLUMNS;

			put_quad(&at, low + column, low + next, high + next, high + column);
		}
	}
	for (j = 0; j < bottom.depth; j++)
		for (i = 0; i < bottom.width; i++)
			put_quad(&at, cap_vertex(&bottom, i, j), cap_vertex(&bottom, i + 1, j),
				 cap_vertex(&bottom, i + 1, j + 1), cap_vertex(&bottom, i, j + 1));
	for (j = 0; j < top.depth; j++)
		for (i = 0; i < top.width; i++)
			put_quad(&at, cap_vertex(&top, i, j), cap_vertex(&top, i, j + 1),
				 cap_vertex(&top, i + 1, j + 1), cap_vertex(&top, i + 1, j));
}

/* ---- Fitting the limit surface ----------------------------------------------------------------------------------- */

/* Where each cage vertex ends up on the limit surface. For a vertex of valence n with faces all quads that is
 * (n^2 v + 4 * sum of edge neighbours + sum of face opposites) / (n (n + 5)). */
static void limit_points(const vec3 cage[VERTICES], const uint32_t indices[4 * FACES], vec3 limit[VERTICES])
{
	int valence[VERTICES] = {0};
	int v, f, k;

	for (v = 0; v < VERTICES; v++)
		limit[v] = v3(0.0, 0.0, 0.0);
	for (f = 0; f < FACES; f++) {
		const uint32_t *q = &indices[4 * f];

		for (k = 0; k < 4; k++) {
			/* Each edge is met in two faces, so each of its two visits counts half. */
			vec3 edges = add(cage[q[(k + 1) % 4]], cage[q[(k + 3) % 4]]);

			limit[q[k]] = add(limit[q[k]], add(scale(edges, 2.0), cage[q[(k + 2) % 4]]));
			valence[q[k]]++;
		}
	}
	for (v = 0; v < VERTICES; v++) {
		double n = valence[v];

		limit[v] = scale(add(limit[v], scale(cage[v], n * n)), 1.0 / (n * (n + 5.0)));
	}
}

/* Sums of face normals around each vertex, made unit length. */
static void vertex_normals(const vec3 points[VERTICES], const uint32_t indices[4 * FACES], vec3 normals[VERTICES])
{
	int v, f, k;

	for (v = 0; v < VERTICES; v++)
		normals[v] = v3(0.0, 0.0, 0.0);
	for (f = 0; f < FACES; f++) {
		const uint32_t *q = &indices[4 * f];
		vec3 n = cross(sub(points[q[2]], points[q[0]]), sub(points[q[3]], points[q[1]]));

		for (k = 0; k < 4; k++)
			normals[q[k]] = add(normals[q[k]], n);
	}
	for (v = 0; v < VERTICES; v++)
		normals[v] = scale(normals[v], 1.0 / length(normals[v]));
}

/* Pushes the cage until the limit surface meets the targets. Errors along the surface are harmless and mended only in
 * part: where rings lie at uneven distances, mending them all would bunch the surface up into folds. The foot ring and
 * the bottom keep y = 0: then the limit surface cannot sink below the floor. */
static void fit(const vec3 targets[VERTICES], const uint32_t indices[4 * FACES], vec3 cage[VERTICES])
{
	const double sideways = 0.15;
	vec3 limit[VERTICES], normals[VERTICES];
	int round, v;

	memcpy(cage, targets, VERTICES * sizeof *cage);
	vertex_normals(targets, indices, normals);
	for (round = 0; round < FIT_ROUNDS; round++) {
		limit_points(cage, indices, limit);
		for (v = 0; v < VERTICES; v++) {
			bool on_floor = v < COLUMNS || (v >= BOTTOM_FIRST && v < TOP_FIRST);
			vec3 error = sub(targets[v], limit[v]);
			vec3 outward = scale(normals[v], dot(error, normals[v]));
			vec3 push = add(outward, scale(sub(error, outward), sideways));

			if (on_floor)
				push.y = 0.0;
			cage[v] = add(cage[v], push);
		}
	}
}

/* Gives the half x < 0 of a row of vertices the mirror image of the half x > 0; `last` mirrors `first`. */
static void mirror_row(vec3 *first, vec3 *last)
{
	for (; first < last; first++, last--)
		*first = mirrored(*last);
	if (first == last)
		first->x = 0.0;
}

/* Sets the height of the limit surface to exactly one, and the symmetry, which the fit's sums keep only up to
 * rounding, to the bit. */
static void finish(const uint32_t indices[4 * FACES], vec3 cage[VERTICES])
{
	vec3 limit[VERTICES];
	double height;
	int v, ring, column, j;

	limit_points(cage, indices, limit);
	height = limit[CROWN].y;
	for (v = 0; v < VERTICES; v++)
		cage[v] = scale(cage[v], 1.0 / height);
	for (ring = 0; ring < RINGS; ring++) {
		vec3 *row = &cage[ring * COLUMNS];

		row[0].x = row[HALF].x = 0.0;
		for (column = 1; column < HALF; column++)
			row[COLUMNS - column] = mirrored(row[column]);
	}
	for (j = 1; j < bottom.depth; j++)
		mirror_row(&cage[cap_vertex(&bottom, 1, j)], &cage[cap_vertex(&bottom, bottom.width - 1, j)]);
	for (j = 1; j < top.depth; j++)
		mirror_row(&cage[cap_vertex(&top, 1, j)], &cage[cap_vertex(&top, top.width - 1, j)]);
}

/* ---- The mesh ---------------------------------------------------------------------------------------------------- */

bool buddha_cage(engine_mesh *out)
{
	vec3 targets[VERTICES], cage[VERTICES];
	int v, f;

	memset(out, 0, sizeof *out);
	out->positions = malloc(3 * VERTICES * sizeof *out->positions);
	out->face_counts = malloc(FACES * sizeof *out->face_counts);
	out->indices = malloc(4 * FACES * sizeof *out->indices);
	if (!out->positions || !out->face_counts || !out->indices) {
		engine_mesh_free(out);
		return false;
	}
	list_faces(out->indices);
	place_targets(targets);
	fit(targets, out->indices, cage);
	finish(out->indices, cage);
	for (v = 0; v < VERTICES; v++) {
		out->positions[3 * v] = (float)cage[v].x;
		out->positions[3 * v + 1] = (float)cage[v].y;
		out->positions[3 * v + 2] = (float)cage[v].z;
	}
	for (f = 0; f < FACES; f++)
		out->face_counts[f] = 4;
	out->vertex_count = VERTICES;
	out->face_count = FACES;
	out->index_count = 4 * FACES;
	return true;
}
