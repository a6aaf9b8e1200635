/* How it works: the figure is a solid, given as a signed distance built from smoothly joined ellipsoids and tapered
 * capsules ("the clay", part by part: legs, torso, arms, head). Around it lies a grid of RINGS x COLUMNS vertices,
 * closed below and above by a square grid each. Every vertex owns a ray from inside the body; where the ray last
 * leaves the clay is the vertex's target. The tables of rings and columns aim the rays, so that grid lines follow
 * the features (nose, brow, robe edge). The lotus is simple enough to be placed directly. At the end the cage is
 * pushed out until its limit surface, not the cage, passes through the targets.
 */
#include "scenes/buddha.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- The grid ---------------------------------------------------------------------------------------------- */

enum {
	COLUMNS = 24,                        /* around the figure; column 0 is the front, 6 its left (+x), 12 the back */
	HALF = COLUMNS / 2,                  /* columns 0..HALF are modelled, the others are their mirror images */
	LOTUS_RINGS = 9,
	BODY_RINGS = 29,
	NECK_RING = 17,                      /* the body ring from which on rays see the head */
	RINGS = LOTUS_RINGS + BODY_RINGS,
	CAP = COLUMNS / 4,                   /* the square grids at both ends have CAP x CAP faces */
	CAP_INNER = (CAP - 1) * (CAP - 1),   /* vertices of such a grid that no ring owns */
	BOTTOM_FIRST = RINGS * COLUMNS,      /* vertex numbers: rings, then inner bottom, then inner top */
	TOP_FIRST = BOTTOM_FIRST + CAP_INNER,
	VERTICES = TOP_FIRST + CAP_INNER,
	FACES = (RINGS - 1) * COLUMNS + 2 * CAP * CAP,
	FIT_ROUNDS = 8                       /* cage corrections; the error of the finest waves is still a third of itself */
};

static const double DEGREE = 0.017453292519943295;

typedef struct vec3 {
	double x, y, z;
} vec3;

static vec3 v3(double x, double y, double z)
{
	return (vec3){x, y, z};
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

/* ---- The clay: signed distances, negative inside. Lengths in figure heights. --------------------------------- */

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

/* All parts get p.x >= 0: the caller folds space at the plane of symmetry. */

static double legs(vec3 p)
{
	double thigh = limb(p, v3(0.08, 0.285, -0.06), 0.095, v3(0.285, 0.268, 0.10), 0.068);
	double shin = limb(p, v3(0.29, 0.262, 0.115), 0.062, v3(0.0, 0.262, 0.235), 0.052);
	double knee = ellipsoid(p, v3(0.295, 0.262, 0.11), v3(0.072, 0.062, 0.075));
	double apron = ellipsoid(p, v3(0.0, 0.205, 0.235), v3(0.15, 0.028, 0.085));
	double sole = ellipsoid(p, v3(0.155, 0.335, 0.155), v3(0.075, 0.026, 0.036));
	double lap = ellipsoid(p, v3(0.0, 0.30, 0.14), v3(0.14, 0.045, 0.10));
	double d = join(join(thigh, shin, 0.03), knee, 0.03);

	d = join(join(d, apron, 0.02), lap, 0.03);
	return join(d, sole, 0.012);
}

static double trunk(vec3 p)
{
	double hips = ellipsoid(p, v3(0.0, 0.29, -0.05), v3(0.20, 0.12, 0.135));
	double belly = ellipsoid(p, v3(0.0, 0.41, -0.005), v3(0.138, 0.14, 0.112));
	double chest = ellipsoid(p, v3(0.0, 0.555, -0.015), v3(0.158, 0.125, 0.105));
	double breast = ellipsoid(p, v3(0.07, 0.575, 0.045), v3(0.07, 0.05, 0.045));
	double shoulders = limb(p, v3(0.0, 0.645, -0.03), 0.055, v3(0.165, 0.63, -0.03), 0.055);
	double slope = limb(p, v3(0.0, 0.705, -0.03), 0.045, v3(0.13, 0.65, -0.03), 0.035);
	double d = join(join(hips, belly, 0.08), chest, 0.07);

	d = join(d, breast, 0.05);
	return join(join(d, shoulders, 0.05), slope, 0.03);
}

static double arms(vec3 p)
{
	vec3 elbow = v3(0.232, 0.43, -0.015);
	double upper = limb(p, v3(0.188, 0.625, -0.028), 0.056, elbow, 0.053);
	double lower = limb(p, elbow, 0.053, v3(0.075, 0.372, 0.165), 0.036);
	double sleeve = limb(p, v3(0.235, 0.37, -0.01), 0.05, v3(0.15, 0.345, 0.10), 0.035);

	return join(join(upper, lower, 0.03), sleeve, 0.04);
}

static double hands(vec3 p)
{
	double palm = ellipsoid(p, v3(0.035, 0.372, 0.19), v3(0.075, 0.028, 0.042));
	double thumb = limb(p, v3(0.06, 0.385, 0.185), 0.014, v3(0.0, 0.418, 0.192), 0.012);

	return join(palm, thumb, 0.01);
}

/* The robe is a second skin over the trunk; its edges run down from the neck and meet above the hands. */
static double robe(vec3 p, double trunk_distance)
{
	const double thickness = 0.016;
	double edge = (p.x - 0.012) * 0.95 - (p.y - 0.43) * 0.33; /* > 0: covered */

	return fmax(trunk_distance - thickness, p.z > -0.02 ? -edge : -1.0);
}

static double neck(vec3 p)
{
	return limb(p, v3(0.0, 0.66, -0.025), 0.056, v3(0.0, 0.78, -0.01), 0.050);
}

static double face(vec3 p)
{
	double skull = ellipsoid(p, v3(0.0, 0.845, -0.012), v3(0.083, 0.092, 0.094));
	double jaw = ellipsoid(p, v3(0.0, 0.795, 0.022), v3(0.070, 0.078, 0.066));
	double chin = ellipsoid(p, v3(0.0, 0.735, 0.058), v3(0.026, 0.018, 0.022));
	double socket = ellipsoid(p, v3(0.034, 0.824, 0.098), v3(0.022, 0.010, 0.018));
	double lid = ellipsoid(p, v3(0.036, 0.819, 0.066), v3(0.020, 0.011, 0.016));
	double brow = limb(p, v3(0.010, 0.838, 0.084), 0.007, v3(0.050, 0.845, 0.062), 0.006);
	double nose = limb(p, v3(0.0, 0.835, 0.086), 0.008, v3(0.0, 0.792, 0.100), 0.012);
	double wing = ellipsoid(p, v3(0.011, 0.789, 0.092), v3(0.009, 0.008, 0.010));
	double upper_lip = limb(p, v3(0.0, 0.770, 0.090), 0.008, v3(0.025, 0.769, 0.076), 0.005);
	double lower_lip = limb(p, v3(0.0, 0.757, 0.086), 0.009, v3(0.018, 0.760, 0.076), 0.005);
	double d = join(join(skull, jaw, 0.03), chin, 0.03);

	d = carve(d, socket, 0.012);
	d = join(d, lid, 0.006);
	d = join(d, brow, 0.010);
	d = join(join(d, nose, 0.010), wing, 0.006);
	return join(join(d, upper_lip, 0.006), lower_lip, 0.006);
}

static double ears(vec3 p)
{
	double shell = ellipsoid(p, v3(0.092, 0.825, -0.008), v3(0.014, 0.040, 0.024));
	double lobe = limb(p, v3(0.092, 0.80, -0.002), 0.014, v3(0.086, 0.735, 0.004), 0.014);

	return join(shell, lobe, 0.015);
}

static double hair(vec3 p)
{
	double cap = ellipsoid(p, v3(0.0, 0.862, -0.022), v3(0.093, 0.086, 0.098));
	double ushnisha = ellipsoid(p, v3(0.0, 0.945, -0.028), v3(0.046, 0.055, 0.048));

	return join(cap, ushnisha, 0.025);
}

static double body(vec3 p)
{
	double skin = trunk(p);
	double d = join(skin, robe(p, skin), 0.004);

	d = join(d, arms(p), 0.022);
	d = join(d, legs(p), 0.025);
	d = join(d, hands(p), 0.012);
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
	const double far_away = 0.9, careful = 0.6, close_enough = 1e-5; /* distances of blends are not exact */
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

/* ---- Aiming the rays ----------------------------------------------------------------------------------------- */

enum zone { ZONE_SEAT, ZONE_LAP, ZONE_CHEST, ZONE_COLLAR, ZONE_FACE, ZONE_CROWN, ZONES };

/* Azimuth of columns 0..HALF in degrees, 0 = front, 90 = side. */
static const double azimuth[ZONES][HALF + 1] = {
	[ZONE_SEAT]   = {0, 15, 30, 45, 58, 68, 80, 95, 110, 125, 142, 161, 180},
	[ZONE_LAP]    = {0, 12, 24, 36, 48, 60, 75, 92, 108, 125, 142, 161, 180},
	[ZONE_CHEST]  = {0, 17, 30, 46, 60, 74, 88, 102, 116, 130, 146, 163, 180},
	[ZONE_COLLAR] = {0, 22, 42, 56, 68, 78, 90, 102, 115, 130, 146, 163, 180},
	[ZONE_FACE]   = {0, 10, 21, 34, 50, 70, 86, 100, 114, 129, 145, 162, 180},
	[ZONE_CROWN]  = {0, 14, 29, 45, 61, 76, 90, 104, 119, 135, 151, 166, 180},
};

/* One ring of rays: heights of the origin and pitch above the horizon (degrees) for the rays to the front, to the
 * side and to the back, z of the axis that the origins lie on, and how far the columns have moved from one zone's
 * azimuths to those of the next. */
typedef struct ring_aim {
	double y[3], pitch[3], z;
	enum zone from, to;
	double share;
} ring_aim;

static const ring_aim aims[BODY_RINGS] = {
	/* legs */
	{{.210, .214, .210}, {0, 0, 0}, .02, ZONE_SEAT, ZONE_SEAT, 0},
	{{.232, .232, .235}, {0, 0, 0}, .02, ZONE_SEAT, ZONE_SEAT, 0},
	{{.262, .262, .275}, {0, 0, 0}, .02, ZONE_SEAT, ZONE_SEAT, 0},
	{{.285, .290, .315}, {5, 0, 0}, .02, ZONE_SEAT, ZONE_SEAT, 0},
	{{.290, .305, .350}, {15, 5, 0}, .02, ZONE_SEAT, ZONE_LAP, .5},
	/* lap, hands, forearms */
	{{.295, .320, .375}, {21, 10, 0}, .02, ZONE_LAP, ZONE_LAP, 0},
	{{.310, .340, .400}, {23, 10, 0}, .0, ZONE_LAP, ZONE_LAP, 0},
	{{.330, .365, .425}, {24, 10, 0}, .0, ZONE_LAP, ZONE_LAP, 0},
	{{.350, .395, .450}, {30, 10, 0}, -.01, ZONE_LAP, ZONE_LAP, 0},
	{{.390, .425, .475}, {15, 10, 0}, -.02, ZONE_LAP, ZONE_CHEST, .5},
	/* belly and chest */
	{{.450, .460, .500}, {5, 5, 0}, -.02, ZONE_CHEST, ZONE_CHEST, 0},
	{{.500, .505, .535}, {0, 0, 0}, -.02, ZONE_CHEST, ZONE_CHEST, 0},
	{{.545, .550, .575}, {0, 0, 0}, -.02, ZONE_CHEST, ZONE_CHEST, 0},
	{{.590, .590, .610}, {0, 5, 0}, -.02, ZONE_CHEST, ZONE_COLLAR, .4},
	{{.628, .610, .635}, {0, 15, 5}, -.025, ZONE_CHEST, ZONE_COLLAR, .7},
	{{.655, .630, .655}, {5, 28, 15}, -.03, ZONE_COLLAR, ZONE_COLLAR, 0},
	{{.680, .660, .680}, {5, 30, 20}, -.03, ZONE_COLLAR, ZONE_FACE, .3},
	/* neck and head */
	{{.708, .715, .722}, {0, 0, 0}, -.02, ZONE_FACE, ZONE_FACE, 0},
	{{.765, .755, .745}, {-38, -20, 0}, -.01, ZONE_FACE, ZONE_FACE, 0},
	{{.765, .765, .765}, {-20, -10, 0}, -.01, ZONE_FACE, ZONE_FACE, 0},
	{{.762, .775, .780}, {-3, 0, 0}, -.01, ZONE_FACE, ZONE_FACE, 0},
	{{.774, .785, .795}, {0, 0, 0}, -.01, ZONE_FACE, ZONE_FACE, 0},
	{{.788, .800, .810}, {0, 0, 0}, -.01, ZONE_FACE, ZONE_FACE, 0},
	{{.804, .812, .825}, {0, 0, 0}, -.01, ZONE_FACE, ZONE_FACE, 0},
	{{.822, .828, .840}, {0, 0, 0}, -.01, ZONE_FACE, ZONE_FACE, 0},
	{{.840, .845, .855}, {0, 0, 0}, -.01, ZONE_FACE, ZONE_FACE, 0},
	{{.850, .855, .860}, {14, 10, 8}, -.01, ZONE_FACE, ZONE_CROWN, .3},
	{{.855, .860, .860}, {38, 32, 30}, -.02, ZONE_CROWN, ZONE_CROWN, 0},
	{{.860, .860, .860}, {60, 56, 54}, -.028, ZONE_CROWN, ZONE_CROWN, 0},
};

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

/* ---- The lotus ------------------------------------------------------------------------------------------------ */

/* One ring of the pedestal: height and radius, and what a petal's middle adds to both (a notch takes it away).
 * Petals are two columns wide. */
typedef struct lotus_ring {
	double y, radius, petal_y, petal_radius;
} lotus_ring;

static const lotus_ring lotus[LOTUS_RINGS] = {
	{.000, .345, .000, -.012}, /* the foot, flat on the floor */
	{.022, .372, .000, -.016}, /* lower tier: tips point down, between those of the upper tier */
	{.060, .352, .000, -.014},
	{.090, .305, .000, -.004}, /* waist */
	{.108, .300, .000, .004},
	{.132, .345, .000, .012},
	{.168, .378, .003, .016}, /* upper tier: tips point up */
	{.199, .388, .008, .016},
	{.200, .352, .000, .000}, /* the seat */
};
static const double LOTUS_DEPTH = 0.86;   /* z radius over x radius */
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

/* ---- The square grids at both ends ------------------------------------------------------------------------------ */

/* Vertex at (i, j), 0..CAP each, of the cap whose rim is `ring`; i grows to +x, j to +z. The rim starts with column 0
 * in the middle of the +z side. */
static int cap_vertex(int ring, int inner_first, int i, int j)
{
	int column;

	if (i > 0 && i < CAP && j > 0 && j < CAP)
		return inner_first + (j - 1) * (CAP - 1) + (i - 1);
	if (j == CAP)
		column = i - CAP / 2;
	else if (i == CAP)
		column = CAP / 2 + (CAP - j);
	else if (j == 0)
		column = CAP / 2 + CAP + (CAP - i);
	else
		column = CAP / 2 + 2 * CAP + j;
	return ring * COLUMNS + (column + COLUMNS) % COLUMNS;
}

/* Maps the square grid to the unit disc. */
static void cap_to_disc(int i, int j, double *x, double *z)
{
	double u = (2.0 * i - CAP) / CAP, v = (2.0 * j - CAP) / CAP;

	*x = u * sqrt(1.0 - 0.5 * v * v);
	*z = v * sqrt(1.0 - 0.5 * u * u);
}

static vec3 bottom_target(int i, int j)
{
	double x, z;

	cap_to_disc(i, j, &x, &z);
	return v3(x * lotus[0].radius, 0.0, z * lotus[0].radius * LOTUS_DEPTH + LOTUS_CENTRE_Z);
}

/* The cap continues the last ring of rays up to the zenith. */
static vec3 top_target(int i, int j)
{
	const ring_aim *rim = &aims[BODY_RINGS - 1];
	double x, z, angle, opening, pitch;
	vec3 target;

	cap_to_disc(i, j, &x, &z);
	angle = atan2(fabs(x), z);
	opening = sqrt(x * x + z * z) * (90.0 - around(rim->pitch, angle));
	pitch = DEGREE * (90.0 - opening);
	target = last_exit(head, v3(0.0, around(rim->y, angle), rim->z), direction_of(angle, pitch));
	target.x = i == CAP / 2 ? 0.0 : x < 0.0 ? -target.x : target.x;
	return target;
}

/* ---- Targets and faces -------------------------------------------------------------------------------------------- */

/* Only the half x >= 0 is computed and then mirrored, so that symmetry is exact to the bit. */
static void place_targets(vec3 targets[VERTICES])
{
	int ring, column, i, j;

	for (ring = 0; ring < RINGS; ring++) {
		for (column = 0; column <= HALF; column++) {
			vec3 t = ring < LOTUS_RINGS ? lotus_target(ring, column) : body_target(ring - LOTUS_RINGS, column);

			targets[ring * COLUMNS + column] = t;
			targets[ring * COLUMNS + (COLUMNS - column) % COLUMNS] = v3(-t.x, t.y, t.z);
		}
	}
	for (j = 1; j < CAP; j++) {
		for (i = 1; i < CAP; i++) {
			targets[cap_vertex(0, BOTTOM_FIRST, i, j)] = bottom_target(i, j);
			targets[cap_vertex(RINGS - 1, TOP_FIRST, i, j)] = top_target(i, j);
		}
	}
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
	for (j = 0; j < CAP; j++) {
		for (i = 0; i < CAP; i++) {
			put_quad(&at, cap_vertex(0, BOTTOM_FIRST, i, j), cap_vertex(0, BOTTOM_FIRST, i + 1, j),
				 cap_vertex(0, BOTTOM_FIRST, i + 1, j + 1), cap_vertex(0, BOTTOM_FIRST, i, j + 1));
			put_quad(&at, cap_vertex(RINGS - 1, TOP_FIRST, i, j), cap_vertex(RINGS - 1, TOP_FIRST, i, j + 1),
				 cap_vertex(RINGS - 1, TOP_FIRST, i + 1, j + 1), cap_vertex(RINGS - 1, TOP_FIRST, i + 1, j));
		}
	}
}

/* ---- Fitting the limit surface -------------------------------------------------------------------------------------- */

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

/* Pushes the cage until the limit surface meets the targets. The foot ring and the bottom keep y = 0: then the limit
 * surface cannot sink below the floor. */
static void fit(const vec3 targets[VERTICES], const uint32_t indices[4 * FACES], vec3 cage[VERTICES])
{
	vec3 limit[VERTICES];
	int round, v;

	memcpy(cage, targets, VERTICES * sizeof *cage);
	for (round = 0; round < FIT_ROUNDS; round++) {
		limit_points(cage, indices, limit);
		for (v = 0; v < VERTICES; v++) {
			bool on_floor = v < COLUMNS || (v >= BOTTOM_FIRST && v < TOP_FIRST);
			vec3 push = sub(targets[v], limit[v]);

			if (on_floor)
				push.y = 0.0;
			cage[v] = add(cage[v], push);
		}
	}
}

/* Sums run in another order on either side, so the last bits may differ: copy the half x >= 0 over. Also sets the
 * height of the limit surface to exactly one. */
static void finish(const uint32_t indices[4 * FACES], vec3 cage[VERTICES])
{
	vec3 limit[VERTICES];
	double top;
	int v, ring, column, i, j, cap;

	limit_points(cage, indices, limit);
	top = limit[TOP_FIRST + CAP_INNER / 2].y;
	for (v = 0; v < VERTICES; v++)
		cage[v] = scale(cage[v], 1.0 / top);
	for (ring = 0; ring < RINGS; ring++) {
		vec3 *row = &cage[ring * COLUMNS];

		row[0].x = row[HALF].x = 0.0;
		for (column = 1; column < HALF; column++)
			row[COLUMNS - column] = v3(-row[column].x, row[column].y, row[column].z);
	}
	for (cap = BOTTOM_FIRST; cap <= TOP_FIRST; cap += CAP_INNER) {
		for (j = 0; j < CAP - 1; j++) {
			vec3 *row = &cage[cap + j * (CAP - 1)];

			row[CAP / 2 - 1].x = 0.0;
			for (i = 0; i < CAP / 2 - 1; i++)
				row[i] = v3(-row[CAP - 2 - i].x, row[CAP - 2 - i].y, row[CAP - 2 - i].z);
		}
	}
}

/* ---- The mesh --------------------------------------------------------------------------------------------------------- */

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
