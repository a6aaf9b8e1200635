/* A polygon mesh as scenes, files and simplifiers hand it around: plain arrays on the CPU, one owner.
 *
 * Faces are stored back to back: face f has face_counts[f] corners, its vertex numbers start in `indices`
 * where those of face f-1 end. Corners run counter-clockwise seen from the front. Units are metres.
 */
#ifndef ENGINE_MESH_H
#define ENGINE_MESH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct engine_mesh {
	float *positions; /* 3 * vertex_count, metres, object space */
	uint32_t vertex_count;
	uint32_t *face_counts; /* face_count corner numbers, each >= 3 */
	uint32_t *indices;     /* index_count vertex numbers */
	float *uvs;            /* 2 * index_count, texture coordinates of corners; NULL: none */
	float *colors; /* 4 * index_count, of corners: linear r g b, alpha, which materials are times; NULL: none */
	uint32_t *face_materials; /* face_count material numbers; NULL: all 0 */
	uint32_t face_count;
	uint32_t index_count;
	uint32_t *crease_vertices; /* 2 * crease_count vertex numbers, one pair per creased edge; NULL when none */
	float *crease_sharpness;   /* crease_count values >= 0; 10 and above is infinitely sharp */
	uint32_t crease_count;
} engine_mesh;

/* Texture coordinates of a corner that has none: a face of such has the mean of all of a texture. */
#define ENGINE_NO_UV 4e9f

/* Red of a corner that has no colour: its face has the material's alone. */
#define ENGINE_NO_COLOR (-1.0f)

/* Frees every array and zeroes the struct. NULL arrays and an already zeroed struct are fine. */
void engine_mesh_free(engine_mesh *mesh);

/* Copies every array into `out`, which must not own any. False, and `out` zeroed, when out of memory. */
bool engine_mesh_copy(const engine_mesh *mesh, engine_mesh *out);

/* Keeps, in their order, the faces of which `keep` says so; returns how many went. It is asked once of each, from the
 * first on, with the corners where they are.
 */
typedef bool engine_mesh_keep(const void *context, uint32_t face, const uint32_t *corners);
uint32_t engine_mesh_keep_faces(engine_mesh *mesh, engine_mesh_keep *keep, const void *context);

/* Moves `count` corners from place `from` of the index list to place `to`, with what they carry. */
void engine_mesh_move_corners(engine_mesh *mesh, size_t to, size_t from, size_t count);

/* Area-weighted normal of face corners (Newell's method), its length is the area. */
void engine_mesh_face_normal(const engine_mesh *mesh, const uint32_t *corners, uint32_t count, double normal[3]);

#ifdef __cplusplus
}
#endif

#endif
