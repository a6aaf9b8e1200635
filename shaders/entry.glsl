// What an entry says of its visibility: V is seen over samples.

uint samples_of(uvec4 entry)
{
	return (entry.w >> GI_ENTRY_SAMPLE_SHIFT) & GI_ENTRY_SAMPLE_MASK;
}

uint seen_of(uvec4 entry)
{
	return uint(bitCount(entry.z & 0xFFFFu));
}
