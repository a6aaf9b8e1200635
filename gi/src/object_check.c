/* Which definitions and poses are taken. */
#include "object_build.h"

#include "faces.h"

#include <float.h>
#include <math.h>

bool object_all_within(const float *values, size_t count, float most)
{
	for (size_t k = 0; k < count; k++)
		if (!(fabsf(values[k]) <= most))
			return false;
	return true;
}

static bool all_finite(const float *values, size_t count)
{
	return object_all_within(values, count, FLT_MAX);
}

bool object_normalise_pose(const gi_log *log, gi_pose *pose, const char *object)
{
	double length = 0;
	for (int k = 0; k < 4; k++)
		length += (double)pose->rotation[k] * pose->rotation[k];
	length = sqrt(length);
	if (!object_all_within(pose->position, 3, OBJECT_MAX_LENGTH) || !isfinite(length) || length < 1e-6) {
		gi_fail(log, GI_ERROR_INVALID_POSE,
			"object '%s': the pose needs a position within 1e9 m of the origin and a rotation quaternion "
			"that is not zero",
			object);
		return false;
	}
	/* What was normalised is off by 2^-24 at most, and must stay what it is: a pose that was got may be set. */
	for (int k = 0; k < 4 && fabs(length - 1) > 0x1p-23; k++)
		pose->rotation[k] = (float)(pose->rotation[k] / length);
	return true;
}

static bool indices_are_valid(const gi_object_def *def)
{
	uint64_t corners = 0;
	for (uint32_t face = 0; face < def->face_count; face++) {
		if (gi_corner_count(def->face_counts, face) < 3)
			return false;
		corners += gi_corner_count(def->face_counts, face);
	}
	if (corners != def->index_count)
		return false;
	for (uint32_t k = 0; k < def->index_count; k++)
		if (def->indices[k] >= def->vertex_count)
			return false;
	return true;
}

static const char *broken_geometry(const gi_object_def *def)
{
	if (!def->positions || !def->indices || !def->vertex_count || !def->face_count)
		return "positions, indices, vertex_count and face_count are required";
	if (!indices_are_valid(def))
		return "a face has fewer than 3 corners, the face counts do not add up to index_count, or an index is "
		       "out of range";
	if (!all_finite(def->positions, 3 * (size_t)def->vertex_count))
		return "a position is not finite";
	if (def->crease_count && (!def->crease_vertices || !def->crease_sharpness))
		return "crease_count without crease arrays";
	for (int k = 0; k < 3; k++)
		if (!(def->scale[k] > 0.0f && isfinite(def->scale[k])))
			return "scale must be finite and above zero";
	if (!(def->light_edge >= 0.0f && def->light_edge <= 180.0f))
		return "light_edge is outside [0, 180] degrees";
	for (uint32_t k = 0; def->face_materials && k < def->face_count; k++)
		if (def->face_materials[k] >= (def->material_count ? def->material_count : 1))
			return "a face's material number is not below material_count";
	if (def->draw_index_count % 3 != 0 || (def->draw_index_count && (!def->draw_positions || !def->draw_indices)))
		return "a draw mesh needs positions and three indices a triangle";
	for (uint32_t k = 0; k < def->draw_index_count; k++)
		if (def->draw_indices[k] >= def->draw_vertex_count)
			return "an index of the draw mesh is out of range";
	for (uint32_t k = 0; k < def->leaf_cut_count; k++)
		if (!def->leaf_cuts || def->leaf_cuts[k].face >= def->face_count ||
		    !all_finite(def->leaf_cuts[k].from, 3) || !all_finite(def->leaf_cuts[k].to, 3))
			return "a leaf cut is on a face that is not there, or not finite";
	if ((def->uvs && !all_finite(def->uvs, 2 * (size_t)def->index_count)) ||
	    (def->draw_uvs && !all_finite(def->draw_uvs, 2 * (size_t)def->draw_index_count)))
		return "a texture coordinate is not finite";
	for (uint32_t k = 0; def->draw_face_materials && k < def->draw_index_count / 3; k++)
		if (def->draw_face_materials[k] >= (def->material_count ? def->material_count : 1))
			return "a material number of the draw mesh is not below material_count";
	for (uint32_t k = 0; def->leaf_sizes && k < def->face_count; k++)
		if (!(def->leaf_sizes[k] >= 0.0f && isfinite(def->leaf_sizes[k])))
			return "a face's leaf size is negative or not finite";
	if (def->draw_index_count && !all_finite(def->draw_positions, 3 * (size_t)def->draw_vertex_count))
		return "a position of the draw mesh is not finite";
	return NULL;
}

static gi_result check_subsurface(const gi_log *log, const gi_object_def *def, const char *name)
{
	const char *fault = def->subsurface ? gi_subsurface_fault(def->subsurface) : NULL;
	if (fault)
		return gi_fail(log, GI_ERROR_INVALID_MATERIAL, "object '%s': subsurface scattering: %s", name, fault);
	bool smooth = false;
	for (uint32_t k = 0; def->subsurface && def->specular && k < (def->material_count ? def->material_count : 1);
	     k++)
		smooth = smooth || material_is_mirror(&def->specular[k]) || material_is_glass(&def->specular[k]);
	return smooth
		   ? gi_fail(log, GI_ERROR_INVALID_MATERIAL,
			     "object '%s' has subsurface scattering: no material of it can be a mirror or glass", name)
		   : GI_OK;
}

static const char *broken_skin(const uint32_t *joints, const float *weights, uint32_t vertices, uint32_t joint_count)
{
	if (!joints != !weights)
		return "joints need weights, and weights joints";
	for (size_t k = 0; joints && k < 4 * (size_t)vertices; k++) {
		if (!(weights[k] >= 0.0f && isfinite(weights[k])))
			return "a joint's weight is negative or not finite";
		if (joints[k] >= joint_count)
			return "a vertex's joint is not below joint_count";
	}
	return NULL;
}

static gi_result check_deforming(const gi_log *log, const gi_object_def *def, const char *name)
{
	const bool meshed = def->draw_index_count > 0;
	const char *broken = broken_skin(def->joints, def->joint_weights, def->vertex_count, def->joint_count);
	if (!broken && meshed)
		broken =
		    broken_skin(def->draw_joints, def->draw_joint_weights, def->draw_vertex_count, def->joint_count);
	if (!broken && (def->joints || def->draw_joints) && !def->deforms)
		broken = "joints need deforms";
	if (!broken && meshed && !def->joints != !def->draw_joints)
		broken = "a cage and the mesh that is drawn have joints both or neither";
	if (!broken && def->deforms && def->subsurface)
		broken = "light scattered below the surface is made once: an object that has it cannot deform";
	if (!broken && def->deforms && def->mobility == GI_MOBILITY_STATIC)
		broken = "what deforms is movable, never static";
	return broken ? gi_fail(log, GI_ERROR_INVALID_GEOMETRY, "object '%s': %s", name, broken) : GI_OK;
}

gi_result object_check_named(const gi_log *log, const gi_object_def *def, const char *name)
{
	if (def->scheme > GI_SCHEME_LOOP || def->mobility > GI_MOBILITY_STATIC ||
	    def->boundary > GI_BOUNDARY_EDGE_ONLY || def->levels > OBJECT_MAX_LEVELS ||
	    def->draw_levels > OBJECT_MAX_DRAW_LEVELS || !(def->leaf_size >= 0.0f && isfinite(def->leaf_size)))
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT,
			       "object '%s': scheme, mobility, boundary, levels (0..%d), draw_levels (0..%d) or "
			       "leaf_size is out of range",
			       name, OBJECT_MAX_LEVELS, OBJECT_MAX_DRAW_LEVELS);
	if (def->material_count && !def->materials)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT,
			       "object '%s': material_count is %u and materials is NULL", name, def->material_count);
	const char *broken = broken_geometry(def);
	if (broken)
		return gi_fail(log, GI_ERROR_INVALID_GEOMETRY, "object '%s': %s", name, broken);
	for (uint32_t k = 0; k < def->material_count; k++)
		if (!material_is_valid(log, &def->materials[k], name, k))
			return GI_ERROR_INVALID_MATERIAL;
	for (uint32_t k = 0; def->specular && k < (def->material_count ? def->material_count : 1); k++)
		if (!material_specular_is_valid(log, &def->specular[k],
						def->material_count ? &def->materials[k] : &OBJECT_GREY, name, k))
			return GI_ERROR_INVALID_MATERIAL;
	const gi_result result = check_deforming(log, def, name);
	return result ? result : check_subsurface(log, def, name);
}

gi_result object_check_def(const gi_log *log, const gi_object_def *def)
{
	const char *name = def->name ? def->name : "unnamed";
	gi_pose pose = def->pose;
	gi_result result = object_check_named(log, def, name);
	if (!result && !object_normalise_pose(log, &pose, name))
		result = GI_ERROR_INVALID_POSE;
	return result;
}
