#include "host_room.h"

#include <glad/gl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

const host_wall host_walls[HOST_WALLS] = {
    {"floor", {-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, {.rho = {.7f, .7f, .7f}}},
    {"ceiling", {-2, 3, -2}, {4, 0, 0}, {0, 0, 4}, {.rho = {.7f, .7f, .7f}}},
    {"back", {-2, 0, -2}, {4, 0, 0}, {0, 3, 0}, {.rho = {.7f, .7f, .7f}}},
    {"left", {-2, 0, -2}, {0, 3, 0}, {0, 0, 4}, {.rho = {.6f, .1f, .1f}}},
    {"right", {2, 0, -2}, {0, 0, 4}, {0, 3, 0}, {.rho = {.1f, .5f, .1f}}},
    {"lamp", {-.5f, 2.99f, -.5f}, {1, 0, 0}, {0, 0, 1}, {.exitance = {25, 22, 18}}},
};
const gi_material host_ball_material = {.rho = {.8f, .8f, .8f}};

/* From 6 m before the room. */
#define NEAR 0.1f
#define FAR 50.0f
#define SCALE 2.5f
const float host_view_from_world[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1.5f, -6, 1};
const float host_clip_from_view[16] = {
    SCALE * HOST_HEIGHT / HOST_WIDTH, 0, 0, 0, 0, SCALE, 0, 0, 0, 0, -(FAR + NEAR) / (FAR - NEAR), -1, 0, 0,
    -2 * FAR *NEAR / (FAR - NEAR),    0};

static void check(gi_result result)
{
	if (result)
		exit(EXIT_FAILURE); /* what was wrong went to stderr */
}

static double now_ms(void)
{
	struct timespec t;
	timespec_get(&t, TIME_UTC);
	return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

/* ---- what an engine remembers of OpenGL ---- */

/* Engines leave out what they think is bound. Of what the library leaves changed (gi.h, Rules) these two remember
 * programs and vertex arrays; the framebuffer is host_room_draw's doing. */
typedef struct engine_state {
	GLint program, array, draw, read, viewport[4];
} engine_state;

static engine_state keep_state(void)
{
	engine_state s;
	glGetIntegerv(GL_CURRENT_PROGRAM, &s.program);
	glGetIntegerv(GL_VERTEX_ARRAY_BINDING, &s.array);
	glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &s.draw);
	glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &s.read);
	glGetIntegerv(GL_VIEWPORT, s.viewport);
	return s;
}

static void give_back(const engine_state *s)
{
	glUseProgram((GLuint)s->program);
	glBindVertexArray((GLuint)s->array);
	glBindFramebuffer(GL_DRAW_FRAMEBUFFER, (GLuint)s->draw);
	glBindFramebuffer(GL_READ_FRAMEBUFFER, (GLuint)s->read);
	glViewport(s->viewport[0], s->viewport[1], s->viewport[2], s->viewport[3]);
}

/* ---- the library's side ---- */

static gi_object add_wall(gi_context *gi, const host_wall *wall)
{
	static const uint32_t indices[4] = {0, 1, 2, 3};
	float corners[12];
	gi_object object;
	gi_object_def def = gi_object_def_default();
	for (int k = 0; k < 3; k++) {
		corners[k] = wall->corner[k];
		corners[3 + k] = wall->corner[k] + wall->u[k];
		corners[6 + k] = wall->corner[k] + wall->u[k] + wall->v[k];
		corners[9 + k] = wall->corner[k] + wall->v[k];
	}
	def.name = wall->name;
	def.positions = corners;
	def.vertex_count = def.index_count = 4;
	def.indices = indices;
	def.face_count = 1;
	def.leaf_size = .15f;
	def.materials = &wall->material;
	def.material_count = 1;
	check(gi_create_object(gi, &def, &object));
	return object;
}

/* A cube that Catmull and Clark's rules round to the ball, to 2 % of its radius. */
static gi_object add_ball(gi_context *gi, float scale)
{
	static const uint32_t indices[24] = {0, 4, 6, 2, 1, 3, 7, 5, 0, 1, 5, 4, 2, 6, 7, 3, 0, 2, 3, 1, 4, 5, 7, 6};
	const float half = 1.18f * HOST_BALL_RADIUS / scale;
	float corners[24];
	gi_object object;
	gi_object_def def = gi_object_def_default();
	for (int k = 0; k < 24; k++)
		corners[k] = (k / 3) >> (k % 3) & 1 ? half : -half;
	def.name = "ball";
	def.positions = corners;
	def.vertex_count = 8;
	def.indices = indices;
	def.index_count = 24;
	def.face_count = 6;
	def.scheme = GI_SCHEME_CATMULL_CLARK;
	def.levels = 3;
	def.materials = &host_ball_material;
	def.material_count = 1;
	def.mobility = GI_MOBILITY_MOVABLE;
	for (int k = 0; k < 3; k++)
		def.scale[k] = scale;
	check(gi_create_object(gi, &def, &object));
	return object;
}

static uint32_t make_framebuffer(void)
{
	GLuint framebuffer, parts[2];
	glCreateRenderbuffers(2, parts);
	glNamedRenderbufferStorage(parts[0], GL_RGBA32F, HOST_WIDTH, HOST_HEIGHT);
	glNamedRenderbufferStorage(parts[1], GL_DEPTH_COMPONENT32F, HOST_WIDTH, HOST_HEIGHT);
	glCreateFramebuffers(1, &framebuffer);
	glNamedFramebufferRenderbuffer(framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, parts[0]);
	glNamedFramebufferRenderbuffer(framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, parts[1]);
	return framebuffer;
}

typedef struct loader {
	gi_get_proc_address_fn *find;
	void *user;
} loader;

static GLADapiproc find_for_glad(void *user, const char *name)
{
	const loader *l = user;
	return l->find(name, l->user);
}

void host_room_open(host_room *room, gi_get_proc_address_fn *find, void *user, float ball_scale)
{
	gi_context_def def = gi_context_def_default();
	*room = (host_room){0};
	if (!gladLoadGLUserPtr(find_for_glad, &(loader){find, user}))
		exit(EXIT_FAILURE);
	def.get_proc_address = find;
	def.get_proc_user = user;
	def.pixel_lamps = 0; /* these hosts have no lamps of their own */
	check(gi_context_create(&def, &room->gi));
	for (int k = 0; k < HOST_WALLS; k++)
		room->objects[k] = add_wall(room->gi, &host_walls[k]);
	room->objects[HOST_BALL] = add_ball(room->gi, ball_scale);
	check(gi_commit(room->gi));
	room->framebuffer = make_framebuffer();
	room->host_framebuffer = make_framebuffer();
}

void host_room_close(host_room *room)
{
	gi_context_destroy(room->gi);
	glDeleteFramebuffers(2, (const GLuint[]){room->framebuffer, room->host_framebuffer});
}

void host_room_map(const host_room *room, int surface, const float *positions, const float *normals, uint32_t count,
		   gi_vertex_light *out)
{
	check(gi_map_vertices(room->gi, room->objects[surface], positions, normals, count, out));
}

void host_room_move(host_room *room, float along, float place[3])
{
	const gi_pose pose = {{2 * along - 1, .7f, 0}, {0, 0, 0, 1}};
	const uint32_t layout = room->buffers.layout;
	const double began = now_ms();
	const engine_state state = keep_state();
	memcpy(place, pose.position, sizeof pose.position);
	check(gi_set_pose(room->gi, room->objects[HOST_BALL], pose));
	check(gi_update(room->gi, NULL));
	check(gi_finish(room->gi)); /* for the time alone */
	if (layout) {
		room->update_ms += now_ms() - began;
		room->updates++;
	}
	check(gi_get_buffers(room->gi, &room->buffers));
	for (int k = 0; k < HOST_SURFACES && room->buffers.layout != layout; k++)
		check(gi_get_object_range(room->gi, room->objects[k], &room->ranges[k]));
	give_back(&state);
}

static void bind(GLuint framebuffer)
{
	glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
	glViewport(0, 0, HOST_WIDTH, HOST_HEIGHT);
}

void host_room_bind(const host_room *room)
{
	bind(room->host_framebuffer);
}

static void read_picture(GLuint framebuffer, float *picture)
{
	glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
	glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
	glPixelStorei(GL_PACK_ALIGNMENT, 4);
	glReadPixels(0, 0, HOST_WIDTH, HOST_HEIGHT, GL_RGBA, GL_FLOAT, picture);
}

void host_room_read(const host_room *room, float *picture)
{
	read_picture(room->host_framebuffer, picture);
}

void host_room_draw(host_room *room, float *picture)
{
	gi_view view = gi_view_default();
	view.width = HOST_WIDTH;
	view.height = HOST_HEIGHT;
	memcpy(view.view_from_world, host_view_from_world, sizeof view.view_from_world);
	memcpy(view.clip_from_view, host_clip_from_view, sizeof view.clip_from_view);
	glClearNamedFramebufferfv(room->framebuffer, GL_COLOR, 0, (const float[]){0, 0, 0, 1});
	glClearNamedFramebufferfv(room->framebuffer, GL_DEPTH, 0, (const float[]){1});
	const engine_state state = keep_state();
	bind(room->framebuffer);
	check(gi_draw(room->gi, &view));
	read_picture(room->framebuffer, picture);
	give_back(&state);
}
