#include "view.h"

#include <math.h>

gi_view gi_view_default(void)
{
	return (gi_view){
	    .view_from_world = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
	    .clip_from_view = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
	    .width = 512,
	    .height = 512,
	};
}

static bool all_finite(const float *values, size_t count)
{
	bool finite = true;
	for (size_t k = 0; k < count; k++)
		finite = finite && isfinite(values[k]);
	return finite;
}

bool view_is_finite(const gi_view *view)
{
	return all_finite(view->view_from_world, 16) && all_finite(view->clip_from_view, 16);
}

void view_clip_from_world(const gi_view *view, float out[16])
{
	for (int column = 0; column < 4; column++)
		for (int row = 0; row < 4; row++) {
			double sum = 0;
			for (int k = 0; k < 4; k++)
				sum +=
				    (double)view->clip_from_view[4 * k + row] * view->view_from_world[4 * column + k];
			out[4 * column + row] = (float)sum;
		}
}

void view_window_from_world(const gi_view *view, float out[16])
{
	view_clip_from_world(view, out);
	for (int k = 1; view->clip_upper_left && k < 16; k += 4)
		out[k] = -out[k];
}

void view_eye(const gi_view *view, float eye[4])
{
	const float *m = view->view_from_world;
	const bool parallel = view->clip_from_view[15] != 0.0f;
	const float scale = m[0] * m[0] + m[1] * m[1] + m[2] * m[2];
	for (int k = 0; k < 3; k++) {
		const float *column = m + 4 * k;
		eye[k] = parallel ? column[2] : -(column[0] * m[12] + column[1] * m[13] + column[2] * m[14]) / scale;
	}
	eye[3] = parallel ? 0.0f : 1.0f;
}

gpu_convention view_convention(const gi_view *view)
{
	return (gpu_convention){view->clip_upper_left, view->clip_zero_to_one, view->depth_reversed};
}

float view_farthest(const gi_view *view)
{
	return view->depth_reversed ? 0 : 1;
}
