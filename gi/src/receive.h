/* The light of receivers, from their rows (receiver_sets.h). */
#ifndef GI_RECEIVE_H
#define GI_RECEIVE_H

#include "buffers.h"
#include "gpu.h"
#include "receiver_sets.h"

/* Of receivers with normals and of those without; the same where there are lights without a surface. */
typedef enum receive_kind {
	RECEIVE_FACING,
	RECEIVE_ROUND,
	RECEIVE_FACING_LIT,
	RECEIVE_ROUND_LIT,
	RECEIVE_KINDS
} receive_kind;

typedef struct gi_receive {
	uint32_t programs[RECEIVE_KINDS];
	uint32_t facing; /* points with normals, which come first in the scene */
	bool round;      /* some see all round: rows are made by programs that know such */
	uint32_t factor_program, trace_program, tops_program;
	RECEIVER_BUFFERS(BUFFER_MEMBER) /* of all sets, one after the other */
	bool written;                   /* since the last commit */
} gi_receive;

/* Makes what the scene's receivers take, or lets go of it where there are none. */
gi_result receive_prepare(gi_context *gi);
/* In place of those of rows, where some receivers see all round. */
uint32_t receive_factor_program(const gi_context *gi);
uint32_t receive_trace_program(const gi_context *gi, bool tops);
/* After the solve. lights: how many without a surface are bound (punctual_bind). */
void receive_update(gi_context *gi, uint32_t lights);
void receive_invalidate(gi_context *gi); /* receivers have other places */
/* Where a set's light is; NULL: no update wrote it yet. */
const receiver_place *receive_place(const gi_context *gi, const receiver_set *set);
void receive_free(gi_context *gi);

#endif
