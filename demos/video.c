#define _POSIX_C_SOURCE 200809L
#include "video.h"

#include "output.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

static bool failed(char *message, size_t message_size, const char *what, int code)
{
	snprintf(message, message_size, "%s: %s", what, strerror(code));
	return false;
}

/* Runs ffmpeg with its standard input from a file descriptor, -1: nothing. Returns an errno. */
static int run(char *const arguments[], int input, pid_t *out)
{
	posix_spawn_file_actions_t files;
	int code = posix_spawn_file_actions_init(&files);
	if (code)
		return code;
	code = input >= 0 ? posix_spawn_file_actions_adddup2(&files, input, STDIN_FILENO)
			  : posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
	if (!code)
		code = posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
	if (!code)
		code = posix_spawnp(out, arguments[0], &files, NULL, arguments, environ);
	posix_spawn_file_actions_destroy(&files);
	return code;
}

/* Its exit code; -1: it did not end by itself. */
static int wait_for(pid_t process)
{
	int status = 0;
	while (waitpid(process, &status, 0) < 0)
		if (errno != EINTR)
			return -1;
	return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

bool video_check(char *message, size_t message_size)
{
	char *const arguments[] = {"ffmpeg", "-loglevel", "quiet", "-version", NULL};
	pid_t process;
	if (run(arguments, -1, &process) == 0 && wait_for(process) == 0)
		return true;
	snprintf(message, message_size,
		 "--video needs the program ffmpeg, which is not installed: install it, or write --images");
	return false;
}

/* Sides and pixels as players of films take them: even, 4:2:0; a row or column is left out where they are odd. */
static char fit[] = "crop=trunc(iw/2)*2:trunc(ih/2)*2,format=pix_fmts=yuv420p|bgr8";

static int start_encoder(video *v, int input, int width, int height, double frames_a_second)
{
	char size[32], rate[32], path[ENGINE_OUTPUT_PATH + 8];
	snprintf(size, sizeof size, "%dx%d", width, height);
	snprintf(rate, sizeof rate, "%g", frames_a_second);
	snprintf(path, sizeof path, "file:%s", v->path);
	char *const arguments[] = {"ffmpeg", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", size,
				   "-r",     rate,        "-i",    "-",  "-vf",      fit,        "-y",    path, NULL};
	return run(arguments, input, &v->encoder);
}

bool video_open(video *v, const char *path, int width, int height, double frames_a_second, char *message,
		size_t message_size)
{
	int ends[2];
	if (pipe(ends) != 0)
		return failed(message, message_size, "cannot make a pipe to ffmpeg", errno);
	*v = (video){path, ends[1], 0, 3 * (size_t)width * (size_t)height};
	/* The encoder must not hold the end that says that there is no more. */
	fcntl(ends[1], F_SETFD, FD_CLOEXEC);
	const int code = start_encoder(v, ends[0], width, height, frames_a_second);
	close(ends[0]);
	if (code) {
		close(ends[1]);
		*v = (video){0};
		return failed(message, message_size, "cannot start ffmpeg", code);
	}
	signal(SIGPIPE, SIG_IGN); /* where it ends too early, writing says so */
	engine_output_half(path);
	return true;
}

bool video_write(video *v, const uint8_t *pixels, char *message, size_t message_size)
{
	for (size_t done = 0; done < v->frame_bytes;) {
		const ssize_t written = write(v->pipe, pixels + done, v->frame_bytes - done);
		if (written < 0 && errno != EINTR) {
			snprintf(message, message_size, "ffmpeg cannot write %.500s: see its lines above", v->path);
			return false;
		}
		done += written > 0 ? (size_t)written : 0;
	}
	return true;
}

bool video_close(video *v, bool whole, char *message, size_t message_size)
{
	if (!v->path)
		return true;
	close(v->pipe);
	const bool written = wait_for(v->encoder) == 0;
	if (!written && whole)
		snprintf(message, message_size, "ffmpeg cannot write %.500s: see its lines above", v->path);
	if (!written || !whole)
		remove(v->path);
	engine_output_whole(v->path);
	*v = (video){0};
	return written || !whole;
}
