/* The picture. */
#include "context.h"

gi_result gi_draw(gi_context *gi, const gi_view *view)
{
	(void)gi;
	(void)view;
	return GI_OK;
}

void shade_invalidate(gi_context *gi)
{
	(void)gi;
}

void shade_free(gi_context *gi)
{
	(void)gi;
}
