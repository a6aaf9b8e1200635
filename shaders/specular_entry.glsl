// Entries that see a mirror or glass: the target of one is then a leaf of it (trace.glsl).

bool has_smooth(uint source)
{
	return (topology_range(object_nodes(source).x).w & GI_NODE_SMOOTH) != 0u;
}

bool sees_smooth(uvec4 entry, uint target)
{
	return seen_of(entry) > 0u && (topology_range(target & ~GI_TARGET_BLACK).w & GI_NODE_SMOOTH) != 0u;
}
