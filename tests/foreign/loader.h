/* A host's own OpenGL loader: of each kind one file. */
#ifndef FOREIGN_LOADER_H
#define FOREIGN_LOADER_H

#include <stdbool.h>

typedef void (*loader_function)(void);

extern const char *const loader_name;
bool loader_load(loader_function (*find)(const char *name));
bool loader_works(void);       /* does it reach the current context? */
void loader_poison(void);      /* whoever calls one of some functions that the library takes ends the program */
bool loader_is_poisoned(void); /* are they all still like that? */

#endif
