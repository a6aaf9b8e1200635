#include "host_memory.h"

#include "compiler.h"

#include <stdalign.h>
#include <stdlib.h>
#include <string.h>

/* Before every block; its size keeps the block aligned as it is itself. */
typedef struct header {
	alignas(max_align_t) gi_reallocate_fn *reallocate;
	gi_free_fn *free;
	void *user;
	size_t size; /* of all, bytes */
} header;

static void *system_allocate(size_t size, void *user)
{
	(void)user;
	return malloc(size);
}

static void *system_reallocate(void *memory, size_t old_size, size_t new_size, void *user)
{
	(void)old_size;
	(void)user;
	return realloc(memory, new_size);
}

static void system_free(void *memory, size_t size, void *user)
{
	(void)size;
	(void)user;
	free(memory);
}

static const gi_allocator system_allocator = {system_allocate, system_reallocate, system_free, NULL};
static GI_THREAD_LOCAL const gi_allocator *current;

const gi_allocator *gi_memory_from(const gi_allocator *allocator)
{
	const gi_allocator *before = current;
	current = allocator && allocator->allocate ? allocator : NULL;
	return before;
}

static void *begin_block(void *memory, size_t size, const gi_allocator *a)
{
	header *h = memory;
	if (!h)
		return NULL;
	*h = (header){a->reallocate, a->free, a->user, size};
	return h + 1;
}

void *gi_malloc(size_t size)
{
	const gi_allocator *a = current ? current : &system_allocator;
	if (size > SIZE_MAX - sizeof(header))
		return NULL;
	const size_t all = sizeof(header) + size;
	return begin_block(a->allocate(all, a->user), all, a);
}

void *gi_calloc(size_t count, size_t size)
{
	if (size && count > (SIZE_MAX - sizeof(header)) / size)
		return NULL;
	const size_t all = sizeof(header) + count * size;
	/* Pages that the system hands out are zero: calloc does not touch them. */
	if (!current)
		return begin_block(calloc(1, all), all, &system_allocator);
	void *memory = gi_malloc(count * size);
	return memory ? memset(memory, 0, count * size) : NULL;
}

void *gi_realloc(void *memory, size_t size)
{
	if (!memory)
		return gi_malloc(size);
	if (size > SIZE_MAX - sizeof(header))
		return NULL;
	header *h = (header *)memory - 1;
	const size_t all = sizeof *h + size;
	header *moved = h->reallocate(h, h->size, all, h->user);
	if (!moved)
		return NULL;
	moved->size = all;
	return moved + 1;
}

void gi_free(void *memory)
{
	if (!memory)
		return;
	header *h = (header *)memory - 1;
	h->free(h, h->size, h->user);
}

void *gi_copy(const void *from, size_t count, size_t size, bool *enough)
{
	void *made = from ? gi_malloc(count * size) : NULL;
	*enough = *enough && (!from || made);
	return made ? memcpy(made, from, count * size) : NULL;
}
