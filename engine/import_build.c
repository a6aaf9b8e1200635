#include "import_build.h"
#include "import_path.h"

#include <stdlib.h>
#include <string.h>

bool import_make_graph(import_loader *loader, uint32_t count)
{
	engine_scene_graph *graph = loader->scene->graph;
	graph->nodes = malloc(((size_t)count + 1) * sizeof *graph->nodes);
	graph->order = malloc(((size_t)count + 1) * sizeof *graph->order);
	graph->world = malloc(((size_t)count + 1) * 16 * sizeof *graph->world);
	if (!graph->nodes || !graph->order || !graph->world)
		return import_fail(loader, "out of memory for %u nodes", count);
	graph->node_count = count;
	for (uint32_t n = 0; n < count; n++) {
		graph->nodes[n] = import_node_default();
		for (int i = 0; i < 16; i++)
			graph->world[16 * (size_t)n + i] = i % 5 == 0; /* for those that no scene holds */
	}
	return true;
}

uint8_t *import_read_file(import_loader *loader, size_t *size)
{
	char why[128];
	FILE *file = import_open(loader->path, why, sizeof why);
	uint8_t *bytes = import_read_all(file, (size_t)4 << 30, size, why, sizeof why);
	if (!bytes)
		import_fail(loader, "%s", why);
	else if (*size >= 2 && (memcmp(bytes, "\xff\xfe", 2) == 0 || memcmp(bytes, "\xfe\xff", 2) == 0)) {
		import_fail(loader, "is UTF-16; save it as UTF-8");
		free(bytes);
		return NULL;
	}
	return bytes;
}
