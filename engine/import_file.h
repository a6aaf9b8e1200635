/* Scenes from files: glTF 2.0 (.gltf, .glb), OBJ and PLY, as plain structs in metres, watts and seconds.
 *
 * glTF   Every node of the scene that has a mesh is an object, in node order, and every instance of
 *        EXT_mesh_gpu_instancing one of its own; all primitives of a mesh become one. baseColorFactor times
 *        baseColorTexture times COLOR_0 is rho (linear), emissiveFactor times emissiveTexture times
 *        KHR_materials_emissive_strength the radiance L; materials have the means of textures, and what it takes to
 *        have them at a place. Metals of a roughness below 0.1 are mirrors, what KHR_materials_transmission lets
 *        through is glass of KHR_materials_ior. Nodes with a light of KHR_lights_punctual are lights, whose candela and
 *        lux are taken as the nits of emissive materials are (ENGINE_WATTS_PER_LUMEN); the scene's
 *        EXT_lights_image_based is its sky, by the first mip of its cube map, else by its coefficients. Skins and morph
 *        targets move meshes (import_shape.h). The node's extras.gi =
 *        {"scheme": "catmull-clark" | "loop" | "bilinear", "levels": n} chooses the refinement.
 *        glTF has triangles only: where extras.gi.scheme says catmull-clark or bilinear, pairs of triangles that were a
 *        quad are put together again (see engine_mesh_pair_triangles); without it triangles stay. All animations of a
 *        file play together from 0 s; of two for one property of a node the first counts.
 * OBJ    Every o or g with faces is an object; polygons stay. Kd times map_Kd is rho (0.6 where the .mtl gives
 *        neither), Ke times map_Ke the radiance; map_d covers faces as alpha of glTF does.
 * PLY    One object; triangle strips too.
 *        In both, colours of vertices or faces (sRGB) are times the rho of the material, of 1 without one.
 *
 * In all of them:
 * - Faces without any material, and glTF materials without a base colour, have rho 0.5. A rho of 1 or more becomes
 *   0.98: white that gives everything back has no solution (M = I - diag(rho) F is singular in a closed room).
 * - Vertices of equal position are one; faces without area are dropped; those that are not convex, or have a hole
 *   joined to their rim, are cut into triangles of the same area.
 * - A transform that shears is baked into the mesh; an object whose scale is 0 is left out, for as long as that lasts.
 * - Faces whose material lets more than half of the light through (alpha) are left out.
 * - A scene far from the origin, in the coordinates of a map, is moved to its middle in double precision.
 * - What is broken costs itself alone: a face, an object, an animated property, a colour. A file is refused when it is
 *   cut off (an OBJ or PLY too that has a corner at a vertex it does not hold, or at no finite place), when nothing of
 *   it can be used, and when it makes more of its bytes than there could be light for.
 * - Only regular files are opened, and only in the folder of the scene and below it.
 * All that is left out or mended is in `warning`, once a kind, with a count and where it was found first.
 */
#ifndef ENGINE_IMPORT_FILE_H
#define ENGINE_IMPORT_FILE_H

#include "import_pose.h"
#include "import_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Loads path, by its extension, into *scene; the caller frees it with engine_scene_free(). False with *scene zeroed and
 * one line in message that starts with the path and says what is wrong and, where there is a choice, what to do.
 */
bool engine_scene_load(const char *path, engine_scene *scene, char *message, size_t message_size);

/* Frees everything and zeroes the struct; fine on a zeroed one. */
void engine_scene_free(engine_scene *scene);

/* All objects as one mesh in world space at rest, vertices welded: what a file of several groups is to a program that
 * wants one object. The caller owns *out. False with *out zeroed and one line in message.
 */
bool engine_scene_merge(const engine_scene *scene, engine_mesh *out, char *message, size_t message_size);

#ifdef __cplusplus
}
#endif

#endif
