/* Faces of a cage that are there twice: the same corners in the same order round, wherever the list begins. Two that go
 * round the other way are the sides of a sheet.
 */
#ifndef GI_DUPLICATES_H
#define GI_DUPLICATES_H

#include "gi/gi.h"

/* A definition without the faces that repeat an earlier one; of the other arrays it shares the caller's. */
typedef struct gi_unique_faces {
	gi_object_def def;
	uint32_t dropped;
	uint32_t *origin; /* def.face_count numbers of the caller's faces; NULL where nothing was dropped */
	uint32_t *face_counts, *indices, *face_materials; /* its own; NULL where nothing was dropped */
	float *leaf_sizes, *uvs;
	gi_leaf_cut *leaf_cuts;
} gi_unique_faces;

/* `def` has passed its checks. Corners are compared by where they are, or, so that creases keep their edges, by number
 * where there are creases. Time: corners times the logarithm of faces. False when memory ran out. */
bool gi_unique_faces_make(const gi_object_def *def, gi_unique_faces *out);

void gi_unique_faces_free(gi_unique_faces *unique);

#endif
