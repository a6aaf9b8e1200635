/* An OBJ; what follows a line "%mtl", which is no OBJ, is its library m.mtl. */
#include "fuzz_scene.h"

#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static const char separator[] = "\n%mtl\n";

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	const size_t length = sizeof separator - 1;
	size_t obj = 0;
	while (obj + length <= size && memcmp(bytes + obj, separator, length) != 0)
		obj++;
	size_t mtl = obj + length <= size ? obj + length : size;
	fuzz_write("a.obj", bytes, mtl < size ? obj : size);
	fuzz_write("m.mtl", bytes + mtl, size - mtl);
	fuzz_load("a.obj");
	return 0;
}
