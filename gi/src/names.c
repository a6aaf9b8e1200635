/* The version, and what the values of public enumerations are called. */
#include "gi/gi.h"

uint32_t gi_version(void)
{
	return GI_VERSION;
}

const char *gi_result_text(gi_result result)
{
#define GI_RESULT_TEXT(name, text) text,
	static const char *const texts[] = {GI_RESULTS(GI_RESULT_TEXT)};
#undef GI_RESULT_TEXT
	return (unsigned)result < GI_RESULT_COUNT ? texts[result] : "unknown result";
}

const char *gi_pass_name(gi_pass pass)
{
	static const char *const names[] = {"pose",  "choose",  "cut",      "factor", "flag",
					    "trace", "close",   "caustics", "lights", "solve",
					    "light", "receive", "estimate", "shadow", "draw"};
	_Static_assert(sizeof names / sizeof *names == GI_PASS_COUNT, "a name a pass");
	return (unsigned)pass < GI_PASS_COUNT ? names[pass] : "unknown";
}
