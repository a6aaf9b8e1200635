/* glad 2, generated with its default names. */
#include <glad/gl.h>

#define NAME(function) glad_gl##function
#include "loader_body.h"

const char *const loader_name = "glad 2";

bool loader_load(loader_function (*find)(const char *name))
{
	return gladLoadGL((GLADloadfunc)find) != 0;
}
