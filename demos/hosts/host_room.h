/* What the hosts of this folder show: a room that is open to the front, a lamp below its ceiling, a ball that moves.
 * Here is the library's side of it, and what a host's picture is compared with; meshes, shaders and pictures are the
 * hosts'.
 */
#ifndef HOST_ROOM_H
#define HOST_ROOM_H

#include <gi/gi.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { HOST_WIDTH = 480, HOST_HEIGHT = 360, HOST_PIXELS = HOST_WIDTH * HOST_HEIGHT };
enum { HOST_WALLS = 6, HOST_BALL = HOST_WALLS, HOST_SURFACES };
#define HOST_BALL_RADIUS 0.4f

/* Rectangles, seen from where u turns counter-clockwise into v. */
typedef struct host_wall {
	const char *name;
	float corner[3], u[3], v[3]; /* metres */
	gi_material material;
} host_wall;
extern const host_wall host_walls[HOST_WALLS];
extern const gi_material host_ball_material;
extern const float host_view_from_world[16], host_clip_from_view[16];

typedef struct host_room {
	gi_context *gi;
	gi_object objects[HOST_SURFACES]; /* walls, then the ball */
	gi_object_range ranges[HOST_SURFACES];
	gi_buffers buffers;
	uint32_t framebuffer, host_framebuffer; /* of gi_draw, and for the host: RGBA32F, with depth */
	double update_ms;                       /* of all updates after the first */
	uint32_t updates;
} host_room;

/* ball_scale: the host's ball has this many metres a unit. Ends the program where something fails. */
void host_room_open(host_room *room, gi_get_proc_address_fn *find, void *user, float ball_scale);
void host_room_close(host_room *room);
/* What vertices of the host's mesh take of the light. */
void host_room_map(const host_room *room, int surface, const float *positions, const float *normals, uint32_t count,
		   gi_vertex_light *out);
/* Moves the ball, along: 0..1, and brings light, buffers and ranges up to date. Its middle goes to `place`. */
void host_room_move(host_room *room, float along, float place[3]);
/* The host's framebuffer, to draw into it and to read rgba radiance from it, bottom row first. */
void host_room_bind(const host_room *room);
void host_room_read(const host_room *room, float *picture);
/* The same picture by gi_draw. */
void host_room_draw(host_room *room, float *picture);

/* Of a host's and the library's pictures with the ball at 0 and at 1: whether the floor in the ball's shadow at 0 has
 * the light of gi_draw within 5 % both times, and changes as much within 5 %. Prints what it found and ms a frame;
 * writes PREFIX_host_0.png and so on. */
bool host_room_judge(const host_room *room, const char *prefix, float *const host[2], float *const gi[2],
		     double host_ms);

#ifdef __cplusplus
}
#endif

#endif
