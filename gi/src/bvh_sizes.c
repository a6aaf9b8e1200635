#include "bvh.h"

#include "host_memory.h"

#include <stdlib.h>

static int order(double a, double b)
{
	return (a > b) - (a < b);
}

typedef struct sized {
	double size;
	uint32_t number;
} sized;

static int compare_sizes(const void *left, const void *right)
{
	const sized *a = left, *b = right;
	const int by_size = order(b->size, a->size);
	return by_size ? by_size : order(a->number, b->number);
}

uint32_t *gi_bvh_by_size(const gi_bvh *bvh)
{
	const uint32_t count = bvh->primitive_count;
	sized *list = gi_malloc(sizeof *list * ((size_t)count + 1));
	uint32_t *numbers = gi_malloc(sizeof *numbers * ((size_t)count + 1));
	for (uint32_t k = 0; list && k < count; k++)
		list[k] = (sized){(double)bvh->primitives[k].c.w + bvh->primitives[k].d.w, k};
	if (list)
		qsort(list, count, sizeof *list, compare_sizes);
	for (uint32_t k = 0; list && numbers && k < count; k++)
		numbers[k] = list[k].number;
	if (!list) {
		gi_free(numbers);
		return NULL;
	}
	gi_free(list);
	return numbers;
}
