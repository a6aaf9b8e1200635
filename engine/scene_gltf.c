/* glTF 2.0 to a scene: materials, nodes, meshes, animations, camera. The container is gltf_document.c's. */
#include "gltf_document.h"
#include "mesh_clean.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- materials --------------------------------------------------------------------------------------------------- */

static void to_floats(const double *from, int count, float *to)
{
	for (int i = 0; i < count; i++)
		to[i] = (float)from[i];
}

static bool read_emission(gltf_document *document, const cJSON *from, engine_scene_material *material)
{
	double factor[3] = {0, 0, 0}, strength = 1;
	const cJSON *extension = gltf_member(gltf_member(from, "extensions"), "KHR_materials_emissive_strength");
	if (!gltf_numbers(document, from, "emissiveFactor", 3, factor) ||
	    !gltf_number(document, extension, "emissiveStrength", &strength))
		return false;
	for (int c = 0; c < 3; c++)
		factor[c] *= strength;
	to_floats(factor, 3, material->radiance);
	return true;
}

static void warn_of_textures(gltf_document *document, const cJSON *from, const char *name)
{
	if (gltf_member(gltf_member(from, "pbrMetallicRoughness"), "baseColorTexture") ||
	    gltf_member(from, "emissiveTexture"))
		scene_warn(document->loader, "textures of material \"%.80s\" are not read", name);
}

static bool read_material(gltf_document *document, const cJSON *from)
{
	engine_scene_material *material = scene_add_material(document->loader, gltf_text(from, "name"));
	if (!material)
		return false;
	const cJSON *surface = gltf_member(from, "pbrMetallicRoughness");
	double color[4] = {0.5, 0.5, 0.5, 1};
	if (!gltf_numbers(document, surface, "baseColorFactor", 4, color) || !read_emission(document, from, material))
		return false;
	to_floats(color, 3, material->rho);
	material->double_sided = cJSON_IsTrue(gltf_member(from, "doubleSided"));
	warn_of_textures(document, from, material->name);
	return scene_check_material(document->loader, material);
}

/* ---- nodes ------------------------------------------------------------------------------------------------------- */

static bool read_transform(gltf_document *document, const cJSON *from, scene_node *node)
{
	node->has_matrix = gltf_member(from, "matrix") != NULL;
	return gltf_numbers(document, from, "matrix", 16, node->matrix) &&
	       gltf_numbers(document, from, "translation", 3, node->translation) &&
	       gltf_numbers(document, from, "rotation", 4, node->rotation) &&
	       gltf_numbers(document, from, "scale", 3, node->scale);
}

/* The last row, 0 0 0 1: what else is a projection, which no body has. */
static bool check_matrix(gltf_document *document, const scene_node *node)
{
	const double *m = node->matrix;
	bool affine = fmax(fabs(m[3]), fmax(fabs(m[7]), fabs(m[11]))) <= 1e-6 && fabs(m[15] - 1) <= 1e-6;
	return !node->has_matrix || affine ||
	       scene_fail(document->loader, "a node's matrix has the last row %g %g %g %g, it must be 0 0 0 1", m[3],
			  m[7], m[11], m[15]);
}

/* glTF lets a rotation be a unit quaternion only; files round. */
static bool normalize_rotation(gltf_document *document, scene_node *node)
{
	double *q = node->rotation, length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
	if (!(length > 1e-6 && length < 1e6))
		return scene_fail(document->loader, "a node's rotation is no unit quaternion");
	for (int c = 0; c < 4; c++)
		q[c] /= length;
	return true;
}

static bool read_nodes(gltf_document *document)
{
	engine_scene_graph *graph = document->loader->scene->graph;
	const gltf_table *table = &document->tables[GLTF_NODES];
	graph->nodes = calloc(table->count + 1, sizeof *graph->nodes);
	if (!graph->nodes)
		return scene_fail(document->loader, "out of memory for nodes");
	graph->node_count = table->count;
	for (uint32_t i = 0; i < table->count; i++) {
		graph->nodes[i] = scene_node_default();
		if (!read_transform(document, table->items[i], &graph->nodes[i]) ||
		    !check_matrix(document, &graph->nodes[i]) || !normalize_rotation(document, &graph->nodes[i]))
			return false;
	}
	return true;
}

/* Breadth first over the scene's nodes, without recursion: files nest as deep as they like. */
typedef struct walk {
	uint32_t *order; /* nodes in the order found; also the queue */
	uint32_t count;
	bool *seen; /* by node: belongs to the scene */
} walk;

/* Takes the node numbers of an array member. Each node belongs to one parent, which excludes cycles too. */
static bool take_nodes(gltf_document *document, walk *w, const cJSON *array, int32_t parent)
{
	const cJSON *item;
	cJSON_ArrayForEach(item, array)
	{
		double value = cJSON_IsNumber(item) ? item->valuedouble : -1;
		uint32_t node = (uint32_t)fmax(0, fmin(value, 4e9));
		if (value != node || node >= document->tables[GLTF_NODES].count || w->seen[node])
			return scene_fail(document->loader,
					  "its nodes form no tree, or a node's number is out of range");
		w->seen[node] = true;
		w->order[w->count++] = node;
		document->loader->scene->graph->nodes[node].parent = parent;
	}
	return true;
}

/* Files without scenes: every node that is nobody's child. */
static bool take_all_roots(gltf_document *document, walk *w)
{
	const gltf_table *table = &document->tables[GLTF_NODES];
	for (uint32_t i = 0; i < table->count; i++) {
		if (!take_nodes(document, w, gltf_member(table->items[i], "children"), (int32_t)i))
			return false;
	}
	w->count = 0; /* that was only to know the children; walk_nodes finds them again */
	for (uint32_t i = 0; i < table->count; i++) {
		w->seen[i] = !w->seen[i];
		if (w->seen[i])
			w->order[w->count++] = i;
	}
	return true;
}

static bool take_roots(gltf_document *document, walk *w)
{
	int64_t scene = -1;
	if (!gltf_index(document, document->root, "scene", GLTF_SCENES, &scene))
		return false;
	if (document->tables[GLTF_SCENES].count == 0)
		return take_all_roots(document, w);
	const cJSON *chosen = document->tables[GLTF_SCENES].items[scene < 0 ? 0 : scene];
	return take_nodes(document, w, gltf_member(chosen, "nodes"), -1);
}

static bool walk_nodes(gltf_document *document, walk *w)
{
	uint32_t count = document->tables[GLTF_NODES].count;
	w->order = malloc((count + 1) * sizeof *w->order);
	w->seen = calloc(count + 1, sizeof *w->seen);
	if (!w->order || !w->seen)
		return scene_fail(document->loader, "out of memory for nodes");
	if (!take_roots(document, w))
		return false;
	for (uint32_t i = 0; i < w->count; i++) {
		const cJSON *node = document->tables[GLTF_NODES].items[w->order[i]];
		if (!take_nodes(document, w, gltf_member(node, "children"), (int32_t)w->order[i]))
			return false;
	}
	/* Without scenes all nodes belong; those of a cycle have no root that leads to them. */
	return document->tables[GLTF_SCENES].count > 0 || w->count == count ||
	       scene_fail(document->loader, "its nodes form no tree");
}

/* ---- meshes ------------------------------------------------------------------------------------------------------ */

enum { MODE_TRIANGLES = 4, MODE_STRIP = 5, MODE_FAN = 6 };

/* Corner numbers (into the primitive's list) of triangle t. */
static void triangle_corners(int mode, uint32_t t, uint32_t corners[3])
{
	corners[0] = mode == MODE_TRIANGLES ? 3 * t : mode == MODE_STRIP ? t : 0;
	corners[1] = mode == MODE_TRIANGLES ? 3 * t + 1 : mode == MODE_STRIP ? t + 1 + t % 2 : t + 1;
	corners[2] = mode == MODE_TRIANGLES ? 3 * t + 2 : mode == MODE_STRIP ? t + 2 - t % 2 : t + 2;
}

/* list NULL: the vertices in order. */
static bool make_triangles(engine_mesh *part, int mode, const uint32_t *list, uint32_t count)
{
	uint32_t triangles = mode == MODE_TRIANGLES ? count / 3 : count < 3 ? 0 : count - 2;
	part->indices = malloc((3 * (size_t)triangles + 1) * sizeof(uint32_t));
	part->face_counts = malloc(((size_t)triangles + 1) * sizeof(uint32_t));
	if (!part->indices || !part->face_counts)
		return false;
	for (uint32_t t = 0; t < triangles; t++) {
		uint32_t corners[3];
		triangle_corners(mode, t, corners);
		for (int k = 0; k < 3; k++)
			part->indices[3 * (size_t)t + k] = list ? list[corners[k]] : corners[k];
		part->face_counts[t] = 3;
	}
	part->face_count = triangles;
	part->index_count = 3 * triangles;
	return true;
}

static bool read_part(gltf_document *document, const cJSON *primitive, int mode, engine_mesh *part)
{
	int64_t positions = -1, indices = -1;
	uint32_t *list = NULL, count = 0;
	if (!gltf_index(document, gltf_member(primitive, "attributes"), "POSITION", GLTF_ACCESSORS, &positions) ||
	    !gltf_index(document, primitive, "indices", GLTF_ACCESSORS, &indices) ||
	    !gltf_floats(document, positions, 3, &part->positions, &part->vertex_count))
		return false;
	count = part->vertex_count;
	if (indices >= 0 && !gltf_indices(document, indices, &list, &count))
		return false;
	bool made = count < 1u << 30 && make_triangles(part, mode, list, count);
	free(list);
	return made || scene_fail(document->loader, "out of memory for a mesh of %u corners", count);
}

static bool material_number(gltf_document *document, const cJSON *primitive, uint32_t *number)
{
	int64_t material = -1;
	if (!gltf_index(document, primitive, "material", GLTF_MATERIALS, &material))
		return false;
	*number = (uint32_t)material;
	return material >= 0 || scene_default_material(document->loader, number);
}

static bool append_primitive(gltf_document *document, const cJSON *primitive, engine_mesh *mesh)
{
	double mode = MODE_TRIANGLES;
	uint32_t material = 0;
	if (!gltf_number(document, primitive, "mode", &mode))
		return false;
	if (mode != MODE_TRIANGLES && mode != MODE_STRIP && mode != MODE_FAN) {
		scene_warn(document->loader, "points and lines are not read");
		return true;
	}
	engine_mesh part = {0};
	bool read = material_number(document, primitive, &material) && read_part(document, primitive, (int)mode, &part);
	bool appended = read && engine_mesh_append(mesh, &part, material);
	engine_mesh_free(&part);
	if (read && !appended)
		scene_fail(document->loader, "out of memory for meshes");
	return appended;
}

static bool read_mesh(gltf_document *document, const cJSON *from, engine_mesh *mesh)
{
	const cJSON *primitive, *primitives = gltf_member(from, "primitives");
	if (!cJSON_IsArray(primitives))
		return true;
	cJSON_ArrayForEach(primitive, primitives)
	{
		if (!append_primitive(document, primitive, mesh))
			return false;
	}
	return true;
}

/* ---- objects ----------------------------------------------------------------------------------------------------- */

static bool read_scheme(gltf_document *document, const cJSON *gi, const char *name, scene_object_def *def)
{
	static const char *const schemes[] = {"bilinear", "catmull-clark", "loop"}; /* in the order of engine_scheme */
	const char *text = gltf_text(gi, "scheme");
	if (!gltf_member(gi, "scheme"))
		return true;
	for (int i = 0; text && i < 3; i++) {
		if (strcmp(text, schemes[i]) == 0) {
			def->scheme = (engine_scheme)i;
			def->pair_triangles = def->scheme != ENGINE_SCHEME_LOOP;
			return true;
		}
	}
	return scene_fail(document->loader,
			  "extras.gi.scheme of node \"%.80s\" must be \"catmull-clark\", \"loop\" or \"bilinear\"",
			  name);
}

static bool read_levels(gltf_document *document, const cJSON *gi, const char *name, scene_object_def *def)
{
	double levels = 0;
	if (!gltf_number(document, gi, "levels", &levels))
		return false;
	def->levels = (uint32_t)fmax(0, fmin(levels, ENGINE_SCENE_MAX_LEVELS));
	return levels == def->levels ||
	       scene_fail(document->loader, "extras.gi.levels of node \"%.80s\" must be a whole number of 0 to %d",
			  name, ENGINE_SCENE_MAX_LEVELS);
}

static bool read_object(gltf_document *document, uint32_t node, const cJSON *from, const cJSON *from_mesh)
{
	const cJSON *gi = gltf_member(gltf_member(from, "extras"), "gi");
	const char *name = gltf_text(from, "name");
	/* Exporters that leave nodes unnamed tend to name meshes. */
	scene_object_def def = {.name = name ? name : gltf_text(from_mesh, "name"), .node = node};
	engine_mesh mesh = {0};
	if (gltf_member(from, "skin") || gltf_member(from_mesh, "weights"))
		scene_warn(document->loader, "skins and morph targets are not read");
	const char *shown = def.name ? def.name : "";
	bool read = read_scheme(document, gi, shown, &def) && read_levels(document, gi, shown, &def) &&
		    read_mesh(document, from_mesh, &mesh);
	if (read)
		read = scene_add_object(document->loader, &def, &mesh);
	engine_mesh_free(&mesh);
	return read;
}

static bool read_camera(gltf_document *document, uint32_t node, const cJSON *from)
{
	engine_scene *scene = document->loader->scene;
	const cJSON *perspective = gltf_member(from, "perspective");
	double fov = 0;
	if (!perspective || scene->has_camera)
		return true;
	if (!gltf_number(document, perspective, "yfov", &fov))
		return false;
	if (!(fov > 0 && fov < 3.1415926))
		return scene_fail(document->loader, "a camera's yfov of %g must be above 0 and below pi", fov);
	scene->has_camera = true;
	scene->camera_node = node;
	scene->camera_fov = (float)fov;
	return true;
}

static bool read_node(gltf_document *document, uint32_t node)
{
	const cJSON *from = document->tables[GLTF_NODES].items[node];
	int64_t mesh = -1, camera = -1;
	if (!gltf_index(document, from, "mesh", GLTF_MESHES, &mesh) ||
	    !gltf_index(document, from, "camera", GLTF_CAMERAS, &camera))
		return false;
	if (camera >= 0 && !read_camera(document, node, document->tables[GLTF_CAMERAS].items[camera]))
		return false;
	return mesh < 0 || read_object(document, node, from, document->tables[GLTF_MESHES].items[mesh]);
}

/* In the order of the file, not of the walk: what the user sees in the file is what reports list. */
static bool read_scene_nodes(gltf_document *document)
{
	walk w = {0};
	bool read = walk_nodes(document, &w);
	for (uint32_t i = 0; read && i < document->tables[GLTF_NODES].count; i++) {
		if (w.seen[i])
			read = read_node(document, i);
	}
	free(w.order);
	free(w.seen);
	return read;
}

/* ---- animation --------------------------------------------------------------------------------------------------- */

static bool check_times(gltf_document *document, const scene_channel *channel)
{
	for (uint32_t i = 0; i < channel->key_count; i++) {
		float previous = i > 0 ? channel->times[i - 1] : -1;
		if (!(channel->times[i] >= 0 && channel->times[i] > previous && channel->times[i] < 1e9f))
			return scene_fail(document->loader, "an animation's times must rise from 0 s on");
	}
	return true;
}

static bool read_interpolation(gltf_document *document, const cJSON *sampler, scene_channel *channel)
{
	static const char *const names[] = {"LINEAR", "STEP", "CUBICSPLINE"}; /* in the order of scene_interpolation */
	const char *text = gltf_text(sampler, "interpolation");
	channel->interpolation = SCENE_LINEAR;
	if (!text)
		return true;
	for (int i = 0; i < 3; i++) {
		if (strcmp(text, names[i]) == 0) {
			channel->interpolation = (scene_interpolation)i;
			return true;
		}
	}
	return scene_fail(document->loader, "an animation has the unknown interpolation \"%.40s\"", text);
}

/* A rotation of zero length has no direction; between keys that are opposite there is none either, but that passes. */
static bool check_values(gltf_document *document, const scene_channel *channel, uint32_t value_count)
{
	uint32_t per_key = channel->interpolation == SCENE_CUBIC ? 3 : 1;
	if (value_count != (uint64_t)per_key * channel->key_count)
		return scene_fail(document->loader, "an animation has %u values for %u keys", value_count,
				  channel->key_count);
	for (size_t i = 0; i < (size_t)value_count * channel->components; i++) {
		if (!isfinite(channel->values[i]))
			return scene_fail(document->loader, "an animation has a value that is not finite");
	}
	return true;
}

static bool read_channel(gltf_document *document, const cJSON *sampler, uint32_t components, scene_channel *channel)
{
	int64_t input = -1, output = -1;
	uint32_t value_count = 0;
	channel->components = components;
	return read_interpolation(document, sampler, channel) &&
	       gltf_index(document, sampler, "input", GLTF_ACCESSORS, &input) &&
	       gltf_index(document, sampler, "output", GLTF_ACCESSORS, &output) &&
	       gltf_floats(document, input, 1, &channel->times, &channel->key_count) &&
	       gltf_floats(document, output, components, &channel->values, &value_count) &&
	       check_times(document, channel) && check_values(document, channel, value_count);
}

/* SCENE_PROPERTIES: nothing of a transform. */
static int property_of(const char *path)
{
	static const char *const names[SCENE_PROPERTIES] = {"translation", "rotation", "scale"};
	int property = 0;
	while (property < SCENE_PROPERTIES && !(path && strcmp(path, names[property]) == 0))
		property++;
	return property;
}

static bool store_channel(gltf_document *document, const cJSON *sampler, scene_node *node, int property)
{
	engine_scene_graph *graph = document->loader->scene->graph;
	scene_channel *grown = realloc(graph->channels, (graph->channel_count + 1) * sizeof *grown);
	if (!grown)
		return scene_fail(document->loader, "out of memory for animations");
	graph->channels = grown;
	scene_channel *channel = &grown[graph->channel_count++]; /* counted at once: freed with the scene if it fails */
	*channel = (scene_channel){0};
	if (!read_channel(document, sampler, property == SCENE_ROTATION ? 4 : 3, channel))
		return false;
	node->channels[property] = (int32_t)graph->channel_count - 1;
	double end = channel->times[channel->key_count - 1];
	document->loader->scene->duration_s = fmax(document->loader->scene->duration_s, end);
	return true;
}

static bool bind_channel(gltf_document *document, const cJSON *channel, const gltf_table *samplers)
{
	const cJSON *target = gltf_member(channel, "target");
	int property = property_of(gltf_text(target, "path"));
	int64_t node_number = -1;
	const cJSON *number = gltf_member(channel, "sampler");
	if (!gltf_index(document, target, "node", GLTF_NODES, &node_number))
		return false;
	if (node_number < 0 || property == SCENE_PROPERTIES)
		return true; /* morph weights, or the target of an extension */
	if (!cJSON_IsNumber(number) || !(number->valuedouble >= 0 && number->valuedouble < samplers->count))
		return scene_fail(document->loader, "an animation channel has no sampler");
	scene_node *node = &document->loader->scene->graph->nodes[node_number];
	if (node->has_matrix)
		return scene_fail(document->loader,
				  "an animated node has a matrix; it must have translation, rotation, scale");
	return node->channels[property] >= 0 ||
	       store_channel(document, samplers->items[(uint32_t)number->valuedouble], node, property);
}

static bool read_animation(gltf_document *document, const cJSON *from)
{
	const cJSON *item, *array = gltf_member(from, "samplers");
	gltf_table samplers = {.items = calloc((size_t)cJSON_GetArraySize(array) + 1, sizeof *samplers.items)};
	if (!samplers.items)
		return scene_fail(document->loader, "out of memory for animations");
	cJSON_ArrayForEach(item, array) samplers.items[samplers.count++] = item;
	bool read = true;
	cJSON_ArrayForEach(item, gltf_member(from, "channels")) read = read && bind_channel(document, item, &samplers);
	free(samplers.items);
	return read;
}

/* ---- all of it --------------------------------------------------------------------------------------------------- */

static bool for_all(gltf_document *document, gltf_array array, bool (*read)(gltf_document *, const cJSON *))
{
	const gltf_table *table = &document->tables[array];
	for (uint32_t i = 0; i < table->count; i++) {
		if (!read(document, table->items[i]))
			return false;
	}
	return true;
}

/* Animations before objects: an object's poses are checked at its keys. */
bool scene_read_gltf(scene_loader *loader)
{
	gltf_document document;
	bool read = gltf_open(&document, loader) && for_all(&document, GLTF_MATERIALS, read_material) &&
		    read_nodes(&document) && for_all(&document, GLTF_ANIMATIONS, read_animation) &&
		    read_scene_nodes(&document);
	gltf_close(&document);
	return read;
}
