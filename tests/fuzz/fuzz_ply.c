/* A PLY. */
#include "fuzz_scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	fuzz_write("a.ply", bytes, size);
	fuzz_load("a.ply");
	return 0;
}
