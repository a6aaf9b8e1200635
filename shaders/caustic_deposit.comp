#version 450 core
// What arrives at each leaf, summed up in whole steps: in any order the same sum. One thread a photon.
#define READ_PHOTONS
#define READ_CAUSTIC_PAIRS
#define READ_CAUSTIC_PATHS
#define WRITE_CAUSTIC_SUMS
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint photons_a_pair;
layout(location = 1) uniform uint pair_count;

void main()
{
	uint t = thread_number(), pair = t / photons_a_pair;
	if (pair >= pair_count || t % photons_a_pair >= load_photon_count(pair))
		return;
	gi_photon photon = load_photon(t);
	uint leaf = floatBitsToUint(photon.place.w);
	if (leaf == GI_NONE)
		return;
	uvec3 steps = uvec3(photon.flux.xyz / (float(load_photon_count(pair)) * load_caustic_pair(pair).power.w) + 0.5);
	for (uint c = 0u; c < 3u; c++)
		atomicAdd(caustic_sums[3u * leaf + c], steps[c]);
}
