/* The header of a PLY file: which elements follow, in which order, of which properties. */
#ifndef ENGINE_IMPORT_PLY_HEADER_H
#define ENGINE_IMPORT_PLY_HEADER_H

#include "import_polygons.h"
#include "import_text.h"

typedef enum ply_format { PLY_NO_FORMAT, PLY_ASCII, PLY_LITTLE_ENDIAN, PLY_BIG_ENDIAN } ply_format;

typedef enum ply_type {
	PLY_NO_TYPE, /* as the type of a count: no list */
	PLY_INT8,
	PLY_UINT8,
	PLY_INT16,
	PLY_UINT16,
	PLY_INT32,
	PLY_UINT32,
	PLY_FLOAT32,
	PLY_FLOAT64,
} ply_type;

/* What a property is to the reader. */
typedef enum ply_role {
	PLY_IGNORED,
	PLY_X,
	PLY_Y,
	PLY_Z,
	PLY_RED,
	PLY_GREEN,
	PLY_BLUE,
	PLY_CORNERS, /* list of vertex numbers */
	PLY_ROLES,
} ply_role;

typedef struct ply_property {
	ply_type type;       /* of the value, or of the items of a list */
	ply_type count_type; /* of a list's length, else PLY_NO_TYPE */
	ply_role role;
} ply_property;

typedef enum ply_kind { PLY_OTHER, PLY_VERTEX, PLY_FACE, PLY_STRIPS, PLY_KINDS } ply_kind;

typedef struct ply_element {
	ply_kind kind;
	char name[32]; /* cut short where it is longer */
	uint64_t count;
	uint32_t first_property, property_count;
	uint32_t roles; /* bits 1 << ply_role of its properties */
} ply_element;

typedef struct ply_header {
	ply_format format;
	import_array elements;   /* ply_element, in the file's order */
	import_array properties; /* ply_property, those of one element side by side */
	uint64_t vertex_count;
	bool has_texture; /* a comment names one (MeshLab writes such) */
} ply_header;

/* Bytes of a value of that type. */
size_t ply_size(ply_type type);

/* Reads up to the end of the line of end_header, where text->next is left. False: reported. *header is good for
 * ply_header_free() in either case.
 */
bool ply_read_header(import_loader *loader, import_text *text, ply_header *header);

void ply_header_free(ply_header *header);

#endif
