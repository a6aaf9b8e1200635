#include "file_probes.h"

#include <math.h>
#include <stdio.h>

/* Each is some 4,000 bytes of planes and a row of its own. */
static const double MOST_PROBES = 20000;

static double count_along(const file_scene *f, int axis, double spacing)
{
	return fmax(1, floor(((double)f->upper[axis] - (double)f->lower[axis]) / spacing));
}

static double count_all(const file_scene *f, double spacing)
{
	return count_along(f, 0, spacing) * count_along(f, 1, spacing) * count_along(f, 2, spacing);
}

/* The least of those tried that makes few enough. */
static double fitting_spacing(const file_scene *f, double spacing)
{
	while (count_all(f, spacing) > MOST_PROBES)
		spacing *= 1.1;
	return spacing;
}

bool file_probes_create(const file_scene *f, float spacing, gi_context *gi, char *message, size_t message_size)
{
	gi_probes_def def = gi_probes_def_default();
	gi_receivers probes;
	const double count = count_all(f, (double)spacing);
	if (count > MOST_PROBES) {
		snprintf(message, message_size, "--probes %g would be %.3g probes, of at most %.0f: use %.2g or more",
			 (double)spacing, count, MOST_PROBES, fitting_spacing(f, (double)spacing));
		return false;
	}
	def.spacing = spacing;
	for (int k = 0; k < 3; k++) {
		def.count[k] = (uint32_t)count_along(f, k, (double)spacing);
		def.lower[k] = 0.5f * (f->lower[k] + f->upper[k]) - 0.5f * spacing * (float)(def.count[k] - 1);
	}
	if (gi_create_probes(gi, &def, &probes) == GI_OK)
		return true;
	if (!message[0])
		snprintf(message, message_size, "--probes %g: they could not be made", (double)spacing);
	return false;
}
