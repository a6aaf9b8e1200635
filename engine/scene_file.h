/* Scenes from files: glTF 2.0 (.gltf, .glb), OBJ and PLY, as plain structs in metres, watts and seconds.
 *
 * glTF   Every node of the scene that has a mesh is an object, in node order, and every instance of
 *        EXT_mesh_gpu_instancing one of its own; all primitives of a mesh become one. baseColorFactor times COLOR_0 is
 *        rho (linear), emissiveFactor times the mean of emissiveTexture times KHR_materials_emissive_strength the
 *        radiance L. Skins and morph targets stand as at rest. The node's extras.gi = {"scheme": "catmull-clark" |
 *        "loop" | "bilinear", "levels": n} chooses the refinement. glTF has triangles only: where extras.gi.scheme says
 *        catmull-clark or bilinear, pairs of triangles that were a quad are put together again (see
 *        engine_mesh_pair_triangles); without it triangles stay. All animations of a file play together from 0 s; of
 *        two for one property of a node the first counts.
 * OBJ    Every o or g with faces is an object; polygons stay. Kd is rho (0.6 where the .mtl gives none), Ke times the
 *        mean of map_Ke the radiance.
 * PLY    One object; triangle strips too.
 *        In both, colours of vertices or faces (sRGB) are the rho of faces that have no material.
 *
 * In all of them:
 * - Faces without any material, and glTF materials without a base colour, have rho 0.5. A rho of 1 or more becomes
 * 0.98: white that gives everything back has no solution (M = I - diag(rho) F is singular in a closed room).
 * - Vertices of equal position are one; faces without area are dropped; those that are not convex, or have a hole
 * joined to their rim, are cut into triangles of the same area.
 * - A transform that shears is baked into the mesh; an object whose scale is 0 is left out, for as long as that lasts.
 * - Faces whose material lets more than half of the light through (alpha) are left out.
 * - A scene far from the origin, in the coordinates of a map, is moved to its middle in double precision.
 * - What is broken costs itself alone: a face, an object, an animated property, a colour. A file is refused when it is
 *   cut off (an OBJ or PLY too that has a corner at a vertex it does not hold, or at no finite place), when nothing of
 *   it can be used, and when it makes more of its bytes than there could be light for.
 * - Only regular files are opened, and only in the folder of the scene and below it.
 * All that is left out or mended is in `warning`, once a kind, with a count and where it was found first.
 */
#ifndef ENGINE_SCENE_FILE_H
#define ENGINE_SCENE_FILE_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum engine_scheme {
	ENGINE_SCHEME_BILINEAR, /* default */
	ENGINE_SCHEME_CATMULL_CLARK,
	ENGINE_SCHEME_LOOP, /* the mesh has triangles only */
} engine_scheme;

enum { ENGINE_SCENE_MAX_LEVELS = 8 };

typedef struct engine_scene_material {
	char *name;        /* never NULL; control characters are replaced by blanks */
	float rho[3];      /* linear RGB, each in [0, 1) */
	float radiance[3]; /* L of one side, W/(m2 sr), >= 0; exitance E = pi L */
	bool double_sided; /* two back-to-back sides */
	bool used;         /* some face has it */
	bool clear;        /* lets light through: its faces are left out */
} engine_scene_material;

/* World from object: scale, then rotate, then translate. */
typedef struct engine_pose {
	float translation[3]; /* metres */
	float rotation[4];    /* unit quaternion x y z w */
	float scale[3];       /* each > 0: a mirrored node has its mesh mirrored instead, with its fronts kept */
} engine_pose;

typedef struct engine_scene_object {
	char *name;       /* never NULL or empty, unique in the scene ("a", "a#2", ...) */
	engine_mesh mesh; /* object space; face_materials number the scene's materials, never NULL */
	engine_pose rest; /* as the file places it, animation apart */
	engine_scheme scheme;
	uint32_t levels;     /* refinement steps, 0..ENGINE_SCENE_MAX_LEVELS, default 0 */
	bool double_sided;   /* one of its materials is */
	bool animated;       /* its pose depends on time */
	bool scale_animated; /* even the scale does: not a rigid motion */
	bool vanishes;       /* its scale is 0 at times, when engine_scene_pose() has no pose */
	uint32_t node;       /* private, as all that follows */
	bool mirrored, baked;
	double offset[3], stretch[9];
	double rounding; /* metres in object space: how far the file's coordinates may be off */
} engine_scene_object;

typedef struct engine_scene_camera {
	float eye[3], target[3], up[3]; /* world; target is 1 m ahead, up a unit vector across the view */
	float vertical_fov;             /* radians, (0, pi) */
} engine_scene_camera;

typedef struct engine_scene {
	engine_scene_material *materials;
	uint32_t material_count;
	engine_scene_object *objects;
	uint32_t object_count; /* 0: an empty scene is none of our errors */
	double duration_s;     /* last key of the animations, 0 without */
	bool has_camera;       /* the first perspective camera of the scene */
	double origin[3];      /* metres: where the scene's 0 0 0 lies in the file; 0 but for scenes far off */
	char warning[4096];    /* one line about what was dropped or ignored, "" when nothing was */
	uint32_t camera_node;  /* private */
	float camera_fov;      /* private */
	struct engine_scene_graph *graph; /* private: nodes and animation */
} engine_scene;

/* Loads path, by its extension, into *scene; the caller frees it with engine_scene_free(). False with *scene zeroed and
 * one line in message that starts with the path and says what is wrong and, where there is a choice, what to do.
 */
bool engine_scene_load(const char *path, engine_scene *scene, char *message, size_t message_size);

/* Frees everything and zeroes the struct; fine on a zeroed one. */
void engine_scene_free(engine_scene *scene);

/* The object's pose at time_s through its animated parents; times outside 0..duration_s show the first or last key
 * (loop in the caller). False, with *pose unchanged, where it has none: the scale is 0 (object->vanishes), or mirrors
 * other than at rest. Not for two threads at once: the scene keeps where its nodes are at the last time asked for.
 */
bool engine_scene_pose(const engine_scene *scene, uint32_t object, double time_s, engine_pose *pose);

/* The camera at time_s. False, with *camera unchanged, when the file has none or its pose is singular. */
bool engine_scene_camera_at(const engine_scene *scene, double time_s, engine_scene_camera *camera);

/* All objects as one mesh in world space at rest, vertices welded: what a file of several groups is to a program that
 * wants one object. The caller owns *out. False with *out zeroed and one line in message.
 */
bool engine_scene_merge(const engine_scene *scene, engine_mesh *out, char *message, size_t message_size);

#ifdef __cplusplus
}
#endif

#endif
