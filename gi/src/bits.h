/* Numbers carried in the w of a vec4, bit for bit (gi_shared.h). */
#ifndef GI_BITS_H
#define GI_BITS_H

#include <stdint.h>
#include <string.h>

static inline float gi_float_from_bits(uint32_t bits)
{
	float value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

static inline uint32_t gi_bits_from_float(float value)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof bits);
	return bits;
}

#endif
