/* A PNG or JPEG as a texture: decoded, its alpha chosen, and means taken over triangles that the first bytes place. */
#include "fuzz_scene.h"

#include "engine/texture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

enum { HEAD = 8 };

static void require(bool holds, const char *what)
{
	if (holds)
		return;
	fprintf(stderr, "broken promise: %s\n", what);
	abort();
}

static void check_mean(const float mean[4])
{
	for (int c = 0; c < 4; c++)
		require(mean[c] >= 0 && mean[c] <= 1.0001f, "means are 0 to 1");
}

/* Coordinates up to 32 pictures away, some of them equal. */
static void check_triangle(const engine_texture *texture, const uint8_t *head)
{
	engine_texture_use use = engine_texture_use_of(1);
	float uvs[3][2], mean[4];
	for (int k = 0; k < 6; k++)
		uvs[k / 2][k % 2] = (float)(int8_t)head[k] / (head[6] & 4 ? 64.0f : 4.0f);
	use.wrap[0] = (engine_wrap)(head[6] % 3);
	use.wrap[1] = (engine_wrap)(head[7] % 3);
	engine_texture_mean(texture, &use, uvs, mean);
	check_mean(mean);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	engine_texture texture;
	uint64_t pixels = 0;
	const char *fault = NULL;
	if (size < HEAD)
		return 0;
	if (!engine_image_decode(bytes + HEAD, size - HEAD, &texture.pixels, texture.mean, &pixels, &fault)) {
		require(fault && !texture.pixels.rgba, "a refusal says why, and leaves nothing");
		return 0;
	}
	require((uint64_t)texture.pixels.width * texture.pixels.height == pixels, "pixels are counted");
	check_mean(texture.mean);
	check_triangle(&texture, bytes);
	engine_texture_set_alpha(&texture, (engine_alpha)(bytes[7] % (ENGINE_ALPHA_MASK + 1)));
	check_mean(texture.mean);
	check_triangle(&texture, bytes);
	free(texture.pixels.rgba);
	return 0;
}
