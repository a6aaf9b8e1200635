/* Opening the files of a scene: the one that the user names, and those that it names itself.
 *
 * A scene file may come from anywhere, so what it names (buffers, images, material libraries) is opened only where it
 * lies below the folder of the scene, links followed. Only regular files are opened: a FIFO would wait for a writer,
 * a device may never end.
 */
#ifndef ENGINE_IMPORT_PATH_H
#define ENGINE_IMPORT_PATH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Opens a regular file to read bytes from. NULL with the reason in message, without the path: "cannot be opened (No
 * such file or directory)".
 */
FILE *import_open(const char *path, char *message, size_t message_size);

/* Opens the file `name` beside or below the file scene_path; where there is none of that name, backslashes are slashes.
 * NULL with the reason in message for an absolute name, an address of another place (http://), one that leads out of
 * that folder (by "..", by a link), or what import_open() refuses.
 */
FILE *import_open_below(const char *scene_path, const char *name, char *message, size_t message_size);

/* The bytes of an open file from its start, and a zero after the last; the caller frees them. Closes the file, which
 * may be NULL. NULL with the reason in message (kept where file is NULL) for an empty file, one of more than `limit`
 * bytes, or lack of memory.
 */
uint8_t *import_read_all(FILE *file, size_t limit, size_t *size, char *message, size_t message_size);

/* Turns %20 and the like of an address back in place. False where that gives a zero byte. */
bool import_unescape(char *name);

#ifdef __cplusplus
}
#endif

#endif
