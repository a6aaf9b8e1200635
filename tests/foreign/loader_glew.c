#include <GL/glew.h>

#define NAME(function) __glew##function
#include "loader_body.h"

const char *const loader_name = "GLEW";

bool loader_load(loader_function (*find)(const char *name))
{
	(void)find;
	glewExperimental = GL_TRUE;
	/* It looks for GLX after OpenGL, and there is none without a window system. */
	const GLenum result = glewInit();
	return result == GLEW_OK || result == GLEW_ERROR_NO_GLX_DISPLAY;
}
