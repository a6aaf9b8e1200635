#include "scene_object.h"

#include "bits.h"
#include "bvh_pack.h"

gi_node_topology scene_topology_of(const gi_hierarchy *h, uint32_t node, scene_base base)
{
	gi_node_topology t = h->topology[node];
	t.range.x += base.node;
	t.range.y += base.leaf;
	uint32_t *corners = &t.corners.x;
	for (int c = 0; c < 4; c++)
		corners[c] += corners[c] == GI_NONE ? 0 : base.vertex;
	return t;
}

void scene_fill_quads(const gi_hierarchy *h, gi_vec4 *quads)
{
	double area = 0;
	for (uint32_t l = 0; l < h->leaf_count; l++) {
		const gi_uvec4 corners = h->topology[h->leaf_node[l]].corners;
		gi_vec4 *quad = quads + 4 * (size_t)l;
		for (int c = 0; c < 4; c++)
			quad[c] = h->vertices[(&corners.x)[c]];
		area += (double)h->geometry[h->leaf_node[l]].moment.w;
		quad[0].w = (float)area;
	}
}

void scene_fill_tree(const object_record *o, gi_object_data *data, gi_uvec4 *tree)
{
	gi_pack_grid(&o->hierarchy.lower, &o->hierarchy.upper, &data->grid, &data->cells);
	for (uint32_t k = 0; k < o->bvh.node_count; k++)
		tree[k] = gi_pack_node(&o->bvh.nodes[k], data->grid, data->cells, o->bvh_base, o->primitive_base);
}

static float add_bits(float value, uint32_t base)
{
	const uint32_t bits = gi_bits_from_float(value);
	return gi_float_from_bits(bits == GI_NONE ? bits : bits + base);
}

void scene_fill_primitives(const object_record *o, gi_primitive *primitives)
{
	for (uint32_t k = 0; k < o->bvh.primitive_count; k++) {
		primitives[k] = o->bvh.primitives[k];
		primitives[k].a.w = add_bits(primitives[k].a.w, o->leaf_base);
	}
}
