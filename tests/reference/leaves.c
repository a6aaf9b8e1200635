#include "leaves.h"

#include <stdlib.h>
#include <string.h>

bool leaf_scene_make(const gi_leaf *leaves, uint32_t count, leaf_scene *out)
{
	const size_t n = (size_t)count + 1;
	float *corners = malloc(12 * n * sizeof *corners), *rho = malloc(3 * n * sizeof *rho),
	      *exitance = malloc(3 * n * sizeof *exitance);
	*out = (leaf_scene){.scene = {.corners = corners, .rho = rho, .exitance = exitance, .leaf_count = count},
			    .areas = malloc(n * sizeof *out->areas),
			    .rho = malloc(3 * n * sizeof *out->rho)};
	if (!corners || !rho || !exitance || !out->areas || !out->rho) {
		leaf_scene_free(out);
		return false;
	}
	for (size_t k = 0; k < count; k++) {
		memcpy(corners + 12 * k, leaves[k].corners, sizeof leaves[k].corners);
		memcpy(rho + 3 * k, leaves[k].rho, sizeof leaves[k].rho);
		memcpy(exitance + 3 * k, leaves[k].exitance, sizeof leaves[k].exitance);
		for (size_t c = 0; c < 3; c++)
			out->rho[3 * k + c] = leaves[k].rho[c];
	}
	reference_leaf_areas(&out->scene, out->areas);
	return true;
}

void leaf_scene_free(leaf_scene *s)
{
	free((float *)s->scene.corners);
	free((float *)s->scene.rho);
	free((float *)s->scene.exitance);
	free(s->areas);
	free(s->rho);
	*s = (leaf_scene){0};
}

void leaf_irradiance(const gi_leaf *leaves, uint32_t count, double *out)
{
	for (size_t k = 0; k < count; k++)
		for (size_t c = 0; c < 3; c++)
			out[3 * k + c] = leaves[k].irradiance[c];
}
