#define _GNU_SOURCE /* realpath, mkstemp */
#include "output.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool cannot_write(const char *path, char *message, size_t message_size)
{
	snprintf(message, message_size, "cannot write %s: %s", path, strerror(errno ? errno : EIO));
	return false;
}

/* ---- what is half written ---- */

static _Atomic(const char *) halves[8]; /* free of locks, as pointers are: read in handlers of signals */

static void replace_half(const char *from, const char *to)
{
	for (size_t k = 0; k < sizeof halves / sizeof *halves; k++) {
		const char *expected = from;
		if (atomic_compare_exchange_strong(&halves[k], &expected, to))
			return;
	}
}

void engine_output_half(const char *path)
{
	replace_half(NULL, path);
}

void engine_output_whole(const char *path)
{
	replace_half(path, NULL);
}

void engine_output_drop_halves(void)
{
	for (size_t k = 0; k < sizeof halves / sizeof *halves; k++) {
		const char *path = atomic_load(&halves[k]);
		if (path)
			unlink(path);
	}
}

/* ---- where ---- */

/* A file that standard output or error goes to is written in place, or what they write would be lost. */
static bool is_standard(const struct stat *status)
{
	for (int fd = STDOUT_FILENO; fd <= STDERR_FILENO; fd++) {
		struct stat standard;
		if (fstat(fd, &standard) == 0 && standard.st_dev == status->st_dev && standard.st_ino == status->st_ino)
			return true;
	}
	return false;
}

/* Is the path to be replaced, or written as it is? `mode`: of the file there, else 0. A link that leads nowhere is
 * written as it is. */
static bool is_replaced(const char *path, mode_t *mode)
{
	struct stat status;
	*mode = 0;
	if (stat(path, &status) != 0)
		return lstat(path, &status) != 0;
	*mode = status.st_mode & 07777;
	return S_ISREG(status.st_mode) && !is_standard(&status);
}

/* A name in the folder of `place`; however long the name there is, this one is short. */
static bool name_part(const char *place, char part[ENGINE_OUTPUT_PATH])
{
	const char *slash = strrchr(place, '/');
	const int folder = slash ? (int)(slash - place) + 1 : 0;
	const int length = snprintf(part, ENGINE_OUTPUT_PATH, "%.*s.partXXXXXX", folder, place);
	errno = ENAMETOOLONG;
	return length < ENGINE_OUTPUT_PATH;
}

static bool find_place(const char *path, char place[ENGINE_OUTPUT_PATH])
{
	char *real = realpath(path, NULL);
	const char *found = real ? real : path; /* not there yet */
	const bool fits = strlen(found) < ENGINE_OUTPUT_PATH;
	if (fits)
		strcpy(place, found);
	free(real);
	errno = ENAMETOOLONG;
	return fits;
}

/* mkstemp lets nobody else read; a file has the mode that was there, or that of any new one. */
static void set_mode(int fd, mode_t mode)
{
	if (!mode) {
		const mode_t mask = umask(0);
		umask(mask);
		mode = 0666 & ~mask;
	}
	(void)!fchmod(fd, mode); /* a file system without modes is fine */
}

static void remove_part(engine_output *o)
{
	if (o->part[0])
		unlink(o->part);
	engine_output_whole(o->part);
}

static bool open_part(engine_output *o, mode_t mode)
{
	if (!find_place(o->path, o->place) || !name_part(o->place, o->part)) {
		o->part[0] = '\0';
		return false;
	}
	engine_output_half(o->part);
	const int fd = mkstemp(o->part);
	if (fd < 0) {
		engine_output_whole(o->part);
		o->part[0] = '\0';
		return false;
	}
	set_mode(fd, mode);
	o->file = fdopen(fd, "wb");
	if (o->file)
		return true;
	close(fd);
	remove_part(o);
	return false;
}

/* ---- files ---- */

bool engine_output_open(engine_output *o, const char *path, char *message, size_t message_size)
{
	mode_t mode;
	*o = (engine_output){0};
	errno = 0;
	if (strlen(path) >= sizeof o->path) {
		errno = ENAMETOOLONG;
		return cannot_write(path, message, message_size);
	}
	strcpy(o->path, path);
	if (is_replaced(path, &mode))
		open_part(o, mode);
	else
		o->file = fopen(path, "wb");
	return o->file || cannot_write(path, message, message_size);
}

bool engine_output_close(engine_output *o, bool written, char *message, size_t message_size)
{
	const int before = ferror(o->file) ? errno : 0; /* of the write that went wrong */
	errno = 0;
	written = written && fflush(o->file) == 0 && !ferror(o->file);
	const int flushed = errno;
	if (fclose(o->file) != 0)
		written = false;
	errno = before ? before : flushed ? flushed : errno;
	if (written && o->part[0] && rename(o->part, o->place) != 0)
		written = false;
	if (written) {
		engine_output_whole(o->part);
		return true;
	}
	cannot_write(o->path, message, message_size);
	remove_part(o);
	return false;
}

bool engine_output_check(const char *path, char *message, size_t message_size)
{
	struct stat status;
	mode_t mode;
	errno = 0;
	if (is_replaced(path, &mode)) {
		engine_output trial;
		if (lstat(path, &status) != 0 && errno != ENOENT) /* a name that is too long, a folder that is a file */
			return cannot_write(path, message, message_size);
		if (!engine_output_open(&trial, path, message, message_size))
			return false;
		fclose(trial.file);
		remove_part(&trial);
		return true;
	}
	if (stat(path, &status) == 0 && S_ISDIR(status.st_mode))
		errno = EISDIR;
	else if (access(path, W_OK) == 0 || errno == ENOENT)
		return true;
	return cannot_write(path, message, message_size);
}

/* ---- lines ---- */

void engine_output_one_line(char *text)
{
	for (; *text; text++)
		if ((unsigned char)*text < ' ' || *text == 127)
			*text = ' ';
}

static const char *watching_program;

static void check_standard_output(void)
{
	errno = 0;
	const bool written = !ferror(stdout);
	if (fclose(stdout) == 0 && written)
		return;
	fprintf(stderr, "%s: cannot write to standard output: %s\n", watching_program, strerror(errno ? errno : EIO));
	_Exit(EXIT_FAILURE);
}

/* A standard stream that the program was started without: its number must not become a file's, or what is printed goes
 * there. Opened the wrong way round, it stays an error to use. */
static void fill_standard_streams(void)
{
	for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; fd++)
		if (fcntl(fd, F_GETFD) < 0)
			(void)!open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

void engine_output_watch(const char *program)
{
	fill_standard_streams();
	watching_program = program;
	signal(SIGXFSZ, SIG_IGN);
	atexit(check_standard_output);
}
