/* Planes that a file's rounding bends or parts (engine/import_level.h): rooms that share a wall, turned and kilometres
 * off, in all formats and precisions; and what is apart stays apart.
 */
#define _XOPEN_SOURCE 700 /* mkdtemp */
#include "scene_files.h"
#include "import_points.h"

typedef struct site {
	double axis[3], angle, offset[3];
} site;

static void place(const site *s, const double p[3], double out[3])
{
	const double length = sqrt(s->axis[0] * s->axis[0] + s->axis[1] * s->axis[1] + s->axis[2] * s->axis[2]);
	const double k[3] = {s->axis[0] / length, s->axis[1] / length, s->axis[2] / length};
	const double along = k[0] * p[0] + k[1] * p[1] + k[2] * p[2], c = cos(s->angle), n = sin(s->angle);
	for (int i = 0; i < 3; i++) {
		const int j = (i + 1) % 3, l = (i + 2) % 3;
		out[i] = p[i] * c + (k[j] * p[l] - k[l] * p[j]) * n + k[i] * along * (1 - c) + s->offset[i];
	}
}

/* Boxes, each an object of eight corners and six faces. */
enum { MOST_BOXES = 3, CORNERS = 8, SIDES = 6 };
typedef struct boxes {
	double lower[MOST_BOXES][3], upper[MOST_BOXES][3];
	uint32_t count;
} boxes;

static const uint32_t sides[SIDES][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
					 {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

static void corner_of(const boxes *b, uint32_t box, uint32_t corner, double out[3])
{
	for (int c = 0; c < 3; c++)
		out[c] = (corner >> c & 1 ? b->upper : b->lower)[box][c];
}

typedef enum format { OBJ, OBJ_TRIANGLES, PLY_TEXT, PLY_FLOATS, GLTF, GLTF_NODE, FORMATS } format;
static const char *const format_names[FORMATS] = {"OBJ",         "OBJ, triangles", "PLY, text",
						  "PLY, floats", "glTF",           "glTF, moved by its node"};

static void write_obj(const boxes *b, const site *s, int digits, bool triangles, FILE *to)
{
	for (uint32_t k = 0; k < b->count; k++) {
		fprintf(to, "o box%u\n", k);
		for (uint32_t v = 0; v < CORNERS; v++) {
			double own[3], p[3];
			corner_of(b, k, v, own);
			place(s, own, p);
			fprintf(to, "v %.*g %.*g %.*g\n", digits, p[0], digits, p[1], digits, p[2]);
		}
		for (uint32_t f = 0; f < SIDES; f++) {
			const uint32_t n = CORNERS * k + 1, *c = sides[f];
			if (triangles)
				fprintf(to, "f %u %u %u\nf %u %u %u\n", n + c[0], n + c[1], n + c[2], n + c[0],
					n + c[2], n + c[3]);
			else
				fprintf(to, "f %u %u %u %u\n", n + c[0], n + c[1], n + c[2], n + c[3]);
		}
	}
}

static void write_ply(const boxes *b, const site *s, int digits, bool text, FILE *to)
{
	fprintf(to,
		"ply\nformat %s 1.0\nelement vertex %u\nproperty %s x\nproperty %s y\nproperty %s z\nelement face "
		"%u\nproperty list uchar int vertex_indices\nend_header\n",
		text ? "ascii" : "binary_little_endian", b->count * CORNERS, text ? "double" : "float",
		text ? "double" : "float", text ? "double" : "float", b->count * SIDES);
	for (uint32_t v = 0; v < b->count * CORNERS; v++) {
		double own[3], p[3];
		corner_of(b, v / CORNERS, v % CORNERS, own);
		place(s, own, p);
		const float floats[3] = {(float)p[0], (float)p[1], (float)p[2]};
		if (text)
			fprintf(to, "%.*g %.*g %.*g\n", digits, p[0], digits, p[1], digits, p[2]);
		else
			fwrite(floats, sizeof floats, 1, to);
	}
	for (uint32_t f = 0; f < b->count * SIDES; f++) {
		const uint32_t n = f / SIDES * CORNERS, *c = sides[f % SIDES];
		const uint32_t corners[4] = {n + c[0], n + c[1], n + c[2], n + c[3]};
		if (text)
			fprintf(to, "4 %u %u %u %u\n", corners[0], corners[1], corners[2], corners[3]);
		else {
			fputc(4, to);
			fwrite(corners, sizeof corners, 1, to);
		}
	}
}

/* A mesh a box; `moved`: where they stand is said by a node each, in nine digits, its mesh turned about its own middle.
 */
static void write_gltf(const boxes *b, const site *s, bool moved, FILE *to)
{
	FILE *bin = fopen(path_of("a.bin"), "wb");
	assert_non_null(bin);
	fprintf(to, "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"uri\":\"a.bin\",\"byteLength\":%u}],",
		b->count * 240);
	fprintf(to, "\"nodes\":[");
	for (uint32_t k = 0; k < b->count; k++) {
		double middle[3] = {0}, at[3] = {0};
		if (moved) {
			for (int c = 0; c < 3; c++)
				middle[c] = .5 * (b->lower[k][c] + b->upper[k][c]);
			place(s, middle, at);
		}
		fprintf(to, "%s{\"mesh\":%u,\"translation\":[%.9g,%.9g,%.9g]}", k ? "," : "", k, at[0], at[1], at[2]);
		for (uint32_t v = 0; v < CORNERS; v++) {
			double own[3], p[3];
			corner_of(b, k, v, own);
			place(s, own, p);
			const float floats[3] = {(float)(p[0] - at[0]), (float)(p[1] - at[1]), (float)(p[2] - at[2])};
			fwrite(floats, sizeof floats, 1, bin);
		}
		for (uint32_t f = 0; f < SIDES; f++) {
			const uint32_t *c = sides[f];
			const uint16_t corners[6] = {(uint16_t)c[0], (uint16_t)c[1], (uint16_t)c[2],
						     (uint16_t)c[0], (uint16_t)c[2], (uint16_t)c[3]};
			fwrite(corners, sizeof corners, 1, bin);
		}
		for (int pad = 0; pad < 72; pad++)
			fputc(0, bin);
	}
	fclose(bin);
	fprintf(to, "],\"scenes\":[{\"nodes\":[");
	for (uint32_t k = 0; k < b->count; k++)
		fprintf(to, "%s%u", k ? "," : "", k);
	fprintf(to, "]}],\"meshes\":[");
	for (uint32_t k = 0; k < b->count; k++)
		fprintf(to, "%s{\"primitives\":[{\"attributes\":{\"POSITION\":%u},\"indices\":%u}]}", k ? "," : "",
			2 * k, 2 * k + 1);
	fprintf(to, "],\"accessors\":[");
	for (uint32_t k = 0; k < b->count; k++)
		fprintf(to,
			"%s{\"bufferView\":%u,\"componentType\":5126,\"count\":8,\"type\":\"VEC3\"},"
			"{\"bufferView\":%u,\"componentType\":5123,\"count\":36,\"type\":\"SCALAR\"}",
			k ? "," : "", 2 * k, 2 * k + 1);
	fprintf(to, "],\"bufferViews\":[");
	for (uint32_t k = 0; k < b->count; k++)
		fprintf(to,
			"%s{\"buffer\":0,\"byteOffset\":%u,\"byteLength\":96},"
			"{\"buffer\":0,\"byteOffset\":%u,\"byteLength\":72}",
			k ? "," : "", 240 * k, 240 * k + 96);
	fprintf(to, "]}");
}

static engine_scene load_boxes(const boxes *b, const site *s, format form, int digits)
{
	const char *name = form <= OBJ_TRIANGLES ? "a.obj" : form <= PLY_FLOATS ? "a.ply" : "a.gltf";
	FILE *to = fopen(path_of(name), "wb");
	assert_non_null(to);
	if (form <= OBJ_TRIANGLES)
		write_obj(b, s, digits, form == OBJ_TRIANGLES, to);
	else if (form <= PLY_FLOATS)
		write_ply(b, s, digits, form == PLY_TEXT, to);
	else
		write_gltf(b, s, form == GLTF_NODE, to);
	fclose(to);
	return load(path_of(name));
}

static void world_of(const engine_scene_object *o, uint32_t vertex, double out[3])
{
	const double q[4] = {o->rest.rotation[0], o->rest.rotation[1], o->rest.rotation[2], o->rest.rotation[3]};
	const float *f = o->mesh.positions + 3 * (size_t)vertex;
	double p[3], t[3];
	for (int c = 0; c < 3; c++)
		p[c] = (double)f[c] * (double)o->rest.scale[c];
	for (int c = 0; c < 3; c++)
		t[c] = 2 * (q[(c + 1) % 3] * p[(c + 2) % 3] - q[(c + 2) % 3] * p[(c + 1) % 3]);
	for (int c = 0; c < 3; c++)
		out[c] = p[c] + q[3] * t[c] + q[(c + 1) % 3] * t[(c + 2) % 3] - q[(c + 2) % 3] * t[(c + 1) % 3] +
			 (double)o->rest.translation[c];
}

/* The loaded corner that is nearest to one of a box, among the boxes' own ones where they are objects, and how far. */
static double nearest(const engine_scene *scene, const boxes *b, const site *s, uint32_t box, uint32_t corner,
		      double out[3])
{
	double own[3], p[3], best = INFINITY;
	corner_of(b, box, corner, own);
	place(s, own, p);
	for (uint32_t o = 0; o < scene->object_count; o++) {
		if (scene->object_count == b->count && o != box)
			continue;
		for (uint32_t v = 0; v < scene->objects[o].mesh.vertex_count; v++) {
			double q[3], d2 = 0;
			world_of(&scene->objects[o], v, q);
			for (int c = 0; c < 3; c++)
				d2 += pow(q[c] + scene->origin[c] - p[c], 2);
			if (d2 < best) {
				best = d2;
				memcpy(out, q, sizeof q);
			}
		}
	}
	return sqrt(best);
}

static void plane_of(double corners[4][3], double plane[4])
{
	double u[3], v[3], length = 0;
	for (int c = 0; c < 3; c++) {
		u[c] = corners[2][c] - corners[0][c];
		v[c] = corners[3][c] - corners[1][c];
	}
	for (int c = 0; c < 3; c++)
		plane[c] = u[(c + 1) % 3] * v[(c + 2) % 3] - u[(c + 2) % 3] * v[(c + 1) % 3];
	for (int c = 0; c < 3; c++)
		length += plane[c] * plane[c];
	plane[3] = 0;
	for (int c = 0; c < 3; c++) {
		plane[c] /= sqrt(length);
		for (int k = 0; k < 4; k++)
			plane[3] += .25 * plane[c] * corners[k][c];
	}
}

typedef struct figures {
	double bent, parted,
	    moved;    /* m: corners off their side's plane, off that of the shared wall; from their places */
	double reach; /* m: the largest coordinate as loaded */
} figures;

/* Side 1 of box 0 and side 0 of box 1 are one wall. */
static figures measure(const engine_scene *scene, const boxes *b, const site *s)
{
	figures f = {0};
	double wall[4] = {0};
	for (uint32_t box = 0; box < b->count; box++)
		for (uint32_t side = 0; side < SIDES; side++) {
			double corners[4][3], plane[4];
			for (int k = 0; k < 4; k++) {
				f.moved = fmax(f.moved, nearest(scene, b, s, box, sides[side][k], corners[k]));
				for (int c = 0; c < 3; c++)
					f.reach = fmax(f.reach, fabs(corners[k][c]));
			}
			plane_of(corners, plane);
			if (box == 0 && side == 1)
				memcpy(wall, plane, sizeof wall);
			for (int k = 0; k < 4; k++) {
				const double *p = corners[k];
				f.bent =
				    fmax(f.bent, fabs(p[0] * plane[0] + p[1] * plane[1] + p[2] * plane[2] - plane[3]));
				if (box == 1 && side == 0)
					f.parted = fmax(
					    f.parted, fabs(p[0] * wall[0] + p[1] * wall[1] + p[2] * wall[2] - wall[3]));
			}
		}
	return f;
}

/* What floats leave, of the largest coordinate; a renderer takes 2.5e-7 of coordinates for one place, of both ends. */
static const double FLAT = 1.2e-7;

static void rooms_that_share_a_wall(void **state)
{
	(void)state;
	static const boxes rooms[] = {
	    {{{0, 0, 0}, {3.1, -.35, -.4}}, {{3.1, 2.5, 4}, {7, 2.9, 4.7}}, 2},
	    {{{-2, 0, 0}, {1.37, 0, .81}, {1.37, 0, -3}}, {{1.37, 2.4, 2.2}, {3.3, 2.4, 2.9}, {2.7, 2.2, .81}}, 3},
	};
	static const site sites[] = {
	    {{1, 2, .5}, .7, {3000, 120, -2000}},
	    {{-.3, 1, .8}, 2.1, {-640, 35, 990}},
	    {{.2, -.9, .4}, 1.3, {9800, -210, 4100}},
	    {{0, 1, 0}, .4, {412345, 87, -733210}},
	};
	for (size_t r = 0; r < sizeof rooms / sizeof *rooms; r++)
		for (size_t k = 0; k < sizeof sites / sizeof *sites; k++)
			for (int form = 0; form < FORMATS; form++)
				for (int digits = 6; digits <= (form <= PLY_TEXT ? 9 : 6); digits++) {
					const site *s = &sites[k];
					double largest = 0;
					for (int c = 0; c < 3; c++)
						largest = fmax(largest, fabs(s->offset[c]) + 8);
					const double unit = form > PLY_TEXT
								? ldexp(largest, -23)
								: pow(10, floor(log10(largest)) + 1 - digits);
					if (unit > .02) /* rooms of blocks */
						continue;
					engine_scene scene = load_boxes(&rooms[r], s, (format)form, digits);
					const figures f = measure(&scene, &rooms[r], s);
					printf("%s, %d digits, %.0f m off: unit %.1g m; sides bent by %.1g, shared "
					       "wall parted "
					       "by %.1g, corners moved by %.1g m\n",
					       format_names[form], digits, largest, unit, f.bent, f.parted, f.moved);
					assert_true(fmax(f.bent, f.parted) <= FLAT * f.reach);
					assert_true(f.moved <= 3 * unit + FLAT * f.reach);
					engine_scene_free(&scene);
				}
}

/* Sheets a millimetre apart, and a step of one, where the file tells millimetres. */
static void what_is_apart_stays_apart(void **state)
{
	(void)state;
	static const boxes rooms = {{{0, 0, 0}, {3.101, 0, .5}}, {{3.1, 2.5, 4}, {7, 2.501, 4}}, 2};
	static const site sites[] = {
	    {{1, 2, .5}, .7, {2, 1, -3}}, {{1, 2, .5}, 0, {0, 0, 0}}, {{1, 1, .5}, .6, {70, 9, -50}}};
	for (size_t k = 0; k < sizeof sites / sizeof *sites; k++)
		for (int form = 0; form < FORMATS; form++)
			for (int digits = 6; digits <= 9; digits++) {
				engine_scene scene = load_boxes(&rooms, &sites[k], (format)form, digits);
				const figures f = measure(&scene, &rooms, &sites[k]);
				if (digits == 6)
					printf("%s, %.0f m off: 1 mm is %.4f mm\n", format_names[form],
					       fabs(sites[k].offset[0]), 1e3 * f.parted);
				assert_true(fabs(f.parted - 1e-3) <= 3e-4);
				engine_scene_free(&scene);
			}
}

/* Digits that people write are meant: nothing is moved by a bit. */
static void what_people_write_is_meant(void **state)
{
	(void)state;
	engine_scene scene = load(write_text("b.obj", "v 0 0 0\nv 4.01 0 0.02\nv 4 2.5 0\nv 0 2.5 0.01\nf 1 2 3 4\n"));
	const float positions[] = {0, 0, 0, 4.01f, 0, .02f, 4, 2.5f, 0, 0, 2.5f, .01f};
	assert_memory_equal(scene.objects[0].mesh.positions, positions, sizeof positions);
	engine_scene_free(&scene);
}

/* A wavy sheet of many faces, in six digits: no corner is moved by more than some units. */
static void curved_meshes_stay_curved(void **state)
{
	(void)state;
	enum { N = 150 };
	FILE *to = fopen(path_of("c.obj"), "w");
	assert_non_null(to);
	for (int i = 0; i < N; i++)
		for (int k = 0; k < N; k++)
			fprintf(to, "v %.6g %.6g %.6g\n", 1500 + .02 * i, .1 * sin(.04 * i) * cos(.05 * k),
				-900 + .02 * k);
	for (int i = 0; i + 1 < N; i++)
		for (int k = 0; k + 1 < N; k++)
			fprintf(to, "f %d %d %d %d\n", i * N + k + 1, i * N + k + 2, (i + 1) * N + k + 2,
				(i + 1) * N + k + 1);
	fclose(to);
	engine_scene scene = load(path_of("c.obj"));
	const engine_mesh *mesh = &scene.objects[0].mesh;
	double worst = 0;
	assert_int_equal(mesh->vertex_count, N * N);
	for (uint32_t v = 0; v < N * N; v++) {
		double p[3];
		world_of(&scene.objects[0], v, p);
		worst = fmax(worst, fabs(p[1] + scene.origin[1] - .1 * sin(.04 * (v / N)) * cos(.05 * (v % N))));
	}
	printf("a wavy sheet of %u faces in steps of 10 mm: heights off by %.2g mm at most\n", mesh->face_count,
	       1e3 * worst);
	assert_true(worst <= .04);
	engine_scene_free(&scene);
}

/* Where nothing was rounded only what is in the very same place is one point; far away and far apart too. */
static void points_without_rounding(void **state)
{
	(void)state;
	const double points[] = {0, 0, 0, -0.0, 0, 0, 1e300, 0, -1e300, 1e300, 0, -1e300, 1e-300, 0, 0};
	const uint32_t wanted[] = {0, 0, 2, 2, 4};
	uint32_t first[5];
	for (int k = 0; k < 2; k++) {
		assert_true(import_points_weld(points, 5, k ? 1e-320 : 0, first));
		assert_memory_equal(first, wanted, sizeof wanted);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(rooms_that_share_a_wall),    cmocka_unit_test(what_is_apart_stays_apart),
	    cmocka_unit_test(what_people_write_is_meant), cmocka_unit_test(curved_meshes_stay_curved),
	    cmocka_unit_test(points_without_rounding),
	};
	return cmocka_run_group_tests_name("level planes", tests, make_folder, remove_folder);
}
