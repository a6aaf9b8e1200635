#include "stencils.h"

#include "host_memory.h"

#include <string.h>

static bool grow(void **array, size_t size, size_t room)
{
	void *grown = gi_realloc(*array, size * room);
	if (grown)
		*array = grown;
	return grown != NULL;
}

static uint32_t larger_of(uint32_t a, uint32_t b)
{
	return a > b ? a : b;
}

bool gi_stencils_reserve(gi_stencils *s, uint32_t points, uint32_t terms)
{
	const uint32_t wanted = s->count + points, wanted_terms = s->term_count + terms;
	if (!s->first || wanted > s->room) {
		const uint32_t room = larger_of(wanted, 2 * s->room);
		if (!grow((void **)&s->first, sizeof *s->first, (size_t)room + 1))
			return false;
		s->first[s->count] = s->term_count;
		s->room = room;
	}
	if (!s->vertex || !s->weight || wanted_terms > s->term_room) {
		const uint32_t room = larger_of(wanted_terms, 2 * s->term_room);
		if (!grow((void **)&s->vertex, sizeof *s->vertex, (size_t)room + 1) ||
		    !grow((void **)&s->weight, sizeof *s->weight, (size_t)room + 1))
			return false;
		s->term_room = room;
	}
	return true;
}

void gi_stencils_add_term(gi_stencils *s, uint32_t vertex, double weight)
{
	s->vertex[s->term_count] = vertex;
	s->weight[s->term_count++] = weight;
}

void gi_stencils_end_point(gi_stencils *s)
{
	s->first[++s->count] = s->term_count;
}

bool gi_stencils_add_between(gi_stencils *s, uint32_t a, uint32_t b, double weight_a, double weight_b)
{
	const double share_a = weight_a / (weight_a + weight_b), share_b = weight_b / (weight_a + weight_b);
	const uint32_t end_a = s->first[a + 1], end_b = s->first[b + 1];
	uint32_t i = s->first[a], j = s->first[b];
	if (!gi_stencils_reserve(s, 1, end_a - i + end_b - j))
		return false;
	while (i < end_a || j < end_b) {
		const uint32_t of_a = i < end_a ? s->vertex[i] : UINT32_MAX,
			       of_b = j < end_b ? s->vertex[j] : UINT32_MAX;
		const uint32_t vertex = of_a < of_b ? of_a : of_b;
		double weight = 0;
		if (of_a == vertex)
			weight += share_a * s->weight[i++];
		if (of_b == vertex)
			weight += share_b * s->weight[j++];
		gi_stencils_add_term(s, vertex, weight);
	}
	gi_stencils_end_point(s);
	return true;
}

void gi_stencils_drop_last(gi_stencils *s)
{
	s->term_count = s->first[--s->count];
}

bool gi_stencils_alike(const gi_stencils *s, uint32_t a, uint32_t b)
{
	const uint32_t terms = s->first[a + 1] - s->first[a];
	return s->first[b + 1] - s->first[b] == terms &&
	       memcmp(s->vertex + s->first[a], s->vertex + s->first[b], sizeof *s->vertex * terms) == 0;
}

void gi_stencils_evaluate(const gi_stencils *s, uint32_t point, const double (*cage)[3], double out[3])
{
	double x = 0, y = 0, z = 0;
	for (uint32_t k = s->first[point]; k < s->first[point + 1]; k++) {
		const double *vertex = cage[s->vertex[k]], weight = s->weight[k];
		x += weight * vertex[0];
		y += weight * vertex[1];
		z += weight * vertex[2];
	}
	out[0] = x;
	out[1] = y;
	out[2] = z;
}

bool gi_stencils_copy(const gi_stencils *from, gi_stencils *out)
{
	*out = (gi_stencils){0};
	if (!gi_stencils_reserve(out, from->count, from->term_count)) {
		gi_stencils_free(out);
		return false;
	}
	if (from->count) {
		memcpy(out->first, from->first, sizeof *out->first * ((size_t)from->count + 1));
		memcpy(out->vertex, from->vertex, sizeof *out->vertex * from->term_count);
		memcpy(out->weight, from->weight, sizeof *out->weight * from->term_count);
	}
	out->count = from->count;
	out->term_count = from->term_count;
	return true;
}

void gi_stencils_free(gi_stencils *s)
{
	gi_free(s->first);
	gi_free(s->vertex);
	gi_free(s->weight);
	*s = (gi_stencils){0};
}
