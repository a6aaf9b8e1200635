#include "player_internal.h"
#include "wall_clock.h"

#include <math.h>
#include <string.h>

/* A drag over the whole picture turns the view by so many radians; arrow keys push so many metres a second. */
static const float DRAG_TURN = 4, PUSH_SPEED = 1.5f;

/* Levels of nodes; no hierarchy has as many. */
static const uint32_t MOST_DEPTH = 40;

static gi_mode next_mode(gi_mode mode)
{
	return mode == GI_MODE_GLOBAL ? GI_MODE_DIRECT : mode == GI_MODE_DIRECT ? GI_MODE_INDIRECT : GI_MODE_GLOBAL;
}

static void toggle_layer(player *p, gi_overlay layer)
{
	p->layer = p->layer == layer ? GI_OVERLAY_NONE : layer;
}

static void press_mode(player *p, int key)
{
	switch (key) {
	case '1':
		p->mode = GI_MODE_DIRECT;
		break;
	case '2':
		p->mode = GI_MODE_INDIRECT;
		break;
	case '3':
		p->mode = GI_MODE_GLOBAL;
		break;
	case 'M':
		p->mode = next_mode(p->mode);
		break;
	}
}

/* Of the leaf under the cursor; where there is none, the one of before. */
static void pick(player *p, gi_overlay layer)
{
	float direction[3];
	uint32_t leaf = GI_NO_LEAF;
	camera_direction(&p->camera, p->cursor[0], p->cursor[1], engine_context_width(p->context),
			 engine_context_height(p->context), direction);
	if (gi_pick_leaf(p->gi, p->camera.eye, direction, &leaf) == GI_OK && leaf != GI_NO_LEAF) {
		p->leaf = leaf;
		p->layer = layer;
	}
}

/* The same key again takes it away, but for those of a leaf, which another leaf may be meant with. */
static void press_layer(player *p, int key)
{
	switch (key) {
	case 'W':
		toggle_layer(p, GI_OVERLAY_WIREFRAME);
		break;
	case 'D':
		toggle_layer(p, GI_OVERLAY_DIRTY);
		break;
	case 'R':
		toggle_layer(p, GI_OVERLAY_RESIDUAL);
		break;
	case 'T':
		toggle_layer(p, GI_OVERLAY_HIERARCHY);
		break;
	case '[':
		p->depth -= p->depth > 0;
		break;
	case ']':
		p->depth += p->depth < MOST_DEPTH;
		break;
	case 'L':
		pick(p, GI_OVERLAY_SENDERS);
		break;
	case 'V':
		pick(p, GI_OVERLAY_VISIBILITY);
		break;
	case 'K':
		pick(p, GI_OVERLAY_BLOCKERS);
		break;
	case 'P':
		if (p->scene->receiver_radius > 0)
			toggle_layer(p, GI_OVERLAY_RECEIVERS);
		break;
	case 'O':
		p->layer = GI_OVERLAY_NONE;
		break;
	}
}

/* Those that do not compile leave the others in use, and are no reason to end. */
static void reload_shaders(player *p)
{
	const gi_result result = gi_reload_shaders(p->gi);
	options_say(p->o->program, "%s", result ? p->message : "shaders were read again");
	p->message[0] = 0;
}

static void press_setting(player *p, int key)
{
	if (key == 'N')
		p->setting = (player_setting)((p->setting + 1) % PLAYER_SETTING_COUNT);
	else if ((key == ',' || key == '.') && player_setting_turn(p, key == '.' ? 1 : -1) != GI_OK) {
		options_say(p->o->program, "%s", p->message);
		p->message[0] = 0;
	}
}

/* What the player has no use for is the scene's. */
static void press_scene(player *p, int key)
{
	if (p->scene->press && p->scene->press(p->scene->user, p->gi, key) != GI_OK) {
		options_say(p->o->program, "%s", p->message);
		p->message[0] = 0;
	}
}

static void press(player *p, int key)
{
	switch (key) {
	case ' ':
		p->paused = !p->paused;
		break;
	case 'B':
		p->rebuild = !p->rebuild;
		break;
	case 'H':
		p->help = !p->help;
		break;
	case '-':
		p->exposure /= 1.125f;
		break;
	case '=':
		p->exposure *= 1.125f;
		break;
	case ENGINE_KEY_F1 + 4:
		reload_shaders(p);
		break;
	case ENGINE_KEY_ESCAPE:
		engine_context_request_close(p->context);
		break;
	default:
		press_mode(p, key);
		press_layer(p, key);
		press_setting(p, key);
		press_scene(p, key);
	}
}

static void look(player *p, const engine_input *in)
{
	const float *drag = in->drag[ENGINE_MOUSE_LEFT];
	if (drag[0] == 0 && drag[1] == 0 && in->scroll == 0)
		return;
	const float turn = DRAG_TURN / fmaxf(1, (float)engine_context_height(p->context));
	camera_orbit(&p->camera, -turn * drag[0], turn * drag[1]);
	camera_zoom(&p->camera, in->scroll);
	p->camera_taken = true;
}

/* What the right button goes down on is moved from then on. */
static void grab(player *p, const engine_input *in)
{
	float direction[3];
	if (!p->scene->grab || !in->mouse_pressed[ENGINE_MOUSE_RIGHT])
		return;
	camera_direction(&p->camera, in->cursor[0], in->cursor[1], engine_context_width(p->context),
			 engine_context_height(p->context), direction);
	p->scene->grab(p->scene->user, p->camera.eye, direction);
}

/* Along the picture's axes laid on the floor, so that a drag takes the figure where the hand goes. */
static void push(player *p, const engine_input *in, double seconds)
{
	float right[3], away[3];
	camera_floor_axes(&p->camera, right, away);
	const float step = PUSH_SPEED * (float)seconds;
	const float metres = camera_metres_per_pixel(&p->camera, engine_context_height(p->context));
	const float *drag = in->drag[ENGINE_MOUSE_RIGHT];
	const float r =
	    step * (float)(in->key_down[ENGINE_KEY_RIGHT] - in->key_down[ENGINE_KEY_LEFT]) + metres * drag[0];
	const float a = step * (float)(in->key_down[ENGINE_KEY_UP] - in->key_down[ENGINE_KEY_DOWN]) - metres * drag[1];
	if (r != 0 || a != 0)
		p->scene->move(p->scene->user, r * right[0] + a * away[0], r * right[2] + a * away[2]);
}

/* Smoothed over half a second. The first two frames build everything and are no measure of the others. */
static void note_interval(player *p, double ms)
{
	if (p->frame < 2)
		return;
	const double share = p->interval_ms > 0 ? fmin(1, ms / 500) : 1;
	p->interval_ms += share * (ms - p->interval_ms);
}

void player_input(player *p)
{
	const engine_input *in = engine_context_poll(p->context);
	const double before = p->last_clock_ms, now = wall_clock_ms(), seconds = fmin(0.25, 1e-3 * (now - before));
	p->last_clock_ms = now;
	note_interval(p, now - before);
	if (!engine_context_has_window(p->context))
		return;
	memcpy(p->cursor, in->cursor, sizeof p->cursor);
	for (int k = 0; k < in->pressed_count; k++)
		press(p, in->pressed[k]);
	look(p, in);
	if (p->scene->move && engine_context_height(p->context) > 0) {
		grab(p, in);
		push(p, in, seconds);
	}
	if (!p->recording && !p->paused)
		p->time_s += seconds;
	if (p->scene->loop_s > 0)
		p->time_s = fmod(p->time_s, p->scene->loop_s);
}
