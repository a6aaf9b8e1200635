/* What rows receive by way of mirrors and glass: entries that see one are followed to where the light comes from, and
 * have links for it (gi_shared.h). Nothing of it is there in a scene without mirrors and glass. */
#ifndef GI_SPECULAR_ROWS_H
#define GI_SPECULAR_ROWS_H

#include "buffers.h"
#include "gi/gi.h"
#include "gpu.h"

/* Programs in the place of those of the same names, for rows that may have such links. */
typedef struct gi_specular_rows {
	uint32_t close_program, gather_program, double_program, emitted_program; /* made first */
	uint32_t assess_program, survey_program;                                 /* by an update under a budget */
	uint32_t estimate_program;                                               /* where estimates are wanted */
	uint32_t list_program, path_program, tops_program;
	SPECULAR_BUFFERS(BUFFER_MEMBER)
} gi_specular_rows;

/* Before an update of the rows, behind specular_update(). part: under a budget. */
gi_result specular_rows_prepare(gi_context *gi, bool part);
/* Behind the visibility of entries, before rows are closed. In the time of that pass. */
void specular_rows_follow(gi_context *gi);
/* The program that closes rows. */
uint32_t specular_rows_close_program(const gi_context *gi);
/* An update of the rows ends: of some of them or all. */
void specular_rows_done(gi_context *gi, bool part);
/* May links through mirrors and glass bring what something emits, the sky's light or, where there are no photons, that
 * of any emitter? */
bool specular_rows_bring_exitance(const gi_context *gi);
/* May rows sum to more than 1, up to 2: where a mirror or glass shines or is not black, what it gives off and what is
 * seen in it count both? */
bool specular_rows_are_heavy(const gi_context *gi);
void specular_rows_free(gi_context *gi);

#endif
