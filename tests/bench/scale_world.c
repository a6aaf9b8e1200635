#include "scale_world.h"

#include "bench_scene.h"
#include "scenes/body.h"
#include "scenes/shapes.h"

#include <math.h>
#include <stdlib.h>

static const float PITCH = 1.5f; /* between a hall's boxes, metres */
static const float HALL_HEIGHT = 3, ROOM_HEIGHT = 2.7f;
static const float ROOM_PITCH = 4.2f, STREET_HALF = 1.5f, ROOM_FRONT = 1.7f, ROOM_BACK = 6.7f;
static const float ONE_FACE = 1e9f; /* wider than any */
static const float DOOR_LEFT = 1.6f, DOOR_RIGHT = 2.5f, DOOR_HEIGHT = 2.05f;
static const float WOOD[3] = {.5f, .35f, .2f}, PLASTER[3] = {.7f, .68f, .64f}, CLOTH[3] = {.25f, .3f, .55f};

/* A number in [0,1) of two: the same whatever else there is. */
static float random_of(uint32_t a, uint32_t b)
{
	uint32_t h = a * 0x9e3779b9u ^ (b + 0x7f4a7c15u) * 0x85ebca6bu;
	h = (h ^ h >> 16) * 0x7feb352du;
	h = (h ^ h >> 15) * 0x846ca68bu;
	return (float)((h ^ h >> 16) >> 8) * (1.0f / 16777216.0f);
}

static void need(bool done)
{
	if (!done)
		fail("out of memory");
}

typedef enum stays { STAYS, MOVES } stays;

/* Faces are split to leaves of that size; 0: one leaf a face. */
static gi_object add_split_mesh(scale_world *w, const char *name, stays s, engine_mesh *mesh, float leaf_size,
				const float rho[3], float exitance, gi_pose pose)
{
	const gi_material material = {.rho = {rho[0], rho[1], rho[2]},
				      .exitance = {exitance, exitance, .9f * exitance}};
	gi_object_def def = scene_mesh_def(mesh);
	def.name = name;
	def.materials = &material;
	def.material_count = 1;
	def.pose = pose;
	def.leaf_size = leaf_size;
	def.mobility = w->settings.fixed && s == STAYS ? GI_MOBILITY_STATIC : GI_MOBILITY_MOVABLE;
	gi_object object;
	check(gi_create_object(w->gi, &def, &object));
	engine_mesh_free(mesh);
	w->objects++;
	return object;
}

/* One leaf a face. */
static gi_object add_mesh(scale_world *w, const char *name, stays s, engine_mesh *mesh, const float rho[3],
			  float exitance, gi_pose pose)
{
	return add_split_mesh(w, name, s, mesh, 0, rho, exitance, pose);
}

/* ---- a hall ---- */

static uint32_t hall_columns(uint32_t boxes)
{
	return (uint32_t)ceil(sqrt((double)boxes + 1)); /* room for the one that comes */
}

/* Boxes that the hall has room for. */
static uint32_t hall_room(const scale_world *w)
{
	return w->settings.room ? w->settings.room : w->settings.objects;
}

static gi_pose box_pose(const scale_world *w, uint32_t number, float shift)
{
	const uint32_t columns = hall_columns(hall_room(w)), place = number * (hall_room(w) / w->settings.objects),
		       i = place % columns, j = place / columns;
	const float turn = 1.5f * random_of(number, 5);
	return (gi_pose){{PITCH * ((float)i + .3f + .4f * random_of(number, 1)) + shift, .01f,
			  PITCH * ((float)j + .3f + .4f * random_of(number, 2))},
			 {0, sinf(turn), 0, cosf(turn)}};
}

static gi_object add_box(scale_world *w, uint32_t number, stays s)
{
	engine_mesh mesh;
	const float half = .15f + .15f * random_of(number, 3), high = .3f + 1.2f * random_of(number, 4);
	const uint32_t cells = s == MOVES && w->settings.mover_cells ? w->settings.mover_cells : w->settings.cells;
	need(shape_box((float[]){-half, 0, -half}, (float[]){half, high, half}, cells, false, &mesh));
	const float rho[3] = {.7f, .6f, .3f + .4f * random_of(number, 6)};
	return add_mesh(w, "box", s, &mesh, rho, 0, box_pose(w, number, 0));
}

/* Ten of a hall's boxes move, evenly spread. */
static uint32_t hall_mover(const scale_world *w, uint32_t k)
{
	const uint32_t boxes = w->settings.objects;
	return (boxes / 2 + k * (boxes / 10 + 1)) % boxes;
}

static stays how_it_stays(const scale_world *w, uint32_t number)
{
	for (uint32_t k = 0; k < 10; k++)
		if (hall_mover(w, k) == number)
			return MOVES;
	return STAYS;
}

static void build_hall(scale_world *w)
{
	engine_mesh mesh;
	const float side = PITCH * (float)hall_columns(hall_room(w)), middle = .5f * side, half = .1f * side;
	const uint32_t cells = (uint32_t)fmaxf(4, roundf(side / w->settings.cell));
	need(shape_box((float[]){0, 0, 0}, (float[]){side, HALL_HEIGHT, side}, cells < 64 ? cells : 64, true, &mesh));
	add_mesh(w, "hall", STAYS, &mesh, PLASTER, 0, gi_pose_identity());
	need(shape_quad((float[]){middle - half, HALL_HEIGHT - .05f, middle - half}, (float[]){2 * half, 0, 0},
			(float[]){0, 0, 2 * half}, 2, 2, &mesh));
	add_mesh(w, "lamp", STAYS, &mesh, (float[]){0, 0, 0}, 10, gi_pose_identity());
	w->places = w->settings.objects;
	w->movers = calloc(w->places, sizeof *w->movers);
	need(w->movers != NULL);
	for (uint32_t k = 0; k < w->places; k++)
		w->movers[k] = add_box(w, k, how_it_stays(w, k));
}

/* ---- a street ---- */

/* Room k's frame: x along the street, z away from its middle line; every second room is on the other side. */
static gi_pose in_room(uint32_t k, float x, float y, float z, float turn)
{
	const float start = ROOM_PITCH * (float)(k / 2);
	if (k % 2 == 0)
		return (gi_pose){{start + x, y, z}, {0, sinf(.5f * turn), 0, cosf(.5f * turn)}};
	turn += 3.14159265f;
	return (gi_pose){{start + ROOM_PITCH - x, y, -z}, {0, sinf(.5f * turn), 0, cosf(.5f * turn)}};
}

typedef struct sheet {
	float corner[3], u[3], v[3];
} sheet;

/* Inside and the half of the street before it, with an opening between; backs are black. */
static void add_shell(scale_world *w, uint32_t k)
{
	const float l = DOOR_LEFT, r = DOOR_RIGHT, d = DOOR_HEIGHT, h = ROOM_HEIGHT, s = STREET_HALF, f = ROOM_FRONT,
		    p = ROOM_PITCH, wide = r - l, deep = ROOM_BACK - f, thick = f - s, in = .1f, out = p - in;
	const sheet sheets[] = {
	    {{0, 0, 0}, {0, 0, s}, {p, 0, 0}}, /* street: floor, ceiling, wall */
	    {{0, h, 0}, {p, 0, 0}, {0, 0, s}},
	    {{0, 0, s}, {0, h, 0}, {l, 0, 0}},
	    {{r, 0, s}, {0, h, 0}, {p - r, 0, 0}},
	    {{l, d, s}, {0, h - d, 0}, {wide, 0, 0}},
	    {{l, 0, s}, {0, 0, thick}, {wide, 0, 0}}, /* doorway */
	    {{l, d, s}, {wide, 0, 0}, {0, 0, thick}},
	    {{l, 0, s}, {0, d, 0}, {0, 0, thick}},
	    {{r, 0, s}, {0, 0, thick}, {0, d, 0}},
	    {{in, 0, f}, {l - in, 0, 0}, {0, h, 0}}, /* room: front wall, floor, ceiling, the others */
	    {{r, 0, f}, {out - r, 0, 0}, {0, h, 0}},
	    {{l, d, f}, {wide, 0, 0}, {0, h - d, 0}},
	    {{in, 0, f}, {0, 0, deep}, {out - in, 0, 0}},
	    {{in, h, f}, {out - in, 0, 0}, {0, 0, deep}},
	    {{in, 0, f}, {0, h, 0}, {0, 0, deep}},
	    {{out, 0, f}, {0, 0, deep}, {0, h, 0}},
	    {{in, 0, ROOM_BACK}, {0, h, 0}, {out - in, 0, 0}},
	};
	engine_mesh mesh = {0};
	for (size_t n = 0; n < sizeof sheets / sizeof *sheets; n++)
		need(shape_append_quad(&mesh, sheets[n].corner, sheets[n].u, sheets[n].v, ONE_FACE));
	add_split_mesh(w, "room", STAYS, &mesh, w->settings.cell, PLASTER, 0, in_room(k, 0, 0, 0, 0));
}

typedef struct slab {
	float lower[3], upper[3];
} slab;

static engine_mesh slabs(const scale_world *w, const slab *parts, size_t count)
{
	engine_mesh mesh = {0}, part;
	for (size_t n = 0; n < count; n++) {
		need(shape_box(parts[n].lower, parts[n].upper, w->settings.cells, false, &part));
		need(shape_append(&mesh, &part));
	}
	return mesh;
}

static gi_object add_chair(scale_world *w, stays s, gi_pose pose)
{
	static const slab parts[] = {{{-.22f, .42f, -.22f}, {.22f, .46f, .22f}},
				     {{-.22f, .47f, .18f}, {.22f, .95f, .22f}},
				     {{-.22f, .01f, -.2f}, {-.18f, .41f, .2f}},
				     {{.18f, .01f, -.2f}, {.22f, .41f, .2f}}};
	engine_mesh mesh = slabs(w, parts, sizeof parts / sizeof *parts);
	return add_mesh(w, "chair", s, &mesh, CLOTH, 0, pose);
}

static void add_table(scale_world *w, gi_pose pose)
{
	static const slab parts[] = {{{-.7f, .7f, -.45f}, {.7f, .75f, .45f}},
				     {{-.65f, .01f, -.4f}, {-.6f, .69f, .4f}},
				     {{.6f, .01f, -.4f}, {.65f, .69f, .4f}}};
	engine_mesh mesh = slabs(w, parts, sizeof parts / sizeof *parts);
	add_mesh(w, "table", STAYS, &mesh, WOOD, 0, pose);
}

static gi_object add_shelf(scale_world *w, gi_pose pose)
{
	static const slab parts[] = {
	    {{-.6f, .01f, -.15f}, {-.57f, 1.8f, .15f}},  {{.57f, .01f, -.15f}, {.6f, 1.8f, .15f}},
	    {{-.56f, .1f, -.15f}, {.56f, .13f, .13f}},   {{-.56f, .7f, -.15f}, {.56f, .73f, .13f}},
	    {{-.56f, 1.3f, -.15f}, {.56f, 1.33f, .13f}}, {{-.56f, .01f, .14f}, {.56f, 1.8f, .15f}}};
	engine_mesh mesh = slabs(w, parts, sizeof parts / sizeof *parts);
	return add_mesh(w, "shelf", STAYS, &mesh, WOOD, 0, pose);
}

/* Two balls, the lower one stretched to a body. */
static gi_object add_figure(scale_world *w, gi_pose pose)
{
	engine_mesh body, head;
	need(shape_sphere(1, 1 + w->settings.cells, &body));
	need(shape_sphere(.12f, 1 + w->settings.cells, &head));
	for (uint32_t n = 0; n < body.vertex_count; n++) {
		body.positions[3 * n] *= .24f;
		body.positions[3 * n + 1] = .75f + .72f * body.positions[3 * n + 1];
		body.positions[3 * n + 2] *= .16f;
	}
	for (uint32_t n = 0; n < head.vertex_count; n++)
		head.positions[3 * n + 1] += 1.62f;
	need(shape_append(&body, &head));
	return add_mesh(w, "figure", MOVES, &body, CLOTH, 0, pose);
}

static gi_pose figure_pose(uint32_t k, float shift)
{
	return in_room(k, 3.3f, .01f, 3 + shift, .5f);
}

static gi_pose door_pose(uint32_t k, float turn)
{
	return in_room(k, DOOR_LEFT + .03f, .01f, ROOM_FRONT + .03f, -turn);
}

static void add_room(scale_world *w, uint32_t k)
{
	engine_mesh mesh;
	add_shell(w, k);
	need(shape_quad((float[]){-.4f, 0, -.4f}, (float[]){.8f, 0, 0}, (float[]){0, 0, .8f}, 2, 2, &mesh));
	add_mesh(w, "lamp", STAYS, &mesh, (float[]){0, 0, 0}, 30, in_room(k, 2.1f, ROOM_HEIGHT - .03f, 4.2f, 0));
	const slab leaf = {{0, 0, 0}, {.85f, 2.02f, .04f}};
	mesh = slabs(w, &leaf, 1);
	w->doors[k] = add_mesh(w, "door", MOVES, &mesh, WOOD, 0, door_pose(k, 1));
	add_table(w, in_room(k, 1.6f, 0, 4.4f, 0));
	for (uint32_t n = 0; n < 4; n++) {
		const float turn = n % 2 ? .2f : 3.2f, x = 1.3f + (n / 2 ? .6f : 0), z = n % 2 ? 5.1f : 3.7f;
		const gi_object chair = add_chair(w, STAYS, in_room(k, x, 0, z, turn + .4f * random_of(k, n)));
		if (n == 0)
			w->others[k] = chair;
	}
	add_shelf(w, in_room(k, 2.6f, 0, ROOM_BACK - .2f, 0));
	w->movers[k] = add_figure(w, figure_pose(k, 0));
}

/* The street's two ends, and what stands in for the room that the last one lacks opposite. */
static void add_ends(scale_world *w)
{
	const bool odd = w->places % 2;
	const float length = ROOM_PITCH * (float)((w->places + 1) / 2), h = ROOM_HEIGHT,
		    first = w->places > 1 ? -STREET_HALF : 0, last = odd ? 0 : -STREET_HALF, step = length - ROOM_PITCH;
	const sheet sheets[] = {
	    {{0, 0, first}, {0, h, 0}, {0, 0, STREET_HALF - first}},
	    {{length, 0, last}, {0, 0, STREET_HALF - last}, {0, h, 0}},
	    {{step, 0, 0}, {ROOM_PITCH, 0, 0}, {0, h, 0}},
	    {{step, 0, -STREET_HALF}, {0, 0, STREET_HALF}, {0, h, 0}},
	};
	engine_mesh mesh = {0};
	for (uint32_t n = 0; n < (odd ? w->places > 1 ? 4u : 3u : 2u); n++)
		need(shape_append_quad(&mesh, sheets[n].corner, sheets[n].u, sheets[n].v, ONE_FACE));
	add_split_mesh(w, "ends", STAYS, &mesh, w->settings.cell, PLASTER, 0, gi_pose_identity());
}

static void build_street(scale_world *w)
{
	w->places = w->settings.objects < 20 ? 1 : w->settings.objects / 10;
	w->movers = calloc(w->places, sizeof *w->movers);
	w->doors = calloc(w->places, sizeof *w->doors);
	w->others = calloc(w->places, sizeof *w->others);
	need(w->movers && w->doors && w->others);
	for (uint32_t k = 0; k < w->places; k++)
		add_room(w, k);
	add_ends(w);
}

/* ---- what the benchmark does ---- */

const char *scale_kind_name(scale_kind kind)
{
	static const char *const names[SCALE_KINDS] = {"hall", "street"};
	return names[kind];
}

void scale_world_build(scale_world *w, gi_context *gi, const scale_settings *settings)
{
	*w = (scale_world){.gi = gi, .settings = *settings};
	if (settings->kind == SCALE_HALL)
		build_hall(w);
	else
		build_street(w);
}

void scale_world_free(scale_world *w)
{
	free(w->movers);
	free(w->doors);
	free(w->others);
	*w = (scale_world){0};
}

static uint32_t middle(const scale_world *w)
{
	return w->places / 2;
}

void scale_world_move(scale_world *w, uint32_t k, uint32_t round)
{
	const float shift = .02f * (float)(round % 5 + 1);
	const bool hall = w->settings.kind == SCALE_HALL;
	const uint32_t place = hall ? hall_mover(w, k) : (middle(w) + k * (w->places / 10 + 1)) % w->places;
	check(gi_set_pose(w->gi, w->movers[place], hall ? box_pose(w, place, shift) : figure_pose(place, shift)));
}

void scale_world_move_staying(scale_world *w, uint32_t round)
{
	uint32_t place = (w->places / 3 + round) % w->places;
	while (how_it_stays(w, place) == MOVES)
		place = (place + 1) % w->places;
	check(gi_set_pose(w->gi, w->movers[place], box_pose(w, place, .02f)));
}

void scale_world_turn_door(scale_world *w, uint32_t round)
{
	check(gi_set_pose(w->gi, w->doors[middle(w)], door_pose(middle(w), 1 + .05f * (float)(round % 5 + 1))));
}

void scale_world_paint(scale_world *w, uint32_t round)
{
	const float rho = .3f + .05f * (float)(round % 7);
	const gi_object object = w->others ? w->others[middle(w)] : w->movers[middle(w)];
	check(gi_set_material(w->gi, object, 0, (gi_material){.rho = {rho, rho, rho}}));
}

void scale_world_add(scale_world *w, bool staying)
{
	const stays s = staying ? STAYS : MOVES;
	w->guest = w->settings.kind == SCALE_HALL ? add_box(w, w->settings.objects, s)
						  : add_chair(w, s, in_room(middle(w), 3.4f, 0, 5.6f, .8f));
}

void scale_world_light_guest(scale_world *w)
{
	check(gi_set_material(w->gi, w->guest, 0, (gi_material){.rho = {.5f, .5f, .5f}, .exitance = {1, 1, 1}}));
}

void scale_world_remove(scale_world *w)
{
	check(gi_destroy_object(w->gi, w->guest));
	w->objects--;
}
