/* Libraries loaded at run time. */
#ifndef ENGINE_LIBRARY_H
#define ENGINE_LIBRARY_H

#include <stdbool.h>
#include <stddef.h>

/* One function of a library loaded at run time. */
typedef struct engine_symbol {
	const char *name;
	size_t offset; /* of the pointer in the table of functions */
} engine_symbol;

/* Opens the first library of the NULL-ended list that is there and fills the table's function pointers.
 * Returns false with a message that names the library, what_to_do in it, when the library or one of its functions is
 * missing. A library stays open until the process ends: drivers do not survive being unloaded.
 */
bool engine_library_load(const char *const *file_names, const engine_symbol *symbols, size_t symbol_count, void *table,
			 const char *what_to_do, char *message, size_t message_size);

#endif
