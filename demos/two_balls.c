/* The demo: a mirror ball and a glass ball in the Cornell box (figure 5 of Song et al., README), and their caustics follow. */
#include "player.h"
#include "scenes/cornell.h"

#include <cglm/cglm.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OBJECTS = 8 };

static const float EXPOSURE = 1.6f;

/* How far from the middle of the floor a ball's middle may be. */
static const float REACH = 1.9f;

typedef struct two_balls {
	options options;
	cornell box;
	gi_object handles[OBJECTS];
	float pushed[2]; /* x and z, by the user */
} two_balls;

static const char *const NAMES[OBJECTS] = {"floor", "ceiling", "back", "left", "right", "light", "mirror", "glass"};

static error_t parse(int key, char *text, struct argp_state *state)
{
	two_balls *b = state->input;
	switch (key) {
	case ARGP_KEY_INIT:
		state->child_inputs[0] = &b->options;
		return 0;
	case ARGP_KEY_ARG:
		options_fail(b->options.program, "%s: takes options only; see --help", text);
	}
	return ARGP_ERR_UNKNOWN;
}

static const struct argp_child children[] = {{&options_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .parser = parse,
    .children = children,
    .doc = "A mirror ball and a glass ball move through the Cornell box, their caustics computed anew every frame."
	   "\vWithout a window pictures and report go to out/two_balls unless --out says otherwise.",
};

static bool create(void *user, gi_context *gi, char *message, size_t message_size)
{
	two_balls *b = user;
	cornell_def def = cornell_def_default();
	def.leaf_size = b->options.leaf_size;
	def.buddha = false;
	def.ball_faces = CORNELL_SMOOTH_BALL_FACES;
	def.ball_specular = cornell_mirror_and_glass;
	const gi_result result = cornell_create(gi, &def, &b->box);
	if (result && !message[0])
		snprintf(message, message_size, "the box cannot be built: %s", gi_result_text(result));
	const cornell *c = &b->box;
	const gi_object handles[OBJECTS] = {c->floor, c->ceiling, c->back,     c->left,
					    c->right, c->light,   c->balls[0], c->balls[1]};
	memcpy(b->handles, handles, sizeof handles);
	return result == GI_OK;
}

static gi_result animate(void *user, gi_context *gi, double time_s)
{
	const two_balls *b = user;
	gi_result result = GI_OK;
	for (int k = 0; !result && k < 2; k++) {
		gi_pose pose = cornell_rolling_ball_pose(k, (float)time_s);
		pose.position[0] = glm_clamp(pose.position[0] + (k ? b->pushed[0] : 0), -REACH, REACH);
		pose.position[2] = glm_clamp(pose.position[2] + (k ? b->pushed[1] : 0), -REACH, REACH);
		result = gi_set_pose(gi, b->box.balls[k], pose);
	}
	return result;
}

static void move(void *user, float x, float z)
{
	two_balls *b = user;
	b->pushed[0] = glm_clamp(b->pushed[0] + x, -2 * REACH, 2 * REACH);
	b->pushed[1] = glm_clamp(b->pushed[1] + z, -2 * REACH, 2 * REACH);
}

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
	const two_balls *b = user;
	return (export_objects){b->handles, NAMES, OBJECTS};
}

int main(int argc, char **argv)
{
	two_balls b = {.options = options_default("two_balls")};
	b.options.out = "out/two_balls";
	options_parse(&parser, argc, argv, &b);
	const player_scene scene = {.user = &b,
				    .title = "two_balls",
				    .create = create,
				    .animate = animate,
				    .view = view,
				    .move = move,
				    .objects = objects,
				    .frames = 48,
				    .exposure = EXPOSURE,
				    .gallery = true,
				    .report = "frames.csv"};
	return player_run(&b.options, &scene);
}
