/* The buffers that shaders find by their bindings: X(binding, member, what debuggers call it). The lists declare the
 * members, and bind, label, retire and free them. So a new buffer is a line here, its number in gi_shared.h, how
 * shaders get at it in buffers.glsl, and what fills it. */
#ifndef GI_BUFFERS_H
#define GI_BUFFERS_H

/* clang-format off */
/* gi_scene */
#define SCENE_BUFFERS(X) \
	X(OBJECTS, objects_gpu, "objects") \
	X(TOPOLOGY, topology_gpu, "node topology") \
	X(REST, rest_gpu, "nodes at rest") \
	X(SPREAD, spread_gpu, "spread of nodes") \
	X(WORLD, world_gpu, "nodes in the world") \
	X(VERTICES_REST, vertices_rest_gpu, "vertices at rest") \
	X(VERTICES_WORLD, vertices_world_gpu, "vertices in the world") \
	X(LEAVES, leaves_gpu, "leaves") \
	X(MATERIALS, materials_gpu, "materials") \
	X(BVH, bvh_gpu, "trees of objects") \
	X(PRIMITIVES, primitives_gpu, "primitives") \
	X(TLAS, tlas_gpu, "trees over objects") \
	X(LEAF_QUADS, leaf_quads_gpu, "corners of leaves") \
	X(NODE_EXITANCE, node_exitance_gpu, "exitance of nodes") \
	X(LARGE_NODES, large_nodes_gpu, "large nodes") \
	X(LIGHT_LINKS, light_links_gpu, "light links") \
	X(LIGHT_FIRST, light_first_gpu, "first light links")

/* gi_rows: of leaves and sources */
#define ROWS_TABLES(X) \
	X(SEGMENTS, segments, "segments") \
	X(ROWS, headers, "rows") \
	X(TOUCHED, touched, "touched")

/* gi_rows: kept over commits, or made larger */
#define ROWS_POOLS(X) \
	X(ENTRIES, entries, "entries") \
	X(TARGETS, targets, "targets") \
	X(ENTRY_POOL, entry_pool, "free entries") \
	X(QUEUE, queue, "queue") \
	X(LINKS, links, "links") \
	X(LINK_POOL, link_pool, "free links")

/* gi_rows: of an update, as large as they are wanted */
#define ROWS_LISTS(X) \
	X(RUNS, runs, "runs") \
	X(OBJECT_LISTS, object_lists, "lists of objects")

/* gi_budget_state */
#define BUDGET_BUFFERS(X) \
	X(CHOICES, choices, "choices") \
	X(PENDING, pending, "pending") \
	X(LIGHT_BOUNDS, light_bounds, "light bounds")

/* gi_solver */
#define SOLVER_BUFFERS(X) \
	X(RADIOSITY, radiosity, "radiosity of nodes") \
	X(LEAF_RADIOSITY, leaf_radiosity, "radiosity of leaves") \
	X(LEAF_INDIRECT, leaf_indirect, "indirect light of leaves") \
	X(LIGHT, light, "light of vertices")
/* clang-format on */

#define BUFFER_MEMBER(binding, member, label) gpu_buffer member;

#endif
