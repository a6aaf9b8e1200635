/* How far off the rows are, on random leaves. */
#ifndef GI_ESTIMATE_H
#define GI_ESTIMATE_H

#include "arena.h"
#include "buffers.h"
#include "gpu.h"

typedef struct gi_estimate {
	bool fresh;      /* chances are those of the committed scene */
	double area;     /* of all its leaves, m2 */
	gi_arena memory; /* where chances are made: shapes that change make others every frame */
	/* Made by the first update that wants them, as the buffers. */
	uint32_t samples_program, trace_program, sum_program, mean_program;
	ESTIMATE_BUFFERS(BUFFER_MEMBER)
} gi_estimate;

gi_result estimate_update(gi_context *gi); /* nothing where def.estimate_leaves is 0 */
void estimate_invalidate(gi_context *gi);  /* after a commit, or where leaves are of other areas */
void estimate_free(gi_context *gi);

#endif
