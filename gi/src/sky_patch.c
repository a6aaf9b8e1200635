#include "sky_patch.h"

static const double PI = 3.14159265358979323846;

gi_vec3d sky_direction(int face, double i, double j)
{
	const double u = tan(PI / 4 * (2.0 * i / SKY_GRID - 1)), v = tan(PI / 4 * (2.0 * j / SKY_GRID - 1));
	const gi_vec3d faces[SKY_FACES] = {{1, v, u}, {-1, u, v}, {u, 1, v}, {v, -1, u}, {v, u, 1}, {u, v, -1}};
	const gi_vec3d d = faces[face];
	const double s = 1 / sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
	return (gi_vec3d){d.x * s, d.y * s, d.z * s};
}

static double place_in_grid(double tangent)
{
	return SKY_GRID * 0.5 * (atan(tangent) * 4 / PI + 1);
}

void sky_place_of(gi_vec3d d, int *face, double *i, double *j)
{
	const double x = fabs(d.x), y = fabs(d.y), z = fabs(d.z);
	double u, v, largest;
	if (x >= y && x >= z) {
		*face = d.x > 0 ? 0 : 1;
		largest = x;
		u = d.x > 0 ? d.z : d.y;
		v = d.x > 0 ? d.y : d.z;
	} else if (y >= z) {
		*face = d.y > 0 ? 2 : 3;
		largest = y;
		u = d.y > 0 ? d.x : d.z;
		v = d.y > 0 ? d.z : d.x;
	} else {
		*face = d.z > 0 ? 4 : 5;
		largest = z;
		u = d.z > 0 ? d.y : d.x;
		v = d.z > 0 ? d.x : d.y;
	}
	*i = place_in_grid(u / largest);
	*j = place_in_grid(v / largest);
}

void sky_patch_corners(sky_patch p, gi_vec3d corners[4])
{
	corners[0] = sky_direction(p.face, p.i, p.j);
	corners[1] = sky_direction(p.face, p.i + p.size, p.j);
	corners[2] = sky_direction(p.face, p.i + p.size, p.j + p.size);
	corners[3] = sky_direction(p.face, p.i, p.j + p.size);
}

/* Of the triangle a b c of unit vectors (van Oosterom and Strackee, 1983). */
static double triangle_angle(gi_vec3d a, gi_vec3d b, gi_vec3d c)
{
	const double triple =
	    a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
	const double ab = a.x * b.x + a.y * b.y + a.z * b.z, bc = b.x * c.x + b.y * c.y + b.z * c.z,
		     ca = c.x * a.x + c.y * a.y + c.z * a.z;
	return fabs(2 * atan2(triple, 1 + ab + bc + ca));
}

double sky_patch_angle(sky_patch p)
{
	gi_vec3d c[4];
	sky_patch_corners(p, c);
	return triangle_angle(c[0], c[1], c[2]) + triangle_angle(c[0], c[2], c[3]);
}
