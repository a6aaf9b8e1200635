/* The rows of M: which nodes each leaf receives from, form factors, visibility, closing. */
#ifndef GI_ROWS_H
#define GI_ROWS_H

#include "buffers.h"
#include "gpu.h"

typedef struct gi_slot_list {
	uint32_t *slots, count, capacity;
} gi_slot_list;

typedef struct gi_rows {
	uint32_t update;                /* number of the last update of the rows, from 1 */
	uint32_t current;               /* every row has seen all that changed up to this one */
	bool rebuild;                   /* everything is to be cut anew */
	bool fitted;                    /* the pools held the rows at least once since the commit */
	bool kept;                      /* the last commit kept the rows, and no update ran since */
	bool lost;                      /* likewise, and an object went in that commit */
	uint32_t lost_update;           /* number of the update that saw the last object go */
	gi_vec4 lost_lower, lost_upper; /* box of the objects that went and that not every row has seen go */
	uint64_t entry_limit, link_limit;
	ROWS_TABLES(BUFFER_MEMBER)
	ROWS_POOLS(BUFFER_MEMBER)
	ROWS_LISTS(BUFFER_MEMBER)
	ROWS_UNIFORMS(BUFFER_MEMBER)
	gi_uvec4 *run_data; /* pose runs, then cut runs */
	uint32_t run_capacity;
	gi_slot_list object_list; /* of the last update */
	uint32_t pose_program, cut_program, factor_program, flag_program, trace_program, close_program, recycle_program,
	    prepare_program, renumber_program, tops_program, concern_program, changed_program, unmark_program,
	    kept_program, covered_program, own_program;
} gi_rows;

/* Programs by what takes them: a scene that does without a set compiles none of it (programs.c). */
typedef enum rows_set {
	ROWS_ALWAYS,
	ROWS_MOTION,         /* updates that keep rows: something moved, came, went, or began to emit */
	ROWS_STATICS,        /* static objects under common nodes */
	ROWS_STATICS_MOTION, /* both */
	ROWS_KEPT,           /* commits that keep rows */
	ROWS_DEFORMING,      /* objects whose shape may change */
	ROWS_SETS
} rows_set;
enum { ROWS_PROGRAMS = 8 }; /* of a set at most */
/* How many there are. */
uint32_t rows_programs(gi_rows *rows, rows_set set, gpu_program_file list[ROWS_PROGRAMS]);
gi_result rows_init(gi_context *gi);
gi_result rows_allocate(gi_context *gi);
/* Where the objects of the scene before the commit are now, slot by slot. */
typedef struct rows_moves {
	gi_move *list;
	uint32_t count, first_source; /* slots before */
	uint32_t place_count;         /* and with sets of receivers behind them, for which the list goes on */
	uint32_t row_count;           /* leaves and receivers before */
	uint32_t *nodes, node_count;  /* where each node is now */
	uint32_t statics_slot;        /* before; GI_NONE: there was none, or its nodes are what they were */
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
/* Sets a pool's allocator to a larger number of elements. */
void rows_copy_pool(gi_context *gi, gpu_buffer *from, uint64_t from_limit, gpu_buffer *to, uint64_t to_limit);
void rows_recycle(gi_context *gi); /* blocks that this update gave back may be taken by the next */
gi_result rows_update(gi_context *gi, const gi_budget *budget);
/* For an update in which nothing but values of materials changed: rows stay as they are. */
gi_result rows_relight(gi_context *gi);
void rows_clear_counts(gi_context *gi); /* what a report counts of one update */
/* Forgets the buffers that a commit makes anew without deleting them: a copy of the gi_rows owns them now. */
void rows_forget(gi_rows *rows);
void rows_release(gi_context *gi, gi_rows *rows); /* frees it */
void rows_retire(gi_context *gi, gi_rows *rows);  /* likewise, but memory of tables is kept for the next commit */
void rows_free(gi_context *gi);
/* Of the first rows after a commit, tells the host that this pass begins, of so many: the passes of an exact update
 * come before this one. */
enum { ROWS_FIRST_STEPS = GI_PASS_ESTIMATE };
void rows_progress(const gi_context *gi, gi_pass pass);

#endif
