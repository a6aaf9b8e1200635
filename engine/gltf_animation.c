/* Animations of a glTF file: channels with their keys, bound to nodes. A channel that cannot be read is left out. */
#include "gltf_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of two keys of one time the last counts: exporters round. Values move with their times. */
static uint32_t drop_equal_times(import_channel *channel)
{
	uint32_t parts = channel->interpolation == IMPORT_CUBIC ? 3 : 1, kept = 0;
	size_t size = (size_t)parts * channel->components;
	for (uint32_t i = 0; i < channel->key_count; i++) {
		if (kept > 0 && channel->times[i] == channel->times[kept - 1])
			kept--;
		channel->times[kept] = channel->times[i];
		memmove(channel->values + kept * size, channel->values + i * size, size * sizeof(float));
		kept++;
	}
	uint32_t dropped = channel->key_count - kept;
	channel->key_count = kept;
	return dropped;
}

/* NULL, or what is wrong with them. */
static const char *fault_of_times(const import_channel *channel)
{
	for (uint32_t i = 0; i < channel->key_count; i++) {
		float previous = i > 0 ? channel->times[i - 1] : 0;
		if (!(channel->times[i] >= previous && channel->times[i] < 1e9f))
			return "its times must rise from 0 s on, to less than 1e9 s";
	}
	return NULL;
}

static bool read_interpolation(const cJSON *sampler, import_channel *channel)
{
	static const char *const names[] = {"LINEAR", "STEP", "CUBICSPLINE"}; /* in the order of import_interpolation */
	const char *text = gltf_text(sampler, "interpolation");
	for (int i = 0; i < 3; i++) {
		channel->interpolation = (import_interpolation)i;
		if (strcmp(text ? text : names[0], names[i]) == 0)
			return true;
	}
	return false;
}

/* A rotation of zero length has no direction; between keys that are opposite there is none either, but that passes. */
static const char *fault_of_values(const import_channel *channel)
{
	uint32_t parts = channel->interpolation == IMPORT_CUBIC ? 3 : 1;
	for (size_t i = 0; i < (size_t)channel->key_count * parts; i++) {
		const float *values = channel->values + i * channel->components;
		float length2 = 0;
		for (uint32_t c = 0; c < channel->components; c++)
			length2 += values[c] * values[c];
		if (!isfinite(length2))
			return "it has a value that is not finite";
		bool is_value = parts == 1 || i % 3 == 1; /* tangents may be zero */
		if (channel->turns && is_value && !(length2 > 1e-12f))
			return "it has a rotation of length 0";
	}
	return NULL;
}

/* Of what a channel's values are: weights of morph targets are single numbers, as many a key as there are targets. */
typedef struct value_kind {
	uint32_t components;
	bool turns, weights;
} value_kind;

/* NULL, or what is wrong. Values beyond the keys' are not looked at. */
static const char *read_channel(const gltf_document *document, const cJSON *sampler, value_kind kind,
				import_channel *channel)
{
	int64_t input = -1, output = -1;
	const char *fault;
	channel->components = kind.components;
	channel->turns = kind.turns;
	if (!read_interpolation(sampler, channel))
		return "its interpolation is unknown";
	if (!gltf_index(document, sampler, "input", GLTF_ACCESSORS, &input) ||
	    !gltf_index(document, sampler, "output", GLTF_ACCESSORS, &output))
		return "it names an accessor that is not there";
	const gltf_accessor *times = gltf_find_accessor(document, input, 1, &fault);
	const gltf_accessor *values =
	    times ? gltf_find_accessor(document, output, kind.weights ? 1 : kind.components, &fault) : NULL;
	if (!values)
		return fault;
	uint64_t parts = channel->interpolation == IMPORT_CUBIC ? 3 : 1, each = kind.weights ? kind.components : 1;
	if (values->count < parts * each * times->count)
		return "it has fewer values than keys";
	channel->times = gltf_floats(times);
	channel->values = gltf_floats(values);
	channel->key_count = times->count;
	if (!channel->times || !channel->values)
		return "there is no memory for it";
	fault = fault_of_times(channel);
	return fault ? fault : fault_of_values(channel);
}

/* IMPORT_PROPERTIES: nothing of a transform. */
static int property_of(const char *path)
{
	static const char *const names[IMPORT_PROPERTIES] = {"translation", "rotation", "scale"};
	int property = 0;
	while (property < IMPORT_PROPERTIES && !(path && strcmp(path, names[property]) == 0))
		property++;
	return property;
}

/* The samplers of one animation, each read once however many channels play it. */
typedef struct sampler {
	const cJSON *from;
	/* In the graph, of 3 components, of rotations and of weights; -1: not read, -2: left out */
	int32_t channels[3];
} sampler;

typedef struct samplers {
	sampler *items;
	uint32_t count;
} samplers;

/* Floats that a file's channels may take together: what its bytes can hold 64 times over. */
static bool within_budget(gltf_document *document, const cJSON *from)
{
	int64_t input = -1, output = -1;
	gltf_index(document, from, "input", GLTF_ACCESSORS, &input);
	gltf_index(document, from, "output", GLTF_ACCESSORS, &output);
	if (input >= 0)
		document->floats_read += document->accessors[input].count;
	if (output >= 0)
		document->floats_read += 4 * (uint64_t)document->accessors[output].count;
	return document->floats_read <= gltf_budget(document);
}

/* Appends to the graph's channels. False: out of memory (reported). */
static bool add_channel(gltf_document *document, const cJSON *from, value_kind kind, const char *subject,
			int32_t *number)
{
	engine_scene_graph *graph = document->loader->scene->graph;
	import_channel channel = {0};
	*number = -2;
	const char *fault = within_budget(document, from) ? read_channel(document, from, kind, &channel)
							  : "the animations would take too much memory";
	import_channel *grown =
	    fault ? NULL : realloc(graph->channels, (graph->channel_count + 1) * sizeof *graph->channels);
	if (grown) {
		import_note_many(document->loader, drop_equal_times(&channel), subject,
				 "animation keys of equal times are dropped but for the last");
		graph->channels = grown;
		graph->channels[graph->channel_count] = channel;
		*number = (int32_t)graph->channel_count++;
		return true;
	}
	free(channel.times);
	free(channel.values);
	if (!fault)
		return import_fail(document->loader, "out of memory for animations");
	import_note(document->loader, subject, "animation channels are left out: %s", fault);
	return true;
}

/* The channel of a sampler goes to *number, -2: it is left out. False: out of memory (reported). */
static bool play(gltf_document *document, sampler *from, value_kind kind, int32_t *number, const char *subject)
{
	engine_scene *scene = document->loader->scene;
	int32_t *read = &from->channels[kind.weights ? 2 : kind.turns ? 1 : 0];
	if (*read == -1 && !add_channel(document, from->from, kind, subject, read))
		return false;
	if (*read < 0)
		return true;
	const import_channel *channel = &scene->graph->channels[*read];
	if (channel->components != kind.components) {
		import_note(document->loader, subject,
			    "animations of morph targets that meshes of other targets share are left out");
		return true;
	}
	*number = *read;
	scene->duration_s = fmax(scene->duration_s, (double)channel->times[channel->key_count - 1]);
	return true;
}

static bool bind_weights(gltf_document *document, sampler *from, int64_t number, const char *name)
{
	import_node *node = &document->loader->scene->graph->nodes[number];
	const uint32_t targets = gltf_count_targets(document, number);
	if (targets == 0 || targets > IMPORT_MOST_TARGETS)
		import_note(document->loader, name,
			    "animations of morph targets of meshes without any, or with more than %d, are left out",
			    IMPORT_MOST_TARGETS);
	else if (node->weights_channel >= 0)
		import_note(document->loader, name,
			    "further animations of one property are left out: the first counts");
	else
		return play(document, from, (value_kind){targets, false, true}, &node->weights_channel, name);
	return true;
}

static bool bind_channel(gltf_document *document, const cJSON *channel, const samplers *all)
{
	const cJSON *target = gltf_member(channel, "target"), *number = gltf_member(channel, "sampler");
	const char *path = gltf_text(target, "path");
	int property = property_of(path);
	int64_t node_number = -1;
	bool found = gltf_index(document, target, "node", GLTF_NODES, &node_number);
	double wanted = cJSON_IsNumber(number) ? number->valuedouble : -1;
	if (found && node_number < 0)
		return true; /* the target of an extension, which is told */
	const char *name = found ? document->node_names[node_number] : NULL;
	if (found && path && strcmp(path, "weights") == 0 && wanted >= 0 && wanted < all->count)
		return bind_weights(document, &all->items[(uint32_t)wanted], node_number, name);
	if (!found || property == IMPORT_PROPERTIES || !(wanted >= 0 && wanted < all->count))
		import_note(document->loader, name,
			    "animation channels without a node, a property or a sampler are left out");
	else if (document->loader->scene->graph->nodes[node_number].has_matrix)
		import_note(
		    document->loader, name,
		    "animations of nodes with a matrix are left out; they must have translation, rotation, scale");
	else if (document->loader->scene->graph->nodes[node_number].channels[property] >= 0)
		import_note(document->loader, name,
			    "further animations of one property are left out: the first counts");
	else
		return play(document, &all->items[(uint32_t)wanted],
			    (value_kind){property == IMPORT_ROTATION ? 4 : 3, property == IMPORT_ROTATION, false},
			    &document->loader->scene->graph->nodes[node_number].channels[property], name);
	return true;
}

static bool read_animation(gltf_document *document, const cJSON *from)
{
	const cJSON *item, *array = gltf_member(from, "samplers");
	samplers all = {.items = calloc((size_t)cJSON_GetArraySize(array) + 1, sizeof *all.items)};
	if (!all.items)
		return import_fail(document->loader, "out of memory for animations");
	cJSON_ArrayForEach(item, array) all.items[all.count++] = (sampler){item, {-1, -1, -1}};
	bool read = true;
	cJSON_ArrayForEach(item, gltf_member(from, "channels")) read = read && bind_channel(document, item, &all);
	free(all.items);
	return read;
}

bool gltf_read_animations(gltf_document *document)
{
	const gltf_table *table = &document->tables[GLTF_ANIMATIONS];
	for (uint32_t i = 0; i < table->count; i++) {
		if (!read_animation(document, table->items[i]))
			return false;
	}
	return true;
}
