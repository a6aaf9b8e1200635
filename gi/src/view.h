/* What a gi_view means. */
#ifndef GI_VIEW_H
#define GI_VIEW_H

#include "gi/gi.h"
#include "gpu_draw.h"

bool view_is_finite(const gi_view *view);

/* Column-major. */
void view_clip_from_world(const gi_view *view, float out[16]);

/* The same, y as pixels are counted. */
void view_window_from_world(const gi_view *view, float out[16]);

/* Where the camera is, for a view that turns, moves and scales evenly; for a parallel projection the way to it, w 0. */
void view_eye(const gi_view *view, float out[4]);

gpu_convention view_convention(const gi_view *view);

/* Depth where nothing is drawn. */
float view_farthest(const gi_view *view);

#endif
