/* Surfaces that lie in one place count once: rooms that share a wall, faces given twice, plates in the plane of a wall.
 *
 * A closed room of six walls and a lamp, alone and with what must not change its light; every sheet an object, and all
 * of them one mesh; as it is, and turned and far from the origin.
 */
#include "pieces.h"

#include "scenes/body.h"
#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* ---- scenes of sheets ---- */

typedef struct sheet {
	float corner[3], u[3], v[3]; /* its front is the side u x v points to */
	uint32_t n;                  /* n x n faces */
	float rho, exitance;
} sheet;

enum { MOST_SHEETS = 32 };

typedef struct sheets {
	sheet list[MOST_SHEETS];
	uint32_t count;
	uint32_t levels; /* each face is 4^levels leaves */
} sheets;

/* Walls have a reflectance of their own, by which their leaves are known; what is added differs from it by nothing that
 * shows. */
static const float WALL = .7f, ADDED = .70001f;

static void add(sheets *s, sheet one)
{
	assert_true(s->count < MOST_SHEETS);
	s->list[s->count++] = one;
}

static sheet turned_round(sheet s)
{
	float u[3];
	memcpy(u, s.u, sizeof u);
	memcpy(s.u, s.v, sizeof u);
	memcpy(s.v, u, sizeof u);
	return s;
}

static sheet like(sheet s, float rho, float exitance)
{
	s.rho = rho;
	s.exitance = exitance;
	return s;
}

/* The side of a box that lies at the low or the high end of an axis, facing inward. */
static sheet side_of(box b, int axis, bool high, float rho)
{
	const int u = (axis + 1) % 3, v = (axis + 2) % 3;
	sheet s = {.n = 1, .rho = rho};
	memcpy(s.corner, b.lower, sizeof s.corner);
	s.corner[axis] = high ? b.upper[axis] : b.lower[axis];
	s.u[u] = b.upper[u] - b.lower[u];
	s.v[v] = b.upper[v] - b.lower[v];
	return high ? turned_round(s) : s;
}

static void add_walls(sheets *s, box b, float rho)
{
	for (int side = 0; side < 6; side++)
		add(s, side_of(b, side >> 1, side & 1, rho));
}

/* Part of a sheet, in its plane: from (u0, v0) to (u1, v1) in shares of its sides. */
static sheet part_of(sheet s, float u0, float v0, float u1, float v1)
{
	sheet part = s;
	for (int c = 0; c < 3; c++) {
		part.corner[c] = s.corner[c] + u0 * s.u[c] + v0 * s.v[c];
		part.u[c] = (u1 - u0) * s.u[c];
		part.v[c] = (v1 - v0) * s.v[c];
	}
	return part;
}

/* ---- solving them ---- */

typedef enum way { OBJECTS, ONE_MESH } way;
static const char *const WAY_NAMES[] = {"objects", "one mesh"};

typedef struct place {
	const char *name;
	gi_pose pose;
} place;

static const place PLACES[] = {
    {"here", {{0, 0, 0}, {0, 0, 0, 1}}},
    {"turned, far off", {{310, -75, 140}, {.2f, -.5f, .3f, .7874f}}},
};

static void create(gi_context *gi, engine_mesh *mesh, const gi_material *materials, uint32_t count, uint32_t levels,
		   gi_pose pose)
{
	gi_object_def def = scene_mesh_def(mesh);
	def.face_materials = mesh->face_materials;
	def.materials = materials;
	def.material_count = count;
	def.levels = levels;
	def.pose = pose;
	gi_object object;
	if (gi_create_object(gi, &def, &object))
		fail_msg("gi_create_object: %s", harness_last_message());
	engine_mesh_free(mesh);
}

static gi_material material_of(const sheet *s)
{
	return (gi_material){.rho = {s->rho, s->rho, s->rho}, .exitance = {s->exitance, s->exitance, s->exitance}};
}

static void create_sheets(gi_context *gi, const sheets *s, way as, gi_pose pose)
{
	gi_material materials[MOST_SHEETS];
	engine_mesh all = {0};
	uint32_t faces = 0;
	for (uint32_t k = 0; k < s->count; k++) {
		const sheet *one = &s->list[k];
		engine_mesh mesh;
		materials[k] = material_of(one);
		assert_true(shape_quad(one->corner, one->u, one->v, one->n, one->n, &mesh));
		if (as == OBJECTS)
			create(gi, &mesh, &materials[k], 1, s->levels, pose);
		else
			assert_true(shape_append(&all, &mesh));
	}
	if (as == OBJECTS)
		return;
	all.face_materials = calloc(all.face_count, sizeof *all.face_materials);
	assert_non_null(all.face_materials);
	for (uint32_t k = 0; k < s->count; k++)
		for (uint32_t f = 0; f < s->list[k].n * s->list[k].n; f++)
			all.face_materials[faces++] = k;
	create(gi, &all, materials, s->count, s->levels, pose);
}

static snapshot solved(const sheets *s, way as, const place *at)
{
	gi_context *gi = open_context(.01f);
	create_sheets(gi, s, as, at->pose);
	assert_gi(gi_commit(gi));
	solve(gi);
	const snapshot result = snapshot_take(gi);
	expect_sane_rows(&result);
	gi_context_destroy(gi);
	return result;
}

/* ---- comparing ---- */

static double distance2(const gi_leaf *a, const gi_leaf *b)
{
	double sum = 0;
	for (int k = 0; k < 4; k++)
		for (int c = 0; c < 3; c++) {
			const double d = (double)a->corners[k][c] - b->corners[k][c];
			sum += d * d;
		}
	return sum;
}

static bool is_wall(const gi_leaf *l)
{
	return l->rho[0] == WALL;
}

/* Relative RMS difference of H over the walls' leaves, area-weighted, and of their mean. */
static void compare(const snapshot *right, const snapshot *got, double *rms, double *mean)
{
	double off = 0, all = 0, sum_right = 0, sum_got = 0;
	for (uint32_t k = 0; k < right->leaf_count; k++) {
		const gi_leaf *l = &right->leaves[k], *same = NULL;
		if (!is_wall(l))
			continue;
		for (uint32_t j = 0; j < got->leaf_count && !same; j++)
			if (is_wall(&got->leaves[j]) && distance2(l, &got->leaves[j]) < 1e-6)
				same = &got->leaves[j];
		assert_non_null(same);
		const double h = l->irradiance[0], d = same->irradiance[0] - h, area = l->area;
		off += area * d * d;
		all += area * h * h;
		sum_right += area * h;
		sum_got += area * same->irradiance[0];
	}
	*rms = sqrt(off / all);
	*mean = sum_got / sum_right - 1;
}

/* How far H may be off by surfaces that lie in one place, RMS over that of H; and a form factor. */
static const double TOLERANCE = .01;

/* The walls' H in `with` is theirs in `alone`. Objects here and one mesh far off; in a long run both in both places. */
static void expect_same_light(const char *what, const sheets *alone, const sheets *with)
{
	double worst = 0;
	for (size_t at = 0; at < sizeof PLACES / sizeof *PLACES; at++)
		for (way as = OBJECTS; as <= ONE_MESH; as++) {
			if ((size_t)as != at && !harness_is_long())
				continue;
			snapshot right = solved(alone, as, &PLACES[at]), got = solved(with, as, &PLACES[at]);
			double rms, mean;
			compare(&right, &got, &rms, &mean);
			printf("  %s, %s, %s: mean H %+.2f %%, leaves %.2f %% RMS\n", what, WAY_NAMES[as],
			       PLACES[at].name, 100 * mean, 100 * rms);
			worst = fmax(worst, fmax(rms, fabs(mean)));
			snapshot_free(&right);
			snapshot_free(&got);
		}
	if (!getenv("RELUME_PRINT") && !(worst <= TOLERANCE))
		fail_msg("%s: off by %.2f %%", what, 100 * worst);
}

/* ---- cases ---- */

static const box ROOM = {{-1, -1, -1}, {1, 1, 1}}, LOW_ROOM = {{0, .3f, -.7f}, {3.1f, 2, 1.4f}};

static sheet ceiling_of(box b)
{
	return side_of(b, 1, true, WALL);
}

static sheet lamp_below(box b)
{
	sheet lamp = like(part_of(ceiling_of(b), .35f, .3f, .65f, .7f), 0, 31.4f);
	lamp.corner[1] -= .2f * (b.upper[1] - b.lower[1]);
	return lamp;
}

static sheets lit_room(box b)
{
	sheets s = {.levels = 2};
	add_walls(&s, b, WALL);
	add(&s, lamp_below(b));
	return s;
}

static void rooms_that_share_a_plane(void **state)
{
	(void)state;
	const sheets alone = lit_room(ROOM);
	/* Of one size, and such as share only part of the plane. */
	const box next[] = {
	    {{1, -1, -1}, {3, 1, 1}}, {{1, -1, -.45f}, {2.2f, .3f, 1.8f}}, {{-.6f, -4, -.8f}, {.3f, -1, 1}}};
	for (size_t k = 0; k < sizeof next / sizeof *next; k++) {
		char what[64];
		snprintf(what, sizeof what, "next room %zu", k + 1);
		sheets with = alone;
		add_walls(&with, next[k], ADDED);
		expect_same_light(what, &alone, &with);
	}
}

static void faces_that_are_there_twice(void **state)
{
	(void)state;
	const sheets alone = lit_room(LOW_ROOM);
	sheets with = alone;
	for (uint32_t k = 0; k < alone.count; k++) {
		sheet copy = like(alone.list[k], k < 6 ? ADDED : alone.list[k].rho, alone.list[k].exitance);
		copy.n = 2; /* the same place, other faces */
		with = alone;
		add(&with, copy);
		char what[64];
		snprintf(what, sizeof what, k < 6 ? "wall %u twice" : "the lamp twice", k);
		expect_same_light(what, &alone, &with);
	}
}

static void plates_in_a_plane(void **state)
{
	(void)state;
	sheets alone = lit_room(ROOM);
	alone.levels = 3; /* leaves of a plate are smaller than those that it covers, and say more */
	const sheet plates[] = {part_of(side_of(ROOM, 1, false, ADDED), .1f, .2f, .8f, .55f),
				part_of(side_of(ROOM, 0, true, ADDED), .4f, .4f, .55f, .9f),
				part_of(side_of(ROOM, 1, true, ADDED), .05f, .05f, .95f, .95f)};
	sheets all = alone;
	for (size_t k = 0; k < sizeof plates / sizeof *plates; k++) {
		sheets with = alone;
		add(&with, plates[k]);
		add(&all, plates[k]);
		char what[64];
		snprintf(what, sizeof what, "plate %zu", k + 1);
		expect_same_light(what, &alone, &with);
		with.list[with.count - 1] = turned_round(plates[k]);
		snprintf(what, sizeof what, "plate %zu, facing the wall", k + 1);
		expect_same_light(what, &alone, &with);
	}
	expect_same_light("all plates", &alone, &all);
}

/* The same ceiling with a hole that the lamp fills. */
static sheets room_with_hole(box b)
{
	static const float cuts[4] = {0, .35f, .65f, 1};
	sheets s = {.levels = 2};
	add_walls(&s, b, WALL);
	const sheet ceiling = s.list[3];
	s.list[3] = like(part_of(ceiling, cuts[1], cuts[1], cuts[2], cuts[2]), 0, 31.4f);
	for (int k = 0; k < 9; k++)
		if (k != 4)
			add(&s, like(part_of(ceiling, cuts[k % 3], cuts[k / 3], cuts[k % 3 + 1], cuts[k / 3 + 1]),
				     ADDED, 0));
	return s;
}

static void lamp_in_the_ceiling(void **state)
{
	(void)state;
	const sheets right = room_with_hole(ROOM);
	for (int first = 0; first < 2; first++) {
		sheets with = {.levels = right.levels};
		const sheet ceiling = like(ceiling_of(ROOM), ADDED, 0);
		const sheet lamp = like(part_of(ceiling, .35f, .35f, .65f, .65f), 0, 31.4f);
		if (first)
			add(&with, lamp);
		add_walls(&with, ROOM, WALL);
		with.list[3 + first] = ceiling;
		if (!first)
			add(&with, lamp);
		expect_same_light(first ? "lamp in the ceiling, made before it" : "lamp in the ceiling", &right, &with);
	}
}

/* Path tracing meets the same of two surfaces. */
static double traced_mean(const sheets *s, way as)
{
	gi_context *gi = open_context(.1f);
	create_sheets(gi, s, as, PLACES[0].pose);
	assert_gi(gi_commit(gi));
	solve(gi);
	const snapshot rows = snapshot_take(gi);
	float *h = calloc(3 * (size_t)rows.leaf_count, sizeof *h);
	uint32_t count;
	assert_non_null(h);
	assert_gi(gi_trace_paths(gi, &(gi_path_options){.paths = 1024, .seed = 3}, h, rows.leaf_count, &count));
	double sum = 0, area = 0;
	for (uint32_t k = 0; k < count; k++)
		if (is_wall(&rows.leaves[k])) {
			sum += (double)rows.leaves[k].area * h[3 * k];
			area += rows.leaves[k].area;
		}
	free(h);
	snapshot_free((snapshot *)&rows);
	gi_context_destroy(gi);
	return sum / area;
}

static void paths_meet_the_same(void **state)
{
	(void)state;
	const sheets alone = lit_room(ROOM);
	sheets twice = alone, carpet = alone, black = alone;
	add(&twice, alone.list[6]);
	twice.list[7].n = 2;
	add(&carpet, part_of(side_of(ROOM, 1, false, ADDED), .1f, .2f, .8f, .55f));
	add(&black, like(turned_round(carpet.list[7]), 0, 0));
	const sheets *with[] = {&twice, &carpet, &black};
	for (way as = OBJECTS; as <= ONE_MESH; as++) {
		const double right = traced_mean(&alone, as);
		for (size_t k = 0; k < sizeof with / sizeof *with; k++) {
			const double mean = traced_mean(with[k], as);
			printf("  path tracing, %s, case %zu: mean H %+.2f %%\n", WAY_NAMES[as], k,
			       100 * (mean / right - 1));
			/* Of 96 leaves and 1,024 paths each: the noise is 0.2 %. */
			assert_true(fabs(mean / right - 1) <= TOLERANCE);
		}
	}
}

/* Two faces back to back are the two sides of a sheet; both are seen. */
static void sheets_of_two_faces(void **state)
{
	(void)state;
	sheets thin = lit_room(ROOM), thick;
	sheet upper = like(part_of(side_of(ROOM, 1, false, ADDED), .2f, .3f, .8f, .7f), .3f, 0);
	upper.corner[1] += .8f;
	thick = thin;
	add(&thin, upper);
	add(&thin, turned_round(upper));
	upper.corner[1] += 1e-3f;
	add(&thick, upper);
	upper.corner[1] -= 1e-3f;
	add(&thick, turned_round(upper));
	expect_same_light("a sheet of two faces", &thick, &thin);
}

/* ---- the same face twice in one object ---- */

/* Adds to the mesh each of its faces `copies` times more, their lists begun at one corner after the other; every other
 * copy on vertices of its own. */
static void repeat_faces(engine_mesh *mesh, uint32_t copies)
{
	engine_mesh once;
	assert_true(engine_mesh_copy(mesh, &once));
	for (uint32_t copy = 1; copy <= copies; copy++) {
		engine_mesh more;
		const uint32_t before = mesh->vertex_count;
		assert_true(engine_mesh_copy(&once, &more));
		for (uint32_t k = 0; k < more.index_count; k++)
			more.indices[k] = once.indices[4 * (k / 4) + (k + copy) % 4];
		assert_true(shape_append(mesh, &more));
		for (uint32_t k = mesh->index_count - once.index_count; k < mesh->index_count && copy % 2; k++)
			mesh->indices[k] -= before;
	}
	engine_mesh_free(&once);
}

/* Creates a box of n x n faces a side, each there `copies` times more, and returns how many leaves there are. */
static uint32_t leaves_of_copies(uint32_t n, uint32_t copies, gi_scheme scheme, bool double_sided, double *seconds)
{
	gi_context *gi = open_context(.1f);
	engine_mesh mesh;
	assert_true(shape_box((float[]){-1, -2, 0}, (float[]){1, 1, 3}, n, false, &mesh));
	const uint32_t once = mesh.face_count;
	repeat_faces(&mesh, copies);
	assert_int_equal(mesh.face_count, once * (copies + 1));
	struct timespec begin, end;
	timespec_get(&begin, TIME_UTC);
	harness_add(gi, &(harness_object){.name = "copies", .scheme = scheme, .double_sided = double_sided}, &mesh);
	timespec_get(&end, TIME_UTC);
	*seconds = (double)(end.tv_sec - begin.tv_sec) + 1e-9 * (double)(end.tv_nsec - begin.tv_nsec);
	char said[128];
	snprintf(said, sizeof said, "object 'copies': %u of its %u faces", once * copies, once * (copies + 1));
	if (copies)
		assert_non_null(strstr(harness_last_message(), said));
	else
		assert_string_equal(harness_last_message(), "");
	assert_gi(gi_commit(gi));
	uint32_t leaves;
	assert_gi(gi_read_leaves(gi, NULL, 0, &leaves));
	gi_context_destroy(gi);
	return leaves;
}

static void copies_within_an_object_are_dropped(void **state)
{
	(void)state;
	static const gi_scheme schemes[] = {GI_SCHEME_BILINEAR, GI_SCHEME_CATMULL_CLARK};
	double seconds;
	for (size_t k = 0; k < sizeof schemes / sizeof *schemes; k++)
		for (uint32_t copies = 0; copies < 4; copies++) {
			assert_int_equal(leaves_of_copies(2, copies, schemes[k], false, &seconds), 24);
			assert_int_equal(leaves_of_copies(2, copies, schemes[k], true, &seconds), 48);
		}
	for (uint32_t copies = 1000; copies <= 4000; copies *= 2) {
		assert_int_equal(leaves_of_copies(4, copies, GI_SCHEME_BILINEAR, false, &seconds), 96);
		printf("  96 faces, %u copies of each: %.3f s\n", copies, seconds);
	}
}

/* The first of two keeps its material; the other side of a sheet is no copy. */
static void the_first_of_two_faces_stays(void **state)
{
	(void)state;
	const float positions[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
	const uint32_t indices[] = {0, 1, 2, 3, 3, 2, 1, 0, 2, 3, 0, 1, 0, 3, 2, 1}, materials[] = {1, 0, 0, 1};
	const gi_material two[2] = {{.rho = {.1f, .1f, .1f}}, {.rho = {.2f, .2f, .2f}}};
	gi_context *gi = open_context(.1f);
	gi_object_def def = gi_object_def_default();
	def.positions = positions;
	def.vertex_count = 4;
	def.indices = indices;
	def.index_count = 16;
	def.face_count = 4;
	def.face_materials = materials;
	def.materials = two;
	def.material_count = 2;
	gi_object object;
	assert_gi(gi_create_object(gi, &def, &object));
	assert_gi(gi_commit(gi));
	harness_update(gi);
	gi_leaf leaves[4];
	uint32_t count;
	assert_gi(gi_read_leaves(gi, leaves, 4, &count));
	assert_int_equal(count, 2);
	for (int k = 0; k < 2; k++) {
		const float *a = leaves[k].corners[0], *b = leaves[k].corners[1], *c = leaves[k].corners[2];
		const bool up = (b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0]);
		assert_true(leaves[k].rho[0] == two[up ? 1 : 0].rho[0]);
	}
	gi_context_destroy(gi);
}

/* A floor of four leaves that is there twice, the copy with a size and a cut of its own, and a shelf that is cut in
 * two: what is said of faces by their numbers stays with them. */
static void sizes_and_cuts_stay_with_their_faces(void **state)
{
	(void)state;
	const float positions[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1};
	const uint32_t indices[] = {0, 1, 2, 3, 1, 2, 3, 0, 4, 5, 6, 7};
	const float sizes[] = {.5f, .1f, 1};
	const gi_leaf_cut cuts[] = {{1, {.3f, 0, 0}, {.3f, 1, 0}, false}, {2, {.3f, 0, 1}, {.3f, 1, 1}, true}};
	for (int sides = 1; sides <= 2; sides++) {
		gi_context *gi = open_context(.1f);
		gi_object_def def = gi_object_def_default();
		gi_object object;
		uint32_t leaves;
		def.positions = positions;
		def.vertex_count = 8;
		def.indices = indices;
		def.index_count = 12;
		def.face_count = 3;
		def.leaf_size = 1;
		def.leaf_sizes = sizes;
		def.leaf_cuts = cuts;
		def.leaf_cut_count = 2;
		def.double_sided = sides == 2;
		assert_gi(gi_create_object(gi, &def, &object));
		assert_gi(gi_commit(gi));
		assert_gi(gi_read_leaves(gi, NULL, 0, &leaves));
		printf("  %d sides: %u leaves\n", sides, leaves);
		assert_int_equal(leaves, 6 * sides);
		gi_context_destroy(gi);
	}
}

/* ---- moving into one place and out of it ---- */

enum { MOVERS = 4, RESTS = 4, FRAMES = 60 };

typedef struct moving {
	gi_context *gi;
	gi_object movers[MOVERS];
} moving;

static void open_moving(moving *m)
{
	m->gi = open_context(.03f);
	create_sheets(m->gi,
		      &(sheets){.list = {side_of(ROOM, 0, false, WALL), side_of(ROOM, 1, false, WALL),
					 side_of(ROOM, 2, false, WALL), side_of(ROOM, 0, true, WALL)},
				.count = 4,
				.levels = 2},
		      OBJECTS, gi_pose_identity());
	const float x[3] = {1, 0, 0}, z[3] = {0, 0, 1};
	const harness_object plate = {.name = "plate", .levels = 1, .rho = {.3f, .3f, .3f}},
			     lamp = {.name = "lamp", .levels = 1, .exitance = {9, 9, 9}};
	m->movers[0] = add_quad(m->gi, &plate, (float[]){-.5f, 0, -.5f}, z, x);
	m->movers[1] = add_quad(m->gi, &lamp, (float[]){-.4f, 0, -.5f}, z, x);
	m->movers[2] = add_block(m->gi, &plate, (box){{-.3f, 0, -.3f}, {.3f, .6f, .3f}});
	m->movers[3] = add_room(m->gi, &plate, (box){{-.5f, 0, -.5f}, {.5f, .5f, .5f}});
	assert_gi(gi_commit(m->gi));
}

static uint32_t draw(uint32_t *state, uint32_t below)
{
	*state = *state * 1664525u + 1013904223u;
	return (*state >> 8) % below;
}

/* On the floor, on one height above it, on a wall, or anywhere; in steps, so that movers meet. */
static gi_pose drawn_pose(uint32_t *state)
{
	gi_pose p = gi_pose_identity();
	p.position[0] = -.5f + .25f * (float)draw(state, 5);
	p.position[2] = -.5f + .25f * (float)draw(state, 5);
	switch (draw(state, RESTS)) {
	case 0:
		p.position[1] = -1;
		break;
	case 1:
		p.position[1] = -.4f;
		break;
	case 2: /* about z: what was level stands on the wall x = -1 */
		p.position[0] = -1;
		p.rotation[2] = -sqrtf(.5f);
		p.rotation[3] = sqrtf(.5f);
		break;
	default:
		p.position[1] = -.9f + .01f * (float)draw(state, 150);
		p.rotation[0] = .01f * (float)draw(state, 100);
	}
	return p;
}

static void compare_rows(moving *kept, moving *rebuilt, uint32_t frame)
{
	char when[32];
	snprintf(when, sizeof when, "frame %u", frame);
	gi_invalidate(rebuilt->gi);
	harness_update(kept->gi);
	harness_update(rebuilt->gi);
	snapshot a = snapshot_take(kept->gi), b = snapshot_take(rebuilt->gi);
	snapshot_expect_same_rows(&a, &b, when);
	snapshot_free(&a);
	snapshot_free(&b);
}

static void updated_rows_are_a_rebuilds(void **state)
{
	(void)state;
	moving kept, rebuilt;
	open_moving(&kept);
	open_moving(&rebuilt);
	uint32_t numbers = 20261126;
	for (uint32_t frame = 0; frame < FRAMES; frame++) {
		for (int k = 0; k < MOVERS; k++) {
			if (draw(&numbers, 2))
				continue;
			const gi_pose pose = drawn_pose(&numbers);
			assert_gi(gi_set_pose(kept.gi, kept.movers[k], pose));
			assert_gi(gi_set_pose(rebuilt.gi, rebuilt.movers[k], pose));
		}
		compare_rows(&kept, &rebuilt, frame);
	}
	gi_context_destroy(kept.gi);
	gi_context_destroy(rebuilt.gi);
}

/* ---- sheets of two sides that are bent ---- */

enum { SHADE_SIDES = 12 };

/* A lampshade open above and below; `warp` takes its corners out of the planes of its faces, metres. */
static gi_context *create_shade(double warp)
{
	float positions[2 * SHADE_SIDES][3];
	uint32_t indices[4 * SHADE_SIDES];
	for (uint32_t k = 0; k < SHADE_SIDES; k++) {
		const double angle = 6.283185307 * k / SHADE_SIDES, next = warp * sin(5.0 * k);
		for (uint32_t top = 0; top < 2; top++) {
			const double radius = (top ? .12 : .25) + (top ? next : -next);
			float *p = positions[2 * k + top];
			p[0] = (float)(radius * cos(angle));
			p[1] = (float)(.3 * top + warp * cos(3.0 * k));
			p[2] = (float)(radius * sin(angle));
		}
		const uint32_t n = (k + 1) % SHADE_SIDES, face[4] = {2 * k, 2 * k + 1, 2 * n + 1, 2 * n};
		memcpy(indices + 4 * k, face, sizeof face);
	}
	const gi_material cloth = {{.6f, .6f, .6f}, {0, 0, 0}};
	gi_object_def def = gi_object_def_default();
	def.name = "shade";
	def.positions = positions[0];
	def.vertex_count = 2 * SHADE_SIDES;
	def.indices = indices;
	def.index_count = 4 * SHADE_SIDES;
	def.face_count = SHADE_SIDES;
	def.levels = 2;
	def.double_sided = true;
	def.materials = &cloth;
	def.material_count = 1;
	gi_context_def context = harness_def();
	gi_context *gi = harness_context(&context);
	gi_object object;
	assert_gi(gi_create_object(gi, &def, &object));
	assert_gi(gi_commit(gi));
	harness_update(gi);
	return gi;
}

static void middle_and_normal(const gi_leaf *l, double middle[3], double normal[3])
{
	double u[3], v[3];
	for (int k = 0; k < 3; k++) {
		middle[k] = ((double)l->corners[0][k] + l->corners[1][k] + l->corners[2][k] + l->corners[3][k]) / 4;
		u[k] = (double)l->corners[2][k] - l->corners[0][k];
		v[k] = (double)l->corners[3][k] - l->corners[1][k];
	}
	for (int k = 0; k < 3; k++)
		normal[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
}

static bool are_back_to_back(const gi_leaf *a, const gi_leaf *b)
{
	double p[2][3], n[2][3], apart = 0, facing = 0;
	middle_and_normal(a, p[0], n[0]);
	middle_and_normal(b, p[1], n[1]);
	for (int k = 0; k < 3; k++) {
		apart += (p[0][k] - p[1][k]) * (p[0][k] - p[1][k]);
		facing += n[0][k] * n[1][k];
	}
	return facing < 0 && apart < 1e-10;
}

/* Largest sum of weights of a leaf on the outside, which sees nothing of the shade where that is not warped. */
static double most_seen_from_outside(const snapshot *s)
{
	double sum = 0, most = 0;
	for (uint64_t k = 0; k < s->link_count; k++) {
		double p[3], n[3];
		middle_and_normal(&s->leaves[s->links[k].leaf], p, n);
		if (k && s->links[k].leaf != s->links[k - 1].leaf)
			sum = 0;
		if (p[0] * n[0] + p[2] * n[2] > 0 && s->links[k].leaf_count)
			most = fmax(most, sum += (double)s->links[k].weight);
	}
	return most;
}

/* No leaf sees the one on its own back, however its faces are warped: what is in no plane has no height over it. */
static void bent_sheets_do_not_see_their_backs(void **state)
{
	(void)state;
	harness_require_context();
	static const double WARPS[4] = {0, 1e-6, 1e-3, 1e-2}, LIMITS[4] = {1e-3, 1e-3, .02, .2};
	for (int k = 0; k < 4; k++) {
		gi_context *gi = create_shade(WARPS[k]);
		snapshot s = snapshot_take(gi);
		uint32_t pairs = 0;
		double most = 0;
		for (uint32_t a = 0; a < s.leaf_count; a++)
			for (uint32_t b = 0; b < s.leaf_count; b++)
				pairs += are_back_to_back(&s.leaves[a], &s.leaves[b]);
		assert_int_equal(pairs, s.leaf_count);
		for (uint64_t l = 0; l < s.link_count; l++)
			if (s.links[l].leaf_count == 1 &&
			    are_back_to_back(&s.leaves[s.links[l].leaf], &s.leaves[s.links[l].first_leaf]))
				most = fmax(most, (double)s.links[l].weight);
		const double outside = most_seen_from_outside(&s);
		printf("warp %d: the back of a leaf has a weight of %.3f at most, all of the shade from outside %.3f\n",
		       k, most, outside);
		assert_true(most < 1e-3);
		assert_true(outside < LIMITS[k]);
		snapshot_free(&s);
		gi_context_destroy(gi);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(rooms_that_share_a_plane),
	    cmocka_unit_test(faces_that_are_there_twice),
	    cmocka_unit_test(plates_in_a_plane),
	    cmocka_unit_test(lamp_in_the_ceiling),
	    cmocka_unit_test(paths_meet_the_same),
	    cmocka_unit_test(sheets_of_two_faces),
	    cmocka_unit_test(copies_within_an_object_are_dropped),
	    cmocka_unit_test(the_first_of_two_faces_stays),
	    cmocka_unit_test(sizes_and_cuts_stay_with_their_faces),
	    cmocka_unit_test(updated_rows_are_a_rebuilds),
	    cmocka_unit_test(bent_sheets_do_not_see_their_backs),
	};
	return cmocka_run_group_tests(tests, harness_open, harness_close);
}
