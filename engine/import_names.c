/* Names that are taken: a hash table with linear probing, so that a file of many objects of one name loads in linear
 * time.
 */
#include "import_build.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The slot that holds name, or the empty one where it would go. FNV-1a; the table is never full. */
static import_name *find(const import_names *names, const char *name)
{
	uint32_t hash = 2166136261u;
	for (const char *c = name; *c; c++)
		hash = (hash ^ (unsigned char)*c) * 16777619u;
	size_t slot = hash & (names->capacity - 1);
	while (names->slots[slot].name && strcmp(names->slots[slot].name, name) != 0)
		slot = (slot + 1) & (names->capacity - 1);
	return &names->slots[slot];
}

static bool is_taken(const import_names *names, const char *name)
{
	return names->capacity > 0 && find(names, name)->name;
}

/* At most half full. */
static bool make_room(import_names *names)
{
	if (2 * (names->count + 1) <= names->capacity)
		return true;
	import_names grown = {.capacity = names->capacity ? 2 * names->capacity : 64, .count = names->count};
	grown.slots = calloc(grown.capacity, sizeof *grown.slots);
	if (!grown.slots)
		return false;
	for (size_t i = 0; i < names->capacity; i++) {
		if (names->slots[i].name)
			*find(&grown, names->slots[i].name) = names->slots[i];
	}
	free(names->slots);
	*names = grown;
	return true;
}

char *import_unique_name(import_names *names, char *wish)
{
	if (!wish || !is_taken(names, wish))
		return wish;
	import_name *taken = find(names, wish);
	size_t size = strlen(wish) + 12;
	char *numbered = malloc(size);
	for (; numbered; taken->number++) {
		snprintf(numbered, size, "%s#%u", wish, taken->number);
		if (!is_taken(names, numbered))
			break;
	}
	free(wish);
	return numbered;
}

bool import_take_name(import_names *names, const char *name)
{
	if (!make_room(names))
		return false;
	*find(names, name) = (import_name){.name = name, .number = 2};
	names->count++;
	return true;
}
