/* Steps of building an object. */
#ifndef GI_OBJECT_BUILD_H
#define GI_OBJECT_BUILD_H

#include "object.h"
#include "refine.h"

/* Of an object without materials. */
static const gi_material OBJECT_GREY = {.rho = {0.5f, 0.5f, 0.5f}};

enum { OBJECT_MAX_LEVELS = 8, OBJECT_MAX_DRAW_LEVELS = 4 };

/* Arrays of a cage that is not the caller's own: the two-sided copy. */
typedef struct object_cage {
	float *positions;
	uint32_t *face_counts, *indices, *face_materials, *crease_vertices;
	float *crease_sharpness, *uvs;
} object_cage;

void object_cage_free(object_cage *own);
/* A second copy of the cage with its faces turned round, on vertices of its own: two sides that do not touch. */
bool object_make_two_sided(const gi_object_def *def, gi_refine_cage *cage, object_cage *own);
gi_refine_cage object_cage_of(const gi_object_def *def);
/* Smooth schemes are refined as a whole; faces of bilinear cages are split each for itself. */
bool object_is_split(const gi_object_def *def);
/* How often the cage is refined, where it is not split. */
uint32_t object_levels(const gi_object_def *def);
/* Are all |values| at most that? False for NaN too. */
bool object_all_within(const float *values, size_t count, float most);
/* Two sides that cover each other never show a back. */
void object_hide_backs(gi_hierarchy *hierarchy);
/* Of one whose shape changes, when its hierarchy is built: what that takes, and the shape of its definition. */
gi_result object_make_shape(const gi_log *log, const gi_object_def *def, const char *name, gi_refined *refined,
			    object_record *object);
void object_note_sizes(object_record *object); /* once its tree is there */
/* Makes each leaf a material of its own. False: out of memory. */
bool object_own_materials(object_record *o);
/* Faces and texture coordinates of the leaves; origin as in gi_unique_faces. False: out of memory. */
bool object_map_leaves(const gi_object_def *def, const uint32_t *origin, const gi_refined *refined, object_record *o);
/* Where in a texture what is drawn lies; nothing without texture coordinates. False: out of memory. */
bool object_chart_drawn(const gi_object_def *def, const gi_refined *refined, object_record *o);
char *object_copy_name(const char *name); /* NULL: out of memory */
/* All of a definition but its pose; messages call it `name`. */
gi_result object_check_named(const gi_log *log, const gi_object_def *def, const char *name);

#endif
