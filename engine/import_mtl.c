#define _POSIX_C_SOURCE 200809L /* strdup */
#include "import_mtl.h"

#include "import_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct reader {
	mtl_materials *all;
	mtl_material *material; /* the one that is described; NULL before the first newmtl */
	import_loader *loader;
	const char *name; /* of the library */
	import_text text;
	bool out_of_memory;
} reader;

static void note_broken(reader *r, const char *what)
{
	char where[64];
	snprintf(where, sizeof where, "%s, line %u of %.30s", what, r->text.line, r->name);
	import_note(r->loader, where, "broken lines of material libraries are not read");
}

/* ---- lines ------------------------------------------------------------------------------------------------------- */

static void begin_material(reader *r, char *rest)
{
	mtl_material *material = import_array_add(&r->all->items, sizeof *material);
	r->material = NULL; /* the array may have moved */
	if (!material) {
		r->out_of_memory = true;
		return;
	}
	*material = (mtl_material){.name = strdup(import_rest_of_line(rest)),
				   .order = (uint32_t)r->all->items.count,
				   .rho = {MTL_RHO, MTL_RHO, MTL_RHO}};
	r->out_of_memory = !material->name;
	r->material = material;
}

/* One number for all channels, or three. */
static bool read_color(char *rest, float color[3])
{
	double values[3];
	int count = 0;
	while (count < 3 && import_read_number(&rest, &values[count]))
		count++;
	if (count != 3 && (count != 1 || (rest = import_rest_of_line(rest), *rest && *rest != '#')))
		return false;
	for (int c = 0; c < 3; c++) {
		double value = values[count == 3 ? c : 0];
		if (!(value >= 0 && isfinite(value)))
			return false;
		color[c] = (float)fmin(value, 1e30); /* brought into range with those of all formats */
	}
	return true;
}

static void read_diffuse(reader *r, char *rest)
{
	float color[3];
	if (!read_color(rest, color)) {
		note_broken(r, "Kd");
		return;
	}
	memcpy(r->material->rho, color, sizeof color);
	r->material->has_rho = true;
}

static void read_emission(reader *r, char *rest)
{
	float color[3];
	if (!read_color(rest, color)) {
		note_broken(r, "Ke");
		return;
	}
	memcpy(r->material->radiance, color, sizeof color);
	r->material->has_radiance = true;
}

static void read_specular(reader *r, char *rest)
{
	float color[3];
	r->material->shines = read_color(rest, color) && color[0] + color[1] + color[2] > 0;
}

static void set_unread(reader *r, mtl_unread kind, bool is_so)
{
	r->material->unread &= ~(1u << kind);
	r->material->unread |= (uint32_t)is_so << kind;
}

static void read_opacity(reader *r, char *rest)
{
	double value;
	char *word = rest;
	if (strncmp(import_rest_of_line(rest), "-halo", 5) == 0)
		import_next_word(&word);
	set_unread(r, MTL_TRANSPARENT, import_read_number(&word, &value) && value < 1);
}

static void read_transparency(reader *r, char *rest)
{
	double value;
	set_unread(r, MTL_TRANSPARENT, import_read_number(&rest, &value) && value > 0);
}

/* Models 3 to 9 trace rays to what a surface mirrors or lets through. */
static void read_illumination(reader *r, char *rest)
{
	double value;
	set_unread(r, MTL_MIRROR, import_read_number(&rest, &value) && value >= 3 && value <= 9);
}

static void read_metalness(reader *r, char *rest)
{
	double value;
	if (import_read_number(&rest, &value) && value > 0)
		set_unread(r, MTL_MIRROR, true);
}

/* ---- textures ---- */

/* Up to three numbers, of which two count: the picture has no depth. */
static void read_pair(char **rest, float pair[2])
{
	double value;
	for (int k = 0; k < 3 && import_read_number(rest, &value); k++)
		if (k < 2 && fabs(value) <= 1e6)
			pair[k] = (float)value;
}

static void read_channel(const char *word, mtl_texture *texture)
{
	static const char letters[] = "mrgbl"; /* in the order of engine_alpha */
	const char *at = word && word[0] ? strchr(letters, word[0]) : NULL;
	if (at)
		texture->alpha = (engine_alpha)(at - letters);
}

/* Options with one word behind them that change nothing here, and those that would. */
static const struct {
	const char *name;
	uint32_t words;
	bool told;
} other_options[] = {{"-blendu", 1, false}, {"-blendv", 1, false}, {"-texres", 1, false}, {"-bm", 1, false},
		     {"-boost", 1, false},  {"-type", 1, false},   {"-cc", 1, true},      {"-mm", 2, true}};

/* Passes over one option and what belongs to it. False: it is none of those that textures have. */
static bool read_option(reader *r, const char *name, char **rest, mtl_texture *texture)
{
	float unread[2];
	if (strcmp(name, "-s") == 0) {
		read_pair(rest, texture->scale);
	} else if (strcmp(name, "-o") == 0) {
		read_pair(rest, texture->offset);
	} else if (strcmp(name, "-t") == 0) {
		read_pair(rest, unread);
		set_unread(r, MTL_TEXTURE_OPTIONS, true);
	} else if (strcmp(name, "-clamp") == 0) {
		const char *word = import_next_word(rest);
		texture->clamp = word && strcmp(word, "on") == 0;
	} else if (strcmp(name, "-imfchan") == 0) {
		read_channel(import_next_word(rest), texture);
	} else {
		for (size_t k = 0; k < sizeof other_options / sizeof *other_options; k++) {
			if (strcmp(name, other_options[k].name) != 0)
				continue;
			for (uint32_t w = 0; w < other_options[k].words; w++)
				import_next_word(rest);
			if (other_options[k].told)
				set_unread(r, MTL_TEXTURE_OPTIONS, true);
			return true;
		}
		return false;
	}
	return true;
}

/* The last word, of a line with an option that nobody knows. */
static char *last_word(char *line)
{
	char *blank = strrchr(line, ' '), *tab = strrchr(line, '\t');
	return blank > tab ? blank + 1 : tab ? tab + 1 : line;
}

/* A name between quotation marks is what is between them. */
static char *without_quotes(char *file)
{
	const size_t length = strlen(file);
	if (length < 2 || file[0] != '"' || file[length - 1] != '"')
		return file;
	file[length - 1] = '\0';
	return file + 1;
}

/* Options, then the file, whose name may have blanks in it. */
static void read_texture(reader *r, char *rest, mtl_texture_kind kind)
{
	mtl_texture texture = {.scale = {1, 1}, .alpha = kind == MTL_OPACITY ? ENGINE_ALPHA_MASK : ENGINE_ALPHA_OWN};
	char *file = import_rest_of_line(rest);
	bool known = true;
	while (file[0] == '-' && known) {
		char *after = file, *last = last_word(file), name[16];
		snprintf(name, sizeof name, "%.*s", (int)strcspn(file, " \t"), file);
		after += strcspn(file, " \t");
		known = *after && read_option(r, name, &after, &texture);
		file = known ? import_rest_of_line(after) : last;
	}
	file = without_quotes(file);
	if (!file[0]) {
		note_broken(r, "a texture");
		return;
	}
	mtl_texture *to = &r->material->textures[kind];
	free(to->file);
	*to = texture;
	to->file = strdup(file);
	r->out_of_memory = !to->file;
}

static void read_diffuse_texture(reader *r, char *rest)
{
	read_texture(r, rest, MTL_DIFFUSE);
}

static void read_emission_texture(reader *r, char *rest)
{
	read_texture(r, rest, MTL_EMISSION);
}

static void read_opacity_texture(reader *r, char *rest)
{
	read_texture(r, rest, MTL_OPACITY);
}

/* All other keys say how a surface shines, bumps or is named elsewhere. */
static const struct {
	const char *key;
	void (*read)(reader *r, char *rest);
} keys[] = {
    {"Kd", read_diffuse},
    {"Ke", read_emission},
    {"Ks", read_specular},
    {"d", read_opacity},
    {"Tr", read_transparency},
    {"map_d", read_opacity_texture},
    {"illum", read_illumination},
    {"Pm", read_metalness},
    {"map_Kd", read_diffuse_texture},
    {"map_Ke", read_emission_texture},
};

static void read_line(reader *r, char *line)
{
	char *key = import_next_word(&line);
	if (!key || key[0] == '#')
		return;
	if (strcmp(key, "newmtl") == 0) {
		begin_material(r, line);
		return;
	}
	for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
		if (strcmp(key, keys[i].key) != 0)
			continue;
		if (r->material)
			keys[i].read(r, line);
		else
			note_broken(r, "before newmtl");
	}
}

bool mtl_read(mtl_materials *materials, import_loader *loader, const char *name, uint8_t *bytes, size_t size)
{
	reader r = {.all = materials, .loader = loader, .name = name, .text = import_text_of(bytes, size)};
	char *line;
	while (!r.out_of_memory && (line = import_next_line(&r.text)))
		read_line(&r, line);
	return !r.out_of_memory;
}

/* ---- all of them ------------------------------------------------------------------------------------------------- */

static void free_material(mtl_material *material)
{
	free(material->name);
	for (int k = 0; k < MTL_TEXTURES; k++)
		free(material->textures[k].file);
}

static int compare(const void *a, const void *b)
{
	const mtl_material *x = a, *y = b;
	int names = strcmp(x->name, y->name);
	return names ? names : (x->order > y->order) - (x->order < y->order);
}

void mtl_sort(mtl_materials *materials)
{
	mtl_material *all = materials->items.items;
	size_t count = materials->items.count, kept = 0;
	if (count > 0)
		qsort(all, count, sizeof *all, compare);
	for (size_t i = 0; i < count; i++) {
		if (i + 1 < count && strcmp(all[i].name, all[i + 1].name) == 0)
			free_material(&all[i]);
		else
			all[kept++] = all[i];
	}
	materials->items.count = kept;
	for (size_t i = 0; i < kept; i++) {
		if (all[i].shines && all[i].rho[0] + all[i].rho[1] + all[i].rho[2] == 0)
			all[i].unread |= 1u << MTL_MIRROR;
	}
}

static int compare_name(const void *name, const void *material)
{
	return strcmp(name, ((const mtl_material *)material)->name);
}

const mtl_material *mtl_find(const mtl_materials *materials, const char *name)
{
	size_t count = materials->items.count;
	return count > 0 ? bsearch(name, materials->items.items, count, sizeof(mtl_material), compare_name) : NULL;
}

void mtl_free(mtl_materials *materials)
{
	mtl_material *all = materials->items.items;
	for (size_t i = 0; i < materials->items.count; i++)
		free_material(&all[i]);
	free(all);
	*materials = (mtl_materials){0};
}
