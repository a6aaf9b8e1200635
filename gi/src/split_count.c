/* About how many leaves a cage would have. */
#include "faces.h"
#include "split_pieces.h"

static gi_vec3d cage_point(const gi_refine_cage *cage, uint32_t index)
{
	const float *p = cage->positions + 3 * (size_t)cage->indices[index];
	return (gi_vec3d){(double)p[0] * cage->scale[0], (double)p[1] * cage->scale[1], (double)p[2] * cage->scale[2]};
}

static double cage_edge(const gi_refine_cage *cage, uint32_t from, uint32_t to)
{
	return gi_vec3d_length(gi_vec3d_sub(cage_point(cage, to), cage_point(cage, from)));
}

/* By area, and not fewer than its longest edge takes. */
static double estimate_polygon(const gi_refine_cage *cage, uint32_t first, uint32_t count, double size)
{
	gi_vec3d moment = {0};
	double longest = 0;
	for (uint32_t k = 0; k < count; k++) {
		longest = fmax(longest, cage_edge(cage, first + k, first + (k + 1) % count));
		if (k >= 2)
			moment = gi_vec3d_add(moment, gi_vec3d_triangle(cage_point(cage, first),
									cage_point(cage, first + k - 1),
									cage_point(cage, first + k)));
	}
	return fmax(gi_vec3d_length(moment) / (0.75 * size * size),
		    fmax(count == 3 ? 1 : count, longest / (SPLIT_TRIANGLE_EDGE * size)));
}

static double estimate_quad(const gi_refine_cage *cage, uint32_t first, double size)
{
	const double n = (cage_edge(cage, first, first + 1) + cage_edge(cage, first + 2, first + 3)) / 2,
		     m = (cage_edge(cage, first + 1, first + 2) + cage_edge(cage, first + 3, first)) / 2;
	return fmax(1, ceil(n / (SPLIT_SIZE_SLACK * size) - 1e-9)) *
	       fmax(1, ceil(m / (SPLIT_SIZE_SLACK * size) - 1e-9));
}

double gi_split_estimate(const gi_refine_cage *cage, const gi_split_def *def)
{
	double sum = 0;
	for (uint32_t face = 0, first = 0; face < cage->face_count; face++) {
		const uint32_t count = gi_corner_count(cage->face_counts, face);
		const double own = def->leaf_sizes ? def->leaf_sizes[face] : 0, size = own > 0 ? own : def->leaf_size;
		sum += count == 4 ? estimate_quad(cage, first, size) : estimate_polygon(cage, first, count, size);
		first += count;
	}
	return sum;
}
