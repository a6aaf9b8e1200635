/* The container of a glTF 2.0 file: JSON, buffers and accessors, every number checked before it is used.
 *
 * Why not assimp, which reads OBJ and PLY here: Debian 12's 5.2.5 does not know KHR_materials_emissive_strength, plays
 * STEP and CUBICSPLINE keys as if they were linear, addresses animated nodes by name (glTF names need not be unique),
 * and trusts offsets and counts of the file. cJSON (MIT, one file, Debian's libcjson-dev) is what that needs and no
 * more.
 */
#ifndef ENGINE_GLTF_DOCUMENT_H
#define ENGINE_GLTF_DOCUMENT_H

#include "scene_internal.h"

#include <cjson/cJSON.h>

/* The top-level arrays, as tables: cJSON's own arrays are lists. */
typedef enum gltf_array {
	GLTF_ACCESSORS,
	GLTF_ANIMATIONS,
	GLTF_BUFFERS,
	GLTF_BUFFER_VIEWS,
	GLTF_CAMERAS,
	GLTF_MATERIALS,
	GLTF_MESHES,
	GLTF_NODES,
	GLTF_SCENES,
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

typedef struct gltf_document {
	scene_loader *loader;
	uint8_t *file; /* the whole file */
	size_t file_size;
	const uint8_t *binary; /* BIN chunk of a .glb, or NULL */
	size_t binary_size;
	cJSON *root;
	gltf_table tables[GLTF_ARRAYS];
	gltf_buffer *buffers; /* as many as tables[GLTF_BUFFERS] */
} gltf_document;

/* Reads the file and its buffers. Call gltf_close() whatever the result; failures are reported to the loader. */
bool gltf_open(gltf_document *document, scene_loader *loader);
void gltf_close(gltf_document *document);

/* A member, or NULL. object may be NULL. */
const cJSON *gltf_member(const cJSON *object, const char *key);

/* Text of a member, or NULL. */
const char *gltf_text(const cJSON *object, const char *key);

/* Number of an item of an array: -1 when the member is not there. False (reported) when it is no number of the array.
 */
bool gltf_index(gltf_document *document, const cJSON *object, const char *key, gltf_array array, int64_t *index);

/* `count` numbers of an array member; left alone when it is not there. False (reported) for anything else. */
bool gltf_numbers(gltf_document *document, const cJSON *object, const char *key, int count, double *numbers);

/* One number; left alone when not there. */
bool gltf_number(gltf_document *document, const cJSON *object, const char *key, double *number);

/* Reads an accessor of `components` (1, 3 or 4) as floats; normalised integers become 0..1 or -1..1, other integers
 * their value. *values is the caller's to free().
 */
bool gltf_floats(gltf_document *document, int64_t accessor, uint32_t components, float **values, uint32_t *count);

/* Reads a scalar accessor of unsigned integers. */
bool gltf_indices(gltf_document *document, int64_t accessor, uint32_t **values, uint32_t *count);

#endif
