// What a row gathers, by sums in REAL: with SPECULAR its first links may be such through mirrors and glass.
#ifdef SPECULAR
#include "specular_link.glsl"
#endif

struct gathered {
	REAL4 sum;  // of weight * R_node, and of weight * v_node
	uint count; // of links
};

gathered gather(uint leaf)
{
	uvec4 row = load_row(leaf);
	gathered g = gathered(REAL4(0.0), row.y & GI_BLOCK_COUNT_MASK);
	uint reflected = GI_NODE_R * frame.counts.y;
	uint k = row.x / 2u;
#ifdef SPECULAR
	for (; 2u * k < row.x + g.count; k++) {
		uvec4 link = load_two_links(k);
		if (!is_specular(link))
			break;
		vec4 weights = vec4(weights_of(link), largest_weight_of(link));
		g.sum += REAL4(weights) * REAL4(load_radiosity(reflected + node_of(link)));
	}
#endif
	for (; 2u * k < row.x + g.count; k++) {
		uvec4 two = load_two_links(k);
		g.sum += REAL(uintBitsToFloat(two.y)) * REAL4(load_radiosity(reflected + two.x));
		g.sum += REAL(uintBitsToFloat(two.w)) * REAL4(load_radiosity(reflected + two.z));
	}
	return g;
}
