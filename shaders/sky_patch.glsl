#include "numbers.glsl"

// The patch of sky that lies in a direction (gi/src/sky_patch.c has where they are). Of a sky without a picture all
// patches are alike, and the first one stands for them.
uint sky_patch_towards(uint root, vec3 d)
{
	if ((topology_range(root).w & GI_NODE_PICTURE) == 0u)
		return root;
	vec3 a = abs(d);
	uint axis = a.x >= a.y && a.x >= a.z ? 0u : a.y >= a.z ? 1u : 2u;
	vec3 t = axis == 0u ? d.xyz : axis == 1u ? d.yzx : d.zxy; // the axis, and the two that follow it
	bool positive = t.x > 0.0;
	vec2 place = 0.5 + atan((positive ? t.zy : t.yz) / abs(t.x)) * (2.0 / PI);
	uint n = root;
	for (uint face = 2u * axis + (positive ? 0u : 1u); face > 0u; face--)
		n = topology_range(n).x;
	while ((topology_range(n).w & GI_NODE_LEAF) == 0u) {
		place *= 2.0;
		uvec2 half_of = uvec2(greaterThanEqual(place, vec2(1.0)));
		place -= vec2(half_of);
		n++;
		for (uint k = half_of.x + 2u * half_of.y; k > 0u; k--)
			n = topology_range(n).x;
	}
	return n;
}
