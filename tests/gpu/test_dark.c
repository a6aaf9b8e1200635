/* Where no light comes to, in stiff scenes, B is 0 to the bit, channel by channel: from a cold start, while the scene
 * moves, and after warm light that was no help; and what was lit before it was sealed off gets no brighter.
 */
#include "pieces.h"

#include <math.h>
#include <stdio.h>

static const float RHOS[] = {.9f, .99f, .999f, .9999f};
enum { RHO_COUNT = sizeof RHOS / sizeof *RHOS, FRAMES = 12, FRAMES_SHUT = 20 };

/* Two of five cases, all in a long run. */
static bool is_taken(uint32_t k)
{
	return harness_is_long() || k % 5 < 2;
}

static gi_pose at(float x, float y, float z)
{
	return (gi_pose){{x, y, z}, {0, 0, 0, 1}};
}

static gi_context *open_stiff(uint32_t sweeps)
{
	gi_context_def def = harness_def();
	def.row_tolerance = .05f;
	def.max_sweeps = sweeps;
	return harness_context(&def);
}

/* Largest R of channel c of what lies beyond x, seen from inside the rooms that begin there. */
static double largest_beyond(gi_context *gi, float x, uint32_t c)
{
	snapshot s = snapshot_take(gi);
	double most = 0;
	for (uint32_t k = 0; k < s.leaf_count; k++) {
		float centre[3], normal[3];
		leaf_centre_and_normal(&s.leaves[k], centre, normal);
		const bool on_side = fabsf(centre[0] - x) < 1e-5f;
		if (centre[0] > x - 1e-5f && (!on_side || normal[0] > 0))
			most = fmax(most, (double)s.leaves[k].radiosity[c] - (double)s.leaves[k].exitance[c]);
	}
	snapshot_free(&s);
	return most;
}

static double largest_anywhere(gi_context *gi, uint32_t c)
{
	return largest_beyond(gi, -100, c);
}

/* ---- two rooms without a door, the second from x = 2.5 on ---- */

static const float SECOND_ROOM = 2.25f;

typedef struct rooms {
	gi_context *gi;
	gi_object lamp, ball;
} rooms;

static rooms open_rooms(float rho, const float exitance[3], uint32_t sweeps)
{
	rooms r = {.gi = open_stiff(sweeps)};
	const harness_object wall = {.name = "room", .levels = 2, .rho = {rho, rho, rho}};
	add_room(r.gi, &wall, (box){{0, 0, 0}, {2, 2, 2}});
	add_room(r.gi, &wall, (box){{2.5f, -.3f, .1f}, {4.5f, 1.5f, 2}});
	r.lamp =
	    add_block(r.gi,
		      &(harness_object){
			  .name = "lamp", .rho = {rho, rho, rho}, .exitance = {exitance[0], exitance[1], exitance[2]}},
		      (box){{-.2f, -.1f, -.2f}, {.2f, .1f, .2f}});
	r.ball = add_block(r.gi, &(harness_object){.name = "block", .levels = 1, .rho = {rho, rho, rho}},
			   (box){{-.3f, -.3f, -.2f}, {.3f, .3f, .2f}});
	assert_gi(gi_set_pose(r.gi, r.lamp, at(1, 1, 1)));
	assert_gi(gi_set_pose(r.gi, r.ball, at(3.5f, .6f, 1)));
	assert_gi(gi_commit(r.gi));
	return r;
}

static void expect_zero(double r, const char *what, float rho, int frame, uint32_t c)
{
	if (r != 0)
		fail_msg("%s, rho %g, frame %d: R is %g in channel %u", what, (double)rho, frame, r, c);
}

/* The lamp moves in the first room, the block in the second one. */
static void sealed_rooms_are_dark(void **state)
{
	(void)state;
	static const float colours[][3] = {{50, 50, 50}, {50, 0, 0}, {0, 3, 0}, {0, 1e-3f, 7}};
	static const uint32_t sweeps[] = {1, 2, 3, 8, 200};
	double least = INFINITY;
	for (uint32_t k = 0; k < RHO_COUNT * 5; k++) {
		if (!is_taken(k))
			continue;
		const float rho = RHOS[k % RHO_COUNT], *colour = colours[k % 3 + (k % 5 == 0)];
		rooms r = open_rooms(rho, colour, sweeps[k % 5]);
		for (int frame = 0; frame < FRAMES; frame++) {
			assert_gi(gi_set_pose(r.gi, r.lamp, at(1 + .05f * (float)frame, 1, 1.1f)));
			assert_gi(gi_set_pose(r.gi, r.ball, at(3.5f, .6f, 1 + .04f * (float)frame)));
			if (frame == FRAMES / 2)
				gi_reset_radiosity(r.gi);
			harness_update(r.gi);
			for (uint32_t c = 0; c < 3; c++) {
				expect_zero(largest_beyond(r.gi, SECOND_ROOM, c), "sealed room", rho, frame, c);
				const double lit = largest_anywhere(r.gi, c);
				if (colour[c] > 0)
					least = fmin(least, lit / (double)colour[c]);
				else
					expect_zero(lit, "no lamp of that colour", rho, frame, c);
			}
		}
		gi_context_destroy(r.gi);
	}
	printf("  sealed rooms and colours that no lamp has: 0; the largest R elsewhere is %.2f of the lamp's E at "
	       "least\n",
	       least);
	assert_true(least > .01);
}

/* The lamp jumps from room to room: light of before is no help, is refused, and nothing of it stays. */
static void refused_light_is_gone(void **state)
{
	(void)state;
	uint32_t refused = 0, jumps = 0;
	for (uint32_t k = 0; k < RHO_COUNT * 3; k++) {
		if (!is_taken(k))
			continue;
		const float rho = RHOS[k % RHO_COUNT], white[3] = {50, 20, 80};
		static const uint32_t sweeps[] = {1, 4, 100};
		rooms warm = open_rooms(rho, white, sweeps[k % 3]), cold = open_rooms(rho, white, sweeps[k % 3]);
		for (int frame = 0; frame < FRAMES; frame++) {
			const bool in_first = frame % 4 < 2;
			const gi_pose pose = in_first ? at(1, 1, 1) : at(3.6f, 1.2f, .5f);
			assert_gi(gi_set_pose(warm.gi, warm.lamp, pose));
			assert_gi(gi_set_pose(cold.gi, cold.lamp, pose));
			gi_reset_radiosity(cold.gi);
			harness_update(warm.gi);
			harness_update(cold.gi);
			snapshot a = snapshot_take(warm.gi), b = snapshot_take(cold.gi);
			const bool same = snapshot_hash_radiosity(&a) == snapshot_hash_radiosity(&b);
			snapshot_free(&a);
			snapshot_free(&b);
			if (frame < 2 || frame % 2)
				continue;
			jumps++;
			refused += same;
			for (uint32_t c = 0; same && in_first && c < 3; c++)
				expect_zero(largest_beyond(warm.gi, SECOND_ROOM, c), "refused", rho, frame, c);
		}
		gi_context_destroy(warm.gi);
		gi_context_destroy(cold.gi);
	}
	printf("  a lamp jumps to the other room: after %u of %u jumps B is a cold start's to the bit\n", refused,
	       jumps);
	assert_true(refused > 0);
}

/* The lamp of the second room, weak beside the first one's, goes out. Warm starts are good enough for the first room;
 * in the second one light only decays, whatever the first one's does. */
static void a_weak_lamp_goes_out(void **state)
{
	(void)state;
	double most = 0;
	uint32_t lit = 0, frames = 0;
	for (uint32_t k = 0; k < RHO_COUNT * 6; k++) {
		if (!is_taken(k))
			continue;
		static const uint32_t sweeps[] = {1, 3, 8};
		static const float restless[] = {.2f, .01f};
		const float rho = RHOS[k % RHO_COUNT], much = restless[k / RHO_COUNT % 2], white[3] = {50, 50, 50};
		rooms r = open_rooms(rho, white, sweeps[k / (2 * RHO_COUNT)]);
		gi_material weak = {.rho = {rho, rho, rho}, .exitance = {.5f, .5f, .5f}}, strong = weak;
		assert_gi(gi_set_material(r.gi, r.ball, 0, weak));
		for (int frame = 0; frame < 6; frame++) {
			assert_gi(gi_set_pose(r.gi, r.lamp, at(1 + .02f * much * (float)frame, 1, 1)));
			harness_update(r.gi);
		}
		weak = (gi_material){.rho = {rho, rho, rho}};
		assert_gi(gi_set_material(r.gi, r.ball, 0, weak));
		double last = largest_beyond(r.gi, SECOND_ROOM, 0);
		assert_true(last > 0);
		for (int frame = 0; frame < FRAMES_SHUT; frame++) {
			strong.exitance[0] = strong.exitance[1] = strong.exitance[2] =
			    50 * (1 + much * (float)(frame % 5));
			assert_gi(gi_set_material(r.gi, r.lamp, 0, strong));
			assert_gi(gi_set_pose(r.gi, r.lamp, at(1 + .1f * much * (float)(frame % 3), 1, 1)));
			harness_update(r.gi);
			const double now = largest_beyond(r.gi, SECOND_ROOM, 0);
			most = fmax(most, last > 0 ? now / last : now > 0 ? INFINITY : 0);
			last = now;
			lit += now > 0;
			frames++;
		}
		gi_context_destroy(r.gi);
	}
	printf("  where a weak lamp went out the largest R is at most %.7f of the frame before; light in %u of %u "
	       "frames\n",
	       most, lit, frames);
	assert_true(lit > 0);
	assert_true(most <= 1);
}

/* ---- a room with a wall across and a door in it ---- */

static gi_object add_panel(gi_context *gi, const char *name, float rho, float x, float from, float to)
{
	const harness_object like = {.name = name, .levels = 2, .rho = {rho, rho, rho}, .double_sided = true};
	return add_quad(gi, &like, (float[]){x, 0, from}, (float[]){0, 2, 0}, (float[]){0, 0, to - from});
}

/* The door shuts, and the lamp on the near side flickers and moves: what is beyond only loses light. */
static void a_door_shuts(void **state)
{
	(void)state;
	double most = 0;
	uint32_t lit = 0, frames = 0;
	for (uint32_t k = 0; k < RHO_COUNT * 9; k++) {
		if (!is_taken(k))
			continue;
		static const uint32_t sweeps[] = {1, 3, 8};
		/* Leaves end at the wall. */
		static const struct {
			float wall, length;
			uint32_t levels;
		} plans[] = {{2, 4, 2}, {2.25f, 3, 2}, {2.1875f, 2.5f, 3}}, *p;
		static const float restless[] = {1, .3f, .05f};
		p = &plans[k / RHO_COUNT % 3];
		const float rho = RHOS[k % RHO_COUNT], much = restless[(k + k / 4) % 3];
		gi_context *gi = open_stiff(sweeps[k / (3 * RHO_COUNT) % 3]);
		const harness_object room = {.name = "room", .levels = p->levels, .rho = {rho, rho, rho}};
		add_room(gi, &room, (box){{0, 0, 0}, {p->length, 2, 2}});
		add_panel(gi, "wall", rho, p->wall, 0, .7f);
		add_panel(gi, "wall", rho, p->wall, 1.3f, 2);
		const gi_object door = add_panel(gi, "door", rho, p->wall, .7f, 1.3f);
		const gi_object lamp =
		    add_block(gi, &(harness_object){.name = "lamp", .rho = {rho, rho, rho}, .exitance = {10, 10, 10}},
			      (box){{-.2f, -.1f, -.2f}, {.2f, .1f, .2f}});
		assert_gi(gi_set_pose(gi, lamp, at(1, 1, 1)));
		assert_gi(gi_set_pose(gi, door, at(-.05f, 0, .65f)));
		assert_gi(gi_commit(gi));
		for (int frame = 0; frame < 6; frame++) {
			assert_gi(gi_set_pose(gi, lamp, at(1 + .02f * much * (float)frame, 1, 1)));
			harness_update(gi);
		}
		double last = largest_beyond(gi, p->wall, 0);
		assert_true(last > 0);
		assert_gi(gi_set_pose(gi, door, at(0, 0, 0)));
		for (int frame = 0; frame < FRAMES_SHUT; frame++) {
			const float e = 10 * (1 + .2f * much * (float)(frame % 7));
			const gi_material brighter = {.rho = {rho, rho, rho}, .exitance = {e, e, e}};
			assert_gi(gi_set_material(gi, lamp, 0, brighter));
			assert_gi(gi_set_pose(gi, lamp, at(1 - .02f * much * (float)frame, 1, 1)));
			harness_update(gi);
			const double now = largest_beyond(gi, p->wall, 0);
			most = fmax(most, last > 0 ? now / last : now > 0 ? INFINITY : 0);
			last = now;
			lit += now > 0;
			frames++;
		}
		gi_context_destroy(gi);
	}
	printf(
	    "  beyond a door that shut the largest R is at most %.7f of the frame before; light in %u of %u frames\n",
	    most, lit, frames);
	assert_true(most <= 1 + 1e-6);
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(sealed_rooms_are_dark),
					   cmocka_unit_test(refused_light_is_gone),
					   cmocka_unit_test(a_weak_lamp_goes_out), cmocka_unit_test(a_door_shuts)};
	return cmocka_run_group_tests_name("dark", tests, harness_open, harness_close);
}
