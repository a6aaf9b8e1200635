/* Do parts of a flat object cover each other? */
#ifndef GI_OVERLAP_H
#define GI_OVERLAP_H

#include "bvh.h"

/* All primitives lie in one plane. Those that share an edge do not overlap. */
bool gi_plane_overlaps(const gi_bvh *bvh);

#endif
