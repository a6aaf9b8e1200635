/* The list of a context's lights without a surface (gi_light): places, handles, and what changed since the last update.
 * Named for glTF's KHR_lights_punctual, whose falloffs they have, they are called punctual in what follows. */
#ifndef GI_LIGHT_LIST_H
#define GI_LIGHT_LIST_H

#include "gi/gi.h"

typedef struct light_record {
	uint32_t generation; /* odd: alive */
	gi_light_def def;
	bool moved; /* other rays than in the last update */
} light_record;

typedef struct gi_light_list {
	light_record *list;  /* by place */
	uint32_t count;      /* places, free ones too; there is room for the next power of two */
	bool changed;        /* since the last update, whatever it was */
	uint32_t generation; /* another one when anything of them changed */
} gi_light_list;

bool light_is_there(const light_record *light);
uint32_t light_list_alive(const gi_light_list *lights);
/* Does one give light to anything? */
bool light_list_shines(const gi_light_list *lights);
void light_list_seen(gi_light_list *lights); /* by an update */
void light_list_free(gi_light_list *lights);

#endif
