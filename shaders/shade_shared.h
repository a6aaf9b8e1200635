/* What the shaders of the picture share with gi/src/lamp.c and shadow.c; read by both compilers.
 *
 * A lamp is a polygon that gives direct light per pixel. Its shadows come from a few samples on it, each with a depth
 * map: one layer of an array texture. All samples of a lamp share one frame and one window:
 *
 *     q = frame * (p - origin)         q.z along the lamp's normal, the same for every sample s of the lamp's plane
 *     d = q.xy - s.xy                  e = q.z + bend * max(|d.x|, |d.y|)
 *     uv = d * scale / e + shift       depth = depth.x + depth.y / e
 *
 * bend 0 is a plain perspective, for casters in a cone about the normal. With bend 1 the square |d.x|, |d.y| <= e is
 * the whole hemisphere. Where one of the four directions +x, -x, +y, -y is the largest, e is linear and straight lines
 * stay straight: each such sector is drawn by a matrix of its own.
 */
#ifndef GI_SHADE_SHARED_H
#define GI_SHADE_SHARED_H

#include "gi_shared.h"

#define GI_LAMP_MAX 32u        /* lamps drawn per pixel; what emits beyond them goes through the leaves */
#define GI_LAMP_SAMPLE_MAX 32u /* depth maps of all lamps together */
#define GI_LAMP_FEW_SAMPLES 16u /* of one lamp, and of each of two */
#define GI_LAMP_PROBES 8u      /* samples that have to disagree before the others are asked */

#define GI_BIND_LAMPS 1 /* uniform block */

/* One lamp, world space.
 *
 *   //--------------- 16B ---------------
 *   corner[k].xyz   counter-clockwise from its front; a triangle repeats its third
 *   exitance.xyz    E; a curved emitter's is scaled to the power of the surface the polygon stands for
 *   exitance.w      maps with bend 1 show what lies higher than that over the lamp's plane
 *   frame_x .. z    rows of the frame; w: minus the row times the origin
 *   map.x scale     map.y bend      map.zw shift
 *   depth.x, depth.y as above; depth.z edge of a texel at e = 1; depth.w how far a sample looks aside, metres
 *   range.x first sample    range.y samples; 0: casts no shadows
 */
GI_STRUCT(gi_lamp) {
	GI_VEC4 corner[4];
	GI_VEC4 exitance;
	GI_VEC4 frame_x;
	GI_VEC4 frame_y;
	GI_VEC4 frame_z;
	GI_VEC4 map;
	GI_VEC4 depth;
	GI_UVEC4 range;
} GI_END(gi_lamp)

/* counts.x lamps; samples.xy in the lamp's frame, samples.zw where its second look lies. */
GI_STRUCT(gi_lamp_block) {
	GI_UVEC4 counts;
	GI_VEC4 samples[GI_LAMP_SAMPLE_MAX];
	gi_lamp lamps[GI_LAMP_MAX];
} GI_END(gi_lamp_block)

#endif
