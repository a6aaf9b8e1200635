#version 450 core
// The mean over the chosen leaves, into the report: one group, sums in a fixed order.
#define USE_STATE
#define USE_ESTIMATE_RESULTS
#include "buffers.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint all;

shared vec3 sums[GI_GROUP_SIZE]; // squared error, squared light, weight
shared uint rays[GI_GROUP_SIZE];

void main()
{
	uint t = gl_LocalInvocationID.x;
	sums[t] = vec3(0.0);
	rays[t] = 0u;
	for (uint k = t; k < all; k += GI_GROUP_SIZE) {
		gi_estimate_leaf r = results[k];
		sums[t] += r.error.x * vec3(r.error.y, dot(r.light.xyz, r.light.xyz), 1.0);
		rays[t] += floatBitsToUint(r.error.z);
	}
	barrier();
	if (t > 0u)
		return;
	for (uint k = 1u; k < GI_GROUP_SIZE; k++) {
		sums[0] += sums[k];
		rays[0] += rays[k];
	}
	state[GI_STATE_ESTIMATE_SQUARED] = floatBitsToUint(sums[0].x / sums[0].z);
	state[GI_STATE_ESTIMATE_POWER] = floatBitsToUint(sums[0].y / sums[0].z);
	state[GI_STATE_ESTIMATE_RAYS] = rays[0];
}
