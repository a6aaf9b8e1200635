/* The GPU's buffers (shaders/buffer_list.h) for C: numbers of bindings, members, labels. A structure with buffers of
 * a list declares them by LIST(BUFFER_MEMBER), its owner binds them by LIST(BUFFER_BIND), and so on. */
#ifndef GI_BUFFERS_H
#define GI_BUFFERS_H

#include "buffer_list.h"

#define BUFFER_NUMBER(place, name, ...) GI_BIND_##name = place,
enum { BOUND_BUFFERS(BUFFER_NUMBER) };
#undef BUFFER_NUMBER

#define BUFFER_PLACE(place, name, ...) GI_BIND_##name = GI_BIND_##place,
enum { PLACED_BUFFERS(BUFFER_PLACE) };
#undef BUFFER_PLACE

#define BUFFER_ONE(...) +1
enum { GI_BIND_COUNT = 0 BOUND_BUFFERS(BUFFER_ONE) };
#undef BUFFER_ONE

#define BUFFER_CHECK(place, ...) _Static_assert((place) < GI_BIND_COUNT, "bindings are numbered without a gap");
BOUND_BUFFERS(BUFFER_CHECK)
#undef BUFFER_CHECK

/* What debuggers call them: buffer_labels.NAME. */
#define BUFFER_LABEL(place, name, ...) const char *name;
typedef struct gi_buffer_labels {
	BOUND_BUFFERS(BUFFER_LABEL)
	PLACED_BUFFERS(BUFFER_LABEL)
} gi_buffer_labels;
#undef BUFFER_LABEL
extern const gi_buffer_labels buffer_labels;
/* Of the buffer that has a binding of its own. */
const char *buffer_bound_label(unsigned binding);

#define BUFFER_MEMBER(place, name, member, ...) gpu_buffer member;

/* In a function with gi, and with the structure that has them as `owner`. */
#define BUFFER_BIND(place, name, member, ...) gpu_bind(&gi->gpu, GI_BIND_##name, &owner->member);
#define BUFFER_FREE(place, name, member, ...) gpu_buffer_free(&gi->gpu, &owner->member);
#define BUFFER_RETIRE(place, name, member, ...) gpu_buffer_retire(&gi->gpu, &owner->member, GI_BIND_##name);
#define BUFFER_FORGET(place, name, member, ...) owner->member = (gpu_buffer){0};

#endif
