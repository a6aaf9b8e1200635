/* PLY, ascii and binary. One object; colours become materials.
 *
 * Memory grows with what has been read, so that no count in a header takes any: a file that states more than it holds
 * is read to its end and refused.
 */
#include "import_ply.h"

#include "import_ply_header.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct ply_reader {
	import_loader *loader;
	import_text text;
	ply_header header;
	import_polygons polygons;
	const ply_element *element; /* the one that is read, and how many of its kind were */
	uint64_t index;
} ply_reader;

/* What the properties of one vertex or face say. */
typedef struct ply_values {
	double value[PLY_ROLES];
	uint32_t corners; /* at the end of polygons.corners */
} ply_values;

/* With "line 7" before the fault where there are lines, else with "face 3". */
static bool fail_at(ply_reader *r, const char *fault)
{
	if (r->header.format == PLY_ASCII)
		return import_fail(r->loader, "line %u: %s", r->text.line, fault);
	return import_fail(r->loader, "%s %llu: %s", r->element->name, (unsigned long long)r->index, fault);
}

static bool fail_short(ply_reader *r)
{
	return import_fail(r->loader, "is cut off: %llu of %llu elements \"%s\" are there",
			   (unsigned long long)r->index, (unsigned long long)r->element->count, r->element->name);
}

/* Where the reader is, as r->polygons.places counts. */
static uint32_t place(const ply_reader *r)
{
	return r->header.format == PLY_ASCII ? r->text.line : (uint32_t)r->index;
}

/* ---- values ------------------------------------------------------------------------------------------------------ */

static uint64_t read_bits(const uint8_t *bytes, size_t size, bool big_endian)
{
	uint64_t bits = 0;
	for (size_t i = 0; i < size; i++)
		bits = bits << 8 | bytes[big_endian ? i : size - 1 - i];
	return bits;
}

static double value_of(ply_type type, uint64_t bits)
{
	uint32_t low = (uint32_t)bits;
	float single;
	double value;
	switch (type) {
	case PLY_INT8:
		return (int8_t)bits;
	case PLY_INT16:
		return (int16_t)bits;
	case PLY_INT32:
		return (int32_t)bits;
	case PLY_FLOAT32:
		memcpy(&single, &low, sizeof single);
		return (double)single;
	case PLY_FLOAT64:
		memcpy(&value, &bits, sizeof value);
		return value;
	default:
		return (double)bits;
	}
}

static bool read_ascii(ply_reader *r, double *value)
{
	if (!import_skip_blanks(&r->text))
		return fail_short(r);
	return import_read_number(&r->text.next, value) || fail_at(r, "a number was expected");
}

static bool read_value(ply_reader *r, ply_type type, double *value)
{
	if (r->header.format == PLY_ASCII)
		return read_ascii(r, value);
	size_t size = ply_size(type);
	if ((size_t)(r->text.end - r->text.next) < size)
		return fail_short(r);
	*value = value_of(type, read_bits((uint8_t *)r->text.next, size, r->header.format == PLY_BIG_ENDIAN));
	r->text.next += size;
	return true;
}

static bool read_length(ply_reader *r, ply_type type, uint32_t *length)
{
	double value;
	if (!read_value(r, type, &value))
		return false;
	if (!(value >= 0 && value <= UINT32_MAX) || value != (double)(uint32_t)value)
		return fail_at(r, "the length of a list is no whole number of 0 or more");
	*length = (uint32_t)value;
	return true;
}

/* Without a look at what is skipped: normals may be no numbers where positions are. */
static bool skip_words(ply_reader *r, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		if (!import_skip_blanks(&r->text))
			return fail_short(r);
		import_skip_word(&r->text);
	}
	return true;
}

static bool skip_values(ply_reader *r, ply_type type, uint32_t count)
{
	if (r->header.format == PLY_ASCII)
		return skip_words(r, count);
	if ((uint64_t)(r->text.end - r->text.next) < (uint64_t)count * ply_size(type))
		return fail_short(r);
	r->text.next += count * ply_size(type);
	return true;
}

/* In a list of corners, where one strip ends and another begins. */
static const uint32_t STRIP_END = IMPORT_NO_VERTEX - 1;

static uint32_t vertex_of(const ply_reader *r, double value)
{
	if (value == -1 && r->element->kind == PLY_STRIPS)
		return STRIP_END;
	const double most = fmin((double)r->header.vertex_count, IMPORT_MOST_ITEMS);
	return value >= 0 && value < most && value == floor(value) ? (uint32_t)value : IMPORT_NO_VERTEX;
}

static bool read_corners(ply_reader *r, ply_type type, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		double value;
		if (!read_value(r, type, &value))
			return false;
		uint32_t *corner = import_array_add(&r->polygons.corners, sizeof *corner);
		if (!corner)
			return fail_at(r, "out of memory");
		*corner = vertex_of(r, value);
	}
	return true;
}

static bool read_property(ply_reader *r, const ply_property *property, ply_values *values)
{
	if (property->count_type == PLY_NO_TYPE && property->role == PLY_IGNORED)
		return skip_values(r, property->type, 1);
	if (property->count_type == PLY_NO_TYPE) {
		const char *before = r->text.next;
		const bool read = read_value(r, property->type, &values->value[property->role]);
		if (read && r->header.format == PLY_ASCII && property->role >= PLY_X && property->role <= PLY_Z)
			import_count_digits(&r->polygons, before, r->text.next);
		return read;
	}
	uint32_t count = 0;
	if (!read_length(r, property->count_type, &count))
		return false;
	if (property->role != PLY_CORNERS)
		return skip_values(r, property->type, count);
	values->corners = count;
	return read_corners(r, property->type, count);
}

static bool read_properties(ply_reader *r, ply_values *values)
{
	const ply_property *properties = (ply_property *)r->header.properties.items + r->element->first_property;
	for (uint32_t i = 0; i < r->element->property_count; i++) {
		if (!read_property(r, &properties[i], values))
			return false;
	}
	return true;
}

/* ---- elements ---------------------------------------------------------------------------------------------------- */

/* Whether the element has a colour; its largest value is 1 for floats, else the type's. */
static bool read_color(const ply_reader *r, const ply_values *values, float color[3])
{
	static const double largest[] = {
	    [PLY_INT8] = 127,          [PLY_UINT8] = 255,          [PLY_INT16] = 32767, [PLY_UINT16] = 65535,
	    [PLY_INT32] = 2147483647., [PLY_UINT32] = 4294967295., [PLY_FLOAT32] = 1,   [PLY_FLOAT64] = 1};
	static const uint32_t all = 1u << PLY_RED | 1u << PLY_GREEN | 1u << PLY_BLUE;
	const ply_property *properties = (ply_property *)r->header.properties.items + r->element->first_property;
	double srgb[3] = {0};
	if ((r->element->roles & all) != all)
		return false;
	for (uint32_t i = 0; i < r->element->property_count; i++) {
		ply_role role = properties[i].role;
		if (role >= PLY_RED && role <= PLY_BLUE)
			srgb[role - PLY_RED] = values->value[role] / largest[properties[i].type];
	}
	import_linear_color(srgb, color);
	return true;
}

static bool add_vertex(ply_reader *r, const ply_values *values)
{
	const double *position = values->value + PLY_X;
	char text[64];
	snprintf(text, sizeof text, "%g %g %g", position[0], position[1], position[2]);
	import_vertex *vertex = import_add_vertex(r->loader, &r->polygons, position, place(r), text);
	if (!vertex)
		return fail_at(r, "out of memory");
	vertex->colored = read_color(r, values, vertex->color);
	return true;
}

static bool add_face(ply_reader *r, const ply_values *values)
{
	import_polygon *face = import_add_polygon(&r->polygons, values->corners);
	if (!face)
		return fail_at(r, "out of memory");
	face->place = place(r);
	float color[3];
	if (read_color(r, values, color)) {
		face->colored = true;
		memcpy(face->color, color, sizeof face->color);
	}
	return true;
}

static bool add_triangle(ply_reader *r, uint32_t a, uint32_t b, uint32_t c)
{
	const uint32_t corners[3] = {a, b, c};
	if ((a == b || b == c || c == a) && fmax(fmax(a, b), c) < STRIP_END) /* strips are sewn together by such */
		return true;
	for (int i = 0; i < 3; i++) {
		uint32_t *corner = import_array_add(&r->polygons.corners, sizeof *corner);
		if (!corner)
			return fail_at(r, "out of memory");
		*corner = corners[i];
	}
	import_polygon *face = import_add_polygon(&r->polygons, 3);
	if (!face)
		return fail_at(r, "out of memory");
	face->place = place(r);
	return true;
}

/* Every second triangle of a strip runs the other way round. */
static bool add_strips(ply_reader *r, const uint32_t *at, uint32_t count)
{
	for (uint32_t i = 0, begin = 0; i < count; i++) {
		if (at[i] == STRIP_END)
			begin = i + 1;
		else if (i >= begin + 2 && !((i - begin) % 2 ? add_triangle(r, at[i - 1], at[i - 2], at[i])
							     : add_triangle(r, at[i - 2], at[i - 1], at[i])))
			return false;
	}
	return true;
}

/* Takes the list off the end of the corners, where its triangles go. */
static bool take_strips(ply_reader *r, const ply_values *values)
{
	size_t size = values->corners * sizeof(uint32_t);
	uint32_t *list = malloc(size + 1);
	if (!list)
		return fail_at(r, "out of memory");
	r->polygons.corners.count -= values->corners;
	if (size > 0)
		memcpy(list, (uint32_t *)r->polygons.corners.items + r->polygons.corners.count, size);
	bool added = add_strips(r, list, values->corners);
	free(list);
	return added;
}

static bool add_nothing(ply_reader *r, const ply_values *values)
{
	(void)r;
	(void)values;
	return true;
}

static bool read_element(ply_reader *r)
{
	static bool (*const add[PLY_KINDS])(ply_reader *, const ply_values *) = {add_nothing, add_vertex, add_face,
										 take_strips};
	if (r->element->kind == PLY_OTHER && r->element->count > 0)
		import_note(r->loader, r->element->name, "elements of other kinds are not read");
	if (r->element->property_count == 0) /* takes no bytes, however many there are */
		return true;
	for (r->index = 0; r->index < r->element->count; r->index++) {
		ply_values values = {0};
		if (!read_properties(r, &values) || !add[r->element->kind](r, &values))
			return false;
	}
	return true;
}

static void note_unread(ply_reader *r)
{
	if (r->header.has_texture)
		import_note(r->loader, NULL, "its texture is not read");
	if (r->header.format == PLY_ASCII ? import_skip_blanks(&r->text) : r->text.next < r->text.end)
		import_note(r->loader, NULL, "what follows its last element is not read");
}

static bool read_file(ply_reader *r)
{
	static const char *const name = NULL;
	if (!ply_read_header(r->loader, &r->text, &r->header))
		return false;
	r->text.line++; /* where the body begins */
	r->polygons.places = r->header.format == PLY_ASCII ? "line" : "face";
	const ply_element *elements = r->header.elements.items;
	for (size_t i = 0; i < r->header.elements.count; i++) {
		r->element = &elements[i];
		if (!read_element(r))
			return false;
	}
	note_unread(r);
	return import_add_polygons(r->loader, &r->polygons, &name, 1);
}

bool import_read_ply(import_loader *loader)
{
	size_t size;
	uint8_t *bytes = import_read_file(loader, &size);
	if (!bytes)
		return false;
	ply_reader r = {.loader = loader, .text = import_text_of(bytes, size)};
	bool read = read_file(&r);
	import_polygons_free(&r.polygons);
	ply_header_free(&r.header);
	free(bytes);
	return read;
}
