/* A glTF, as JSON or binary: the reader tells them apart. Beside it lies a buffer of small numbers. */
#include "fuzz_scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	static const float numbers[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.5f, 1, 2, 3, -1, 0, 0, 1};
	fuzz_write("a.bin", (const uint8_t *)numbers, sizeof numbers);
	fuzz_write("a.gltf", bytes, size);
	fuzz_load("a.gltf");
	return 0;
}
