/* What a gi_context is made of. Each part belongs to one module; gi.c holds the public functions that join them.
 *
 *   gi.c, frame.c
 *     -> leaves.c, contact.c                      how fine objects are cut
 *     -> handles.c                                the list of objects
 *     -> scene.c, scene_upload.c, sky.c, tlas.c   objects, uploads; statics.c: those that stay, under common nodes; one at
 *                                                 a time: object.c, hierarchy.c, refine.cpp, split.c, bvh.c, skin.c
 *        -> rows.c             cuts, factors, visibility, closing
 *        -> budget.c           which rows an update refreshes, what the others may be off by; loans.c: new ones' light
 *        -> solver.c           sweeps, light
 *        -> estimate.c         how far off the rows are
 *        -> shade.c            the picture
 *        -> paths.c            path tracing, for comparison
 *             all -> gpu.c     OpenGL
 */
#ifndef GI_CONTEXT_H
#define GI_CONTEXT_H

#include "arena.h"
#include "bvh.h"
#include "costs.h"
#include "gpu.h"
#include "hierarchy.h"
#include "lamp.h"
#include "skin.h"

/* ---- scene ---- */

/* Of a material of an object (emitters.c). */
typedef struct scene_emission {
	double area;    /* of its leaves, m2 */
	uint32_t steps; /* while it emits it is cut 2^steps times finer than others */
	bool ranked;    /* it emitted at the last commit (rank.h) */
} scene_emission;

typedef struct scene_object {
	uint32_t generation; /* of the handle that owns this place; odd while alive */
	bool committed;      /* part of the uploaded scene */
	bool moved;          /* since the last update */
	bool relit;          /* emission began or ended, or it is cut finer or coarser for it, or black became not black */
	bool material_changed;
	bool hidden;         /* by the host */
	bool arrives;        /* it came or is shown again, since the last update: it has no rows yet */
	gi_mobility mobility;
	bool grouped;        /* one of the static objects that are one source (statics.h) */
	bool was_grouped;    /* before the last commit */
	uint32_t moved_update, relit_update; /* numbers of the row updates that last saw it so (gi_rows) */
	char *name;
	gi_pose pose;
	gi_material *materials;
	scene_emission *emission; /* of each */
	uint32_t material_count;
	gi_hierarchy hierarchy;
	gi_bvh bvh;
	gi_skin skin;
	uint32_t *by_size; /* numbers of its primitives (rank.h) */

	/* Place in the uploaded scene. */
	uint32_t lowest_rank, highest_rank; /* of its primitives (rank.h) */
	uint32_t slot, node_base, leaf_base, vertex_base, bvh_base, primitive_base, material_base, light_base;
	gi_vec4 world_lower, world_upper;
	bool trails; /* where it was since every row has seen it: */
	gi_vec4 trail_lower, trail_upper;
	gi_vec4 ceiling; /* of its leaves, largest E / (1 - rho) of rgb; largest 1 / (1 - rho) */
	bool plane; /* all of it in one plane */
	bool overlaps; /* and parts of it cover each other */
	uint64_t created; /* how many were created before it */
	/* Ids of its leaves and nodes begin here. They are the place's: an object that takes it gets them, if they are
	 * enough. */
	uint32_t leaf_id, node_id, leaf_ids, node_ids;
} scene_object;

/* A node of several static objects, those of slots [first_slot, end_slot). */
typedef struct scene_top {
	uint32_t node, first_slot, end_slot;
	uint32_t id;
	uint32_t changed; /* number of the row update that last saw it or something below it changed */
	uint32_t before;  /* its node in the scene before the last commit, GI_NONE: it was not there */
} scene_top;

typedef struct gi_scene {
	scene_object *objects; /* by handle index */
	uint32_t object_count; /* places, dead ones too; there is room for the next power of two */
	uint32_t first_free;   /* no place below it is */
	uint64_t created_count; /* objects ever created */
	uint32_t next_leaf_id, next_node_id;
	bool ever_committed;

	uint32_t *slots;     /* handle index of each slot; the sky's is GI_NONE */
	uint32_t slot_count; /* the sky's too */
	uint32_t sky_slot;   /* GI_NONE: none */
	uint32_t statics_slot; /* static objects as one source, GI_NONE: none; their own slots are the first ones */
	uint32_t first_source; /* slot; from here on they are sources */
	scene_top *tops;
	uint32_t top_count;
	bool automatic_static; /* GI_MOBILITY_AUTOMATIC is static, as of the last commit */
	uint32_t statics_update; /* number of the row update that last saw an object come to the static ones or leave them */
	uint32_t *changed_slots; /* static objects that the update sees changed: room for all of them */
	bool regroup;            /* one of them is static no more, or not seen: the next update commits */
	uint32_t leaf_count, node_count, vertex_count, light_count, wide_count;

	gi_arena arrays; /* all of these, slots and tops: */
	gi_object_data *object_data; /* slot_count */
	gi_node_topology *topology;  /* node_count, as uploaded */
	gi_vec4 *node_exitance;      /* node_count: rgb, w mean rho */
	gi_bvh_node *tlas;
	gi_uvec4 *tlas_packed;
	gi_vec4 tlas_grid, tlas_cells;
	uint32_t tlas_count; /* nodes that there is room for in each of two trees */
	uint32_t tlas_all, tlas_inner; /* of all objects that are seen, of a tree of those that may lie between two others */
	uint32_t tlas_inner_first, tlas_inner_end; /* of the latter, which may be the first tree */

	gpu_buffer objects_gpu, topology_gpu, rest_gpu, world_gpu, vertices_rest_gpu, vertices_world_gpu, leaves_gpu,
		materials_gpu, bvh_gpu, primitives_gpu, tlas_gpu, node_exitance_gpu, wide_nodes_gpu, light_links_gpu,
		light_first_gpu, spread_gpu, leaf_quads_gpu;
} gi_scene;

/* ---- rows ---- */

typedef struct gi_slot_list {
	uint32_t *slots, count, capacity;
} gi_slot_list;

typedef struct gi_rows {
	uint32_t update;   /* number of the last update of the rows, from 1 */
	uint32_t current;  /* every row has seen all that changed up to this one */
	bool rebuild;      /* everything is to be cut anew */
	bool fitted;       /* the pools held the rows at least once since the commit */
	bool kept;         /* the last commit kept them: no update ran since */
	bool lost;         /* and an object went */
	uint32_t lost_update; /* that saw the last one that went */
	gi_vec4 lost_lower, lost_upper; /* where all those were that not every row has seen go */
	uint64_t entry_limit, link_limit;
	gpu_buffer segments, entries, targets, entry_pool, queue, headers, links, link_pool, touched, runs, suspects,
		frame;
	gi_uvec4 *run_data; /* pose runs, then cut runs */
	uint32_t run_capacity;
	gi_slot_list suspect_list; /* of the last update */
	uint32_t pose_program, cut_program, factor_program, flag_program, trace_program, close_program, recycle_program,
		prepare_program, renumber_program, tops_program, concern_program, changed_program, unmark_program,
		kept_program, covered_program;
} gi_rows;

/* ---- budget ---- */

/* Made by the first update that has a budget. */
typedef struct gi_rations {
	bool made;         /* programs */
	bool in_force;     /* some rows may wait: bounds on them are kept up with B */
	bool late;         /* some wait for lack of budget alone, as of the newest report: the next update goes on */
	gi_costs costs;
	uint64_t learned;  /* frame of the report that costs were learned from last */
	gi_budget last;    /* budget of the last update of rows that had one */
	gpu_timer assess_timer; /* part of the choose pass */
	gpu_buffer choices, pending, shine;
	uint32_t shine_program, survey_program, assess_program, choose_program, enlist_program, stale_program,
		lend_program;
} gi_rations;

/* ---- solver ---- */

typedef struct gi_solver {
	bool cold;         /* start from B = E, though buffers hold another B; they begin with B = E */
	bool unconverged;  /* of the newest report: another frame of sweeps would come nearer */
	gpu_buffer radiosity, leaf_radiosity, leaf_indirect, light;
	uint32_t emitted_program, gather_program, double_program, weigh_program, pull_program, wide_program,
		check_program, start_program, light_program, hand_over_program;
} gi_solver;

/* ---- estimate ---- */

typedef struct gi_estimate {
	bool fresh; /* chances are those of the committed scene */
	double area; /* of all its leaves, m2 */
	/* Made by the first update that wants them, as the buffers. */
	uint32_t choose_program, trace_program, sum_program, mean_program;
	gpu_buffer chances, items, shares, results;
} gi_estimate;

typedef struct gi_shade gi_shade;
typedef struct gi_paths gi_paths;

struct gi_context {
	uint32_t number; /* of all contexts of the program, from 1: handles have it */
	gi_context_def def;
	gpu gpu;
	gi_scene scene;
	gi_rows rows;
	gi_rations rations;
	gi_solver solver;
	gi_arena spare_arrays; /* of the scene before, for the next one */
	gi_arena passing;      /* what a step of a commit takes, one after the other */
	gi_arena undo;         /* what it needs to the end */
	gi_arena tree_arena;   /* what building the trees over the objects takes, for every frame */
	gi_lamps lamps;
	gi_estimate estimate;
	gi_shade *shade; /* made by the first gi_draw */
	gi_paths *paths; /* made by the first gi_trace_paths */
	gpu_buffer state;
	gpu_readback readback;
	gpu_timer timers[GI_PASS_COUNT];
	gi_frame frame;
	bool compiled;     /* the programs of every frame: begun by gi_context_create, asked for by gi_commit */
	bool solve_changed; /* gi_set_solve: the next update solves by other rules */
	bool light_changed; /* gi_set_sky and others: likewise, and by other light */
	bool truncated;    /* a report said that a pool was full */
	uint64_t wanted;   /* how many elements it lacked */
	bool wanted_all;   /* and all rows were built: with those they fit */
	uint64_t frame_number, issued_frame; /* last gi_update; last one that issued work */
	uint64_t commit_frame;               /* last gi_update before the last commit */
	uint64_t rows_frame;                 /* last one before a commit that made all rows anew: reports up to it are of others */
	uint64_t picture_number;             /* of gi_draw calls */
	gi_report report;
	struct {
		uint64_t frame;
		uint32_t dispatches;
		uint64_t uploaded_bytes;
		float update_ms;
		uint32_t rows_update; /* number of the rows' update that it ended with */
		bool rebuilt;         /* which built all of them */
	} issued[GPU_READBACK_RING]; /* what the CPU knows of frames not reported yet, by frame number modulo the ring */
};

/* gi.c: "... must not be NULL", or "the context must not be NULL". */
gi_result gi_fail_null(const gi_context *gi, const char *what);
/* GI_ERROR_WRONG_CONTEXT, and a line, unless the OpenGL context is current that gi was created in. */
gi_result gi_check_current(const gi_context *gi, const char *function);

/* handles.c */
struct gi_prepared_object {
	scene_object object;
};

gi_result scene_create_object(gi_context *gi, const gi_object_def *def, gi_object *out);
/* On any thread. */
gi_result scene_prepare_object(const gi_log *log, const gi_object_def *def, gi_prepared_object **out);
/* Frees it where all went well. */
gi_result scene_create_prepared(gi_context *gi, gi_prepared_object *prepared, gi_object *out);
void scene_free_place(gi_scene *scene, scene_object *object); /* the object too */
scene_object *scene_find(const gi_context *gi, gi_object handle);
gi_object scene_handle(const gi_context *gi, uint32_t index);

/* object.c: nothing of it writes to what threads share. */
/* For whom an object is built: a context whose renderer has to hold it, or NULL, on any thread. */
typedef struct object_builder {
	const gi_log *log;
	gi_context *gi;
} object_builder;

gi_result scene_build_object(const object_builder *builder, const gi_object_def *def, scene_object *out);
void scene_free_object(scene_object *object);
bool scene_emits(const gi_material *material);
bool scene_material_is_valid(const gi_log *log, const gi_material *material, const char *object, uint32_t index);
/* Lengths and places of objects, metres, and exitance, W/m2, are at most this: B and area times B stay in the range of
 * floats with every rho below 1, and so do the products of three lengths that rays take. */
#define SCENE_MAX_LENGTH 1e9f
#define SCENE_MAX_EXITANCE 1e12f
/* Products of three lengths end here at the lower end. */
#define SCENE_MIN_AREA 1e-24f
/* Whether the library takes the definition, but for what refining it shows. */
gi_result scene_check_def(const gi_log *log, const gi_object_def *def);
/* About how many leaves an object would have; or exactly, by splitting its faces, false: memory ran out. */
double scene_estimate_leaves(const gi_object_def *def);
bool scene_count_leaves(const gi_object_def *def, uint64_t *count);
/* A size in two digits, not less than it. */
double scene_rounded_size(double size);
bool scene_normalise_pose(const gi_log *log, gi_pose *pose, const char *object);

/* scene.c */
bool scene_is_alive(const scene_object *object);
/* Not hidden, not destroyed: what is not seen keeps its place until the next commit, and takes part in nothing. */
bool scene_is_seen(const scene_object *object);
/* The same as of the last update. Not the sky. */
bool scene_slot_is_seen(const gi_scene *scene, uint32_t slot);
uint32_t scene_source_count(const gi_scene *scene);
uint32_t scene_object_flags(const scene_object *object); /* GI_OBJECT_ */
void scene_place_object(scene_object *object, gi_object_data *data);
void scene_leave_trail(scene_object *object); /* before it is placed elsewhere */
void scene_include_box(const scene_object *object, gi_vec4 *lower, gi_vec4 *upper); /* its own and its trail */
void scene_place_sky(gi_object_data *data);
gi_material_data scene_material_data(const scene_object *object, uint32_t material);
void scene_update_exitance(gi_context *gi, scene_object *object);
/* Of a node's flags, those that this sets. */
#define SCENE_EMITTER_BITS (GI_NODE_EMITTER | GI_NODE_FINER_MOST << GI_NODE_FINER_SHIFT)
void scene_update_top(gi_context *gi, const scene_top *top); /* likewise, of its objects' */
/* Materials that changed; what emits is weighed again, which may relight others. */
gi_result scene_upload_materials(gi_context *gi);
gi_result scene_upload_changes(gi_context *gi); /* likewise, poses and trees */
void scene_bind(const gi_context *gi);
void scene_release(gi_context *gi, gi_scene *scene); /* buffers and arrays, not the objects */
void scene_retire(gi_context *gi, gi_scene *scene);  /* likewise, but their memory is kept for the next commit */
void scene_free(gi_context *gi);

/* emitters.c: how much finer what emits is cut. */
bool scene_measure_materials(scene_object *object);
/* Of all objects; those whose part in it changed are relit. */
gi_result scene_weigh_emitters(gi_context *gi);

/* tlas.c: where the objects are now. */
gi_result tlas_upload(gi_context *gi);

/* gi.c: what gi_commit does. */
gi_result gi_take_in(gi_context *gi);

/* scene_upload.c */
gi_result scene_upload(gi_context *gi);

/* sky.c: the patches at infinity as a hierarchy of directions. */
bool sky_build(gi_hierarchy *out);
bool sky_is_lit(const gi_context_def *def);
/* Where the scene has a sky: its light is that of the definition. */
void sky_relight(gi_context *gi);

/* frame.c: of the first rows after a commit, tells the host that this pass begins. */
void frame_progress(const gi_context *gi, gi_pass pass);

/* rows.c */
enum { ROWS_PROGRAMS = 15 };
void rows_programs(gi_rows *rows, gpu_program_file list[ROWS_PROGRAMS]);
gi_result rows_init(gi_context *gi);
/* Are the tables of that many leaves and objects within what the renderer binds? */
bool rows_can_hold(gi_context *gi, uint64_t leaves, uint64_t sources);
/* Of a scene's table of segments, or of the fewest entries that there must be room for. */
uint64_t rows_table_bytes(uint64_t leaves, uint64_t sources);
gi_result rows_allocate(gi_context *gi);
/* What became of the objects of the scene before, slot by slot. */
typedef struct rows_moves {
	gi_move *list;
	uint32_t count, leaf_count, first_source; /* slots and leaves before */
	uint32_t *nodes, node_count;              /* where each node is now */
	uint32_t statics_slot;                    /* before; GI_NONE: there was none, or its nodes are what they were */
} rows_moves;
/* Instead of rows_allocate, where a scene takes the place of another that has much in common with it: rows of what
 * stays are kept, and renumbered as the last step, which cannot fail. Takes what it keeps out of `before`. */
gi_result rows_keep(gi_context *gi, gi_rows *before, const rows_moves *moves);
gi_result rows_grow(gi_context *gi);
/* For rows_keep.c: tables of leaves and slots, without a row; pools of gi->rows.entry_limit; how many entries a pool
 * may have where so many are wanted. */
gi_result rows_allocate_tables(gi_context *gi);
gi_result rows_allocate_pools(gi_context *gi);
uint64_t rows_most_entries(gi_context *gi, uint64_t wanted);
/* An allocator's state, for a pool of more elements. */
void rows_copy_pool(gi_context *gi, gpu_buffer *from, uint64_t from_limit, gpu_buffer *to, uint64_t to_limit);
void rows_recycle(gi_context *gi); /* what was given back may be taken again */
gi_result rows_update(gi_context *gi, const gi_budget *budget);
/* Where values of materials are all that changed: rows stay what they are. */
gi_result rows_relight(gi_context *gi);
void rows_clear_counts(gi_context *gi); /* what a report counts of one update */
void rows_bind(const gi_context *gi);
void rows_forget(gi_rows *rows);                     /* drops the names of what a commit makes */
void rows_release(gi_context *gi, gi_rows *rows);     /* frees it */
void rows_retire(gi_context *gi, gi_rows *rows);      /* likewise, but memory of tables is kept for the next commit */
void rows_free(gi_context *gi);

/* budget.c */
bool budget_is_exact(const gi_budget *budget);
gi_result budget_check(const gi_context *gi, const gi_budget *budget);
/* Programs and buffers, where they are not there yet. */
gi_result budget_allocate(gi_context *gi);
/* Of the frame: limit, and of rations the rows to assess. */
void budget_limits(gi_context *gi, const gi_budget *budget, gi_frame *frame);
/* Is time what a solve is given, and not as many sweeps as it needs? */
bool budget_times_solve(const gi_context *gi, const gi_budget *budget);
uint32_t budget_sweeps(const gi_context *gi, const gi_budget *budget); /* that such a solve may take */
void budget_choose(gi_context *gi);  /* the rows to refresh; the movers' poses must be in the world */
void budget_bound(gi_context *gi);   /* after the solve: what waiting rows may be off by */
void budget_report(const uint32_t *state, gi_report *out);
void budget_learn(gi_context *gi);   /* what updates cost, from the newest report */
float budget_choose_ms(const gi_context *gi); /* of the choose pass, of the newest report */
void budget_bind(const gi_context *gi);
void budget_free(gi_context *gi);

/* solver.c */
enum { SOLVER_PROGRAMS = 10 };
void solver_programs(gi_solver *solver, gpu_program_file list[SOLVER_PROGRAMS]);
gi_result solver_allocate(gi_context *gi);
/* anew: the rows or materials are not those of the solve before. budget may be NULL. */
void solver_update(gi_context *gi, bool anew, const gi_budget *budget);
void solver_bind(const gi_context *gi);
void solver_forget(gi_solver *solver);
void solver_release(gi_context *gi, gi_solver *solver);
void solver_retire(gi_context *gi, gi_solver *solver);

/* estimate.c */
gi_result estimate_update(gi_context *gi); /* nothing where def.estimate_leaves is 0 */
void estimate_invalidate(gi_context *gi);  /* after a commit */
void estimate_free(gi_context *gi);

/* shade.c */
void shade_invalidate(gi_context *gi);
void shade_free(gi_context *gi);

/* paths.c */
void paths_free(gi_context *gi);

#endif
