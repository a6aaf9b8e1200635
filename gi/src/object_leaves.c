/* Leaves by themselves: materials of their own, and where in a texture each lies, and what is drawn of it. Of objects
 * that ask for either. */
#include "object_build.h"

#include "faces.h"
#include "host_memory.h"
#include "vec3d.h"

#include <string.h>

/* ---- materials ---- */

/* Each leaf a material: what it had becomes its own. */
bool object_own_materials(object_record *o)
{
	const uint32_t leaves = o->hierarchy.leaf_count;
	uint32_t *of_leaf = o->hierarchy.leaf_material;
	gi_material *materials = gi_malloc(sizeof *materials * leaves);
	gi_specular *specular = o->specular ? gi_malloc(sizeof *specular * leaves) : NULL;
	if (!materials || (o->specular && !specular)) {
		gi_free(materials);
		gi_free(specular);
		return false;
	}
	for (uint32_t leaf = 0; leaf < leaves; leaf++) {
		materials[leaf] = o->materials[of_leaf[leaf]];
		if (specular)
			specular[leaf] = o->specular[of_leaf[leaf]];
		of_leaf[leaf] = leaf;
	}
	gi_free(o->materials);
	gi_free(o->specular);
	o->materials = materials;
	o->specular = specular;
	o->material_count = leaves;
	o->leaf_materials = true;
	return true;
}

/* ---- texture coordinates ---- */

typedef struct mapping {
	const gi_object_def *def;
	const uint32_t *origin; /* of faces: numbers of the caller's; NULL: their own */
	const gi_refined *refined;
	uint32_t *first; /* corner of a face */
} mapping;

static gi_vec3d corner_of(const gi_object_def *def, uint32_t corner)
{
	const float *p = def->positions + 3 * (size_t)def->indices[corner], *scale = def->scale;
	return (gi_vec3d){(double)(p[0] * scale[0]), (double)(p[1] * scale[1]), (double)(p[2] * scale[2])};
}

/* At a point of a flat face: in the triangle of its fan that it lies in. */
static void map_point(const mapping *m, uint32_t face, gi_vec3d p, float out[2])
{
	const uint32_t first = m->first[face], count = gi_corner_count(m->def->face_counts, face);
	double best = -HUGE_VAL;
	for (uint32_t k = 1; k + 1 < count; k++) {
		const uint32_t corners[3] = {first, first + k, first + k + 1};
		const gi_vec3d c[3] = {corner_of(m->def, corners[0]), corner_of(m->def, corners[1]),
				       corner_of(m->def, corners[2])};
		double weights[3];
		const double least = gi_vec3d_weights(c, p, weights);
		if (!(least > best))
			continue;
		best = least;
		for (int i = 0; i < 2; i++)
			out[i] = (float)(weights[0] * m->def->uvs[2 * (size_t)corners[0] + i] +
					 weights[1] * m->def->uvs[2 * (size_t)corners[1] + i] +
					 weights[2] * m->def->uvs[2 * (size_t)corners[2] + i]);
	}
}

static void map_leaf(const mapping *m, const gi_hierarchy *h, uint32_t leaf, gi_leaf_uvs *out)
{
	const uint32_t refined = h->leaf_face[leaf], faces = m->def->face_count;
	const uint32_t face = m->refined->faces[refined] % faces; /* the second side's are behind the first's */
	const uint32_t *corners = &h->topology[h->leaf_node[leaf]].corners.x;
	*out = (gi_leaf_uvs){.face = m->origin ? m->origin[face] : face};
	for (int k = 0; m->def->uvs && k < 4; k++) {
		if (m->refined->uvs)
			memcpy(out->uvs[k], m->refined->uvs[refined][k], sizeof out->uvs[k]);
		else
			map_point(m, face, gi_vec3d_from(h->vertices[corners[k]]), out->uvs[k]);
	}
}

bool object_map_leaves(const gi_object_def *def, const uint32_t *origin, const gi_refined *refined, object_record *o)
{
	mapping m = {def, origin, refined, gi_malloc(sizeof *m.first * (def->face_count + 1))};
	o->leaf_uvs = gi_calloc(o->hierarchy.leaf_count, sizeof *o->leaf_uvs);
	const bool ready = m.first && o->leaf_uvs;
	for (uint32_t face = 0, first = 0; ready && face < def->face_count; face++) {
		m.first[face] = first;
		first += gi_corner_count(def->face_counts, face);
	}
	for (uint32_t leaf = 0; ready && leaf < o->hierarchy.leaf_count; leaf++)
		map_leaf(&m, &o->hierarchy, leaf, &o->leaf_uvs[leaf]);
	gi_free(m.first);
	return ready;
}

/* Of each triangle of a cage's surface: the material of the face that it lies on. */
static uint32_t *triangle_materials(const gi_refined *refined, const object_record *o)
{
	const gi_drawn_surface *drawn = &o->drawn;
	const uint32_t *of_face = refined->levels[refined->level_count - 1].material;
	uint32_t *materials = gi_malloc(sizeof *materials * (drawn->index_count / 3 + 1));
	for (uint32_t t = 0; materials && t < drawn->index_count / 3; t++)
		materials[t] = of_face[o->hierarchy.leaf_face[drawn->vertices[drawn->indices[3 * t]].leaf]];
	return materials;
}

bool object_chart_drawn(const gi_object_def *def, const gi_refined *refined, object_record *o)
{
	const uint32_t count = def->material_count ? def->material_count : 1;
	const bool mesh = def->draw_index_count > 0;
	const void *mesh_uvs = def->draw_uvs;
	if (def->undrawn || !(mesh ? mesh_uvs : def->uvs))
		return true;
	if (mesh)
		return gi_drawn_chart_build(&o->drawn, mesh_uvs, def->draw_face_materials, count, &o->chart);
	uint32_t *materials = triangle_materials(refined, o);
	const bool made =
	    materials && gi_drawn_chart_build(&o->drawn, (const float(*)[2])o->drawn.uvs, materials, count, &o->chart);
	gi_free(materials);
	gi_free(o->drawn.uvs);
	o->drawn.uvs = NULL;
	return made;
}
