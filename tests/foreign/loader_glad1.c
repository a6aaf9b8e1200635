/* glad 1 as it is generated into many hosts, which Debian does not have: its global names, for the functions that are
 * called here. */
#include <stdbool.h>
#include <stddef.h>

#define GL_GLEXT_PROTOTYPES 0
#include <GL/gl.h>
#include <GL/glext.h>

struct gladGLversionStruct {
	int major, minor;
} GLVersion;
int GLAD_GL_VERSION_1_0, GLAD_GL_VERSION_4_5;

#define FUNCTIONS(X)                                                                                                   \
	X(CREATEBUFFERS, CreateBuffers)                                                                                \
	X(DELETEBUFFERS, DeleteBuffers)                                                                                \
	X(NAMEDBUFFERSTORAGE, NamedBufferStorage)                                                                      \
	X(BINDBUFFERBASE, BindBufferBase)                                                                              \
	X(USEPROGRAM, UseProgram)                                                                                      \
	X(DISPATCHCOMPUTE, DispatchCompute)                                                                            \
	X(MEMORYBARRIER, MemoryBarrier)                                                                                \
	X(CREATEPROGRAM, CreateProgram)                                                                                \
	X(GETNAMEDBUFFERSUBDATA, GetNamedBufferSubData)
#define DEFINE(type, name) PFNGL##type##PROC glad_gl##name;
FUNCTIONS(DEFINE)
typedef void(APIENTRYP PFNGLGETINTEGERVPROC1)(GLenum name, GLint *data);
PFNGLGETINTEGERVPROC1 glad_glGetIntegerv;
#define glCreateBuffers glad_glCreateBuffers
#define glDeleteBuffers glad_glDeleteBuffers
#define glGetIntegerv glad_glGetIntegerv

#define NAME(function) glad_gl##function
#include "loader_body.h"

const char *const loader_name = "glad 1";

typedef void *(*GLADloadproc)(const char *name);
int gladLoadGLLoader(GLADloadproc load);
int gladLoadGL(void);

#define LOAD(type, name) glad_gl##name = (PFNGL##type##PROC)load("gl" #name);
int gladLoadGLLoader(GLADloadproc load)
{
	glad_glGetIntegerv = (PFNGLGETINTEGERVPROC1)load("glGetIntegerv");
	FUNCTIONS(LOAD)
	GLVersion.major = 4;
	GLVersion.minor = 5;
	GLAD_GL_VERSION_1_0 = GLAD_GL_VERSION_4_5 = 1;
	return glad_glGetIntegerv != NULL;
}

int gladLoadGL(void)
{
	return 0;
}

bool loader_load(loader_function (*find)(const char *name))
{
	return gladLoadGLLoader((GLADloadproc)find) != 0;
}
