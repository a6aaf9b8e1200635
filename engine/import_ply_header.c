#include "import_ply_header.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct reader {
	import_loader *loader;
	ply_header *header;
	uint32_t line;
	uint32_t kinds; /* bits 1 << ply_kind of the elements so far */
	bool ended;
} reader;

static const struct {
	const char *name;
	ply_type type;
} types[] = {
    {"char", PLY_INT8},     {"int8", PLY_INT8},       {"uchar", PLY_UINT8},    {"uint8", PLY_UINT8},
    {"short", PLY_INT16},   {"int16", PLY_INT16},     {"ushort", PLY_UINT16},  {"uint16", PLY_UINT16},
    {"int", PLY_INT32},     {"int32", PLY_INT32},     {"uint", PLY_UINT32},    {"uint32", PLY_UINT32},
    {"float", PLY_FLOAT32}, {"float32", PLY_FLOAT32}, {"double", PLY_FLOAT64}, {"float64", PLY_FLOAT64},
};

size_t ply_size(ply_type type)
{
	static const size_t sizes[] = {[PLY_INT8] = 1,  [PLY_UINT8] = 1,  [PLY_INT16] = 2,   [PLY_UINT16] = 2,
				       [PLY_INT32] = 4, [PLY_UINT32] = 4, [PLY_FLOAT32] = 4, [PLY_FLOAT64] = 8};
	return sizes[type];
}

static ply_type type_of(const char *name)
{
	for (size_t i = 0; name && i < sizeof types / sizeof types[0]; i++) {
		if (strcmp(name, types[i].name) == 0)
			return types[i].type;
	}
	return PLY_NO_TYPE;
}

static ply_role role_of(ply_kind kind, const char *name, bool is_list)
{
	static const struct {
		const char *name;
		ply_role role;
		bool is_list;
		unsigned kinds;
	} roles[] = {
	    {"x", PLY_X, false, 1 << PLY_VERTEX},
	    {"y", PLY_Y, false, 1 << PLY_VERTEX},
	    {"z", PLY_Z, false, 1 << PLY_VERTEX},
	    {"red", PLY_RED, false, 1 << PLY_VERTEX | 1 << PLY_FACE},
	    {"green", PLY_GREEN, false, 1 << PLY_VERTEX | 1 << PLY_FACE},
	    {"blue", PLY_BLUE, false, 1 << PLY_VERTEX | 1 << PLY_FACE},
	    {"diffuse_red", PLY_RED, false, 1 << PLY_VERTEX | 1 << PLY_FACE},
	    {"diffuse_green", PLY_GREEN, false, 1 << PLY_VERTEX | 1 << PLY_FACE},
	    {"diffuse_blue", PLY_BLUE, false, 1 << PLY_VERTEX | 1 << PLY_FACE},
	    {"r", PLY_RED, false, 1 << PLY_VERTEX | 1 << PLY_FACE},
	    {"g", PLY_GREEN, false, 1 << PLY_VERTEX | 1 << PLY_FACE},
	    {"b", PLY_BLUE, false, 1 << PLY_VERTEX | 1 << PLY_FACE},
	    {"vertex_indices", PLY_CORNERS, true, 1 << PLY_FACE | 1 << PLY_STRIPS},
	    {"vertex_index", PLY_CORNERS, true, 1 << PLY_FACE | 1 << PLY_STRIPS},
	};
	for (size_t i = 0; i < sizeof roles / sizeof roles[0]; i++) {
		if (is_list == roles[i].is_list && (roles[i].kinds >> kind & 1) && strcmp(name, roles[i].name) == 0)
			return roles[i].role;
	}
	return PLY_IGNORED;
}

/* ---- lines ------------------------------------------------------------------------------------------------------- */

static bool read_format(reader *r, char *rest)
{
	static const char *const names[] = {[PLY_ASCII] = "ascii",
					    [PLY_LITTLE_ENDIAN] = "binary_little_endian",
					    [PLY_BIG_ENDIAN] = "binary_big_endian"};
	const char *name = import_next_word(&rest);
	r->header->format = PLY_NO_FORMAT;
	for (int format = PLY_ASCII; name && format <= PLY_BIG_ENDIAN; format++) {
		if (strcmp(name, names[format]) == 0)
			r->header->format = (ply_format)format;
	}
	return r->header->format != PLY_NO_FORMAT ||
	       import_fail(r->loader, "line %u: the format \"%.40s\" is not read", r->line, name ? name : "");
}

/* A count in decimal digits; what is beyond 64 bits is as much as fits. */
static bool parse_count(const char *word, uint64_t *count)
{
	size_t digits = word ? strspn(word, "0123456789") : 0;
	if (digits == 0 || word[digits])
		return false;
	*count = strtoull(word, NULL, 10);
	return true;
}

static ply_kind kind_of(const char *name)
{
	static const char *const names[] = {[PLY_VERTEX] = "vertex", [PLY_FACE] = "face", [PLY_STRIPS] = "tristrips"};
	for (int kind = PLY_VERTEX; kind < PLY_KINDS; kind++) {
		if (strcmp(name, names[kind]) == 0)
			return (ply_kind)kind;
	}
	return PLY_OTHER;
}

static bool read_element(reader *r, char *rest)
{
	const char *name = import_next_word(&rest), *count = import_next_word(&rest);
	ply_element element = {.first_property = (uint32_t)r->header->properties.count};
	if (!name || !parse_count(count, &element.count))
		return import_fail(r->loader, "line %u: element \"%.30s\" needs a count, and \"%.30s\" is none",
				   r->line, name ? name : "", count ? count : "");
	element.kind = kind_of(name);
	if (element.kind != PLY_OTHER && (r->kinds >> element.kind & 1))
		return import_fail(r->loader, "line %u: element \"%.30s\" comes twice", r->line, name);
	r->kinds |= 1u << element.kind;
	if (element.kind == PLY_VERTEX)
		r->header->vertex_count = element.count;
	snprintf(element.name, sizeof element.name, "%s", name);
	ply_element *added = import_array_add(&r->header->elements, sizeof *added);
	if (added)
		*added = element;
	return added || import_fail(r->loader, "out of memory in line %u", r->line);
}

static bool parse_property(char *rest, ply_property *property, const char **name)
{
	const char *type = import_next_word(&rest);
	*property = (ply_property){0};
	if (type && strcmp(type, "list") == 0) {
		property->count_type = type_of(import_next_word(&rest));
		type = import_next_word(&rest);
		if (property->count_type == PLY_NO_TYPE || property->count_type >= PLY_FLOAT32)
			return false;
	}
	property->type = type_of(type);
	*name = import_next_word(&rest);
	return property->type != PLY_NO_TYPE && *name;
}

static bool read_property(reader *r, char *rest)
{
	ply_property parsed;
	const char *name;
	if (r->header->elements.count == 0)
		return import_fail(r->loader, "line %u: a property stands before any element", r->line);
	if (!parse_property(rest, &parsed, &name))
		return import_fail(
		    r->loader, "line %u: is no \"property TYPE NAME\" or \"property list TYPE TYPE NAME\"", r->line);
	ply_element *element = (ply_element *)r->header->elements.items + r->header->elements.count - 1;
	parsed.role = role_of(element->kind, name, parsed.count_type != PLY_NO_TYPE);
	if (parsed.role == PLY_CORNERS && parsed.type >= PLY_FLOAT32)
		return import_fail(r->loader, "line %u: vertex numbers must be integers", r->line);
	if (parsed.role != PLY_IGNORED && (element->roles >> parsed.role & 1))
		return import_fail(r->loader, "line %u: element \"%s\" has \"%.30s\" twice", r->line, element->name,
				   name);
	element->roles |= 1u << parsed.role;
	element->property_count++;
	ply_property *added = import_array_add(&r->header->properties, sizeof *added);
	if (added)
		*added = parsed;
	return added || import_fail(r->loader, "out of memory in line %u", r->line);
}

static bool read_comment(reader *r, char *rest)
{
	const char *word = import_next_word(&rest);
	r->header->has_texture |= word && strcmp(word, "TextureFile") == 0;
	return true;
}

static bool end_header(reader *r, char *rest)
{
	(void)rest;
	r->ended = true;
	return true;
}

static const struct {
	const char *word;
	bool (*read)(reader *r, char *rest);
} keywords[] = {
    {"format", read_format},   {"element", read_element},  {"property", read_property},
    {"comment", read_comment}, {"obj_info", read_comment}, {"end_header", end_header},
};

static bool read_line(reader *r, char *line)
{
	const char *word = import_next_word(&line);
	if (!word)
		return true;
	for (size_t i = 0; i < sizeof keywords / sizeof keywords[0]; i++) {
		if (strcmp(word, keywords[i].word) == 0)
			return keywords[i].read(r, line);
	}
	return import_fail(r->loader, "line %u: \"%.40s\" has no meaning in the header of a PLY file", r->line, word);
}

/* ---- the whole --------------------------------------------------------------------------------------------------- */

/* The next line up to `end` (LF or CR), which the body follows at once: its first byte may look like part of an end of
 * line. What blanks and CR stand before the end are cut off. NULL: no such line.
 */
static char *next_line(import_text *text, char end)
{
	char *line = text->next;
	char *at = line < text->end ? memchr(line, end, (size_t)(text->end - line)) : NULL;
	if (!at)
		return NULL;
	text->next = at + 1;
	text->line++;
	while (at > line && (at[-1] == '\r' || at[-1] == ' ' || at[-1] == '\t'))
		at--;
	*at = '\0';
	return line;
}

/* The end of lines that the first line has, or a zero byte where it is not "ply". */
static char end_of_lines(const import_text *text)
{
	const char *at = text->next;
	if (strncmp(at, "ply", 3) != 0)
		return '\0';
	at += 3 + strspn(at + 3, " \t");
	return at[0] == '\n' || (at[0] == '\r' && at[1] == '\n') ? '\n' : at[0] == '\r' ? '\r' : '\0';
}

static bool check_elements(reader *r)
{
	static const uint32_t position = 1u << PLY_X | 1u << PLY_Y | 1u << PLY_Z, corners = 1u << PLY_CORNERS;
	static const uint32_t needed[PLY_KINDS] = {0, position, corners, corners};
	static const char *const names[PLY_KINDS] = {"", "x, y and z", "vertex_indices", "vertex_indices"};
	const ply_element *elements = r->header->elements.items;
	if (r->header->format == PLY_NO_FORMAT)
		return import_fail(r->loader, "its header has no format line");
	for (size_t i = 0; i < r->header->elements.count; i++) {
		ply_kind kind = elements[i].kind;
		if ((elements[i].roles & needed[kind]) != needed[kind] && elements[i].count > 0)
			return import_fail(r->loader, "element \"%s\" has no %s", elements[i].name, names[kind]);
	}
	return true;
}

bool ply_read_header(import_loader *loader, import_text *text, ply_header *header)
{
	reader r = {.loader = loader, .header = header};
	char end = end_of_lines(text), *line = end ? next_line(text, end) : NULL;
	*header = (ply_header){0};
	if (!line)
		return import_fail(loader, "is no PLY file");
	while (!r.ended && (line = next_line(text, end))) {
		r.line = text->line;
		if (!read_line(&r, line))
			return false;
	}
	return r.ended ? check_elements(&r) : import_fail(loader, "is cut off in its header");
}

void ply_header_free(ply_header *header)
{
	free(header->elements.items);
	free(header->properties.items);
	*header = (ply_header){0};
}
