// H of a leaf, at the B of the nodes as it is.
vec3 light_of_row(uint leaf)
{
	uvec2 row = rows[leaf].xy;
	vec3 h = vec3(0.0);
	for (uint k = row.x; k < row.x + (row.y & GI_BLOCK_COUNT_MASK); k++)
		h += uintBitsToFloat(links[k].y) * radiosity[links[k].x].xyz;
	return h;
}
