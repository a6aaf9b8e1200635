/* Memory of the CPU, which the host gives (gi_allocator). A public function says whose it is for as long as it runs:
 *
 *     const gi_allocator *before = gi_memory_from(&gi->def.allocator);
 *     ... gi_malloc() and all that calls it ...
 *     gi_memory_from(before);
 *
 * Each block knows its allocator: it is freed by that one, whoever frees it, on whichever thread. Nothing else of the
 * library calls malloc; OpenSubdiv and the C library's own functions do.
 */
#ifndef GI_HOST_MEMORY_H
#define GI_HOST_MEMORY_H

#include "gi/gi.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Where this thread's blocks come from now; NULL, as at first, or one of no functions: malloc. What it was before. */
const gi_allocator *gi_memory_from(const gi_allocator *allocator);

/* As malloc, calloc, realloc and free, aligned for any standard type; of no bytes too. */
void *gi_malloc(size_t size);
void *gi_calloc(size_t count, size_t size);
void *gi_realloc(void *memory, size_t size);
void gi_free(void *memory);

/* Another block with the same `count` things of `size` bytes; NULL of NULL. Where there is no memory *enough becomes
 * false, and NULL comes. */
void *gi_copy(const void *from, size_t count, size_t size, bool *enough);

#ifdef __cplusplus
}
#endif

#endif
