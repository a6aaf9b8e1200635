/* Some functions that the library cannot do without. */
#define LOADER_FUNCTIONS(X)                                                                                            \
	X(CreateBuffers)                                                                                               \
	X(NamedBufferStorage)                                                                                          \
	X(BindBufferBase) X(UseProgram) X(DispatchCompute) X(MemoryBarrier) X(CreateProgram) X(GetNamedBufferSubData)
