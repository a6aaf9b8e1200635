/* What debuggers show: names of objects, groups of calls. */
#include "gpu.h"

#include <gi_gl.h>

#include <stdio.h>

void gpu_label(const gpu *g, uint32_t kind, uint32_t name, const char *what)
{
	char label[96];
	snprintf(label, sizeof label, "gi %s", what);
	g->gl->ObjectLabel(kind, name, -1, label);
}

void gpu_group_begin(const gpu *g, const char *what)
{
	g->gl->PushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, -1, what);
}

void gpu_group_end(const gpu *g)
{
	g->gl->PopDebugGroup();
}
