/* The demo: a Buddha moves through the Cornell box and the light follows.
 *
 * Without a window it records: every eighth frame in direct, indirect and global light, as figure 4 of Song et al.
 * (README), and figures of all frames.
 */
#include "figure.h"
#include "player.h"
#include "progress.h"
#include "import_file.h"
#include "scenes/cornell.h"

#include <cglm/cglm.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { KEY_MESH = 'm', KEY_LEVELS = 'l', CAGE_FACES = 900, OBJECTS = 9 };

/* The back wall in the middle of the tones, its bright top below white. */
static const float EXPOSURE = 1.6f;

/* The floor that the figure's middle may stand on: the box less about half the figure's width. */
static const float REACH = 1.7f;

typedef struct moving_buddha {
	options options;
	const char *mesh_path;
	uint32_t levels; /* of the Buddha and the balls */
	engine_mesh figure, cage;
	cornell box;
	gi_object handles[OBJECTS];
	const char *names[OBJECTS];
	uint32_t object_count;
	float pushed[2]; /* x and z, by the user */
} moving_buddha;

/* ---- options -------------------------------------------------------------------------------------------------------
 */

static const struct argp_option table[] = {
    {"mesh", KEY_MESH, "FILE", 0, "a figure in the Buddha's place: OBJ, PLY or glTF, y up, facing +z", 0},
    {"levels", KEY_LEVELS, "N", 0,
     "refinement of the Buddha and the balls, 0..3 (0): four times the leaves each, finer light and shadows", 0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state)
{
	moving_buddha *b = state->input;
	switch (key) {
	case ARGP_KEY_INIT:
		state->child_inputs[0] = &b->options;
		return 0;
	case KEY_MESH:
		b->mesh_path = text;
		return 0;
	case KEY_LEVELS:
		b->levels = options_count(b->options.program, "--levels", text, 0, 3);
		return 0;
	case ARGP_KEY_ARG:
		options_fail(b->options.program, "%s: takes options only; see --help", text);
	}
	return ARGP_ERR_UNKNOWN;
}

static const struct argp_child children[] = {{&options_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .options = table,
    .parser = parse,
    .children = children,
    .doc = "A Buddha moves through the Cornell box, its light computed anew every frame."
	   "\vWithout a window pictures and report go to out/moving_buddha unless --out says otherwise.",
};

/* ---- figure --------------------------------------------------------------------------------------------------------
 */

static void free_figure(moving_buddha *b)
{
	engine_mesh_free(&b->figure);
	engine_mesh_free(&b->cage);
}

static bool load_figure(moving_buddha *b, char *message, size_t message_size)
{
	engine_scene scene;
	engine_mesh whole;
	if (!engine_scene_load(b->mesh_path, &scene, message, message_size))
		return false;
	if (scene.warning[0])
		fprintf(stderr, "%s: %s: %s\n", b->options.program, b->mesh_path, scene.warning);
	const bool merged = engine_scene_merge(&scene, &whole, message, message_size);
	engine_scene_free(&scene);
	if (!merged)
		return false;
	char why[512];
	const bool made = figure_make(&whole, b->options.cage_faces ? b->options.cage_faces : CAGE_FACES, &b->figure,
				      &b->cage, why, sizeof why);
	engine_mesh_free(&whole);
	if (!made)
		snprintf(message, message_size, "%s: %s", b->mesh_path, why);
	return made;
}

/* ---- scene ---------------------------------------------------------------------------------------------------------
 */

static void name_object(moving_buddha *b, const char *name, gi_object handle)
{
	b->names[b->object_count] = name;
	b->handles[b->object_count++] = handle;
}

static void name_objects(moving_buddha *b)
{
	const cornell *c = &b->box;
	name_object(b, "floor", c->floor);
	name_object(b, "ceiling", c->ceiling);
	name_object(b, "back", c->back);
	name_object(b, "left", c->left);
	name_object(b, "right", c->right);
	name_object(b, "light", c->light);
	name_object(b, b->mesh_path ? "figure" : "buddha", c->buddha);
	name_object(b, "ball", c->balls[0]);
	name_object(b, "small ball", c->balls[1]);
}

static bool create(void *user, gi_context *gi, char *message, size_t message_size)
{
	moving_buddha *b = user;
	cornell_def def = cornell_def_default();
	def.leaf_size = b->options.leaf_size;
	def.smooth_levels = b->levels;
	if (b->mesh_path) {
		def.figure = &b->figure;
		def.figure_cage = &b->cage;
	}
	const gi_result result = cornell_create(gi, &def, &b->box);
	if (result && !message[0])
		snprintf(message, message_size, "the box cannot be built: %s", gi_result_text(result));
	name_objects(b);
	return result == GI_OK;
}

static gi_result animate(void *user, gi_context *gi, double time_s)
{
	const moving_buddha *b = user;
	gi_pose pose = cornell_buddha_pose((float)time_s);
	pose.position[0] = glm_clamp(pose.position[0] + b->pushed[0], -REACH, REACH);
	pose.position[2] = glm_clamp(pose.position[2] + b->pushed[1], -REACH, REACH);
	return gi_set_pose(gi, b->box.buddha, pose);
}

static void move(void *user, float x, float z)
{
	moving_buddha *b = user;
	/* A push against a wall is not kept, else the way back would begin with nothing happening. */
	b->pushed[0] = glm_clamp(b->pushed[0] + x, -2 * REACH, 2 * REACH);
	b->pushed[1] = glm_clamp(b->pushed[1] + z, -2 * REACH, 2 * REACH);
}

/* That of the scene; the box's middle is what it turns about. */
static void view(void *user, double time_s, camera *out)
{
	(void)user;
	(void)time_s;
	float view_from_world[16], clip_from_view[16];
	cornell_camera(1, view_from_world, clip_from_view);
	*out = camera_about_y(view_from_world, clip_from_view, 5);
}

static export_objects objects(void *user)
{
	const moving_buddha *b = user;
	return (export_objects){b->handles, b->names, b->object_count};
}

int main(int argc, char **argv)
{
	moving_buddha b = {.options = options_default("moving_buddha")};
	b.options.out = "out/moving_buddha";
	options_parse(&parser, argc, argv, &b);
	char message[1024];
	if (b.mesh_path)
		progress_show(&(progress){.program = b.options.program}, "simplifying the mesh", 0, 0);
	if (b.mesh_path && !load_figure(&b, message, sizeof message)) {
		options_say(b.options.program, "%s", message);
		free_figure(&b);
		return EXIT_FAILURE;
	}
	const player_scene scene = {.user = &b,
				    .title = "moving_buddha",
				    .create = create,
				    .animate = animate,
				    .view = view,
				    .move = move,
				    .objects = objects,
				    .frames = 48,
				    .exposure = EXPOSURE,
				    .gallery = true,
				    .report = "frames.csv"};
	const int code = player_run(&b.options, &scene);
	free_figure(&b);
	return code;
}
