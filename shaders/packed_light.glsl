// Three channels of light in one float, for bounds: its exponent is that of the first power of two above the largest,
// and its mantissa has seven bits of each, rounded up. It is a normal number, or 0 of no light.

const float PACKED_STEPS = 127.0;

float pack_light(vec3 x)
{
	float most = max(x.x, max(x.y, x.z));
	if (most == 0.0)
		return 0.0;
	uint exponent = (floatBitsToUint(most) >> 23u) + 1u;
	uvec3 steps = uvec3(ceil(min(x / uintBitsToFloat(exponent << 23u), 1.0) * PACKED_STEPS));
	return uintBitsToFloat(exponent << 23u | steps.x << 14u | steps.y << 7u | steps.z);
}

// The light is off by at most `slack` from what is returned.
vec3 unpack_light(float stored, out float slack)
{
	uint bits = floatBitsToUint(stored);
	float scale = uintBitsToFloat(bits & 0x7F800000u);
	// Half a step, and a little for roundings.
	slack = scale * (0.505 / PACKED_STEPS);
	return (vec3(bits >> 14u & 127u, bits >> 7u & 127u, bits & 127u) - 0.5) * (scale / PACKED_STEPS);
}
