/* OpenGL 4.5 core contexts: a window (GLFW), headless on a GPU or on Mesa (EGL), or headless in plain memory (OSMesa).
 *
 * The three libraries are loaded at run time, so one program starts on a desktop, on a server that has only a GPU
 * driver and on a machine without any GPU; a library that is missing is a message, not a failure to start.
 * All kinds run the same code after creation: the host draws into its own framebuffer objects (see tonemap.h) and
 * only a window has a default framebuffer worth blitting to.
 *
 * One context is current at a time in a process, on the thread that made it so. The GL functions of <glad/gl.h> are
 * loaded by engine_context_create() and again by engine_context_make_current() when the context changes.
 */
#ifndef ENGINE_CONTEXT_H
#define ENGINE_CONTEXT_H

#include "gl_proc.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum engine_context_kind {
	ENGINE_CONTEXT_AUTO,   /* glfw where a display is set and works, else osmesa, else egl */
	ENGINE_CONTEXT_GLFW,   /* a window */
	ENGINE_CONTEXT_EGL,    /* headless: first hardware device that gives 4.5 core, else surfaceless Mesa */
	ENGINE_CONTEXT_OSMESA, /* headless: llvmpipe into client memory; Mesa has none after 25.0, use egl there */
} engine_context_kind;

typedef struct engine_context_def {
	engine_context_kind kind; /* AUTO */
	int width, height; /* pixels of the framebuffer, 1..16384, 512 x 512; a window may differ, ask the context */
	const char *title; /* of the window, "Relume"; read during creation only */
	bool hidden;       /* false; true: glfw makes an invisible window (tests) */
	bool vsync;        /* true; glfw only: a swap waits for the display */
	bool debug;        /* false; ask the driver for a debug context */
	uint32_t cookie;   /* set by engine_context_def_default(); tells a struct nobody initialised */
} engine_context_def;

typedef struct engine_context engine_context;

/* Keys: printable ones are their upper-case ASCII code ('W', '1', ' '), the rest start at 256. */
typedef enum engine_key {
	ENGINE_KEY_ESCAPE = 256,
	ENGINE_KEY_ENTER,
	ENGINE_KEY_TAB,
	ENGINE_KEY_BACKSPACE,
	ENGINE_KEY_LEFT,
	ENGINE_KEY_RIGHT,
	ENGINE_KEY_UP,
	ENGINE_KEY_DOWN,
	ENGINE_KEY_PAGE_UP,
	ENGINE_KEY_PAGE_DOWN,
	ENGINE_KEY_HOME,
	ENGINE_KEY_END,
	ENGINE_KEY_F1, /* F1 .. F12 follow each other */
	ENGINE_KEY_COUNT = ENGINE_KEY_F1 + 12,
} engine_key;

enum { ENGINE_MOUSE_LEFT, ENGINE_MOUSE_RIGHT, ENGINE_MOUSE_MIDDLE, ENGINE_MOUSE_COUNT };
enum { ENGINE_INPUT_MAX_PRESSED = 32 };

/* What the user did between the last two polls, and what is held now. All zero without a window.
 * Lengths are framebuffer pixels, x to the right, y down.
 */
typedef struct engine_input {
	int pressed[ENGINE_INPUT_MAX_PRESSED]; /* keys that went down or repeated, in order; more than fit are lost */
	int pressed_count;
	bool key_down[ENGINE_KEY_COUNT];        /* held now, by key */
	bool mouse_down[ENGINE_MOUSE_COUNT];    /* held now */
	bool mouse_pressed[ENGINE_MOUSE_COUNT]; /* went down since the last poll */
	float drag[ENGINE_MOUSE_COUNT][2];      /* how far the cursor went while that button was held */
	float cursor[2];                        /* now, from the top left corner */
	float scroll;                           /* wheel notches, away from the user is positive */
	bool resized;                           /* width or height changed since the last poll */
} engine_input;

engine_context_def engine_context_def_default(void);

/* "auto", "glfw", "egl" or "osmesa". Returns false and leaves *kind alone for any other name. */
bool engine_context_kind_from_name(const char *name, engine_context_kind *kind);
const char *engine_context_kind_name(engine_context_kind kind);

/* Makes a context, makes it current, checks for OpenGL 4.5 core and loads the functions of <glad/gl.h>.
 * Returns NULL after writing one line to message (at most message_size bytes with the terminator) that says what is
 * missing and what to do. The caller owns the result.
 */
engine_context *engine_context_create(const engine_context_def *def, char *message, size_t message_size);

/* Ends a context; its GL objects go with it. NULL is fine. No context is current afterwards if this one was. */
void engine_context_destroy(engine_context *context);

/* Makes the context current on this thread; whichever was current before is released. False if the system refuses. */
bool engine_context_make_current(engine_context *context);

/* Never AUTO: what creation settled on. */
engine_context_kind engine_context_get_kind(const engine_context *context);

/* Looks up a GL function of an engine_context, which must be current. */
engine_gl_proc engine_context_find_gl(const char *name, void *context);

/* GL_RENDERER and GL_VERSION in one line, e.g. for reports. Lives as long as the context. */
const char *engine_context_describe(const engine_context *context);

/* Framebuffer size in pixels, now. May be 0 x 0 while a window is minimised. */
int engine_context_width(const engine_context *context);
int engine_context_height(const engine_context *context);

/* Asks for another framebuffer size, 1..16384 each. A window follows when the window manager allows (seen at a later
 * poll), the headless kinds at once. False and unchanged if the size is out of range or memory is short.
 */
bool engine_context_resize(engine_context *context, int width, int height);

/* True where a default framebuffer is shown to somebody: blit into framebuffer 0 before swapping. */
bool engine_context_has_window(const engine_context *context);

/* Shows the frame. Headless kinds only flush, so that a driver starts working. */
void engine_context_swap(engine_context *context);

/* Collects what happened since the last call; the input stays valid and constant until the next. */
const engine_input *engine_context_poll(engine_context *context);

/* True once the user closed the window or engine_context_request_close() was called. */
bool engine_context_should_close(const engine_context *context);
void engine_context_request_close(engine_context *context);

#ifdef __cplusplus
}
#endif

#endif
