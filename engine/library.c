#define _POSIX_C_SOURCE 200809L
#include "library.h"

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

static void *open_first(const char *const *file_names)
{
	void *library = NULL;
	for (int i = 0; file_names[i] && !library; i++)
		library = dlopen(file_names[i], RTLD_NOW | RTLD_LOCAL);
	return library;
}

bool engine_library_load(const char *const *file_names, const engine_symbol *symbols, size_t symbol_count, void *table,
			 const char *what_to_do, char *message, size_t message_size)
{
	void *library = open_first(file_names);
	if (!library) {
		snprintf(message, message_size, "%s cannot be loaded; %s", file_names[0], what_to_do);
		return false;
	}
	for (size_t i = 0; i < symbol_count; i++) {
		void *function = dlsym(library, symbols[i].name);
		if (!function) {
			snprintf(message, message_size, "%s lacks %s; %s", file_names[0], symbols[i].name, what_to_do);
			return false;
		}
		memcpy((char *)table + symbols[i].offset, &function, sizeof function);
	}
	return true;
}
