/* All objects as one scene: their arrays laid end to end, and uploaded. */
#ifndef GI_SCENE_UPLOAD_H
#define GI_SCENE_UPLOAD_H

#include "scene.h"

/* The scene that the new one takes the place of. */
typedef struct scene_before {
	const gi_scene *scene;
	const object_record *objects; /* as they were: with their places in it */
} scene_before;

/* What this object's part of the old scene was, to carry its B over. */
typedef struct carried {
	uint32_t index, node_base, leaf_base;
} carried;

/* What a commit does not make anew. */
void scene_keep_objects(const gi_scene *from, gi_scene *to);

/* Gathers and uploads all objects into gi->scene, whose buffers and arrays are none yet. old: room for an entry of each
 * place; those that were in the scene before are put there. */
gi_result scene_upload(gi_context *gi, const scene_before *before, carried *old, uint32_t *old_count);

#endif
