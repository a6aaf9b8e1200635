/* Under a budget: what objects that came, or are shown again, are lit by until their own rows are built.
 *
 * Their leaves borrow the row of the nearest leaf that faces the same way. It is a closed row like any, so that all
 * that is certified of rows that wait holds of it; it is marked (GI_ROW_OPEN) to be built whatever else changes.
 */
#ifndef GI_LOANS_H
#define GI_LOANS_H

#include "buffers.h"
#include "gpu.h"

typedef struct loans {
	LOAN_BUFFERS(BUFFER_MEMBER)
	uint32_t count;
} loans;

/* Finds for each new leaf the one that lends its row; the trees over the objects must be up to date. */
gi_result loans_find(gi_context *gi, loans *out);

/* Copies the lent rows on the GPU, before rows to refresh are chosen. Frees the list. */
void loans_give(gi_context *gi, loans *loans);

void loans_free(gi_context *gi, loans *loans);

#endif
