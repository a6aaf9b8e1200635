/* How fine a scene is cut: gi_choose_leaves.
 *
 *   definitions --parts--> each face's share of the scene's leaf size --a size that gives the leaves wanted-->
 *   sizes of all faces --contact.c--> cuts --counted, and the size mended for what cuts add--> definitions
 */
#include "contact.h"
#include "context.h"
#include "duplicates.h"
#include "faces.h"
#include "host_memory.h"
#include "vec3d.h"

#include <string.h>

enum { CHOICE_COOKIE = 0x6c656176, SOFTWARE_LEAVES = 4000, GPU_LEAVES = 20000, MOST_LEAVES = 100000 };

/* A lamp is worth this many leaves a side. */
static const double LAMP_SIDE = 3;

/* Cuts may take the leaves this far above what was asked for. */
static const double OVERSHOOT = 1.15;

/* How much is cut: with strips and at the reach asked for, less where that would more than double the leaves of a scene
 * and add more than a few hundred: piles of things that nearly touch everywhere. */
static const struct {
	double reach;
	bool strips;
} EFFORTS[] = {{1, true}, {1, false}, {0.25, false}, {0, false}};
enum { LEAST_EFFORT = 3 };
static const double MOST_ADDED = 500, MOST_TIMES = 2;

typedef struct choice_memory {
	uint32_t count;
	float **sizes; /* of each object's faces; NULL: the definition keeps its own fineness */
	gi_leaf_cut **cuts;
} choice_memory;

typedef struct chooser {
	const gi_leaf_choice_def *def;
	gi_unique_faces *unique; /* of each object: faces that will be there */
	gi_object_def *objects;  /* copies of those, with what was chosen so far */
	uint32_t count;
	double **shares; /* of each face: its size over the scene's */
	double **lamps;  /* of each face: smaller is not wanted for a lamp, metres; 0: no lamp */
	choice_memory *memory;
	double largest; /* diagonal of the largest part, metres */
	double size;
	int effort; /* of EFFORTS */
} chooser;

gi_leaf_choice_def gi_leaf_choice_def_default(void)
{
	return (gi_leaf_choice_def){
	    .most_leaves = MOST_LEAVES, .finest = 0.25f, .contact = 0.5f, .internal = CHOICE_COOKIE};
}

static void free_memory(choice_memory *m)
{
	for (uint32_t k = 0; m && k < m->count; k++) {
		if (m->sizes)
			gi_free(m->sizes[k]);
		if (m->cuts)
			gi_free(m->cuts[k]);
	}
	if (m) {
		gi_free(m->sizes);
		gi_free(m->cuts);
	}
	gi_free(m);
}

void gi_free_leaf_choice(gi_leaf_choice *choice)
{
	if (!choice)
		return;
	free_memory(choice->memory);
	*choice = (gi_leaf_choice){0};
}

static bool is_chosen(const gi_object_def *def)
{
	return def->levels == 0 && !(def->leaf_size > 0);
}

/* ---- parts: faces that share vertices ---- */

static void join_faces(const gi_object_def *def, uint32_t *group)
{
	for (uint32_t k = 0; k < def->vertex_count; k++)
		group[k] = k;
	for (uint32_t face = 0, first = 0; face < def->face_count; first += gi_corner_count(def->face_counts, face++))
		for (uint32_t k = 1; k < gi_corner_count(def->face_counts, face); k++)
			gi_join(group, def->indices[first + k], def->indices[first]);
}

static gi_vec3d position(const gi_object_def *def, uint32_t vertex)
{
	const float *p = def->positions + 3 * (size_t)vertex;
	return (gi_vec3d){(double)p[0] * def->scale[0], (double)p[1] * def->scale[1], (double)p[2] * def->scale[2]};
}

/* diagonals[v]: of the bounds of the part that vertex v names, metres. */
static bool measure_parts(const gi_object_def *def, uint32_t *group, double *diagonals)
{
	gi_vec3d *lower = gi_malloc(sizeof *lower * def->vertex_count),
		 *upper = gi_malloc(sizeof *upper * def->vertex_count);
	for (uint32_t k = 0; lower && upper && k < def->vertex_count; k++) {
		lower[k] = (gi_vec3d){INFINITY, INFINITY, INFINITY};
		upper[k] = (gi_vec3d){-INFINITY, -INFINITY, -INFINITY};
	}
	for (uint32_t k = 0; lower && upper && k < def->index_count; k++) {
		const uint32_t part = gi_group_of(group, def->indices[k]);
		const gi_vec3d p = position(def, def->indices[k]);
		lower[part] = (gi_vec3d){fmin(lower[part].x, p.x), fmin(lower[part].y, p.y), fmin(lower[part].z, p.z)};
		upper[part] = (gi_vec3d){fmax(upper[part].x, p.x), fmax(upper[part].y, p.y), fmax(upper[part].z, p.z)};
	}
	for (uint32_t k = 0; lower && upper && k < def->vertex_count; k++)
		diagonals[k] = lower[k].x <= upper[k].x ? gi_vec3d_length(gi_vec3d_sub(upper[k], lower[k])) : 0;
	const bool done = lower && upper;
	gi_free(lower);
	gi_free(upper);
	return done;
}

static bool is_lamp(const gi_object_def *def, uint32_t face)
{
	return def->material_count &&
	       material_emits(&def->materials[def->face_materials ? def->face_materials[face] : 0]);
}

static double face_area(const gi_object_def *def, uint32_t first, uint32_t count)
{
	gi_vec3d sum = {0};
	for (uint32_t k = 2; k < count; k++)
		sum = gi_vec3d_add(sum, gi_vec3d_triangle(position(def, def->indices[first]),
							  position(def, def->indices[first + k - 1]),
							  position(def, def->indices[first + k])));
	return gi_vec3d_length(sum);
}

/* Diagonals of each face's part go to shares, for now. */
static bool survey_object(chooser *c, uint32_t object)
{
	const gi_object_def *def = &c->objects[object];
	uint32_t *group = gi_malloc(sizeof *group * def->vertex_count);
	double *diagonals = gi_malloc(sizeof *diagonals * def->vertex_count);
	c->shares[object] = gi_malloc(sizeof **c->shares * def->face_count);
	c->lamps[object] = gi_malloc(sizeof **c->lamps * def->face_count);
	c->memory->sizes[object] = is_chosen(def) ? gi_malloc(sizeof **c->memory->sizes * def->face_count) : NULL;
	bool done = group && diagonals && c->shares[object] && c->lamps[object] &&
		    (!is_chosen(def) || c->memory->sizes[object]);
	if (done) {
		join_faces(def, group);
		done = measure_parts(def, group, diagonals);
	}
	for (uint32_t face = 0, first = 0; done && face < def->face_count;
	     first += gi_corner_count(def->face_counts, face++)) {
		c->shares[object][face] = diagonals[gi_group_of(group, def->indices[first])];
		c->largest = fmax(c->largest, c->shares[object][face]);
		c->lamps[object][face] =
		    is_lamp(def, face)
			? sqrt(face_area(def, first, gi_corner_count(def->face_counts, face))) / LAMP_SIDE
			: 0;
	}
	gi_free(group);
	gi_free(diagonals);
	return done;
}

/* A part a quarter as large has leaves of half the size. */
static bool survey(chooser *c)
{
	for (uint32_t k = 0; k < c->count; k++)
		if (!survey_object(c, k))
			return false;
	for (uint32_t k = 0; k < c->count; k++)
		for (uint32_t face = 0; face < c->objects[k].face_count; face++) {
			const double ratio = c->largest > 0 ? c->shares[k][face] / c->largest : 1;
			c->shares[k][face] = fmax(sqrt(ratio), (double)c->def->finest);
		}
	return true;
}

/* ---- sizes ---- */

static void set_size(chooser *c, double size)
{
	c->size = size;
	for (uint32_t k = 0; k < c->count; k++) {
		float *sizes = c->memory->sizes[k], least = (float)size;
		for (uint32_t face = 0; sizes && face < c->objects[k].face_count; face++) {
			const double lamp = c->lamps[k][face], own = size * c->shares[k][face];
			sizes[face] = (float)(lamp > 0 ? fmin(own, fmax(lamp, size * (double)c->def->finest)) : own);
			least = fminf(least, sizes[face]);
		}
		if (!sizes)
			continue;
		/* Smooth schemes take one size for all. */
		c->objects[k].leaf_size = least;
		c->objects[k].leaf_sizes = sizes;
	}
}

static double estimate(chooser *c, double size)
{
	double sum = 0;
	set_size(c, size);
	for (uint32_t k = 0; k < c->count; k++)
		sum += object_estimate_leaves(&c->objects[k]);
	return sum;
}

/* Halves the range of sizes, by ratio, until it is within a hundredth. Where there are many small faces anyway, the
 * large ones still get half of what was asked for. */
static double size_for(chooser *c, double leaves)
{
	double high = 2 * fmax(c->largest, 1e-12), low = high * 1e-6;
	const double least = estimate(c, high), wanted = fmax(leaves, least + 0.5 * leaves);
	while (high > 1.01 * low) {
		const double middle = sqrt(low * high);
		if (estimate(c, middle) > wanted)
			low = middle;
		else
			high = middle;
	}
	return high;
}

/* ---- cuts ---- */

static void drop_cuts(chooser *c)
{
	for (uint32_t k = 0; k < c->count; k++) {
		gi_free(c->memory->cuts[k]);
		c->memory->cuts[k] = NULL;
		if (c->memory->sizes[k]) {
			c->objects[k].leaf_cuts = NULL;
			c->objects[k].leaf_cut_count = 0;
		}
	}
}

static bool find_cuts(chooser *c)
{
	drop_cuts(c);
	gi_contact_object *contacts = gi_calloc((size_t)c->count + 1, sizeof *contacts);
	uint32_t *places = gi_calloc((size_t)c->count + 1, sizeof *places);
	uint32_t flat = 0;
	for (uint32_t k = 0; contacts && places && k < c->count; k++)
		if (c->objects[k].scheme == GI_SCHEME_BILINEAR) {
			contacts[flat] = (gi_contact_object){.def = &c->objects[k],
							     .moves = c->def->moves && c->def->moves[k],
							     .sizes = c->memory->sizes[k]};
			places[flat++] = k;
		}
	const bool done = contacts && places &&
			  gi_find_contacts(contacts, flat, EFFORTS[c->effort].reach * (double)c->def->contact,
					   EFFORTS[c->effort].strips);
	for (uint32_t k = 0; contacts && places && k < flat; k++) {
		c->memory->cuts[places[k]] = contacts[k].cuts;
		c->objects[places[k]].leaf_cuts =
		    c->memory->sizes[places[k]] ? contacts[k].cuts : c->objects[places[k]].leaf_cuts;
		if (c->memory->sizes[places[k]])
			c->objects[places[k]].leaf_cut_count = contacts[k].cut_count;
	}
	gi_free(contacts);
	gi_free(places);
	return done;
}

static bool count_leaves(const chooser *c, uint64_t *count)
{
	*count = 0;
	for (uint32_t k = 0; k < c->count; k++) {
		uint64_t leaves;
		if (!object_count_leaves(&c->objects[k], &leaves))
			return false;
		*count += leaves;
	}
	return true;
}

/* Cuts as much as is worth it at the present size. */
static bool cut_and_count(chooser *c, uint64_t *count)
{
	const double uncut = estimate(c, c->size);
	for (;; c->effort++) {
		if (!find_cuts(c) || !count_leaves(c, count))
			return false;
		if (c->effort == LEAST_EFFORT || (double)*count <= MOST_TIMES * uncut + MOST_ADDED)
			return true;
	}
}

/* Cuts add leaves: the size grows by as much, unless it was given. */
static bool cut_and_mend(chooser *c, double leaves, uint64_t *count)
{
	enum { TURNS = 3 };
	const double wanted = fmax(leaves, estimate(c, c->size));
	for (int turn = 0;; turn++) {
		if (!cut_and_count(c, count))
			return false;
		if (c->def->leaf_size > 0 || (double)*count <= OVERSHOOT * wanted || turn == TURNS)
			return true;
		set_size(c, c->size * sqrt((double)*count / wanted));
	}
}

/* ---- the whole ---- */

static gi_result check(const gi_context *gi, const gi_leaf_choice_def *def, const gi_object_def *objects,
		       uint32_t count)
{
	const gi_log *log = &gi->gpu.log;
	if (def->internal != CHOICE_COOKIE)
		return gi_fail(log, GI_ERROR_INVALID_DEF, "start from gi_leaf_choice_def_default()");
	if (!(def->leaf_size >= 0 && isfinite(def->leaf_size) && def->finest > 0 && def->finest <= 1 &&
	      def->contact >= 0 && def->contact <= 1 && def->most_leaves > 0))
		return gi_fail(
		    log, GI_ERROR_INVALID_ARGUMENT,
		    "leaf_size, finest (0..1], contact [0..1] or most_leaves of a leaf choice is out of range");
	gi_result result = GI_OK;
	for (uint32_t k = 0; !result && k < count; k++)
		result = object_check_def(&gi->gpu.log, &objects[k]);
	return result;
}

/* Of which the leaves fit with what cuts may add to them; 0: none does. */
static double fitting_size(chooser *c)
{
	const double most = (c->def->most_leaves - MOST_ADDED) / MOST_TIMES;
	double size = c->size;
	while (estimate(c, size) > most) {
		if (size > 4 * c->largest)
			return 0;
		size *= 1.1;
	}
	return object_rounded_size(size);
}

static gi_result refuse(const gi_context *gi, chooser *c, double leaves)
{
	const gi_log *log = &gi->gpu.log;
	const double size = c->size, fits = fitting_size(c);
	if (!(fits > 0))
		return gi_fail(
		    log, GI_ERROR_INVALID_ARGUMENT,
		    "would be %.0f leaves of %g, more than %u, and no leaf size makes them few enough: there "
		    "are too many faces",
		    leaves, size, c->def->most_leaves);
	return gi_fail(log, GI_ERROR_INVALID_ARGUMENT,
		       "would be %.0f leaves of %g, more than %u: a leaf size of %g fits", leaves, size,
		       c->def->most_leaves, fits);
}

/* Every definition has a fineness of its own. */
static gi_result count_kept(const gi_context *gi, const chooser *c, gi_leaf_choice *out)
{
	double leaves = 0;
	for (uint32_t k = 0; k < c->count; k++)
		leaves += object_estimate_leaves(&c->objects[k]);
	if (leaves > c->def->most_leaves)
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_ARGUMENT,
			       "would be %.0f leaves, more than %u: fewer levels fit", leaves, c->def->most_leaves);
	out->leaves = (uint32_t)leaves;
	return GI_OK;
}

static gi_result choose(const gi_context *gi, chooser *c, gi_leaf_choice *out)
{
	bool chosen = false;
	for (uint32_t k = 0; k < c->count; k++)
		chosen = chosen || is_chosen(&c->objects[k]);
	if (!chosen)
		return count_kept(gi, c, out);
	const double leaves = c->def->leaves ? c->def->leaves : gi->gpu.software ? SOFTWARE_LEAVES : GPU_LEAVES;
	uint64_t count = 0;
	if (!survey(c))
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory for choosing leaves");
	const double size = c->def->leaf_size > 0 ? (double)c->def->leaf_size : size_for(c, leaves);
	const double rough = estimate(c, size);
	if (rough > c->def->most_leaves)
		return refuse(gi, c, rough);
	if (!cut_and_mend(c, leaves, &count))
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory for choosing leaves");
	if (count > c->def->most_leaves)
		return refuse(gi, c, (double)count);
	out->leaves = (uint32_t)count;
	out->leaf_size = out->least_size = (float)c->size;
	for (uint32_t k = 0; k < c->count; k++) {
		out->cuts += c->memory->sizes[k] ? c->objects[k].leaf_cut_count : 0;
		for (uint32_t face = 0; c->memory->sizes[k] && face < c->objects[k].face_count; face++)
			out->least_size = fminf(out->least_size, c->memory->sizes[k][face]);
	}
	return GI_OK;
}

static bool allocate(chooser *c, const gi_object_def *objects)
{
	const size_t count = (size_t)c->count + 1;
	c->unique = gi_calloc(count, sizeof *c->unique);
	c->objects = gi_malloc(sizeof *c->objects * count);
	c->shares = gi_calloc(count, sizeof *c->shares);
	c->lamps = gi_calloc(count, sizeof *c->lamps);
	c->memory = gi_calloc(1, sizeof *c->memory);
	if (!c->unique || !c->objects || !c->shares || !c->lamps || !c->memory)
		return false;
	c->memory->count = c->count;
	c->memory->sizes = gi_calloc(count, sizeof *c->memory->sizes);
	c->memory->cuts = gi_calloc(count, sizeof *c->memory->cuts);
	if (!c->memory->sizes || !c->memory->cuts)
		return false;
	for (uint32_t k = 0; k < c->count; k++) {
		if (!gi_unique_faces_make(&objects[k], &c->unique[k]))
			return false;
		c->objects[k] = c->unique[k].def;
	}
	return true;
}

static void free_chooser(chooser *c)
{
	for (uint32_t k = 0; k < c->count; k++) {
		if (c->shares)
			gi_free(c->shares[k]);
		if (c->lamps)
			gi_free(c->lamps[k]);
		if (c->unique)
			gi_unique_faces_free(&c->unique[k]);
	}
	gi_free(c->unique);
	gi_free(c->objects);
	gi_free(c->shares);
	gi_free(c->lamps);
	free_memory(c->memory);
}

/* By the numbers that the caller's faces have; those that will be left out get the size of all. */
static bool renumber(const gi_unique_faces *from, uint32_t face_count, float **sizes, gi_leaf_cut *cuts,
		     uint32_t cut_count)
{
	float *all = gi_calloc(face_count, sizeof *all);
	if (!all)
		return false;
	for (uint32_t k = 0; k < from->def.face_count; k++)
		all[from->origin[k]] = (*sizes)[k];
	gi_free(*sizes);
	*sizes = all;
	for (uint32_t k = 0; k < cut_count; k++)
		cuts[k].face = from->origin[cuts[k].face];
	return true;
}

static bool hand_over(chooser *c, gi_object_def *objects)
{
	for (uint32_t k = 0; k < c->count; k++) {
		const uint32_t cuts = c->objects[k].leaf_cut_count;
		if (c->memory->sizes[k] && c->unique[k].dropped &&
		    !renumber(&c->unique[k], objects[k].face_count, &c->memory->sizes[k], c->memory->cuts[k], cuts))
			return false;
	}
	for (uint32_t k = 0; k < c->count; k++) {
		if (!c->memory->sizes[k])
			continue;
		objects[k].leaf_size = c->objects[k].leaf_size;
		objects[k].leaf_sizes = c->memory->sizes[k];
		objects[k].leaf_cuts = c->memory->cuts[k];
		objects[k].leaf_cut_count = c->objects[k].leaf_cut_count;
	}
	return true;
}

static gi_result choose_and_hand_over(gi_context *gi, const gi_leaf_choice_def *def, gi_object_def *objects,
				      uint32_t count, gi_leaf_choice *out)
{
	gi_result result = check(gi, def, objects, count);
	if (result)
		return result;
	chooser c = {.def = def, .count = count};
	bool enough = allocate(&c, objects);
	if (enough)
		result = choose(gi, &c, out);
	enough = enough && (result || hand_over(&c, objects));
	if (!enough)
		result = gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory for choosing leaves");
	if (result) {
		*out = (gi_leaf_choice){0};
	} else {
		out->memory = c.memory;
		c.memory = NULL;
	}
	free_chooser(&c);
	return result;
}

gi_result gi_choose_leaves(gi_context *gi, const gi_leaf_choice_def *def, gi_object_def *objects, uint32_t count,
			   gi_leaf_choice *out)
{
	if (out)
		*out = (gi_leaf_choice){0};
	if (!gi || !def || !out || (count && !objects))
		return gi_fail_null(gi, "gi_choose_leaves: def, objects and out");
	const gi_allocator *before = gi_memory_from(&gi->def.allocator);
	const gi_result result = choose_and_hand_over(gi, def, objects, count, out);
	gi_memory_from(before);
	return result;
}
