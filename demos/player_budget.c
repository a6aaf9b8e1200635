/* What an update may take: what the user gave, or what keeps the frame rate while something moves. */
#include "player_internal.h"
#include "wall_clock.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool keeps_rate(const player *p)
{
	const options *o = p->o;
	return !o->budget_given && (o->budget_fps_given || !p->recording);
}

bool player_budget_open(player *p)
{
	p->rate = frame_budget_make(keeps_rate(p) ? p->o->budget_fps : 0);
	p->pose_count = p->scene->objects(p->scene->user).count;
	p->poses = calloc(p->pose_count + 1u, sizeof *p->poses);
	if (!p->poses)
		snprintf(p->message, sizeof p->message, "out of memory for the poses of %u objects", p->pose_count);
	return p->poses != NULL;
}

/* Remembers the poses; whether one is not what it was. */
static bool anything_moved(player *p)
{
	const export_objects objects = p->scene->objects(p->scene->user);
	bool moved = false;
	for (uint32_t k = 0; k < p->pose_count; k++) {
		gi_pose pose;
		if (gi_get_pose(p->gi, objects.handles[k], &pose) != GI_OK)
			continue;
		moved = moved || memcmp(&pose, p->poses + k, sizeof pose) != 0;
		p->poses[k] = pose;
	}
	return moved;
}

gi_budget player_budget_next(player *p)
{
	/* The first frame's poses are news, but nothing was seen to move. */
	const bool moved = anything_moved(p) && p->frame > 0;
	p->budget = p->o->budget_given ? p->o->budget : frame_budget_next(&p->rate, moved, wall_clock_ms());
	return p->budget;
}

void player_budget_note(player *p, const gi_report *report)
{
	frame_budget_note(&p->rate, p->shown_ms, report);
}
