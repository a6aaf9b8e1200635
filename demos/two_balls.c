/* The demo: a mirror ball and a glass ball in the Cornell box (figure 5 of Song et al., README), and their caustics
 * follow. */
#include "player.h"
#include "scenes/cornell.h"

#include <cglm/cglm.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { KEY_BALLS = 'b', OBJECTS = 8, BALLS = 2 };

static const float EXPOSURE = 1.6f;

/* How far from the middle of the floor a ball's middle may be. */
static const float REACH = 1.9f;

typedef struct two_balls {
	options options;
	cornell box;
	gi_object handles[OBJECTS];
	bool glass[BALLS];      /* else a mirror */
	float pushed[BALLS][2]; /* x and z, by the user */
	float middle[BALLS][3]; /* now */
	int held;               /* the ball that is moved */
} two_balls;

static const char *const NAMES[OBJECTS] = {"floor", "ceiling", "back",       "left",
					   "right", "light",   "first ball", "second ball"};

static const char *const KEYS[][2] = {{"Tab, right click", "choose a ball"}, {"G", "the chosen ball: mirror or glass"}};

static const struct argp_option table[] = {
    {"balls", KEY_BALLS, "KIND,KIND", 0, "what they are, mirror or glass each (mirror,glass)", 0},
    {0},
};

static bool parse_kind(const char *text, size_t length, bool *glass)
{
	*glass = length == 5 && strncmp(text, "glass", length) == 0;
	return *glass || (length == 6 && strncmp(text, "mirror", length) == 0);
}

static void parse_balls(two_balls *b, const char *text)
{
	const size_t first = strcspn(text, ",");
	if (!text[first] || !parse_kind(text, first, &b->glass[0]) ||
	    !parse_kind(text + first + 1, strlen(text + first + 1), &b->glass[1]))
		options_fail(b->options.program, "--balls %s: must be two of mirror and glass, e.g. glass,glass", text);
}

static error_t parse(int key, char *text, struct argp_state *state)
{
	two_balls *b = state->input;
	switch (key) {
	case ARGP_KEY_INIT:
		state->child_inputs[0] = &b->options;
		return 0;
	case KEY_BALLS:
		parse_balls(b, text);
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
    .doc = "A mirror ball and a glass ball move through the Cornell box, their caustics computed anew every frame."
	   "\vIn a window: the right mouse button takes a ball and moves it over the floor, Tab takes the other one, "
	   "arrow keys "
	   "move it too, G makes it a mirror or glass, space stops their own way, H lists all keys. Without a window "
	   "pictures and report go to out/two_balls unless --out says otherwise; frames recorded under a budget "
	   "(--frames 48 --budget-fps 10) end with what an exact frame takes.",
};

/* As cornell_mirror_and_glass has them. */
static gi_specular kind_of(const two_balls *b, int ball)
{
	return cornell_mirror_and_glass[b->glass[ball]];
}

static bool create(void *user, gi_context *gi, char *message, size_t message_size)
{
	two_balls *b = user;
	cornell_def def = cornell_def_default();
	def.leaf_size = b->options.leaf_size;
	def.buddha = false;
	def.ball_faces = CORNELL_SMOOTH_BALL_FACES;
	const gi_specular kinds[BALLS] = {kind_of(b, 0), kind_of(b, 1)};
	def.ball_specular = kinds;
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
	two_balls *b = user;
	gi_result result = GI_OK;
	for (int k = 0; !result && k < BALLS; k++) {
		gi_pose pose = cornell_rolling_ball_pose(k, (float)time_s);
		pose.position[0] = glm_clamp(pose.position[0] + b->pushed[k][0], -REACH, REACH);
		pose.position[2] = glm_clamp(pose.position[2] + b->pushed[k][1], -REACH, REACH);
		memcpy(b->middle[k], pose.position, sizeof b->middle[k]);
		result = gi_set_pose(gi, b->box.balls[k], pose);
	}
	return result;
}

static void move(void *user, float x, float z)
{
	two_balls *b = user;
	float *pushed = b->pushed[b->held];
	pushed[0] = glm_clamp(pushed[0] + x, -2 * REACH, 2 * REACH);
	pushed[1] = glm_clamp(pushed[1] + z, -2 * REACH, 2 * REACH);
}

/* How far the line of sight passes by a ball's middle. */
static float distance_from(const float middle[3], const float eye[3], const float direction[3])
{
	vec3 to, across;
	glm_vec3_sub((float *)middle, (float *)eye, to);
	glm_vec3_cross(to, (float *)direction, across);
	return glm_vec3_norm(across) / glm_vec3_norm((float *)direction);
}

static void grab(void *user, const float eye[3], const float direction[3])
{
	two_balls *b = user;
	b->held = distance_from(b->middle[1], eye, direction) < distance_from(b->middle[0], eye, direction);
}

static gi_result press(void *user, gi_context *gi, int key)
{
	two_balls *b = user;
	if (key == ENGINE_KEY_TAB)
		b->held = 1 - b->held;
	if (key != 'G')
		return GI_OK;
	b->glass[b->held] = !b->glass[b->held];
	return gi_set_specular(gi, b->box.balls[b->held], 0, kind_of(b, b->held));
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
	two_balls b = {.options = options_default("two_balls"), .glass = {false, true}, .held = 1};
	b.options.out = "out/two_balls";
	options_parse(&parser, argc, argv, &b);
	const player_scene scene = {.user = &b,
				    .title = "two_balls",
				    .create = create,
				    .animate = animate,
				    .view = view,
				    .move = move,
				    .grab = grab,
				    .press = press,
				    .keys = KEYS,
				    .key_count = sizeof KEYS / sizeof *KEYS,
				    .objects = objects,
				    .frames = 48,
				    .exposure = EXPOSURE,
				    .gallery = true,
				    .exact_frame = true,
				    .report = "frames.csv"};
	return player_run(&b.options, &scene);
}
