#include "dipole.h"

#include <math.h>

static const double PI = 3.14159265358979323846;

/* A medium that neither scatters nor absorbs has its source nowhere; so far away it counts as that. */
static const double FARTHEST = 1e30;

/* A of the boundary condition: the ratio that inner reflection makes, by the mean Fresnel reflectance that Jensen and
 * others give (Egan and Hilgeman 1979). At an index of 1 that fit is a hair above 0. */
static double boundary(double index)
{
	const double reflected = -1.440 / (index * index) + 0.710 / index + 0.668 + 0.0636 * index;
	return (1 + reflected) / (1 - reflected);
}

gi_dipole gi_dipole_of(double scattering, double absorption, double index)
{
	const double extinction = scattering + absorption;
	gi_dipole d = {.share = extinction > 0 ? scattering / extinction : 0,
		       .transport = sqrt(3 * absorption * extinction),
		       .depth = {extinction * FARTHEST > 1 ? 1 / extinction : FARTHEST}};
	d.depth[1] = d.depth[0] * (1 + 4.0 / 3.0 * boundary(index));
	return d;
}

double gi_dipole_exitance(const gi_dipole *d, double squared)
{
	double sum = 0;
	for (int k = 0; k < 2; k++) {
		const double z = d->depth[k], r = sqrt(squared + z * z);
		sum += z / (r * r) * (d->transport + 1 / r) * exp(-d->transport * r);
	}
	return d->share / (4 * PI) * sum;
}

/* z (t + 1/r) exp(-t r) / r2 times r dr is the differential of -z exp(-t r) / r. */
double gi_dipole_beyond(const gi_dipole *d, double squared)
{
	double sum = 0;
	for (int k = 0; k < 2; k++) {
		const double z = d->depth[k], r = sqrt(squared + z * z);
		sum += z / r * exp(-d->transport * r);
	}
	return d->share / (4 * PI) * sum;
}

double gi_dipole_albedo(const gi_dipole *d)
{
	return 2 * PI * gi_dipole_beyond(d, 0);
}

double gi_dipole_steepness(const gi_dipole *d, double distance)
{
	return d->transport + 3 / hypot(distance, d->depth[0]);
}
