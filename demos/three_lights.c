/* The demo: lights without a surface in a room: a sun through the window, which moves, a lamp inside its lampshade, and
 * a torch that flickers. */
#include "player.h"
#include "scenes/body.h"
#include "scenes/shapes.h"

#include <cglm/cglm.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OBJECTS = 14, SHADE_SIDES = 32, TABLE_PARTS = 5, BARS = 2, SUN = 0, LAMP = 1, TORCH = 2, LIGHTS = 3 };

/* Metres. The room, the window in its wall at +x, and where the lamps are. */
static const float WIDE = 5, HIGH = 2.7f, DEEP = 4;
static const float WINDOW[2][2] = {{0.8f, 2.2f}, {-1.4f, 0.6f}}; /* y, z */
static const float SHADE[3] = {-1.5f, 1.6f, -1.2f}, FLAME[3] = {0.4f, 1.85f, -1.8f};

/* pi times the radiance of what is seen through the window, W/m2. */
static const float SKY[3] = {5, 6, 8};

/* Seconds in which the sun comes and goes. */
static const double DAY = 16;

typedef struct three_lights {
	options options;
	gi_object handles[OBJECTS];
	const char *names[OBJECTS];
	uint32_t count;
	gi_light lights[LIGHTS];
} three_lights;

static const float WHITE[3] = {0.75f, 0.73f, 0.7f}, FLOOR[3] = {0.5f, 0.36f, 0.24f}, BLUE[3] = {0.3f, 0.42f, 0.55f},
		   WOOD[3] = {0.45f, 0.28f, 0.16f}, CLOTH[3] = {0.8f, 0.72f, 0.6f}, IRON[3] = {0.15f, 0.15f, 0.15f};

/* ---- objects ---- */

/* Takes the mesh. */
static gi_result add(three_lights *t, gi_context *gi, const char *name, const float rho[3], engine_mesh *mesh,
		     float leaf)
{
	gi_object_def def = scene_mesh_def(mesh);
	gi_material material = {{rho[0], rho[1], rho[2]}, {0, 0, 0}};
	def.name = t->names[t->count] = name;
	def.materials = &material;
	def.material_count = 1;
	def.leaf_size = t->options.leaf_size > 0 ? t->options.leaf_size : leaf;
	const gi_result result = gi_create_object(gi, &def, &t->handles[t->count]);
	t->count += !result;
	engine_mesh_free(mesh);
	return result;
}

static gi_result add_wall(three_lights *t, gi_context *gi, const char *name, const float rho[3], const float corner[3],
			  const float u[3], const float v[3])
{
	engine_mesh mesh;
	return shape_quad(corner, u, v, 1, 1, &mesh) ? add(t, gi, name, rho, &mesh, 0.2f) : GI_ERROR_OUT_OF_MEMORY;
}

static bool append_box(engine_mesh *to, const float lower[3], const float upper[3])
{
	engine_mesh box;
	return shape_box(lower, upper, 1, false, &box) && shape_append(to, &box);
}

/* The wall with the window, seen from inside: below, above, and on both sides of it. */
static gi_result add_window_wall(three_lights *t, gi_context *gi)
{
	const float x = WIDE / 2, y0 = WINDOW[0][0], y1 = WINDOW[0][1], z0 = WINDOW[1][0], z1 = WINDOW[1][1];
	const float parts[4][4] = {{0, y0, -DEEP / 2, DEEP / 2},
				   {y1, HIGH, -DEEP / 2, DEEP / 2},
				   {y0, y1, -DEEP / 2, z0},
				   {y0, y1, z1, DEEP / 2}};
	engine_mesh mesh = {0};
	bool made = true;
	for (int k = 0; k < 4 && made; k++) {
		const float *p = parts[k], corner[3] = {x, p[0], p[2]}, u[3] = {0, 0, p[3] - p[2]},
			    v[3] = {0, p[1] - p[0], 0};
		made = shape_append_quad(&mesh, corner, u, v, 100);
	}
	return made ? add(t, gi, "window wall", WHITE, &mesh, 0.2f) : GI_ERROR_OUT_OF_MEMORY;
}

static gi_result add_bars(three_lights *t, gi_context *gi)
{
	const float x = WIDE / 2, y = (WINDOW[0][0] + WINDOW[0][1]) / 2, z = (WINDOW[1][0] + WINDOW[1][1]) / 2;
	const float boxes[BARS][2][3] = {
	    {{x - 0.03f, WINDOW[0][0], z - 0.03f}, {x + 0.03f, WINDOW[0][1], z + 0.03f}},
	    {{x - 0.029f, y - 0.03f, WINDOW[1][0]}, {x + 0.029f, y + 0.03f, WINDOW[1][1]}}};
	engine_mesh mesh = {0};
	bool made = true;
	for (int k = 0; k < BARS && made; k++)
		made = append_box(&mesh, boxes[k][0], boxes[k][1]);
	return made ? add(t, gi, "window bars", WHITE, &mesh, 0.1f) : GI_ERROR_OUT_OF_MEMORY;
}

static gi_result add_table(three_lights *t, gi_context *gi)
{
	const float boxes[TABLE_PARTS][2][3] = {{{-0.1f, 0.7f, -0.5f}, {1.3f, 0.75f, 0.4f}},
						{{-0.05f, 0, -0.45f}, {0.01f, 0.7f, -0.39f}},
						{{1.19f, 0, -0.45f}, {1.25f, 0.7f, -0.39f}},
						{{-0.05f, 0, 0.29f}, {0.01f, 0.7f, 0.35f}},
						{{1.19f, 0, 0.29f}, {1.25f, 0.7f, 0.35f}}};
	engine_mesh mesh = {0};
	bool made = true;
	for (int k = 0; k < TABLE_PARTS && made; k++)
		made = append_box(&mesh, boxes[k][0], boxes[k][1]);
	return made ? add(t, gi, "table", WOOD, &mesh, 0.12f) : GI_ERROR_OUT_OF_MEMORY;
}

static gi_result add_ball(three_lights *t, gi_context *gi)
{
	engine_mesh mesh;
	const scene_body ball = {.name = "ball",
				 .scheme = GI_SCHEME_CATMULL_CLARK,
				 .leaf_size = t->options.leaf_size > 0 ? t->options.leaf_size : 0.06f,
				 .rho = BLUE,
				 .position = {0.55f, 0.94f, 0}};
	if (!shape_sphere(0.2f, 3, &mesh))
		return GI_ERROR_OUT_OF_MEMORY;
	t->names[t->count] = ball.name;
	const gi_result result = scene_add_body(gi, &ball, &mesh, &t->handles[t->count]);
	t->count += !result;
	return result;
}

/* A quad of any four corners, counter-clockwise seen from its front. */
static bool append_facet(engine_mesh *to, const float c[4][3])
{
	float u[3], v[3], across[3];
	engine_mesh facet;
	glm_vec3_sub((float *)c[1], (float *)c[0], u);
	glm_vec3_sub((float *)c[3], (float *)c[0], v);
	glm_vec3_add((float *)c[1], v, across);
	if (!shape_quad(c[0], u, v, 1, 1, &facet))
		return false;
	for (uint32_t k = 0; k < facet.vertex_count; k++)
		if (glm_vec3_distance(facet.positions + 3 * k, across) < 1e-5f)
			memcpy(facet.positions + 3 * k, c[2], sizeof c[2]);
	return shape_append(to, &facet);
}

/* Between two circles about the shade's axis, heights and radii; its front is to the right of the way from the first
 * to the second, seen from where the axis is to the left. */
static bool append_ring(engine_mesh *to, const float first[2], const float second[2])
{
	bool made = true;
	for (int k = 0; k < SHADE_SIDES && made; k++) {
		float c[4][3];
		for (int n = 0; n < 4; n++) {
			const float *circle = n < 2 ? first : second, side = (float)(k + (n == 0 || n == 3));
			const float angle = 2 * GLM_PIf * side / SHADE_SIDES;
			c[n][0] = SHADE[0] + circle[1] * cosf(angle);
			c[n][1] = SHADE[1] + circle[0];
			c[n][2] = SHADE[2] + circle[1] * sinf(angle);
		}
		made = append_facet(to, (const float(*)[3])c);
	}
	return made;
}

/* A truncated cone, open above and below, of some thickness. */
static gi_result add_shade(three_lights *t, gi_context *gi)
{
	static const float circles[4][2] = {{-0.16f, 0.24f}, {0.16f, 0.15f}, {0.16f, 0.144f}, {-0.16f, 0.234f}};
	engine_mesh mesh = {0};
	bool made = true;
	for (int k = 0; k < 4 && made; k++)
		made = append_ring(&mesh, circles[k], circles[(k + 1) % 4]);
	return made ? add(t, gi, "lampshade", CLOTH, &mesh, 0.08f) : GI_ERROR_OUT_OF_MEMORY;
}

static gi_result add_stands(three_lights *t, gi_context *gi)
{
	engine_mesh mesh = {0};
	const float pole[2][3] = {{SHADE[0] - 0.015f, 0, SHADE[2] - 0.015f},
				  {SHADE[0] + 0.015f, 1.44f, SHADE[2] + 0.015f}};
	const float foot[2][3] = {{SHADE[0] - 0.15f, 0, SHADE[2] - 0.15f}, {SHADE[0] + 0.15f, 0.03f, SHADE[2] + 0.15f}};
	const float torch[2][3] = {{FLAME[0] - 0.03f, 1.45f, FLAME[2] - 0.03f},
				   {FLAME[0] + 0.03f, 1.75f, FLAME[2] + 0.03f}};
	const float arm[2][3] = {{FLAME[0] - 0.01f, 1.58f, -DEEP / 2}, {FLAME[0] + 0.01f, 1.62f, FLAME[2] - 0.03f}};
	const bool made = append_box(&mesh, pole[0], pole[1]) && append_box(&mesh, foot[0], foot[1]) &&
			  append_box(&mesh, torch[0], torch[1]) && append_box(&mesh, arm[0], arm[1]);
	return made ? add(t, gi, "stands", IRON, &mesh, 0.1f) : GI_ERROR_OUT_OF_MEMORY;
}

static gi_result add_objects(three_lights *t, gi_context *gi)
{
	const float x = WIDE / 2, z = DEEP / 2, along_x[3] = {WIDE, 0, 0}, up[3] = {0, HIGH, 0},
		    along_z[3] = {0, 0, DEEP};
	gi_result result = add_wall(t, gi, "floor", FLOOR, (float[]){-x, 0, -z}, along_z, along_x);
	if (!result)
		result = add_wall(t, gi, "ceiling", WHITE, (float[]){-x, HIGH, -z}, along_x, along_z);
	if (!result)
		result = add_wall(t, gi, "back wall", WHITE, (float[]){-x, 0, -z}, along_x, up);
	if (!result)
		result = add_wall(t, gi, "front wall", WHITE, (float[]){-x, 0, z}, up, along_x);
	if (!result)
		result = add_wall(t, gi, "left wall", BLUE, (float[]){-x, 0, -z}, up, along_z);
	gi_result (*const rest[])(three_lights *, gi_context *) = {add_window_wall, add_bars,  add_table,
								   add_ball,        add_shade, add_stands};
	for (size_t k = 0; !result && k < sizeof rest / sizeof *rest; k++)
		result = rest[k](t, gi);
	return result;
}

/* ---- lights ---- */

static void set_color(gi_light_def *def, float r, float g, float b, float factor)
{
	def->intensity[0] = r * factor;
	def->intensity[1] = g * factor;
	def->intensity[2] = b * factor;
}

/* Smooth, and never the same twice within some minutes. */
static float flicker(double time_s)
{
	const double s = sin(13.1 * time_s) + 0.7 * sin(7.3 * time_s + 1) + 0.5 * sin(23.9 * time_s + 2);
	return (float)(1 + 0.25 * s);
}

static gi_light_def light_at(int which, double time_s)
{
	gi_light_def def = gi_light_def_default();
	const double day = time_s / DAY * 2 * GLM_PI;
	if (which == SUN) {
		def.type = GI_LIGHT_DIRECTIONAL;
		def.direction[0] = -1;
		def.direction[1] = -0.52f - 0.12f * (float)sin(day);
		def.direction[2] = 0.12f + 0.25f * (float)sin(day);
		def.angular_radius = 0.00465f;
		set_color(&def, 1, 0.84f, 0.62f, 40);
	} else if (which == LAMP) {
		memcpy(def.position, SHADE, sizeof SHADE);
		def.radius = 0.035f;
		set_color(&def, 1, 0.72f, 0.42f, 3.5f);
	} else {
		memcpy(def.position, FLAME, sizeof FLAME);
		def.radius = 0.03f;
		set_color(&def, 1, 0.45f, 0.12f, 4 * flicker(time_s));
	}
	return def;
}

static bool create(void *user, gi_context *gi, char *message, size_t message_size)
{
	three_lights *t = user;
	gi_result result = gi_set_sky(gi, GI_SKY_ON, SKY);
	if (!result)
		result = add_objects(t, gi);
	for (int k = 0; !result && k < LIGHTS; k++) {
		const gi_light_def def = light_at(k, 0);
		result = gi_create_light(gi, &def, &t->lights[k]);
	}
	if (result && !message[0])
		snprintf(message, message_size, "the room cannot be built: %s", gi_result_text(result));
	return result == GI_OK;
}

static gi_result animate(void *user, gi_context *gi, double time_s)
{
	three_lights *t = user;
	gi_result result = GI_OK;
	for (int k = 0; !result && k < LIGHTS; k++) {
		const gi_light_def def = light_at(k, time_s);
		result = gi_set_light(gi, t->lights[k], &def);
	}
	return result;
}

static void view(void *user, double time_s, camera *out)
{
	(void)user;
	(void)time_s;
	*out = (camera){.eye = {-0.55f, 1.5f, 1.95f},
			.target = {-0.1f, 1.15f, -1},
			.up = {0, 1, 0},
			.vertical_fov = 1.25f,
			.radius = 3};
}

static export_objects objects(void *user)
{
	const three_lights *t = user;
	return (export_objects){t->handles, t->names, t->count};
}

static error_t parse(int key, char *text, struct argp_state *state)
{
	three_lights *t = state->input;
	if (key == ARGP_KEY_INIT)
		state->child_inputs[0] = &t->options;
	else if (key == ARGP_KEY_ARG)
		options_fail(t->options.program, "%s: takes options only; see --help", text);
	else
		return ARGP_ERR_UNKNOWN;
	return 0;
}

static const struct argp_child children[] = {{&options_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .parser = parse,
    .children = children,
    .doc = "A room lit by a sun through its window, which moves, by a lamp inside a lampshade and by a torch that "
	   "flickers, none of which has a surface.\vWithout a window pictures and report go to out/three_lights unless "
	   "--out says otherwise.",
};

int main(int argc, char **argv)
{
	three_lights t = {.options = options_default("three_lights")};
	t.options.out = "out/three_lights";
	options_parse(&parser, argc, argv, &t);
	const player_scene scene = {.user = &t,
				    .title = "three_lights",
				    .create = create,
				    .animate = animate,
				    .view = view,
				    .objects = objects,
				    .loop_s = DAY,
				    .frames = 48,
				    .gallery = true,
				    .report = "frames.csv"};
	return player_run(&t.options, &scene);
}
