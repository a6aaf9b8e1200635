/* The only use of the generated loader: what it defines stays in this file, for a host has a loader of its own, which
 * may be of the same generator. */
#include "gpu.h"

#include "host_memory.h"

#include <stdio.h>
#include <stdlib.h>

/* The loader lists extensions while it loads. */
#define malloc gi_malloc
#define free gi_free
#define GLAD_API_CALL static
#define GLAD_GL_IMPLEMENTATION
#include <gi_gl.h>
#undef malloc
#undef free

typedef struct host_loader {
	gi_get_proc_address_fn *find;
	void *user;
} host_loader;

static GLADapiproc find(void *loader, const char *name)
{
	const host_loader *host = loader;
	return (GLADapiproc)host->find(name, host->user);
}

gi_result gpu_load_functions(gpu *g, gi_get_proc_address_fn *get_proc_address, void *user)
{
	host_loader loader = {get_proc_address, user};
	const PFNGLGETSTRINGPROC get_string = (PFNGLGETSTRINGPROC)find(&loader, "glGetString");
	const char *text = get_string ? (const char *)get_string(GL_VERSION) : NULL;
	int major = 0, minor = 0;
	if (!text || sscanf(text, "%d.%d", &major, &minor) != 2)
		return gi_fail(&g->log, GI_ERROR_NO_OPENGL_45,
			       "no OpenGL context is current: make a 4.5 core context current first");
	if (10 * major + minor < 45)
		return gi_fail(
		    &g->log, GI_ERROR_NO_OPENGL_45,
		    "OpenGL 4.5 is needed and the current context has %d.%d: make a 4.5 core context current first",
		    major, minor);
	g->gl = gi_calloc(1, sizeof *g->gl);
	/* Of an OpenGL that is new enough the list of extensions is what can fail. */
	if (g->gl && gladLoadGLContextUserPtr(g->gl, find, &loader))
		return GI_OK;
	gpu_free_functions(g);
	return gi_fail(&g->log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
}

void gpu_free_functions(gpu *g)
{
	gi_free(g->gl);
	g->gl = NULL;
}
