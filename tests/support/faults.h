/* Memory that runs out when a test says so, and is counted: the CPU's (the allocator that a context is given, and C++'s
 * new, which the linker wraps), and the GPU's (buffers, textures and their storage).
 */
#ifndef TESTS_FAULTS_H
#define TESTS_FAULTS_H

#include "gi/gi.h"

typedef enum fault_kind { FAULT_CPU, FAULT_GPU, FAULT_KINDS } fault_kind;

/* Both of the definition: an allocator, and its OpenGL with storage that may fail. */
void faults_in(gi_context_def *def);
gi_allocator faults_allocator(void);

/* What was asked of all these allocators. */
typedef struct faults_memory {
	int64_t blocks, bytes; /* that are not freed */
	uint64_t allocations;  /* ever, those that made a block larger or smaller too */
} faults_memory;

faults_memory faults_memory_now(void);

/* From now on the allocation number `first`, from 0, fails, and if `all` every one after it. */
void faults_begin(fault_kind kind, uint32_t first, bool all);

/* No more; how many failed. */
uint32_t faults_end(void);

#endif
