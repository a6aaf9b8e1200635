#define _POSIX_C_SOURCE 200809L /* rmdir */
#include "furnished_file.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Corners of the unit cube about the middle of its floor, as a thing looks out and as a hall looks in. */
typedef struct binary {
	float cube[8][3];
	float times[2];
	float places[2][3];
	uint16_t outward[36], inward[36];
} binary;

static const float PITCH = 1.1f;

static binary make_binary(void)
{
	static const uint16_t faces[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
					     {3, 7, 6, 2}, {0, 4, 7, 3}, {1, 2, 6, 5}};
	static const int corners[6] = {0, 1, 2, 0, 2, 3};
	binary b = {.times = {0, 2}, .places = {{2, .02f, 2.6f}, {11, .02f, 2.6f}}};
	for (int k = 0; k < 8; k++) {
		b.cube[k][0] = (k & 3) == 1 || (k & 3) == 2 ? .5f : -.5f;
		b.cube[k][1] = (k & 3) > 1 ? 1 : 0;
		b.cube[k][2] = k > 3 ? .5f : -.5f;
	}
	for (int f = 0; f < 6; f++)
		for (int c = 0; c < 6; c++) {
			b.outward[6 * f + c] = faces[f][corners[c]];
			b.inward[6 * f + c] = faces[f][corners[5 - c]];
		}
	return b;
}

static void write_node(FILE *to, int mesh, const float place[3], const float size[3], float turn)
{
	fprintf(to, ",{\"mesh\":%d,\"translation\":[%g,%g,%g],\"rotation\":[0,%.9g,0,%.9g],\"scale\":[%g,%g,%g]}", mesh,
		(double)place[0], (double)place[1], (double)place[2], sin((double)turn), cos((double)turn),
		(double)size[0], (double)size[1], (double)size[2]);
}

static void write_mesh(FILE *to, int indices, int material)
{
	fprintf(to, "{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":%d,\"material\":%d}]}", indices,
		material);
}

static void write_nodes(FILE *to)
{
	const float side = PITCH * FURNISHED_SIDE, middle[3] = {.5f * side, 0, .5f * side}, hall[3] = {side, 3, side};
	const float under_ceiling[3] = {.3f * side, 2.9f, .4f * side}, lamp[3] = {3, .05f, 3};
	fprintf(to, "\"nodes\":[{\"mesh\":0,\"name\":\"rolls\",\"scale\":[0.5,0.8,0.5]}");
	write_node(to, 1, middle, hall, 0);
	write_node(to, 2, under_ceiling, lamp, 0);
	for (int k = 0; k < FURNISHED_THINGS; k++) {
		const int i = k % FURNISHED_SIDE, j = k / FURNISHED_SIDE;
		const float place[3] = {PITCH * ((float)i + .5f), .01f, PITCH * ((float)j + .5f)};
		const float size[3] = {.2f + .05f * (float)(k % 5), .2f + .15f * (float)(k * 7 % 11), .3f};
		/* A lane is left for what rolls. */
		if (j != 2)
			write_node(to, 0, place, size, .1f * (float)(k % 13));
		else
			write_node(to, 0, (float[]){place[0], 2.2f, place[2]}, size, .1f * (float)(k % 13));
	}
	fprintf(to, "],\"scenes\":[{\"nodes\":[0");
	for (int k = 1; k < FURNISHED_THINGS + 3; k++)
		fprintf(to, ",%d", k);
	fprintf(to, "]}],\"scene\":0,");
}

static void write_scene(FILE *to)
{
	fprintf(to, "{\"asset\":{\"version\":\"2.0\"},");
	write_nodes(to);
	fprintf(to, "\"meshes\":[");
	write_mesh(to, 1, 0);
	fprintf(to, ",");
	write_mesh(to, 2, 1);
	fprintf(to, ",");
	write_mesh(to, 1, 2);
	fprintf(
	    to,
	    "],\"materials\":["
	    "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.6,0.4,0.3,1],\"metallicFactor\":0}},"
	    "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.7,0.7,0.7,1],\"metallicFactor\":0}},"
	    "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0,0,0,1],\"metallicFactor\":0},"
	    "\"emissiveFactor\":[1,1,1]}],"
	    "\"animations\":[{\"samplers\":[{\"input\":3,\"output\":4}],"
	    "\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"translation\"}}]}],"
	    "\"buffers\":[{\"byteLength\":%zu,\"uri\":\"hall.bin\"}],\"bufferViews\":["
	    "{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":96},{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":72},"
	    "{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":72},{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":8},"
	    "{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":24}],\"accessors\":["
	    "{\"bufferView\":0,\"componentType\":5126,\"count\":8,\"type\":\"VEC3\",\"min\":[-0.5,0,-0.5],\"max\":[0.5,"
	    "1,0.5]},"
	    "{\"bufferView\":1,\"componentType\":5123,\"count\":36,\"type\":\"SCALAR\"},"
	    "{\"bufferView\":2,\"componentType\":5123,\"count\":36,\"type\":\"SCALAR\"},"
	    "{\"bufferView\":3,\"componentType\":5126,\"count\":2,\"type\":\"SCALAR\",\"min\":[0],\"max\":[2]},"
	    "{\"bufferView\":4,\"componentType\":5126,\"count\":2,\"type\":\"VEC3\"}]}",
	    sizeof(binary), offsetof(binary, cube), offsetof(binary, outward), offsetof(binary, inward),
	    offsetof(binary, times), offsetof(binary, places));
}

static FILE *open_in(const char *folder, const char *name, char *path, size_t path_size)
{
	snprintf(path, path_size, "%s/%s", folder, name);
	return fopen(path, "wb");
}

bool furnished_file_write(const char *folder, char *path, size_t path_size)
{
	const binary b = make_binary();
	FILE *to = open_in(folder, "hall.bin", path, path_size);
	bool ok = to && fwrite(&b, sizeof b, 1, to) == 1;
	ok = to && fclose(to) == 0 && ok;
	to = open_in(folder, "hall.gltf", path, path_size);
	if (to)
		write_scene(to);
	return to && fclose(to) == 0 && ok;
}

void furnished_file_remove(const char *folder)
{
	static const char *const names[] = {"hall.bin", "hall.gltf"};
	char path[256];
	for (int k = 0; k < 2; k++) {
		snprintf(path, sizeof path, "%s/%s", folder, names[k]);
		remove(path);
	}
	rmdir(folder);
}
