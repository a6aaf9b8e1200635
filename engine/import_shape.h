/* Objects of a scene whose vertices move on their own: with the joints of a skin, with morph targets.
 *
 * What moves is the file's vertices; meshes made of them (cleaned, simplified) follow: each point has the joints and
 * targets of the file's vertex next to it at rest.
 */
#ifndef ENGINE_IMPORT_SHAPE_H
#define ENGINE_IMPORT_SHAPE_H

#include "import_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Points that move with an object. */
typedef struct engine_followers {
	uint32_t count;
	uint32_t *source;  /* of each: a vertex of the file */
	double (*bind)[3]; /* and where it is before joints and targets */
} engine_followers;

/* Points of an object that deforms, in object space at rest. False: out of memory. Free it with
 * engine_followers_free(), which takes a zeroed one too.
 */
bool engine_scene_follow(const engine_scene *scene, uint32_t object, const float *points, uint32_t count,
			 engine_followers *out);
void engine_followers_free(engine_followers *followers);

/* Where they are at time_s, object space (engine_scene_pose places that). Not for two threads at once. */
void engine_scene_shape(const engine_scene *scene, uint32_t object, const engine_followers *followers, double time_s,
			float *points);

#ifdef __cplusplus
}
#endif

#endif
