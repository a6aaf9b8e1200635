#include "arena.h"

#include "host_memory.h"

/* Of a line of a cache. */
static const size_t ALIGNMENT = 64;

void gi_arena_measure(gi_arena *a)
{
	a->used = 0;
	a->measuring = true;
}

bool gi_arena_reserve(gi_arena *a)
{
	const size_t wanted = a->used;
	a->used = 0;
	a->measuring = false;
	if (wanted <= a->capacity)
		return true;
	gi_arena_free(a);
	const size_t capacity = wanted + wanted / 8;
	a->memory = gi_malloc(capacity);
	a->capacity = a->memory ? capacity : 0;
	return a->memory;
}

void *gi_arena_take(gi_arena *a, size_t count, size_t size)
{
	char *taken = a->measuring ? NULL : a->memory + a->used;
	a->used += (count * size / ALIGNMENT + 1) * ALIGNMENT;
	return taken;
}

void gi_arena_free(gi_arena *a)
{
	gi_free(a->memory);
	*a = (gi_arena){0};
}
