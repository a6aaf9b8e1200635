/* EGL without a window system. Displays are tried in this order, the first that gives 4.5 core wins:
 *
 *   1. every hardware device of EGL_EXT_device_enumeration (NVIDIA's driver, Mesa with a render node)
 *   2. EGL_MESA_platform_surfaceless (llvmpipe where there is no GPU)
 *   3. software devices, for Mesa builds without the surfaceless platform
 *
 * A context needs no surface where EGL_KHR_surfaceless_context is there, else it gets a pbuffer of 1 x 1: all drawing
 * goes into framebuffer objects.
 */
#define EGL_NO_X11 /* <EGL/eglplatform.h> would ask for the X11 headers */
#include "context_internal.h"
#include "library.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* clang-format off */
#define FUNCTIONS(X) \
	X(eglGetProcAddress) X(eglQueryString) X(eglInitialize) X(eglBindAPI) X(eglChooseConfig) \
	X(eglCreateContext) X(eglDestroyContext) X(eglCreatePbufferSurface) X(eglDestroySurface) \
	X(eglMakeCurrent)
/* clang-format on */

#define DECLARE(name) __typeof__(name) *name;
#define SYMBOL(function) {#function, offsetof(struct functions, function)},

static struct functions {
	FUNCTIONS(DECLARE)
} egl;

static const engine_symbol symbols[] = {FUNCTIONS(SYMBOL)};
static const char *const file_names[] = {"libEGL.so.1", "libEGL.so", NULL};

/* Extensions of the client library, found through eglGetProcAddress; NULL: not there. */
static PFNEGLGETPLATFORMDISPLAYEXTPROC get_platform_display;
static PFNEGLQUERYDEVICESEXTPROC query_devices;
static PFNEGLQUERYDEVICESTRINGEXTPROC query_device_string;

enum { MAX_DEVICES = 32 };

typedef struct egl_native {
	EGLDisplay display;
	EGLContext context;
	EGLSurface surface; /* EGL_NO_SURFACE where a context needs none */
} egl_native;

/* A whole word of a list separated by blanks; a NULL list has none. */
static bool has_extension(const char *list, const char *name)
{
	size_t length = strlen(name);
	for (const char *found = list ? strstr(list, name) : NULL; found; found = strstr(found + length, name)) {
		bool starts = found == list || found[-1] == ' ';
		if (starts && (found[length] == ' ' || found[length] == '\0'))
			return true;
	}
	return false;
}

static bool load_library(char *message, size_t message_size)
{
	if (!engine_library_load(file_names, symbols, sizeof symbols / sizeof symbols[0], &egl,
				 "install libegl1 or use another --context", message, message_size))
		return false;
	get_platform_display = (PFNEGLGETPLATFORMDISPLAYEXTPROC)egl.eglGetProcAddress("eglGetPlatformDisplayEXT");
	query_devices = (PFNEGLQUERYDEVICESEXTPROC)egl.eglGetProcAddress("eglQueryDevicesEXT");
	query_device_string = (PFNEGLQUERYDEVICESTRINGEXTPROC)egl.eglGetProcAddress("eglQueryDeviceStringEXT");
	if (get_platform_display)
		return true;
	snprintf(message, message_size, "libEGL lacks EGL_EXT_platform_base; update it or use another --context");
	return false;
}

static EGLContext create_core_45(EGLDisplay display, EGLConfig config, bool debug)
{
	const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
				     4,
				     EGL_CONTEXT_MINOR_VERSION,
				     5,
				     EGL_CONTEXT_OPENGL_PROFILE_MASK,
				     EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
				     EGL_CONTEXT_OPENGL_DEBUG,
				     debug ? EGL_TRUE : EGL_FALSE,
				     EGL_NONE};
	return egl.eglCreateContext(display, config, EGL_NO_CONTEXT, attributes);
}

static EGLConfig choose_config(EGLDisplay display)
{
	static const EGLint attributes[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
					    EGL_NONE};
	EGLConfig config = NULL;
	EGLint count = 0;
	if (!egl.eglChooseConfig(display, attributes, &config, 1, &count) || count == 0)
		return NULL;
	return config;
}

/* Fills native->context and surface for an initialised display. False: this display cannot do it. */
static bool create_on_display(egl_native *native, bool debug)
{
	static const EGLint pbuffer_attributes[] = {EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};
	const char *extensions = egl.eglQueryString(native->display, EGL_EXTENSIONS);
	bool surfaceless = has_extension(extensions, "EGL_KHR_surfaceless_context");
	EGLConfig config = choose_config(native->display);
	if (!config && !(surfaceless && has_extension(extensions, "EGL_KHR_no_config_context")))
		return false;
	if (!egl.eglBindAPI(EGL_OPENGL_API))
		return false;
	native->context = create_core_45(native->display, config, debug);
	if (native->context == EGL_NO_CONTEXT)
		return false;
	native->surface =
	    surfaceless ? EGL_NO_SURFACE : egl.eglCreatePbufferSurface(native->display, config, pbuffer_attributes);
	return surfaceless || native->surface != EGL_NO_SURFACE;
}

/* Displays stay initialised: equal arguments give equal displays, so contexts share them, and ending one unloads Mesa's
 * driver, which leaves memory behind each time.
 */
static void close_native(egl_native *native)
{
	if (native->surface != EGL_NO_SURFACE)
		egl.eglDestroySurface(native->display, native->surface);
	if (native->context != EGL_NO_CONTEXT)
		egl.eglDestroyContext(native->display, native->context);
	*native = (egl_native){0};
}

static bool try_display(egl_native *native, EGLenum platform, void *native_display, bool debug)
{
	native->display = get_platform_display(platform, native_display, NULL);
	if (native->display == EGL_NO_DISPLAY || !egl.eglInitialize(native->display, NULL, NULL))
		return false;
	if (create_on_display(native, debug))
		return true;
	close_native(native);
	return false;
}

static bool is_software(EGLDeviceEXT device)
{
	const char *extensions = query_device_string ? query_device_string(device, EGL_EXTENSIONS) : NULL;
	return has_extension(extensions, "EGL_MESA_device_software");
}

static bool try_devices(egl_native *native, bool software, bool debug)
{
	EGLDeviceEXT devices[MAX_DEVICES];
	EGLint count = 0;
	if (!query_devices || !query_devices(MAX_DEVICES, devices, &count))
		return false;
	for (EGLint i = 0; i < count; i++) {
		if (is_software(devices[i]) == software &&
		    try_display(native, EGL_PLATFORM_DEVICE_EXT, devices[i], debug))
			return true;
	}
	return false;
}

static bool try_surfaceless(egl_native *native, bool debug)
{
	const char *extensions = egl.eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
	return has_extension(extensions, "EGL_MESA_platform_surfaceless") &&
	       try_display(native, EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, debug);
}

static bool egl_open(engine_context *context, const engine_context_def *def, char *message, size_t message_size)
{
	if (!load_library(message, message_size))
		return false;
	egl_native *native = calloc(1, sizeof *native);
	if (!native) {
		snprintf(message, message_size, "out of memory for an EGL context");
		return false;
	}
	context->native = native;
	if (try_devices(native, false, def->debug) || try_surfaceless(native, def->debug) ||
	    try_devices(native, true, def->debug))
		return true;
	snprintf(
	    message, message_size,
	    "EGL has no device with OpenGL 4.5 core; install a GPU driver or libegl-mesa0, or use another --context");
	free(native);
	context->native = NULL;
	return false;
}

static void egl_close(engine_context *context)
{
	close_native(context->native);
	free(context->native);
	context->native = NULL;
}

/* The display that was made current last: releasing needs one. */
static EGLDisplay current_display = EGL_NO_DISPLAY;

static bool egl_make_current(engine_context *context)
{
	egl_native *native = context->native;
	if (!native)
		return egl.eglMakeCurrent(current_display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
	current_display = native->display;
	egl.eglBindAPI(EGL_OPENGL_API); /* kept per thread */
	return egl.eglMakeCurrent(native->display, native->surface, native->surface, native->context);
}

static engine_gl_proc egl_get_proc(const char *name)
{
	return (engine_gl_proc)egl.eglGetProcAddress(name);
}

const engine_context_backend engine_context_backend_egl = {
    .open = egl_open,
    .close = egl_close,
    .make_current = egl_make_current,
    .get_proc = egl_get_proc,
};
