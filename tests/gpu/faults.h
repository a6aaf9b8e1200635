/* Memory that runs out when a test says so: the CPU's (malloc, calloc, realloc and C++'s new, as the library calls
 * them: the linker wraps those), and the GPU's (buffers, textures and their storage).
 */
#ifndef TESTS_FAULTS_H
#define TESTS_FAULTS_H

#include "gi/gi.h"

typedef enum fault_kind {
	FAULT_CPU,
	FAULT_GPU,
	FAULT_KINDS
} fault_kind;

/* The definition's OpenGL with storage that may fail. */
void faults_in_gl(gi_context_def *def);

/* From now on the allocation number `first`, from 0, fails, and if `all` every one after it. */
void faults_begin(fault_kind kind, uint32_t first, bool all);

/* No more; how many failed. */
uint32_t faults_end(void);

#endif
