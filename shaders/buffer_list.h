/* The GPU's buffers, each named here once. C reads the lists (gi/src/buffers.h): they declare, bind, label and free.
 * The build reads them too (cmake/declare_buffers.cmake), and writes what shaders declare. A line is
 *
 *   X(place, NAME, member, element, type, writer, "label")
 *
 *   place    its binding: a number of its own, or the NAME of another whose number it takes where no shader needs both
 *   NAME     of the binding, GI_BIND_NAME; shaders ask for READ_NAME and WRITE_NAME (buffers.glsl)
 *   member   the gpu_buffer in the structure of its owner
 *   element  one of it: load_element(n) reads it, element_part(n) a member of it; written is name[n]
 *   type     of that, as shaders call it; structures are those of gi_shared.h
 *   writer   HOST: uploaded or copied, shaders but read it. SHADERS: they write it too. ALONE: one structure, no array,
 *            which buffers.glsl or its only shader declares by hand
 *   label    what debuggers call it
 */
#ifndef GI_BUFFER_LIST_H
#define GI_BUFFER_LIST_H

/* clang-format off */
/* gi_scene */
#define SCENE_BUFFERS(X) \
	X(1, OBJECTS, objects_gpu, object, gi_object_data, HOST, "objects") \
	X(2, TOPOLOGY, topology_gpu, topology, gi_node_topology, HOST, "node topology") \
	X(3, REST, rest_gpu, rest, gi_node_geometry, HOST, "nodes at rest") \
	X(31, SPREAD, spread_gpu, spread, gi_node_spread, HOST, "spread of nodes") \
	X(4, WORLD, world_gpu, world, gi_node_geometry, SHADERS, "nodes in the world") \
	X(5, VERTICES_REST, vertices_rest_gpu, rest_vertex, vec4, HOST, "vertices at rest") \
	X(6, VERTICES_WORLD, vertices_world_gpu, world_vertex, vec4, SHADERS, "vertices in the world") \
	X(7, LEAVES, leaves_gpu, leaf, uvec4, HOST, "leaves") /* node, slot, material, rank of the primitive */ \
	X(8, MATERIALS, materials_gpu, material, gi_material_data, HOST, "materials") \
	X(9, BVH, bvh_gpu, bvh_node, uvec4, HOST, "trees of objects") /* packed */ \
	X(10, PRIMITIVES, primitives_gpu, primitive, gi_primitive, HOST, "primitives") \
	/* packed; of all, then of what lies between */ \
	X(11, TLAS, tlas_gpu, tlas_node, uvec4, HOST, "trees over objects") \
	/* 4 a leaf, at rest; first w: area up to it */ \
	X(36, LEAF_QUADS, leaf_quads_gpu, leaf_corner, vec4, HOST, "corners of leaves") \
	/* area mean of E; in w of rho */ \
	X(21, NODE_EXITANCE, node_exitance_gpu, exitance, vec4, HOST, "exitance of nodes") \
	/* of more than GI_LARGE_NODE_LEAVES leaves */ \
	X(25, LARGE_NODES, large_nodes_gpu, large_node, uint, HOST, "large nodes") \
	/* of vertex and leaf: leaf, weight bits */ \
	X(27, LIGHT_LINKS, light_links_gpu, light_link, uvec2, HOST, "light links") \
	/* a light vertex, and one more */ \
	X(28, LIGHT_FIRST, light_first_gpu, light_first, uint, HOST, "first light links")

/* gi_rows: of leaves and sources */
#define ROWS_TABLES(X) \
	X(12, SEGMENTS, segments, segment, uvec4, SHADERS, "segments") \
	X(16, ROWS, headers, row, uvec4, SHADERS, "rows") \
	X(30, TOUCHED, touched, touched, uint, SHADERS, "touched") /* GI_TOUCHED_PARTS a leaf (touched.glsl) */

/* gi_rows: kept over commits, or made larger */
#define ROWS_POOLS(X) \
	X(13, ENTRIES, entries, entry, uvec4, SHADERS, "entries") \
	/* of an entry: the node whose B it takes, GI_TARGET_BLACK */ \
	X(35, TARGETS, targets, target, uint, SHADERS, "targets") \
	X(14, ENTRY_POOL, entry_pool, entry_pool, uint, SHADERS, "free entries") \
	X(15, QUEUE, queue, queued, uint, SHADERS, "queue") \
	X(17, LINKS, links, link, uvec2, SHADERS, "links") \
	X(18, LINK_POOL, link_pool, link_pool, uint, SHADERS, "free links")

/* gi_rows: of an update, as large as they are wanted */
#define ROWS_LISTS(X) \
	X(23, RUNS, runs, run, uvec4, HOST, "runs") /* pose runs, then cut runs */ \
	/* movers, their neighbours, emitting objects; what was swept */ \
	X(24, OBJECT_LISTS, object_lists, listed_object, uint, HOST, "lists of objects")

/* gi_rows: the frame, a uniform block */
#define ROWS_UNIFORMS(X) \
	X(0, FRAME, frame, frame, gi_frame, ALONE, "frame")

/* gi_context: a uniform block where it is but read */
#define CONTEXT_BUFFERS(X) \
	X(22, STATE, state, state, gi_state, ALONE, "state")

/* gi_budget_state */
#define BUDGET_BUFFERS(X) \
	X(32, CHOICES, choices, choice, uint, SHADERS, "choices") /* GI_CHOICE_ */ \
	X(33, PENDING, pending, pending, gi_pending, SHADERS, "pending") \
	/* GI_LIGHT_BOUND_WORDS an object slot, and for all of them */ \
	X(34, LIGHT_BOUNDS, light_bounds, light_bound, uint, SHADERS, "light bounds")

/* gi_solver */
#define SOLVER_BUFFERS(X) \
	X(19, RADIOSITY, radiosity, radiosity, vec4, SHADERS, "radiosity of nodes") /* GI_NODE_PARTS */ \
	/* GI_LEAF_PARTS */ \
	X(20, LEAF_RADIOSITY, leaf_radiosity, leaf_radiosity, vec4, SHADERS, "radiosity of leaves") \
	X(26, LEAF_INDIRECT, leaf_indirect, leaf_indirect, vec4, SHADERS, "indirect light of leaves") \
	X(29, LIGHT, light, light, vec4, SHADERS, "light of vertices")

/* gi_rows of before a commit, and what became of objects and nodes (renumber.comp). */
#define OLD_ROWS_TABLES(X) \
	X(LARGE_NODES, OLD_SEGMENTS, segments, old_segment, uvec4, HOST, "segments before") \
	X(LIGHT_LINKS, OLD_ROWS, headers, old_row, uvec4, HOST, "rows before")
#define MOVE_BUFFERS(X) \
	X(RUNS, MOVES, slots, move, gi_move, HOST, "moves") \
	X(OBJECT_LISTS, NODE_MOVES, nodes, node_move, uint, HOST, "moves of nodes")

/* loans: rows that are lent, the leaf and the one that lends */
#define LOAN_BUFFERS(X) \
	X(LARGE_NODES, LOANS, list, loan, uvec2, HOST, "loans")

/* gi_paths: paths.comp reads no rows; every update binds them again. */
#define PATH_BUFFERS(X) \
	X(SEGMENTS, PATH_SLOTS, slots, path_slot, gi_path_slot, SHADERS, "paths: slots") /* a thread */ \
	X(QUEUE, PATH_GOING, going, path_going, uint, ALONE, "paths: going") /* 1 while a slot has a vertex to go */ \
	/* 3 an emitting triangle, in the world */ \
	X(ENTRIES, PATH_LIGHTS, lights, light_triangle, uvec4, HOST, "paths: lights") \
	/* GI_SOBOL_DIMENSIONS * 32, bits reversed */ \
	X(ENTRY_POOL, PATH_SOBOL, sobol, sobol, uint, HOST, "paths: Sobol numbers")

/* gi_sky_state: of a sky with a picture, for shaders that look it up (sky_image.glsl). Of a texel: bits of exitance,
 * W/m2, and of all light up to it the share in 2^-32 */
#define SKY_BUFFERS(X) \
	X(RUNS, SKY_TEXELS, texels, sky_texel, uvec4, HOST, "texels of the sky")

/* gi_smooth: mirrors and glass, of scenes that have any, in places of what their dispatches do not read */
#define SMOOTH_BUFFERS(X) \
	/* a primitive: at its corners (smooth.h) */ \
	X(SPREAD, SMOOTH, normals, smooth_normals, uvec4, HOST, "smooth normals") \
	X(CHOICES, SMOOTH_MATERIALS, materials, smooth_material, gi_smooth_material, HOST, "smooth materials") \
	/* light vertices of a leaf */ \
	X(ROWS, CORNER_LIGHTS, corner_lights, corner_lights, uvec4, HOST, "light at corners of leaves")

/* gi_caustics, likewise; its emitting triangles lie as those of paths do. */
#define CAUSTIC_BUFFERS(X) \
	X(ENTRIES, CAUSTIC_LIGHTS, lights, caustic_triangle, uvec4, HOST, "caustics: lights") \
	/* those of a pair one after the other */ \
	X(PENDING, PHOTONS, photons, photon, gi_photon, SHADERS, "caustics: photons") \
	X(LIGHT_BOUNDS, CAUSTIC_PAIRS, pairs, caustic_pair, gi_caustic_pair, HOST, "caustics: pairs") \
	/* GI_CAUSTIC_PATH_WORDS a pair */ \
	X(ENTRY_POOL, CAUSTIC_PATHS, paths, caustic_path, uint, SHADERS, "caustics: paths") \
	/* 3 a leaf: flux in steps of power.w */ \
	X(LINK_POOL, CAUSTIC_SUMS, sums, caustic_sum, uint, SHADERS, "caustics: sums") \
	X(QUEUE, CAUSTIC_LIGHT, light, caustic_light, vec4, SHADERS, "caustics: light") /* a leaf: irradiance, W/m2 */ \
	/* photons a cell of a hashed grid, level by level */ \
	X(TARGETS, CAUSTIC_CELLS, cells, caustic_cell, uint, SHADERS, "caustics: cells")

/* gi_specular_rows, likewise: what entries see by way of mirrors and glass, of this update alone. Of an entry: as x of
 * a link through them, and what of the light arrives, ten bits a channel. */
#define SPECULAR_BUFFERS(X) \
	X(PENDING, SPECULAR_ENDS, ends, specular_end, uvec2, SHADERS, "ends of ways through mirrors and glass")

/* gi_punctual: lights without a surface, of contexts that have any, in places of what their dispatches do not read. */
#define PUNCTUAL_BUFFERS(X) \
	X(PENDING, PUNCTUAL_LIGHTS, lights, punctual_light, gi_punctual_light, HOST, "lights without a surface") \
	/* irradiance of a leaf by one of them, were its intensity 1: those of a light one after the other */ \
	X(ENTRY_POOL, PUNCTUAL_SHARES, shares, punctual_share, float, SHADERS, "lights: shares of leaves") \
	X(TARGETS, PUNCTUAL_SUMS, sums, punctual_sum, vec4, SHADERS, "lights: sums") /* GI_PUNCTUAL_PARTS a leaf */ \
	X(LINK_POOL, LINKED_LIGHT, linked, linked_light, vec4, SHADERS, "light of links") /* GI_LINKED_PARTS a leaf */

/* gi_diffusion: translucent objects, of scenes that have any, in places of what a solve does not read. Rows: those of
 * leaves, of small clusters, of large ones. */
#define DIFFUSION_BUFFERS(X) \
	/* x first link, y links, of a leaf z its number */ \
	X(SPREAD, DIFFUSION_ROWS, rows, diffusion_row, uvec4, HOST, "rows below surfaces") \
	/* value, bits of three weights (subsurface.h) */ \
	X(CHOICES, DIFFUSION_LINKS, links, diffusion_link, uvec4, HOST, "links below surfaces") \
	/* what enters there, W/m2; the same of v */ \
	X(PENDING, DIFFUSION_VALUES, values, diffusion_value, vec4, SHADERS, "light below surfaces")

/* gi_receivers, of scenes that have any, in the place of what its dispatches do not read */
#define RECEIVER_BUFFERS(X) \
	/* of a set's points, one after the other: irradiance, or coefficients (receive.glsl) */ \
	X(QUEUE, RECEIVED, light, received_light, vec4, SHADERS, "light of receivers")
/* gi_probes, likewise. */
#define PROBE_BUFFERS(X) \
	/* 16 x 16 a probe (probe_planes.comp) */ \
	X(TARGETS, PROBE_PLANES, planes, probe_plane, vec4, SHADERS, "planes about probes")

/* gi_estimate, in places whose owners its dispatches do not read; it brings those back. */
#define ESTIMATE_BUFFERS(X) \
	/* an entry between a point of a leaf and a leaf */ \
	X(RUNS, ESTIMATE_ITEMS, items, item, uvec4, SHADERS, "estimate: items") \
	/* of an item: what its F V counts */ \
	X(OBJECT_LISTS, ESTIMATE_SHARES, shares, share, float, SHADERS, "estimate: shares") \
	/* of a leaf: end of its part of [0,1], the part */ \
	X(LARGE_NODES, ESTIMATE_CHANCES, chances, chance, vec2, HOST, "estimate: chances") \
	X(LIGHT_LINKS, ESTIMATE_RESULTS, results, result, gi_estimate_leaf, SHADERS, "estimate: leaves")

/* Those with bindings of their own. */
#define BOUND_BUFFERS(X) \
	SCENE_BUFFERS(X) ROWS_TABLES(X) ROWS_POOLS(X) ROWS_LISTS(X) ROWS_UNIFORMS(X) CONTEXT_BUFFERS(X) \
	BUDGET_BUFFERS(X) SOLVER_BUFFERS(X)
/* Those in the places of others. */
#define PLACED_BUFFERS(X) \
	OLD_ROWS_TABLES(X) MOVE_BUFFERS(X) LOAN_BUFFERS(X) PATH_BUFFERS(X) SMOOTH_BUFFERS(X) CAUSTIC_BUFFERS(X) \
	SPECULAR_BUFFERS(X) PUNCTUAL_BUFFERS(X) SKY_BUFFERS(X) DIFFUSION_BUFFERS(X) RECEIVER_BUFFERS(X) \
	PROBE_BUFFERS(X) ESTIMATE_BUFFERS(X)
/* clang-format on */

#endif
