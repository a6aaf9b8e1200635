#include "random_scene.h"

#include "scenes/shapes.h"

#include <math.h>

/* splitmix64 (Steele, Lea and Flood 2014). */
static uint64_t next(random_scene *s)
{
	uint64_t z = s->state += 0x9e3779b97f4a7c15u;
	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
	z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
	return z ^ (z >> 31);
}

double random_scene_draw(random_scene *s)
{
	return (double)(next(s) >> 11) * 0x1p-53;
}

static float between(random_scene *s, double low, double high)
{
	return (float)(low + (high - low) * random_scene_draw(s));
}

static uint32_t below(random_scene *s, uint32_t n)
{
	return (uint32_t)(random_scene_draw(s) * n);
}

static bool chance(random_scene *s, double p)
{
	return random_scene_draw(s) < p;
}

static gi_pose random_pose(random_scene *s)
{
	gi_pose p = {{between(s, -1.5, 1.5), between(s, 0.4, 2.4), between(s, -1.5, 1.5)}, {0}};
	for (int k = 0; k < 4; k++)
		p.rotation[k] = between(s, -1, 1);
	p.rotation[3] += 1.5f; /* never zero */
	return p;
}

/* Ordinary, or as near to 1 as the scene has it. */
static void random_rho(random_scene *s, float rho[3])
{
	const bool bright = chance(s, 0.6);
	for (int c = 0; c < 3; c++)
		rho[c] = bright ? s->brightest_rho * between(s, 0.99, 1) : between(s, 0, 0.8);
	if (bright && chance(s, 0.5))
		rho[below(s, 3)] = s->brightest_rho;
}

static void random_exitance(random_scene *s, float exitance[3], bool lit)
{
	const float size = powf(10, between(s, -2, 3));
	for (int c = 0; c < 3; c++)
		exitance[c] = lit ? size * between(s, 0, 1) : 0;
}

static gi_object add(gi_context *gi, random_scene *s, uint32_t levels, bool lit, bool lying, engine_mesh *mesh)
{
	harness_object like = {.name = "random", .levels = levels, .double_sided = lying};
	random_rho(s, like.rho);
	random_exitance(s, like.exitance, lit);
	return harness_add(gi, &like, mesh);
}

static void add_surroundings(gi_context *gi, random_scene *s)
{
	engine_mesh mesh;
	if (chance(s, 0.7))
		assert_true(shape_box((float[]){-2, 0, -2}, (float[]){2, 3, 2}, 1, true, &mesh));
	else
		assert_true(shape_quad((float[]){-2, 0, -2}, (float[]){0, 0, 4}, (float[]){4, 0, 0}, 1, 1, &mesh));
	s->objects[s->count++] = add(gi, s, 1 + below(s, 2), chance(s, 0.3), false, &mesh);
	s->fixed = s->count;
}

static void add_thing(gi_context *gi, random_scene *s, bool lit)
{
	engine_mesh mesh;
	const float size = between(s, 0.1, 0.5);
	const uint32_t kind = below(s, 3);
	if (kind == 0)
		assert_true(shape_box((float[]){-size, -size, -size}, (float[]){size, size, size}, 1, false, &mesh));
	else if (kind == 1)
		assert_true(shape_sphere(size, 1, &mesh));
	else
		assert_true(shape_quad((float[]){-size, 0, -size}, (float[]){0, 0, 2 * size}, (float[]){2 * size, 0, 0},
				       1, 1, &mesh));
	const gi_object object = add(gi, s, 1, lit, kind == 2 && chance(s, 0.5), &mesh);
	assert_gi(gi_set_pose(gi, object, random_pose(s)));
	s->objects[s->count++] = object;
}

static void fill(gi_context *gi, random_scene *s)
{
	add_surroundings(gi, s);
	const uint32_t things = 1 + below(s, 4);
	for (uint32_t k = 0; k < things; k++)
		add_thing(gi, s, k == 0 || chance(s, 0.3));
	assert_gi(gi_commit(gi));
}

random_scene random_scene_make(gi_context *gi, uint64_t seed)
{
	random_scene s = {.state = seed * 0xd1342543de82ef95u + 1};
	const double kind = random_scene_draw(&s);
	s.brightest_rho = kind < 0.1 ? 0.9999f : kind < 0.4 ? 0.999f : kind < 0.6 ? 0.99f : 0.8f;
	fill(gi, &s);
	return s;
}

random_scene random_scene_make_stiff(gi_context *gi, uint64_t seed)
{
	random_scene s = {.state = seed * 0xd1342543de82ef95u + 1};
	s.brightest_rho = (float)(1 - pow(10, -1 - 5 * random_scene_draw(&s)));
	fill(gi, &s);
	return s;
}

static void nudge(gi_context *gi, random_scene *s, gi_object object)
{
	gi_pose pose;
	assert_gi(gi_get_pose(gi, object, &pose));
	for (int k = 0; k < 3; k++)
		pose.position[k] += between(s, -0.05, 0.05);
	for (int k = 0; k < 4; k++)
		pose.rotation[k] += between(s, -0.02, 0.02);
	assert_gi(gi_set_pose(gi, object, pose));
}

void random_scene_move(gi_context *gi, random_scene *s)
{
	if (chance(s, 0.15)) {
		gi_material material;
		random_rho(s, material.rho);
		random_exitance(s, material.exitance, true);
		assert_gi(gi_set_material(gi, s->objects[below(s, s->count)], 0, material));
	}
	const uint32_t movers = below(s, s->count - s->fixed + 1);
	for (uint32_t k = 0; k < movers; k++) {
		const gi_object object = s->objects[s->fixed + below(s, s->count - s->fixed)];
		if (chance(s, 0.6))
			nudge(gi, s, object);
		else
			assert_gi(gi_set_pose(gi, object, random_pose(s)));
	}
}

void random_scene_clear(gi_context *gi, random_scene *s)
{
	for (uint32_t k = 0; k < s->count; k++)
		assert_gi(gi_destroy_object(gi, s->objects[k]));
	assert_gi(gi_commit(gi));
	s->count = 0;
}
