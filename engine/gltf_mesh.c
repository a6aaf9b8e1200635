/* Meshes of a glTF file: triangles of all modes, morph targets and skins as they are at rest, colours of vertices. */
#include "gltf_scene.h"
#include "mesh_clean.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MODE_TRIANGLES = 4, MODE_STRIP = 5, MODE_FAN = 6 };

/* More active at once are a mistake; each costs as much as the mesh. */
enum { MAX_TARGETS = 16 };

/* Accessors of a primitive; of the optional ones NULL where there is none. */
typedef struct primitive {
	const gltf_accessor *positions, *indices, *colors, *uvs, *joints[2], *weights[2], *targets[MAX_TARGETS];
	double target_weights[MAX_TARGETS];
	uint32_t target_count;
	const gltf_accessor *all_targets[IMPORT_MOST_TARGETS]; /* for the shape: at rest or not */
	uint32_t corner_count, triangle_count;
	int mode;
	uint32_t material;
} primitive;

/* What a mesh is read with. */
typedef struct reading {
	gltf_document *document;
	const gltf_skin *skin;
	const cJSON *target_weights; /* the list, or NULL */
	const char *name;
	engine_mesh *out;    /* its arrays have room for all corners */
	import_shape *shape; /* likewise; NULL: not wanted */
	uint32_t left_out;   /* triangles */
	uint64_t corners;    /* of all, room for which is made */
} reading;

/* ---- what there is ----------------------------------------------------------------------------------------------- */

static int mode_of(const cJSON *from)
{
	double mode = MODE_TRIANGLES;
	gltf_number(from, "mode", &mode);
	return mode == MODE_TRIANGLES || mode == MODE_STRIP || mode == MODE_FAN ? (int)mode : -1;
}

/* Number of an accessor that an object names; -1: none, or one that is not there. */
static int64_t accessor_number(const gltf_document *document, const cJSON *object, const char *key)
{
	int64_t number = -1;
	return gltf_index(document, object, key, GLTF_ACCESSORS, &number) ? number : -1;
}

static uint32_t corner_count(const gltf_document *document, const cJSON *from)
{
	int64_t number = gltf_member(from, "indices")
			     ? accessor_number(document, from, "indices")
			     : accessor_number(document, gltf_member(from, "attributes"), "POSITION");
	return number >= 0 && !document->accessors[number].fault ? document->accessors[number].count : 0;
}

static uint32_t triangles_of(int mode, uint32_t corners)
{
	return mode == MODE_TRIANGLES ? corners / 3 : corners < 3 ? 0 : corners - 2;
}

uint64_t gltf_count_corners(const gltf_document *document, const cJSON *mesh)
{
	const cJSON *from;
	uint64_t corners = 0;
	cJSON_ArrayForEach(from, gltf_member(mesh, "primitives"))
	{
		int mode = mode_of(from);
		corners += mode < 0 ? 0 : 3 * (uint64_t)triangles_of(mode, corner_count(document, from));
	}
	return corners;
}

/* Of `components`, or one more, and with an element for each position; NULL where there is none. */
static const gltf_accessor *optional(const reading *r, const primitive *p, const cJSON *attributes, const char *key,
				     uint32_t components)
{
	const char *fault;
	int64_t number = accessor_number(r->document, attributes, key);
	const gltf_accessor *found = gltf_find_accessor(r->document, number, components, &fault);
	if (!found && number >= 0 && components == 3)
		found = gltf_find_accessor(r->document, number, components + 1, &fault);
	if (found && found->count < p->positions->count) {
		fault = "it has fewer elements than there are positions";
		found = NULL;
	}
	if (!found && gltf_member(attributes, key))
		import_note(r->document->loader, r->name, "attributes %s are left out: %s", key, fault);
	return found;
}

static void find_targets(reading *r, const cJSON *from, primitive *p)
{
	const cJSON *target = gltf_member(from, "targets"),
		    *weight = r->target_weights ? r->target_weights->child : NULL;
	target = target ? target->child : NULL;
	for (int i = 0; target && weight && i < 4096; i++, target = target->next, weight = weight->next) {
		double value = cJSON_IsNumber(weight) && isfinite(weight->valuedouble) ? weight->valuedouble : 0;
		const gltf_accessor *moves = value != 0 ? optional(r, p, target, "POSITION", 3) : NULL;
		if (!moves)
			continue;
		if (p->target_count == MAX_TARGETS) {
			import_note(r->document->loader, r->name, "morph targets beyond %d active ones are left out",
				    MAX_TARGETS);
			return;
		}
		p->targets[p->target_count] = moves;
		p->target_weights[p->target_count++] = value;
	}
}

/* Those of a shape, which may play later. */
static void find_all_targets(const reading *r, const cJSON *from, primitive *p)
{
	const cJSON *target = gltf_member(from, "targets");
	target = target ? target->child : NULL;
	for (uint32_t t = 0; r->shape && target && t < r->shape->target_count; t++, target = target->next)
		p->all_targets[t] = optional(r, p, target, "POSITION", 3);
}

static void find_attributes(reading *r, const cJSON *from, primitive *p)
{
	const cJSON *attributes = gltf_member(from, "attributes");
	static const char *const joints[2] = {"JOINTS_0", "JOINTS_1"}, *const weights[2] = {"WEIGHTS_0", "WEIGHTS_1"};
	p->colors = optional(r, p, attributes, "COLOR_0", 3);
	for (int set = 0; r->skin && set < 2; set++) {
		p->joints[set] = optional(r, p, attributes, joints[set], 4);
		p->weights[set] = optional(r, p, attributes, weights[set], 4);
		if (!p->joints[set] || !p->weights[set])
			p->joints[set] = p->weights[set] = NULL;
	}
	find_targets(r, from, p);
	find_all_targets(r, from, p);
}

/* False with the reason in *fault. */
static bool open_primitive(reading *r, const cJSON *from, primitive *p, const char **fault)
{
	const gltf_document *document = r->document;
	int64_t positions = accessor_number(document, gltf_member(from, "attributes"), "POSITION");
	p->positions = gltf_find_accessor(document, positions, 3, fault);
	if (!p->positions)
		return false;
	if (gltf_member(from, "indices")) {
		p->indices = gltf_find_accessor(document, accessor_number(document, from, "indices"), 1, fault);
		if (!p->indices)
			return false;
	}
	p->corner_count = p->indices ? p->indices->count : p->positions->count;
	p->triangle_count = triangles_of(p->mode, p->corner_count);
	find_attributes(r, from, p);
	return true;
}

/* ---- vertices ---------------------------------------------------------------------------------------------------- */

/* sum of weight * world from mesh; false where no joint has a weight. */
static bool blend_joints(const gltf_skin *skin, const primitive *p, uint32_t vertex, double m[16])
{
	double sum = 0;
	memset(m, 0, 16 * sizeof *m);
	for (int set = 0; set < 2 && p->joints[set]; set++) {
		double joints[4], weights[4];
		gltf_element(p->joints[set], vertex, joints);
		gltf_element(p->weights[set], vertex, weights);
		for (int k = 0; k < 4; k++) {
			if (!(weights[k] > 0) || !(joints[k] >= 0 && joints[k] < skin->joint_count))
				continue;
			const double *joint = skin->matrices[(uint32_t)joints[k]];
			for (int i = 0; i < 16; i++)
				m[i] += weights[k] * joint[i];
			sum += weights[k];
		}
	}
	for (int i = 0; sum > 0 && i < 16; i++)
		m[i] /= sum;
	return sum > 0;
}

static void read_position(const reading *r, const primitive *p, uint32_t vertex, double position[3])
{
	double m[16], base[3], moved[3];
	gltf_element(p->positions, vertex, base);
	for (uint32_t t = 0; t < p->target_count; t++) {
		gltf_element(p->targets[t], vertex, moved);
		for (int c = 0; c < 3; c++)
			base[c] += p->target_weights[t] * moved[c];
	}
	memcpy(position, base, sizeof base);
	if (!r->skin || !blend_joints(r->skin, p, vertex, m))
		return;
	for (int row = 0; row < 3; row++)
		position[row] = m[row] * base[0] + m[4 + row] * base[1] + m[8 + row] * base[2] + m[12 + row];
}

/* What moves a vertex, under the number that it has in the mesh. */
static void record_vertex(const reading *r, const primitive *p, uint32_t vertex, uint32_t number)
{
	import_shape *shape = r->shape;
	double bind[3], joints[4], weights[4], moved[3];
	gltf_element(p->positions, vertex, bind);
	for (size_t c = 0; c < 3; c++) {
		shape->bind[3 * (size_t)number + c] = (float)bind[c];
		shape->rest[3 * (size_t)number + c] = r->out->positions[3 * (size_t)number + c];
	}
	for (int k = 0; shape->joint_count && k < IMPORT_INFLUENCES; k++) {
		const size_t at = (size_t)IMPORT_INFLUENCES * number + (size_t)k;
		if (k % 4 == 0 && p->joints[k / 4]) {
			gltf_element(p->joints[k / 4], vertex, joints);
			gltf_element(p->weights[k / 4], vertex, weights);
		}
		bool sound = p->joints[k / 4] && weights[k % 4] > 0 && isfinite(weights[k % 4]) && joints[k % 4] >= 0 &&
			     joints[k % 4] < shape->joint_count;
		shape->joints[at] = sound ? (uint32_t)joints[k % 4] : 0;
		shape->weights[at] = sound ? (float)weights[k % 4] : 0;
	}
	for (uint32_t t = 0; t < shape->target_count; t++) {
		float *delta = shape->deltas + 3 * ((size_t)shape->target_count * number + t);
		memset(delta, 0, 3 * sizeof *delta);
		if (!p->all_targets[t])
			continue;
		gltf_element(p->all_targets[t], vertex, moved);
		for (int c = 0; c < 3; c++)
			delta[c] = isfinite(moved[c]) ? (float)moved[c] : 0;
	}
	shape->vertex_count = number + 1;
}

static bool is_sound(const double position[3])
{
	double farthest = (double)ENGINE_MESH_FARTHEST;
	return fabs(position[0]) <= farthest && fabs(position[1]) <= farthest && fabs(position[2]) <= farthest;
}

/* Number in the mesh of a vertex of the primitive, made when first asked for; UINT32_MAX: it has no place. */
static uint32_t vertex_number(reading *r, const primitive *p, uint32_t vertex)
{
	gltf_document *document = r->document;
	double position[3];
	if (document->stamps[vertex] == document->stamp)
		return document->numbers[vertex];
	document->stamps[vertex] = document->stamp;
	read_position(r, p, vertex, position);
	if (!is_sound(position))
		return document->numbers[vertex] = UINT32_MAX;
	for (int c = 0; c < 3; c++)
		r->out->positions[3 * (size_t)r->out->vertex_count + (size_t)c] = (float)position[c];
	if (r->shape)
		record_vertex(r, p, vertex, r->out->vertex_count);
	return document->numbers[vertex] = r->out->vertex_count++;
}

/* ---- triangles --------------------------------------------------------------------------------------------------- */

/* Corner numbers (into the primitive's list) of triangle t. */
static void triangle_corners(int mode, uint32_t t, uint32_t corners[3])
{
	corners[0] = mode == MODE_TRIANGLES ? 3 * t : mode == MODE_STRIP ? t : 0;
	corners[1] = mode == MODE_TRIANGLES ? 3 * t + 1 : mode == MODE_STRIP ? t + 1 + t % 2 : t + 1;
	corners[2] = mode == MODE_TRIANGLES ? 3 * t + 2 : mode == MODE_STRIP ? t + 2 - t % 2 : t + 2;
}

/* Vertices of the primitive at a triangle's corners. False where there is no such vertex. */
static bool triangle_vertices(const primitive *p, uint32_t t, uint32_t vertices[3])
{
	triangle_corners(p->mode, t, vertices);
	for (int k = 0; k < 3; k++) {
		double number = vertices[k];
		if (p->indices)
			gltf_element(p->indices, vertices[k], &number);
		if (!(number >= 0 && number < p->positions->count))
			return false;
		vertices[k] = (uint32_t)number;
	}
	return true;
}

/* Of files that count them in 0..1; floats may be more, which a dark material brings back. */
static const double BRIGHTEST_COLOR = 1e6;

static void read_color(const primitive *p, uint32_t vertex, float out[4])
{
	double color[4] = {1, 1, 1, 1};
	if (p->colors)
		gltf_element(p->colors, vertex, color);
	for (int c = 0; c < 4; c++)
		out[c] = !p->colors ? ENGINE_NO_COLOR : color[c] > 0 ? (float)fmin(color[c], BRIGHTEST_COLOR) : 0;
}

static void read_uv(const primitive *p, uint32_t vertex, float out[2])
{
	double uv[4] = {0, 0, 0, 0};
	if (p->uvs)
		gltf_element(p->uvs, vertex, uv);
	for (int k = 0; k < 2; k++)
		out[k] = p->uvs && fabs(uv[k]) < 1e6 ? (float)uv[k] : ENGINE_NO_UV;
}

static void add_triangle(reading *r, const primitive *p, uint32_t t)
{
	engine_mesh *out = r->out;
	uint32_t vertices[3], *to = out->indices + out->index_count;
	bool sound = triangle_vertices(p, t, vertices);
	for (int k = 0; sound && k < 3; k++) {
		to[k] = vertex_number(r, p, vertices[k]);
		sound = to[k] != UINT32_MAX;
	}
	if (!sound) {
		r->left_out++;
		return;
	}
	for (int k = 0; out->uvs && k < 3; k++)
		read_uv(p, vertices[k], out->uvs + 2 * ((size_t)out->index_count + (size_t)k));
	for (int k = 0; out->colors && k < 3; k++)
		read_color(p, vertices[k], out->colors + 4 * ((size_t)out->index_count + (size_t)k));
	out->index_count += 3;
	out->face_materials[out->face_count] = p->material;
	out->face_counts[out->face_count++] = 3;
}

static void *make_array(size_t count, size_t size)
{
	return malloc((count + 1) * size);
}

/* Room for the numbers of the vertices of any primitive. */
static bool make_numbers(gltf_document *document)
{
	size_t most = 0;
	for (uint32_t i = 0; i < document->tables[GLTF_ACCESSORS].count; i++) {
		const gltf_accessor *accessor = &document->accessors[i];
		if (!accessor->fault && accessor->components == 3 && accessor->count > most)
			most = accessor->count;
	}
	document->numbers = document->numbers ? document->numbers : make_array(most, sizeof(uint32_t));
	document->stamps = document->stamps ? document->stamps : calloc(most + 1, sizeof(uint32_t));
	return document->numbers && document->stamps;
}

/* Texture coordinates, where the material has a texture; the mesh gets room for them with the first. */
static bool find_uvs(reading *r, const cJSON *from, primitive *p)
{
	const engine_scene_material *m = &r->document->loader->scene->materials[p->material];
	if (!m->rho_texture.number && !m->radiance_texture.number && !m->alpha_texture.number)
		return true;
	char key[16];
	snprintf(key, sizeof key, "TEXCOORD_%u", m->uv_set);
	p->uvs = optional(r, p, gltf_member(from, "attributes"), key, 2);
	if (!r->out->uvs)
		r->out->uvs = calloc(2 * ((size_t)r->corners + 1), sizeof *r->out->uvs);
	return r->out->uvs || import_fail(r->document->loader, "out of memory for meshes");
}

/* Room for colours, where the primitive has some; those before it in the mesh have none. */
static bool make_color_room(reading *r, const primitive *p)
{
	engine_mesh *out = r->out;
	if (!p->colors || out->colors)
		return true;
	out->colors = make_array(r->corners, 4 * sizeof *out->colors);
	for (size_t i = 0; out->colors && i < 4 * (size_t)out->index_count; i++)
		out->colors[i] = ENGINE_NO_COLOR;
	return out->colors || import_fail(r->document->loader, "out of memory for meshes");
}

static bool add_primitive(reading *r, const cJSON *from)
{
	gltf_document *document = r->document;
	primitive p = {.mode = mode_of(from)};
	const char *fault;
	if (p.mode < 0) {
		import_note(document->loader, r->name, "points and lines are not read");
		return true;
	}
	if (!open_primitive(r, from, &p, &fault)) {
		import_note(document->loader, r->name, "parts of meshes are left out: %s", fault);
		document->loader->meshes_broken = true;
		return true;
	}
	if (!gltf_material_number(document, from, &p.material))
		return false;
	if (!find_uvs(r, from, &p) || !make_color_room(r, &p))
		return false;
	document->stamp++;
	for (uint32_t t = 0; t < p.triangle_count; t++)
		add_triangle(r, &p, t);
	return true;
}

/* Corners are known, vertices are no more than those; memory that is not written is not taken either. */
static bool make_room(engine_mesh *mesh, uint64_t corners)
{
	*mesh = (engine_mesh){.positions = make_array(corners, 3 * sizeof(float)),
			      .indices = make_array(corners, sizeof(uint32_t)),
			      .face_counts = make_array(corners / 3, sizeof(uint32_t)),
			      .face_materials = make_array(corners / 3, sizeof(uint32_t))};
	return mesh->positions && mesh->indices && mesh->face_counts && mesh->face_materials;
}

uint32_t gltf_count_targets(const gltf_document *document, int64_t node)
{
	int64_t mesh = -1;
	if (!gltf_index(document, document->tables[GLTF_NODES].items[node], "mesh", GLTF_MESHES, &mesh) || mesh < 0)
		return 0;
	const cJSON *primitives = gltf_member(document->tables[GLTF_MESHES].items[mesh], "primitives");
	return (uint32_t)cJSON_GetArraySize(gltf_member(primitives ? primitives->child : NULL, "targets"));
}

/* Its joints and targets are counted; room as the mesh has it. */
static bool make_shape_room(const reading *r, import_shape *shape, uint64_t corners)
{
	const cJSON *weight = r->target_weights ? r->target_weights->child : NULL;
	for (uint32_t t = 0; t < shape->target_count && weight; t++, weight = weight->next)
		shape->rest_weights[t] =
		    cJSON_IsNumber(weight) && isfinite(weight->valuedouble) ? weight->valuedouble : 0;
	const size_t influences = shape->joint_count ? IMPORT_INFLUENCES : 0;
	shape->rest = make_array(corners, 3 * sizeof(float));
	shape->bind = make_array(corners, 3 * sizeof(float));
	shape->joints = make_array(corners, influences * sizeof(uint32_t) + 1);
	shape->weights = make_array(corners, influences * sizeof(float) + 1);
	shape->deltas = make_array(corners, 3 * sizeof(float) * shape->target_count + 1);
	return shape->rest && shape->bind && shape->joints && shape->weights && shape->deltas;
}

bool gltf_read_mesh(gltf_document *document, const cJSON *mesh, const cJSON *node, const gltf_skin *skin,
		    const char *name, engine_mesh *out, import_shape *shape)
{
	const cJSON *from, *weights = gltf_member(node, "weights");
	const uint64_t corners = gltf_count_corners(document, mesh);
	reading r = {document, skin, weights ? weights : gltf_member(mesh, "weights"), name, out, shape, 0, corners};
	if (!make_numbers(document) || !make_room(out, corners) || (shape && !make_shape_room(&r, shape, corners)))
		return import_fail(document->loader, "out of memory for meshes");
	cJSON_ArrayForEach(from, gltf_member(mesh, "primitives"))
	{
		if (!add_primitive(&r, from))
			return false;
	}
	import_note_many(document->loader, r.left_out, name, IMPORT_BROKEN_FACES);
	document->loader->meshes_broken = document->loader->meshes_broken || r.left_out > 0;
	float *positions = realloc(out->positions, ((size_t)out->vertex_count + 1) * 3 * sizeof(float));
	out->positions = positions ? positions : out->positions;
	return true;
}

/* ---- skins ------------------------------------------------------------------------------------------------------- */

bool gltf_read_skin(gltf_document *document, int64_t number, gltf_skin *out, const char **fault)
{
	const cJSON *from = document->tables[GLTF_SKINS].items[number], *joints = gltf_member(from, "joints"), *joint;
	const engine_scene_graph *graph = document->loader->scene->graph;
	const gltf_accessor *inverse = NULL;
	uint32_t count = (uint32_t)cJSON_GetArraySize(joints);
	*out = (gltf_skin){.matrices = make_array(count, sizeof *out->matrices),
			   .inverse = make_array(count, sizeof *out->inverse),
			   .nodes = make_array(count, sizeof *out->nodes),
			   .joint_count = count};
	if (gltf_member(from, "inverseBindMatrices")) {
		inverse =
		    gltf_find_accessor(document, accessor_number(document, from, "inverseBindMatrices"), 16, fault);
		if (!inverse || inverse->count < count)
			return *fault = inverse ? "a skin has fewer matrices than joints" : *fault, false;
	}
	const bool room = out->matrices && out->inverse && out->nodes;
	*fault = room ? "a skin has a joint that is no node" : "there is no memory for a skin";
	for (joint = joints ? joints->child : NULL, count = 0; room && joint; joint = joint->next, count++) {
		double bind[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
		double node = cJSON_IsNumber(joint) ? joint->valuedouble : -1;
		if (!(node >= 0 && node < document->tables[GLTF_NODES].count))
			return false;
		if (inverse)
			gltf_element(inverse, count, bind);
		out->nodes[count] = (uint32_t)node;
		memcpy(out->inverse[count], bind, sizeof bind);
		import_multiply(graph->world + 16 * (size_t)node, bind, out->matrices[count]);
	}
	return room && count > 0;
}
