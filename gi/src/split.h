/* Cuts the faces of a bilinear cage into leaves, each face for itself: into a grid of cells of a size, and along lines.
 *
 *   face 4 x 1 m, size 1       with a line across it
 *   +---+---+---+---+          +---+--|+---+---+
 *   |   |   |   |   |          |   |  ||   |   |      each piece is a node, so that what lies on either side of a line
 *   +---+---+---+---+          +---+--|+---+---+      hangs below nodes that do not cross it
 *
 * Faces that share an edge and have one size meet corner to corner; else a corner of one lies on an edge of the other.
 */
#ifndef GI_SPLIT_H
#define GI_SPLIT_H

#include "refine.h"

#include "gi/gi.h"

/* Levels of a cage that was split: no deeper, or recursion over them would be. */
#define GI_SPLIT_MAX_LEVELS 64

typedef struct gi_split_def {
	float leaf_size;         /* of faces without one of their own, > 0 */
	const float *leaf_sizes; /* a face of the cage, 0: leaf_size; NULL: all */
	const gi_leaf_cut *cuts; /* before the cage's scale */
	uint32_t cut_count;
} gi_split_def;

/* About how many leaves the cage would have without its cuts: exactly for rectangles, on average for others. */
double gi_split_estimate(const gi_refine_cage *cage, const gi_split_def *def);

/* The cage's faces become level 0; faces that are not split reach down to the finest level as single children.
 * Positions are interpolated in double. Lines are cut into convex flat faces only. False with one line in message when
 * the cage is not valid (see gi_refine), there would be more than 2^24 leaves, or memory ran out. */
bool gi_split(const gi_refine_cage *cage, const gi_split_def *def, gi_refined *out, char *message, size_t message_size);

#endif
