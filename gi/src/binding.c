#include "binding.h"

#include "context.h"

void bind_scene(const gi_context *gi)
{
	const gi_scene *owner = &gi->scene;
	SCENE_BUFFERS(BUFFER_BIND)
}

static void bind_budget(const gi_context *gi)
{
	const gi_budget_state *owner = &gi->budget;
	BUDGET_BUFFERS(BUFFER_BIND)
}

static void bind_state(const gi_context *gi)
{
	const gi_context *owner = gi;
	CONTEXT_BUFFERS(BUFFER_BIND)
	gpu_bind_uniforms(&gi->gpu, GI_UNIFORM_STATE, &gi->state);
}

void bind_rows(const gi_context *gi)
{
	const gi_rows *owner = &gi->rows;
	gpu_bind_uniforms(&gi->gpu, GI_UNIFORM_FRAME, &owner->frame);
	ROWS_TABLES(BUFFER_BIND)
	ROWS_POOLS(BUFFER_BIND)
	ROWS_LISTS(BUFFER_BIND)
	bind_state(gi);
	bind_budget(gi);
}

void bind_solver(const gi_context *gi)
{
	const gi_solver *owner = &gi->solver;
	SOLVER_BUFFERS(BUFFER_BIND)
}

void bind_all(const gi_context *gi)
{
	bind_scene(gi);
	bind_rows(gi);
	bind_solver(gi);
}
