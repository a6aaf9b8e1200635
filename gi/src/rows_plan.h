/* What an update of the rows has to do: which threads of pose and cut, which objects moved, under a budget or not. */
#ifndef GI_ROWS_PLAN_H
#define GI_ROWS_PLAN_H

#include "loans.h"
#include "rows.h"

typedef struct rows_plan {
	bool part;    /* under a budget: the chosen rows alone */
	bool several; /* rows may have several candidates: flagged entries are marked */
	uint32_t pose_runs, pose_threads, cut_runs, movers;
	uint32_t first_emitter, end_emitter; /* in the lists of objects */
	uint32_t first_swept, swept;         /* likewise, in fours of words */
	uint64_t cut_threads, own_threads;   /* the latter of objects that deform, for themselves */
	bool deforms;                        /* there are such objects */
	loans loans;                         /* in part alone */
} rows_plan;

/* Uploads what moved, the runs and the lists of objects. */
gi_result rows_plan_make(gi_context *gi, const gi_budget *budget, rows_plan *plan);
/* Fills gi->frame and uploads it. An empty plan: nothing of the rows changes. */
void rows_plan_upload_frame(gi_context *gi, const rows_plan *plan, const gi_budget *budget);
/* Did it move since some row was refreshed? The sky never does. */
bool rows_slot_moved(const gi_context *gi, uint32_t slot);

#endif
