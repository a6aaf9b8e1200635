#include "import_bounds.h"

#include <math.h>
#include <string.h>

import_bounds import_bounds_of_nothing(void)
{
	return (import_bounds){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

void import_bounds_widen(import_bounds *b, const double point[3])
{
	for (int c = 0; c < 3; c++) {
		b->lower[c] = fmin(b->lower[c], point[c]);
		b->upper[c] = fmax(b->upper[c], point[c]);
	}
}

import_bounds import_bounds_of_mesh(const engine_mesh *mesh)
{
	import_bounds b = import_bounds_of_nothing();
	for (size_t v = 0; v < mesh->vertex_count; v++) {
		const float *p = mesh->positions + 3 * v;
		import_bounds_widen(&b, (const double[3]){p[0], p[1], p[2]});
	}
	return b;
}

bool import_bounds_far_middle(const import_bounds *b, double middle[3])
{
	double extent = 0, farthest = 0;
	for (int c = 0; c < 3; c++) {
		middle[c] = round(0.5 * (b->lower[c] + b->upper[c]));
		extent = fmax(extent, b->upper[c] - b->lower[c]);
		farthest = fmax(farthest, fabs(middle[c]));
	}
	if (farthest < HUGE_VAL && (farthest > 4096 * extent || (farthest > 64 * extent && farthest >= 1000)))
		return true;
	memset(middle, 0, 3 * sizeof *middle);
	return false;
}
