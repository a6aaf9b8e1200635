/* The picture of the sky for shaders that look it up: paths, and what is seen in mirrors. */
#include "context.h"
#include "host_memory.h"
#include "sky.h"
#include "sky_image.h"

#include <string.h>

bool sky_shows_image(const gi_context *gi)
{
	return gi->sky.seen && gi->scene.slot_count && gi->scene.sky_slot != GI_NONE;
}

static void fill(const gi_sky_state *sky, gi_uvec4 *out)
{
	const sky_image *s = sky->seen;
	const size_t count = (size_t)s->width * s->height;
	double total = 0, running = 0;
	for (int pass = 0; pass < 2; pass++)
		for (size_t k = 0; k < count; k++) {
			float e[3];
			for (int c = 0; c < 3; c++)
				e[c] = s->texels[3 * k + c] + sky->seen_exitance[c];
			running += ((double)e[0] + e[1] + e[2]) * sky_image_texel_angle(s, (uint32_t)(k / s->width));
			if (pass == 0) {
				total = running;
				running = k + 1 < count ? running : 0;
				continue;
			}
			memcpy(&out[k], e, sizeof e);
			const double top = running / total * 0x1p32;
			out[k].w = k + 1 < count && top < UINT32_MAX ? (uint32_t)top : UINT32_MAX;
		}
}

gi_result sky_upload_texels(gi_context *gi)
{
	gi_sky_state *sky = &gi->sky;
	if (sky->uploaded || !sky->seen)
		return GI_OK;
	const size_t bytes = sizeof(gi_uvec4) * sky->seen->width * sky->seen->height;
	gi_uvec4 *texels = gi_malloc(bytes);
	if (!texels)
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	fill(sky, texels);
	const gi_result result = gpu_buffer_allocate(&gi->gpu, &sky->texels, buffer_labels.SKY_TEXELS, bytes, texels);
	sky->uploaded = !result;
	gi_free(texels);
	return result;
}

void sky_bind(const gi_context *gi, uint32_t program, int location)
{
	const gi_sky_state *owner = &gi->sky;
	const sky_image *s = owner->seen;
	const float size[3] = {(float)s->width, (float)s->height, 0};
	float rows[3][4]; /* of image_from_world */
	for (int r = 0; r < 3; r++) {
		for (int c = 0; c < 3; c++)
			rows[r][c] = (float)s->world_from_image[c][r];
		rows[r][3] = size[r];
	}
	SKY_BUFFERS(BUFFER_BIND)
	gpu_set_floats(&gi->gpu, program, location, 4, 3, rows[0]);
}
