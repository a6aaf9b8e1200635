/* Where the faces of a scene's cages touch, cross or come close to one another: the lines along which leaves are to be
 * cut, or one leaf has one B for both sides of a wall, or for what lies under a block and what lies beside it.
 *
 *        wall |                     block  +------
 *             |                            +------   close above the floor
 *   ----------+---------- floor    --------+------
 *             ^ a line                     ^ a line, below the edge
 */
#ifndef GI_CONTACT_H
#define GI_CONTACT_H

#include "gi/gi.h"

#include <stdbool.h>
#include <stdint.h>

/* One object of the scene as it stands. */
typedef struct gi_contact_object {
	const gi_object_def *def;
	bool moves;         /* its contacts with others do not part light */
	const float *sizes; /* of each face's leaves, metres; NULL: its faces are not cut, but cut others */
	gi_leaf_cut *cuts;  /* found, the caller frees them */
	uint32_t cut_count;
} gi_contact_object;

/* Finds the cuts of all objects. `reach`: edges that end closer above a face than this share of its leaves' size are in
 * contact with it. `strips`: along such edges both surfaces are cut into strips as well, where light falls off from one
 * to the next. False when memory ran out; what was found so far is there to be freed. */
bool gi_find_contacts(gi_contact_object *objects, uint32_t count, double reach, bool strips);

#endif
