/* What a host's pictures are compared with. */
#include "host_room.h"

#include "image.h"

#include <math.h>
#include <stdio.h>

/* Radiance that is white, W/m2/sr. */
static const float WHITE = .5f;

static uint8_t srgb(float radiance)
{
	const float x = fminf(fmaxf(radiance / WHITE, 0), 1);
	return (uint8_t)lrintf(255 * (x <= .0031308f ? 12.92f * x : 1.055f * powf(x, 1 / 2.4f) - .055f));
}

static void write_picture(const char *prefix, const char *whose, int number, const float *picture)
{
	static uint8_t bytes[3 * HOST_PIXELS];
	char path[512], message[256];
	for (int y = 0; y < HOST_HEIGHT; y++)
		for (int x = 0; x < HOST_WIDTH; x++)
			for (int c = 0; c < 3; c++)
				bytes[3 * ((HOST_HEIGHT - 1 - y) * HOST_WIDTH + x) + c] =
				    srgb(picture[4 * (y * HOST_WIDTH + x) + c]);
	snprintf(path, sizeof path, "%s_%s_%d.png", prefix, whose, number);
	if (!engine_image_write_png(path, HOST_WIDTH, HOST_HEIGHT, bytes, message, sizeof message))
		fprintf(stderr, "%s\n", message);
}

/* Where a point of the floor is in the picture. */
static void pixel_of(float x, float z, int out[2])
{
	const float depth = 6 - z;
	out[0] = (int)((.5f + .5f * host_clip_from_view[0] * x / depth) * HOST_WIDTH);
	out[1] = (int)((.5f + .5f * host_clip_from_view[5] * -1.5f / depth) * HOST_HEIGHT);
}

/* Mean of red, green and blue over the floor in the shadow of the ball at 0. */
static double mean_in_shadow(const float *picture)
{
	int low[2], high[2], count = 0;
	double sum = 0;
	pixel_of(-1.45f, .35f, low);
	pixel_of(-1.05f, -.15f, high);
	for (int y = low[1]; y <= high[1]; y++)
		for (int x = low[0]; x <= high[0]; x++)
			for (int c = 0; c < 3; c++, count++)
				sum += (double)picture[4 * (y * HOST_WIDTH + x) + c];
	return sum / count;
}

static bool within_five(const char *what, double host, double gi)
{
	const double off = host / gi - 1;
	printf("%s: %.4f W/m2/sr, gi_draw %.4f: %+.2f %%\n", what, host, gi, 100 * off);
	return fabs(off) <= .05;
}

bool host_room_judge(const host_room *room, const char *prefix, float *const host[2], float *const gi[2],
		     double host_ms)
{
	double mean[2][2];
	for (int k = 0; k < 2; k++) {
		mean[0][k] = mean_in_shadow(host[k]);
		mean[1][k] = mean_in_shadow(gi[k]);
		write_picture(prefix, "host", k, host[k]);
		write_picture(prefix, "gi", k, gi[k]);
	}
	const bool dark = within_five("the floor below the ball", mean[0][0], mean[1][0]);
	const bool lit = within_five("when it has gone", mean[0][1], mean[1][1]);
	const bool change = within_five("the change", mean[0][1] - mean[0][0], mean[1][1] - mean[1][0]);
	printf("a frame: %.1f ms for the light, %.1f ms for the picture\n", room->update_ms / room->updates, host_ms);
	return dark && lit && change;
}
