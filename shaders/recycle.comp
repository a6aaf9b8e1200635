#version 450 core
// Puts the blocks given back during the frame on the free lists of their classes, where the next frame takes them.
#define WRITE_ENTRY_POOL
#define WRITE_LINK_POOL
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"
#include "pool.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

void main()
{
	uint t = thread_number();
	if (t < min(entry_pool[GI_POOL_PENDING], GI_POOL_PENDING_MAX)) {
		uint c = entry_pool[GI_POOL_PENDING_LIST + 2u * t + 1u];
		uint k = atomicAdd(entry_pool[GI_POOL_FREE + c], 1u);
		entry_pool[entry_pool[GI_POOL_LIST] + pool_list_begin(entry_pool[GI_POOL_LIMIT], c) + k] =
		    entry_pool[GI_POOL_PENDING_LIST + 2u * t];
	}
	if (t < min(link_pool[GI_POOL_PENDING], GI_POOL_PENDING_MAX)) {
		uint c = link_pool[GI_POOL_PENDING_LIST + 2u * t + 1u];
		uint k = atomicAdd(link_pool[GI_POOL_FREE + c], 1u);
		link_pool[link_pool[GI_POOL_LIST] + pool_list_begin(link_pool[GI_POOL_LIMIT], c) + k] =
		    link_pool[GI_POOL_PENDING_LIST + 2u * t];
	}
}
