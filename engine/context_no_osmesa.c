/* Stands in for context_osmesa.c where there is no OSMesa to build with: Mesa ended it with 25.0. */
#include "context_internal.h"

#include <stdio.h>

static bool say_that_it_is_gone(engine_context *context, const engine_context_def *def, char *message,
				size_t message_size)
{
	(void)context, (void)def;
	snprintf(message, message_size, "built without OSMesa (Mesa has none after 25.0); use --context egl");
	return false;
}

const engine_context_backend engine_context_backend_osmesa = {.open = say_that_it_is_gone};
