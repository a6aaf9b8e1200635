/* What 10,000 receivers add to a frame of the Cornell box in motion, and what they would add as leaves.
 *
 *     LP_NUM_THREADS=0 receivers_cost [FRAMES [REFINEMENT SAMPLES]]
 *
 * Processor time of this process a frame, ms: of the box alone, with a square object of so many leaves in the air, with
 * a square of so many receivers there whose rows are as fine as those of leaves, and at the defaults or as fine as the
 * arguments say.
 */
#include "context.h"
#include "scenes/body.h"
#include "scenes/cornell.h"
#include "scenes/shapes.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { SIDE = 100, COUNT = SIDE * SIDE };

static const float HEIGHT = 4, HALF = 2;

static bool fails(gi_result result, const char *what)
{
	if (result)
		fprintf(stderr, "%s: %s\n", what, gi_result_text(result));
	return result != GI_OK;
}

static gi_result add_receivers(gi_context *gi, float refinement, uint32_t samples)
{
	static float positions[COUNT][3], normals[COUNT][3];
	for (int k = 0; k < COUNT; k++) {
		positions[k][0] = HALF * (2 * ((float)(k % SIDE) + .5f) / SIDE - 1);
		positions[k][1] = HEIGHT;
		positions[k][2] = HALF * (2 * ((float)(k / SIDE) + .5f) / SIDE - 1);
		normals[k][1] = -1;
	}
	gi_receivers_def def = gi_receivers_def_default();
	gi_receivers out;
	def.positions = positions[0];
	def.normals = normals[0];
	def.count = COUNT;
	def.refinement = refinement;
	def.samples = samples;
	return gi_create_receivers(gi, &def, &out);
}

static gi_result add_leaves(gi_context *gi)
{
	static const float grey[3] = {.5f, .5f, .5f};
	engine_mesh mesh;
	gi_object object;
	if (!shape_quad((float[]){-HALF, HEIGHT, -HALF}, (float[]){2 * HALF, 0, 0}, (float[]){0, 0, 2 * HALF}, SIDE,
			SIDE, &mesh))
		return GI_ERROR_OUT_OF_MEMORY;
	return scene_add_body(gi, &(scene_body){.name = "square", .rho = grey}, &mesh, &object);
}

typedef struct square {
	const char *name;
	bool leaves;
	float refinement; /* of receivers; 0: there are none */
	uint32_t samples;
} square;

/* False: it said why. */
static bool measure(engine_context *context, const square *square, int frames, double *ms, gi_report *report)
{
	gi_context_def def = gi_context_def_default();
	def.get_proc_address = engine_context_find_gl;
	def.get_proc_user = context;
	gi_context *gi;
	if (fails(gi_context_create(&def, &gi), "context"))
		return false;
	cornell_def box = cornell_def_default();
	box.balls = false;
	cornell made;
	bool ok = !fails(cornell_create(gi, &box, &made), "box");
	if (ok && square->leaves)
		ok = !fails(add_leaves(gi), "square");
	if (ok && square->refinement > 0)
		ok = !fails(add_receivers(gi, square->refinement, square->samples), "receivers");
	clock_t began = 0;
	ok = ok && !fails(gi_commit(gi), "commit");
	/* The first update builds all rows, the next two compile what motion takes. */
	for (int frame = 0; ok && frame < frames + 3; frame++) {
		began = frame == 3 ? clock() : began;
		ok = !fails(gi_set_pose(gi, made.buddha, cornell_buddha_pose(.05f * (float)frame)), "pose") &&
		     !fails(gi_update(gi, NULL), "update") && !fails(gi_finish(gi), "finish");
	}
	*ms = 1000.0 * (double)(clock() - began) / CLOCKS_PER_SEC / frames;
	ok = ok && !fails(gi_get_report(gi, report), "report");
	gi_context_destroy(gi);
	return ok;
}

int main(int argc, char **argv)
{
	const gi_receivers_def defaults = gi_receivers_def_default();
	const square squares[4] = {{.name = "the box alone"},
				   {.name = "10,000 leaves", .leaves = true},
				   {.name = "10,000 receivers, as fine", .refinement = 1, .samples = 1},
				   {.name = "10,000 receivers",
				    .refinement = argc > 3 ? (float)atof(argv[2]) : defaults.refinement,
				    .samples = argc > 3 ? (uint32_t)atoi(argv[3]) : defaults.samples}};
	const int frames = argc > 1 ? atoi(argv[1]) : 10;
	engine_context_def def = engine_context_def_default();
	def.width = def.height = 64;
	def.hidden = true;
	char message[256];
	engine_context *context = engine_context_create(&def, message, sizeof message);
	if (!context || frames < 1) {
		fprintf(stderr, "%s\n", context ? "usage: receivers_cost [FRAMES [REFINEMENT SAMPLES]]" : message);
		return 1;
	}
	double ms[4];
	bool ok = true;
	for (int k = 0; ok && k < 4; k++) {
		gi_report r;
		ok = measure(context, &squares[k], frames, &ms[k], &r);
		if (ok)
			printf("%-25s %8.1f ms a frame, %+8.1f; %u leaves, %.2f million entries, %.0f rays\n",
			       squares[k].name, ms[k], ms[k] - ms[0], r.leaves, (double)r.entries * 1e-6,
			       (double)r.rays);
	}
	engine_context_destroy(context);
	return ok ? 0 : 1;
}
