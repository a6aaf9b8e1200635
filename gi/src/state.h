/* The state (gi_state of gi_shared.h) in its buffer: members by name. */
#ifndef GI_STATE_H
#define GI_STATE_H

#include "gi_shared.h"
#include "gpu.h"

#include <stddef.h>

/* Where a member lies: for group counts, and to read one. */
#define STATE_OFFSET(member) offsetof(gi_state, member)

/* Sets a member, or a part with all its members, to 0. */
#define STATE_CLEAR(gi, member)                                                                                        \
	gpu_buffer_clear(&(gi)->gpu, &(gi)->state, STATE_OFFSET(member), sizeof(((gi_state *)0)->member), 0)

#endif
