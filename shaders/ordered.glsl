// Floats as words of the same order, for atomic minima and maxima.

uint ordered_from_float(float x)
{
	uint bits = floatBitsToUint(x);
	return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}

float float_from_ordered(uint x)
{
	return uintBitsToFloat((x & 0x80000000u) != 0u ? x & 0x7FFFFFFFu : ~x);
}
