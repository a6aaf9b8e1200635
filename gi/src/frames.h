/* Between an object's rest frame and the world, in double. */
#ifndef GI_FRAMES_H
#define GI_FRAMES_H

#include "vec3d.h"

static inline gi_vec3d gi_direction_to_world(const gi_object_data *d, gi_vec3d v)
{
	return (gi_vec3d){gi_vec3d_dot(gi_vec3d_from(d->row0), v), gi_vec3d_dot(gi_vec3d_from(d->row1), v),
			  gi_vec3d_dot(gi_vec3d_from(d->row2), v)};
}

static inline gi_vec3d gi_point_to_world(const gi_object_data *d, gi_vec3d p)
{
	const gi_vec3d v = gi_direction_to_world(d, p);
	return (gi_vec3d){v.x + d->row0.w, v.y + d->row1.w, v.z + d->row2.w};
}

static inline gi_vec3d gi_direction_to_rest(const gi_object_data *d, gi_vec3d v)
{
	return gi_vec3d_add(
	    gi_vec3d_add(gi_vec3d_scale(gi_vec3d_from(d->row0), v.x), gi_vec3d_scale(gi_vec3d_from(d->row1), v.y)),
	    gi_vec3d_scale(gi_vec3d_from(d->row2), v.z));
}

static inline gi_vec3d gi_point_to_rest(const gi_object_data *d, gi_vec3d p)
{
	return gi_direction_to_rest(d, (gi_vec3d){p.x - d->row0.w, p.y - d->row1.w, p.z - d->row2.w});
}

#endif
