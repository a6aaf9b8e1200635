/* How large a scene may be: its table of segments is the largest buffer, of leaves times sources. */
#ifndef GI_SCENE_LIMITS_H
#define GI_SCENE_LIMITS_H

#include "gpu.h"

/* Of a scene's table of segments, or of the fewest entries that there must be room for. */
uint64_t limits_table_bytes(uint64_t leaves, uint64_t sources);
/* Are the tables of that many leaves and sources within what the renderer binds? */
bool limits_can_hold(gpu *g, uint64_t leaves, uint64_t sources);

#endif
