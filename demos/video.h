/* A film of pictures, made by the program ffmpeg where that is installed: pictures go to it through a pipe. */
#ifndef DEMOS_VIDEO_H
#define DEMOS_VIDEO_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

typedef struct video {
	const char *path; /* NULL: there is none */
	int pipe;
	pid_t encoder;
	size_t frame_bytes;
} video;

/* Is there a ffmpeg to ask? False with one line in message. */
bool video_check(char *message, size_t message_size);

/* Begins a film; what kind is the ending of its name (mp4, webm, gif ...). path must stay where it is until
 * video_close. False with one line in message. */
bool video_open(video *v, const char *path, int width, int height, double frames_a_second, char *message,
		size_t message_size);

/* RGB, 8 bits a channel, rows from the top. */
bool video_write(video *v, const uint8_t *pixels, char *message, size_t message_size);

/* Ends it; without `whole` the file is removed. Does nothing where none is open. */
bool video_close(video *v, bool whole, char *message, size_t message_size);

#endif
