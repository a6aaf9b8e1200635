#include "plain_files.h"

#include <math.h>
#include <string.h>

/* ---- points and faces ---- */

static void turn(const double axis[3], double angle, const double p[3], double out[3])
{
	const double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
	if (length == 0) {
		memcpy(out, p, 3 * sizeof *out);
		return;
	}
	/* Rodrigues' formula. */
	const double k[3] = {axis[0] / length, axis[1] / length, axis[2] / length};
	const double along = k[0] * p[0] + k[1] * p[1] + k[2] * p[2], c = cos(angle), s = sin(angle);
	for (int i = 0; i < 3; i++) {
		const int j = (i + 1) % 3, l = (i + 2) % 3;
		out[i] = p[i] * c + (k[j] * p[l] - k[l] * p[j]) * s + k[i] * along * (1 - c);
	}
}

void plain_file_own(const placement *where, const double in[3], double out[3])
{
	double p[3];
	for (int k = 0; k < 3; k++)
		p[k] = (in[k] - where->offset[k]) / where->scale;
	turn(where->axis, -where->angle, p, out);
}

static void point(FILE *to, const placement *where, double x, double y, double z)
{
	double p[3];
	turn(where->axis, where->angle, (double[]){x, y, z}, p);
	fprintf(to, "v %.9g %.9g %.9g\n", where->scale * p[0] + where->offset[0],
		where->scale * p[1] + where->offset[1], where->scale * p[2] + where->offset[2]);
}

/* The last corners written are a face's. */
static void face(FILE *to, uint32_t count)
{
	fprintf(to, "f");
	for (uint32_t k = 0; k < count; k++)
		fprintf(to, " %d", (int)k - (int)count);
	fprintf(to, "\n");
}

static void object(FILE *to, const char *name, const char *material)
{
	fprintf(to, "o %s\nusemtl %s\n", name, material);
}

/* Corner, then along u, u + v, v; the front is u x v. */
static void quad(FILE *to, const placement *w, const double c[3], const double u[3], const double v[3])
{
	point(to, w, c[0], c[1], c[2]);
	point(to, w, c[0] + u[0], c[1] + u[1], c[2] + u[2]);
	point(to, w, c[0] + u[0] + v[0], c[1] + u[1] + v[1], c[2] + u[2] + v[2]);
	point(to, w, c[0] + v[0], c[1] + v[1], c[2] + v[2]);
	face(to, 4);
}

/* Eight corners, six faces that share them. */
static void box(FILE *to, const placement *w, const double a[3], const double b[3], bool inward)
{
	static const int faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
					{2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
	for (int k = 0; k < 8; k++)
		point(to, w, (k & 1 ? b : a)[0], (k & 2 ? b : a)[1], (k & 4 ? b : a)[2]);
	for (int k = 0; k < 6; k++) {
		fprintf(to, "f");
		for (int i = 0; i < 4; i++)
			fprintf(to, " %d", faces[k][inward ? 3 - i : i] - 8);
		fprintf(to, "\n");
	}
}

static void lamp_down(FILE *to, const placement *w, double x, double y, double z, double side)
{
	object(to, "lamp", "lamp");
	quad(to, w, (double[]){x - side / 2, y, z - side / 2}, (double[]){side, 0, 0}, (double[]){0, 0, side});
}

#define BOX(to, w, x0, y0, z0, x1, y1, z1) box(to, w, (const double[]){x0, y0, z0}, (const double[]){x1, y1, z1}, false)
#define ROOM(to, w, x0, y0, z0, x1, y1, z1) box(to, w, (const double[]){x0, y0, z0}, (const double[]){x1, y1, z1}, true)

/* ---- the files ---- */

/* A wall of three boxes leaves a door of 0.9 x 2 m; behind a second wall nothing is lit. */
static void rooms_with_door(FILE *to, const placement *w)
{
	object(to, "shell", "white");
	ROOM(to, w, 0, 0, 0, 9, 2.6, 3.7);
	object(to, "walls", "white");
	BOX(to, w, 3.4, 0, 0, 3.5, 2.6, 1.3);
	BOX(to, w, 3.4, 0, 2.2, 3.5, 2.6, 3.7);
	BOX(to, w, 3.4, 2, 1.3, 3.5, 2.6, 2.2);
	object(to, "wall", "grey");
	BOX(to, w, 6.65, 0, 0, 6.75, 2.6, 3.7);
	lamp_down(to, w, 1.6, 2.55, 1.9, .6);
}

/* Floor and ceiling are polygons of six corners. */
static void l_room(FILE *to, const placement *w)
{
	static const double plan[6][2] = {{0, 0}, {6.2, 0}, {6.2, 2.4}, {2.7, 2.4}, {2.7, 5.1}, {0, 5.1}};
	object(to, "floor", "grey");
	for (int k = 5; k >= 0; k--)
		point(to, w, plan[k][0], 0, plan[k][1]);
	face(to, 6);
	object(to, "ceiling", "white");
	for (int k = 0; k < 6; k++)
		point(to, w, plan[k][0], 2.5, plan[k][1]);
	face(to, 6);
	object(to, "walls", "white");
	for (int k = 0; k < 6; k++) {
		const double *a = plan[k], *b = plan[(k + 1) % 6];
		point(to, w, a[0], 0, a[1]);
		point(to, w, b[0], 0, b[1]);
		point(to, w, b[0], 2.5, b[1]);
		point(to, w, a[0], 2.5, a[1]);
		face(to, 4);
	}
	lamp_down(to, w, 1.2, 2.4, 4.2, .7);
}

/* Closed, of walls 0.1 m thick, on one quad of ground; a lamp high above beside it. */
static void hut_on_ground(FILE *to, const placement *w)
{
	object(to, "ground", "grey");
	quad(to, w, (double[]){-6, 0, -6}, (double[]){0, 0, 12}, (double[]){12, 0, 0});
	object(to, "hut", "white");
	BOX(to, w, -1.5, 0, -1.2, -1.4, 2.2, 1.3);
	BOX(to, w, 1.6, 0, -1.2, 1.7, 2.2, 1.3);
	BOX(to, w, -1.4, 0, -1.2, 1.6, 2.2, -1.1);
	BOX(to, w, -1.4, 0, 1.2, 1.6, 2.2, 1.3);
	BOX(to, w, -1.7, 2.2, -1.4, 1.9, 2.3, 1.5);
	lamp_down(to, w, 2.5, 5, 2, 1.5);
}

/* Table, cupboard, chair and shelf: one mesh. */
static void furnished(FILE *to, const placement *w)
{
	object(to, "room", "white");
	ROOM(to, w, 0, 0, 0, 4.8, 2.5, 3.6);
	object(to, "furniture", "grey");
	BOX(to, w, 1.5, .7, 1.2, 3.1, .74, 2);
	for (int k = 0; k < 4; k++) {
		const double x = k & 1 ? 3 : 1.55, z = k & 2 ? 1.9 : 1.25;
		BOX(to, w, x, 0, z, x + .05, .7, z + .05);
	}
	BOX(to, w, 0, 0, .4, .5, 1.9, 1.6);
	BOX(to, w, 2, .42, 2.3, 2.45, .46, 2.75);
	for (int k = 0; k < 4; k++) {
		const double x = k & 1 ? 2.41 : 2, z = k & 2 ? 2.71 : 2.3;
		BOX(to, w, x, 0, z, x + .04, .42, z + .04);
	}
	BOX(to, w, 4.5, 1.2, .5, 4.8, 1.23, 2.5);
	lamp_down(to, w, 2.4, 2.4, 1.8, .5);
}

/* A bulb in a closed box of walls 2 cm thick, and a lamp outside. */
static void hollow(FILE *to, const placement *w)
{
	object(to, "room", "white");
	ROOM(to, w, 0, 0, 0, 4, 2.7, 4);
	object(to, "chest", "white");
	BOX(to, w, 1, 0, 1.3, 2.2, .9, 2.1);
	ROOM(to, w, 1.02, .02, 1.32, 2.18, .88, 2.08);
	lamp_down(to, w, 2.9, 2.6, 2.9, .6);
}

/* Sheets without thickness: a screen in the room, and one that shuts off its end. */
static void sheets(FILE *to, const placement *w)
{
	object(to, "room", "white");
	ROOM(to, w, 0, 0, 0, 5.4, 2.4, 3.1);
	object(to, "screen", "grey");
	quad(to, w, (double[]){1.7, 0, 0}, (double[]){0, 0, 1.9}, (double[]){0, 1.8, 0});
	quad(to, w, (double[]){1.7, 0, 0}, (double[]){0, 1.8, 0}, (double[]){0, 0, 1.9});
	object(to, "end", "grey");
	quad(to, w, (double[]){4.1, 0, 0}, (double[]){0, 0, 3.1}, (double[]){0, 2.4, 0});
	quad(to, w, (double[]){4.1, 0, 0}, (double[]){0, 2.4, 0}, (double[]){0, 0, 3.1});
	lamp_down(to, w, .8, 2.3, 1, .5);
}

/* Boxes on one another and side by side. */
static void stacked(FILE *to, const placement *w)
{
	object(to, "room", "white");
	ROOM(to, w, 0, 0, 0, 4, 2.8, 4);
	for (int k = 0; k < 4; k++) {
		object(to, "box", k % 2 ? "white" : "grey");
		BOX(to, w, 1 + .11 * k, .4 * k, 1.2 - .05 * k, 1.8 + .11 * k, .4 * k + .4, 2 - .05 * k);
	}
	object(to, "beside", "grey");
	BOX(to, w, 1.8, 0, 1.2, 2.6, .4, 2);
	lamp_down(to, w, 2, 2.7, 2.6, .6);
}

/* Two floors of a house in one mesh, the stairs not built: the upper one is dark. */
static void two_floors(FILE *to, const placement *w)
{
	object(to, "house", "white");
	ROOM(to, w, 0, 0, 0, 5, 2.5, 4);
	ROOM(to, w, 0, 2.7, 0, 5, 5.2, 4);
	BOX(to, w, -.2, -.2, -.2, 5.2, 5.4, 4.2);
	BOX(to, w, 1, 0, 1, 1.6, .8, 2.1);
	BOX(to, w, 1, 2.7, 1, 1.6, 3.5, 2.1);
	lamp_down(to, w, 2.9, 2.4, 1.8, .6);
}

static void corridor(FILE *to, const placement *w)
{
	object(to, "corridor", "white");
	ROOM(to, w, 0, 0, 0, 14, 2.3, 1.3);
	object(to, "pillar", "grey");
	BOX(to, w, 5, 0, 0, 5.25, 2.3, .25);
	BOX(to, w, 9, 0, 1.05, 9.25, 2.3, 1.3);
	lamp_down(to, w, 2, 2.25, .65, .5);
}

/* Two closed rooms of one shell each, a wall of no thickness between them. */
static void shared_plane(FILE *to, const placement *w)
{
	object(to, "left", "white");
	ROOM(to, w, 0, 0, 0, 3.1, 2.5, 4);
	object(to, "right", "white");
	ROOM(to, w, 3.1, -.35, -.4, 7, 2.9, 4.7);
	object(to, "cupboard", "grey");
	BOX(to, w, 0, 0, 1, .6, 1.9, 2);
	lamp_down(to, w, 1.6, 2.4, 2.1, .6);
}

/* ---- all ---- */

#define NOWHERE                                                                                                        \
	{                                                                                                              \
		{0, 0, 0},                                                                                             \
		{                                                                                                      \
			0, 0, 0                                                                                        \
		}                                                                                                      \
	}
#define AS_IS                                                                                                          \
	{                                                                                                              \
		1, {0, 0, 0}, 0,                                                                                       \
		{                                                                                                      \
			0, 0, 0                                                                                        \
		}                                                                                                      \
	}

const plain_file plain_files[PLAIN_FILE_COUNT] = {
    {"door", rooms_with_door, AS_IS, {{-1, -1, -1}, {3.45, 3, 4}}, {{6.7, -1, -1}, {9.5, 3, 4}}},
    {"door_mm",
     rooms_with_door,
     {1000, {0, 0, 0}, 0, {0, 0, 0}},
     {{-1, -1, -1}, {3.45, 3, 4}},
     {{6.7, -1, -1}, {9.5, 3, 4}}},
    {"door_far",
     rooms_with_door,
     {1, {0, 0, 0}, 0, {3000, 120, -2000}},
     {{-1, -1, -1}, {3.45, 3, 4}},
     {{6.7, -1, -1}, {9.5, 3, 4}}},
    {"door_turned_far",
     rooms_with_door,
     {1, {1, 2, .5}, .7, {3000, 120, -2000}},
     {{-1, -1, -1}, {3.45, 3, 4}},
     {{6.7, -1, -1}, {9.5, 3, 4}}},
    {"l_room", l_room, AS_IS, NOWHERE, NOWHERE},
    {"hut", hut_on_ground, AS_IS, {{-6, -.1, 1.6}, {6, .1, 6}}, {{-1.39, -.05, -1.09}, {1.59, 2.19, 1.19}}},
    {"furnished", furnished, AS_IS, NOWHERE, NOWHERE},
    {"furnished_turned", furnished, {1, {.3, 1, -.4}, 1.1, {2, -1, .5}}, NOWHERE, NOWHERE},
    {"hollow", hollow, AS_IS, {{-1, -1, 2.2}, {5, 3, 5}}, {{1.015, .015, 1.315}, {2.185, .885, 2.085}}},
    {"sheets", sheets, {1, {0, 1, 0}, .3, {0, 0, 0}}, {{-1, -1, -1}, {1.65, 3, 4}}, {{4.15, -1, -1}, {6, 3, 4}}},
    {"stacked", stacked, AS_IS, NOWHERE, NOWHERE},
    {"two_floors", two_floors, AS_IS, {{-.1, -.1, -.1}, {5.1, 2.55, 4.1}}, {{-.1, 2.65, -.1}, {5.1, 5.25, 4.1}}},
    {"shared", shared_plane, AS_IS, {{-1, -1, -1}, {3.09, 3, 5}}, {{3.11, -1, -1}, {8, 3, 5}}},
    {"shared_turned",
     shared_plane,
     {1, {1, 2, .5}, .7, {0, 0, 0}},
     {{-1, -1, -1}, {3.09, 3, 5}},
     {{3.11, -1, -1}, {8, 3, 5}}},
    {"shared_turned_far",
     shared_plane,
     {1, {1, 2, .5}, .7, {3000, 120, -2000}},
     {{-1, -1, -1}, {3.09, 3, 5}},
     {{3.11, -1, -1}, {8, 3, 5}}},
    {"corridor_feet", corridor, {3.28084, {0, 0, 0}, 0, {0, 0, 0}}, NOWHERE, NOWHERE},
};

static bool write_materials(const char *path)
{
	FILE *to = fopen(path, "w");
	if (!to)
		return false;
	fprintf(to, "newmtl white\nKd .75 .75 .75\nnewmtl grey\nKd .4 .45 .5\nnewmtl lamp\nKd 0 0 0\nKe 12 11 9\n");
	return fclose(to) == 0;
}

bool plain_file_write(const plain_file *file, const char *folder, char *path, size_t path_size)
{
	snprintf(path, path_size, "%s/%s.mtl", folder, file->name);
	if (!write_materials(path))
		return false;
	snprintf(path, path_size, "%s/%s.obj", folder, file->name);
	FILE *to = fopen(path, "w");
	if (!to)
		return false;
	fprintf(to, "mtllib %s.mtl\n", file->name);
	file->write(to, &file->where);
	return fclose(to) == 0;
}
