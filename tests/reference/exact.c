/* Sources: J. R. Howell, A Catalog of Radiation Heat Transfer Configuration Factors (C-11, C-14, C-41, B-4); Lambert's
 * contour formula for polygons. The element-to-sphere formula with a cut horizon is the catalogue's B-43 (Naraghi). */
#include "exact.h"

#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

static double clamp(double x, double lo, double hi)
{
	return x < lo ? lo : x > hi ? hi : x;
}

double exact_parallel_rectangles(double a, double b, double c)
{
	double x = a / c, y = b / c, x2 = 1 + x * x, y2 = 1 + y * y;
	double sum = 0.5 * log(x2 * y2 / (x2 + y * y));
	sum += x * sqrt(y2) * atan(x / sqrt(y2)) + y * sqrt(x2) * atan(y / sqrt(x2));
	sum -= x * atan(x) + y * atan(y);
	return 2 / (PI * x * y) * sum;
}

double exact_perpendicular_rectangles(double h, double w, double l)
{
	double H = h / l, W = w / l, H2 = H * H, W2 = W * W, sum2 = H2 + W2;
	double sum = W * atan(1 / W) + H * atan(1 / H) - sqrt(sum2) * atan(1 / sqrt(sum2));
	double logs = log((1 + W2) * (1 + H2) / (1 + sum2));
	logs += W2 * log(W2 * (1 + sum2) / ((1 + W2) * sum2));
	logs += H2 * log(H2 * (1 + sum2) / ((1 + H2) * sum2));
	return (sum + 0.25 * logs) / (PI * W);
}

double exact_coaxial_discs(double r1, double r2, double h)
{
	double R1 = r1 / h, R2 = r2 / h, x = 1 + (1 + R2 * R2) / (R1 * R1);
	/* x/2 - sqrt(x^2/4 - q) loses digits for small discs; q / (x/2 + sqrt) does not */
	double q = (R2 / R1) * (R2 / R1);
	return q / (0.5 * x + sqrt(0.25 * x * x - q));
}

double exact_element_rectangle(double a, double b, double c)
{
	double A = a / c, B = b / c, sa = sqrt(1 + A * A), sb = sqrt(1 + B * B);
	return (A / sa * atan(B / sa) + B / sb * atan(A / sb)) / (2 * PI);
}

double exact_element_sphere(double r, double h, double cosine)
{
	double s = r / h;
	if (cosine >= s)
		return s * s * cosine;
	if (cosine <= -s)
		return 0;
	/* the horizon cuts the sphere: |cosine| < s = sin(half angle of the sphere's cone) */
	double H2 = 1 / (s * s), root = sqrt(H2 - 1), sine = sqrt(1 - cosine * cosine);
	double cut = sqrt(fmax(0, 1 - H2 * cosine * cosine));
	double arc = acos(clamp(-root * cosine / sine, -1, 1));
	return (cosine * arc - root * cut) * s * s / PI + atan(cut / root) / PI;
}

void exact_gauss_legendre(uint32_t count, double *nodes, double *weights)
{
	for (uint32_t i = 0; i < count; i++) {
		double x = cos(PI * (i + 0.75) / (count + 0.5)), slope = 1;
		for (int newton = 0; newton < 100; newton++) {
			double p0 = 1, p1 = x;
			for (uint32_t k = 2; k <= count; k++) {
				double p2 = ((2.0 * k - 1) * x * p1 - (k - 1.0) * p0) / k;
				p0 = p1;
				p1 = p2;
			}
			slope = count * (x * p1 - p0) / (x * x - 1);
			double step = p1 / slope;
			x -= step;
			if (fabs(step) < 1e-16)
				break;
		}
		nodes[i] = x;
		weights[i] = 2 / ((1 - x * x) * slope * slope);
	}
}

#define GAUSS_COUNT 64

/* Mean over sphere 1 of the element's factor: area is uniform in c = cos of the angle from the line of centres. The
 * integrand has kinks where sphere 2 starts to set and has set, so the interval is cut there. */
double exact_sphere_sphere(double r1, double r2, double d)
{
	double nodes[GAUSS_COUNT], weights[GAUSS_COUNT], sum = 0;
	const double cuts[4] = {1, (r1 + r2) / d, (r1 - r2) / d, -1};
	exact_gauss_legendre(GAUSS_COUNT, nodes, weights);
	for (int piece = 0; piece < 3; piece++) {
		double half = 0.5 * (cuts[piece] - cuts[piece + 1]), middle = 0.5 * (cuts[piece] + cuts[piece + 1]);
		for (int i = 0; i < GAUSS_COUNT; i++) {
			double c = middle + half * nodes[i];
			double h = sqrt(r1 * r1 + d * d - 2 * r1 * d * c);
			sum += half * weights[i] * exact_element_sphere(r2, h, (d * c - r1) / h);
		}
	}
	return 0.5 * sum;
}

/* Sutherland-Hodgman against the plane through the point; p: corners relative to the point. */
static uint32_t clip_to_horizon(const double normal[3], const double *p, uint32_t count, double *out)
{
	uint32_t kept = 0;
	for (uint32_t i = 0; i < count; i++) {
		const double *a = p + 3 * i, *b = p + 3 * ((i + 1) % count);
		double ha = a[0] * normal[0] + a[1] * normal[1] + a[2] * normal[2];
		double hb = b[0] * normal[0] + b[1] * normal[1] + b[2] * normal[2];
		if (ha >= 0)
			memcpy(out + 3 * kept++, a, 3 * sizeof *a);
		if ((ha > 0 && hb < 0) || (ha < 0 && hb > 0)) {
			for (int k = 0; k < 3; k++)
				out[3 * kept + k] = a[k] + (b[k] - a[k]) * (ha / (ha - hb));
			kept++;
		}
	}
	return kept;
}

/* F = 1/(2 pi) sum over edges of angle(a,b) n . (a x b)/|a x b|; counter-clockwise seen from the point is a x b
 * pointing back at it, hence the sign. */
double exact_element_polygon(const double point[3], const double normal[3], const double *corners, uint32_t count)
{
	double p[3 * EXACT_MAX_CORNERS], q[6 * EXACT_MAX_CORNERS], sum = 0;
	for (uint32_t i = 0; i < 3 * count; i++)
		p[i] = corners[i] - point[i % 3];
	uint32_t kept = clip_to_horizon(normal, p, count, q);
	for (uint32_t i = 0; kept >= 3 && i < kept; i++) {
		const double *a = q + 3 * i, *b = q + 3 * ((i + 1) % kept);
		double c[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
		double length = sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
		double angle = atan2(length, a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
		if (length > 0)
			sum -= angle * (c[0] * normal[0] + c[1] * normal[1] + c[2] * normal[2]) / length;
	}
	return sum / (2 * PI);
}

/* Element at the origin facing +z to [x0,x1] x [y0,y1] at height c: four corner rectangles with signs. */
static double element_to_box(double x0, double x1, double y0, double y1, double c)
{
	if (!(x1 > x0 && y1 > y0))
		return 0;
	return exact_element_rectangle(x1, y1, c) - exact_element_rectangle(x0, y1, c) -
	       exact_element_rectangle(x1, y0, c) + exact_element_rectangle(x0, y0, c);
}

/* Along one axis the occluder's shadow of x on the far plane is [x + (o0 - x) s, x + (o1 - x) s], s = c / height, cut
 * to [0, size]. The integrand is smooth between the x where a shadow edge meets 0 or size. */
typedef struct shadow_axis {
	double size, o0, o1, s;
	double cuts[6];
} shadow_axis;

static void shadow_cuts(shadow_axis *axis)
{
	const double edges[4] = {axis->o0, axis->o0, axis->o1, axis->o1}, ends[4] = {0, axis->size, 0, axis->size};
	axis->cuts[0] = 0;
	axis->cuts[5] = axis->size;
	for (int i = 0; i < 4; i++)
		axis->cuts[i + 1] = clamp((ends[i] - edges[i] * axis->s) / (1 - axis->s), 0, axis->size);
	for (int i = 1; i < 5; i++)
		for (int j = i; j > 1 && axis->cuts[j] < axis->cuts[j - 1]; j--) {
			double swap = axis->cuts[j];
			axis->cuts[j] = axis->cuts[j - 1];
			axis->cuts[j - 1] = swap;
		}
}

/* Shadow of x relative to x itself. */
static void shadow_of(const shadow_axis *axis, double x, double *lo, double *hi)
{
	*lo = clamp(x + (axis->o0 - x) * axis->s, 0, axis->size) - x;
	*hi = clamp(x + (axis->o1 - x) * axis->s, 0, axis->size) - x;
}

static uint32_t panel_nodes(const shadow_axis *axis, double *x, double *w)
{
	double nodes[GAUSS_COUNT], weights[GAUSS_COUNT];
	uint32_t count = 0;
	exact_gauss_legendre(GAUSS_COUNT, nodes, weights);
	for (int piece = 0; piece < 5; piece++) {
		double half = 0.5 * (axis->cuts[piece + 1] - axis->cuts[piece]);
		for (int i = 0; half > 0 && i < GAUSS_COUNT; i++) {
			x[count] = axis->cuts[piece] + half * (1 + nodes[i]);
			w[count++] = half * weights[i];
		}
	}
	return count;
}

double exact_parallel_rectangles_occluded(double a, double b, double c, const exact_occluder *o)
{
	shadow_axis ax = {.size = a, .o0 = o->x0, .o1 = o->x1, .s = c / o->height};
	shadow_axis ay = {.size = b, .o0 = o->y0, .o1 = o->y1, .s = c / o->height};
	double x[5 * GAUSS_COUNT], wx[5 * GAUSS_COUNT], y[5 * GAUSS_COUNT], wy[5 * GAUSS_COUNT], blocked = 0;
	shadow_cuts(&ax);
	shadow_cuts(&ay);
	uint32_t nx = panel_nodes(&ax, x, wx), ny = panel_nodes(&ay, y, wy);
	for (uint32_t i = 0; i < nx; i++) {
		double x0, x1, y0, y1;
		shadow_of(&ax, x[i], &x0, &x1);
		for (uint32_t j = 0; j < ny; j++) {
			shadow_of(&ay, y[j], &y0, &y1);
			blocked += wx[i] * wy[j] * element_to_box(x0, x1, y0, y1, c);
		}
	}
	return exact_parallel_rectangles(a, b, c) - blocked / (a * b);
}
