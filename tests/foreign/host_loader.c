/* A program with an OpenGL loader of its own beside the library's, whose functions are poisoned while the library
 * works: it must neither call nor change them. */
#include "headless.h"
#include "loader.h"
#include "room.h"

static gi_proc find_gl(const char *name, void *user)
{
	(void)user;
	return (gi_proc)headless_find(name);
}

int main(void)
{
	headless_open(headless_display());
	if (!loader_load(headless_find) || !loader_works()) {
		printf("the host's own %s does not load\n", loader_name);
		return 1;
	}
	loader_poison();
	gi_context_def def = gi_context_def_default();
	def.get_proc_address = find_gl;
	gi_context *gi = NULL;
	gi_leaf leaves[ROOM_LEAVES];
	if (gi_context_create(&def, &gi) || room_light(gi, leaves))
		return 1;
	gi_context_destroy(gi);
	if (!loader_is_poisoned()) {
		printf("the library changed functions of the host's %s\n", loader_name);
		return 1;
	}
	return !(loader_load(headless_find) && loader_works() && room_is_lit(loader_name, leaves));
}
