/* The part of a loader's file that is the same in all: NAME(function) is the loader's pointer. */
#include "loader.h"
#include "loader_functions.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void poison(void)
{
	printf("the library called a function of the host's %s\n", loader_name);
	fflush(stdout);
	abort();
}

#define POISON(function) memcpy(&NAME(function), &poisoned, sizeof poisoned);
#define CHECK(function) same = same && memcmp(&NAME(function), &poisoned, sizeof poisoned) == 0;

void loader_poison(void)
{
	const loader_function poisoned = poison;
	LOADER_FUNCTIONS(POISON)
}

bool loader_is_poisoned(void)
{
	const loader_function poisoned = poison;
	bool same = true;
	LOADER_FUNCTIONS(CHECK)
	return same;
}

bool loader_works(void)
{
	GLint major = 0;
	GLuint buffer = 0;
	glGetIntegerv(GL_MAJOR_VERSION, &major);
	glCreateBuffers(1, &buffer);
	glDeleteBuffers(1, &buffer);
	return major == 4 && buffer != 0;
}
