#include "trace_smooth.h"

#include "../reference/light_trace.h"

#include <math.h>

/* A smooth normal may lead through its triangles where light is reflected, or back where it is refracted: there
 * light goes along them. */
static void keep_side(const vec3 flat, bool reflected, vec3 direction)
{
	const float least = 1e-3f, along = glm_vec3_dot((float *)flat, direction);
	const float push = reflected ? fmaxf(least - along, 0) : fminf(-least - along, 0);
	glm_vec3_muladds((float *)flat, push, direction);
}

bool trace_smooth_go_on(const trace_hit *hit, float lift, float chance, vec3 origin, vec3 direction, vec3 weight)
{
	const gi_specular *s = &hit->object->specular;
	const bool glass = s->index > 0 && glm_vec3_max((float *)s->transmittance) > 0;
	if (!glass && !hit->front)
		return false;
	vec3 flat, n;
	glm_vec3_scale((float *)hit->flat, hit->front ? 1 : -1, flat);
	glm_vec3_scale((float *)hit->normal, hit->front ? 1 : -1, n);
	float cosine = -glm_vec3_dot(direction, n);
	if (cosine <= 0) { /* at the rim of a round object */
		glm_vec3_copy(flat, n);
		cosine = -glm_vec3_dot(direction, n);
	}
	cosine = fminf(cosine, 1);
	const double index = hit->front ? (double)s->index : 1 / (double)s->index;
	const bool reflected = !glass || (double)chance < light_fresnel((double)cosine, index);
	if (reflected) {
		glm_vec3_muladds(n, 2 * cosine, direction);
		if (!glass)
			glm_vec3_mul(weight, (float *)s->reflectance, weight);
	} else {
		const double sine2 = (1 - (double)cosine * (double)cosine) / (index * index);
		glm_vec3_scale(direction, (float)(1 / index), direction);
		glm_vec3_muladds(n, (float)((double)cosine / index - sqrt(fmax(1 - sine2, 0))), direction);
		glm_vec3_mul(weight, (float *)s->transmittance, weight);
	}
	keep_side(flat, reflected, direction);
	glm_vec3_normalize(direction);
	glm_vec3_copy((float *)hit->point, origin);
	glm_vec3_muladds(flat, reflected ? lift : -lift, origin);
	return true;
}
