/* Updates that may not refresh every row: which rows go first, and what those that wait may be off by. */
#ifndef GI_BUDGET_H
#define GI_BUDGET_H

#include "buffers.h"
#include "costs.h"
#include "gi_shared.h"
#include "gpu.h"

/* Made by the first update that has a budget. */
typedef struct gi_budget_state {
	bool made;     /* the programs are there */
	bool in_force; /* some rows may wait: bounds on them are kept up with B */
	bool late;     /* some wait for lack of budget alone, as of the newest report: the next update goes on */
	gi_costs costs;
	uint64_t learned;       /* frame of the report that costs were learned from last */
	gi_budget last;         /* budget of the last update of rows that had one */
	gpu_timer assess_timer; /* part of the choose pass */
	BUDGET_BUFFERS(BUFFER_MEMBER)
	uint32_t light_bounds_program, survey_program, assess_program, choose_program, enlist_program, stale_program,
	    lend_program;
} gi_budget_state;

bool budget_is_exact(const gi_budget *budget);
gi_result budget_check(const gi_context *gi, const gi_budget *budget);
/* Makes the programs and buffers that are not there yet. */
gi_result budget_allocate(gi_context *gi);
/* What is left of a budget of time after `ms` of it were used; a tenth of it at least. Other budgets stay. */
gi_budget budget_less(const gi_budget *budget, float ms);
/* Sets frame->limit and, in frame->budget, how many rows may be assessed. */
void budget_limits(gi_context *gi, const gi_budget *budget, gi_frame *frame);
/* Does the budget limit the time of the solve? Else it takes as many sweeps as it needs. */
bool budget_times_solve(const gi_context *gi, const gi_budget *budget);
/* How many sweeps a solve may take whose time is limited. */
uint32_t budget_sweeps(const gi_context *gi, const gi_budget *budget);
void budget_choose(gi_context *gi); /* the rows to refresh; the movers' poses must be in the world */
void budget_bound(gi_context *gi);  /* after the solve: what waiting rows may be off by */
void budget_report(const gi_state *state, gi_report *out);
void budget_learn(gi_context *gi);            /* what updates cost, from the newest report */
float budget_choose_ms(const gi_context *gi); /* of the choose pass, of the newest report */
void budget_free(gi_context *gi);

#endif
