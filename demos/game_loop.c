/* A whole game loop: GLFW's window, a room with a lamp, a box that moves, gi's light.
 *
 *     game_loop [FRAMES]    default: until the window is closed
 * Units are metres and W/m2; y is up. The window's framebuffer takes linear light and keeps it as sRGB.
 */
#include <gi/gi.h>

#define GLFW_INCLUDE_GLEXT
#include <GLFW/glfw3.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static gi_proc find_gl(const char *name, void *user)
{
	(void)user;
	return (gi_proc)glfwGetProcAddress(name);
}

/* Ends the program where a call failed; what was wrong went to stderr. */
static void check(gi_result result)
{
	if (result)
		exit(EXIT_FAILURE);
}

static gi_object add(gi_context *gi, const char *name, const float *positions, uint32_t vertices,
		     const uint32_t *indices, uint32_t faces, gi_material material)
{
	gi_object object;
	gi_object_def def = gi_object_def_default();
	def.name = name;
	def.positions = positions;
	def.vertex_count = vertices;
	def.indices = indices;
	def.index_count = 4 * faces;
	def.face_count = faces;
	def.leaf_size = .3f; /* light is computed in patches of this edge: 1,000 here */
	def.materials = &material;
	def.material_count = 1;
	check(gi_create_object(gi, &def, &object));
	return object;
}

/* A rectangle from `c` along u and v, seen from where u turns counter-clockwise into v. */
static void add_wall(gi_context *gi, const char *name, const float c[3], const float u[3], const float v[3],
		     gi_material material)
{
	static const uint32_t indices[4] = {0, 1, 2, 3};
	float positions[12];
	for (int k = 0; k < 3; k++) {
		positions[k] = c[k];
		positions[3 + k] = c[k] + u[k];
		positions[6 + k] = c[k] + u[k] + v[k];
		positions[9 + k] = c[k] + v[k];
	}
	add(gi, name, positions, 4, indices, 1, material);
}

static void add_room(gi_context *gi)
{
	static const float x[3] = {4, 0, 0}, y[3] = {0, 3, 0}, z[3] = {0, 0, 4}, lx[3] = {1, 0, 0}, lz[3] = {0, 0, 1};
	static const float low[3] = {-2, 0, -2}, high[3] = {-2, 3, -2}, front[3] = {-2, 0, 2}, right[3] = {2, 0, -2},
			   lamp[3] = {-.5f, 2.99f, -.5f};
	const gi_material grey = {.rho = {.7f, .7f, .7f}}, red = {.rho = {.6f, .1f, .1f}},
			  green = {.rho = {.1f, .5f, .1f}}, light = {.exitance = {25, 22, 18}};
	add_wall(gi, "floor", low, z, x, grey);
	add_wall(gi, "ceiling", high, x, z, grey);
	add_wall(gi, "back", low, x, y, grey);
	add_wall(gi, "front", front, y, x, grey);
	add_wall(gi, "left", low, y, z, red);
	add_wall(gi, "right", right, z, y, green);
	add_wall(gi, "lamp", lamp, lx, lz, light);
}

static gi_object add_box(gi_context *gi, float half)
{
	static const uint32_t indices[24] = {0, 4, 6, 2, 1, 3, 7, 5, 0, 1, 5, 4, 2, 6, 7, 3, 0, 2, 3, 1, 4, 5, 7, 6};
	const gi_material white = {.rho = {.8f, .8f, .8f}};
	float positions[24];
	for (int k = 0; k < 24; k++)
		positions[k] = (k / 3) >> (k % 3) & 1 ? half : -half;
	return add(gi, "box", positions, 8, indices, 6, white);
}

/* From 6 m before the room, 60 degrees high. Backs of walls are not drawn: one looks in through the front. */
static gi_view view_of(int width, int height)
{
	const float near = .1f, far = 50, scale = 1.7f;
	gi_view view = gi_view_default();
	view.width = (uint32_t)width;
	view.height = (uint32_t)height;
	view.view_from_world[13] = -1.5f;
	view.view_from_world[14] = -6;
	memset(view.clip_from_view, 0, sizeof view.clip_from_view);
	view.clip_from_view[0] = scale * (float)height / (float)width;
	view.clip_from_view[5] = scale;
	view.clip_from_view[10] = -(far + near) / (far - near);
	view.clip_from_view[11] = -1;
	view.clip_from_view[14] = -2 * far * near / (far - near);
	return view;
}

int main(int argc, char **argv)
{
	const int frames = argc > 1 ? atoi(argv[1]) : -1;
	glfwInit();
	glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
	glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
	glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
	glfwWindowHint(GLFW_SRGB_CAPABLE, GLFW_TRUE);
	GLFWwindow *window = glfwCreateWindow(640, 480, "Relume", NULL, NULL);
	if (!window)
		return EXIT_FAILURE;
	glfwMakeContextCurrent(window);
	glEnable(GL_FRAMEBUFFER_SRGB);

	gi_context_def def = gi_context_def_default();
	def.get_proc_address = find_gl;
	gi_context *gi;
	check(gi_context_create(&def, &gi));
	add_room(gi);
	const gi_object box = add_box(gi, .4f);
	check(gi_commit(gi));

	gi_report report = {0};
	int width, height;
	for (int frame = 0; frame != frames && !glfwWindowShouldClose(window); frame++) {
		const float angle = .02f * (float)frame;
		const gi_pose pose = {{cosf(angle), .8f, sinf(angle)}, {0, sinf(angle / 2), 0, cosf(angle / 2)}};
		glfwGetFramebufferSize(window, &width, &height);
		const gi_view view = view_of(width, height);
		const gi_budget budget = {
		    .ms = 8, .view = width && height ? &view : NULL}; /* the rest is done in later frames */
		check(gi_set_pose(gi, box, pose));
		check(gi_update(gi, &budget));
		glViewport(0, 0, width, height);
		glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
		check(width && height ? gi_draw(gi, &view) : GI_OK); /* a minimised window has no pixels */
		glfwSwapBuffers(window);
		glfwPollEvents();
		check(gi_get_report(gi, &report));
	}
	printf("%u leaves, %llu entries, B within %.2g of the rows' solution\n", report.leaves,
	       (unsigned long long)report.entries, (double)report.solve_bound);
	gi_context_destroy(gi);
	return 0;
}
