/* An object that is built: what it is made of, and where it is. */
#include "object.h"

#include "host_memory.h"

#include <math.h>
#include <string.h>

bool object_is_alive(const object_record *o)
{
	return o->generation & 1;
}

bool object_is_seen(const object_record *o)
{
	return object_is_alive(o) && !o->hidden;
}

uint32_t object_flags(const object_record *o)
{
	return (o->plane && !o->overlaps ? GI_OBJECT_FLAT : 0) | (object_is_seen(o) ? 0 : GI_OBJECT_UNSEEN) |
	       (o->leaf_materials ? GI_OBJECT_LEAF_MATERIALS : 0) | (o->deform ? GI_OBJECT_DEFORMS : 0);
}

/* ---- materials ---- */

bool object_measure_materials(object_record *o)
{
	const gi_hierarchy *h = &o->hierarchy;
	o->emission = gi_calloc(o->material_count, sizeof *o->emission);
	if (!o->emission)
		return false;
	for (uint32_t leaf = 0; leaf < h->leaf_count; leaf++)
		o->emission[h->leaf_material[leaf]].area += (double)h->geometry[h->leaf_node[leaf]].moment.w;
	return true;
}

bool object_is_translucent(const object_record *o)
{
	return o->subsurface.leaf_count > 0;
}

uint32_t object_material_slots(const object_record *o)
{
	return (object_is_translucent(o) ? 2 : 1) * o->material_count;
}

gi_material_data object_material_data(const object_record *o, uint32_t slot)
{
	const gi_material *m = &o->materials[slot % o->material_count];
	const float e = object_is_seen(o) ? 1 : 0, rho = slot < o->material_count ? 1 : 0;
	const float other = object_is_translucent(o) && slot < o->material_count ? (float)o->material_count : 0;
	return (gi_material_data){{rho * m->rho[0], rho * m->rho[1], rho * m->rho[2], 0},
				  {e * m->exitance[0], e * m->exitance[1], e * m->exitance[2], other}};
}

void object_take_albedo(const object_record *o, gi_material *material)
{
	if (object_is_translucent(o))
		memcpy(material->rho, o->subsurface.albedo, sizeof material->rho);
}

/* ---- poses ---- */

/* Rows of the rotation matrix of a unit quaternion, in double so that a turn by 1e-7 does not scale. */
static void rotation_rows(const float q[4], double m[3][3])
{
	const double x = q[0], y = q[1], z = q[2], w = q[3];
	const double rows[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
				   {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
				   {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
	memcpy(m, rows, sizeof rows);
}

/* World box of the turned rest box, and sphere about it, each a little larger than rounding needs: a ray is never lost.
 */
static void place_bounds(object_record *o, gi_object_data *data, double m[3][3])
{
	const float *lower = &o->hierarchy.lower.x, *upper = &o->hierarchy.upper.x;
	float *world_lower = &o->world_lower.x, *world_upper = &o->world_upper.x;
	double half[3], radius = 0;
	for (int k = 0; k < 3; k++) {
		half[k] = 0.5 * ((double)upper[k] - lower[k]);
		radius += half[k] * half[k];
	}
	float *centre_out = &data->sphere.x;
	for (int r = 0; r < 3; r++) {
		double centre = o->pose.position[r], extent = 0;
		for (int k = 0; k < 3; k++) {
			centre += m[r][k] * 0.5 * ((double)upper[k] + lower[k]);
			extent += fabs(m[r][k]) * half[k];
		}
		const double pad = 1e-5 * (fabs(centre) + extent + sqrt(radius)) + 1e-20;
		world_lower[r] = (float)(centre - extent - pad);
		world_upper[r] = (float)(centre + extent + pad);
		centre_out[r] = (float)centre;
	}
	data->sphere.w = (float)(sqrt(radius) * 1.00001);
}

static gi_vec4 world_plane(const object_record *o, double m[3][3])
{
	const gi_vec4 axis = o->hierarchy.geometry[0].axis, centre = o->hierarchy.geometry[0].sphere;
	double normal[3], height = 0;
	for (int r = 0; r < 3; r++) {
		normal[r] = m[r][0] * axis.x + m[r][1] * axis.y + m[r][2] * axis.z;
		height +=
		    normal[r] * (m[r][0] * centre.x + m[r][1] * centre.y + m[r][2] * centre.z + o->pose.position[r]);
	}
	return (gi_vec4){(float)normal[0], (float)normal[1], (float)normal[2], (float)height};
}

void object_place_rows(const gi_pose *pose, gi_object_data *data)
{
	double m[3][3];
	rotation_rows(pose->rotation, m);
	gi_vec4 *rows[3] = {&data->row0, &data->row1, &data->row2};
	for (int r = 0; r < 3; r++)
		*rows[r] = (gi_vec4){(float)m[r][0], (float)m[r][1], (float)m[r][2], pose->position[r]};
}

void object_place(object_record *o, gi_object_data *data)
{
	double m[3][3];
	rotation_rows(o->pose.rotation, m);
	object_place_rows(&o->pose, data);
	place_bounds(o, data, m);
	data->plane = o->plane ? world_plane(o, m) : (gi_vec4){0, 0, 0, 0};
}

static void include(gi_vec4 lower, gi_vec4 upper, gi_vec4 *to_lower, gi_vec4 *to_upper)
{
	for (int k = 0; k < 3; k++) {
		(&to_lower->x)[k] = fminf((&to_lower->x)[k], (&lower.x)[k]);
		(&to_upper->x)[k] = fmaxf((&to_upper->x)[k], (&upper.x)[k]);
	}
}

void object_leave_trail(object_record *o)
{
	if (o->trails) {
		include(o->world_lower, o->world_upper, &o->trail_lower, &o->trail_upper);
		return;
	}
	o->trail_lower = o->world_lower;
	o->trail_upper = o->world_upper;
	o->trails = true;
}

void object_include_box(const object_record *o, gi_vec4 *lower, gi_vec4 *upper)
{
	include(o->world_lower, o->world_upper, lower, upper);
	if (o->trails)
		include(o->trail_lower, o->trail_upper, lower, upper);
}

bool object_is_smooth(const object_record *o)
{
	bool smooth = false;
	for (uint32_t m = 0; o->specular && m < o->material_count && !smooth; m++)
		smooth = material_is_smooth(&o->specular[m]);
	return smooth;
}

bool object_is_textured(const object_record *o, uint32_t material)
{
	return o->textures && (o->textures[material].base_color || o->textures[material].emissive);
}

bool object_has_glass(const object_record *o)
{
	bool glass = false;
	for (uint32_t m = 0; o->specular && m < o->material_count && !glass; m++)
		glass = material_is_glass(&o->specular[m]);
	return glass;
}
