/* Plays a scene file: its animation moves the objects, their light follows.
 *
 * Without a window it records what is asked for, or pictures when nothing is.
 */
#include "file_probes.h"
#include "file_scene.h"
#include "player.h"
#include "progress.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct gi_play {
	options options;
	const char *path;
	float probes; /* metres between them; 0: none */
	file_scene file;
} gi_play;

enum { KEY_PROBES = 0x1000 }; /* no letter */

static const struct argp_option table[] = {
    {"probes", KEY_PROBES, "SPACING", 0,
     "probes in a grid over the scene, so many metres apart: --overlay receivers shows their light, and P in a window",
     0},
    {0}};

/* Of a probe, over the spacing. */
static const float PROBE_RADIUS = 0.08f;

static error_t parse(int key, char *text, struct argp_state *state)
{
	gi_play *play = state->input;
	switch (key) {
	case ARGP_KEY_INIT:
		state->child_inputs[0] = &play->options;
		return 0;
	case ARGP_KEY_ARG:
		if (play->path)
			options_fail(play->options.program, "%s: one scene at a time", text);
		play->path = text;
		return 0;
	case KEY_PROBES:
		play->probes = options_positive(&play->options, "--probes", text, 1e6);
		play->options.receivers = true;
		return 0;
	case ARGP_KEY_END:
		if (!play->path)
			options_fail(play->options.program, "which scene? Give a glTF, OBJ or PLY file; see --help");
		return 0;
	}
	return ARGP_ERR_UNKNOWN;
}

static const struct argp_child children[] = {{&options_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .options = table,
    .parser = parse,
    .args_doc = "SCENE",
    .children = children,
    .doc =
	"Plays a glTF 2.0, OBJ or PLY file with its global illumination."
	"\vPATTERNs hold one %d, e.g. frame_%04d.png. Without a window and without anything to write, pictures go to "
	"out/gi_play unless --out says otherwise. Frames default to the length of the animation.",
};

static bool create(void *user, gi_context *gi, char *message, size_t message_size)
{
	gi_play *play = user;
	return file_scene_create(&play->file, gi, message, message_size) &&
	       (!play->probes || file_probes_create(&play->file, play->probes, gi, message, message_size));
}

static gi_result animate(void *user, gi_context *gi, double time_s)
{
	gi_play *play = user;
	return file_scene_animate(&play->file, gi, time_s);
}

static void view(void *user, double time_s, camera *out)
{
	const gi_play *play = user;
	file_scene_view(&play->file, time_s, out);
}

static export_objects objects(void *user)
{
	const gi_play *play = user;
	return (export_objects){play->file.handles, play->file.names, play->file.scene.object_count};
}

/* The whole animation with its last key, or one picture of what does not move. */
static uint32_t default_frames(const gi_play *play)
{
	const double frames = floor(play->file.scene.duration_s * play->options.fps + 1e-6) + 1;
	return frames < 1e6 ? (uint32_t)frames : 1000000;
}

int main(int argc, char **argv)
{
	gi_play play = {.options = options_default("gi_play")};
	options *o = &play.options;
	o->out = "out/gi_play";
	options_parse(&parser, argc, argv, &play);
	play.file = (file_scene){.program = o->program,
				 .lit = o->sky > 0 || o->sky_file,
				 .sky_given = o->sky_given,
				 .two_sided = o->two_sided,
				 .leaf_size = o->leaf_size,
				 .leaves = o->leaves,
				 .cage_faces = o->cage_faces};
	char message[1024];
	progress_show(&(progress){.program = o->program}, "reading the file", 0, 0);
	if (!file_scene_load(&play.file, play.path, message, sizeof message)) {
		options_say(o->program, "%s", message);
		return EXIT_FAILURE;
	}
	const char *slash = strrchr(play.path, '/');
	const bool asked = o->images || o->report || o->field || o->form_factors;
	const player_scene scene = {.user = &play,
				    .title = slash ? slash + 1 : play.path,
				    .create = create,
				    .animate = animate,
				    .view = view,
				    .objects = objects,
				    .sky = play.file.scene.sky.radiance,
				    .sky_width = play.file.scene.sky.width,
				    .sky_height = play.file.scene.sky.height,
				    .receiver_radius = PROBE_RADIUS * play.probes,
				    .loop_s = play.file.scene.duration_s,
				    .frames = default_frames(&play),
				    .gallery = !asked};
	const int code = player_run(o, &scene);
	file_scene_free(&play.file);
	return code;
}
