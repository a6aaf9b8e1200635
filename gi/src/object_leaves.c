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
	const gi_refined *chart; /* of a smooth surface: texture coordinates refined as it was, as positions */
	uint32_t *first;         /* corner of a face */
} mapping;

static uint32_t base_face(const gi_refined *refined, uint32_t face)
{
	for (uint32_t level = refined->level_count - 1; level > 0; level--)
		face = refined->levels[level].parent[face];
	return face;
}

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
	const uint32_t face = base_face(m->refined, refined) % faces; /* the second side's are behind the first's */
	const uint32_t *corners = &h->topology[h->leaf_node[leaf]].corners.x;
	*out = (gi_leaf_uvs){.face = m->origin ? m->origin[face] : face};
	for (int k = 0; m->def->uvs && k < 4; k++) {
		if (m->chart)
			memcpy(out->uvs[k],
			       m->chart->positions[m->chart->levels[m->chart->level_count - 1].corners[refined][k]],
			       sizeof out->uvs[k]);
		else
			map_point(m, face, gi_vec3d_from(h->vertices[corners[k]]), out->uvs[k]);
	}
}

static void chart_corner(const gi_object_def *def, uint32_t corner, uint32_t number, float *positions,
			 uint32_t *indices)
{
	indices[number] = number;
	positions[3 * (size_t)number] = def->uvs[2 * (size_t)corner];
	positions[3 * (size_t)number + 1] = def->uvs[2 * (size_t)corner + 1];
}

/* The cage's faces apart from each other, at their texture coordinates: refined like the cage, face by face, they stay
 * flat, so that each finer face lies where it does in the texture. */
static bool make_chart(const gi_object_def *def, const gi_refine_cage *cage, uint32_t levels, gi_refined *out)
{
	const uint32_t corners = def->index_count, sides = cage->face_count / def->face_count;
	float *positions = gi_calloc(3 * (size_t)corners * sides, sizeof *positions);
	uint32_t *indices = gi_malloc(sizeof *indices * corners * sides);
	const bool enough = positions && indices;
	uint32_t first = 0;
	for (uint32_t face = 0; enough && face < def->face_count; face++) {
		const uint32_t count = gi_corner_count(def->face_counts, face);
		for (uint32_t k = 0; k < count; k++) {
			chart_corner(def, first + k, first + k, positions, indices);
			if (sides > 1) /* turned round */
				chart_corner(def, first + count - 1 - k, corners + first + k, positions, indices);
		}
		first += count;
	}
	char message[256];
	gi_refine_cage chart = {.positions = positions,
				.face_counts = cage->face_counts,
				.indices = indices,
				.vertex_count = corners * sides,
				.face_count = cage->face_count,
				.index_count = corners * sides,
				.scheme = cage->scheme == GI_REFINE_LOOP ? GI_REFINE_LOOP : GI_REFINE_BILINEAR,
				.scale = {1, 1, 1}};
	const bool made = enough && gi_refine(&chart, levels, out, message, sizeof message);
	gi_free(positions);
	gi_free(indices);
	return made;
}

bool object_map_leaves(const gi_object_def *def, const gi_refine_cage *cage, const uint32_t *origin,
		       const gi_refined *refined, object_record *o)
{
	gi_refined chart = {0};
	mapping m = {def, origin, refined, NULL, gi_malloc(sizeof *m.first * (def->face_count + 1))};
	o->leaf_uvs = gi_calloc(o->hierarchy.leaf_count, sizeof *o->leaf_uvs);
	bool ready = m.first && o->leaf_uvs;
	if (ready && def->uvs && def->scheme != GI_SCHEME_BILINEAR) {
		ready = make_chart(def, cage, refined->level_count - 1, &chart);
		m.chart = &chart;
	}
	for (uint32_t face = 0, first = 0; ready && face < def->face_count; face++) {
		m.first[face] = first;
		first += gi_corner_count(def->face_counts, face);
	}
	for (uint32_t leaf = 0; ready && leaf < o->hierarchy.leaf_count; leaf++)
		map_leaf(&m, &o->hierarchy, leaf, &o->leaf_uvs[leaf]);
	gi_refined_free(&chart);
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
