/* Pictures that a scene's file names, as textures of the scene: each is read once, however many materials name it. */
#ifndef ENGINE_IMPORT_PICTURE_H
#define ENGINE_IMPORT_PICTURE_H

#include "import_polygons.h"

/* Those of a file so far. Zeroed: none. */
typedef struct import_pictures {
	import_array read; /* private */
	uint64_t pixels, bytes;
	uint32_t looked_for;
} import_pictures;

/* The scene's texture of a PNG or JPEG beside or below the scene's file: its number and one; 0 with the reason in why,
 * "cannot be opened (No such file or directory)". name must live as long as the pictures.
 */
uint32_t import_find_picture(import_loader *loader, import_pictures *pictures, const char *name, engine_alpha alpha,
			     char *why, size_t why_size);

/* A texture with the colours of one (0: white) and the alpha of another, as large as the larger of both, so that a
 * picture can be cut out by it: its number and one; 0: too large, or out of memory. */
uint32_t import_combine_pictures(import_loader *loader, import_pictures *pictures, uint32_t color, uint32_t alpha);

void import_pictures_free(import_pictures *pictures);

#endif
