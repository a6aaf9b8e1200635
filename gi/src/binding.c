#include "binding.h"

#include "context.h"

#define BIND(name, buffer, label) gpu_bind(&gi->gpu, GI_BIND_##name, &part->buffer);

void bind_scene(const gi_context *gi)
{
	const gi_scene *part = &gi->scene;
	SCENE_BUFFERS(BIND)
}

static void bind_budget(const gi_context *gi)
{
	const gi_rations *part = &gi->rations;
	BUDGET_BUFFERS(BIND)
}

void bind_rows(const gi_context *gi)
{
	const gi_rows *part = &gi->rows;
	gpu_bind_uniforms(&gi->gpu, GI_UNIFORM_FRAME, &part->frame);
	ROWS_TABLES(BIND)
	ROWS_POOLS(BIND)
	ROWS_LISTS(BIND)
	gpu_bind(&gi->gpu, GI_BIND_STATE, &gi->state);
	gpu_bind_uniforms(&gi->gpu, GI_UNIFORM_STATE, &gi->state);
	bind_budget(gi);
}

void bind_solver(const gi_context *gi)
{
	const gi_solver *part = &gi->solver;
	SOLVER_BUFFERS(BIND)
}

void bind_all(const gi_context *gi)
{
	bind_scene(gi);
	bind_rows(gi);
	bind_solver(gi);
}
