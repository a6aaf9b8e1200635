/* Subsurface scattering within one object: which share of the light that enters at one leaf leaves at another.
 * Fixed when the object is made, in its rest frame, so that motion does not change a bit of it.
 *
 *     R_i = sum_j S_ij H_j,    S_ij = 1/A_i int_i int_j R_d(|x - y|) dy dx       (dipole.h)
 *
 * Leaves that lie near each other have a link of their own; far ones are taken together, as nodes of the object's
 * hierarchy. Rows of leaves and columns sum to at most the albedo, so that no more light leaves than entered, and
 * the solve converges.
 */
#ifndef GI_SUBSURFACE_H
#define GI_SUBSURFACE_H

#include "hierarchy.h"

#include "gi/gi.h"

/* More leaves than these make a cluster large. */
#define GI_LARGE_CLUSTER 64u

/* A link: x the value it takes, then the float bits of its weight for red, green and blue. */

/* Values are the irradiance of leaves, then the area means of clusters, small ones first: those that are means of
 * leaves. Others are means of leaves and small clusters. Row k says what value k is made of, but for leaves, whose
 * row says what they reflect. */
typedef struct gi_subsurface_links {
	uint32_t leaf_count, small_count, large_count;
	uint32_t *first; /* row_count + 1: of its links */
	gi_uvec4 *links;
	float albedo[3]; /* of a half space of the medium, below 1: no row or column sums to more */
} gi_subsurface_links;

/* What is wrong with a medium, or NULL. */
const char *gi_subsurface_fault(const gi_subsurface *medium);

/* False: out of memory; *out is zero then. */
bool gi_subsurface_build(const gi_hierarchy *hierarchy, const gi_subsurface *medium, gi_subsurface_links *out);
void gi_subsurface_free(gi_subsurface_links *links);

#endif
