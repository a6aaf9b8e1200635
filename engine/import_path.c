#define _XOPEN_SOURCE 700 /* realpath, fdopen, fseeko */
#define _FILE_OFFSET_BITS 64
#include "import_path.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* O_NONBLOCK: a FIFO opens at once instead of waiting for a writer, and is then found to be none of ours. */
FILE *import_open(const char *path, char *message, size_t message_size)
{
	struct stat about;
	int descriptor = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
	if (descriptor < 0 || fstat(descriptor, &about) != 0) {
		snprintf(message, message_size, "cannot be opened (%s)", strerror(errno));
	} else if (!S_ISREG(about.st_mode)) {
		snprintf(message, message_size, "is %s, not a file",
			 S_ISDIR(about.st_mode) ? "a folder" : "a pipe or a device");
	} else {
		FILE *file = fdopen(descriptor, "rb");
		if (file)
			return file;
		snprintf(message, message_size, "cannot be opened (%s)", strerror(errno));
	}
	if (descriptor >= 0)
		close(descriptor);
	return NULL;
}

/* The folder of a path with the slash behind it, malloc'd and with `name` behind that. "" where there is none. */
static char *join(const char *path, const char *name)
{
	const char *slash = strrchr(path, '/');
	size_t folder = slash ? (size_t)(slash - path) + 1 : 0, length = strlen(name);
	char *joined = malloc(folder + length + 1);
	if (!joined)
		return NULL;
	memcpy(joined, path, folder);
	memcpy(joined + folder, name, length + 1);
	return joined;
}

/* Whether `file` lies below `folder`; both as realpath() gives them. */
static bool lies_below(const char *folder, const char *file)
{
	size_t length = strlen(folder);
	return strncmp(folder, file, length) == 0 && (file[length] == '/' || folder[length - 1] == '/');
}

static FILE *open_if_below(const char *scene_path, const char *joined, char *message, size_t message_size)
{
	char *folder_name = join(scene_path, ".");
	char *folder = folder_name ? realpath(folder_name, NULL) : NULL;
	char *file = folder ? realpath(joined, NULL) : NULL;
	FILE *opened = NULL;
	if (!file)
		snprintf(message, message_size, "cannot be opened (%s)", strerror(errno));
	else if (!lies_below(folder, file))
		snprintf(message, message_size, "lies outside of the scene's folder and is not read");
	else
		opened = import_open(file, message, message_size);
	free(folder_name);
	free(folder);
	free(file);
	return opened;
}

/* As Windows writes paths, where there is no file with backslashes in its name. */
static void mend_slashes(char *joined, size_t folder)
{
	if (access(joined, F_OK) == 0)
		return;
	for (char *c = joined + folder; *c; c++)
		*c = *c == '\\' ? '/' : *c;
}

FILE *import_open_below(const char *scene_path, const char *name, char *message, size_t message_size)
{
	if (name[0] == '/') {
		snprintf(message, message_size, "is an absolute path; only files of the scene's folder are read");
		return NULL;
	}
	if (strstr(name, "://")) {
		snprintf(message, message_size, "lies elsewhere; only files of the scene's folder are read");
		return NULL;
	}
	char *joined = join(scene_path, name);
	if (!joined) {
		snprintf(message, message_size, "out of memory");
		return NULL;
	}
	mend_slashes(joined, strlen(joined) - strlen(name));
	FILE *file = open_if_below(scene_path, joined, message, message_size);
	free(joined);
	return file;
}

/* Bytes of an open file; 0 also for one that cannot tell. */
static uint64_t size_of(FILE *file)
{
	off_t end = fseeko(file, 0, SEEK_END) == 0 ? ftello(file) : 0;
	return end > 0 && fseeko(file, 0, SEEK_SET) == 0 ? (uint64_t)end : 0;
}

uint8_t *import_read_all(FILE *file, size_t limit, size_t *size, char *message, size_t message_size)
{
	*size = 0;
	if (!file)
		return NULL;
	uint64_t length = size_of(file);
	uint8_t *bytes = NULL;
	if (length == 0)
		snprintf(message, message_size, "is empty or cannot be read");
	else if (length > limit)
		snprintf(message, message_size, "has %llu bytes, at most %zu are read", (unsigned long long)length,
			 limit);
	else if (!(bytes = malloc((size_t)length + 1)))
		snprintf(message, message_size, "has %llu bytes, more than there is memory for",
			 (unsigned long long)length);
	if (bytes && fread(bytes, 1, (size_t)length, file) != length) {
		snprintf(message, message_size, "cannot be read to its end");
		free(bytes);
		bytes = NULL;
	}
	if (bytes) {
		bytes[length] = 0;
		*size = (size_t)length;
	}
	fclose(file);
	return bytes;
}

static int hex_digit(char c)
{
	if (c >= '0' && c <= '9')
		return c - '0';
	c |= 32;
	return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

bool import_unescape(char *name)
{
	char *to = name;
	for (const char *c = name; *c; c++, to++) {
		bool escaped = c[0] == '%' && hex_digit(c[1]) >= 0 && hex_digit(c[2]) >= 0;
		*to = escaped ? (char)(hex_digit(c[1]) * 16 + hex_digit(c[2])) : *c;
		if (*to == '\0')
			return false;
		c += escaped ? 2 : 0;
	}
	*to = '\0';
	return true;
}
