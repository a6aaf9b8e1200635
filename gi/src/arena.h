/* Memory of many arrays that come and go together: one block, which is kept for the next ones. New memory is what costs
 * most of a commit: the system hands it out in pages, one by one as they are first touched.
 *
 *     gi_arena_measure(&a);  lay_out(&a);   (takes give NULL)
 *     if (gi_arena_reserve(&a))  lay_out(&a);
 */
#ifndef GI_ARENA_H
#define GI_ARENA_H

#include <stdbool.h>
#include <stddef.h>

typedef struct gi_arena {
	char *memory;
	size_t capacity, used; /* bytes */
	bool measuring;
} gi_arena;

/* Begins a count: until gi_arena_reserve what is taken is only added up. */
void gi_arena_measure(gi_arena *arena);

/* Makes the block as large as was counted: what is taken now lies in it, what was taken before is gone. False: out of
 * memory, there is no block. */
bool gi_arena_reserve(gi_arena *arena);

/* The next part of the block, not cleared; a part of no bytes is one too. NULL while counting. */
void *gi_arena_take(gi_arena *arena, size_t count, size_t size);

void gi_arena_free(gi_arena *arena);

#endif
