/* Images of a glTF file, decoded once each when a material asks for them. */
#include "gltf_scene.h"
#include "image_mean.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_IMAGE_BYTES = 1 << 28 };

/* Of all images of a file: what decoding takes a few seconds for. */
#define MAX_ALL_PIXELS ((uint64_t)1 << 26)

static bool decode(gltf_document *document, const uint8_t *bytes, size_t size, gltf_image *image)
{
	uint64_t pixels = 0;
	const char *fault = "the images of the file have too many pixels";
	engine_texture texture;
	bool read = document->pixels_read <= MAX_ALL_PIXELS &&
		    engine_image_decode(bytes, size, &texture.pixels, texture.mean, &pixels, &fault);
	if (read) {
		memcpy(image->mean, texture.mean, sizeof image->mean);
		read = import_add_texture(document->loader, &texture, &image->texture);
	}
	snprintf(image->fault, sizeof image->fault, "%s", fault);
	document->pixels_read += pixels;
	return read;
}

static void read_image(gltf_document *document, const cJSON *from, gltf_image *image)
{
	const char *uri = gltf_text(from, "uri");
	int64_t number = -1;
	size_t size = 0;
	snprintf(image->fault, sizeof image->fault, "an image has no bytes");
	if (!uri) {
		bool found = gltf_index(document, from, "bufferView", GLTF_BUFFER_VIEWS, &number) && number >= 0;
		const gltf_view *view = found ? &document->views[number] : NULL;
		image->read = view && view->bytes && decode(document, view->bytes, view->size, image);
		return;
	}
	bool inside = strncmp(uri, "data:", 5) == 0;
	uint8_t *bytes =
	    inside ? gltf_read_base64(uri, &size)
		   : gltf_read_beside(document, uri, MAX_IMAGE_BYTES, &size, image->fault, sizeof image->fault);
	image->read = bytes && decode(document, bytes, size, image);
	free(bytes);
}

bool gltf_image_texture(gltf_document *document, int64_t number, uint32_t *texture, float mean[4], const char **fault)
{
	gltf_image *image = &document->images[number];
	if (!image->tried)
		read_image(document, document->tables[GLTF_IMAGES].items[number], image);
	image->tried = true;
	*fault = image->fault;
	memcpy(mean, image->mean, sizeof image->mean);
	*texture = image->texture;
	return image->read;
}
