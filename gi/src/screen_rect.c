#include "screen_rect.h"

#include <limits.h>

screen_rect screen_rect_empty(void)
{
	return (screen_rect){{INT_MAX, INT_MAX}, {0, 0}};
}

static void grow(screen_rect *rect, const uint32_t size[2], const double lower[2], const double upper[2])
{
	for (int axis = 0; axis < 2; axis++) {
		const double half = 0.5 * size[axis];
		const int from = (int)floor(half * (fmax(lower[axis], -1) + 1)),
			  to = (int)ceil(half * (fmin(upper[axis], 1) + 1));
		rect->lower[axis] = from < rect->lower[axis] ? from : rect->lower[axis];
		rect->upper[axis] = to > rect->upper[axis] ? to : rect->upper[axis];
	}
}

/* Projects the corners of the cube around the ball. Where one is at or behind the eye the ball may be anywhere. */
void screen_rect_add(screen_rect *rect, const float m[16], const uint32_t size[2], gi_vec3d c, double radius)
{
	double lower[2] = {INFINITY, INFINITY}, upper[2] = {-INFINITY, -INFINITY};
	int behind = 0;
	for (int k = 0; k < 8; k++) {
		const double x = c.x + (k & 1 ? radius : -radius), y = c.y + (k & 2 ? radius : -radius),
			     z = c.z + (k & 4 ? radius : -radius), w = m[3] * x + m[7] * y + m[11] * z + m[15];
		behind += !(w > 0);
		for (int axis = 0; axis < 2; axis++) {
			const double at = (m[axis] * x + m[4 + axis] * y + m[8 + axis] * z + m[12 + axis]) / w;
			lower[axis] = fmin(lower[axis], at);
			upper[axis] = fmax(upper[axis], at);
		}
	}
	if (behind == 8)
		return;
	for (int axis = 0; axis < 2; axis++) {
		lower[axis] = behind ? -1 : lower[axis];
		upper[axis] = behind ? 1 : upper[axis];
		if (lower[axis] >= 1 || upper[axis] <= -1)
			return;
	}
	grow(rect, size, lower, upper);
}
