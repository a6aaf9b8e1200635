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
#define GI_LAMP_WIDE_PROBES 4u /* of GI_LAMP_FEW_SAMPLES, near the lamp's corners: they decide where a penumbra ends */


/* Where a lamp may be hidden is known by a grid of 64 x 64 x 32 cells (gi/src/occluder_mask.h). */
#define GI_MASK_SIDE 64u
#define GI_MASK_HEIGHT 32u

/* Texture units of gi_draw beside those of the buffers: the four before them, and what follows. */
#define GI_UNIT_MAPS 0
#define GI_UNIT_MAP_VALUES 1
#define GI_UNIT_PLACE 2
#define GI_UNIT_LOOK 3
#define GI_UNIT_DEPTH (GI_TEXEL_UNIT + GI_BIND_COUNT)
#define GI_UNIT_SO_FAR (GI_UNIT_DEPTH + 1)
#define GI_UNIT_MASKS (GI_UNIT_DEPTH + 2)
/* Textures of the host, while surfaces are drawn; the reflectance of pixels, where a uniform block has its place. */
#define GI_UNIT_BASE_COLOR GI_UNIT_PLACE
#define GI_UNIT_EMISSIVE GI_UNIT_LOOK
#define GI_UNIT_ALBEDO (GI_TEXEL_UNIT + GI_BIND_FRAME)

/* Which of them a surface has. */
#define GI_HAS_BASE_COLOR 1u
#define GI_HAS_EMISSIVE 2u

/* One lamp, world space.
 *
 *   //--------------- 16B ---------------
 *   corner[k].xyz   counter-clockwise from its front; a triangle repeats its third
 *   exitance.xyz    E; a curved emitter's is scaled to the power of the surface the polygon stands for
 *   exitance.w      maps with bend 1 show what lies higher than that over the lamp's plane
 *   frame_x .. z    rows of the frame; w: minus the row times the origin
 *   map.x scale     map.y bend      map.zw shift
 *   depth.x, depth.y as above; depth.z edge of a texel at e = 1; depth.w how far a sample looks aside, metres
 *   range.x layer of the first sample's map    range.y samples; 0: casts no shadows
 *   range.w probes of four texels, the first ones
 *   range.z first word of its mask, two a row, low bits first
 *   grid_lower.xyz, grid_scale.xyz    cell of the mask = (q - lower) * scale
 *   samples[k].xy in the lamp's frame, samples[k].zw where its second look lies
 *   rest            uniform blocks begin at multiples of 256 bytes
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
	GI_VEC4 grid_lower;
	GI_VEC4 grid_scale;
	GI_VEC4 samples[GI_LAMP_SAMPLE_MAX];
	GI_VEC4 rest[3];
} GI_END(gi_lamp)

/* A light without a surface, as a picture is lit by it. Its depth maps see the world in a frame of its own: q = frame *
 * (p, 1).
 *
 * Of a point and a wide spot six maps, one for each direction along an axis; of a narrow spot the one along +z. Along
 * axis a, with e = |q[a]| and u, v the two axes behind a in turn
 *
 *     uv = 0.5 + map.x * (q[u], q[v]) / e       depth = depth.x + depth.y / e
 *
 * Of a sun GI_SUN_TILES x GI_SUN_TILES maps side by side, seen along +z
 *
 *     t = (q.xy - tiles.xy) / tiles.z           uv = 0.5 + map.x * (t - floor(t) - 0.5)
 *                                               depth = depth.x + depth.y * q.z
 *
 * Maps show more than what is asked of them by a rim, for filters.
 *
 *   //--------------- 16B ---------------
 *   map.x as above    map.y edge of a texel: metres, or slope q[u] / e    map.z rim, uv    map.w texels a side
 *   depth.z how soft shadows are: radius, metres, or tangent of the angular radius
 *   layers.x first map    layers.y how many: 1, 6, or of a sun all its tiles
 *   rest     uniform blocks begin at multiples of 256 bytes
 */
GI_STRUCT(gi_punctual_view) {
	gi_punctual_light light;
	GI_VEC4 frame_x;
	GI_VEC4 frame_y;
	GI_VEC4 frame_z;
	GI_VEC4 map;
	GI_VEC4 depth;
	GI_VEC4 tiles;
	GI_UVEC4 layers;
	GI_VEC4 rest[4];
} GI_END(gi_punctual_view)

#define GI_PIXEL_LIGHTS 16u    /* that pictures are lit by pixel by pixel; others light them through the leaves */
#define GI_SUN_TILES 4u

#endif
