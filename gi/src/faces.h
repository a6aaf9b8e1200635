/* Faces of a cage as plain arrays: how many corners each has, and which vertices they join. */
#ifndef GI_FACES_H
#define GI_FACES_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* face_counts NULL: all have four. */
static inline uint32_t gi_corner_count(const uint32_t *face_counts, uint32_t face)
{
	return face_counts ? face_counts[face] : 4;
}

/* The vertex that names the group of vertex k: two that faces join, directly or by others, have the same. Shortens the
 * way there by half each time (Tarjan and van Leeuwen 1984).
 */
static inline uint32_t gi_group_of(uint32_t *group, uint32_t k)
{
	while (group[k] != k)
		k = group[k] = group[group[k]];
	return k;
}

static inline void gi_join(uint32_t *group, uint32_t a, uint32_t b)
{
	group[gi_group_of(group, a)] = gi_group_of(group, b);
}

#ifdef __cplusplus
}
#endif

#endif
