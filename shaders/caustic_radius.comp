#version 450 core
// How wide each photon is drawn: so that about so many overlap. One thread a photon.
#define READ_CAUSTIC_PAIRS
#define READ_CAUSTIC_PATHS
#define READ_CAUSTIC_CELLS
#define WRITE_PHOTONS
#include "buffers.glsl"
#include "dispatch.glsl"
#include "caustic_cells.glsl"
#include "numbers.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint photons_a_pair;
layout(location = 1) uniform uint pair_count;

// Photons that overlap: noise is about a tenth, and edges are sharp to the width of some.
const float OVERLAP = 40.0;

// A cell with fewer says little.
const uint ENOUGH = 16u;

void main()
{
	uint t = thread_number(), pair = t / photons_a_pair;
	if (pair >= pair_count || t % photons_a_pair >= load_photon_count(pair) ||
	    floatBitsToUint(photons[t].place.w) == GI_NONE)
		return;
	float finest = FINEST * load_caustic_pair(pair).sphere.w, size = finest;
	uint count = 0u;
	for (uint level = 0u; level < GI_CAUSTIC_LEVELS && count < ENOUGH; level++) {
		count = load_caustic_cell(cell_of(photons[t].place.xyz, pair, level, finest));
		size = finest * float(1u << level);
	}
	// A plane through a cell takes about its side squared of it.
	photons[t].flux.w = size * min(sqrt(OVERLAP / (PI * float(max(count, 1u)))), 1.0);
}
