#include "import_picture.h"

#include "import_path.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of one file; more are no scene's, and would be looked for, decoded and kept for too long. */
enum { MOST_NAMES = 1000 };
static const size_t MOST_PICTURE_BYTES = (size_t)1 << 28;
static const uint64_t MOST_PIXELS = (uint64_t)1 << 26, MOST_BYTES = (uint64_t)1 << 30;

typedef struct picture {
	const char *name;
	engine_alpha alpha;
	uint32_t texture; /* the scene's number and one; 0: it could not be read */
	char why[120];
} picture;

static void decode(import_loader *loader, import_pictures *pictures, const uint8_t *bytes, size_t size, picture *out)
{
	engine_texture texture;
	uint64_t pixels = 0;
	const char *fault = "";
	const bool read = engine_image_decode(bytes, size, &texture.pixels, texture.mean, &pixels, &fault);
	pictures->pixels += pixels;
	pictures->bytes += size;
	if (!read)
		snprintf(out->why, sizeof out->why, "%s", fault);
	else
		engine_texture_set_alpha(&texture, out->alpha);
	if (read && !import_add_texture(loader, &texture, &out->texture)) {
		out->texture = 0;
		snprintf(out->why, sizeof out->why, "there is no memory for it");
	}
}

static void read_picture(import_loader *loader, import_pictures *pictures, picture *out)
{
	size_t size = 0;
	if (pictures->pixels > MOST_PIXELS || pictures->bytes > MOST_BYTES || pictures->looked_for++ >= MOST_NAMES) {
		snprintf(out->why, sizeof out->why, "the images of the file are too many or too large");
		return;
	}
	FILE *file = import_open_below(loader->path, out->name, out->why, sizeof out->why);
	uint8_t *bytes = import_read_all(file, MOST_PICTURE_BYTES, &size, out->why, sizeof out->why);
	if (bytes)
		decode(loader, pictures, bytes, size, out);
	free(bytes);
}

uint32_t import_find_picture(import_loader *loader, import_pictures *pictures, const char *name, engine_alpha alpha,
			     char *why, size_t why_size)
{
	picture *all = pictures->read.items, *found = NULL;
	for (size_t k = 0; k < pictures->read.count && !found; k++)
		if (all[k].alpha == alpha && strcmp(all[k].name, name) == 0)
			found = &all[k];
	if (!found) {
		found = import_array_add(&pictures->read, sizeof *found);
		if (!found) {
			snprintf(why, why_size, "there is no memory for it");
			return 0;
		}
		*found = (picture){.name = name, .alpha = alpha};
		read_picture(loader, pictures, found);
	}
	snprintf(why, why_size, "%s", found->why);
	return found->texture;
}

static uint32_t larger(uint32_t a, uint32_t b)
{
	return a > b ? a : b;
}

/* The texel of a picture that lies where one of another size does. */
static const uint8_t *texel_at(const engine_image_pixels *p, const engine_image_pixels *of, uint32_t x, uint32_t y)
{
	const size_t column = (size_t)x * p->width / of->width, row = (size_t)y * p->height / of->height;
	return p->rgba + 4 * (row * p->width + column);
}

uint32_t import_combine_pictures(import_loader *loader, import_pictures *pictures, uint32_t color, uint32_t alpha)
{
	static const uint8_t white[3] = {255, 255, 255};
	const engine_texture *mask = &loader->scene->textures[alpha - 1];
	const engine_texture *from = color ? &loader->scene->textures[color - 1] : NULL;
	engine_texture out = {.mean = {1, 1, 1, mask->mean[3]}};
	engine_image_pixels *p = &out.pixels;
	uint32_t number = 0;
	p->width = larger(mask->pixels.width, from ? from->pixels.width : 0);
	p->height = larger(mask->pixels.height, from ? from->pixels.height : 0);
	pictures->pixels += (uint64_t)p->width * p->height;
	if (pictures->pixels > MOST_PIXELS)
		return 0;
	p->rgba = malloc(4 * (size_t)p->width * p->height);
	if (!p->rgba)
		return 0;
	for (uint32_t y = 0; y < p->height; y++)
		for (uint32_t x = 0; x < p->width; x++) {
			uint8_t *to = p->rgba + 4 * ((size_t)y * p->width + x);
			memcpy(to, from ? texel_at(&from->pixels, p, x, y) : white, 3);
			to[3] = texel_at(&mask->pixels, p, x, y)[3];
		}
	if (from)
		memcpy(out.mean, from->mean, 3 * sizeof *out.mean);
	return import_add_texture(loader, &out, &number) ? number : 0;
}

void import_pictures_free(import_pictures *pictures)
{
	free(pictures->read.items);
	*pictures = (import_pictures){0};
}
