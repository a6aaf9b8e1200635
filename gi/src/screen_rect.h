/* Where in the picture something is seen, pixels. */
#ifndef GI_SCREEN_RECT_H
#define GI_SCREEN_RECT_H

#include "vec3d.h"

#include <stdint.h>

typedef struct screen_rect {
	int lower[2], upper[2]; /* from the viewport's corner; upper is beyond. Empty: upper <= lower */
} screen_rect;

screen_rect screen_rect_empty(void);

/* Grows by the pixels that may show a ball. clip_from_world column-major. */
void screen_rect_add(screen_rect *rect, const float clip_from_world[16], const uint32_t size[2], gi_vec3d centre,
		     double radius);

#endif
