/* The container of a glTF 2.0 file: JSON, buffers and accessors, every number checked before it is used.
 *
 * Why not assimp: Debian 12's 5.2.5 does not know KHR_materials_emissive_strength, plays STEP and CUBICSPLINE keys as
 * if they were linear, addresses animated nodes by name (glTF names need not be unique), and trusts offsets and counts
 * of the file. cJSON (MIT, one file, Debian's libcjson-dev) is what that needs and no more.
 */
#ifndef ENGINE_GLTF_DOCUMENT_H
#define ENGINE_GLTF_DOCUMENT_H

#include "import_build.h"

#include <cjson/cJSON.h>

/* The top-level arrays, as tables: cJSON's own arrays are lists. */
typedef enum gltf_array {
	GLTF_ACCESSORS,
	GLTF_ANIMATIONS,
	GLTF_BUFFERS,
	GLTF_BUFFER_VIEWS,
	GLTF_CAMERAS,
	GLTF_IMAGES,
	GLTF_MATERIALS,
	GLTF_MESHES,
	GLTF_NODES,
	GLTF_SCENES,
	GLTF_SKINS,
	GLTF_TEXTURES,
	GLTF_SAMPLERS,
	GLTF_ARRAYS
} gltf_array;

typedef struct gltf_table {
	const cJSON **items; /* objects */
	uint32_t count;
} gltf_table;

typedef struct gltf_buffer {
	uint8_t *bytes;
	size_t size;
	bool borrowed; /* points into the .glb */
} gltf_buffer;

/* A buffer view, held against its buffer. */
typedef struct gltf_view {
	const uint8_t *bytes; /* NULL: not all of it is there */
	size_t size, stride;  /* stride 0: elements follow each other */
} gltf_view;

/* An accessor, every number held against its buffer: elements i < count lie at bytes + i * stride. */
typedef struct gltf_accessor {
	const char *fault;    /* why it cannot be read; NULL: it can */
	const uint8_t *bytes; /* NULL: all zeros */
	size_t stride;
	uint32_t count, components; /* both >= 1 */
	int type;                   /* of a component */
	bool normalized;
	const uint8_t *sparse_numbers, *sparse_values; /* sparse_count rising element numbers, and what they become */
	uint32_t sparse_count;
	int sparse_type; /* of the numbers */
} gltf_accessor;

/* The mean of an image, decoded when first asked for. */
typedef struct gltf_image {
	bool tried, read;
	float mean[4];    /* r g b in linear light, alpha */
	uint32_t texture; /* the scene's number and one; 0: it was not read */
	char fault[128];  /* why it was not read */
} gltf_image;

typedef struct gltf_document {
	import_loader *loader;
	uint8_t *file; /* the whole file */
	size_t file_size;
	size_t bytes_read;     /* of the file and its buffers */
	const uint8_t *binary; /* BIN chunk of a .glb, or NULL */
	size_t binary_size;
	cJSON *root;
	gltf_table tables[GLTF_ARRAYS];
	gltf_buffer *buffers;     /* as many as tables[GLTF_BUFFERS] */
	gltf_view *views;         /* as many as tables[GLTF_BUFFER_VIEWS] */
	gltf_accessor *accessors; /* as many as tables[GLTF_ACCESSORS] */
	gltf_image *images;       /* as many as tables[GLTF_IMAGES] */
	const char **node_names; /* as many as tables[GLTF_NODES]; NULL: none. Here, for an object's members are a list,
				  * and a file may name one of very many members very often */
	int64_t *texture_images; /* as many as tables[GLTF_TEXTURES]; -1: none */
	uint64_t pixels_read;    /* of images */
	uint64_t floats_read;    /* of animations */
	uint32_t *materials;     /* by tables[GLTF_MATERIALS]: the scene's number and one; 0: not used so far */
	uint32_t *numbers;       /* of the vertices of the primitive being read */
	uint32_t *stamps;        /* which primitive gave a vertex its number */
	uint32_t stamp;
} gltf_document;

/* Reads the file, its buffers and where its accessors lie. Call gltf_close() whatever the result; failures are reported
 * to the loader.
 */
bool gltf_open(gltf_document *document, import_loader *loader);
void gltf_close(gltf_document *document);

/* A member, or NULL. object may be NULL. */
const cJSON *gltf_member(const cJSON *object, const char *key);

/* Text of a member, or NULL. */
const char *gltf_text(const cJSON *object, const char *key);

/* Of an object that may carry it, or NULL. */
const cJSON *gltf_extension(const cJSON *object, const char *name);

/* Number of an item of an array: -1 when the member is not there. False when it is no number of the array. */
bool gltf_index(const gltf_document *document, const cJSON *object, const char *key, gltf_array array, int64_t *index);

/* `count` numbers of an array member; left alone when it is not there. False, and all left alone, for anything else. */
bool gltf_numbers(const cJSON *object, const char *key, int count, double *numbers);

/* One number; left alone when not there. False for anything else but a finite number. */
bool gltf_number(const cJSON *object, const char *key, double *number);

/* A whole number below 2^32 that counts or places bytes; left alone when not there. */
bool gltf_size(const cJSON *object, const char *key, size_t *number);

/* The bytes of a file beside the scene, at most `limit`; the caller frees them. NULL with the reason in why. */
uint8_t *gltf_read_beside(const gltf_document *document, const char *uri, size_t limit, size_t *size, char *why,
			  size_t why_size);

/* The bytes of a data: address. NULL when it is not base64; the caller frees them. */
uint8_t *gltf_read_base64(const char *uri, size_t *size);

/* Fills document->views and document->accessors. False: out of memory. */
bool gltf_place_accessors(gltf_document *document);

/* The accessor of that number if it holds elements of so many components, else NULL with the reason in *fault. */
const gltf_accessor *gltf_find_accessor(const gltf_document *document, int64_t number, uint32_t components,
					const char **fault);

/* Element i as numbers: normalised integers become 0..1 or -1..1, other integers their value. */
void gltf_element(const gltf_accessor *accessor, uint32_t i, double *values);

/* All elements as floats, the caller's to free(). NULL: out of memory. */
float *gltf_floats(const gltf_accessor *accessor);

/* Corners, or floats of animations, that are made of a file of this size. */
uint64_t gltf_budget(const gltf_document *document);

#endif
