/* OBJ. Every o or g with faces is an object; faces of a g that is named again under the same o join it.
 *
 * What has no bearing on the shape (normals, smoothing) is passed over; what has, and is not read, is counted and told.
 * Numbers of vertices may run ahead of the vertices, as some writers put all faces first.
 */
#define _POSIX_C_SOURCE 200809L /* fileno */
#include "import_obj.h"

#include "import_mtl.h"
#include "import_path.h"
#include "import_picture.h"
#include "import_polygons.h"
#include "import_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Of one file, and bytes of each: more are no scene's, and would be looked for or read for hours. */
enum { MOST_LIBRARIES = 64, MOST_NAMES = 1000 };
static const size_t MOST_LIBRARY_BYTES = (size_t)64 << 20;

/* A name that a line gives, in the file's own text: of a group under its object, or of a material alone. */
typedef struct name_line {
	const char *object, *name; /* "" without */
	uint32_t number;           /* of the line among its like */
	uint32_t first;            /* number of the first line with the same names */
	uint32_t material;         /* usemtl: the scene's number, IMPORT_NO_MATERIAL before a face asks */
	const mtl_material *found; /* usemtl: in a library; NULL: in none */
} name_line;

typedef struct library {
	dev_t device;
	ino_t number;
} library;

typedef struct obj_reader {
	import_loader *loader;
	import_text text;
	import_polygons polygons; /* group and material number name_lines until the end of the file */
	mtl_materials materials;
	import_array groups, uses; /* name_line: of o and g; of usemtl. The first of each holds before any other */
	library libraries[MOST_LIBRARIES];
	uint32_t library_count, names; /* of libraries read, and looked for */
	import_pictures pictures;
	const char *object; /* of the last o */
} obj_reader;

static bool fail_memory(obj_reader *r)
{
	return import_fail(r->loader, "out of memory in line %u", r->text.line);
}

/* ---- vertices and faces ------------------------------------------------------------------------------------------ */

static bool read_vertex(obj_reader *r, char *rest)
{
	const char *line = import_rest_of_line(rest);
	double values[7];
	int count = 0;
	for (const char *before = rest; count < 7 && import_read_number(&rest, &values[count]); before = rest) {
		if (count++ < 3)
			import_count_digits(&r->polygons, before, rest);
	}
	import_vertex *vertex =
	    import_add_vertex(r->loader, &r->polygons, count < 3 ? NULL : values, r->text.line, line);
	if (!vertex)
		return fail_memory(r);
	vertex->colored = count == 6;
	if (vertex->colored)
		import_linear_color(values + 3, vertex->color);
	return true;
}

/* One of texture coordinates that are no numbers, or too far out, is of no use to any face. */
static bool read_uv(obj_reader *r, char *rest)
{
	double values[2] = {0, 0};
	import_uv *uv = import_array_add(&r->polygons.uvs, sizeof *uv);
	if (!uv)
		return fail_memory(r);
	bool sound = import_read_number(&rest, &values[0]);
	import_read_number(&rest, &values[1]); /* a texture may be a line */
	for (int k = 0; k < 2; k++)
		sound = sound && fabs(values[k]) < 1e6;
	for (int k = 0; k < 2; k++)
		uv->uv[k] = sound ? (float)values[k] : ENGINE_NO_UV;
	return true;
}

/* A number as the file has it, up to a slash or the end of the word. False: it is none. */
static bool parse_number(const char *word, int64_t *number)
{
	char *end;
	if ((*word < '0' || *word > '9') && *word != '-' && *word != '+')
		return false;
	*number = strtoll(word, &end, 10); /* out of range: the largest, which is no vertex either */
	return end > word && (*end == '\0' || *end == '/');
}

/* From the file's numbers (from 1 on, or back from -1, the last one before the line) to ours from 0 on. */
static uint32_t number_of(const import_array *array, const char *word)
{
	int64_t number, items = (int64_t)array->count;
	if (!parse_number(word, &number) || number < -items)
		return IMPORT_NO_VERTEX;
	int64_t counted = number < 0 ? items + 1 + number : number;
	return counted < 1 || counted >= IMPORT_MOST_ITEMS ? IMPORT_NO_VERTEX : (uint32_t)counted - 1;
}

/* vertex, vertex/uv, vertex/uv/normal, vertex//normal */
static bool read_corner(obj_reader *r, const char *word)
{
	const char *slash = strchr(word, '/');
	uint32_t *corner = import_array_add(&r->polygons.corners, sizeof *corner);
	uint32_t *uv = import_array_add(&r->polygons.corner_uvs, sizeof *uv);
	if (!corner || !uv)
		return fail_memory(r);
	*corner = number_of(&r->polygons.vertices, word);
	*uv = slash ? number_of(&r->polygons.uvs, slash + 1) : IMPORT_NO_VERTEX;
	return true;
}

static bool read_face(obj_reader *r, char *rest)
{
	uint32_t corners = 0;
	const char *word;
	while ((word = import_next_word(&rest)) && word[0] != '#') {
		if (!read_corner(r, word))
			return false;
		corners++;
	}
	import_polygon *face = import_add_polygon(&r->polygons, corners);
	if (!face)
		return fail_memory(r);
	face->place = r->text.line;
	face->group = (uint32_t)r->groups.count - 1;
	face->material = (uint32_t)r->uses.count - 1;
	return true;
}

static bool skip_points_and_lines(obj_reader *r, char *rest)
{
	(void)rest;
	import_note(r->loader, NULL, "points and lines (p, l) are left out");
	return true;
}

static bool skip(obj_reader *r, char *rest)
{
	(void)r;
	(void)rest;
	return true;
}

/* ---- names ------------------------------------------------------------------------------------------------------- */

static bool add_name_line(obj_reader *r, import_array *lines, const char *object, const char *name)
{
	name_line *line = import_array_add(lines, sizeof *line);
	if (!line)
		return fail_memory(r);
	*line = (name_line){object, name, (uint32_t)lines->count - 1, 0, IMPORT_NO_MATERIAL, NULL};
	return true;
}

static bool read_object(obj_reader *r, char *rest)
{
	r->object = import_rest_of_line(rest);
	return add_name_line(r, &r->groups, r->object, "");
}

static bool read_group(obj_reader *r, char *rest)
{
	return add_name_line(r, &r->groups, r->object, import_rest_of_line(rest));
}

static bool read_material(obj_reader *r, char *rest)
{
	return add_name_line(r, &r->uses, "", import_rest_of_line(rest));
}

static int compare_name_lines(const void *a, const void *b)
{
	const name_line *x = a, *y = b;
	int objects = strcmp(x->object, y->object), names = objects ? objects : strcmp(x->name, y->name);
	return names ? names : (x->number > y->number) - (x->number < y->number);
}

/* Tells every line which one had the same names first. By sorting: no choice of names makes that slow. */
static bool find_first_of_name(obj_reader *r, import_array *lines)
{
	name_line *all = lines->items, *sorted = malloc(lines->count * sizeof *sorted);
	if (!sorted)
		return fail_memory(r);
	memcpy(sorted, all, lines->count * sizeof *sorted);
	qsort(sorted, lines->count, sizeof *sorted, compare_name_lines);
	for (size_t i = 0, begin = 0; i < lines->count; i++) {
		if (strcmp(sorted[i].object, sorted[begin].object) != 0 ||
		    strcmp(sorted[i].name, sorted[begin].name) != 0)
			begin = i;
		all[sorted[i].number].first = sorted[begin].number;
	}
	free(sorted);
	return true;
}

/* ---- material libraries ------------------------------------------------------------------------------------------ */

/* By what it is, since a file has many names ("./a.mtl"). */
static bool was_read(obj_reader *r, FILE *file)
{
	struct stat about;
	if (fstat(fileno(file), &about) != 0)
		return true;
	for (uint32_t i = 0; i < r->library_count; i++) {
		if (r->libraries[i].device == about.st_dev && r->libraries[i].number == about.st_ino)
			return true;
	}
	r->libraries[r->library_count++] = (library){about.st_dev, about.st_ino};
	return false;
}

static bool read_open_library(obj_reader *r, FILE *file, const char *name)
{
	char fault[200];
	size_t size;
	uint8_t *bytes = import_read_all(file, MOST_LIBRARY_BYTES, &size, fault, sizeof fault);
	if (!bytes) {
		import_note(r->loader, name, "a material library %s", fault);
		return true;
	}
	bool read = mtl_read(&r->materials, r->loader, name, bytes, size);
	free(bytes);
	return read || import_fail(r->loader, "out of memory for material library \"%.80s\"", name);
}

static bool read_library(obj_reader *r, const char *name)
{
	char fault[200] = "is one of too many";
	bool one_more = r->library_count < MOST_LIBRARIES && r->names++ < MOST_NAMES;
	FILE *file = one_more ? import_open_below(r->loader->path, name, fault, sizeof fault) : NULL;
	if (!file)
		import_note(r->loader, name, "a material library %s", fault);
	else if (was_read(r, file))
		fclose(file);
	else
		return read_open_library(r, file, name);
	return true;
}

/* Names may have blanks in them, and there may be several in a line: read as one name where there is such a file. */
static bool read_libraries(obj_reader *r, char *rest)
{
	char *name = import_rest_of_line(rest), fault[8];
	if (r->names >= MOST_NAMES)
		return read_library(r, name);
	FILE *whole = import_open_below(r->loader->path, name, fault, sizeof fault);
	if (whole) {
		fclose(whole);
		return read_library(r, name);
	}
	bool read = true;
	while (read && (name = import_next_word(&rest)))
		read = read_library(r, name);
	return read;
}

/* ---- lines ------------------------------------------------------------------------------------------------------- */

static bool skip_unknown(obj_reader *r, const char *word)
{
	char first[48];
	snprintf(first, sizeof first, "%.20s, line %u", word, r->text.line);
	import_note(r->loader, first, "lines of other kinds are not read");
	return true;
}

static const struct {
	const char *word;
	bool (*read)(obj_reader *r, char *rest);
} keywords[] = {
    {"v", read_vertex},
    {"vt", read_uv},
    {"vn", skip},
    {"f", read_face},
    {"fo", read_face}, /* of files before 1995 */
    {"usemtl", read_material},
    {"o", read_object},
    {"g", read_group},
    {"mtllib", read_libraries},
    {"s", skip},
    {"l", skip_points_and_lines},
    {"p", skip_points_and_lines},
};

static bool read_line(obj_reader *r, char *line)
{
	const char *word = import_next_word(&line);
	if (!word || word[0] == '#')
		return true;
	for (size_t i = 0; i < sizeof keywords / sizeof keywords[0]; i++) {
		if (strcmp(word, keywords[i].word) == 0)
			return keywords[i].read(r, line);
	}
	return skip_unknown(r, word);
}

static bool read_lines(obj_reader *r)
{
	char *line;
	while ((line = import_next_line(&r->text))) {
		if (!read_line(r, line))
			return false;
	}
	return true;
}

/* ---- textures ---------------------------------------------------------------------------------------------------- */

/* How a texture is looked up: rows of a picture go down, coordinates go up. */
static engine_texture_use use_of(const mtl_texture *from, uint32_t number)
{
	engine_texture_use use = engine_texture_use_of(number);
	use.transform[0][0] = from->scale[0];
	use.transform[0][2] = from->offset[0];
	use.transform[1][1] = -from->scale[1];
	use.transform[1][2] = 1 - from->offset[1];
	use.wrap[0] = use.wrap[1] = from->clamp ? ENGINE_WRAP_CLAMP : ENGINE_WRAP_REPEAT;
	return use;
}

/* The texture of one kind, and its mean; false where there is none, or none that can be read, which is told. */
static bool find_texture(obj_reader *r, const mtl_material *from, mtl_texture_kind kind, engine_texture_use *use,
			 float mean[4])
{
	static const char *const names[MTL_TEXTURES] = {"Kd", "Ke", "d"};
	const mtl_texture *texture = &from->textures[kind];
	char why[160];
	if (!texture->file)
		return false;
	const uint32_t number =
	    import_find_picture(r->loader, &r->pictures, texture->file, texture->alpha, why, sizeof why);
	if (number == 0) {
		import_note(r->loader, from->name, "textures of %s are left out: %s", names[kind], why);
		return false;
	}
	*use = use_of(texture, number);
	memcpy(mean, r->loader->scene->textures[number - 1].mean, 4 * sizeof *mean);
	return true;
}

/* The mask as alpha of the diffuse texture, or of a white one, as glTF's are: so it cuts what is drawn. Where the two
 * lie differently on the surface it leaves out faces alone. */
static void join_mask(obj_reader *r, engine_scene_material *material)
{
	const engine_texture_use *mask = &material->alpha_texture, *rho = &material->rho_texture;
	if (rho->number &&
	    (memcmp(rho->transform, mask->transform, sizeof rho->transform) != 0 || rho->wrap[0] != mask->wrap[0]))
		return;
	const uint32_t number = import_combine_pictures(r->loader, &r->pictures, rho->number, mask->number);
	if (number == 0)
		return;
	if (!rho->number)
		memcpy(material->rho_factor, material->rho, sizeof material->rho_factor);
	material->alpha_texture.number = number;
	material->rho_texture = material->alpha_texture;
}

/* A texture is times Kd or Ke, 1 without, as colours of vertices are. Without the picture no one knows how much a
 * lamp's leaves: Ke stays as stated.
 */
static void read_textures(obj_reader *r, const mtl_material *from, engine_scene_material *material)
{
	float mean[4];
	for (int c = 0; c < 3; c++) {
		material->rho_factor[c] = from->has_rho ? from->rho[c] : 1;
		material->radiance_factor[c] = from->has_radiance ? from->radiance[c] : 1;
	}
	if (find_texture(r, from, MTL_DIFFUSE, &material->rho_texture, mean))
		for (int c = 0; c < 3; c++)
			material->rho[c] = material->rho_factor[c] * mean[c];
	if (find_texture(r, from, MTL_EMISSION, &material->radiance_texture, mean))
		for (int c = 0; c < 3; c++)
			material->radiance[c] = material->radiance_factor[c] * mean[c];
	if (find_texture(r, from, MTL_OPACITY, &material->alpha_texture, mean)) {
		material->cutoff = 0.5f;
		join_mask(r, material);
	}
}

/* ---- from names to numbers --------------------------------------------------------------------------------------- */

static void note_unread(obj_reader *r, const mtl_material *material)
{
	static const char *const kinds[MTL_UNREAD_KINDS] = {
	    [MTL_TRANSPARENT] = "transparency (d, Tr) is taken as opaque",
	    [MTL_MIRROR] = "mirrors, metals and glass (illum, Pm, Ks without Kd) are taken as diffuse",
	    [MTL_TEXTURE_OPTIONS] = "options -t, -mm and -cc of textures are not read",
	};
	for (int kind = 0; kind < MTL_UNREAD_KINDS; kind++) {
		if (material->unread >> kind & 1)
			import_note(r->loader, material->name, "%s", kinds[kind]);
	}
}

/* A material of the file that a face asks for; one that no library has reflects as one without Kd. */
static bool add_used_material(obj_reader *r, name_line *use)
{
	static const mtl_material unknown = {.rho = {MTL_RHO, MTL_RHO, MTL_RHO}};
	const mtl_material *from = use->found ? use->found : &unknown;
	use->material = r->loader->scene->material_count;
	engine_scene_material *material = import_add_material(r->loader, use->name);
	if (!material)
		return false;
	memcpy(material->rho, from->rho, sizeof material->rho);
	memcpy(material->radiance, from->radiance, sizeof material->radiance);
	if (!use->found) {
		import_note(r->loader, use->name, "materials that are in no library get a reflectance of 0.6");
		return true;
	}
	note_unread(r, from);
	read_textures(r, from, material);
	return true;
}

static bool number_materials(obj_reader *r)
{
	import_polygon *faces = r->polygons.faces.items;
	name_line *uses = r->uses.items;
	const uint32_t *corners = r->polygons.corners.items;
	for (size_t u = 0; u < r->uses.count; u++)
		uses[u].found = mtl_find(&r->materials, uses[u].name);
	for (size_t f = 0; f < r->polygons.faces.count; corners += faces[f++].corners) {
		name_line *use = uses + uses[faces[f].material].first;
		faces[f].material = IMPORT_NO_MATERIAL;
		/* What no library has says less than the colours of the corners. */
		if (!use->name[0] || (!use->found && import_has_color(&r->polygons, &faces[f], corners)))
			continue;
		if (use->material == IMPORT_NO_MATERIAL && !add_used_material(r, use))
			return false;
		faces[f].material = use->material;
	}
	return true;
}

static bool add_objects(obj_reader *r)
{
	import_polygon *faces = r->polygons.faces.items;
	const name_line *groups = r->groups.items;
	const char **names = malloc(r->groups.count * sizeof *names);
	if (!names)
		return fail_memory(r);
	for (size_t g = 0; g < r->groups.count; g++)
		names[g] = groups[g].name[0] ? groups[g].name : groups[g].object;
	for (size_t f = 0; f < r->polygons.faces.count; f++)
		faces[f].group = groups[faces[f].group].first;
	bool added = import_add_polygons(r->loader, &r->polygons, names, (uint32_t)r->groups.count);
	free(names);
	return added;
}

/* ---- the file ---------------------------------------------------------------------------------------------------- */

static bool read_file(obj_reader *r)
{
	if (!add_name_line(r, &r->groups, "", "") || !add_name_line(r, &r->uses, "", "") || !read_lines(r))
		return false;
	mtl_sort(&r->materials);
	if (!find_first_of_name(r, &r->groups) || !find_first_of_name(r, &r->uses) || !number_materials(r))
		return false;
	return add_objects(r);
}

static void free_reader(obj_reader *r)
{
	import_polygons_free(&r->polygons);
	mtl_free(&r->materials);
	import_pictures_free(&r->pictures);
	free(r->groups.items);
	free(r->uses.items);
}

bool import_read_obj(import_loader *loader)
{
	size_t size;
	uint8_t *bytes = import_read_file(loader, &size);
	if (!bytes)
		return false;
	obj_reader r = {.loader = loader, .text = import_text_of(bytes, size), .polygons.places = "line", .object = ""};
	bool read = read_file(&r);
	free_reader(&r);
	free(bytes);
	return read;
}
