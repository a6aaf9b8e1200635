/* A program that knows nothing of Relume but the installed package: one context, one update, the light of the floor.
 * The same text is compiled as C and as C++. */
#include "headless.h"
#include "room.h"

static gi_proc find_gl(const char *name, void *user)
{
	++*(unsigned *)user;
	return (gi_proc)headless_find(name);
}

int main(void)
{
	if (gi_version() != GI_VERSION) {
		printf("the header is %d, the library %u\n", GI_VERSION, gi_version());
		return 1;
	}
	headless_open(headless_display());
	unsigned asked = 0;
	gi_context_def def = gi_context_def_default();
	def.get_proc_address = find_gl;
	def.get_proc_user = &asked;
	gi_context *gi = NULL;
	gi_leaf leaves[ROOM_LEAVES];
	if (gi_context_create(&def, &gi) || room_light(gi, leaves) || !asked)
		return 1;
	gi_context_destroy(gi);
#ifdef __cplusplus
	return !room_is_lit("C++", leaves);
#else
	return !room_is_lit("C", leaves);
#endif
}
