/* How many faces a mesh of a file needs to light its scene. */
#ifndef DEMOS_FINENESS_H
#define DEMOS_FINENESS_H

#include "import_file.h"

/* What a scene's objects share the leaves by. */
typedef struct fineness {
	double leaves;   /* of the whole scene */
	double area;     /* of all objects, each counted the more the smaller it is, m2 */
	double diagonal; /* of the largest, metres */
} fineness;

/* leaves 0: 4,000, which suits any device. */
fineness fineness_of(const engine_scene *scene, uint32_t leaves);

/* More faces than this are more leaves than the object's share: a scan, not a cage. Never less than a few hundred,
 * which cost little. */
uint32_t fineness_most_faces(const fineness *f, const engine_scene_object *object);

#endif
