/* A scene file's faces as triangles to shoot rays at, and its lamps to shoot them from: a few thousand rays say which
 * sides are lit and from where something is seen. Every triangle is tried; how many rays that allows is in `rays`.
 */
#ifndef DEMOS_FILE_RAYS_H
#define DEMOS_FILE_RAYS_H

#include "import_file.h"

#include <cglm/cglm.h>

#include <stdbool.h>
#include <stdint.h>

typedef struct file_triangle {
	float corner[3], edge[2][3]; /* world: first corner, and from it to the two others */
	float normal[3];             /* unit */
	float area;                  /* m2 */
	uint32_t object, face;       /* in the scene, in its object's mesh */
	bool double_sided;
	float power; /* pi L times the area, mean of the channels: W of one side; 0: no lamp */
} file_triangle;

/* A light without a surface, where it is at the start. */
typedef struct file_ray_light {
	engine_light_type type;
	float place[3], direction[3]; /* world */
	float cosine;                 /* of a spot's outer angle */
	double power;                 /* W; of a sun what falls on a disc as large as the scene */
} file_ray_light;

typedef struct file_rays {
	file_triangle *triangles;
	uint32_t count;
	double *powers;         /* count: sums of power up to and with each triangle */
	file_ray_light *lights; /* those without a surface */
	uint32_t light_count;
	double power;            /* of all lamps and lights */
	float middle[3], radius; /* of a sphere about all */
	uint32_t rays;           /* that take about a quarter of a second; 0: too many triangles for any */
	bool sky;                /* what meets no face meets light */
	uint32_t random;
} file_rays;

typedef struct file_hit {
	uint32_t triangle; /* UINT32_MAX: none */
	float distance;
	bool back; /* the ray came from behind the face */
} file_hit;

/* Scale, rotation, translation as a matrix. */
void file_world_from_object(const engine_pose *pose, mat4 out);

/* False: out of memory; file_rays_free() is fine on it. */
bool file_rays_make(file_rays *r, const engine_scene *scene, bool sky);
void file_rays_free(file_rays *r);

/* The nearest triangle ahead, farther than `least` metres. through_backs: backs of faces with one side, which pictures
 * do not show, are passed.
 */
file_hit file_rays_shoot(const file_rays *r, const float origin[3], const float direction[3], float least,
			 bool through_backs);

/* A number of [0, 1): the same sequence on every machine. */
float file_rays_random(file_rays *r);

/* A point on a lamp or light, as often as it gives light, and a direction from it as often as it shines there. False:
 * there are none. */
bool file_rays_from_lamp(file_rays *r, float origin[3], float direction[3]);

/* A direction about a unit normal with the cosine's density. */
void file_rays_scatter(file_rays *r, const float normal[3], float direction[3]);

#endif
