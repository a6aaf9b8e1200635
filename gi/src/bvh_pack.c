#include "bvh_pack.h"

#include "bits.h"

#include <math.h>

void gi_pack_grid(const gi_vec4 *lower, const gi_vec4 *upper, gi_vec4 *grid, gi_vec4 *cells)
{
	const float *l = &lower->x, *u = &upper->x;
	float largest = 0;
	for (int k = 0; k < 3; k++)
		largest = fmaxf(largest, fmaxf(fmaxf(fabsf(l[k]), fabsf(u[k])), u[k] - l[k]));
	const float pad = 1e-5f * largest + 1e-20f;
	for (int k = 0; k < 3; k++) {
		(&grid->x)[k] = l[k] - pad;
		(&cells->x)[k] = GI_PACKED_CELLS / (u[k] - l[k] + 2 * pad);
	}
	grid->w = cells->w = 0;
}

/* One cell more than rounding outward: the ray's turn onto the grid rounds by less than that. */
static uint32_t cell_of(float x, float grid, float cells, int outward)
{
	const float cell = (x - grid) * cells;
	const float rounded = outward < 0 ? floorf(cell) - 1 : ceilf(cell) + 1;
	return (uint32_t)fminf(fmaxf(rounded, 0), GI_PACKED_CELLS);
}

gi_uvec4 gi_pack_node(const gi_bvh_node *n, gi_vec4 grid, gi_vec4 cells, uint32_t node_base, uint32_t primitive_base)
{
	const uint32_t skip = gi_bits_from_float(n->lower.w), primitive = gi_bits_from_float(n->upper.w);
	uint32_t lower[3], upper[3];
	for (int k = 0; k < 3; k++) {
		lower[k] = cell_of((&n->lower.x)[k], (&grid.x)[k], (&cells.x)[k], -1);
		upper[k] = cell_of((&n->upper.x)[k], (&grid.x)[k], (&cells.x)[k], 1);
	}
	const uint32_t link = primitive == GI_NONE ? skip + node_base : GI_PACKED_LEAF | (primitive + primitive_base);
	return (gi_uvec4){lower[0] | lower[1] << 16, lower[2] | upper[0] << 16, upper[1] | upper[2] << 16, link};
}
