/* Points as weighted sums of a cage's vertices: the same sums give the points of any pose of the cage.
 */
#ifndef GI_STENCILS_H
#define GI_STENCILS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Point k is the sum over [first[k], first[k + 1]) of weight times vertex, in the order of the vertices' numbers. */
typedef struct gi_stencils {
	uint32_t count, term_count;
	uint32_t *first; /* count + 1 */
	uint32_t *vertex;
	double *weight;
	uint32_t room, term_room; /* that there is memory for */
} gi_stencils;

/* Room for `points` more of `terms` in all. False: out of memory. */
bool gi_stencils_reserve(gi_stencils *stencils, uint32_t points, uint32_t terms);

/* Appends a term to the point that is being made, the one after the last; then ends that point. There is room. */
void gi_stencils_add_term(gi_stencils *stencils, uint32_t vertex, double weight);
void gi_stencils_end_point(gi_stencils *stencils);

/* Appends (a weight_a + b weight_b) / (weight_a + weight_b), a and b numbers of points. False: out of memory. */
bool gi_stencils_add_between(gi_stencils *stencils, uint32_t a, uint32_t b, double weight_a, double weight_b);

/* Forgets the last point. */
void gi_stencils_drop_last(gi_stencils *stencils);

/* Are two points sums of the same vertices? */
bool gi_stencils_alike(const gi_stencils *stencils, uint32_t a, uint32_t b);

void gi_stencils_evaluate(const gi_stencils *stencils, uint32_t point, const double (*cage)[3], double out[3]);

/* All of `from`, as a copy that has no more room than that. False: out of memory. */
bool gi_stencils_copy(const gi_stencils *from, gi_stencils *out);
void gi_stencils_free(gi_stencils *stencils);

#ifdef __cplusplus
}
#endif

#endif
