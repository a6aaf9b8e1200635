#ifdef SPECULAR
#include "specular_link.glsl"

// What photons do not bring (caustics.c).
vec3 light_of_link(uvec4 link)
{
	uint part = (link.x & GI_LINK_PHOTONS) != 0u ? GI_NODE_R : GI_NODE_B;
	return weights_of(link) * load_radiosity(part * frame.counts.y + node_of(link)).xyz;
}
#endif

// H of a leaf, at the B of the nodes as it is.
vec3 light_of_row(uint leaf)
{
	uvec2 row = load_row(leaf).xy;
	vec3 h = vec3(0.0);
	for (uint k = row.x / 2u; 2u * k < row.x + (row.y & GI_BLOCK_COUNT_MASK); k++) {
		uvec4 two = load_two_links(k);
#ifdef SPECULAR
		if (is_specular(two)) {
#ifndef WITHOUT_SPECULAR_LINKS
			h += light_of_link(two);
#endif
			continue;
		}
#endif
		h += uintBitsToFloat(two.y) * load_radiosity(two.x).xyz;
		h += uintBitsToFloat(two.w) * load_radiosity(two.z).xyz;
	}
	return h;
}
