/* The programs of rows and solve, compiled when a scene takes them. Others are compiled when first wanted, by the
 * modules that run them. */
#ifndef GI_PROGRAMS_H
#define GI_PROGRAMS_H

#include "gi/gi.h"
#include "rows.h"

/* Hands the sources of a set to the driver, which may compile them on threads of its own; nothing for one that was
 * handed over. On failure none of it is. */
gi_result programs_begin(gi_context *gi, rows_set set);
/* Of what a commit of the objects there are will take: waits for it, and hands over first what nobody has. Fails, every
 * time, for those that do not compile. */
gi_result programs_for_commit(gi_context *gi);
/* The same of what the next update of the rows will take. */
gi_result programs_for_rows(gi_context *gi);
/* All that were handed over have been compiled, from their files as these are now. */
void programs_reloaded(gi_context *gi);
void programs_free(gi_context *gi);

#endif
