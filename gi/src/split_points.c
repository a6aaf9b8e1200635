/* Points of the pieces: one a place, so that faces that share an edge share its points. */
#include "split_pieces.h"

#include "host_memory.h"

#include <string.h>

/* Room for one more. */
bool split_reserve(void **array, uint32_t count, uint32_t *room, size_t size)
{
	if (count < *room)
		return true;
	const uint32_t more = *room ? 2 * *room : 256;
	void *grown = gi_realloc(*array, size * more);
	if (!grown)
		return false;
	*array = grown;
	*room = more;
	return true;
}

static uint32_t hash_of(const float p[3], uint32_t component)
{
	uint32_t hash = component * 0x9e3779b9u;
	for (int k = 0; k < 3; k++) {
		const float value = p[k] + 0.0f; /* -0 is 0 */
		uint32_t bits;
		memcpy(&bits, &value, sizeof bits);
		hash = (hash ^ bits) * 0x85ebca6bu;
		hash ^= hash >> 15;
	}
	return hash;
}

void split_round_point(gi_vec3d p, float out[3])
{
	out[0] = (float)p.x;
	out[1] = (float)p.y;
	out[2] = (float)p.z;
}

static bool are_one(const splitter *s, uint32_t point, uint32_t number)
{
	return !s->stencils || gi_stencils_alike(s->stencils, point, number);
}

uint32_t *split_find_place(const splitter *s, gi_vec3d p, uint32_t component, uint32_t number)
{
	float at[3], other[3];
	split_round_point(p, at);
	uint32_t k = hash_of(at, component) & (s->table_room - 1);
	for (; s->table[k] != GI_NONE; k = (k + 1) & (s->table_room - 1)) {
		const uint32_t point = s->table[k];
		split_round_point(s->points[point], other);
		if (s->component[point] == component && at[0] == other[0] && at[1] == other[1] && at[2] == other[2] &&
		    are_one(s, point, number))
			break;
	}
	return &s->table[k];
}

bool split_grow_table(splitter *s, uint32_t room)
{
	uint32_t *table = gi_malloc(sizeof *table * room);
	if (!table)
		return false;
	memset(table, 0xff, sizeof *table * room);
	gi_free(s->table);
	s->table = table;
	s->table_room = room;
	for (uint32_t k = 0; k < s->point_count; k++) {
		uint32_t *place = split_find_place(s, s->points[k], s->component[k], k);
		if (*place == GI_NONE)
			*place = k;
	}
	return true;
}

bool split_reserve_point(splitter *s)
{
	uint32_t room = s->point_room;
	return split_reserve((void **)&s->points, s->point_count, &room, sizeof *s->points) &&
	       split_reserve((void **)&s->component, s->point_count, &s->point_room, sizeof *s->component) &&
	       (2 * s->point_count < s->table_room || split_grow_table(s, 2 * s->table_room));
}

/* Its stencil, where there are any, is there already. */
static uint32_t add_point(splitter *s, gi_vec3d p, uint32_t component)
{
	if (!split_reserve_point(s)) {
		s->full = true;
		return 0;
	}
	uint32_t *place = split_find_place(s, p, component, s->point_count);
	if (*place != GI_NONE) {
		if (s->stencils)
			gi_stencils_drop_last(s->stencils);
		return *place;
	}
	s->points[s->point_count] = p;
	s->component[s->point_count] = component;
	return *place = s->point_count++;
}

/* (a (n - k) + b k) / n: the same from either end. */
uint32_t split_point_between(splitter *s, uint32_t a, uint32_t b, double weight_a, double weight_b)
{
	if (s->full || (s->stencils && !gi_stencils_add_between(s->stencils, a, b, weight_a, weight_b))) {
		s->full = true;
		return 0;
	}
	const gi_vec3d sum =
	    gi_vec3d_add(gi_vec3d_scale(s->points[a], weight_a), gi_vec3d_scale(s->points[b], weight_b));
	return add_point(s, gi_vec3d_scale(sum, 1 / (weight_a + weight_b)), s->component[a]);
}
