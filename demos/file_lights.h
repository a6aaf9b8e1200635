/* Lights of a scene file without a surface (KHR_lights_punctual), as the library takes them. */
#ifndef DEMOS_FILE_LIGHTS_H
#define DEMOS_FILE_LIGHTS_H

#include "gi/gi.h"
#include "import_file.h"

typedef struct file_lights {
	gi_light *handles; /* count: the first of the scene's */
	uint32_t count;
} file_lights;

/* Where the scene's lights are at time 0. Of more than GI_MOST_LIGHTS the others are left out: one line on stderr. */
gi_result file_lights_create(file_lights *lights, const engine_scene *scene, gi_context *gi, const char *program);
/* Moves those that are animated. One of no pose is off. */
gi_result file_lights_animate(const file_lights *lights, const engine_scene *scene, gi_context *gi, double time_s);
void file_lights_free(file_lights *lights);

#endif
