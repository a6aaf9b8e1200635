/* Accessors of a glTF file: where their elements lie, each held against its buffer, and the elements as numbers. */
#include "gltf_document.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BYTE = 5120, UNSIGNED_BYTE, SHORT, UNSIGNED_SHORT, UNSIGNED_INT = 5125, FLOAT = 5126 };

/* Elements of an accessor without bytes of its own: they are all zero but for a few. */
enum { MAX_ZEROS = 1 << 24 };

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

static bool is_unsigned(int type)
{
	return type == UNSIGNED_BYTE || type == UNSIGNED_SHORT || type == UNSIGNED_INT;
}

static uint32_t components_of(const char *type)
{
	static const struct {
		const char *name;
		uint32_t components;
	} types[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
	for (size_t i = 0; type && i < sizeof types / sizeof types[0]; i++) {
		if (strcmp(type, types[i].name) == 0)
			return types[i].components;
	}
	return 0;
}

/* glTF is little-endian, as are the machines this runs on; memcpy because elements need not be aligned. */
static double component(int type, bool normalized, const uint8_t *at)
{
	uint16_t wide;
	uint32_t bits;
	float value;
	switch (type) {
	case BYTE:
		return normalized ? fmax((int8_t)*at / 127.0, -1) : (int8_t)*at;
	case UNSIGNED_BYTE:
		return normalized ? *at / 255.0 : *at;
	case SHORT:
		memcpy(&wide, at, sizeof wide);
		return normalized ? fmax((int16_t)wide / 32767.0, -1) : (int16_t)wide;
	case UNSIGNED_SHORT:
		memcpy(&wide, at, sizeof wide);
		return normalized ? wide / 65535.0 : wide;
	case UNSIGNED_INT:
		memcpy(&bits, at, sizeof bits);
		return normalized ? bits / 4294967295.0 : bits;
	default:
		memcpy(&value, at, sizeof value);
		return (double)value;
	}
}

static gltf_view place_view(const gltf_document *document, const cJSON *from)
{
	int64_t number = -1;
	size_t offset = 0;
	gltf_view view = {0};
	if (!gltf_index(document, from, "buffer", GLTF_BUFFERS, &number) || number < 0 ||
	    !gltf_size(from, "byteOffset", &offset) || !gltf_size(from, "byteLength", &view.size) ||
	    !gltf_size(from, "byteStride", &view.stride))
		return view;
	const gltf_buffer *buffer = &document->buffers[number];
	if (buffer->bytes && offset <= buffer->size && view.size <= buffer->size - offset)
		view.bytes = buffer->bytes + offset;
	return view;
}

/* The bytes of `count` elements in a view. All numbers are below 2^32, so that products and sums fit into 64 bits. */
static const uint8_t *place(const gltf_view *view, size_t offset, uint64_t count, size_t stride, size_t element)
{
	if (!view->bytes || stride < element || (uint64_t)offset + (count - 1) * stride + element > view->size)
		return NULL;
	return view->bytes + offset;
}

static const char *place_dense(const gltf_document *document, const cJSON *from, size_t element, gltf_accessor *to)
{
	int64_t number = -1;
	size_t offset = 0;
	if (!gltf_index(document, from, "bufferView", GLTF_BUFFER_VIEWS, &number) ||
	    !gltf_size(from, "byteOffset", &offset))
		return "an accessor has no buffer view";
	if (number < 0)
		return to->count <= MAX_ZEROS ? NULL : "an accessor states more elements than it has bytes for";
	const gltf_view *view = &document->views[number];
	to->stride = view->stride ? view->stride : element;
	to->bytes = place(view, offset, to->count, to->stride, element);
	return to->bytes ? NULL : "an accessor reaches past the end of its buffer";
}

static const char *place_sparse(const gltf_document *document, const cJSON *sparse, size_t element, gltf_accessor *to)
{
	const cJSON *numbers = gltf_member(sparse, "indices"), *values = gltf_member(sparse, "values");
	int64_t number_view = -1, value_view = -1;
	size_t count = 0, number_offset = 0, value_offset = 0, type = 0;
	if (!sparse)
		return NULL;
	if (!gltf_size(sparse, "count", &count) || count == 0 || count > to->count ||
	    !gltf_index(document, numbers, "bufferView", GLTF_BUFFER_VIEWS, &number_view) || number_view < 0 ||
	    !gltf_index(document, values, "bufferView", GLTF_BUFFER_VIEWS, &value_view) || value_view < 0 ||
	    !gltf_size(numbers, "byteOffset", &number_offset) || !gltf_size(values, "byteOffset", &value_offset) ||
	    !gltf_size(numbers, "componentType", &type) || !is_unsigned((int)type))
		return "a sparse accessor is not whole";
	size_t width = component_size((int)type);
	to->sparse_count = (uint32_t)count;
	to->sparse_type = (int)type;
	to->sparse_numbers = place(&document->views[number_view], number_offset, count, width, width);
	to->sparse_values = place(&document->views[value_view], value_offset, count, element, element);
	return to->sparse_numbers && to->sparse_values ? NULL : "a sparse accessor reaches past the end of its buffer";
}

/* What sparse_element() relies on. */
static bool sparse_numbers_rise(const gltf_accessor *accessor)
{
	const size_t width = component_size(accessor->sparse_type);
	double last = -1;
	for (uint32_t k = 0; k < accessor->sparse_count; k++) {
		const double number = component(accessor->sparse_type, false, accessor->sparse_numbers + k * width);
		if (number <= last)
			return false;
		last = number;
	}
	return true;
}

static const char *place_accessor(const gltf_document *document, const cJSON *from, gltf_accessor *to)
{
	size_t count = 0, type = 0;
	to->components = components_of(gltf_text(from, "type"));
	if (!gltf_size(from, "count", &count) || count == 0)
		return "an accessor is empty";
	if (!gltf_size(from, "componentType", &type) || component_size((int)type) == 0 || to->components == 0)
		return "an accessor is of an unknown type";
	to->count = (uint32_t)count;
	to->type = (int)type;
	to->normalized = cJSON_IsTrue(gltf_member(from, "normalized"));
	size_t element = component_size(to->type) * to->components;
	const char *fault = place_dense(document, from, element, to);
	return fault ? fault : place_sparse(document, gltf_member(from, "sparse"), element, to);
}

bool gltf_place_accessors(gltf_document *document)
{
	const gltf_table *views = &document->tables[GLTF_BUFFER_VIEWS], *table = &document->tables[GLTF_ACCESSORS];
	document->views = calloc((size_t)views->count + 1, sizeof *document->views);
	document->accessors = calloc((size_t)table->count + 1, sizeof *document->accessors);
	if (!document->views || !document->accessors)
		return false;
	for (uint32_t i = 0; i < views->count; i++)
		document->views[i] = place_view(document, views->items[i]);
	uint64_t looks = gltf_budget(document); /* many accessors may share a list of numbers */
	for (uint32_t i = 0; i < table->count; i++) {
		gltf_accessor *accessor = &document->accessors[i];
		accessor->fault = place_accessor(document, table->items[i], accessor);
		if (accessor->fault || accessor->sparse_count == 0)
			continue;
		if (accessor->sparse_count > looks)
			accessor->fault = "a sparse accessor is one of too many for a file of this size";
		else if (!sparse_numbers_rise(accessor))
			accessor->fault = "a sparse accessor's indices do not rise";
		else
			looks -= accessor->sparse_count;
	}
	return true;
}

const gltf_accessor *gltf_find_accessor(const gltf_document *document, int64_t number, uint32_t components,
					const char **fault)
{
	const gltf_accessor *accessor = number >= 0 ? &document->accessors[number] : NULL;
	*fault = accessor ? accessor->fault : "an accessor is missing";
	if (!*fault && accessor->components != components)
		*fault = "an accessor has a type that does not suit its use";
	return *fault ? NULL : accessor;
}

/* Where the sparse values hold element i, or NULL: their numbers rise. */
static const uint8_t *sparse_element(const gltf_accessor *accessor, uint32_t i)
{
	size_t width = component_size(accessor->sparse_type);
	uint32_t low = 0, high = accessor->sparse_count;
	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		double number = component(accessor->sparse_type, false, accessor->sparse_numbers + middle * width);
		if (number < i)
			low = middle + 1;
		else
			high = middle;
	}
	if (low == accessor->sparse_count ||
	    component(accessor->sparse_type, false, accessor->sparse_numbers + low * width) != i)
		return NULL;
	return accessor->sparse_values + (size_t)low * component_size(accessor->type) * accessor->components;
}

void gltf_element(const gltf_accessor *accessor, uint32_t i, double *values)
{
	const uint8_t *at = accessor->sparse_count > 0 ? sparse_element(accessor, i) : NULL;
	size_t size = component_size(accessor->type);
	if (!at && accessor->bytes)
		at = accessor->bytes + i * accessor->stride;
	for (uint32_t c = 0; c < accessor->components; c++)
		values[c] = at ? component(accessor->type, accessor->normalized, at + c * size) : 0;
}

float *gltf_floats(const gltf_accessor *accessor)
{
	uint32_t components = accessor->components;
	float *floats = malloc((size_t)accessor->count * components * sizeof *floats);
	for (uint32_t i = 0; floats && i < accessor->count; i++) {
		double values[16];
		gltf_element(accessor, i, values);
		for (uint32_t c = 0; c < components; c++)
			floats[(size_t)i * components + c] = (float)values[c];
	}
	return floats;
}
