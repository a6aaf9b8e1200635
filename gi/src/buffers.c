#include "buffers.h"

#define LABEL(place, name, member, element, type, writer, label) .name = (label),
const gi_buffer_labels buffer_labels = {BOUND_BUFFERS(LABEL) PLACED_BUFFERS(LABEL)};
#undef LABEL

#define LABEL(place, name, member, element, type, writer, label) [place] = (label),
const char *buffer_bound_label(unsigned binding)
{
	static const char *const labels[GI_BIND_COUNT] = {BOUND_BUFFERS(LABEL)};
	return labels[binding];
}
#undef LABEL
