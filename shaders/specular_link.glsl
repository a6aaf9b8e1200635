// Links through mirrors and glass, which come first in a row (gi_shared.h).

bool is_specular(uvec4 link)
{
	return (link.x & GI_LINK_SPECULAR) != 0u;
}

uint node_of(uvec4 link)
{
	return link.x & GI_LINK_NODE;
}

vec3 weights_of(uvec4 link)
{
	return uintBitsToFloat(link.yzw);
}

float largest_weight_of(uvec4 link)
{
	vec3 w = weights_of(link);
	return max(w.x, max(w.y, w.z));
}
