/* What a half space of a scattering medium gives back of light that falls on one point of it: the dipole of
 *
 *     H. W. Jensen, S. R. Marschner, M. Levoy and P. Hanrahan, A Practical Model for Subsurface Light Transport, 2001
 *
 * One source of light below the surface, at the depth of a mean free path, and a negative one above, so that the
 * fluence is 0 where the boundary's inner reflection says. In double precision, one colour at a time.
 */
#ifndef GI_DIPOLE_H
#define GI_DIPOLE_H

typedef struct gi_dipole {
	double share;     /* alpha': of an extinction, how much is scattered */
	double transport; /* sigma_tr, effective transport coefficient, 1/m */
	double depth[2];  /* z_r of the source, z_v of the negative one, metres; both > 0 */
} gi_dipole;

/* Reduced scattering and absorption, 1/m, both >= 0; index of refraction, 1..2.5. */
gi_dipole gi_dipole_of(double scattering, double absorption, double index);

/* R_d, 1/m2: radiant exitance at a squared distance, m2, from where a flux of 1 W enters. */
double gi_dipole_exitance(const gi_dipole *dipole, double squared);

/* Integral from that distance on of R_d r dr; of two pi times it is how much leaves farther out. With a height h over
 * the plane of integration, squared = r2 + h2, likewise. */
double gi_dipole_beyond(const gi_dipole *dipole, double squared);

/* All that leaves, of 1: the diffuse reflectance of the half space, in [0,1]. */
double gi_dipole_albedo(const gi_dipole *dipole);

/* How fast R_d changes at most, there and farther out: |dR_d/dr| / R_d, 1/m. */
double gi_dipole_steepness(const gi_dipole *dipole, double distance);

#endif
