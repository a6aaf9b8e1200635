/* What the fuzz targets of the scene readers share: files in a temporary folder, and what must hold of what loads.
 *
 * A finding of libFuzzer is a crash, a sanitizer's report, a leak, a minute without an end or 2 GiB of memory; those of
 * these checks are crashes too.
 */
#ifndef TESTS_FUZZ_SCENE_H
#define TESTS_FUZZ_SCENE_H

#include <stddef.h>
#include <stdint.h>

/* Writes a file of that name into the folder; size 0 removes it. */
void fuzz_write(const char *name, const uint8_t *bytes, size_t size);

/* Where the file of that name is; until the next call. */
const char *fuzz_path(const char *name);

/* Loads the file of that name as a scene. Fails where it is refused without a line of its own, or where what loads is
 * not what engine/import_file.h promises.
 */
void fuzz_load(const char *name);

#endif
