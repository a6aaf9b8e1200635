/* The life of an object's arrays, which several objects of one shape may have in common.
 *
 * What a build makes is not written to again, so that all of the shape have it: the last one frees it. Each one's own
 * are its name, its materials and textures, and of one that deforms what follows from its shape of now. All objects
 * that share are one context's, and so of one thread: the count needs no lock.
 */
#include "object_build.h"

#include "host_memory.h"

#include <string.h>

char *object_copy_name(const char *name)
{
	const size_t size = strlen(name) + 1;
	char *copy = gi_malloc(size);
	if (copy)
		memcpy(copy, name, size);
	return copy;
}

/* ---- one's own ---- */

/* What object_apply_shape and object_refit_drawn write. */
static void copy_shape(object_record *o, bool *enough)
{
	gi_hierarchy *h = &o->hierarchy;
	h->vertices = gi_copy(h->vertices, h->vertex_count, sizeof *h->vertices, enough);
	h->geometry = gi_copy(h->geometry, h->node_count, sizeof *h->geometry, enough);
	h->spread = gi_copy(h->spread, h->node_count, sizeof *h->spread, enough);
	h->topology = gi_copy(h->topology, h->node_count, sizeof *h->topology, enough);
	o->bvh.nodes = gi_copy(o->bvh.nodes, o->bvh.node_count, sizeof *o->bvh.nodes, enough);
	o->bvh.primitives = gi_copy(o->bvh.primitives, o->bvh.primitive_count, sizeof *o->bvh.primitives, enough);
	o->by_size = gi_copy(o->by_size, o->bvh.primitive_count, sizeof *o->by_size, enough);
	o->drawn.vertices = gi_copy(o->drawn.vertices, o->drawn.vertex_count, sizeof *o->drawn.vertices, enough);
	o->deform = gi_deform_copy(o->deform, h->vertex_count);
	*enough = *enough && o->deform;
}

static void free_shape(object_record *o)
{
	gi_hierarchy *h = &o->hierarchy;
	gi_free(h->vertices);
	gi_free(h->geometry);
	gi_free(h->spread);
	gi_free(h->topology);
	h->vertices = NULL;
	h->geometry = NULL;
	h->spread = NULL;
	h->topology = NULL;
	gi_bvh_free(&o->bvh);
	gi_free(o->by_size);
	o->by_size = NULL;
	gi_free(o->drawn.vertices);
	o->drawn.vertices = NULL;
}

static void copy_values(object_record *o, bool *enough)
{
	const uint32_t count = o->material_count;
	o->materials = gi_copy(o->materials, count, sizeof *o->materials, enough);
	o->specular = gi_copy(o->specular, count, sizeof *o->specular, enough);
	o->emission = gi_copy(o->emission, count, sizeof *o->emission, enough);
	for (uint32_t m = 0; o->emission && m < count; m++)
		o->emission[m] = (object_emission){.area = o->emission[m].area};
	o->textures = gi_copy(o->textures, o->chart.material_count, sizeof *o->textures, enough);
	o->name = o->name ? object_copy_name(o->name) : NULL;
	*enough = *enough && o->name;
}

/* ---- shared ---- */

bool object_share(const object_record *from, object_record *out)
{
	bool enough = true;
	*out = (object_record){.reshapes = from->reshapes,
			       .mobility = from->mobility,
			       .sharers = from->sharers,
			       .name = from->name,
			       .materials = from->materials,
			       .specular = from->specular,
			       .leaf_materials = from->leaf_materials,
			       .leaf_uvs = from->leaf_uvs,
			       .subsurface = from->subsurface,
			       .emission = from->emission,
			       .material_count = from->material_count,
			       .hierarchy = from->hierarchy,
			       .bvh = from->bvh,
			       .drawn = from->drawn,
			       .chart = from->chart,
			       .textures = from->textures,
			       .by_size = from->by_size,
			       .deform = from->deform,
			       .plane = from->plane,
			       .overlaps = from->overlaps};
	memcpy(out->scale, from->scale, sizeof out->scale);
	++*out->sharers;
	copy_values(out, &enough);
	if (out->deform)
		copy_shape(out, &enough);
	if (!enough)
		object_free(out);
	return enough;
}

void object_free(object_record *o)
{
	const bool last = !o->sharers || --*o->sharers == 0;
	gi_free(o->name);
	gi_free(o->materials);
	gi_free(o->specular);
	gi_free(o->emission);
	gi_free(o->textures);
	if (last || o->hierarchy.deforms)
		free_shape(o);
	gi_deform_free(o->deform, last);
	if (last) {
		gi_free(o->sharers);
		gi_free(o->leaf_uvs);
		gi_hierarchy_free(&o->hierarchy);
		gi_subsurface_free(&o->subsurface);
		gi_drawn_free(&o->drawn);
		gi_drawn_chart_free(&o->chart);
	}
	*o = (object_record){.generation = o->generation,
			     .leaf_id = o->leaf_id,
			     .node_id = o->node_id,
			     .leaf_ids = o->leaf_ids,
			     .node_ids = o->node_ids};
}
