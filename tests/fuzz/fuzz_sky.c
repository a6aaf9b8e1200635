/* A picture of the sky: Radiance's .hdr or a PFM, whichever its first bytes say. */
#include "fuzz_scene.h"

#include "engine/hdr.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static void require(bool holds, const char *what)
{
	if (holds)
		return;
	fprintf(stderr, "broken promise: %s\n", what);
	abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	char message[512] = "";
	int width = 0, height = 0;
	size_t mended = 0;
	float *rgb = NULL;
	fuzz_write("sky", bytes, size);
	if (!engine_panorama_read(fuzz_path("sky"), &width, &height, &rgb, &mended, message, sizeof message)) {
		require(!rgb && message[0] && !strchr(message, '\n'), "a refusal is a line, and leaves nothing");
		return 0;
	}
	require(width >= 1 && height >= 1 && width <= 32768 && height <= 32768, "sides are 1 to 32768 pixels");
	for (size_t k = 0; k < 3 * (size_t)width * (size_t)height; k++)
		require(rgb[k] >= 0 && rgb[k] <= 3e11f, "values are radiance");
	free(rgb);
	return 0;
}
