/* A floor under a lamp in the library, and what arrives on the floor by hand. C and C++. */
#ifndef FOREIGN_ROOM_H
#define FOREIGN_ROOM_H

#include <gi/gi.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { ROOM_FLOOR_LEAVES = 64, ROOM_LEAVES = ROOM_FLOOR_LEAVES + 1 };

static const float ROOM_FLOOR[12] = {-2, 0, -2, -2, 0, 2, 2, 0, 2, 2, 0, -2};
static const float ROOM_LAMP[12] = {-.5f, 2, -.5f, .5f, 2, -.5f, .5f, 2, .5f, -.5f, 2, .5f};
static const float ROOM_EXITANCE = 10; /* W/m2 */

static gi_result room_add(gi_context *gi, const float *corners, uint32_t levels, float exitance, gi_object *out)
{
	static const uint32_t indices[4] = {0, 1, 2, 3};
	const float rho = exitance > 0 ? 0 : .5f;
	const gi_material material = {{rho, rho, rho}, {exitance, exitance, exitance}};
	gi_object_def def = gi_object_def_default();
	def.positions = corners;
	def.vertex_count = 4;
	def.indices = indices;
	def.index_count = 4;
	def.face_count = 1;
	def.levels = levels;
	def.materials = &material;
	def.material_count = 1;
	return gi_create_object(gi, &def, out);
}

/* Leaves of two contexts can be compared then. */
static void room_forget_context(gi_leaf leaves[ROOM_LEAVES])
{
	for (int k = 0; k < ROOM_LEAVES; k++)
		leaves[k].object.context = 0;
}

/* The light of one update; the leaves' order is the library's. */
static gi_result room_light(gi_context *gi, gi_leaf leaves[ROOM_LEAVES])
{
	gi_object floor, lamp;
	uint32_t count = 0;
	gi_result result = room_add(gi, ROOM_FLOOR, 3, 0, &floor);
	if (!result)
		result = room_add(gi, ROOM_LAMP, 0, ROOM_EXITANCE, &lamp);
	if (!result)
		result = gi_commit(gi);
	if (!result)
		result = gi_update(gi, NULL);
	if (!result)
		result = gi_read_leaves(gi, leaves, ROOM_LEAVES, &count);
	room_forget_context(leaves);
	return result ? result : count == ROOM_LEAVES ? GI_OK : GI_ERROR_INVALID_GEOMETRY;
}

/* Mean irradiance of the floor, W/m2. The floor does not see itself, so that all of it is the lamp's. */
static double room_mean(const gi_leaf leaves[ROOM_LEAVES])
{
	double sum = 0;
	for (int k = 0; k < ROOM_LEAVES; k++)
		sum += leaves[k].exitance[0] > 0 ? 0 : (double)leaves[k].irradiance[0];
	return sum / ROOM_FLOOR_LEAVES;
}

/* The same by the midpoint rule: E / pi * mean over the floor of the integral over the lamp of cos^2 / r^2 = h^2 /
 * r^4. */
static double room_mean_by_hand(void)
{
	enum { FLOOR = 64, LAMP = 16 };
	double sum = 0;
	for (int k = 0; k < FLOOR * FLOOR; k++)
		for (int m = 0; m < LAMP * LAMP; m++) {
			const double x = 4 * (k % FLOOR + .5) / FLOOR - 2 - ((m % LAMP + .5) / LAMP - .5);
			const double z = 4 * (k / FLOOR + .5) / FLOOR - 2 - ((m / LAMP + .5) / LAMP - .5);
			const double r2 = x * x + z * z + 4;
			sum += 4 / (r2 * r2);
		}
	return (double)ROOM_EXITANCE / 3.14159265358979 * sum / ((double)FLOOR * FLOOR * LAMP * LAMP);
}

/* Prints both; true where they are within 2 %. */
static bool room_is_lit(const char *who, const gi_leaf leaves[ROOM_LEAVES])
{
	const double mean = room_mean(leaves), by_hand = room_mean_by_hand();
	printf("%s: the floor receives %.4f W/m2, by hand %.4f\n", who, mean, by_hand);
	return fabs(mean - by_hand) <= .02 * by_hand;
}

#endif
