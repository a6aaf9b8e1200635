/* Objects of a glTF scene: the nodes that have a mesh, each instance of EXT_mesh_gpu_instancing one of its own. */
#include "gltf_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* An object takes as much as so many corners of a face. */
enum { CORNERS_OF_OBJECT = 64 };

/* ---- how much there will be -------------------------------------------------------------------------------------- */

static const char *const instance_properties[IMPORT_PROPERTIES] = {"TRANSLATION", "ROTATION", "SCALE"};

/* Attributes of a node's instances, or NULL. */
static const cJSON *instance_attributes(const cJSON *node)
{
	return gltf_member(gltf_extension(node, "EXT_mesh_gpu_instancing"), "attributes");
}

static const gltf_accessor *instance_accessor(const gltf_document *document, const cJSON *attributes, int property)
{
	int64_t number = -1;
	const char *fault;
	if (!gltf_index(document, attributes, instance_properties[property], GLTF_ACCESSORS, &number))
		return NULL;
	return gltf_find_accessor(document, number, property == IMPORT_ROTATION ? 4 : 3, &fault);
}

/* Accessors of a node's instances, NULL where one has none, and as many as the shortest of them has; 1 without. */
typedef struct instances {
	const gltf_accessor *properties[IMPORT_PROPERTIES];
	uint32_t count;
} instances;

static instances find_instances(const gltf_document *document, const cJSON *attributes)
{
	instances all = {.count = UINT32_MAX};
	for (int property = 0; property < IMPORT_PROPERTIES; property++) {
		all.properties[property] = instance_accessor(document, attributes, property);
		if (all.properties[property] && all.properties[property]->count < all.count)
			all.count = all.properties[property]->count;
	}
	all.count = all.count < UINT32_MAX ? all.count : 1;
	return all;
}

/* Adds what a node's objects will take; false where it has none. */
static bool count_node(const gltf_document *document, gltf_objects *objects, const cJSON *node)
{
	int64_t mesh = -1, skin = -1;
	if (!gltf_index(document, node, "mesh", GLTF_MESHES, &mesh) || mesh < 0)
		return false;
	const cJSON *attributes = instance_attributes(node);
	uint64_t count = find_instances(document, attributes).count;
	objects->uses[mesh] += 1;
	objects->corners += count * (objects->mesh_corners[mesh] + CORNERS_OF_OBJECT);
	if (gltf_index(document, node, "skin", GLTF_SKINS, &skin) && skin >= 0)
		objects->corners += objects->skin_corners[skin];
	objects->node_count += attributes ? (uint32_t)count : 0;
	return true;
}

bool gltf_count_objects(gltf_document *document, gltf_objects *objects)
{
	const gltf_table *nodes = &document->tables[GLTF_NODES], *meshes = &document->tables[GLTF_MESHES];
	const gltf_table *skins = &document->tables[GLTF_SKINS];
	uint64_t budget = gltf_budget(document);
	objects->mesh_corners = calloc((size_t)meshes->count + 1, sizeof *objects->mesh_corners);
	objects->meshes = calloc((size_t)meshes->count + 1, sizeof *objects->meshes);
	objects->uses = calloc((size_t)meshes->count + 1, sizeof *objects->uses);
	objects->skin_corners = calloc((size_t)skins->count + 1, sizeof *objects->skin_corners);
	if (!objects->mesh_corners || !objects->meshes || !objects->uses || !objects->skin_corners)
		return import_fail(document->loader, "out of memory for meshes");
	/* Members too: each node that has a skin or weights goes through them again. */
	for (uint32_t m = 0; m < meshes->count; m++)
		objects->mesh_corners[m] =
		    gltf_count_corners(document, meshes->items[m]) + (uint64_t)cJSON_GetArraySize(meshes->items[m]);
	for (uint32_t k = 0; k < skins->count; k++)
		objects->skin_corners[k] = (uint64_t)cJSON_GetArraySize(skins->items[k]) +
					   (uint64_t)cJSON_GetArraySize(gltf_member(skins->items[k], "joints"));
	objects->node_count = nodes->count + 1; /* one for what lies in world space */
	for (uint32_t n = 0; n < nodes->count && objects->corners < UINT64_MAX / 2; n++)
		count_node(document, objects, nodes->items[n]);
	/* 24 bytes a corner while a mesh is read */
	return objects->corners <= budget ||
	       import_fail(
		   document->loader,
		   "its nodes place so many copies of its meshes that they need %.3g GB (%llu corners of faces); "
		   "from a file of this size at most %llu corners are read",
		   24e-9 * (double)objects->corners, (unsigned long long)objects->corners, (unsigned long long)budget);
}

void gltf_free_objects(const gltf_document *document, gltf_objects *objects)
{
	for (uint32_t m = 0; objects->meshes && m < document->tables[GLTF_MESHES].count; m++)
		engine_mesh_free(&objects->meshes[m]);
	free(objects->mesh_corners);
	free(objects->skin_corners);
	free(objects->meshes);
	free(objects->uses);
	*objects = (gltf_objects){0};
}

/* ---- refinement -------------------------------------------------------------------------------------------------- */

static void read_scheme(gltf_document *document, const cJSON *gi, import_object_def *def)
{
	static const char *const schemes[] = {"bilinear", "catmull-clark", "loop"}; /* in the order of engine_scheme */
	const char *text = gltf_text(gi, "scheme");
	if (!gltf_member(gi, "scheme"))
		return;
	for (int i = 0; text && i < 3; i++) {
		if (strcmp(text, schemes[i]) == 0) {
			def->scheme = (engine_scheme)i;
			def->pair_triangles = def->scheme != ENGINE_SCHEME_LOOP;
			return;
		}
	}
	import_note(document->loader, def->name,
		    "extras.gi.scheme other than \"catmull-clark\", \"loop\" or \"bilinear\" is taken as bilinear");
}

static void read_levels(gltf_document *document, const cJSON *gi, import_object_def *def)
{
	double levels = 0;
	bool sound = gltf_number(gi, "levels", &levels);
	def->levels = (uint32_t)fmax(0, fmin(levels, ENGINE_SCENE_MAX_LEVELS));
	if (!sound || levels != def->levels)
		import_note(document->loader, def->name,
			    "extras.gi.levels that are no whole number of 0 to %d are cut to it",
			    ENGINE_SCENE_MAX_LEVELS);
}

/* ---- meshes ------------------------------------------------------------------------------------------------------ */

/* The mesh as a node without skin and weights of its own has it: read once, then copied, handed over at last. */
static bool shared_mesh(gltf_document *document, gltf_objects *objects, int64_t number, bool last, const char *name,
			engine_mesh *out)
{
	engine_mesh *kept = &objects->meshes[number];
	if (!kept->positions &&
	    !gltf_read_mesh(document, document->tables[GLTF_MESHES].items[number], NULL, NULL, name, kept, NULL))
		return false;
	if (last) {
		*out = *kept;
		*kept = (engine_mesh){0};
		return true;
	}
	return engine_mesh_copy(kept, out) || import_fail(document->loader, "out of memory for meshes");
}

static bool any_joint_moves(const engine_scene_graph *graph, const gltf_skin *skin)
{
	bool moves = false;
	for (uint32_t j = 0; j < skin->joint_count && !moves; j++)
		moves = graph->nodes[skin->nodes[j]].moves;
	return moves;
}

/* What moves the vertices of a node's mesh; takes the skin's arrays. *out stays NULL where nothing does. False: out of
 * memory (reported).
 */
static bool begin_shape(gltf_document *document, const cJSON *mesh, uint32_t node, gltf_skin *skin, const char *name,
			import_shape **out)
{
	const engine_scene_graph *graph = document->loader->scene->graph;
	const int32_t weights = graph->nodes[node].weights_channel;
	uint32_t targets = gltf_count_targets(document, node);
	if (weights < 0 && !any_joint_moves(graph, skin))
		return true;
	targets = targets <= IMPORT_MOST_TARGETS ? targets : 0;
	document->floats_read += 3 * (uint64_t)targets * gltf_count_corners(document, mesh);
	if (document->floats_read > gltf_budget(document)) {
		import_note(document->loader, name, "shapes that move are left out: they would take too much memory");
		return true;
	}
	import_shape *shape = calloc(1, sizeof *shape);
	if (!shape)
		return import_fail(document->loader, "out of memory for shapes that move");
	*shape = (import_shape){.joint_count = skin->joint_count,
				.nodes = skin->nodes,
				.inverse = skin->inverse,
				.matrices = skin->matrices,
				.target_count = targets,
				.weights_channel = weights};
	*skin = (gltf_skin){.matrices = skin->matrices, .joint_count = skin->joint_count};
	*out = shape;
	return true;
}

/* A mesh of a node that has a skin, or weights of its own. With a skin it is in world space, as the joints are at rest;
 * the node's own place does not count then.
 */
static bool moving_mesh(gltf_document *document, uint32_t node, int64_t mesh_number, int64_t skin_number,
			import_object_def *def, engine_mesh *out)
{
	const cJSON *from = document->tables[GLTF_NODES].items[node];
	const cJSON *mesh = document->tables[GLTF_MESHES].items[mesh_number];
	gltf_skin skin = {0};
	const char *fault;
	bool sound = skin_number >= 0 && gltf_read_skin(document, skin_number, &skin, &fault);
	if (skin_number >= 0 && !sound) {
		import_note(document->loader, def->name, "skins are left out: %s", fault);
		skin.joint_count = 0;
	}
	bool read = begin_shape(document, mesh, node, &skin, def->name, &def->shape);
	if (sound) {
		def->node = document->loader->scene->graph->node_count - 1;
		if (!def->shape)
			import_note(document->loader, def->name, "skins are read as they are at rest");
	}
	read = read && gltf_read_mesh(document, mesh, from, sound ? &skin : NULL, def->name, out, def->shape);
	if (!def->shape)
		free(skin.matrices);
	free(skin.inverse);
	free(skin.nodes);
	return read;
}

/* ---- objects ----------------------------------------------------------------------------------------------------- */

/* Gives node `to` the place of an instance below its node. */
static void place_instance(const instances *all, uint32_t instance, int32_t parent, import_node *to)
{
	double *const values[IMPORT_PROPERTIES] = {to->translation, to->rotation, to->scale};
	to->parent = parent;
	for (int property = 0; property < IMPORT_PROPERTIES; property++) {
		if (all->properties[property])
			gltf_element(all->properties[property], instance, values[property]);
	}
	double *q = to->rotation, length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
	for (int c = 0; c < 4; c++)
		q[c] /= length; /* of length 0: no pose, and left out with those of scale 0 */
}

static bool add_instances(gltf_document *document, gltf_objects *objects, const cJSON *from, int64_t mesh,
			  import_object_def *def)
{
	engine_scene_graph *graph = document->loader->scene->graph;
	const cJSON *attributes = instance_attributes(from);
	const instances all = find_instances(document, attributes);
	uint32_t node = def->node;
	bool last_use = --objects->uses[mesh] == 0, added = true;
	for (uint32_t i = 0; i < all.count && added; i++) {
		engine_mesh copy = {0};
		added = shared_mesh(document, objects, mesh, last_use && i + 1 == all.count, def->name, &copy);
		if (attributes) {
			def->node = objects->next_node++;
			graph->order[graph->order_count++] = def->node;
			place_instance(&all, i, (int32_t)node, &graph->nodes[def->node]);
		}
		added = added && import_add_object(document->loader, def, &copy);
		engine_mesh_free(&copy);
	}
	return added;
}

static bool add_one(gltf_document *document, uint32_t node, int64_t mesh, int64_t skin, import_object_def *def)
{
	engine_mesh own = {0};
	bool read = moving_mesh(document, node, mesh, skin, def, &own);
	if (!read)
		import_free_shape(def->shape);
	read = read && import_add_object(document->loader, def, &own);
	engine_mesh_free(&own);
	return read;
}

static bool read_object(gltf_document *document, gltf_objects *objects, uint32_t node)
{
	const cJSON *from = document->tables[GLTF_NODES].items[node];
	int64_t mesh = -1, skin = -1;
	const char *name = gltf_text(from, "name");
	if (!gltf_index(document, from, "mesh", GLTF_MESHES, &mesh) ||
	    !gltf_index(document, from, "skin", GLTF_SKINS, &skin)) {
		import_note(document->loader, name, "meshes or skins that the file does not hold are left out");
		document->loader->meshes_broken = true;
	}
	if (mesh < 0)
		return true;
	/* Exporters that leave nodes unnamed tend to name meshes. */
	import_object_def def = {.name = name ? name : gltf_text(document->tables[GLTF_MESHES].items[mesh], "name"),
				 .node = node};
	const cJSON *gi = gltf_member(gltf_member(from, "extras"), "gi");
	read_scheme(document, gi, &def);
	read_levels(document, gi, &def);
	if (skin >= 0 || gltf_member(from, "weights") ||
	    document->loader->scene->graph->nodes[node].weights_channel >= 0) {
		objects->uses[mesh]--;
		return add_one(document, node, mesh, skin, &def);
	}
	return add_instances(document, objects, from, mesh, &def);
}

bool gltf_read_objects(gltf_document *document, gltf_objects *objects, const bool *in_scene)
{
	import_mark_moving(document->loader->scene->graph);
	import_pose_graph(document->loader->scene->graph, NULL); /* for skins */
	objects->next_node = document->tables[GLTF_NODES].count;
	for (uint32_t n = 0; n < document->tables[GLTF_NODES].count; n++) {
		if (in_scene[n] && !read_object(document, objects, n))
			return false;
	}
	document->loader->scene->graph->posed = false; /* instances came */
	return true;
}
