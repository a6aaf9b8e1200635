/* Lights of KHR_lights_punctual: which nodes have one. What is broken of a light costs it alone. */
#include "gltf_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double HALF_PI = 1.5707963267948966;

/* Brighter ones the library does not take, W/sr and W/m2. */
static const double BRIGHTEST = 1e12;

static bool read_type(const cJSON *from, engine_scene_light *light)
{
	static const char *const names[] = {"point", "spot", "directional"}; /* in the order of engine_light_type */
	const char *text = gltf_text(from, "type");
	for (int k = 0; text && k < 3; k++) {
		light->type = (engine_light_type)k;
		if (strcmp(text, names[k]) == 0)
			return true;
	}
	return false;
}

/* NULL, or what is wrong with them. */
static const char *read_intensity(const cJSON *from, engine_scene_light *light)
{
	double color[3] = {1, 1, 1}, intensity = 1, range = 0;
	if (!gltf_numbers(from, "color", 3, color) || !gltf_number(from, "intensity", &intensity) ||
	    !gltf_number(from, "range", &range))
		return "its color, intensity or range is no finite number";
	if (!(intensity >= 0 && fmin(color[0], fmin(color[1], color[2])) >= 0 && range >= 0))
		return "its color, intensity or range is below 0";
	for (int c = 0; c < 3; c++)
		light->intensity[c] = (float)fmin(ENGINE_WATTS_PER_LUMEN * intensity * color[c], BRIGHTEST);
	light->range = (float)fmin(range, 1e9);
	return NULL;
}

static const char *read_cone(const cJSON *from, engine_scene_light *light)
{
	const cJSON *spot = gltf_member(from, "spot");
	double inner = 0, outer = HALF_PI / 2;
	if (light->type != ENGINE_LIGHT_SPOT)
		return NULL;
	if (!gltf_number(spot, "innerConeAngle", &inner) || !gltf_number(spot, "outerConeAngle", &outer) ||
	    !(inner >= 0 && inner < outer && outer <= HALF_PI + 1e-6))
		return "its cone angles are not 0 <= inner < outer <= pi/2";
	light->outer_angle = (float)fmin(outer, HALF_PI);
	light->inner_angle = (float)inner < light->outer_angle ? (float)inner : 0.999f * light->outer_angle;
	return NULL;
}

/* The lights that the file lists. */
typedef struct light_table {
	engine_scene_light *items;
	const char **faults; /* NULL: it is one */
	const char **names;
	uint32_t count;
} light_table;

static bool read_table(gltf_document *document, light_table *table)
{
	const cJSON *array = gltf_member(gltf_extension(document->root, "KHR_lights_punctual"), "lights"), *item;
	const size_t count = (size_t)cJSON_GetArraySize(array) + 1;
	table->items = calloc(count, sizeof *table->items);
	table->faults = calloc(count, sizeof *table->faults);
	table->names = calloc(count, sizeof *table->names);
	if (!table->items || !table->faults || !table->names)
		return import_fail(document->loader, "out of memory for lights");
	cJSON_ArrayForEach(item, array)
	{
		engine_scene_light *light = &table->items[table->count];
		const char *fault = read_type(item, light) ? NULL : "its type is unknown";
		if (!fault)
			fault = read_intensity(item, light);
		if (!fault)
			fault = read_cone(item, light);
		table->faults[table->count] = fault;
		table->names[table->count++] = gltf_text(item, "name");
	}
	return true;
}

/* Room for one more doubles at 1, 2, 4, ... of them. */
static bool add_light(gltf_document *document, const engine_scene_light *light, const char *name, uint32_t node)
{
	engine_scene *scene = document->loader->scene;
	const size_t count = scene->light_count;
	if ((count & (count - 1)) == 0) {
		engine_scene_light *grown = realloc(scene->lights, (count ? 2 * count : 1) * sizeof *grown);
		if (!grown)
			return import_fail(document->loader, "out of memory for lights");
		scene->lights = grown;
	}
	engine_scene_light *to = &scene->lights[count];
	*to = *light;
	to->node = node;
	to->animated = scene->graph->nodes[node].moves;
	to->name = import_copy_name(name, "light", (uint32_t)count);
	if (!to->name)
		return import_fail(document->loader, "out of memory for lights");
	scene->light_count++;
	return true;
}

static bool read_node(gltf_document *document, const light_table *table, uint32_t n)
{
	const cJSON *node = document->tables[GLTF_NODES].items[n];
	const cJSON *extension = gltf_extension(node, "KHR_lights_punctual");
	double number = -1;
	if (!extension)
		return true;
	if (!gltf_number(extension, "light", &number) || !(number >= 0 && number < table->count) ||
	    number != floor(number)) {
		import_note(document->loader, document->node_names[n],
			    "lights that the file does not hold are left out");
		return true;
	}
	const uint32_t k = (uint32_t)number;
	const char *name = document->node_names[n] ? document->node_names[n] : table->names[k];
	if (!table->faults[k])
		return add_light(document, &table->items[k], name, n);
	import_note(document->loader, name, "lights are left out: %s", table->faults[k]);
	return true;
}

bool gltf_read_lights(gltf_document *document, const bool *in_scene)
{
	light_table table = {0};
	bool read = read_table(document, &table);
	for (uint32_t n = 0; read && n < document->tables[GLTF_NODES].count; n++)
		read = !in_scene[n] || read_node(document, &table, n);
	free(table.items);
	free(table.faults);
	free(table.names);
	return read;
}
