#include "file_scene.h"

#include "figure.h"
#include "file_cage.h"
#include "file_inside.h"
#include "file_rays.h"
#include "file_sides.h"
#include "file_textures.h"
#include "file_twins.h"
#include "fineness.h"
#include "options.h"
#include "progress.h"

#include <cglm/cglm.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A leaf size that splits no face, metres. */
static const float WHOLE_FACES = 1e9f;

static const float PI = 3.14159265358979f;

/* ---- where things are ---- */

/* World corners of a face; more than four are not needed to tell where it is and where it looks. */
static uint32_t face_corners(const engine_mesh *mesh, mat4 world, const uint32_t *indices, uint32_t count,
			     vec3 corners[4])
{
	const uint32_t used = count < 4 ? count : 4;
	for (uint32_t k = 0; k < used; k++)
		glm_mat4_mulv3(world, mesh->positions + 3 * (size_t)indices[k], 1, corners[k]);
	return used;
}

static void add_bounds(file_scene *f, const engine_scene_object *object)
{
	mat4 world;
	file_world_from_object(&object->rest, world);
	for (uint32_t v = 0; v < object->mesh.vertex_count; v++) {
		vec3 p;
		glm_mat4_mulv3(world, object->mesh.positions + 3 * (size_t)v, 1, p);
		glm_vec3_minv(f->lower, p, f->lower);
		glm_vec3_maxv(f->upper, p, f->upper);
	}
}

static void measure(file_scene *f)
{
	for (int k = 0; k < 3; k++) {
		f->lower[k] = INFINITY;
		f->upper[k] = -INFINITY;
	}
	for (uint32_t k = 0; k < f->scene.object_count; k++)
		add_bounds(f, f->scene.objects + k);
	if (f->lower[0] <= f->upper[0])
		return;
	glm_vec3_broadcast(-1, f->lower); /* an empty scene: anything will do */
	glm_vec3_broadcast(1, f->upper);
}

/* ---- a camera for files without one ---- */

/* What the faces say about where to look from. */
typedef struct facing {
	double inward;   /* area that looks to the middle less area that looks away, m2 */
	double walls[4]; /* area that looks inward at the sides +z, +x, -x, -z, m2 */
	double area;     /* m2 */
	vec3 normal;     /* sum of all normals times their areas, m2 */
} facing;

static const float sides[4][3] = {{0, 0, 1}, {1, 0, 0}, {-1, 0, 0}, {0, 0, -1}};

static void add_face(facing *a, const file_scene *f, vec3 corners[4], uint32_t count)
{
	vec3 e, d, normal, middle, outward;
	glm_vec3_sub(corners[1], corners[0], e);
	glm_vec3_sub(corners[count - 1], corners[0], d);
	glm_vec3_cross(e, d, normal);
	const float area = (count > 3 ? 1 : 0.5f) * glm_vec3_norm(normal);
	glm_vec3_normalize(normal);
	a->area += (double)area;
	glm_vec3_muladds(normal, area, a->normal);
	glm_vec3_add((float *)f->lower, (float *)f->upper, middle);
	glm_vec3_scale(middle, 0.5f, middle);
	glm_vec3_sub(corners[0], middle, outward);
	a->inward -= (double)(area * glm_vec3_dot(normal, outward) / fmaxf(glm_vec3_norm(outward), 1e-12f));
	for (int k = 0; k < 4; k++)
		if (glm_vec3_dot(normal, (float *)sides[k]) < -0.8f && glm_vec3_dot(outward, (float *)sides[k]) > 0)
			a->walls[k] += (double)area;
}

static facing find_facing(const file_scene *f)
{
	facing a = {0};
	for (uint32_t o = 0; o < f->scene.object_count; o++) {
		const engine_mesh *mesh = &f->scene.objects[o].mesh;
		mat4 world;
		file_world_from_object(&f->scene.objects[o].rest, world);
		const uint32_t *indices = mesh->indices;
		for (uint32_t k = 0; k < mesh->face_count; indices += mesh->face_counts[k++]) {
			vec3 corners[4];
			add_face(&a, f, corners, face_corners(mesh, world, indices, mesh->face_counts[k], corners));
		}
	}
	return a;
}

/* Open ground below a lamp looks inward too, and from the side there is little of it to see. */
static bool is_room(const facing *a)
{
	return a->inward > 0 && a->walls[0] + a->walls[1] + a->walls[2] + a->walls[3] > 0.02 * a->area;
}

/* A room is looked into from its most open side (backs are not drawn: a closed one opens like a doll's house), anything
 * else from the front, the right and above.
 */
static void find_direction(const file_scene *f, vec3 direction)
{
	const facing a = find_facing(f);
	glm_vec3_copy((vec3){0.45f, 0.35f, 1}, direction);
	if (glm_vec3_dot((float *)a.normal, direction) < -0.01f * (float)a.area) { /* from the other side of a slope */
		direction[0] = copysignf(direction[0], a.normal[0]);
		direction[2] = copysignf(direction[2], a.normal[2]);
	}
	if (is_room(&a)) {
		int open = 0;
		for (int k = 1; k < 4; k++)
			if (a.walls[k] < 0.5 * a.walls[open])
				open = k;
		glm_vec3_copy((float *)sides[open], direction);
	}
	glm_vec3_normalize(direction);
}

/* Far enough for every corner of the bounds to be in a square picture. */
static float fitting_distance(const file_scene *f, vec3 middle, vec3 direction, float fov)
{
	vec3 right, up;
	glm_vec3_crossn((vec3){0, 1, 0}, direction, right);
	glm_vec3_cross(direction, right, up);
	float distance = 0;
	for (int k = 0; k < 8; k++) {
		vec3 corner = {(k & 1 ? f->upper : f->lower)[0], (k & 2 ? f->upper : f->lower)[1],
			       (k & 4 ? f->upper : f->lower)[2]};
		glm_vec3_sub(corner, middle, corner);
		const float across = fmaxf(fabsf(glm_vec3_dot(corner, right)), fabsf(glm_vec3_dot(corner, up)));
		distance = fmaxf(distance, glm_vec3_dot(corner, direction) + across / tanf(0.5f * fov));
	}
	return 1.05f * distance;
}

static void frame_everything(file_scene *f)
{
	vec3 middle, direction;
	glm_vec3_add(f->lower, f->upper, middle);
	glm_vec3_scale(middle, 0.5f, middle);
	find_direction(f, direction);
	f->framing = (camera){.up = {0, 1, 0}, .vertical_fov = 0.7f};
	f->framing.radius = fmaxf(0.5f * glm_vec3_distance(f->lower, f->upper), 1e-6f);
	const float distance = fitting_distance(f, middle, direction, f->framing.vertical_fov);
	glm_vec3_copy(middle, f->framing.target);
	glm_vec3_copy(middle, f->framing.eye);
	glm_vec3_muladds(direction, distance, f->framing.eye);
}

/* The file's target is a metre ahead; one as far as the scene's middle is better to turn about. */
static void set_target(const file_scene *f, camera *c)
{
	vec3 ahead, middle;
	glm_vec3_sub(c->target, c->eye, ahead);
	glm_vec3_normalize(ahead);
	glm_vec3_sub((float *)f->framing.target, c->eye, middle);
	const float distance = fmaxf(glm_vec3_dot(middle, ahead), 0.25f * c->radius);
	glm_vec3_copy(c->eye, c->target);
	glm_vec3_muladds(ahead, distance, c->target);
}

void file_scene_view(const file_scene *f, double time_s, camera *out)
{
	engine_scene_camera seen;
	*out = f->framing;
	if (!engine_scene_camera_at(&f->scene, time_s, &seen))
		return;
	glm_vec3_copy(seen.eye, out->eye);
	glm_vec3_copy(seen.target, out->target);
	glm_vec3_copy(seen.up, out->up);
	out->vertical_fov = seen.vertical_fov;
	set_target(f, out);
}

/* ---- load ---- */

static bool has_light(const engine_scene *scene)
{
	for (uint32_t k = 0; k < scene->light_count; k++)
		if (scene->lights[k].intensity[0] + scene->lights[k].intensity[1] + scene->lights[k].intensity[2] > 0)
			return true;
	for (uint32_t k = 0; k < scene->material_count; k++) {
		const float *radiance = scene->materials[k].radiance;
		if (scene->materials[k].used && radiance[0] + radiance[1] + radiance[2] > 0)
			return true;
	}
	return false;
}

/* Whether some faces of an object have two sides and others one: the library knows the one or the other of a whole
 * object. */
static bool mixes_sides(const engine_scene *scene, const engine_scene_object *object)
{
	for (uint32_t k = 0; k < object->mesh.face_count; k++)
		if (object->double_sided && !scene->materials[object->mesh.face_materials[k]].double_sided)
			return true;
	return false;
}

/* What is said of several objects at once: how many, and the first. */
typedef struct objects_told {
	uint32_t count;
	const char *first;
} objects_told;

static void add_told(objects_told *told, bool is_one, const char *name)
{
	if (is_one && !told->count++)
		told->first = name;
}

static void tell(const file_scene *f, const char *path, const objects_told *told, const char *what)
{
	if (told->count)
		options_say(f->program, "%s: %s (%u, first: \"%s\")", path, what, told->count, told->first);
}

static void warn(const file_scene *f, const char *path)
{
	objects_told sized = {0}, mixed = {0};
	if (f->scene.warning[0])
		options_say(f->program, "%s: %s", path, f->scene.warning);
	if (f->scene.object_count && !f->lit && !has_light(&f->scene))
		options_say(f->program, "%s: nothing in it emits light; --sky 3 gives it some", path);
	for (uint32_t k = 0; k < f->scene.object_count; k++) {
		const engine_scene_object *object = f->scene.objects + k;
		add_told(&sized, object->scale_animated && object->baked, object->name);
		add_told(&mixed, mixes_sides(&f->scene, object), object->name);
	}
	tell(f, path, &sized, "objects whose transform shears and changes scale keep their shape at rest");
	tell(f, path, &mixed, "objects with materials of one side and of two get two for all");
}

/* A picture without light should say why. */
static void choose_view(file_scene *f, const char *path)
{
	camera start;
	if (!f->scene.has_camera && file_inside_look(&f->scene, f->lit, &f->framing))
		options_say(f->program, "%s: nothing lit is seen from outside; the camera stands where light falls",
			    path);
	file_scene_view(f, 0, &start);
	if (f->scene.has_camera && file_inside_sees_backs(&f->scene, f->lit, &start))
		options_say(f->program,
			    "%s: the file's camera sees backs of faces, which are not drawn; --two-sided draws them",
			    path);
}

bool file_scene_load(file_scene *f, const char *path, char *message, size_t message_size)
{
	if (!engine_scene_load(path, &f->scene, message, message_size))
		return false;
	f->lit = f->lit || (f->scene.sky.radiance && !f->sky_given);
	const size_t count = f->scene.object_count + 1; /* an empty scene is a scene */
	f->handles = calloc(count, sizeof *f->handles);
	f->shapes = calloc(count, sizeof *f->shapes);
	f->names = calloc(count, sizeof *f->names);
	if (!f->handles || !f->shapes || !f->names) {
		snprintf(message, message_size, "%s: out of memory", path);
		file_scene_free(f);
		return false;
	}
	for (uint32_t k = 0; k < f->scene.object_count; k++)
		f->names[k] = f->scene.objects[k].name;
	measure(f);
	warn(f, path);
	if (!file_sides_mend(&f->scene, f->two_sided, f->lit, f->program)) {
		snprintf(message, message_size, "%s: out of memory", path);
		file_scene_free(f);
		return false;
	}
	frame_everything(f);
	choose_view(f, path);
	return true;
}

void file_scene_free(file_scene *f)
{
	for (uint32_t k = 0; f->shapes && k < f->scene.object_count; k++)
		file_shape_free(&f->shapes[k]);
	free(f->shapes);
	f->shapes = NULL;
	engine_scene_free(&f->scene);
	file_lights_free(&f->lights);
	file_uploads_free(&f->uploads);
	free(f->handles);
	free(f->names);
	f->handles = NULL;
	f->names = NULL;
}

/* ---- objects ---- */

static void to_material(const engine_scene_material *from, gi_material *to, gi_specular *specular)
{
	memcpy(to->rho, from->rho, sizeof to->rho);
	for (int c = 0; c < 3; c++)
		to->exitance[c] = PI * from->radiance[c]; /* a lambertian side: E = pi L */
	memcpy(specular->reflectance, from->mirror, sizeof specular->reflectance);
	memcpy(specular->transmittance, from->glass, sizeof specular->transmittance);
	specular->index = from->index;
}

/* Only what its faces use, or a lamp's material would make lamps of all. Renumbers the mesh. Returns how many. */
static uint32_t take_materials(const engine_scene *scene, engine_mesh *mesh, gi_material *to, gi_specular *specular)
{
	uint32_t count = 0, *number = malloc(sizeof *number * (scene->material_count + 1));
	if (!number)
		return 0;
	for (uint32_t k = 0; k < scene->material_count; k++)
		number[k] = UINT32_MAX;
	for (uint32_t k = 0; k < mesh->face_count; k++) {
		uint32_t *material = mesh->face_materials + k;
		if (number[*material] == UINT32_MAX) {
			to_material(scene->materials + *material, &to[count], &specular[count]);
			number[*material] = count++;
		}
		*material = number[*material];
	}
	free(number);
	return count;
}

static gi_pose to_pose(const engine_pose *pose)
{
	gi_pose out;
	memcpy(out.position, pose->translation, sizeof out.position);
	memcpy(out.rotation, pose->rotation, sizeof out.rotation);
	return out;
}

/* An object on its way to the library: what its definition points to. */
typedef struct prepared {
	engine_mesh cage, drawn; /* drawn: empty where the cage is */
	gi_material *materials;
	gi_specular *specular;
	/* Of one whose leaves have materials of their own, textured or coloured: the scene's numbers; else NULL */
	uint32_t *face_materials;
	const engine_mesh *full; /* what the leaves of a simplified cage take them from; NULL: the cage is whole */
	file_shown shown;        /* which of them are drawn */
} prepared;

static void define(const file_scene *f, const engine_scene_object *object, const prepared *p, gi_object_def *def)
{
	static const gi_scheme schemes[] = {[ENGINE_SCHEME_BILINEAR] = GI_SCHEME_BILINEAR,
					    [ENGINE_SCHEME_CATMULL_CLARK] = GI_SCHEME_CATMULL_CLARK,
					    [ENGINE_SCHEME_LOOP] = GI_SCHEME_LOOP};
	def->name = object->name;
	def->positions = p->cage.positions;
	def->vertex_count = p->cage.vertex_count;
	def->face_counts = p->cage.face_counts;
	def->face_count = p->cage.face_count;
	def->indices = p->cage.indices;
	def->index_count = p->cage.index_count;
	def->face_materials = p->cage.face_materials;
	def->materials = p->materials;
	def->specular = p->specular;
	def->draw_positions = p->drawn.positions;
	def->draw_vertex_count = p->drawn.vertex_count;
	def->draw_indices = p->drawn.indices;
	def->draw_index_count = p->drawn.index_count;
	def->scheme = schemes[object->scheme];
	def->levels = f->leaf_size > 0 ? 0 : object->levels;
	def->double_sided = object->double_sided;
	def->uvs = p->face_materials ? p->cage.uvs : NULL;
	def->leaf_materials = p->face_materials;
	memcpy(def->scale, object->rest.scale, sizeof def->scale);
	def->pose = to_pose(&object->rest);
}

static void *grow(void *memory, size_t count, size_t size, bool *enough)
{
	void *grown = realloc(memory, count * size);
	*enough = *enough && grown;
	return grown ? grown : memory;
}

/* Materials more, for faces whose textures are drawn: those of a cage are what they were, those of a mesh in front of
 * a cage light nothing. */
static bool add_shown(const file_scene *f, const engine_scene_object *object, prepared *p, gi_object_def *def)
{
	const bool whole = !p->drawn.index_count;
	bool enough = true;
	if (!file_shown_is_used(&f->scene, &object->mesh))
		return true;
	if (!file_shown_make(&f->scene, whole ? &p->cage : &object->mesh,
			     whole ? p->face_materials : object->mesh.face_materials,
			     whole ? p->cage.face_materials : NULL, def->material_count, &p->shown))
		return false;
	const uint32_t first = def->material_count, count = first + p->shown.count;
	p->materials = grow(p->materials, count, sizeof *p->materials, &enough);
	p->specular = grow(p->specular, count, sizeof *p->specular, &enough);
	def->materials = p->materials;
	def->specular = p->specular;
	for (uint32_t k = first; enough && k < count; k++) {
		p->materials[k] = (gi_material){.rho = {0}};
		p->specular[k] = (gi_specular){.index = 1};
		if (whole)
			to_material(&f->scene.materials[p->shown.sources[k - first]], &p->materials[k],
				    &p->specular[k]);
	}
	def->material_count = count;
	def->draw_uvs = p->shown.uvs;
	if (whole)
		def->face_materials = p->shown.numbers;
	else
		def->draw_face_materials = p->shown.numbers;
	return enough;
}

/* How many faces a mesh may have before it is simplified, UINT32_MAX: it is a cage. */
static uint32_t most_faces(const file_scene *f, const engine_scene_object *object, const fineness *fine)
{
	if (object->scheme != ENGINE_SCHEME_BILINEAR || object->levels)
		return UINT32_MAX;
	return f->cage_faces ? f->cage_faces : fineness_most_faces(fine, object);
}

/* Before the cage's are numbered anew. */
static bool keep_face_materials(const file_scene *f, prepared *out)
{
	const size_t bytes = sizeof *out->face_materials * out->cage.face_count;
	out->face_materials = malloc(bytes);
	if (out->face_materials)
		memcpy(out->face_materials, out->cage.face_materials, bytes);
	return out->face_materials && file_textures_prepare(&f->scene, &out->cage, out->full != NULL);
}

static gi_result set_leaf_materials(const file_scene *f, const prepared *p, bool both_sides, gi_context *gi,
				    gi_object object)
{
	if (!p->face_materials)
		return GI_OK;
	return p->full ? file_cage_set(&f->scene, p->full, &p->cage, both_sides, gi, object)
		       : file_textures_set(&f->scene, &p->cage, p->face_materials, gi, object);
}

static bool prepare(const file_scene *f, const engine_scene_object *object, const fineness *fine, prepared *out,
		    gi_object_def *def, char *message, size_t message_size)
{
	const uint32_t most = most_faces(f, object, fine);
	const bool simplified = object->mesh.face_count > most;
	char why[512] = "out of memory";
	*def = gi_object_def_default();
	if (simplified)
		progress_show(&(progress){.program = f->program}, "simplifying a mesh", 0, 0);
	if (simplified ? !figure_make(&object->mesh, most, &out->drawn, &out->cage, why, sizeof why)
		       : !engine_mesh_copy(&object->mesh, &out->cage)) {
		snprintf(message, message_size, "%s: %s", object->name, why);
		return false;
	}
	if (simplified)
		options_say(f->program, "%s has %u faces; it is lit through a cage of %u (--cage-faces)", object->name,
			    object->mesh.face_count, out->cage.face_count);
	out->full = simplified ? &object->mesh : NULL;
	if (file_textures_are_used(&f->scene, &object->mesh) && !keep_face_materials(f, out)) {
		snprintf(message, message_size, "out of memory");
		return false;
	}
	out->materials = malloc(sizeof *out->materials * (f->scene.material_count + 1));
	out->specular = malloc(sizeof *out->specular * (f->scene.material_count + 1));
	if (out->materials && out->specular)
		def->material_count = take_materials(&f->scene, &out->cage, out->materials, out->specular);
	if (!def->material_count) {
		snprintf(message, message_size, "out of memory");
		return false;
	}
	define(f, object, out, def);
	if (!add_shown(f, object, out, def)) {
		snprintf(message, message_size, "out of memory");
		return false;
	}
	/* A cage that was made as fine as it should be has a leaf a face. */
	if (simplified && !(f->leaf_size > 0))
		def->leaf_size = WHOLE_FACES;
	return true;
}

static void tell_choice(const file_scene *f, const gi_leaf_choice *choice)
{
	if (choice->least_size < 0.99f * choice->leaf_size)
		options_say(f->program, "%u leaves of %.2g, %.2g on what is small (--leaf-size, --leaves)",
			    choice->leaves, (double)choice->leaf_size, (double)choice->least_size);
	else
		options_say(f->program, "%u leaves of %.2g (--leaf-size, --leaves)", choice->leaves,
			    (double)choice->leaf_size);
}

/* Adds what mends it to what the library said. */
static void name_options(char *message, size_t message_size)
{
	const size_t length = strlen(message);
	if (length < message_size)
		snprintf(message + length, message_size - length, " (--leaf-size, --leaves)");
}

/* What the first of its shape was defined with, where it is. */
static void define_twin(const engine_scene_object *object, const gi_object_def *first, gi_object_def *def)
{
	*def = *first;
	def->name = object->name;
	def->pose = to_pose(&object->rest);
}

/* An object before it that is of its shape and was cut alike; its own number where there is none. */
static uint32_t find_created(const gi_object_def *defs, const uint32_t *first, uint32_t number)
{
	uint32_t k = first[number];
	while (k < number && !(first[k] == first[number] && file_twins_have_same_leaves(&defs[k], &defs[number])))
		k++;
	return k;
}

static gi_result create_one(file_scene *f, gi_context *gi, const prepared *objects, const gi_object_def *defs,
			    const uint32_t *first, uint32_t number)
{
	const prepared *from = &objects[first[number]];
	const uint32_t like = find_created(defs, first, number);
	gi_result result;
	if (like < number) {
		result = gi_create_instance(gi, f->handles[like], defs[number].pose, &f->handles[number]);
		return result ? result : gi_set_mobility(gi, f->handles[number], defs[number].mobility);
	}
	result = gi_create_object(gi, &defs[number], &f->handles[number]);
	if (!result)
		result = set_leaf_materials(f, from, defs[number].double_sided, gi, f->handles[number]);
	if (!result)
		result = file_shown_set(&f->scene, &from->shown, &f->uploads, gi, f->handles[number]);
	return result;
}

/* Chooses sizes for what has none and creates all. */
static gi_result create_all(file_scene *f, gi_context *gi, const prepared *objects, gi_object_def *defs,
			    const bool *moves, const uint32_t *first, char *message, size_t message_size)
{
	gi_leaf_choice_def def = gi_leaf_choice_def_default();
	gi_leaf_choice choice;
	def.leaves = f->leaves;
	def.leaf_size = f->leaf_size;
	def.moves = moves;
	gi_result result = gi_choose_leaves(gi, &def, defs, f->scene.object_count, &choice);
	if (result == GI_ERROR_INVALID_ARGUMENT)
		name_options(message, message_size);
	if (!result && choice.leaf_size > 0 && f->scene.object_count)
		tell_choice(f, &choice);
	for (uint32_t k = 0; !result && k < f->scene.object_count; k++)
		result = create_one(f, gi, objects, defs, first, k);
	gi_free_leaf_choice(&choice);
	return result;
}

bool file_scene_create(file_scene *f, gi_context *gi, char *message, size_t message_size)
{
	const uint32_t count = f->scene.object_count;
	prepared *objects = calloc((size_t)count + 1, sizeof *objects);
	gi_object_def *defs = calloc((size_t)count + 1, sizeof *defs);
	bool *moves = calloc((size_t)count + 1, sizeof *moves);
	uint32_t *first = calloc((size_t)count + 1, sizeof *first);
	const fineness fine = fineness_of(&f->scene, f->leaves);
	bool created = objects && defs && moves && first && file_twins_find(&f->scene, first);
	if (!created)
		snprintf(message, message_size, "out of memory");
	for (uint32_t k = 0; created && k < count; k++) {
		moves[k] = f->scene.objects[k].animated || f->scene.objects[k].deforms;
		if (first[k] < k)
			define_twin(&f->scene.objects[k], &defs[first[k]], &defs[k]);
		else
			created = prepare(f, f->scene.objects + k, &fine, &objects[k], &defs[k], message, message_size);
		if (created && !file_shape_make(&f->scene, k, &objects[k].cage, &objects[k].drawn, &f->shapes[k])) {
			snprintf(message, message_size, "out of memory");
			created = false;
		}
		defs[k].mobility = moves[k] ? GI_MOBILITY_MOVABLE : GI_MOBILITY_AUTOMATIC;
		defs[k].deforms = f->shapes[k].bends || f->shapes[k].scales;
	}
	if (created) {
		gi_result result = create_all(f, gi, objects, defs, moves, first, message, message_size);
		if (!result)
			result = file_lights_create(&f->lights, &f->scene, gi, f->program);
		if (result && !message[0])
			snprintf(message, message_size, "%s", gi_result_text(result));
		created = result == GI_OK;
	}
	for (uint32_t k = 0; objects && k < count; k++) {
		engine_mesh_free(&objects[k].cage);
		engine_mesh_free(&objects[k].drawn);
		free(objects[k].materials);
		free(objects[k].specular);
		free(objects[k].face_materials);
		file_shown_free(&objects[k].shown);
	}
	free(objects);
	free(defs);
	free(moves);
	free(first);
	return created;
}

/* So far off that it takes less than a billionth of the light: an object without a pose, for its scale is 0 then. */
static gi_pose out_of_sight(const file_scene *f)
{
	gi_pose pose = {.rotation = {0, 0, 0, 1}};
	memcpy(pose.position, f->framing.target, sizeof pose.position);
	pose.position[1] -= 3e4f * glm_vec3_distance((float *)f->lower, (float *)f->upper);
	return pose;
}

gi_result file_scene_animate(file_scene *f, gi_context *gi, double time_s)
{
	gi_result result = GI_OK;
	for (uint32_t k = 0; !result && k < f->scene.object_count; k++) {
		const engine_scene_object *object = f->scene.objects + k;
		engine_pose pose;
		if (!object->animated && !object->deforms)
			continue;
		/* A key that is no pose for another reason leaves the object where it was. */
		if (engine_scene_pose(&f->scene, k, time_s, &pose)) {
			result = gi_set_pose(gi, f->handles[k], to_pose(&pose));
			if (!result)
				result = file_shape_set(&f->scene, k, &f->shapes[k], gi, f->handles[k], time_s, &pose);
		} else if (object->vanishes) {
			result = gi_set_pose(gi, f->handles[k], out_of_sight(f));
		}
	}
	return result ? result : file_lights_animate(&f->lights, &f->scene, gi, time_s);
}
