#include "programs.h"

#include "context.h"

/* The programs that every frame takes; others are compiled when first wanted. */
enum { FRAME_PROGRAMS = ROWS_PROGRAMS + SOLVER_PROGRAMS };

static void list_programs(gi_context *gi, gpu_program_file list[FRAME_PROGRAMS])
{
	rows_programs(&gi->rows, list);
	solver_programs(&gi->solver, list + ROWS_PROGRAMS);
}

gi_result programs_begin(gi_context *gi)
{
	gpu_program_file list[FRAME_PROGRAMS];
	list_programs(gi, list);
	return gpu_programs_begin(&gi->gpu, list, FRAME_PROGRAMS);
}

gi_result programs_end(gi_context *gi)
{
	gpu_program_file list[FRAME_PROGRAMS];
	list_programs(gi, list);
	const gi_result result = gi->compiled ? GI_OK : gpu_programs_end(&gi->gpu, list, FRAME_PROGRAMS);
	gi->compiled = !result;
	return result;
}

void programs_free(gi_context *gi)
{
	gpu_program_file list[FRAME_PROGRAMS];
	list_programs(gi, list);
	gpu_programs_free(&gi->gpu, list, FRAME_PROGRAMS);
}
