#version 450 core
// Does a storage block reach beyond what the device promises (gpu_buffer_limit)? Writes a word there.
layout(local_size_x = 1) in;
layout(std430, binding = 0) restrict buffer tried_block { uint tried[]; };
layout(location = 0) uniform uint at;
layout(location = 1) uniform uint value;

void main()
{
	tried[at] = value;
}
