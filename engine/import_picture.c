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

void import_pictures_free(import_pictures *pictures)
{
	free(pictures->read.items);
	*pictures = (import_pictures){0};
}
