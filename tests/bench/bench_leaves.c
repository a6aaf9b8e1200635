#include "bench_leaves.h"

#include "bench_scene.h"

#include <math.h>
#include <stdlib.h>

gi_leaf *bench_leaves(gi_context *gi, uint32_t *count)
{
	check(gi_read_leaves(gi, NULL, 0, count));
	gi_leaf *leaves = malloc(sizeof *leaves * (*count + 1));
	if (!leaves)
		fail("out of memory");
	check(gi_read_leaves(gi, leaves, *count, count));
	return leaves;
}

bench_distance bench_leaves_distance(const gi_leaf *leaves, const gi_leaf *exact, uint32_t count)
{
	double most = 0, off = 0, whole = 0;
	for (uint32_t k = 0; k < count; k++)
		for (int c = 0; c < 3; c++) {
			const double b = (double)exact[k].radiosity[c] - (double)exact[k].exitance[c],
				     d = (double)leaves[k].radiosity[c] - (double)exact[k].radiosity[c];
			most = fmax(most, fabs(d));
			off += (double)exact[k].area * d * d;
			whole += (double)exact[k].area * b * b;
		}
	return (bench_distance){most, 100 * sqrt(off / whole)};
}
