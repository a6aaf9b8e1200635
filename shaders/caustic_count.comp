#version 450 core
// Photons per cell. One thread a photon.
#define READ_PHOTONS
#define READ_CAUSTIC_PAIRS
#define READ_CAUSTIC_PATHS
#define WRITE_CAUSTIC_CELLS
#include "buffers.glsl"
#include "dispatch.glsl"
#include "caustic_cells.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint photons_a_pair;
layout(location = 1) uniform uint pair_count;

void main()
{
	uint t = thread_number(), pair = t / photons_a_pair;
	if (pair >= pair_count || t % photons_a_pair >= load_photon_count(pair))
		return;
	vec4 place = load_photon(t).place;
	float finest = FINEST * load_caustic_pair(pair).sphere.w;
	for (uint level = 0u; level < GI_CAUSTIC_LEVELS && floatBitsToUint(place.w) != GI_NONE; level++)
		atomicAdd(caustic_cells[cell_of(place.xyz, pair, level, finest)], 1u);
}
