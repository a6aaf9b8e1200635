#include "scenes/body.h"

#include <string.h>

gi_object_def scene_mesh_def(const engine_mesh *mesh)
{
	gi_object_def def = gi_object_def_default();
	def.positions = mesh->positions;
	def.vertex_count = mesh->vertex_count;
	def.face_counts = mesh->face_counts;
	def.face_count = mesh->face_count;
	def.indices = mesh->indices;
	def.index_count = mesh->index_count;
	return def;
}

gi_result scene_add_body(gi_context *gi, const scene_body *b, engine_mesh *mesh, gi_object *out)
{
	gi_material material = {0};
	memcpy(material.rho, b->rho, sizeof material.rho);
	if (b->exitance)
		memcpy(material.exitance, b->exitance, sizeof material.exitance);
	gi_object_def def = scene_mesh_def(mesh);
	def.name = b->name;
	def.crease_vertices = mesh->crease_vertices;
	def.crease_sharpness = mesh->crease_sharpness;
	def.crease_count = mesh->crease_count;
	def.scheme = b->scheme;
	def.levels = b->levels;
	def.leaf_size = b->leaf_size;
	def.materials = &material;
	def.material_count = 1;
	def.subsurface = b->subsurface;
	memcpy(def.pose.position, b->position, sizeof def.pose.position);
	def.mobility = b->moves ? GI_MOBILITY_MOVABLE : GI_MOBILITY_AUTOMATIC;
	for (int c = 0; c < 3 && b->scale > 0; c++)
		def.scale[c] = b->scale;
	if (b->draw) {
		def.draw_positions = b->draw->positions;
		def.draw_vertex_count = b->draw->vertex_count;
		def.draw_indices = b->draw->indices;
		def.draw_index_count = b->draw->index_count;
	}
	const gi_result result = gi_create_object(gi, &def, out);
	engine_mesh_free(mesh);
	return result;
}
