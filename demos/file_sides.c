#include "file_sides.h"

#include "file_rays.h"
#include "mesh_clean.h"
#include "options.h"

#include <cglm/cglm.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BOUNCES = 6 };

/* How often light came to an object's faces, or to a face, and how often the front of one that it reached from behind
 * looks at the front of another: walls of a dark room look so at each other.
 */
typedef struct sides {
	uint32_t front, back, faced;
} sides;

/* ---- what light says --------------------------------------------------------------------------------------------- */

static bool looks_at_a_front(file_rays *r, const file_triangle *t, const float point[3])
{
	vec3 direction;
	file_rays_scatter(r, t->normal, direction);
	const file_hit hit = file_rays_shoot(r, point, direction, 1e-5f * r->radius, false);
	return hit.triangle != UINT32_MAX && !hit.back;
}

static void count(sides *s, const file_hit *hit, bool faced)
{
	s->front += !hit->back;
	s->back += hit->back;
	s->faced += faced;
}

/* Light that meets a face goes on from the side it came to, as if all had two. */
static void follow(file_rays *r, sides *of_objects, sides *of_faces, const uint32_t *first_face)
{
	vec3 origin, direction;
	if (!file_rays_from_lamp(r, origin, direction))
		return;
	for (int bounce = 0; bounce < BOUNCES; bounce++) {
		file_hit hit = file_rays_shoot(r, origin, direction, 1e-5f * r->radius, false);
		if (hit.triangle == UINT32_MAX)
			return;
		const file_triangle *t = &r->triangles[hit.triangle];
		vec3 normal;
		glm_vec3_scale((float *)t->normal, hit.back ? -1 : 1, normal);
		glm_vec3_muladds(direction, hit.distance, origin);
		if (!t->double_sided && !(t->power > 0)) {
			const bool faced = hit.back && looks_at_a_front(r, t, origin);
			count(&of_objects[t->object], &hit, faced);
			count(&of_faces[first_face[t->object] + t->face], &hit, faced);
		}
		file_rays_scatter(r, normal, direction);
	}
}

/* ---- what is done ------------------------------------------------------------------------------------------------ */

static bool is_lamp(const engine_scene *scene, const engine_mesh *mesh, uint32_t face)
{
	const float *radiance = scene->materials[mesh->face_materials[face]].radiance;
	return radiance[0] + radiance[1] + radiance[2] > 0;
}

/* Light reached it from behind alone, and its front is not a wall of a room of its own. */
static bool is_turned(const sides *s)
{
	return s->front * 100ull <= s->front + s->back && 4ull * s->faced <= 3ull * s->back;
}

/* Turns the faces that are. Returns whether those are all that were lit from behind. */
static bool turn_faces(const engine_scene *scene, engine_mesh *mesh, const sides *of_faces, uint32_t *turned)
{
	bool all = true;
	uint32_t *corners = mesh->indices;
	for (uint32_t f = 0; f < mesh->face_count; corners += mesh->face_counts[f++]) {
		const uint64_t hits = (uint64_t)of_faces[f].front + of_faces[f].back;
		bool lit_behind = of_faces[f].back * 100ull > hits && !is_lamp(scene, mesh, f);
		if (lit_behind && is_turned(&of_faces[f])) {
			engine_mesh_turn_face(mesh, corners, mesh->face_counts[f]);
			++*turned;
		} else if (lit_behind) {
			all = false;
		}
	}
	return all;
}

typedef struct painted {
	const engine_scene *scene;
	const engine_mesh *mesh;
} painted;

static bool is_no_lamp(const void *context, uint32_t face, const uint32_t *corners)
{
	const painted *p = context;
	(void)corners;
	return !is_lamp(p->scene, p->mesh, face);
}

/* Appends every face that is no lamp the other way round, on vertices of its own. */
static bool add_backs(const engine_scene *scene, engine_mesh *mesh)
{
	engine_mesh backs;
	if (!engine_mesh_copy(mesh, &backs))
		return false;
	engine_mesh_keep_faces(&backs, is_no_lamp, &(painted){scene, &backs});
	uint32_t *corners = backs.indices;
	for (uint32_t f = 0; f < backs.face_count; corners += backs.face_counts[f++])
		engine_mesh_turn_face(&backs, corners, backs.face_counts[f]);
	bool added = engine_mesh_append(mesh, &backs, 0);
	engine_mesh_free(&backs);
	return added;
}

static bool has_lamp(const engine_scene *scene, const engine_mesh *mesh)
{
	for (uint32_t f = 0; f < mesh->face_count; f++) {
		if (is_lamp(scene, mesh, f))
			return true;
	}
	return false;
}

static bool make_two_sided(const engine_scene *scene, engine_scene_object *object)
{
	if (object->double_sided)
		return true;
	if (has_lamp(scene, &object->mesh))
		return add_backs(scene, &object->mesh);
	object->double_sided = true;
	return true;
}

typedef struct mended {
	uint32_t turned, doubled; /* faces, objects */
	const char *first;
} mended;

/* 1 %: a few rays slip through the cracks of any mesh. 16 rays a face tell for each; fewer only for the whole. */
static bool mend_object(engine_scene *scene, engine_scene_object *object, sides of_object, const sides *of_faces,
			mended *m)
{
	uint32_t all = of_object.front + of_object.back;
	if (of_object.back * 100ull <= all)
		return true;
	if (!m->first)
		m->first = object->name;
	bool each = all >= 16 * object->mesh.face_count;
	if (each && turn_faces(scene, &object->mesh, of_faces, &m->turned))
		return true;
	if (!each && is_turned(&of_object)) {
		uint32_t *corners = object->mesh.indices;
		for (uint32_t f = 0; f < object->mesh.face_count; corners += object->mesh.face_counts[f++]) {
			if (!is_lamp(scene, &object->mesh, f))
				engine_mesh_turn_face(&object->mesh, corners, object->mesh.face_counts[f]);
		}
		m->turned += object->mesh.face_count;
		return true;
	}
	m->doubled++;
	return make_two_sided(scene, object);
}

static void tell(const mended *m, const char *program)
{
	if (m->turned)
		options_say(program,
			    "faces that are lit from behind alone are turned round (%u, first in \"%s\"); "
			    "--two-sided=off keeps them",
			    m->turned, m->first);
	if (m->doubled)
		options_say(program,
			    "objects that are lit from behind get two sides (%u, first: \"%s\"); "
			    "--two-sided=off keeps them",
			    m->doubled, m->first);
}

/* 2 % of the light: less is what turns up behind single faces of any scene. */
static bool mend_by_light(engine_scene *scene, file_rays *r, sides *of_objects, sides *of_faces, uint32_t *first_face,
			  const char *program)
{
	uint64_t front = 0, back = 0;
	mended m = {0};
	for (uint32_t o = 0, face = 0; o < scene->object_count; face += scene->objects[o++].mesh.face_count)
		first_face[o] = face;
	for (uint32_t k = 0; k < r->rays / BOUNCES; k++)
		follow(r, of_objects, of_faces, first_face);
	for (uint32_t o = 0; o < scene->object_count; o++) {
		front += of_objects[o].front;
		back += of_objects[o].back;
	}
	bool done = true;
	for (uint32_t o = 0; o < scene->object_count && back * 50 > front + back && done; o++)
		done = mend_object(scene, &scene->objects[o], of_objects[o], of_faces + first_face[o], &m);
	tell(&m, program);
	return done;
}

/* Whether the sky is seen from the front of some face. */
static bool sees_sky(file_rays *r)
{
	for (uint32_t k = 0; k < r->rays; k++) {
		const file_triangle *t = &r->triangles[(uint32_t)(file_rays_random(r) * (float)r->count)];
		vec3 origin, direction;
		float u = file_rays_random(r), v = file_rays_random(r);
		glm_vec3_copy((float *)t->corner, origin);
		glm_vec3_muladds((float *)t->edge[0], u + v > 1 ? 1 - u : u, origin);
		glm_vec3_muladds((float *)t->edge[1], u + v > 1 ? 1 - v : v, origin);
		file_rays_scatter(r, t->normal, direction);
		if (file_rays_shoot(r, origin, direction, 1e-5f * r->radius, false).triangle == UINT32_MAX)
			return true;
	}
	return r->rays == 0; /* too many faces to tell */
}

/* A closed room whose faces look inward stays black below any sky: its outside is shown instead. */
static bool mend_by_sky(engine_scene *scene, file_rays *r, const char *program)
{
	bool done = true;
	if (r->power > 0 || sees_sky(r))
		return true;
	for (uint32_t o = 0; o < scene->object_count && done; o++)
		done = make_two_sided(scene, &scene->objects[o]);
	options_say(program, "no face looks at the sky: all get two sides; --two-sided=off keeps them");
	return done;
}

static bool follow_light(engine_scene *scene, bool sky, const char *program)
{
	file_rays r;
	size_t faces = 0;
	for (uint32_t o = 0; o < scene->object_count; o++)
		faces += scene->objects[o].mesh.face_count;
	sides *of_objects = calloc((size_t)scene->object_count + 1, sizeof *of_objects);
	sides *of_faces = calloc(faces + 1, sizeof *of_faces);
	uint32_t *first_face = calloc((size_t)scene->object_count + 1, sizeof *first_face);
	bool done = file_rays_make(&r, scene, sky) && of_objects && of_faces && first_face &&
		    mend_by_light(scene, &r, of_objects, of_faces, first_face, program) &&
		    (!r.sky || r.count == 0 || mend_by_sky(scene, &r, program));
	file_rays_free(&r);
	free(of_objects);
	free(of_faces);
	free(first_face);
	return done;
}

bool file_sides_mend(engine_scene *scene, options_sides two_sided, bool sky, const char *program)
{
	bool done = true;
	if (two_sided == OPTIONS_SIDES_AUTO)
		return follow_light(scene, sky, program);
	for (uint32_t o = 0; o < scene->object_count && done && two_sided == OPTIONS_SIDES_ON; o++)
		done = make_two_sided(scene, &scene->objects[o]);
	return done;
}
