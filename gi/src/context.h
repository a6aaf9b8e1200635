/* What a gi_context is made of, and nothing else: each part is a module's, with a header of its own. Headers take a
 * context by its name alone; only .c files include this one. docs/architecture.md has the order of the modules. */
#ifndef GI_CONTEXT_H
#define GI_CONTEXT_H

#include "arena.h"
#include "budget.h"
#include "caustics.h"
#include "diffusion.h"
#include "estimate.h"
#include "gpu.h"
#include "lamp.h"
#include "light_list.h"
#include "paths.h"
#include "probes.h"
#include "punctual.h"
#include "receive.h"
#include "receiver_sets.h"
#include "rows.h"
#include "scene.h"
#include "shade.h"
#include "sky.h"
#include "solver.h"
#include "specular.h"
#include "specular_rows.h"

struct gi_context {
	uint32_t number; /* of all contexts of the program, from 1: handles have it */
	gi_context_def def;
	gpu gpu;
	gi_scene scene;
	gi_rows rows;
	gi_budget_state budget;
	gi_solver solver;
	gi_arena spare_arrays; /* of the scene before, for the next one */
	gi_arena passing;      /* scratch of a commit, which each step uses anew */
	gi_arena grouping;     /* the tree of static objects */
	gi_arena undo;         /* what a commit needs to undo itself where it fails */
	gi_arena tree_arena;   /* scratch of every frame: building the trees over the objects */
	gi_sky_state sky;
	gi_lamps lamps;
	gi_receiver_sets receivers;
	gi_probes *probes;   /* likewise, with probes */
	gi_receive *receive; /* made by the first update of a scene with receivers */
	gi_estimate estimate;
	gi_shade *shade;                 /* made by the first gi_draw */
	gi_paths *paths;                 /* made by the first gi_trace_paths */
	gi_smooth *smooth;               /* made by the first update of a scene with mirrors or glass */
	gi_specular_rows *specular_rows; /* likewise; there as long as some row may have links through them */
	gi_arena light_arena;            /* scratch of every frame: the emitters that send photons */
	gi_caustics *caustics;           /* made by the same, where something emits */
	gi_light_list light_list;        /* lights without a surface */
	gi_punctual *punctual;           /* what they bring to leaves; made by the first update with any */
	gi_diffusion *diffusion;         /* made by the first update of a scene with translucent objects */
	CONTEXT_BUFFERS(BUFFER_MEMBER)
	gpu_readback readback;
	gpu_timer timers[GI_PASS_COUNT];
	gi_frame frame;
	bool solve_changed; /* gi_set_solve: the next update solves by other rules */
	bool light_changed; /* gi_set_sky and others: likewise, and by other light */
	bool truncated;     /* a report said that a pool was full: the rows are not whole */
	uint64_t wanted;    /* how many elements the pool lacked */
	bool wanted_all;    /* all rows were counted, so a pool larger by that holds them */
	/* Last gi_update; last one that issued work; last one that solved. */
	uint64_t frame_number, issued_frame, solved_frame;
	uint64_t commit_frame;   /* last gi_update before the last commit */
	uint64_t rows_frame;     /* last one before a commit that made all rows anew: reports up to it are of others */
	uint64_t picture_number; /* of gi_draw calls */
	gi_report report;
	uint32_t layout; /* of buffers and numbers: another one with every commit */
	/* The programs of rows and solve, set by set (programs.c). */
	enum { PROGRAMS_NONE, PROGRAMS_BEGUN, PROGRAMS_READY } programs[ROWS_SETS];
	/* What the CPU knows of frames not reported yet, by frame number modulo the ring. */
	struct {
		uint64_t frame;
		uint32_t dispatches;
		uint64_t uploaded_bytes;
		float update_ms;
		float commit_ms; /* of that: a commit in the update, for a static object that moved or was hidden */
		uint32_t rows_update; /* number of the rows' update that it ended with */
		bool rebuilt;         /* which built all of them */
		bool solved;          /* it took sweeps */
	} issued[GPU_READBACK_RING];
};

#endif
