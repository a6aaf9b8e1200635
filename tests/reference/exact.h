/* Closed forms of form factors: F is the fraction of what leaves surface 1 that arrives at surface 2 directly.
 *
 * C-numbers are those of Howell's catalogue of radiation configuration factors. Lengths in any one unit; double, good
 * to about 1e-12 unless a comment says otherwise.
 */
#ifndef TESTS_REFERENCE_EXACT_H
#define TESTS_REFERENCE_EXACT_H

#include <stdint.h>

/* C-11: identical directly opposed rectangles a x b, c > 0 apart. */
double exact_parallel_rectangles(double a, double b, double c);

/* C-14: rectangles at a right angle that share an edge of length l; 1 is w x l, 2 is h x l. F from 1 to 2. */
double exact_perpendicular_rectangles(double h, double w, double l);

/* C-41: parallel coaxial discs, h > 0 apart; from radius r1 to radius r2. */
double exact_coaxial_discs(double r1, double r2, double h);

/* Element to a parallel rectangle a x b at distance c > 0, one corner of which lies on the element's normal. */
double exact_element_rectangle(double a, double b, double c);

/* Element to a sphere of radius r whose centre is h > r away, at cosine to the element's normal; the part of the sphere
 * below the element's horizon does not count. */
double exact_element_sphere(double r, double h, double cosine);

/* Sphere of radius r1 to sphere of radius r2, centres d >= r1 + r2 apart: one Gauss-Legendre integral, about 1e-9. */
double exact_sphere_sphere(double r1, double r2, double d);

/* Element (point, unit normal) to a planar polygon of `count` corners (3 to EXACT_MAX_CORNERS, 3 doubles each), clipped
 * to the element's horizon. Positive when the corners run counter-clockwise seen from the point (the element sees the
 * polygon's front), negative when it sees the back. The point must not lie on the polygon's edge. */
#define EXACT_MAX_CORNERS 32
double exact_element_polygon(const double point[3], const double normal[3], const double *corners, uint32_t count);

/* Opposed rectangles [0,a] x [0,b] at z = 0 and z = c, with an opaque rectangle [x0,x1] x [y0,y1] at z = height in
 * between (0 < height < c). */
typedef struct exact_occluder {
	double x0, x1, y0, y1, height;
} exact_occluder;
double exact_parallel_rectangles_occluded(double a, double b, double c, const exact_occluder *occluder);

/* Nodes and weights of Gauss-Legendre quadrature on [-1,1], 1 <= count. */
void exact_gauss_legendre(uint32_t count, double *nodes, double *weights);

#endif
