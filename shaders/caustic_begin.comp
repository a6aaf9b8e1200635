#version 450 core
// Which pairs of emitter and smooth object are traced anew, and how far: those that something moved on the paths of
// from their first photon on, the others from where they are. One thread a pair.
#define READ_FRAME
#define READ_OBJECT_LISTS
#define READ_CAUSTIC_PAIRS
#define WRITE_CAUSTIC_PATHS
#include "buffers.glsl"
#include "dispatch.glsl"
#include "ordered.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint pair_count;
layout(location = 2) uniform uint photons_a_pair;
layout(location = 3) uniform uint allowed; // photons of a pair in this update
layout(location = 4) uniform uint seen;    // update of the rows up to which the photons know what moved
layout(location = 1) uniform float margin; // metres: more than a path's points are off by

vec3 corner_of(uint first)
{
	return vec3(float_from_ordered(caustic_paths[first]), float_from_ordered(caustic_paths[first + 1u]),
		    float_from_ordered(caustic_paths[first + 2u]));
}

bool is_crossed(uint pair)
{
	vec3 lower = corner_of(GI_CAUSTIC_PATH_WORDS * pair) - margin,
	     upper = corner_of(GI_CAUSTIC_PATH_WORDS * pair + 3u) + margin;
	bool crossed = false;
	for (uint k = 0u; k < frame.swept.y && !crossed; k++)
		crossed = load_swept_change(k).x > seen && all(lessThanEqual(load_swept_corner(k, 2u).xyz, upper)) &&
			  all(greaterThanEqual(load_swept_corner(k, 3u).xyz, lower));
	return crossed;
}

void main()
{
	uint pair = thread_number();
	if (pair >= pair_count)
		return;
	bool dirty = load_caustic_pair(pair).power.z != 0.0 || is_crossed(pair);
	uint words = GI_CAUSTIC_PATH_WORDS * pair;
	for (uint k = 0u; k < 6u && dirty; k++)
		caustic_paths[words + k] = k < 3u ? 0xFFFFFFFFu : 0u;
	uint before = dirty ? 0u : caustic_paths[words + GI_CAUSTIC_NOW];
	caustic_paths[words + GI_CAUSTIC_BEFORE] = before;
	caustic_paths[words + GI_CAUSTIC_NOW] = min(before + allowed, photons_a_pair);
}
