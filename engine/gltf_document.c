#include "gltf_document.h"
#include "import_path.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { GLB_MAGIC = 0x46546c67, GLB_JSON = 0x4e4f534a, GLB_BIN = 0x004e4942 };
#define MAX_FILE_SIZE ((size_t)4 << 30) /* a .glb counts its bytes in 32 bits */

static const char *const array_names[GLTF_ARRAYS] = {"accessors", "animations", "buffers", "bufferViews", "cameras",
						     "images",    "materials",  "meshes",  "nodes",       "scenes",
						     "skins",     "textures",   "samplers"};

/* ---- members ----------------------------------------------------------------------------------------------------- */

const cJSON *gltf_member(const cJSON *object, const char *key)
{
	return cJSON_GetObjectItemCaseSensitive(object, key);
}

const char *gltf_text(const cJSON *object, const char *key)
{
	return cJSON_GetStringValue(gltf_member(object, key));
}

const cJSON *gltf_extension(const cJSON *object, const char *name)
{
	return gltf_member(gltf_member(object, "extensions"), name);
}

/* A whole number of 0..limit - 1. */
static bool whole_number(const cJSON *item, double limit, double *value)
{
	*value = cJSON_IsNumber(item) ? item->valuedouble : -1;
	return *value >= 0 && *value < limit && *value == floor(*value);
}

bool gltf_index(const gltf_document *document, const cJSON *object, const char *key, gltf_array array, int64_t *index)
{
	const cJSON *item = gltf_member(object, key);
	double value = -1;
	if (item && !whole_number(item, document->tables[array].count, &value))
		return false;
	*index = (int64_t)value;
	return true;
}

bool gltf_numbers(const cJSON *object, const char *key, int count, double *numbers)
{
	const cJSON *array = gltf_member(object, key), *item;
	double read[16];
	int i = 0;
	if (!array)
		return true;
	if (!cJSON_IsArray(array))
		return false;
	cJSON_ArrayForEach(item, array)
	{
		if (i == count || !cJSON_IsNumber(item) || !isfinite(item->valuedouble))
			return false;
		read[i++] = item->valuedouble;
	}
	if (i == count)
		memcpy(numbers, read, (size_t)count * sizeof *read);
	return i == count;
}

bool gltf_number(const cJSON *object, const char *key, double *number)
{
	const cJSON *item = gltf_member(object, key);
	if (!item)
		return true;
	if (!cJSON_IsNumber(item) || !isfinite(item->valuedouble))
		return false;
	*number = item->valuedouble;
	return true;
}

bool gltf_size(const cJSON *object, const char *key, size_t *number)
{
	const cJSON *item = gltf_member(object, key);
	double value = (double)*number;
	if (item && !whole_number(item, (double)MAX_FILE_SIZE, &value))
		return false;
	*number = (size_t)value;
	return true;
}

/* ---- buffers ----------------------------------------------------------------------------------------------------- */

static int base64_digit(char c)
{
	if (c >= 'A' && c <= 'Z')
		return c - 'A';
	if (c >= 'a' && c <= 'z')
		return c - 'a' + 26;
	if (c >= '0' && c <= '9')
		return c - '0' + 52;
	return c == '+' ? 62 : c == '/' ? 63 : -1;
}

uint8_t *gltf_read_base64(const char *uri, size_t *size)
{
	const char *text = strstr(uri, ";base64,");
	size_t length = text ? strcspn(text += 8, "=") : 0, bytes = 0;
	uint8_t *out = text ? malloc(length / 4 * 3 + 4) : NULL;
	uint32_t bits = 0;
	for (size_t i = 0; out && i < length; i++) {
		int digit = base64_digit(text[i]);
		if (digit < 0) {
			free(out);
			return NULL;
		}
		bits = bits << 6 | (uint32_t)digit;
		if (i % 4 == 0)
			continue; /* six bits are no byte yet; later ones give 4 + 2 left over, then 2 + 4, then 0 */
		out[bytes++] = (uint8_t)(bits >> (6 - 2 * (i % 4)));
	}
	*size = bytes;
	return out;
}

uint8_t *gltf_read_beside(const gltf_document *document, const char *uri, size_t limit, size_t *size, char *why,
			  size_t why_size)
{
	uint8_t *bytes = NULL;
	char *name = strdup(uri);
	snprintf(why, why_size, name ? "has a zero byte in its name" : "is more than there is memory for");
	if (name && import_unescape(name)) {
		FILE *file = import_open_below(document->loader->path, name, why, why_size);
		bytes = import_read_all(file, limit, size, why, why_size);
	}
	free(name);
	return bytes;
}

/* A file's only buffer costs the file; one of several, what it holds: *stated becomes 0. False: reported. */
static bool read_uri(gltf_document *document, gltf_buffer *buffer, const char *uri, size_t *stated)
{
	char why[128] = "is not base64";
	bool inside = strncmp(uri, "data:", 5) == 0;
	buffer->bytes = inside ? gltf_read_base64(uri, &buffer->size)
			       : gltf_read_beside(document, uri, MAX_FILE_SIZE, &buffer->size, why, sizeof why);
	if (buffer->bytes)
		return true;
	if (document->tables[GLTF_BUFFERS].count == 1)
		return import_fail(document->loader, "its buffer \"%.200s\" %s", uri, why);
	import_note(document->loader, uri, "a buffer %s", why);
	*stated = 0;
	return true;
}

static bool read_buffer(gltf_document *document, uint32_t number)
{
	const cJSON *object = document->tables[GLTF_BUFFERS].items[number];
	gltf_buffer *buffer = &document->buffers[number];
	const char *uri = gltf_text(object, "uri");
	size_t stated = 0;
	if (!gltf_size(object, "byteLength", &stated))
		return import_fail(document->loader, "the byteLength of buffer %u is no size of at most 4 GiB", number);
	if (uri && !read_uri(document, buffer, uri, &stated))
		return false;
	if (!uri && number == 0 && document->binary)
		*buffer = (gltf_buffer){(uint8_t *)document->binary, document->binary_size, true};
	if (buffer->size < stated)
		return import_fail(document->loader,
				   "buffer %u has %zu bytes of the %zu it states; the file is cut off", number,
				   buffer->size, stated);
	document->bytes_read += buffer->borrowed ? 0 : buffer->size;
	return document->bytes_read < MAX_FILE_SIZE ||
	       import_fail(document->loader, "its buffers hold more than 4 GiB");
}

static bool read_buffers(gltf_document *document)
{
	uint32_t count = document->tables[GLTF_BUFFERS].count;
	document->buffers = calloc(count + 1, sizeof *document->buffers);
	if (!document->buffers)
		return import_fail(document->loader, "out of memory");
	for (uint32_t i = 0; i < count; i++) {
		if (!read_buffer(document, i))
			return false;
	}
	return true;
}

/* ---- container --------------------------------------------------------------------------------------------------- */

static uint32_t little_endian(const uint8_t *bytes)
{
	return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

/*  //---- 4B ---- 4B ------- 4B ------- 4B ---- 4B --- n -- 4B ---- 4B --- m
 *  //    glTF    version   length    | n      JSON   ...  | m     BIN    ...
 */
static bool split_glb(gltf_document *document, const char **json, size_t *json_size)
{
	const uint8_t *file = document->file;
	size_t size = document->file_size;
	if (size < 20 || little_endian(file + 4) != 2 || little_endian(file + 16) != GLB_JSON)
		return import_fail(document->loader, "is no glTF 2.0 binary file");
	*json = (const char *)file + 20;
	*json_size = little_endian(file + 12);
	if (*json_size > size - 20)
		return import_fail(document->loader, "the file is cut off: %zu of the %zu bytes of its JSON are there",
				   size - 20, *json_size);
	size_t second = 20 + (*json_size + 3) / 4 * 4;
	if (second + 8 > size || little_endian(file + second + 4) != GLB_BIN)
		return true;
	document->binary = file + second + 8;
	document->binary_size = little_endian(file + second);
	return document->binary_size <= size - second - 8 ||
	       import_fail(document->loader, "the file is cut off: %zu of the %zu bytes of its buffer are there",
			   size - second - 8, document->binary_size);
}

static bool parse(gltf_document *document)
{
	const char *json = (const char *)document->file;
	size_t json_size = document->file_size;
	bool binary = json_size >= 4 && little_endian(document->file) == GLB_MAGIC;
	if (binary && !split_glb(document, &json, &json_size))
		return false;
	const char *end = json;
	document->root = cJSON_ParseWithLengthOpts(json, json_size, &end, 0);
	if (!cJSON_IsObject(document->root))
		return import_fail(document->loader,
				   "is no JSON from byte %zu of %zu on; the file is broken or cut off",
				   (size_t)(end - json), json_size);
	const char *version = gltf_text(gltf_member(document->root, "asset"), "version");
	if (!version || strncmp(version, "2.", 2) != 0)
		return import_fail(document->loader, "is not glTF 2.x (asset.version is \"%.20s\")",
				   version ? version : "");
	return true;
}

static bool make_table(gltf_document *document, gltf_array which)
{
	static const cJSON empty = {.type = cJSON_Object};
	const cJSON *array = gltf_member(document->root, array_names[which]), *item;
	gltf_table *table = &document->tables[which];
	table->items = calloc((size_t)cJSON_GetArraySize(array) + 1, sizeof *table->items);
	if (!table->items)
		return import_fail(document->loader, "out of memory");
	if (array && !cJSON_IsArray(array))
		return import_fail(document->loader, "\"%s\" must be an array", array_names[which]);
	cJSON_ArrayForEach(item, array)
	{
		if (!cJSON_IsObject(item))
			import_note(document->loader, NULL, "members of \"%s\" that are no objects are taken as empty",
				    array_names[which]);
		table->items[table->count++] = cJSON_IsObject(item) ? item : &empty;
	}
	return true;
}

static bool is_one_of(const char *name, const char *const *list, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		if (strcmp(name, list[i]) == 0)
			return true;
	}
	return false;
}

static const char *const known_extensions[] = {
    "KHR_materials_emissive_strength", "KHR_materials_pbrSpecularGlossiness",
    "KHR_mesh_quantization",           "EXT_mesh_gpu_instancing",
    "KHR_materials_transmission",      "KHR_materials_ior",
    "KHR_texture_transform",           "KHR_lights_punctual",
    "EXT_lights_image_based",
};

/* What holds the geometry alone may not be required; of the rest, what is not read is told where it is used. */
static bool check_extensions(gltf_document *document)
{
	static const char *const geometric[] = {"KHR_draco_mesh_compression", "EXT_meshopt_compression",
						"KHR_meshopt_compression"};
	const cJSON *item;
	cJSON_ArrayForEach(item, gltf_member(document->root, "extensionsRequired"))
	{
		const char *name = cJSON_GetStringValue(item);
		if (name && is_one_of(name, geometric, sizeof geometric / sizeof geometric[0]))
			return import_fail(document->loader, "needs %s, which is not read; export without it", name);
		if (name && !is_one_of(name, known_extensions, sizeof known_extensions / sizeof known_extensions[0]))
			import_note(document->loader, name, "extensions that the file requires are not read");
	}
	return true;
}

static void note_extension(gltf_document *document, const cJSON *extension, const char *subject)
{
	if (!extension->string || /* an array instead of an object */
	    is_one_of(extension->string, known_extensions, sizeof known_extensions / sizeof known_extensions[0]))
		return;
	import_note(document->loader, subject, "uses of %.60s are not read", extension->string);
}

/* Extensions of everything below an item; extras are nobody's business. cJSON nests 1,000 deep at most. */
static void note_extensions(gltf_document *document, const cJSON *item, const char *subject)
{
	const char *name = gltf_text(item, "name");
	const cJSON *member;
	subject = name ? name : subject;
	cJSON_ArrayForEach(member, item)
	{
		const cJSON *extension;
		if (member->string && strcmp(member->string, "extensions") == 0)
			cJSON_ArrayForEach(extension, member) note_extension(document, extension, subject);
		else if (!member->string || strcmp(member->string, "extras") != 0)
			note_extensions(document, member, subject);
	}
}

/* The root's own extensions are lists that others refer to. */
static void note_all_extensions(gltf_document *document)
{
	for (int i = 0; i < GLTF_ARRAYS; i++) {
		const cJSON *array = gltf_member(document->root, array_names[i]), *item;
		cJSON_ArrayForEach(item, array) note_extensions(document, item, NULL);
	}
}

/* A file that holds its geometry once takes a byte or more a corner. One that places a mesh often may make more of it,
 * but not without end: 4 million corners, or 64 a byte, are more than light can be computed for.
 */
uint64_t gltf_budget(const gltf_document *document)
{
	uint64_t budget = 64 * (uint64_t)document->bytes_read, least = 1u << 22, most = 1u << 27;
	return budget < least ? least : budget > most ? most : budget;
}

static bool make_side_tables(gltf_document *document)
{
	const gltf_table *nodes = &document->tables[GLTF_NODES], *textures = &document->tables[GLTF_TEXTURES];
	document->images = calloc((size_t)document->tables[GLTF_IMAGES].count + 1, sizeof *document->images);
	document->materials = calloc((size_t)document->tables[GLTF_MATERIALS].count + 1, sizeof *document->materials);
	document->node_names = calloc((size_t)nodes->count + 1, sizeof *document->node_names);
	document->texture_images = calloc((size_t)textures->count + 1, sizeof *document->texture_images);
	if (!document->images || !document->materials || !document->node_names || !document->texture_images)
		return false;
	for (uint32_t n = 0; n < nodes->count; n++)
		document->node_names[n] = gltf_text(nodes->items[n], "name");
	for (uint32_t t = 0; t < textures->count; t++) {
		document->texture_images[t] = -1;
		gltf_index(document, textures->items[t], "source", GLTF_IMAGES, &document->texture_images[t]);
	}
	return true;
}

bool gltf_open(gltf_document *document, import_loader *loader)
{
	*document = (gltf_document){.loader = loader};
	document->file = import_read_file(loader, &document->file_size);
	if (!document->file)
		return false;
	document->bytes_read = document->file_size;
	if (!parse(document) || !check_extensions(document))
		return false;
	for (int i = 0; i < GLTF_ARRAYS; i++) {
		if (!make_table(document, (gltf_array)i))
			return false;
	}
	note_all_extensions(document);
	if (!make_side_tables(document))
		return import_fail(loader, "out of memory");
	return read_buffers(document);
}

void gltf_close(gltf_document *document)
{
	for (uint32_t i = 0; document->buffers && i < document->tables[GLTF_BUFFERS].count; i++) {
		if (!document->buffers[i].borrowed)
			free(document->buffers[i].bytes);
	}
	for (int i = 0; i < GLTF_ARRAYS; i++)
		free(document->tables[i].items);
	free(document->buffers);
	free(document->views);
	free(document->accessors);
	free(document->images);
	free(document->node_names);
	free(document->texture_images);
	free(document->materials);
	free(document->numbers);
	free(document->stamps);
	cJSON_Delete(document->root);
	free(document->file);
	*document = (gltf_document){0};
}
