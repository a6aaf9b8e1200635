#include "fuzz_input.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void require(bool holds, const char *what)
{
	if (holds)
		return;
	fprintf(stderr, "broken promise: %s\n", what);
	abort();
}

void check(gi_result result)
{
	require(result >= GI_OK && result < GI_RESULT_COUNT, "a result of the list");
}

void check_message(gi_result result, const char *message, void *user)
{
	(void)user;
	check(result);
	require(message && !strchr(message, '\n'), "a message is one line");
}

uint8_t next_byte(input *in)
{
	if (in->size == 0)
		return 0;
	in->size--;
	return *in->bytes++;
}

uint32_t next_below(input *in, uint32_t limit)
{
	return next_byte(in) % limit;
}

float next_float(input *in)
{
	static const float hostile[] = {0,     -0.0f, NAN,   INFINITY, -INFINITY, 1e-45f,    1e-20f, 1e9f,
					-1e9f, 1e12f, 3e38f, -3e38f,   1,         0.999999f, -1,     1e-3f};
	uint8_t kind = next_byte(in);
	float value;
	if (kind < 200)
		return ((float)kind - 100) / 25;
	if (kind < 250) {
		value = hostile[next_below(in, sizeof hostile / sizeof hostile[0])];
	} else {
		uint8_t raw[4];
		for (int i = 0; i < 4; i++)
			raw[i] = next_byte(in);
		memcpy(&value, raw, sizeof value);
	}
	if (!(fabsf(value) <= 100))
		in->sane = false;
	return value;
}

void next_floats(input *in, float *out, int count)
{
	for (int i = 0; i < count; i++)
		out[i] = next_float(in);
}

float next_share(input *in)
{
	uint8_t kind = next_byte(in);
	return kind < 250 ? (float)kind / 256 : next_float(in);
}

gi_pose next_pose(input *in)
{
	gi_pose pose = gi_pose_identity();
	uint8_t parts = next_byte(in);
	if (parts & 1)
		next_floats(in, pose.position, 3);
	if (parts & 2)
		next_floats(in, pose.rotation, 4);
	return pose;
}

gi_material next_material(input *in)
{
	gi_material material = {0};
	for (int c = 0; c < 3; c++)
		material.rho[c] = next_share(in);
	if (next_byte(in) & 1) {
		for (int c = 0; c < 3; c++)
			material.exitance[c] = 10 * next_share(in);
	}
	return material;
}

gi_object next_object(input *in)
{
	uint8_t kind = next_byte(in);
	if (kind < 250)
		return in->objects[kind % SLOTS];
	gi_object forged = {.index1 = next_byte(in) * 16843009u};
	forged.generation = next_byte(in);
	return forged;
}

void remember(input *in, const gi_material *materials, uint32_t count)
{
	for (uint32_t m = 0; m < count; m++) {
		for (int c = 0; c < 3; c++) {
			in->exitance = fmaxf(in->exitance, materials[m].exitance[c]);
			in->rho = fmaxf(in->rho, materials[m].rho[c]);
		}
	}
}
