/* The solve, and the light of what is drawn. */
#ifndef GI_SOLVER_H
#define GI_SOLVER_H

#include "buffers.h"
#include "gpu.h"

typedef struct gi_solver {
	bool cold; /* the next solve starts from B = E, whatever B is in the buffers */
	/* The program whose sums of what is emitted are there: another one makes all of them anew */
	uint32_t emitted_by;
	bool unconverged; /* of the newest report: another frame of sweeps would come nearer */
	SOLVER_BUFFERS(BUFFER_MEMBER)
	uint32_t emitted_program, gather_program, double_program, weigh_program, pull_program, large_program,
	    check_program, start_program, light_program, hand_over_program;
} gi_solver;

enum { SOLVER_PROGRAMS = 10 };
void solver_programs(gi_solver *solver, gpu_program_file list[SOLVER_PROGRAMS]);
gi_result solver_allocate(gi_context *gi);
/* anew: the rows or materials are not those of the solve before. budget may be NULL. */
void solver_update(gi_context *gi, bool anew, const gi_budget *budget);
void solver_forget(gi_solver *solver);
void solver_release(gi_context *gi, gi_solver *solver);
void solver_retire(gi_context *gi, gi_solver *solver);

#endif
