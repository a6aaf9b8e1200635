/* Which sides of a scene file's faces light falls on. Files are often made for programs that show both sides, or have
 * some faces turned round; faces of one side are black from behind, and a room of those is a black picture.
 */
#ifndef DEMOS_FILE_SIDES_H
#define DEMOS_FILE_SIDES_H

#include "options.h"
#include "import_file.h"

/* Gives faces the sides that are asked for. two_sided ON: every face that is no lamp gets both. AUTO: follows light
 * from the lamps; faces lit from behind alone are turned round, objects lit on both sides, or whose fronts are walls of
 * a dark room, get both, and a line says so; likewise where a sky is all the light and no face looks at it. Lamps stay
 * as they are, or they would give twice the light. False: out of memory.
 */
bool file_sides_mend(engine_scene *scene, options_sides two_sided, bool sky, const char *program);

#endif
