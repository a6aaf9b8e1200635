/* What parts of a scene file's surfaces reflect and emit: materials times textures times colours of vertices. */
#ifndef DEMOS_FILE_SURFACE_H
#define DEMOS_FILE_SURFACE_H

#include "gi/gi.h"
#include "import_file.h"

/* A triangle, over which texture coordinates and colours are linear. */
typedef struct file_surface_triangle {
	const engine_scene_material *material;
	float uvs[3][2];    /* ENGINE_NO_UV: none */
	float colors[3][3]; /* [0][0] ENGINE_NO_COLOR: none */
} file_surface_triangle;

bool file_surface_has_texture(const engine_scene_material *material);

/* A corner of a mesh as one of those has it. */
void file_surface_corner(const engine_mesh *mesh, size_t corner, float uv[2], float color[3]);

/* The mean over one, with rho of at most 0.98. */
gi_material file_surface_mean(const engine_scene *scene, const file_surface_triangle *triangle);

/* Cuts a triangle evenly: number `piece` of side * side equal ones, as weights of its corners. */
void file_surface_piece(uint32_t side, uint32_t piece, float weights[3][3]);

/* out = sum of weights times values, `size` each. */
void file_surface_blend(const float weights[3], const float *a, const float *b, const float *c, uint32_t size,
			float *out);

#endif
