#version 450 core
// Means over clusters of a translucent object's leaves, of what enters there: small clusters of leaves, then large ones
// of small ones. Each thread takes clusters in turn.
#define READ_FRAME
#define READ_DIFFUSION_ROWS
#define READ_DIFFUSION_LINKS
#define READ_DIFFUSION_VALUES
#define WRITE_DIFFUSION_VALUES
#include "buffers.glsl"
#include "dispatch.glsl"
#include "solve.glsl"
#include "diffusion.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint first;
layout(location = 1) uniform uint end;

void main()
{
	uint t = thread_number();
	if (t >= frame.counts.x)
		return;
	for (uint k = first + t; k < end; k += frame.counts.x) {
		diffused d = diffuse(load_diffusion_row(k));
		// All three weights are the same share of area.
		diffusion_values[k] = to_single(dvec4(d.light, d.amplified.x));
	}
}
