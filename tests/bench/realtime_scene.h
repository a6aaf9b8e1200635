/* A trace_scene where shaders find it: what stays as one mesh with one tree, each mover as another; vertices for the
 * rasteriser. */
#ifndef TESTS_BENCH_REALTIME_SCENE_H
#define TESTS_BENCH_REALTIME_SCENE_H

#include "gl.h"
#include "trace_scene.h"

enum { REALTIME_MOST_INSTANCES = 8, REALTIME_MOST_OBJECTS = 16, REALTIME_MOST_LIGHTS = 16 };

/* As shaders/realtime.glsl has them, std140. */
typedef struct realtime_instance {
	mat4 object_from_world, world_from_object;
	uint32_t range[4];
} realtime_instance;

typedef struct realtime_object {
	float rho[4], exitance[4], reflectance[4], transmittance[4];
	mat4 before_from_now;
} realtime_object;

typedef struct realtime_light {
	float origin[4], u[4], v[4], exitance[4];
} realtime_light;

typedef struct realtime_camera {
	float eye[4], forward[4], right[4], up[4];
} realtime_camera;

typedef struct realtime_block {
	realtime_instance instances[REALTIME_MOST_INSTANCES];
	realtime_object objects[REALTIME_MOST_OBJECTS];
	realtime_light lights[REALTIME_MOST_LIGHTS];
	realtime_camera camera, camera_before;
	uint32_t counts[4], flags[4];
	float settings[4], edges[4];
} realtime_block;

typedef struct realtime_scene {
	const trace_scene *scene;
	realtime_block block;                    /* cameras, flags and settings are the caller's */
	uint32_t mover[REALTIME_MOST_INSTANCES]; /* the object whose pose an instance has; instance 0 stays */
	uint32_t index_first[REALTIME_MOST_INSTANCES + 1];
	GLuint vertices, indices, vertex_array;
	GLuint buffers[3], textures[3];     /* nodes, triangles, corner normals */
	mat4 before[REALTIME_MOST_OBJECTS]; /* poses of the frame before */
	bool has_before;
	double build_ms;
} realtime_scene;

/* False with one line in message. */
bool realtime_scene_create(const trace_scene *scene, realtime_scene *out, char *message, size_t message_size);
void realtime_scene_destroy(realtime_scene *scene);

/* Takes in the poses of now. */
void realtime_scene_pose(realtime_scene *scene);

#endif
