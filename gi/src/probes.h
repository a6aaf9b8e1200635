/* Grids of probes: receivers that see all round, and what each has near it, so that a place is lit by those that see it
 * (gi_probe.glsl). */
#ifndef GI_PROBES_H
#define GI_PROBES_H

#include "buffers.h"
#include "gpu.h"

typedef struct gi_probes {
	uint32_t program;
	PROBE_BUFFERS(BUFFER_MEMBER) /* of all grids, one after the other */
	bool stale;                  /* a commit gave them other places, or they are new */
} gi_probes;

/* Makes what the scene's grids take, or lets go of it where there are none. */
gi_result probes_prepare(gi_context *gi);
/* After the rows of an update: probes ask again what is near them, where something moved. */
void probes_update(gi_context *gi);
void probes_invalidate(gi_context *gi); /* after a commit */
void probes_free(gi_context *gi);

#endif
