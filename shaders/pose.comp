#version 450 core
// Brings nodes and vertices of moved objects from the rest frame to the world. A run is one object's nodes or vertices:
// x first thread, y object, z 0 nodes / 1 vertices, w index of the first.
#define READ_FRAME
#define READ_OBJECTS
#define READ_REST
#define READ_TOPOLOGY
#define READ_VERTICES_REST
#define READ_RUNS
#define WRITE_WORLD
#define WRITE_VERTICES_WORLD
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

void main()
{
	uint t = thread_number();
	if (t >= frame.work.y)
		return;
	uvec4 run = find_run(0u, frame.work.x, t);
	uint object = run.y;
	uint index = run.w + (t - run.x);
	if (run.z == 1u) {
		vertices_world[index] = vec4(world_from_rest(object, load_rest_vertex(index).xyz), 0.0);
		return;
	}
	// Between tops lie the nodes of objects, which have poses of their own.
	if (object == frame.swept.w && (topology_range(index).w & GI_NODE_TOP) == 0u)
		return;
	gi_node_geometry g = load_rest(index);
	world[index].sphere = vec4(world_from_rest(object, g.sphere.xyz), g.sphere.w);
	world[index].axis = vec4(world_direction_from_rest(object, g.axis.xyz), g.axis.w);
	world[index].moment = vec4(world_direction_from_rest(object, g.moment.xyz), g.moment.w);
}
