#include "export.h"

#include "output.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- field ---------------------------------------------------------------------------------------------------------
 */

/* A triangle repeats its third corner. */
static uint32_t corner_count(const gi_leaf *leaf)
{
	return memcmp(leaf->corners[2], leaf->corners[3], sizeof leaf->corners[2]) == 0 ? 3 : 4;
}

static int32_t object_number(const export_objects *objects, gi_object object)
{
	for (uint32_t k = 0; k < objects->count; k++)
		if (objects->handles[k].index1 == object.index1 && objects->handles[k].generation == object.generation)
			return (int32_t)k;
	return -1;
}

/* Bytes of a little-endian 32-bit word, whatever this machine's order. */
static void put_word(FILE *file, uint32_t word)
{
	const uint8_t bytes[4] = {(uint8_t)word, (uint8_t)(word >> 8), (uint8_t)(word >> 16), (uint8_t)(word >> 24)};
	fwrite(bytes, 1, sizeof bytes, file);
}

static void put_floats(FILE *file, const float *values, uint32_t count)
{
	for (uint32_t k = 0; k < count; k++) {
		uint32_t word;
		memcpy(&word, values + k, sizeof word);
		put_word(file, word);
	}
}

/* A name may hold anything but an end of line. */
static void put_comment(FILE *file, uint32_t number, const char *name)
{
	fprintf(file, "comment object %u ", number);
	for (; *name; name++)
		fputc((unsigned char)*name < ' ' ? ' ' : *name, file);
	fputc('\n', file);
}

static void put_header(FILE *file, const export_objects *objects, uint32_t vertices, uint32_t faces)
{
	static const char *const properties[] = {"rho_r", "rho_g", "rho_b", "e_r", "e_g", "e_b", "b_r", "b_g", "b_b"};
	fputs("ply\nformat binary_little_endian 1.0\ncomment one face a leaf; rho reflectance, e exitance and b "
	      "radiosity in W/m2\n",
	      file);
	for (uint32_t k = 0; k < objects->count; k++)
		put_comment(file, k, objects->names[k]);
	fprintf(file, "element vertex %u\nproperty float x\nproperty float y\nproperty float z\n", vertices);
	fprintf(file, "element face %u\nproperty list uchar int vertex_indices\n", faces);
	for (size_t k = 0; k < sizeof properties / sizeof *properties; k++)
		fprintf(file, "property float %s\n", properties[k]);
	fputs("property int object\nend_header\n", file);
}

static void put_face(FILE *file, const export_objects *objects, const gi_leaf *leaf, uint32_t first_vertex)
{
	const uint32_t corners = corner_count(leaf);
	fputc((int)corners, file);
	for (uint32_t k = 0; k < corners; k++)
		put_word(file, first_vertex + k);
	put_floats(file, leaf->rho, 3);
	put_floats(file, leaf->exitance, 3);
	put_floats(file, leaf->radiosity, 3);
	put_word(file, (uint32_t)object_number(objects, leaf->object));
}

static void write_field(FILE *file, const export_objects *objects, const gi_leaf *leaves, uint32_t count)
{
	uint32_t vertices = 0;
	for (uint32_t k = 0; k < count; k++)
		vertices += corner_count(leaves + k);
	put_header(file, objects, vertices, count);
	for (uint32_t k = 0; k < count; k++)
		put_floats(file, leaves[k].corners[0], 3 * corner_count(leaves + k));
	uint32_t first = 0;
	for (uint32_t k = 0; k < count; k++) {
		put_face(file, objects, leaves + k, first);
		first += corner_count(leaves + k);
	}
}

/* The caller frees *leaves. */
static bool read_leaves(gi_context *gi, gi_leaf **leaves, uint32_t *count, char *message, size_t message_size)
{
	*leaves = NULL;
	gi_result result = gi_read_leaves(gi, NULL, 0, count);
	if (!result && !(*leaves = malloc((*count + !*count) * sizeof **leaves)))
		result = GI_ERROR_OUT_OF_MEMORY;
	if (!result)
		result = gi_read_leaves(gi, *leaves, *count, count);
	if (result)
		snprintf(message, message_size, "the leaves cannot be read: %s", gi_result_text(result));
	return result == GI_OK;
}

bool export_field(gi_context *gi, const export_objects *objects, const char *path, char *message, size_t message_size)
{
	gi_leaf *leaves;
	uint32_t count;
	if (!read_leaves(gi, &leaves, &count, message, message_size)) {
		free(leaves);
		return false;
	}
	engine_output output;
	bool written = engine_output_open(&output, path, message, message_size);
	if (written) {
		write_field(output.file, objects, leaves, count);
		written = engine_output_close(&output, true, message, message_size);
	}
	free(leaves);
	return written;
}

/* ---- form factors --------------------------------------------------------------------------------------------------
 */

/* Quoted where CSV needs it; a row stays one line. */
static void put_name(FILE *file, const char *name)
{
	const bool quoted = strpbrk(name, ",\"") || strcmp(name, "*") == 0;
	if (quoted)
		fputc('"', file);
	for (; *name; name++) {
		if (*name == '"')
			fputc('"', file);
		fputc((unsigned char)*name < ' ' ? ' ' : *name, file);
	}
	if (quoted)
		fputc('"', file);
}

static void put_factor(FILE *file, const char *from, const char *to, double factor)
{
	put_name(file, from);
	fputc(',', file);
	if (to)
		put_name(file, to);
	else
		fputc('*', file);
	fprintf(file, ",%.12g\n", factor);
}

/* `to` and `factors` are room for count + 1; the last handle is nobody's: towards all. */
static gi_result write_row(FILE *file, gi_context *gi, const export_objects *objects, uint32_t from, gi_object *to,
			   double *factors)
{
	memcpy(to, objects->handles, sizeof *to * objects->count);
	to[objects->count] = (gi_object){0};
	const gi_result result = gi_form_factors(gi, objects->handles[from], to, objects->count + 1, factors);
	for (uint32_t k = 0; !result && k <= objects->count; k++)
		put_factor(file, objects->names[from], k < objects->count ? objects->names[k] : NULL, factors[k]);
	return result;
}

bool export_form_factors(gi_context *gi, const export_objects *objects, const char *path, char *message,
			 size_t message_size)
{
	engine_output output;
	if (!engine_output_open(&output, path, message, message_size))
		return false;
	fputs("from,to,F\n", output.file);
	gi_object *to = malloc(sizeof *to * (objects->count + 1));
	double *factors = malloc(sizeof *factors * (objects->count + 1));
	gi_result result = to && factors ? GI_OK : GI_ERROR_OUT_OF_MEMORY;
	for (uint32_t k = 0; !result && k < objects->count; k++)
		result = write_row(output.file, gi, objects, k, to, factors);
	free(to);
	free(factors);
	const bool written = engine_output_close(&output, result == GI_OK, message, message_size);
	if (result)
		snprintf(message, message_size, "form factors cannot be read: %s", gi_result_text(result));
	return written;
}
