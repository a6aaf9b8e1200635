/* The only place of gi/ that calls OpenGL: buffers, programs, dispatches, timers, read-backs.
 *
 * Nothing here knows what the buffers mean. Counters tell a frame what it cost.
 */
#ifndef GI_GPU_H
#define GI_GPU_H

#include "gi/gi.h"
#include "gi_shared.h"
#include "log.h"

typedef struct gpu_buffer {
	uint32_t name;
	uint32_t texture;  /* the same bytes, as texels of four words */
	uint64_t size;     /* bytes; at least 16 once created */
	uint64_t capacity; /* that it has room for */
} gpu_buffer;

/* As shaders count them (gi_shared.h). */
enum { GPU_BINDINGS = GI_BIND_COUNT, GPU_FIRST_TEXEL_UNIT = GI_TEXEL_UNIT };

enum { GPU_TIMER_RING = 4 };

typedef struct gpu_timer {
	uint32_t query[GPU_TIMER_RING][2]; /* time stamps, so that a host may measure around them */
	uint64_t tag[GPU_TIMER_RING];      /* gpu.tag of each measurement; 0: none */
	float ms[GPU_TIMER_RING];          /* below 0: not finished */
	uint32_t next, pending;            /* ring position, queries not yet read */
	double began_ms;                   /* software renderers: by the clock */
	const char *name;                  /* of what it measures, a debug group; NULL: none */
} gpu_timer;

/* A program and where its name is kept. */
typedef struct gpu_program_use {
	const char *vertex_file, *file; /* vertex_file NULL: a compute shader */
	uint32_t *program;
} gpu_program_use;

enum { GPU_MOST_PROGRAMS = 128 };

typedef struct gpu {
	gi_log log;
	struct GladGLContext *gl; /* OpenGL's functions in this context (gi_gl.h); NULL: none were loaded */
	char *shader_directory;   /* NULL: built in */
	uint32_t mark;            /* a vertex array's name, which tells this OpenGL context from others */
	bool lost;                /* the OpenGL context is not current when all is freed: its objects are left alone */
	uint32_t group_size;      /* threads of a compute group, a power of two */
	uint64_t host_limit;      /* of a buffer, bytes; 0: none */
	uint64_t block_bytes;     /* of a storage block, as promised or found by trial */
	uint64_t texture_bytes;   /* of a buffer texture */
	bool tried;               /* whether a storage block holds more than promised */
	uint32_t most_pixels;     /* of a side of a picture */
	bool profile;
	bool software; /* no GPU: its timer queries measure the wrong work, the clock the right one */

	uint64_t tag;                    /* what timers measure now: number of the update or picture, from 1 */
	uint32_t dispatches;             /* since the counters were last zeroed */
	uint64_t uploaded_bytes;         /* likewise */
	uint64_t buffer_bytes;           /* of all live buffers, and of spares */
	gpu_buffer spares[GPU_BINDINGS]; /* what gpu_buffer_retire kept */
	gpu_program_use programs[GPU_MOST_PROGRAMS]; /* that gpu_programs_reload makes anew: those made first */
	uint32_t program_count;
	char renderer[160];
} gpu;

/* OpenGL's functions as the driver of the current context has them: a program may have contexts of several drivers. */
gi_result gpu_load_functions(gpu *g, gi_get_proc_address_fn *get_proc_address, void *user);
void gpu_free_functions(gpu *g);

/* Loads OpenGL's functions and asks for its limits. */
gi_result gpu_init(gpu *g, gi_get_proc_address_fn *get_proc_address, void *user);
void gpu_close(gpu *g);

/* Is the OpenGL context current that gpu_init was called in? One that shares objects with it is another. */
bool gpu_is_current(const gpu *g);
/* GI_ERROR_WRONG_CONTEXT, and a line that names the public function, unless it is. */
gi_result gpu_check_current(const gpu *g, const char *function);

/* Takes back the error of a call that OpenGL refused for lack of memory, so that the host does not find it. */
void gpu_forget_errors(const gpu *g);

/* What debuggers call the buffer of a binding (buffers.h). */
const char *gpu_bound_label(uint32_t binding);
/* What a debugger shows of OpenGL's objects: "gi " and what it is. `kind` as of glObjectLabel. */
void gpu_label(const gpu *g, uint32_t kind, uint32_t name, const char *what);
/* A debug group: debuggers show calls between begin and end under its name. Groups nest. */
void gpu_group_begin(const gpu *g, const char *what);
void gpu_group_end(const gpu *g);

/* How large a buffer may be, bytes, which is asked for where `wanted` are. llvmpipe promises storage blocks of 128 MiB
 * and reaches as far as buffers go: where a block shall be larger than promised, a trial decides, once. */
uint64_t gpu_buffer_limit(gpu *g, uint64_t wanted);
/* For messages, after what is needed: whose limit that is, and of how many bytes. Until the next call on this
 * thread. */
const char *gpu_limit_text(const gpu *g, uint64_t limit);

/* (Re)allocates: contents are undefined unless `data` is given. Keeps the name of a live buffer out of use by others.
 */
gi_result gpu_buffer_allocate(gpu *g, gpu_buffer *buffer, const char *label, uint64_t size, const void *data);
void gpu_buffer_free(gpu *g, gpu_buffer *buffer);
/* The same for data that mostly has the size it had before: then it goes into the same memory. */
gi_result gpu_buffer_replace(gpu *g, gpu_buffer *buffer, const char *label, uint64_t size, const void *data);
/* The same as allocating for what a commit makes anew, with room for an eighth more: in the memory that was kept of
 * an earlier one of this binding, where that is enough and not far too much. */
gi_result gpu_buffer_renew(gpu *g, gpu_buffer *buffer, uint32_t binding, uint64_t size, const void *data);
/* Gives up a buffer; its memory is kept for gpu_buffer_renew, unless it is large. */
void gpu_buffer_retire(gpu *g, gpu_buffer *buffer, uint32_t binding);
void gpu_spares_free(gpu *g);
void gpu_buffer_upload(gpu *g, gpu_buffer *buffer, uint64_t offset, uint64_t size, const void *data);
void gpu_buffer_clear(const gpu *g, gpu_buffer *buffer, uint64_t offset, uint64_t size, uint32_t word);
/* All of it, a multiple of 16 bytes, to copies of four words. */
void gpu_buffer_fill(const gpu *g, gpu_buffer *buffer, const uint32_t words[4]);
void gpu_buffer_copy(const gpu *g, gpu_buffer *from, uint64_t from_offset, gpu_buffer *to, uint64_t to_offset,
		     uint64_t size);
/* Waits for the GPU. */
void gpu_buffer_read(const gpu *g, const gpu_buffer *buffer, uint64_t offset, uint64_t size, void *out);
/* For writing as a storage block at `binding`, for reading as a buffer texture at GPU_FIRST_TEXEL_UNIT + binding; below
 * GPU_BINDINGS. */
void gpu_bind(const gpu *g, uint32_t binding, const gpu_buffer *buffer);
void gpu_bind_uniforms(const gpu *g, uint32_t binding, const gpu_buffer *buffer);

/* Programs from files of shaders/, #include lines resolved. *program is 0 on failure; the compiler's log went to the
 * host. */
typedef struct gpu_program_file {
	const char *file;
	uint32_t *program;
} gpu_program_file;

gi_result gpu_programs_compute(gpu *g, const gpu_program_file *files, size_t count);
gi_result gpu_program_draw(gpu *g, const char *vertex_file, const char *fragment_file, uint32_t *out);
void gpu_program_free(gpu *g, uint32_t *program);
/* All that there are, from their files as these are now. On failure they stay. */
gi_result gpu_programs_reload(gpu *g);

/* The same in two steps: a driver that compiles on threads of its own goes on while the host does something else. begin
 * hands over all sources, and fails for those that are not there; end waits, and fails, every time, for those that do
 * not compile. */
gi_result gpu_programs_begin(gpu *g, const gpu_program_file *files, size_t count);
gi_result gpu_programs_end(gpu *g, const gpu_program_file *files, size_t count);
void gpu_programs_free(gpu *g, const gpu_program_file *files, size_t count);
void gpu_set_uint(const gpu *g, uint32_t program, int location, uint32_t value);
void gpu_set_floats(const gpu *g, uint32_t program, int location, int components, int count, const float *values);
void gpu_set_matrices(const gpu *g, uint32_t program, int location, int count, const float *values);

/* One thread per item; nothing for no items. Ends with a barrier for what it wrote, whichever way it is read next: as a
 * storage block, a buffer texture, group counts or by a copy. */
void gpu_dispatch(gpu *g, uint32_t program, uint64_t threads);
void gpu_dispatch_groups(gpu *g, uint32_t program, uint64_t groups);
void gpu_dispatch_indirect(gpu *g, uint32_t program, const gpu_buffer *arguments, uint64_t offset);

/* Time between begin and end, a debug group too; timers do not nest. Without profile no time is taken. On a software
 * renderer they wait for the work, which runs on the same cores anyway. */
void gpu_timer_begin(gpu *g, gpu_timer *timer);
void gpu_timer_end(gpu *g, gpu_timer *timer);
/* Reads what is finished, or waits for all of it. */
void gpu_timer_poll(const gpu *g, gpu_timer *timer, bool wait);
void gpu_timer_free(const gpu *g, gpu_timer *timer);
/* What was measured under this tag, all of it together; 0 when none was, or it is not finished. */
float gpu_timer_ms(const gpu_timer *timer, uint64_t tag);
/* The newest tag that has a time; 0: none. */
uint64_t gpu_timer_newest(const gpu_timer *timer);

/* A small read-back that does not stall: copies into mapped memory behind a fence. */
enum { GPU_READBACK_RING = 4 };

typedef struct gpu_readback {
	gpu_buffer buffer;
	void *mapped;
	void *fence[GPU_READBACK_RING];
	uint64_t tag[GPU_READBACK_RING];
	uint32_t slot_bytes, next, oldest, pending;
} gpu_readback;

gi_result gpu_readback_create(gpu *g, gpu_readback *r, uint32_t bytes);
void gpu_readback_free(gpu *g, gpu_readback *r);
/* Queues a copy; the oldest unread one is dropped when the ring is full. */
void gpu_readback_queue(const gpu *g, gpu_readback *r, gpu_buffer *from, uint64_t tag);
/* Takes the oldest finished copy. False when none is; `wait` waits for the oldest queued one. */
bool gpu_readback_take(const gpu *g, gpu_readback *r, bool wait, void *out, uint64_t *tag);

void gpu_finish(const gpu *g);

#endif
