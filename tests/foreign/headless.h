/* An OpenGL 4.5 core context without a window or a surface, current on the calling thread. C and C++. */
#ifndef FOREIGN_HEADLESS_H
#define FOREIGN_HEADLESS_H

#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <stdio.h>
#include <stdlib.h>

typedef void (*headless_function)(void);

static EGLDisplay headless_display(void)
{
	const PFNEGLGETPLATFORMDISPLAYEXTPROC get_display =
	    (PFNEGLGETPLATFORMDISPLAYEXTPROC)eglGetProcAddress("eglGetPlatformDisplayEXT");
	const EGLDisplay display =
	    get_display ? get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL) : EGL_NO_DISPLAY;
	if (display != EGL_NO_DISPLAY && eglInitialize(display, NULL, NULL))
		return display;
	fprintf(stderr, "no EGL display without a window system\n");
	exit(77);
}

static EGLContext headless_open(EGLDisplay display)
{
	static const EGLint config_attributes[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0, EGL_NONE};
	static const EGLint attributes[] = {
	    EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK,
	    EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
	EGLConfig config = NULL;
	EGLint count = 0;
	eglBindAPI(EGL_OPENGL_API);
	eglChooseConfig(display, config_attributes, &config, 1, &count);
	const EGLContext context = eglCreateContext(display, count ? config : NULL, EGL_NO_CONTEXT, attributes);
	if (context != EGL_NO_CONTEXT && eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context))
		return context;
	fprintf(stderr, "no OpenGL 4.5 core context\n");
	exit(77);
}

static headless_function headless_find(const char *name)
{
	return (headless_function)eglGetProcAddress(name);
}

#endif
