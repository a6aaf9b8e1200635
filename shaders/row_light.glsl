// H of a leaf, at the B of the nodes as it is.
vec3 light_of_row(uint leaf)
{
	uvec2 row = load_row(leaf).xy;
	vec3 h = vec3(0.0);
	for (uint k = row.x / 2u; 2u * k < row.x + (row.y & GI_BLOCK_COUNT_MASK); k++) {
		uvec4 two = load_two_links(k);
		h += uintBitsToFloat(two.y) * load_radiosity(two.x).xyz;
		h += uintBitsToFloat(two.w) * load_radiosity(two.z).xyz;
	}
	return h;
}
