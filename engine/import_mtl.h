/* Material libraries (.mtl) of OBJ files: Kd is the reflectance, Ke the radiance; what has no place in a scene of matt
 * surfaces is marked, so that the reader of the OBJ can say so of what is used.
 */
#ifndef ENGINE_IMPORT_MTL_H
#define ENGINE_IMPORT_MTL_H

#include "import_polygons.h"

/* Reflectance of a material without Kd. */
#define MTL_RHO 0.6f

/* What a scene of matt, opaque surfaces cannot show. */
typedef enum mtl_unread {
	MTL_TRANSPARENT,     /* d below 1, Tr above 0 */
	MTL_MIRROR,          /* illum 3 to 9, Pm above 0, or Ks without Kd */
	MTL_TEXTURE_OPTIONS, /* those of textures that turn, stretch or recolour them */
	MTL_UNREAD_KINDS,
} mtl_unread;

typedef enum mtl_texture_kind {
	MTL_DIFFUSE,  /* map_Kd */
	MTL_EMISSION, /* map_Ke */
	MTL_OPACITY,  /* map_d */
	MTL_TEXTURES,
} mtl_texture_kind;

typedef struct mtl_texture {
	char *file;                /* NULL: none */
	float scale[2], offset[2]; /* -s, -o: texture coordinates are times scale, plus offset */
	bool clamp;                /* -clamp on: it does not repeat */
	engine_alpha alpha;        /* -imfchan, of MTL_OPACITY */
} mtl_texture;

typedef struct mtl_material {
	char *name;
	uint32_t order; /* of its newmtl line among all */
	float rho[3], radiance[3];
	bool has_rho, has_radiance; /* Kd, Ke are given */
	bool shines;                /* Ks is above 0 */
	uint32_t unread;            /* bits 1 << mtl_unread */
	mtl_texture textures[MTL_TEXTURES];
} mtl_material;

/* What the libraries of a file say. Zeroed: nothing yet. */
typedef struct mtl_materials {
	import_array items; /* mtl_material */
} mtl_materials;

/* Adds the materials of a library, whose text is parsed in place. Lines that are broken are noted and passed over.
 * False: out of memory.
 */
bool mtl_read(mtl_materials *materials, import_loader *loader, const char *name, uint8_t *bytes, size_t size);

/* Sorts by name, of equal names keeps the last, so that mtl_find() finds; once, after the last mtl_read(). */
void mtl_sort(mtl_materials *materials);

/* The material of that name, or NULL. */
const mtl_material *mtl_find(const mtl_materials *materials, const char *name);

void mtl_free(mtl_materials *materials);

#endif
