/* Embree 3 and 4 as one: a scene whose rays may bring a filter along, the closest hit, and whether anything is hit.
 *
 * Debian 12 has Embree 3, Debian 13 has Embree 4, which moved a ray's context and filter into arguments. A filter finds
 * its data in args->geometryUserPtr (rtcSetGeometryUserData), which both have.
 */
#ifndef TESTS_REFERENCE_EMBREE_H
#define TESTS_REFERENCE_EMBREE_H

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <stdbool.h>
#include <stddef.h>

#if RTC_VERSION_MAJOR >= 4

/* A scene flag: the filter of embree_closest is called. */
#define EMBREE_RAY_FILTERS RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS

/* The closest hit that the filter keeps; NULL: of all. hit.geomID stays RTC_INVALID_GEOMETRY_ID where there is none. */
static inline void embree_closest(RTCScene scene, struct RTCRayHit *ray_hit, RTCFilterFunctionN filter)
{
	struct RTCIntersectArguments arguments;
	rtcInitIntersectArguments(&arguments);
	arguments.filter = filter;
	if (filter)
		arguments.flags |= RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER;
	rtcIntersect1(scene, ray_hit, &arguments);
}

/* Whether anything is hit between ray->tnear and ray->tfar. */
static inline bool embree_occluded(RTCScene scene, struct RTCRay *ray)
{
	rtcOccluded1(scene, ray, NULL);
	return ray->tfar < 0.0f; /* Embree writes -inf when occluded */
}

#else

#define EMBREE_RAY_FILTERS RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION

static inline void embree_closest(RTCScene scene, struct RTCRayHit *ray_hit, RTCFilterFunctionN filter)
{
	struct RTCIntersectContext context;
	rtcInitIntersectContext(&context);
	context.filter = filter;
	rtcIntersect1(scene, &context, ray_hit);
}

static inline bool embree_occluded(RTCScene scene, struct RTCRay *ray)
{
	struct RTCIntersectContext context;
	rtcInitIntersectContext(&context);
	rtcOccluded1(scene, &context, ray);
	return ray->tfar < 0.0f;
}

#endif

#endif
