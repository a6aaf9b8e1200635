#include "binding.h"

#include "context.h"

void bind_scene(const gi_context *gi)
{
#define BIND(name, buffer) gpu_bind(&gi->gpu, GI_BIND_##name, &gi->scene.buffer);
	SCENE_BUFFERS(BIND)
#undef BIND
}

static void bind_budget(const gi_context *gi)
{
	const gi_rations *r = &gi->rations;
	gpu_bind(&gi->gpu, GI_BIND_CHOICES, &r->choices);
	gpu_bind(&gi->gpu, GI_BIND_PENDING, &r->pending);
	gpu_bind(&gi->gpu, GI_BIND_SHINE, &r->shine);
}

void bind_rows(const gi_context *gi)
{
	const gi_rows *r = &gi->rows;
	gpu_bind_uniforms(&gi->gpu, GI_BIND_FRAME, &r->frame);
	gpu_bind(&gi->gpu, GI_BIND_SEGMENTS, &r->segments);
	gpu_bind(&gi->gpu, GI_BIND_ENTRIES, &r->entries);
	gpu_bind(&gi->gpu, GI_BIND_TARGETS, &r->targets);
	gpu_bind(&gi->gpu, GI_BIND_ENTRY_POOL, &r->entry_pool);
	gpu_bind(&gi->gpu, GI_BIND_QUEUE, &r->queue);
	gpu_bind(&gi->gpu, GI_BIND_ROWS, &r->headers);
	gpu_bind(&gi->gpu, GI_BIND_LINKS, &r->links);
	gpu_bind(&gi->gpu, GI_BIND_LINK_POOL, &r->link_pool);
	gpu_bind(&gi->gpu, GI_BIND_TOUCHED, &r->touched);
	gpu_bind(&gi->gpu, GI_BIND_RUNS, &r->runs);
	gpu_bind(&gi->gpu, GI_BIND_SUSPECTS, &r->suspects);
	gpu_bind(&gi->gpu, GI_BIND_STATE, &gi->state);
	bind_budget(gi);
}

void bind_solver(const gi_context *gi)
{
	const gi_solver *s = &gi->solver;
	gpu_bind(&gi->gpu, GI_BIND_RADIOSITY, &s->radiosity);
	gpu_bind(&gi->gpu, GI_BIND_LEAF_RADIOSITY, &s->leaf_radiosity);
	gpu_bind(&gi->gpu, GI_BIND_LEAF_INDIRECT, &s->leaf_indirect);
	gpu_bind(&gi->gpu, GI_BIND_LIGHT, &s->light);
}

void bind_all(const gi_context *gi)
{
	bind_scene(gi);
	bind_rows(gi);
	bind_solver(gi);
}
