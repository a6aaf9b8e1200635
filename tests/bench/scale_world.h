/* Worlds of many objects for the benchmark of how costs grow: made by code, the same for the same settings.
 *
 * A hall is one open room with boxes all over it: whatever moves is seen from everywhere. A street has rooms on both
 * sides, ten objects each: shell, lamp, door ajar, table, four chairs, shelf and a figure; most of it is hidden from
 * most of it, as in a game's level.
 */
#ifndef TESTS_BENCH_SCALE_WORLD_H
#define TESTS_BENCH_SCALE_WORLD_H

#include "gi/gi.h"

#include <stdbool.h>

typedef enum scale_kind { SCALE_HALL, SCALE_STREET, SCALE_KINDS } scale_kind;

typedef struct scale_settings {
	scale_kind kind;
	uint32_t objects;     /* about; a street has ten a room and two ends */
	float cell;           /* leaf size of rooms, metres */
	uint32_t cells;       /* a side of a hall's boxes, of a street's furniture */
	uint32_t mover_cells; /* a side of a hall's boxes that move; 0: like the others */
	uint32_t room; /* a hall is as large as for so many boxes, which are spread over it; 0: for those it has */
	bool fixed;    /* all but movers and doors are GI_MOBILITY_STATIC; else movable */
} scale_settings;

typedef struct scale_world {
	gi_context *gi;
	scale_settings settings;
	gi_object *movers, *doors, *others; /* a mover of each place, a door of each (street), what is painted */
	uint32_t places;                    /* of those arrays */
	uint32_t objects;                   /* created */
	gi_object guest;                    /* what scale_world_add added */
} scale_world;

const char *scale_kind_name(scale_kind kind);

/* Creates the objects; the caller commits. Ends the program when it cannot. */
void scale_world_build(scale_world *w, gi_context *gi, const scale_settings *settings);
void scale_world_free(scale_world *w);

/* The k-th mover, counted over the whole world, takes the round's pose: a step to the side of where it stands. */
void scale_world_move(scale_world *w, uint32_t k, uint32_t round);

/* A box that stays moves for the first time, another one each round; a hall's only. */
void scale_world_move_staying(scale_world *w, uint32_t round);

/* The door of the middle room; a street's only. */
void scale_world_turn_door(scale_world *w, uint32_t round);

/* A material's value, of one thing in the middle. */
void scale_world_paint(scale_world *w, uint32_t round);

/* One object more, in the middle, movable or like what stays; it begins to shine; it goes. */
void scale_world_add(scale_world *w, bool stays);
void scale_world_light_guest(scale_world *w);
void scale_world_remove(scale_world *w);

#endif
