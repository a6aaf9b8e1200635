/* GLFW: a window, its keyboard and its mouse. */
#define GLFW_INCLUDE_NONE
#include "context_internal.h"
#include "library.h"

#include <GLFW/glfw3.h>
#include <stdio.h>
#include <stdlib.h>

/* clang-format off */
#define FUNCTIONS(X) \
	X(glfwInit) X(glfwTerminate) X(glfwGetError) X(glfwWindowHint) X(glfwCreateWindow) X(glfwDestroyWindow) \
	X(glfwMakeContextCurrent) X(glfwGetProcAddress) X(glfwSwapInterval) X(glfwSwapBuffers) \
	X(glfwPollEvents) X(glfwWindowShouldClose) X(glfwGetFramebufferSize) X(glfwGetWindowSize) \
	X(glfwSetWindowSize) X(glfwSetWindowUserPointer) X(glfwGetWindowUserPointer) X(glfwSetKeyCallback) \
	X(glfwSetMouseButtonCallback) X(glfwSetCursorPosCallback) X(glfwSetScrollCallback) \
	X(glfwSetFramebufferSizeCallback)
/* clang-format on */

#define DECLARE(name) __typeof__(name) *name;
#define SYMBOL(function) {#function, offsetof(struct functions, function)},

static struct functions {
	FUNCTIONS(DECLARE)
} glfw;

static const engine_symbol symbols[] = {FUNCTIONS(SYMBOL)};
static const char *const file_names[] = {"libglfw.so.3", "libglfw.so", NULL};

/* GLFW counts from 0 to 1 windows here per context; the library starts with the first and ends with the last. */
static int window_count;
static bool swap_interval_wish;

static int translate_special(int key)
{
	static const int pairs[][2] = {
	    {GLFW_KEY_ESCAPE, ENGINE_KEY_ESCAPE},   {GLFW_KEY_ENTER, ENGINE_KEY_ENTER},
	    {GLFW_KEY_TAB, ENGINE_KEY_TAB},         {GLFW_KEY_BACKSPACE, ENGINE_KEY_BACKSPACE},
	    {GLFW_KEY_LEFT, ENGINE_KEY_LEFT},       {GLFW_KEY_RIGHT, ENGINE_KEY_RIGHT},
	    {GLFW_KEY_UP, ENGINE_KEY_UP},           {GLFW_KEY_DOWN, ENGINE_KEY_DOWN},
	    {GLFW_KEY_PAGE_UP, ENGINE_KEY_PAGE_UP}, {GLFW_KEY_PAGE_DOWN, ENGINE_KEY_PAGE_DOWN},
	    {GLFW_KEY_HOME, ENGINE_KEY_HOME},       {GLFW_KEY_END, ENGINE_KEY_END},
	    {GLFW_KEY_KP_ENTER, ENGINE_KEY_ENTER},
	};
	for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
		if (pairs[i][0] == key)
			return pairs[i][1];
	}
	return 0;
}

/* 0: a key nobody here asks about. GLFW's printable keys are upper-case ASCII already. */
static int translate_key(int key)
{
	if (key >= GLFW_KEY_SPACE && key <= GLFW_KEY_GRAVE_ACCENT)
		return key;
	if (key >= GLFW_KEY_F1 && key <= GLFW_KEY_F12)
		return ENGINE_KEY_F1 + key - GLFW_KEY_F1;
	return translate_special(key);
}

static engine_context *context_of(GLFWwindow *window)
{
	return glfw.glfwGetWindowUserPointer(window);
}

static void on_key(GLFWwindow *window, int glfw_key, int scan_code, int action, int modifiers)
{
	(void)scan_code, (void)modifiers;
	engine_input *input = &context_of(window)->incoming;
	int key = translate_key(glfw_key);
	if (key == 0)
		return;
	input->key_down[key] = action != GLFW_RELEASE;
	if (action != GLFW_RELEASE && input->pressed_count < ENGINE_INPUT_MAX_PRESSED)
		input->pressed[input->pressed_count++] = key;
}

static void on_button(GLFWwindow *window, int button, int action, int modifiers)
{
	(void)modifiers;
	if (button < 0 || button >= ENGINE_MOUSE_COUNT) /* left, right, middle are 0, 1, 2 in GLFW too */
		return;
	engine_input *input = &context_of(window)->incoming;
	input->mouse_down[button] = action == GLFW_PRESS;
	if (action == GLFW_PRESS)
		input->mouse_pressed[button] = true;
}

/* Screen coordinates and pixels differ on displays that scale. */
static float pixels_per_unit(GLFWwindow *window)
{
	int width = 0, height = 0;
	glfw.glfwGetWindowSize(window, &width, &height);
	return width > 0 ? (float)context_of(window)->width / (float)width : 1.0f;
}

static void on_cursor(GLFWwindow *window, double x, double y)
{
	engine_input *input = &context_of(window)->incoming;
	float scale = pixels_per_unit(window);
	float position[2] = {(float)x * scale, (float)y * scale};
	for (int axis = 0; axis < 2; axis++) {
		for (int button = 0; button < ENGINE_MOUSE_COUNT; button++) {
			if (input->mouse_down[button])
				input->drag[button][axis] += position[axis] - input->cursor[axis];
		}
		input->cursor[axis] = position[axis];
	}
}

static void on_scroll(GLFWwindow *window, double x, double y)
{
	(void)x;
	context_of(window)->incoming.scroll += (float)y;
}

static void on_framebuffer_size(GLFWwindow *window, int width, int height)
{
	engine_context *context = context_of(window);
	context->width = width;
	context->height = height;
	context->incoming.resized = true;
}

static void listen(GLFWwindow *window, engine_context *context)
{
	glfw.glfwSetWindowUserPointer(window, context);
	glfw.glfwSetKeyCallback(window, on_key);
	glfw.glfwSetMouseButtonCallback(window, on_button);
	glfw.glfwSetCursorPosCallback(window, on_cursor);
	glfw.glfwSetScrollCallback(window, on_scroll);
	glfw.glfwSetFramebufferSizeCallback(window, on_framebuffer_size);
}

static void give_hints(const engine_context_def *def)
{
	glfw.glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
	glfw.glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
	glfw.glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
	glfw.glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, def->debug);
	glfw.glfwWindowHint(GLFW_VISIBLE, !def->hidden);
	glfw.glfwWindowHint(GLFW_DEPTH_BITS, 0); /* drawing happens in framebuffer objects */
}

static void write_error(const char *what, char *message, size_t message_size)
{
	const char *description = NULL;
	glfw.glfwGetError(&description);
	snprintf(message, message_size, "%s (%s); use --context egl", what,
		 description ? description : "no reason given");
}

static void end_library(void)
{
	if (window_count == 0)
		glfw.glfwTerminate();
}

static GLFWwindow *create_window(const engine_context_def *def, char *message, size_t message_size)
{
	if (!glfw.glfwInit()) {
		write_error("no display for a window", message, message_size);
		return NULL;
	}
	give_hints(def);
	GLFWwindow *window = glfw.glfwCreateWindow(def->width, def->height, def->title ? def->title : "", NULL, NULL);
	if (!window) {
		write_error("no window with OpenGL 4.5 core", message, message_size);
		end_library();
	}
	return window;
}

static bool is_set(const char *variable)
{
	const char *value = getenv(variable);
	return value && value[0];
}

static bool glfw_open(engine_context *context, const engine_context_def *def, char *message, size_t message_size)
{
	/* Not asked of GLFW: the libraries that it tries write to stderr themselves. */
	if (!is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY")) {
		snprintf(message, message_size,
			 "no display for a window (neither DISPLAY nor WAYLAND_DISPLAY is set); use --context egl");
		return false;
	}
	if (!engine_library_load(file_names, symbols, sizeof symbols / sizeof symbols[0], &glfw,
				 "install libglfw3 or use --context egl", message, message_size))
		return false;
	GLFWwindow *window = create_window(def, message, message_size);
	if (!window)
		return false;
	window_count++;
	context->native = window;
	swap_interval_wish = def->vsync;
	listen(window, context);
	glfw.glfwGetFramebufferSize(window, &context->width, &context->height);
	return true;
}

static void glfw_close(engine_context *context)
{
	glfw.glfwDestroyWindow(context->native);
	context->native = NULL;
	window_count--;
	end_library();
}

static bool glfw_make_current(engine_context *context)
{
	glfw.glfwMakeContextCurrent(context->native);
	if (context->native)
		glfw.glfwSwapInterval(swap_interval_wish ? 1 : 0);
	return true;
}

static engine_gl_proc glfw_get_proc(const char *name)
{
	return glfw.glfwGetProcAddress(name);
}

static bool glfw_resize(engine_context *context, int width, int height)
{
	float scale = pixels_per_unit(context->native);
	glfw.glfwSetWindowSize(context->native, (int)((float)width / scale), (int)((float)height / scale));
	return true;
}

static void glfw_swap(engine_context *context)
{
	glfw.glfwSwapBuffers(context->native);
}

static void glfw_poll(engine_context *context)
{
	glfw.glfwPollEvents();
	if (glfw.glfwWindowShouldClose(context->native))
		context->should_close = true;
}

const engine_context_backend engine_context_backend_glfw = {
    .open = glfw_open,
    .close = glfw_close,
    .make_current = glfw_make_current,
    .get_proc = glfw_get_proc,
    .resize = glfw_resize,
    .swap = glfw_swap,
    .poll = glfw_poll,
};
