/* A glTF file of a hall with hundreds of things that stay where they are, nodes of one mesh, and one that is
 * animated. */
#ifndef TESTS_FURNISHED_FILE_H
#define TESTS_FURNISHED_FILE_H

#include <stdbool.h>
#include <stddef.h>

enum { FURNISHED_SIDE = 12, FURNISHED_THINGS = FURNISHED_SIDE * FURNISHED_SIDE };

/* Writes hall.gltf and hall.bin into a folder; false when that failed. */
bool furnished_file_write(const char *folder, char *path, size_t path_size);
/* The files and the folder. */
void furnished_file_remove(const char *folder);

#endif
