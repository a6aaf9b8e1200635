#include "fuzz_input.h"

#include <math.h>
#include <string.h>

/* Outward or inward, of which faces may be missing, broken, or there twice. */
static void fill_cube(input *in, cube *c, uint8_t parts, uint8_t more)
{
	static const float positions[24] = {-1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1,
					    -1, -1, 1,  1, -1, 1,  1, 1, 1,  -1, 1, 1};
	static const uint32_t faces[24] = {0, 3, 2, 1, 4, 5, 6, 7, 0, 1, 5, 4, 3, 7, 6, 2, 0, 4, 7, 3, 1, 2, 6, 5};
	memcpy(c->positions, positions, sizeof positions);
	for (int i = 0; i < 24; i++)
		c->indices[i] = faces[parts & 1 ? 23 - i : i];
	for (uint32_t f = 0; f < 6; f++) {
		c->counts[f] = 4;
		c->face_materials[f] = next_below(in, more & 1 ? 3 : 2);
	}
	for (uint32_t i = next_below(in, 4); i > 0 && parts & 2; i--)
		c->positions[next_below(in, 24)] = next_float(in);
	for (uint32_t i = next_below(in, 4); i > 0 && parts & 4; i--)
		c->indices[next_below(in, 24)] = next_byte(in);
	if (parts & 8)
		c->counts[next_below(in, 6)] = next_byte(in);
	next_floats(in, c->sharpness, 2);
}

/* Sizes and cuts of single faces, one of which may be a copy, or what gi_choose_leaves finds. */
static void refine_faces(input *in, gi_context *gi, cube *c, gi_object_def *def)
{
	uint8_t parts = next_byte(in);
	for (uint32_t i = 0; i < 4 && parts & 1; i++)
		c->indices[4 + i] = c->indices[(i + parts) % 4];
	if (parts & 2) {
		def->leaf_sizes = c->sizes;
		for (int f = 0; f < 6; f++)
			c->sizes[f] = fabsf(next_float(in));
	}
	if (parts & 4) {
		def->leaf_cuts = c->cuts;
		def->leaf_cut_count = 1 + next_below(in, 3);
	}
	for (uint32_t k = 0; k < def->leaf_cut_count; k++) {
		c->cuts[k].face = next_below(in, parts & 32 ? 7 : def->face_count);
		next_floats(in, c->cuts[k].from, 3);
		next_floats(in, c->cuts[k].to, 3);
	}
	if (parts & 8) {
		gi_leaf_choice_def choice = gi_leaf_choice_def_default();
		choice.leaves = 1 + next_byte(in);
		choice.leaf_size = parts & 16 ? fabsf(next_float(in)) : 0;
		choice.most_leaves = MOST_LEAVES;
		choice.contact = next_share(in);
		def->levels = 0;
		def->leaf_size = 0;
		check(gi_choose_leaves(gi, &choice, def, 1, &c->choice));
	}
}

gi_object_def next_definition(input *in, gi_context *gi, cube *c)
{
	static const uint32_t levels[] = {0, 0, 0, 1, 1, 2, 9, UINT32_MAX}, creases[4] = {0, 3, 3, 2};
	gi_object_def def = gi_object_def_default();
	for (int m = 0; m < 2; m++)
		c->materials[m] = next_material(in);
	const uint8_t parts = next_byte(in), more = next_byte(in);
	fill_cube(in, c, parts, more);
	def.positions = more & 2 ? NULL : c->positions;
	def.vertex_count = more & 4 ? next_below(in, 9) : 8;
	def.indices = c->indices;
	def.face_counts = more & 8 ? NULL : c->counts;
	def.face_count = 1 + next_below(in, 6);
	def.index_count = more & 16 ? next_below(in, 25) : 4 * def.face_count;
	def.face_materials = c->face_materials;
	def.materials = c->materials;
	def.material_count = more & 32 ? next_below(in, 3) : 2;
	def.crease_vertices = creases;
	def.crease_sharpness = c->sharpness;
	def.crease_count = more & 64 ? 2 : 0;
	def.scheme = (gi_scheme)next_below(in, parts & 16 ? 5 : 2);
	def.boundary = (gi_boundary)next_below(in, 3);
	def.levels = levels[next_below(in, 8)];
	def.draw_levels = next_below(in, 6);
	def.double_sided = more & 128;
	def.mobility = (gi_mobility)next_below(in, 4);
	def.pose = next_pose(in);
	if (parts & 32)
		next_floats(in, def.scale, 3);
	if (parts & 64) {
		static const float sizes[] = {1, 0.7f, NAN, -1, INFINITY, 1e30f};
		const uint32_t kind = next_below(in, 12);
		def.leaf_size = sizes[kind % 6];
		if (kind >= 6)
			refine_faces(in, gi, c, &def);
	}
	if (parts & 128) {
		def.draw_positions = c->positions;
		def.draw_vertex_count = 8;
		def.draw_indices = c->indices;
		def.draw_index_count = next_below(in, 25);
	}
	return def;
}
