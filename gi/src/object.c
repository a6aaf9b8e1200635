/* Builds one object from its definition: checks it, refines its cage, builds its hierarchy, the tree for rays and what
 * is drawn of it. All on the CPU; of a context only what its renderer can hold is asked, so several threads may build
 * objects at once.
 */
#include "object_build.h"

#include "duplicates.h"
#include "faces.h"
#include "host_memory.h"
#include "overlap.h"
#include "scene_limits.h"
#include "split.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { NAME_BYTES = 128 };

/* Draw levels stop here: a picture has no use for more triangles than this per object. */
static const uint64_t MAX_DRAW_FACES = 200000;

static const double DEGREE = 3.14159265358979323846 / 180;

/* ---- building ---- */

static bool copy_values(object_record *o, const gi_object_def *def, const char *name)
{
	o->material_count = def->material_count ? def->material_count : 1;
	o->materials = gi_malloc(sizeof(gi_material) * o->material_count);
	o->name = object_copy_name(name);
	o->specular = def->specular ? gi_malloc(sizeof(gi_specular) * o->material_count) : NULL;
	o->sharers = gi_malloc(sizeof *o->sharers);
	if (o->sharers)
		*o->sharers = 1;
	if (!o->materials || !o->name || (def->specular && !o->specular) || !o->sharers)
		return false;
	if (def->specular)
		memcpy(o->specular, def->specular, sizeof(gi_specular) * o->material_count);
	if (def->material_count)
		memcpy(o->materials, def->materials, sizeof(gi_material) * def->material_count);
	else
		o->materials[0] = OBJECT_GREY;
	o->pose = def->pose;
	memcpy(o->scale, def->scale, sizeof o->scale);
	if (def->subsurface && !gi_subsurface_build(&o->hierarchy, def->subsurface, &o->subsurface))
		return false;
	for (uint32_t m = 0; m < o->material_count; m++)
		object_take_albedo(o, &o->materials[m]);
	return (!def->leaf_materials || object_own_materials(o)) && object_measure_materials(o);
}

/* Bilinear surfaces gain nothing from finer drawing. */
static uint32_t draw_levels(const gi_object_def *def, const object_record *o, uint32_t levels)
{
	uint32_t extra = def->scheme == GI_SCHEME_BILINEAR ? 0 : def->draw_levels;
	while (extra && (levels + extra > OBJECT_MAX_LEVELS ||
			 ((uint64_t)o->hierarchy.leaf_count << (2 * extra)) > MAX_DRAW_FACES))
		extra--;
	return extra;
}

/* Of normals across an edge over which light is shared. */
static double least_cosine(const gi_object_def *def)
{
	if (def->light_edge > 0)
		return cos((double)def->light_edge * DEGREE);
	return def->draw_index_count ? GI_LIGHT_CAGE_EDGE_COSINE : GI_LIGHT_EDGE_COSINE;
}

static bool build_finer_drawn(const gi_object_def *def, const gi_refine_cage *cage, const gi_refined *coarse,
			      uint32_t levels, uint32_t extra, object_record *o)
{
	gi_refined fine;
	char message[256];
	gi_refine_cage shape = *cage;
	shape.uvs = NULL; /* the leaves have them */
	if (!gi_refine(&shape, levels + extra, &fine, message, sizeof message))
		return false;
	const bool ok = gi_drawn_from_cage(&o->hierarchy, coarse, &fine, def->uvs ? o->leaf_uvs : NULL,
					   least_cosine(def), &o->drawn);
	if (ok && o->deform)
		gi_deform_take_drawn(o->deform, &fine, fine.level_count > coarse->level_count);
	gi_refined_free(&fine);
	return ok;
}

/* What is drawn finer than it is lit yields to what memory there is. */
static bool build_drawn(const gi_object_def *def, const gi_refine_cage *cage, gi_refined *coarse, uint32_t levels,
			object_record *o)
{
	if (def->undrawn)
		return gi_drawn_from_nothing(&o->hierarchy, coarse, least_cosine(def), &o->drawn);
	if (def->draw_index_count) {
		float *scaled = gi_malloc(sizeof(float) * 3 * def->draw_vertex_count);
		if (!scaled)
			return false;
		for (size_t k = 0; k < 3 * (size_t)def->draw_vertex_count; k++)
			scaled[k] = def->draw_positions[k] * def->scale[k % 3];
		const bool ok = gi_drawn_from_mesh(&o->hierarchy, scaled, def->draw_vertex_count, def->draw_indices,
						   def->draw_index_count, least_cosine(def), &o->drawn);
		gi_free(scaled);
		return ok;
	}
	for (uint32_t extra = draw_levels(def, o, levels); extra; extra--)
		if (build_finer_drawn(def, cage, coarse, levels, extra, o))
			return true;
	const bool ok = gi_drawn_from_cage(&o->hierarchy, coarse, coarse, def->uvs ? o->leaf_uvs : NULL,
					   least_cosine(def), &o->drawn);
	if (ok && o->deform)
		gi_deform_take_drawn(o->deform, coarse, false);
	return ok;
}

static bool is_too_small(const gi_hierarchy *h)
{
	for (uint32_t n = 0; n < h->node_count; n++)
		if (!(h->geometry[n].moment.w >= OBJECT_MIN_AREA))
			return true;
	return false;
}

static bool is_too_large(const gi_hierarchy *h)
{
	return !object_all_within(&h->lower.x, 3, OBJECT_MAX_LENGTH) ||
	       !object_all_within(&h->upper.x, 3, OBJECT_MAX_LENGTH);
}

/* Does the whole object lie in one plane? To 1e-6 of its size, as rays' ends are. */
static bool is_plane(const gi_hierarchy *h)
{
	const gi_vec4 axis = h->geometry[0].axis, centre = h->geometry[0].sphere;
	if (axis.w < 0.999999f)
		return false;
	for (uint32_t k = 0; k < h->vertex_count; k++) {
		const gi_vec4 v = h->vertices[k];
		const double height = (double)axis.x * ((double)v.x - centre.x) +
				      (double)axis.y * ((double)v.y - centre.y) +
				      (double)axis.z * ((double)v.z - centre.z);
		if (fabs(height) > 1e-6 * centre.w)
			return false;
	}
	return true;
}

/* A face of n corners becomes n quads, then four each. */
static double leaves_at_level(const gi_refine_cage *cage, uint32_t levels)
{
	return levels ? ldexp(cage->index_count, 2 * ((int)levels - 1)) : cage->face_count;
}

static gi_split_def split_def_of(const gi_object_def *def)
{
	return (gi_split_def){def->leaf_size, def->leaf_sizes, def->leaf_cuts, def->leaf_cut_count};
}

double object_estimate_leaves(const gi_object_def *def)
{
	const gi_refine_cage cage = object_cage_of(def);
	const gi_split_def split = split_def_of(def);
	return (def->double_sided ? 2 : 1) *
	       (object_is_split(def) ? gi_split_estimate(&cage, &split) : leaves_at_level(&cage, object_levels(def)));
}

bool object_count_leaves(const gi_object_def *def, uint64_t *count)
{
	const gi_refine_cage cage = object_cage_of(def);
	const gi_split_def split = split_def_of(def);
	gi_refined refined;
	char message[256];
	*count = (uint64_t)object_estimate_leaves(def);
	if (!object_is_split(def))
		return true;
	if (!gi_split(&cage, &split, &refined, message, sizeof message))
		return false;
	*count = (def->double_sided ? 2 : 1) * (uint64_t)refined.levels[refined.level_count - 1].face_count;
	gi_refined_free(&refined);
	return true;
}

/* Is a table of so many leaves within what the renderer binds? Away from any renderer: can it be at all? */
static bool can_hold(const object_builder *b, double leaves)
{
	if (!(leaves <= GI_ENTRY_LEAF_MASK))
		return false;
	return !b->gpu || limits_can_hold(b->gpu, (uint64_t)leaves, 1);
}

static gi_result refine_levels(const object_builder *b, const gi_object_def *def, const gi_refine_cage *cage,
			       const char *name, gi_refined *refined)
{
	const gi_log *log = b->log;
	char message[256];
	const uint32_t levels = object_levels(def);
	uint32_t fitting = levels;
	while (fitting && !can_hold(b, leaves_at_level(cage, fitting)))
		fitting--;
	if (!can_hold(b, leaves_at_level(cage, fitting)))
		return gi_fail(log, GI_ERROR_INVALID_GEOMETRY,
			       "object '%s': its %u faces are more leaves than rows can be made of: use a coarser cage",
			       name, cage->face_count);
	if (fitting < levels)
		return gi_fail(log, GI_ERROR_INVALID_GEOMETRY,
			       "object '%s': %u faces at level %u are %.3g leaves, more than rows can be made of: use "
			       "level %u or less",
			       name, cage->face_count, levels, leaves_at_level(cage, levels), fitting);
	if (!gi_refine(cage, levels, refined, message, sizeof message))
		return gi_fail(log, refined->out_of_memory ? GI_ERROR_OUT_OF_MEMORY : GI_ERROR_INVALID_GEOMETRY,
			       "object '%s': %s", name, message);
	return GI_OK;
}

/* Of leaf sizes and cuts, those of the second side too. */
static bool make_split_def(const gi_object_def *def, gi_split_def *out, float **sizes, gi_leaf_cut **cuts)
{
	const uint32_t faces = def->face_count, n = def->leaf_cut_count;
	*sizes = gi_malloc(sizeof **sizes * 2 * faces);
	*cuts = gi_malloc(sizeof **cuts * (2 * (size_t)n + 1));
	if (!*sizes || !*cuts)
		return false;
	for (uint32_t k = 0; k < faces; k++)
		(*sizes)[k] = (*sizes)[faces + k] =
		    def->leaf_sizes && def->leaf_sizes[k] > 0 ? def->leaf_sizes[k] : def->leaf_size;
	for (uint32_t k = 0; k < n; k++) {
		(*cuts)[k] = (*cuts)[n + k] = def->leaf_cuts[k];
		(*cuts)[n + k].face += faces;
	}
	*out = (gi_split_def){def->leaf_size, *sizes, *cuts, def->double_sided ? 2 * n : n};
	return true;
}

double object_rounded_size(double size)
{
	const double unit = pow(10, floor(log10(size)) - 1);
	return ceil(size / unit) * unit;
}

static gi_result split_faces(const object_builder *b, const gi_object_def *def, const gi_refine_cage *cage,
			     const char *name, gi_refined *refined)
{
	const gi_log *log = b->log;
	char message[256] = "out of memory";
	float *sizes;
	gi_leaf_cut *cuts;
	gi_split_def split;
	gi_result result = GI_ERROR_OUT_OF_MEMORY;
	if (make_split_def(def, &split, &sizes, &cuts)) {
		const double leaves = gi_split_estimate(cage, &split);
		if (!can_hold(b, leaves))
			result =
			    gi_fail(log, GI_ERROR_INVALID_GEOMETRY,
				    "object '%s': leaves of %g would be about %.3g, more than this renderer holds: "
				    "raise leaf_size, to %.2g or more for 100,000 of them",
				    name, (double)def->leaf_size, leaves,
				    object_rounded_size((double)def->leaf_size * sqrt(leaves / 1e5)));
		else
			result =
			    gi_split(cage, &split, refined, message, sizeof message)
				? GI_OK
				: gi_fail(log,
					  refined->out_of_memory ? GI_ERROR_OUT_OF_MEMORY : GI_ERROR_INVALID_GEOMETRY,
					  "object '%s': %s", name, message);
	} else {
		gi_fail(log, result, "object '%s': out of memory", name);
	}
	gi_free(sizes);
	gi_free(cuts);
	return result;
}

/* What comes above and beside the hierarchy. */
static gi_result build_on_hierarchy(const gi_log *log, const gi_unique_faces *unique, const gi_refine_cage *cage,
				    const char *name, gi_refined *refined, object_record *o)
{
	const gi_object_def *def = &unique->def;
	const bool mapped = def->uvs || def->leaf_materials;
	const gi_result result = def->deforms ? object_make_shape(log, def, name, refined, o) : GI_OK;
	if (result)
		return result;
	if (def->double_sided)
		object_hide_backs(&o->hierarchy);
	o->by_size = gi_bvh_build(&o->hierarchy, &o->bvh) ? gi_bvh_by_size(&o->bvh) : NULL;
	if (!o->by_size || !copy_values(o, def, name) ||
	    (mapped && !object_map_leaves(def, unique->origin, refined, o)) ||
	    !build_drawn(def, cage, refined, refined->level_count - 1, o) || !object_chart_drawn(def, refined, o))
		return gi_fail(log, GI_ERROR_OUT_OF_MEMORY, "object '%s': out of memory", name);
	if (o->deform)
		object_note_sizes(o);
	/* What may bend is in no plane, wherever it is now. */
	o->plane = !def->deforms && is_plane(&o->hierarchy);
	o->overlaps = o->plane && gi_plane_overlaps(&o->bvh);
	return GI_OK;
}

static gi_result build(const object_builder *b, const gi_unique_faces *unique, const gi_refine_cage *cage,
		       const char *name, object_record *o)
{
	const gi_object_def *def = &unique->def;
	const gi_log *log = b->log;
	char message[256] = "out of memory";
	gi_refined refined;
	gi_result result = object_is_split(def) ? split_faces(b, def, cage, name, &refined)
						: refine_levels(b, def, cage, name, &refined);
	if (result)
		return result;
	if (!gi_hierarchy_build(&refined, &o->hierarchy, message, sizeof message)) {
		result = gi_fail(log, o->hierarchy.out_of_memory ? GI_ERROR_OUT_OF_MEMORY : GI_ERROR_INVALID_GEOMETRY,
				 "object '%s': %s", name, message);
	} else if (is_too_small(&o->hierarchy)) {
		result = gi_fail(log, GI_ERROR_INVALID_GEOMETRY,
				 "object '%s' is too small: its leaves have areas below 1e-24 m2", name);
	} else if (is_too_large(&o->hierarchy)) {
		result = gi_fail(log, GI_ERROR_INVALID_GEOMETRY,
				 "object '%s' is too large: it reaches farther than 1e9 m from its origin", name);
	} else {
		result = build_on_hierarchy(log, unique, cage, name, &refined, o);
	}
	gi_refined_free(&refined);
	return result;
}

/* The same, of a definition that may hold faces twice. */
static gi_result make(const object_builder *b, const gi_object_def *def, const char *name, object_record *o)
{
	const gi_log *log = b->log;
	gi_unique_faces unique;
	if (!gi_unique_faces_make(def, &unique))
		return gi_fail(log, GI_ERROR_OUT_OF_MEMORY, "object '%s': out of memory", name);
	if (unique.dropped)
		gi_warn(log, "object '%s': %u of its %u faces have the corners of another one and are left out", name,
			unique.dropped, def->face_count);
	object_cage own = {0};
	gi_refine_cage cage = object_cage_of(&unique.def);
	gi_result result;
	if (def->double_sided && !object_make_two_sided(&unique.def, &cage, &own))
		result = gi_fail(log, GI_ERROR_OUT_OF_MEMORY, "object '%s': out of memory", name);
	else
		result = build(b, &unique, &cage, name, o);
	for (uint32_t leaf = 0; !result && o->deform && unique.origin && leaf < o->deform->leaf_count; leaf++)
		o->deform->faces[leaf] = unique.origin[o->deform->faces[leaf]];
	object_cage_free(&own);
	gi_unique_faces_free(&unique);
	return result;
}

/* What messages, which are one line, have room for; whole characters of UTF-8. */
static void clip_name(const char *name, char out[NAME_BYTES])
{
	size_t length = 0;
	while (length < NAME_BYTES - 1 && name[length])
		length++;
	while (length && ((unsigned char)name[length] & 0xC0) == 0x80)
		length--;
	memcpy(out, name, length);
	out[length] = '\0';
}

gi_result object_build(const object_builder *b, const gi_object_def *def, object_record *out)
{
	char name[NAME_BYTES];
	*out = (object_record){0};
	clip_name(def->name ? def->name : "unnamed", name);
	gi_result result = object_check_named(b->log, def, name);
	if (result)
		return result;
	gi_pose pose = def->pose;
	if (!object_normalise_pose(b->log, &pose, name))
		return GI_ERROR_INVALID_POSE;
	if (b->gpu)
		gi_progress(b->log, b->number, 0, "building object '%s'", name);
	result = make(b, def, name, out);
	if (result) {
		object_free(out);
		return result;
	}
	out->pose = pose;
	out->mobility = def->deforms ? GI_MOBILITY_MOVABLE : def->mobility;
	return GI_OK;
}
