/* What many objects of one shape take, each created for itself, and as instances of the first.
 *
 *     LP_NUM_THREADS=0 instances_cost [COPIES [LEAVES]]
 *
 * Spheres in a grid, of about so many leaves each: host memory and processor time of an object, and what the GPU
 * holds once they are committed and drawn. The smooth ones are drawn 16 times as fine; a scan is drawn as a mesh of
 * 20,000 faces. */
#include "context.h"
#include "scenes/body.h"
#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static const gi_subsurface MARBLE = {{2190, 2620, 3000}, {2.1f, 4.1f, 7.1f}, 1.5f};

typedef enum kind { FLAT, SMOOTH, SCAN, MARBLED, SKIN, KINDS } kind;
static const char *const NAMES[KINDS] = {"bilinear", "smooth", "scan", "subsurface", "deforms"};

/* ---- memory ---- */

static size_t held;

static void *allocate(size_t size, void *user)
{
	(void)user;
	held += size;
	return malloc(size);
}

static void *reallocate(void *memory, size_t old_size, size_t new_size, void *user)
{
	(void)user;
	held += new_size - old_size;
	return realloc(memory, new_size);
}

static void give_back(void *memory, size_t size, void *user)
{
	(void)user;
	held -= size;
	free(memory);
}

/* ---- objects ---- */

typedef struct spheres {
	uint32_t copies, leaves;
	engine_mesh cage, fine;
	uint32_t *triangles;
} spheres;

static bool make_spheres(kind kind, spheres *s)
{
	const uint32_t n = (uint32_t)(sqrt((double)s->leaves / 6) + .5), levels = kind == FLAT || kind == SCAN ? 0 : 2;
	s->cage = s->fine = (engine_mesh){0};
	s->triangles = NULL;
	if (!shape_sphere(.4f, n >> levels ? n >> levels : 1, &s->cage) || !shape_sphere(.41f, 58, &s->fine))
		return false;
	s->triangles = malloc(sizeof *s->triangles * 6 * s->fine.face_count);
	for (uint32_t f = 0; s->triangles && f < s->fine.face_count; f++) {
		const uint32_t *q = s->fine.indices + 4 * f, two[6] = {q[0], q[1], q[2], q[0], q[2], q[3]};
		for (int k = 0; k < 6; k++)
			s->triangles[6 * f + (uint32_t)k] = two[k];
	}
	return s->triangles;
}

static void free_spheres(spheres *s)
{
	engine_mesh_free(&s->cage);
	engine_mesh_free(&s->fine);
	free(s->triangles);
}

static gi_object_def define(kind kind, const spheres *s)
{
	gi_object_def def = scene_mesh_def(&s->cage);
	if (kind != FLAT && kind != SCAN) {
		def.scheme = GI_SCHEME_CATMULL_CLARK;
		def.levels = 2;
	}
	def.subsurface = kind == MARBLED ? &MARBLE : NULL;
	def.deforms = kind == SKIN;
	if (kind == SCAN) {
		def.draw_positions = s->fine.positions;
		def.draw_vertex_count = s->fine.vertex_count;
		def.draw_indices = s->triangles;
		def.draw_index_count = 6 * s->fine.face_count;
	}
	return def;
}

static gi_pose place_of(uint32_t k)
{
	gi_pose pose = gi_pose_identity();
	pose.position[0] = (float)(k % 8) - 3.5f;
	pose.position[1] = (float)(k / 8 % 8) - 3.5f;
	pose.position[2] = -(float)(k / 64);
	return pose;
}

/* ---- measures ---- */

typedef struct cost {
	double bytes, ms; /* of an object but the first; processor time */
	double first_bytes, first_ms;
	double gpu, drawn; /* of all: committed, and what drawing adds */
	uint32_t leaves;
} cost;

static double now_ms(void)
{
	return 1000.0 * (double)clock() / CLOCKS_PER_SEC;
}

static bool fails(gi_result result, const char *what)
{
	if (result)
		fprintf(stderr, "%s: %s\n", what, gi_result_text(result));
	return result != GI_OK;
}

static bool create(gi_context *gi, kind kind, const spheres *s, bool instances, cost *c)
{
	gi_object_def def = define(kind, s);
	gi_object first, object;
	size_t before = held;
	double began = now_ms();
	def.pose = place_of(0);
	if (fails(gi_create_object(gi, &def, &first), "create"))
		return false;
	c->first_bytes = (double)(held - before);
	c->first_ms = now_ms() - began;
	before = held;
	began = now_ms();
	for (uint32_t k = 1; k < s->copies; k++) {
		def.pose = place_of(k);
		if (fails(instances ? gi_create_instance(gi, first, def.pose, &object)
				    : gi_create_object(gi, &def, &object),
			  "create"))
			return false;
	}
	c->bytes = (double)(held - before) / (s->copies - 1);
	c->ms = (now_ms() - began) / (s->copies - 1);
	return true;
}

/* Of what is committed, not updated: rows are as many for both. */
static bool measure_gpu(gi_context *gi, cost *c)
{
	gi_report report;
	gi_view view = gi_view_default();
	view.width = view.height = 64;
	view.view_from_world[14] = -20;
	view.clip_from_view[11] = -1;
	view.clip_from_view[15] = 0;
	if (fails(gi_commit(gi), "commit") || fails(gi_get_report(gi, &report), "report"))
		return false;
	c->gpu = (double)report.gpu_bytes;
	c->leaves = report.leaves;
	if (fails(gi_draw(gi, &view), "draw") || fails(gi_get_report(gi, &report), "report"))
		return false;
	c->drawn = (double)report.gpu_bytes - c->gpu;
	return true;
}

static bool measure(engine_context *context, kind kind, spheres *s, bool instances, cost *c)
{
	gi_context_def def = gi_context_def_default();
	def.get_proc_address = engine_context_find_gl;
	def.get_proc_user = context;
	def.allocator = (gi_allocator){allocate, reallocate, give_back, NULL};
	gi_context *gi;
	if (fails(gi_context_create(&def, &gi), "context"))
		return false;
	const bool ok = make_spheres(kind, s) && create(gi, kind, s, instances, c) && measure_gpu(gi, c);
	free_spheres(s);
	gi_context_destroy(gi);
	return ok;
}

int main(int argc, char **argv)
{
	spheres s = {.copies = argc > 1 ? (uint32_t)atoi(argv[1]) : 300,
		     .leaves = argc > 2 ? (uint32_t)atoi(argv[2]) : 500};
	engine_context_def def = engine_context_def_default();
	def.width = def.height = 64;
	def.hidden = true;
	char message[256];
	engine_context *context = engine_context_create(&def, message, sizeof message);
	if (!context || s.copies < 2 || s.leaves < 6) {
		fprintf(stderr, "%s\n", context ? "usage: instances_cost [COPIES [LEAVES]]" : message);
		return 1;
	}
	bool ok = true;
	for (kind kind = 0; ok && kind < KINDS; kind++)
		for (int instances = 0; ok && instances < 2; instances++) {
			cost c = {0};
			ok = measure(context, kind, &s, instances, &c);
			if (ok)
				printf("%-10s %-9s %6u leaves each: first %8.1f KB %8.2f ms, others %9.2f KB %9.4f ms; "
				       "GPU %7.2f KB each, drawing %7.2f KB each\n",
				       NAMES[kind], instances ? "instances" : "objects", c.leaves / s.copies,
				       c.first_bytes / 1024, c.first_ms, c.bytes / 1024, c.ms, c.gpu / 1024 / s.copies,
				       c.drawn / 1024 / s.copies);
			fflush(stdout);
		}
	engine_context_destroy(context);
	return ok ? 0 : 1;
}
