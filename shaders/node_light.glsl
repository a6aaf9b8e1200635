// A node's light: R, v as the solve has them, and B for everybody else.
void store_node(uint n, vec4 r)
{
	radiosity[GI_NODE_R * frame.counts.y + n] = r;
	radiosity[GI_NODE_B * frame.counts.y + n] = vec4(load_exitance(n).xyz + r.xyz, 0.0);
}
