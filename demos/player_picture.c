#include "player_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

bool player_succeeded(player *p, gi_result result)
{
	if (result && !p->message[0])
		snprintf(p->message, sizeof p->message, "%s", gi_result_text(result));
	return result == GI_OK;
}

gi_view player_view(const player *p)
{
	gi_view view = gi_view_default();
	view.width = (uint32_t)engine_target_width(p->target);
	view.height = (uint32_t)engine_target_height(p->target);
	camera_matrices(&p->camera, (float)view.width / (float)view.height, view.view_from_world, view.clip_from_view);
	return view;
}

bool player_draw(player *p, gi_mode mode)
{
	gi_view view = player_view(p);
	view.mode = mode;
	view.overlay = p->layer;
	view.overlay_leaf = p->leaf;
	view.overlay_depth = p->depth;
	view.overlay_radius = p->scene->receiver_radius;
	engine_target_begin(p->target);
	if (!player_succeeded(p, gi_draw(p->gi, &view)))
		return false;
	if (p->backdrop && mode == GI_MODE_GLOBAL)
		engine_backdrop_draw(p->backdrop, view.view_from_world, view.clip_from_view);
	engine_target_tonemap(p->target, p->exposure);
	return true;
}

/* ---- exposure ---- */

/* Area-weighted mean of the radiance that leaves what does not shine itself, W/(m2 sr); 0 in the dark. */
static double mean_radiance(const gi_leaf *leaves, uint32_t count)
{
	double sum = 0, area = 0;
	for (uint32_t k = 0; k < count; k++) {
		const gi_leaf *l = leaves + k;
		const double b = 0.2126 * (double)l->radiosity[0] + 0.7152 * (double)l->radiosity[1] +
				 0.0722 * (double)l->radiosity[2];
		if (l->exitance[0] + l->exitance[1] + l->exitance[2] > 0 || !isfinite(b))
			continue;
		sum += (double)l->area * b;
		area += (double)l->area;
	}
	return area > 0 ? sum / area / 3.14159265358979 : 0;
}

/* The mean of the scene as 0.3 in the picture leaves its bright half below white. */
static float measured_exposure(player *p)
{
	uint32_t count = 0;
	gi_leaf *leaves = NULL;
	if (gi_read_leaves(p->gi, NULL, 0, &count) == GI_OK && count &&
	    (leaves = malloc(count * sizeof *leaves)) != NULL && gi_read_leaves(p->gi, leaves, count, &count) != GI_OK)
		count = 0;
	const double mean = leaves ? mean_radiance(leaves, count) : 0;
	free(leaves);
	return mean > 0 ? (float)(0.3 / mean) : 1;
}

void player_choose_exposure(player *p)
{
	p->exposure = p->o->exposure > 0       ? p->o->exposure
		      : p->scene->exposure > 0 ? p->scene->exposure
					       : measured_exposure(p);
}
