/* Textures and colours of vertices of a scene file as what leaves reflect and emit: the mean over each. */
#ifndef DEMOS_FILE_TEXTURES_H
#define DEMOS_FILE_TEXTURES_H

#include "gi/gi.h"
#include "import_file.h"

#include <stdbool.h>

/* Has some face of the mesh a texture that it knows its place in, or a colour? Then the object is to be made with
 * leaf_materials and with the uvs that file_textures_prepare() leaves. */
bool file_textures_are_used(const engine_scene *scene, const engine_mesh *mesh);

/* Gives faces without texture coordinates, or all, coordinates in their own plane, so that what else is known of their
 * corners is known of leaves. face_materials number the scene's. False: out of memory. */
bool file_textures_prepare(const engine_scene *scene, engine_mesh *mesh, bool all);

/* Sets the materials of the leaves of such an object. face_materials: the scene's numbers, by face of its definition,
 * of which `mesh` holds all else. */
gi_result file_textures_set(const engine_scene *scene, const engine_mesh *mesh, const uint32_t *face_materials,
			    gi_context *gi, gi_object object);

/* The leaves of an object in the order of gi_read_leaves, the caller's to free(). */
gi_result file_textures_leaves(gi_context *gi, gi_object object, gi_leaf_uvs **leaves, uint32_t *count);

/* Where on a face a place in its coordinates lies: weights of three of its corners, whose numbers among all of the
 * mesh's come out too. first: of the face's. False: its coordinates have no area. */
bool file_textures_locate(const engine_mesh *mesh, size_t first, uint32_t count, const float uv[2], size_t corners[3],
			  float weights[3]);

/* The first corner of each face, the caller's to free(). NULL: out of memory. */
size_t *file_textures_first_corners(const engine_mesh *mesh);

#endif
