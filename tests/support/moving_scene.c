#include "moving_scene.h"

#include "scenes/cornell.h"
#include "scenes/shapes.h"

#include <math.h>

/* ---- chance ---- */

static uint32_t random_state;

void seed_motion(uint32_t seed)
{
	random_state = seed;
}

static uint32_t random_bits(void)
{
	/* xorshift32 (Marsaglia, 2003) */
	random_state ^= random_state << 13;
	random_state ^= random_state >> 17;
	random_state ^= random_state << 5;
	return random_state;
}

static float random_between(float low, float high)
{
	return low + (high - low) * (float)(random_bits() >> 8) * (1.0f / 16777216.0f);
}

static bool chance(float p)
{
	return random_between(0, 1) < p;
}

/* ---- scenes ---- */

static gi_object add_ball(gi_context *gi)
{
	engine_mesh mesh;
	assert_true(shape_sphere(.6f, 3, &mesh));
	return harness_add(
	    gi, &(harness_object){.name = "ball", .scheme = GI_SCHEME_CATMULL_CLARK, .rho = {.7f, .3f, .3f}}, &mesh);
}

static gi_object add_block(gi_context *gi)
{
	engine_mesh mesh;
	assert_true(shape_box((float[]){-.5f, 0, -.5f}, (float[]){.5f, 1.5f, .5f}, 2, false, &mesh));
	return harness_add(gi, &(harness_object){.name = "block", .levels = 1, .rho = {.3f, .7f, .3f}}, &mesh);
}

/* A sheet bent in the middle: it sees itself, and both its sides reflect. */
static gi_object add_sheet(gi_context *gi)
{
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-.7f, 0, -.7f}, (float[]){0, 0, 1.4f}, (float[]){1.4f, 0, 0}, 2, 2, &mesh));
	for (uint32_t k = 0; k < mesh.vertex_count; k++)
		mesh.positions[3 * k + 1] = .5f * fabsf(mesh.positions[3 * k]);
	return harness_add(
	    gi, &(harness_object){.name = "sheet", .levels = 1, .rho = {.3f, .3f, .7f}, .double_sided = true}, &mesh);
}

static void add_movers(scene *s)
{
	s->mover[BALL] = add_ball(s->gi);
	s->mover[BLOCK] = add_block(s->gi);
	s->mover[SHEET] = add_sheet(s->gi);
}

void open_box(scene *s, const gi_context_def *def)
{
	s->gi = harness_context(def);
	cornell_def box = cornell_def_default();
	box.wall_faces = 2;
	box.wall_levels = 2;
	box.light_levels = 1;
	box.buddha = box.balls = false;
	cornell made;
	assert_gi(cornell_create(s->gi, &box, &made));
	s->light = made.light;
	add_movers(s);
	assert_gi(gi_commit(s->gi));
}

/* One closed inward object, as large as the Cornell box: no sky. */
void open_room(scene *s, const gi_context_def *def)
{
	s->gi = harness_context(def);
	engine_mesh mesh;
	assert_true(shape_box((float[]){-2.75f, 0, -2.75f}, (float[]){2.75f, 5.5f, 2.75f}, 2, true, &mesh));
	harness_add(s->gi, &(harness_object){.name = "room", .levels = 1, .rho = {.6f, .6f, .6f}}, &mesh);
	assert_true(shape_quad((float[]){-.6f, 5.4f, -.6f}, (float[]){1.2f, 0, 0}, (float[]){0, 0, 1.2f}, 1, 1, &mesh));
	s->light = harness_add(s->gi, &(harness_object){.name = "light", .levels = 1, .exitance = {40, 40, 40}}, &mesh);
	add_movers(s);
	assert_gi(gi_commit(s->gi));
}

/* ---- motion ---- */

const gi_pose HOME[MOVERS] = {
    {{0, 3.2f, 0}, {0, 0, 0, 1}},          /* between the light and the floor */
    {{-1.2f, 0, -.6f}, {0, .2f, 0, .98f}}, /* stands on the floor: contact */
    {{1.3f, 1.2f, .8f}, {.3f, 0, .1f, .95f}},
};

gi_pose random_pose(int mover, bool stay_inside)
{
	gi_pose p = {.position = {random_between(-1.9f, 1.9f), random_between(.8f, 4.6f), random_between(-1.9f, 1.9f)}};
	for (int k = 0; k < 4; k++)
		p.rotation[k] = random_between(-1, 1);
	p.rotation[3] += 1.5f; /* never near zero */
	if (mover == BLOCK) {
		/* On the floor, or in the air. */
		p.position[1] = chance(.6f) ? 0 : random_between(0, 3);
		p.rotation[0] = p.rotation[2] = 0;
	}
	/* The ball goes through the space under the light. */
	if (mover == BALL && chance(.5f)) {
		p.position[0] = random_between(-.8f, .8f);
		p.position[2] = random_between(-.8f, .8f);
	}
	/* Out through the open front, and beyond. */
	if (mover == SHEET && !stay_inside && chance(.3f))
		p.position[2] = random_between(2.2f, 9);
	return p;
}

static gi_pose nudged(gi_pose p, bool turn)
{
	const float step = .12f;
	for (int k = 0; k < 3; k += 1 + (k == 0)) /* along the floor */
		p.position[k] = fminf(fmaxf(p.position[k] + random_between(-step, step), -1.9f), 1.9f);
	if (turn)
		p.rotation[1] += random_between(-.1f, .1f);
	return p;
}

/* The ball on the block, through it, or beside it, just touching. */
static gi_pose in_contact(const gi_pose *block)
{
	gi_pose p = *block;
	switch (random_bits() % 3) {
	case 0:
		p.position[1] += 1.5f + .6f; /* the cage's poles touch the top */
		break;
	case 1:
		p.position[1] += 1.2f;
		break;
	default:
		p.position[0] += .9f;
		p.position[1] += .7f;
	}
	return p;
}

void next_poses(motion *m, bool moved[MOVERS])
{
	for (int k = 0; k < MOVERS; k++) {
		const float dice = random_between(0, 1);
		const gi_pose before = m->pose[k];
		moved[k] = dice < .55f;
		if (dice < .25f)
			m->pose[k] = nudged(before, chance(.5f));
		else if (dice < .35f)
			m->pose[k] = random_pose(k, m->stay_inside);
		else if (dice < .45f)
			m->pose[k] = m->seen[k][random_bits() % 4];
		else if (dice < .5f)
			m->pose[k] = HOME[k];
		else if (dice < .55f && k == BALL)
			m->pose[k] = in_contact(&m->pose[BLOCK]);
		if (moved[k])
			m->seen[k][random_bits() % 4] = before;
	}
}

motion start_motion(bool stay_inside)
{
	motion m = {.stay_inside = stay_inside};
	for (int k = 0; k < MOVERS; k++) {
		m.pose[k] = HOME[k];
		for (int j = 0; j < 4; j++)
			m.seen[k][j] = random_pose(k, stay_inside);
	}
	return m;
}
