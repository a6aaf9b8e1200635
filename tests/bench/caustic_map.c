#include "caustic_map.h"

#include "low_discrepancy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const float FACING = 0.7f; /* cosine */

static int32_t cell(const caustic_map *map, float x)
{
	return (int32_t)floorf(x / (2 * map->radius));
}

static uint32_t hash_cell(const caustic_map *map, int32_t x, int32_t y, int32_t z)
{
	return hash_pair(hash_pair((uint32_t)x, (uint32_t)y), (uint32_t)z) & (map->hashes - 1);
}

static uint32_t hash_point(const caustic_map *map, const float *p)
{
	return hash_cell(map, cell(map, p[0]), cell(map, p[1]), cell(map, p[2]));
}

static bool make_room(caustic_map *map, uint32_t count)
{
	if (count <= map->room)
		return true;
	caustic_map_free(map);
	map->hashes = 1;
	while (map->hashes < count)
		map->hashes *= 2;
	map->photons = malloc(sizeof *map->photons * count);
	map->first = malloc(sizeof *map->first * (map->hashes + 1));
	map->room = map->photons && map->first ? count : 0;
	return map->room > 0;
}

bool caustic_map_build(caustic_map *map, const caustic_photon *photons, uint32_t count, float radius)
{
	map->count = 0;
	if (!make_room(map, count))
		return false;
	map->radius = radius;
	map->count = count;
	if (!count)
		return true;
	/* Counted, then dealt out from the ends of their ranges. */
	memset(map->first, 0, sizeof *map->first * (map->hashes + 1));
	for (uint32_t k = 0; k < count; k++)
		map->first[hash_point(map, photons[k].point)]++;
	for (uint32_t h = 0; h < map->hashes; h++)
		map->first[h + 1] += map->first[h];
	for (uint32_t k = count; k-- > 0;)
		map->photons[--map->first[hash_point(map, photons[k].point)]] = photons[k];
	return true;
}

void caustic_map_free(caustic_map *map)
{
	free(map->photons);
	free(map->first);
	*map = (caustic_map){0};
}

static void add_range(const caustic_map *map, uint32_t hash, const int32_t at[3], const vec3 point, const vec3 normal,
		      vec3 sum)
{
	const float most = map->radius * map->radius;
	for (uint32_t k = map->first[hash]; k < map->first[hash + 1]; k++) {
		const caustic_photon *p = &map->photons[k];
		const float square = glm_vec3_distance2((float *)p->point, (float *)point);
		/* Cells that share a hash share photons: each counts in its own cell alone. */
		if (square < most && glm_vec3_dot((float *)p->normal, (float *)normal) > FACING &&
		    cell(map, p->point[0]) == at[0] && cell(map, p->point[1]) == at[1] &&
		    cell(map, p->point[2]) == at[2])
			glm_vec3_muladds((float *)p->flux, 1 - square / most, sum);
	}
}

void caustic_map_irradiance(const caustic_map *map, const vec3 point, const vec3 normal, vec3 out)
{
	glm_vec3_zero(out);
	if (!map->count)
		return;
	/* Cells are two radii wide: two along each axis hold all that is near. */
	int32_t low[3];
	for (int c = 0; c < 3; c++)
		low[c] = cell(map, point[c] - map->radius);
	for (int k = 0; k < 8; k++) {
		const int32_t at[3] = {low[0] + (k & 1), low[1] + (k >> 1 & 1), low[2] + (k >> 2)};
		add_range(map, hash_cell(map, at[0], at[1], at[2]), at, point, normal, out);
	}
	glm_vec3_scale(out, 2 / (GLM_PIf * map->radius * map->radius), out);
}
