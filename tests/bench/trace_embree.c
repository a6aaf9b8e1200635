#include "trace_embree.h"

#include "../reference/embree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct trace_embree {
	const trace_scene *scene;
	RTCDevice device;
	RTCScene top;
	RTCScene own[TRACE_MOST_OBJECTS]; /* of what moves; else NULL */
	RTCGeometry instances[TRACE_MOST_OBJECTS];
	float lift;
};

static RTCGeometry make_triangles(trace_embree *e, const trace_object *o)
{
	RTCGeometry geometry = rtcNewGeometry(e->device, RTC_GEOMETRY_TYPE_TRIANGLE);
	float *positions = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(vec3),
						   o->vertex_count);
	uint32_t *corners = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
						    3 * sizeof(uint32_t), o->triangle_count);
	if (!positions || !corners) {
		rtcReleaseGeometry(geometry);
		return NULL;
	}
	memcpy(corners, o->corners, 3 * sizeof *corners * o->triangle_count);
	for (uint32_t v = 0; v < o->vertex_count; v++) {
		float *const from = o->positions + 3 * (size_t)v, *const to = positions + 3 * (size_t)v;
		if (o->moves)
			glm_vec3_copy(from, to);
		else
			glm_mat4_mulv3((vec4 *)o->world, from, 1, to);
	}
	rtcCommitGeometry(geometry);
	return geometry;
}

static bool add_still(trace_embree *e, uint32_t number)
{
	RTCGeometry geometry = make_triangles(e, &e->scene->objects[number]);
	if (!geometry)
		return false;
	rtcAttachGeometryByID(e->top, geometry, number);
	rtcReleaseGeometry(geometry);
	return true;
}

static bool add_mover(trace_embree *e, uint32_t number)
{
	RTCGeometry geometry = make_triangles(e, &e->scene->objects[number]);
	e->own[number] = geometry ? rtcNewScene(e->device) : NULL;
	if (e->own[number]) {
		rtcAttachGeometry(e->own[number], geometry);
		rtcSetSceneFlags(e->own[number], RTC_SCENE_FLAG_ROBUST);
		rtcCommitScene(e->own[number]);
		e->instances[number] = rtcNewGeometry(e->device, RTC_GEOMETRY_TYPE_INSTANCE);
		rtcSetGeometryInstancedScene(e->instances[number], e->own[number]);
		rtcAttachGeometryByID(e->top, e->instances[number], number);
	}
	if (geometry)
		rtcReleaseGeometry(geometry);
	return e->instances[number] != NULL;
}

static float extent_of(const trace_scene *scene)
{
	float most = 0;
	for (uint32_t k = 0; k < scene->object_count; k++)
		for (uint32_t t = 0; t < scene->objects[k].triangle_count; t++) {
			vec3 p;
			trace_object_corner(&scene->objects[k], t, 0, p);
			most = fmaxf(most, fmaxf(fabsf(p[0]), fmaxf(fabsf(p[1]), fabsf(p[2]))));
		}
	return most;
}

trace_embree *trace_embree_create(const trace_scene *scene)
{
	trace_embree *e = calloc(1, sizeof *e);
	if (!e)
		return NULL;
	e->scene = scene;
	e->lift = 0x1p-18f * extent_of(scene);
	e->device = rtcNewDevice(NULL);
	e->top = e->device ? rtcNewScene(e->device) : NULL;
	bool ok = e->top != NULL;
	for (uint32_t k = 0; ok && k < scene->object_count; k++)
		ok = scene->objects[k].moves ? add_mover(e, k) : add_still(e, k);
	if (ok) {
		rtcSetSceneFlags(e->top, RTC_SCENE_FLAG_ROBUST);
		trace_embree_update(e);
		ok = rtcGetDeviceError(e->device) == RTC_ERROR_NONE;
	}
	if (ok)
		return e;
	trace_embree_destroy(e);
	return NULL;
}

void trace_embree_update(trace_embree *e)
{
	for (uint32_t k = 0; k < e->scene->object_count; k++)
		if (e->instances[k]) {
			rtcSetGeometryTransform(e->instances[k], 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR,
						e->scene->objects[k].world);
			rtcCommitGeometry(e->instances[k]);
		}
	rtcCommitScene(e->top);
}

void trace_embree_destroy(trace_embree *e)
{
	if (!e)
		return;
	for (uint32_t k = 0; k < TRACE_MOST_OBJECTS; k++) {
		if (e->instances[k])
			rtcReleaseGeometry(e->instances[k]);
		if (e->own[k])
			rtcReleaseScene(e->own[k]);
	}
	if (e->top)
		rtcReleaseScene(e->top);
	if (e->device)
		rtcReleaseDevice(e->device);
	free(e);
}

float trace_embree_lift(const trace_embree *e)
{
	return e->lift;
}

void trace_embree_leave(const trace_embree *e, const trace_hit *hit, const vec3 direction, vec3 origin)
{
	glm_vec3_copy((float *)hit->point, origin);
	glm_vec3_muladds((float *)hit->flat, e->lift, origin);
	glm_vec3_muladds((float *)direction, -e->lift, origin);
}

trace_hit trace_embree_closest(const trace_embree *e, const vec3 origin, const vec3 direction)
{
	struct RTCRayHit ray = {.ray = {.org_x = origin[0],
					.org_y = origin[1],
					.org_z = origin[2],
					.dir_x = direction[0],
					.dir_y = direction[1],
					.dir_z = direction[2],
					.tfar = INFINITY,
					.mask = 0xffffffffu}};
	ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
	ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
	embree_closest(e->top, &ray, NULL);
	trace_hit hit = {0};
	if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID)
		return hit;
	const uint32_t instance = ray.hit.instID[0];
	hit.object = &e->scene->objects[instance == RTC_INVALID_GEOMETRY_ID ? ray.hit.geomID : instance];
	hit.triangle = ray.hit.primID;
	hit.distance = ray.ray.tfar;
	hit.u = ray.hit.u;
	hit.v = ray.hit.v;
	glm_vec3_copy((float *)origin, hit.point);
	glm_vec3_muladds((float *)direction, hit.distance, hit.point);
	trace_object_flat_normal(hit.object, hit.triangle, hit.flat);
	glm_vec3_normalize(hit.flat);
	trace_object_normal(hit.object, hit.triangle, hit.u, hit.v, hit.normal);
	hit.front = glm_vec3_dot(hit.flat, (float *)direction) < 0;
	return hit;
}

/* Short of the end by a rounding of the way, so that the surface there does not hide itself. */
bool trace_embree_is_free(const trace_embree *e, const vec3 from, const vec3 to)
{
	struct RTCRay ray = {.org_x = from[0],
			     .org_y = from[1],
			     .org_z = from[2],
			     .dir_x = to[0] - from[0],
			     .dir_y = to[1] - from[1],
			     .dir_z = to[2] - from[2],
			     .tfar = 1 - 0x1p-16f,
			     .mask = 0xffffffffu};
	return !embree_occluded(e->top, &ray);
}
