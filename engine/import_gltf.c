/* glTF 2.0 to a scene: nodes, their tree, cameras; other files of gltf_scene.h read what hangs on them. */
#include "import_gltf.h"

#include "gltf_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- nodes ------------------------------------------------------------------------------------------------------- */

/* NULL, or what is wrong with the transform. */
static const char *read_transform(const cJSON *from, import_node *node)
{
	const double *m = node->matrix;
	node->has_matrix = gltf_member(from, "matrix") != NULL;
	if (!gltf_numbers(from, "matrix", 16, node->matrix) ||
	    !gltf_numbers(from, "translation", 3, node->translation) ||
	    !gltf_numbers(from, "rotation", 4, node->rotation) || !gltf_numbers(from, "scale", 3, node->scale))
		return "it holds what is no finite number, or too few or many";
	/* A projection, which no body has. */
	if (node->has_matrix && (fmax(fabs(m[3]), fmax(fabs(m[7]), fabs(m[11]))) > 1e-6 || fabs(m[15] - 1) > 1e-6))
		return "the last row of its matrix is not 0 0 0 1";
	return NULL;
}

/* glTF lets a rotation be a unit quaternion only; files round. False: it has no direction. */
static bool normalize_rotation(import_node *node)
{
	double *q = node->rotation, length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
	bool sound = length > 1e-6 && length < 1e6;
	for (int c = 0; c < 4; c++)
		q[c] = sound ? q[c] / length : c == 3;
	return sound;
}

/* A node whose transform makes no sense hides what is below it, as a scale of 0 does. */
static void read_node_transform(gltf_document *document, const cJSON *from, import_node *node)
{
	const char *fault = read_transform(from, node);
	const char *name = gltf_text(from, "name");
	if (!normalize_rotation(node))
		import_note(document->loader, name, "rotations that are no unit quaternion are taken as none");
	if (!fault)
		return;
	import_note(document->loader, name, "nodes are left out with all below them: %s", fault);
	*node = import_node_default();
	node->scale[0] = node->scale[1] = node->scale[2] = 0;
}

/* Breadth first over the scene's nodes, without recursion: files nest as deep as they like. */
typedef struct walk {
	uint32_t *order; /* the graph's: nodes in the order found; also the queue */
	uint32_t count;
	bool *seen; /* by node: belongs to the scene */
} walk;

/* Takes the node numbers of an array member. Each node belongs to one parent, which excludes cycles too. */
static void take_nodes(gltf_document *document, walk *w, const cJSON *array, int32_t parent)
{
	const cJSON *item;
	cJSON_ArrayForEach(item, array)
	{
		double value = cJSON_IsNumber(item) ? item->valuedouble : -1;
		uint32_t node = (uint32_t)fmax(0, fmin(value, 4e9));
		if (value != node || node >= document->tables[GLTF_NODES].count || w->seen[node]) {
			import_note(document->loader, NULL,
				    "children that are no node, or another's child already, are left out");
			continue;
		}
		w->seen[node] = true;
		w->order[w->count++] = node;
		document->loader->scene->graph->nodes[node].parent = parent;
	}
}

/* Files without scenes: every node that is nobody's child. */
static void take_all_roots(gltf_document *document, walk *w)
{
	const gltf_table *table = &document->tables[GLTF_NODES];
	const cJSON *item;
	for (uint32_t i = 0; i < table->count; i++) {
		cJSON_ArrayForEach(item, gltf_member(table->items[i], "children"))
		{
			double value = cJSON_IsNumber(item) ? item->valuedouble : -1;
			if (value >= 0 && value < table->count)
				w->seen[(uint32_t)value] = true;
		}
	}
	for (uint32_t i = 0; i < table->count; i++) {
		w->seen[i] = !w->seen[i];
		if (w->seen[i])
			w->order[w->count++] = i;
	}
}

/* The scene that the file chooses, or its first; NULL: it has none. */
static const cJSON *chosen_scene(const gltf_document *document)
{
	int64_t scene = -1;
	const gltf_table *scenes = &document->tables[GLTF_SCENES];
	gltf_index(document, document->root, "scene", GLTF_SCENES, &scene);
	return scenes->count > 0 ? scenes->items[scene < 0 ? 0 : scene] : NULL;
}

static void take_roots(gltf_document *document, walk *w)
{
	int64_t scene;
	const cJSON *chosen = chosen_scene(document);
	if (!gltf_index(document, document->root, "scene", GLTF_SCENES, &scene))
		import_note(document->loader, NULL, "the scene that the file chooses is not there; the first is read");
	if (chosen)
		take_nodes(document, w, gltf_member(chosen, "nodes"), -1);
	else
		take_all_roots(document, w);
}

/* Leaves the graph's order with the nodes of the scene alone. Those of a cycle have no root that leads to them. */
static void walk_nodes(gltf_document *document, walk *w)
{
	engine_scene_graph *graph = document->loader->scene->graph;
	take_roots(document, w);
	for (uint32_t i = 0; i < w->count; i++) {
		const cJSON *node = document->tables[GLTF_NODES].items[w->order[i]];
		take_nodes(document, w, gltf_member(node, "children"), (int32_t)w->order[i]);
	}
	if (document->tables[GLTF_SCENES].count == 0)
		import_note_many(document->loader, document->tables[GLTF_NODES].count - w->count, NULL,
				 "nodes that are their own parents are left out");
	graph->order_count = w->count;
}

/* ---- the scene --------------------------------------------------------------------------------------------------- */

static void read_camera(gltf_document *document, uint32_t node, const cJSON *from)
{
	engine_scene *scene = document->loader->scene;
	const cJSON *perspective = gltf_member(from, "perspective");
	double fov = 0;
	if (!perspective)
		import_note(document->loader, gltf_text(from, "name"),
			    "cameras without perspective (orthographic ones) are not read");
	else if (!gltf_number(perspective, "yfov", &fov) || !(fov > 0 && fov < 3.1415926))
		import_note(document->loader, gltf_text(from, "name"),
			    "cameras whose yfov is not above 0 and below pi are left out");
	else if (!scene->has_camera) {
		scene->has_camera = true;
		scene->camera_node = node;
		scene->camera_fov = (float)fov;
	}
}

/* In the order of the file, not of the walk: what the user sees in the file is what reports list. Each camera once. */
static bool read_cameras(gltf_document *document, const walk *w)
{
	bool *known = calloc((size_t)document->tables[GLTF_CAMERAS].count + 1, sizeof *known);
	for (uint32_t i = 0; known && i < document->tables[GLTF_NODES].count; i++) {
		int64_t camera = -1;
		if (!w->seen[i])
			continue;
		if (!gltf_index(document, document->tables[GLTF_NODES].items[i], "camera", GLTF_CAMERAS, &camera))
			import_note(document->loader, NULL, "cameras that the file does not hold are left out");
		if (camera >= 0 && !known[camera])
			read_camera(document, i, document->tables[GLTF_CAMERAS].items[camera]);
		known[camera < 0 ? document->tables[GLTF_CAMERAS].count : (uint32_t)camera] = true;
	}
	bool read = known || import_fail(document->loader, "out of memory for cameras");
	free(known);
	return read;
}

static bool read_scene(gltf_document *document, gltf_objects *objects)
{
	import_loader *loader = document->loader;
	const gltf_table *nodes = &document->tables[GLTF_NODES];
	walk w = {.seen = calloc((size_t)nodes->count + 1, sizeof *w.seen)};
	if (!w.seen)
		return import_fail(loader, "out of memory for nodes");
	bool read = gltf_count_objects(document, objects) && import_make_graph(loader, objects->node_count);
	if (read) {
		w.order = loader->scene->graph->order;
		for (uint32_t i = 0; i < nodes->count; i++)
			read_node_transform(document, nodes->items[i], &loader->scene->graph->nodes[i]);
		walk_nodes(document, &w);
		read = read_cameras(document, &w) && gltf_read_animations(document) &&
		       gltf_read_objects(document, objects, w.seen) && gltf_read_lights(document, w.seen) &&
		       gltf_read_sky(document, chosen_scene(document));
	}
	free(w.seen);
	return read;
}

bool import_read_gltf(import_loader *loader)
{
	gltf_document document;
	gltf_objects objects = {0};
	bool read = gltf_open(&document, loader) &&
		    (gltf_place_accessors(&document) || import_fail(loader, "out of memory for accessors")) &&
		    read_scene(&document, &objects);
	gltf_free_objects(&document, &objects);
	gltf_close(&document);
	return read;
}
