#define _POSIX_C_SOURCE 200809L
#include "gltf_document.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { GLB_MAGIC = 0x46546c67, GLB_JSON = 0x4e4f534a, GLB_BIN = 0x004e4942 };
#define MAX_FILE_SIZE ((size_t)4 << 30) /* a .glb counts its bytes in 32 bits */

static const char *const array_names[GLTF_ARRAYS] = {"accessors", "animations", "buffers", "bufferViews", "cameras",
						     "materials", "meshes",     "nodes",   "scenes"};

/* ---- members ----------------------------------------------------------------------------------------------------- */

const cJSON *gltf_member(const cJSON *object, const char *key)
{
	return cJSON_GetObjectItemCaseSensitive(object, key);
}

const char *gltf_text(const cJSON *object, const char *key)
{
	return cJSON_GetStringValue(gltf_member(object, key));
}

/* A whole number of 0..limit - 1. */
static bool whole_number(const cJSON *item, double limit, double *value)
{
	*value = cJSON_IsNumber(item) ? item->valuedouble : -1;
	return *value >= 0 && *value < limit && *value == floor(*value);
}

bool gltf_index(gltf_document *document, const cJSON *object, const char *key, gltf_array array, int64_t *index)
{
	const cJSON *item = gltf_member(object, key);
	double value = -1;
	if (item && !whole_number(item, document->tables[array].count, &value))
		return scene_fail(document->loader, "\"%s\" is none of the %u %s of the file", key,
				  document->tables[array].count, array_names[array]);
	*index = (int64_t)value;
	return true;
}

bool gltf_numbers(gltf_document *document, const cJSON *object, const char *key, int count, double *numbers)
{
	const cJSON *array = gltf_member(object, key), *item;
	int i = 0;
	if (!array)
		return true;
	if (cJSON_IsArray(array) && cJSON_GetArraySize(array) == count) {
		cJSON_ArrayForEach(item, array)
		{
			if (!cJSON_IsNumber(item) || !isfinite(item->valuedouble))
				break;
			numbers[i++] = item->valuedouble;
		}
	}
	return i == count || scene_fail(document->loader, "\"%s\" must be %d finite numbers", key, count);
}

bool gltf_number(gltf_document *document, const cJSON *object, const char *key, double *number)
{
	const cJSON *item = gltf_member(object, key);
	if (!item)
		return true;
	*number = cJSON_IsNumber(item) ? item->valuedouble : NAN;
	return isfinite(*number) || scene_fail(document->loader, "\"%s\" must be a finite number", key);
}

/* A whole number that counts or places bytes. */
static bool byte_number(gltf_document *document, const cJSON *object, const char *key, size_t *number)
{
	const cJSON *item = gltf_member(object, key);
	double value = (double)*number;
	if (item && !whole_number(item, (double)MAX_FILE_SIZE, &value))
		return scene_fail(document->loader, "\"%s\" must be a whole number of at most 4 GiB", key);
	*number = (size_t)value;
	return true;
}

/* ---- files ------------------------------------------------------------------------------------------------------- */

static uint8_t *read_stream(FILE *file, size_t *size)
{
	if (fseeko(file, 0, SEEK_END) != 0)
		return NULL;
	off_t end = ftello(file);
	if (end <= 0 || (uint64_t)end > MAX_FILE_SIZE || fseeko(file, 0, SEEK_SET) != 0)
		return NULL;
	uint8_t *bytes = malloc((size_t)end);
	*size = bytes ? fread(bytes, 1, (size_t)end, file) : 0;
	if (*size == (size_t)end)
		return bytes;
	free(bytes);
	return NULL;
}

static uint8_t *read_file(const char *path, size_t *size)
{
	FILE *file = fopen(path, "rb");
	uint8_t *bytes = file ? read_stream(file, size) : NULL;
	if (file)
		fclose(file);
	return bytes;
}

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

static bool read_base64(gltf_buffer *buffer, const char *text)
{
	size_t length = strcspn(text, "=");
	buffer->bytes = malloc(length / 4 * 3 + 4);
	uint32_t bits = 0;
	for (size_t i = 0; buffer->bytes && i < length; i++) {
		int digit = base64_digit(text[i]);
		if (digit < 0)
			return false;
		bits = bits << 6 | (uint32_t)digit;
		if (i % 4 == 0)
			continue; /* six bits are no byte yet; later ones give 4 + 2 left over, then 2 + 4, then 0 */
		buffer->bytes[buffer->size++] = (uint8_t)(bits >> (6 - 2 * (i % 4)));
	}
	return buffer->bytes != NULL;
}

static int hex_digit(char c)
{
	if (c >= '0' && c <= '9')
		return c - '0';
	c |= 32;
	return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

/* The file beside the .gltf, with %20 and the like turned back. False when the name is too long. */
static bool path_beside(const char *gltf_path, const char *uri, char *path, size_t path_size)
{
	const char *slash = strrchr(gltf_path, '/');
	size_t length = slash ? (size_t)(slash - gltf_path) + 1 : 0;
	if (length + strlen(uri) + 1 > path_size)
		return false;
	memcpy(path, gltf_path, length);
	for (const char *c = uri; *c; c++) {
		bool escaped = c[0] == '%' && hex_digit(c[1]) >= 0 && hex_digit(c[2]) >= 0;
		path[length++] = escaped ? (char)(hex_digit(c[1]) * 16 + hex_digit(c[2])) : *c;
		c += escaped ? 2 : 0;
	}
	path[length] = '\0';
	return true;
}

static bool read_uri(gltf_document *document, gltf_buffer *buffer, const char *uri)
{
	char path[4096];
	if (strncmp(uri, "data:", 5) == 0) {
		const char *comma = strstr(uri, ";base64,");
		return (comma && read_base64(buffer, comma + 8)) ||
		       scene_fail(document->loader, "a buffer's data: address is not base64");
	}
	if (path_beside(document->loader->path, uri, path, sizeof path))
		buffer->bytes = read_file(path, &buffer->size);
	return buffer->bytes || scene_fail(document->loader, "its buffer \"%.200s\" cannot be read", uri);
}

static bool read_buffer(gltf_document *document, uint32_t number)
{
	const cJSON *object = document->tables[GLTF_BUFFERS].items[number];
	gltf_buffer *buffer = &document->buffers[number];
	const char *uri = gltf_text(object, "uri");
	size_t stated = 0;
	if (!byte_number(document, object, "byteLength", &stated))
		return false;
	if (uri && !read_uri(document, buffer, uri))
		return false;
	if (!uri && number == 0 && document->binary)
		*buffer = (gltf_buffer){(uint8_t *)document->binary, document->binary_size, true};
	if (buffer->size < stated)
		return scene_fail(document->loader, "buffer %u has %zu bytes of the %zu it states; the file is cut off",
				  number, buffer->size, stated);
	return true;
}

static bool read_buffers(gltf_document *document)
{
	uint32_t count = document->tables[GLTF_BUFFERS].count;
	document->buffers = calloc(count + 1, sizeof *document->buffers);
	if (!document->buffers)
		return scene_fail(document->loader, "out of memory");
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
		return scene_fail(document->loader, "is no glTF 2.0 binary file");
	*json = (const char *)file + 20;
	*json_size = little_endian(file + 12);
	if (*json_size > size - 20)
		return scene_fail(document->loader, "the file is cut off");
	size_t second = 20 + (*json_size + 3) / 4 * 4;
	if (second + 8 > size || little_endian(file + second + 4) != GLB_BIN)
		return true;
	document->binary = file + second + 8;
	document->binary_size = little_endian(file + second);
	return document->binary_size <= size - second - 8 || scene_fail(document->loader, "the file is cut off");
}

static bool parse(gltf_document *document)
{
	const char *json = (const char *)document->file;
	size_t json_size = document->file_size;
	bool binary = json_size >= 4 && little_endian(document->file) == GLB_MAGIC;
	if (binary && !split_glb(document, &json, &json_size))
		return false;
	document->root = cJSON_ParseWithLength(json, json_size);
	if (!cJSON_IsObject(document->root))
		return scene_fail(document->loader, "is no JSON; the file is broken or cut off");
	const char *version = gltf_text(gltf_member(document->root, "asset"), "version");
	if (!version || strncmp(version, "2.", 2) != 0)
		return scene_fail(document->loader, "is not glTF 2.x (asset.version is \"%.20s\")",
				  version ? version : "");
	return true;
}

static bool make_table(gltf_document *document, gltf_array which)
{
	const cJSON *array = gltf_member(document->root, array_names[which]), *item;
	gltf_table *table = &document->tables[which];
	table->items = calloc((size_t)cJSON_GetArraySize(array) + 1, sizeof *table->items);
	if (!table->items)
		return scene_fail(document->loader, "out of memory");
	if (array && !cJSON_IsArray(array))
		return scene_fail(document->loader, "\"%s\" must be an array", array_names[which]);
	cJSON_ArrayForEach(item, array)
	{
		if (!cJSON_IsObject(item))
			return scene_fail(document->loader, "\"%s\" must hold objects", array_names[which]);
		table->items[table->count++] = item;
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

/* What changes geometry may not be required; of anything else that is not read the user should know. */
static bool check_extensions(gltf_document *document)
{
	static const char *const read[] = {"KHR_materials_emissive_strength", "KHR_mesh_quantization"};
	static const char *const geometric[] = {"KHR_draco_mesh_compression", "EXT_meshopt_compression",
						"EXT_mesh_gpu_instancing"};
	const cJSON *item;
	cJSON_ArrayForEach(item, gltf_member(document->root, "extensionsRequired"))
	{
		const char *name = cJSON_GetStringValue(item);
		if (name && is_one_of(name, geometric, sizeof geometric / sizeof geometric[0]))
			return scene_fail(document->loader, "needs %s, which is not read; export without it", name);
		if (name && !is_one_of(name, read, sizeof read / sizeof read[0]))
			scene_warn(document->loader, "the file requires %.80s, which is not read", name);
	}
	return true;
}

bool gltf_open(gltf_document *document, scene_loader *loader)
{
	*document = (gltf_document){.loader = loader};
	document->file = read_file(loader->path, &document->file_size);
	if (!document->file)
		return scene_fail(loader, "the file cannot be read");
	if (!parse(document) || !check_extensions(document))
		return false;
	for (int i = 0; i < GLTF_ARRAYS; i++) {
		if (!make_table(document, (gltf_array)i))
			return false;
	}
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
	cJSON_Delete(document->root);
	free(document->file);
	*document = (gltf_document){0};
}

/* ---- accessors --------------------------------------------------------------------------------------------------- */

enum { BYTE = 5120, UNSIGNED_BYTE, SHORT, UNSIGNED_SHORT, UNSIGNED_INT = 5125, FLOAT = 5126 };

/* Where the elements of an accessor lie; all inside the buffer. */
typedef struct view {
	const uint8_t *bytes;
	size_t stride;
	uint32_t count;
	int type; /* of a component */
	bool normalized;
} view;

static size_t component_size(int type)
{
	switch (type) {
	case BYTE:
	case UNSIGNED_BYTE:
		return 1;
	case SHORT:
	case UNSIGNED_SHORT:
		return 2;
	case UNSIGNED_INT:
	case FLOAT:
		return 4;
	default:
		return 0;
	}
}

static uint32_t components_of(const char *type)
{
	static const char *const names[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
	for (uint32_t i = 0; type && i < 4; i++) {
		if (strcmp(type, names[i]) == 0)
			return i + 1;
	}
	return 0;
}

/* Numbers of an accessor and its buffer view, before they are held against the buffer's size. */
typedef struct placement {
	size_t view_offset, view_length, stride, offset, count, type;
} placement;

static bool read_placement(gltf_document *document, const cJSON *accessor, const cJSON *buffer_view, placement *p)
{
	return byte_number(document, accessor, "byteOffset", &p->offset) &&
	       byte_number(document, accessor, "count", &p->count) &&
	       byte_number(document, accessor, "componentType", &p->type) &&
	       byte_number(document, buffer_view, "byteOffset", &p->view_offset) &&
	       byte_number(document, buffer_view, "byteLength", &p->view_length) &&
	       byte_number(document, buffer_view, "byteStride", &p->stride);
}

/* All numbers are below 2^32, so that their products and sums fit into 64 bits. */
static bool fits(const placement *p, size_t element, size_t buffer_size)
{
	uint64_t needed = (uint64_t)p->offset + (uint64_t)(p->count - 1) * p->stride + element;
	return p->stride >= element && needed <= p->view_length &&
	       (uint64_t)p->view_offset + p->view_length <= buffer_size;
}

static bool place(gltf_document *document, const cJSON *accessor, const cJSON *buffer_view, const gltf_buffer *buffer,
		  uint32_t components, view *out)
{
	placement p = {0};
	if (!read_placement(document, accessor, buffer_view, &p))
		return false;
	size_t element = component_size((int)p.type) * components;
	if (element == 0 || components_of(gltf_text(accessor, "type")) != components)
		return scene_fail(document->loader, "an accessor has a type that does not suit its use");
	if (p.stride == 0)
		p.stride = element;
	if (p.count == 0 || !fits(&p, element, buffer->size))
		return scene_fail(document->loader, "an accessor reaches past the end of its buffer, or is empty");
	*out = (view){buffer->bytes + p.view_offset + p.offset, p.stride, (uint32_t)p.count, (int)p.type,
		      cJSON_IsTrue(gltf_member(accessor, "normalized"))};
	return true;
}

static bool open_accessor(gltf_document *document, int64_t number, uint32_t components, view *out)
{
	int64_t view_number = -1, buffer_number = -1;
	const cJSON *accessor = number >= 0 ? document->tables[GLTF_ACCESSORS].items[number] : NULL;
	if (!accessor)
		return scene_fail(document->loader, "an accessor is missing");
	if (gltf_member(accessor, "sparse"))
		return scene_fail(document->loader, "uses sparse accessors, which are not read; export without them");
	if (!gltf_index(document, accessor, "bufferView", GLTF_BUFFER_VIEWS, &view_number))
		return false;
	const cJSON *buffer_view = view_number >= 0 ? document->tables[GLTF_BUFFER_VIEWS].items[view_number] : NULL;
	if (!gltf_index(document, buffer_view, "buffer", GLTF_BUFFERS, &buffer_number))
		return false;
	if (buffer_number < 0)
		return scene_fail(document->loader, "an accessor has no buffer");
	return place(document, accessor, buffer_view, &document->buffers[buffer_number], components, out);
}

/* glTF is little-endian, as are the machines this runs on; memcpy because elements need not be aligned. */
static float component(const view *v, const uint8_t *at)
{
	uint16_t wide;
	uint32_t bits;
	float value;
	switch (v->type) {
	case BYTE:
		return v->normalized ? fmaxf((int8_t)*at / 127.0f, -1) : (int8_t)*at;
	case UNSIGNED_BYTE:
		return v->normalized ? *at / 255.0f : *at;
	case SHORT:
		memcpy(&wide, at, sizeof wide);
		return v->normalized ? fmaxf((int16_t)wide / 32767.0f, -1) : (int16_t)wide;
	case UNSIGNED_SHORT:
		memcpy(&wide, at, sizeof wide);
		return v->normalized ? wide / 65535.0f : wide;
	case UNSIGNED_INT:
		memcpy(&bits, at, sizeof bits);
		return (float)bits;
	default:
		memcpy(&value, at, sizeof value);
		return value;
	}
}

bool gltf_floats(gltf_document *document, int64_t accessor, uint32_t components, float **values, uint32_t *count)
{
	view v;
	*values = NULL;
	if (!open_accessor(document, accessor, components, &v))
		return false;
	*values = malloc((size_t)v.count * components * sizeof(float));
	if (!*values)
		return scene_fail(document->loader, "out of memory for an accessor of %u elements", v.count);
	size_t size = component_size(v.type);
	for (size_t i = 0; i < v.count; i++) {
		for (uint32_t c = 0; c < components; c++)
			(*values)[i * components + c] = component(&v, v.bytes + i * v.stride + c * size);
	}
	*count = v.count;
	return true;
}

bool gltf_indices(gltf_document *document, int64_t accessor, uint32_t **values, uint32_t *count)
{
	view v;
	*values = NULL;
	if (!open_accessor(document, accessor, 1, &v))
		return false;
	if (v.type != UNSIGNED_BYTE && v.type != UNSIGNED_SHORT && v.type != UNSIGNED_INT)
		return scene_fail(document->loader, "vertex numbers must be unsigned integers");
	*values = calloc(v.count, sizeof(uint32_t));
	if (!*values)
		return scene_fail(document->loader, "out of memory for an accessor of %u elements", v.count);
	for (size_t i = 0; i < v.count; i++)
		memcpy(&(*values)[i], v.bytes + i * v.stride, component_size(v.type)); /* low bytes first */
	*count = v.count;
	return true;
}
