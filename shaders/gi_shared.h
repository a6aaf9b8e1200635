/* Structures and constants shared by the C side and the shaders; read by both compilers.
 *
 * Only vec4, uvec4 and uint members: their std430 layout is the C layout. gi/src/gpu_layout.c asserts every size.
 */
#ifndef GI_SHARED_H
#define GI_SHARED_H

#ifdef GL_core_profile
#define GI_VEC4 vec4
#define GI_UVEC4 uvec4
#define GI_UINT uint
#define GI_STRUCT(name) struct name
#define GI_END(name) ;
#else
#include <stdint.h>
typedef struct gi_vec4 {
	float x, y, z, w;
} gi_vec4;
typedef struct gi_uvec4 {
	uint32_t x, y, z, w;
} gi_uvec4;
#define GI_VEC4 gi_vec4
#define GI_UVEC4 gi_uvec4
#define GI_UINT uint32_t
#define GI_STRUCT(name) typedef struct name
#define GI_END(name) name;
#endif

/* "No node, no vertex, no object." */
#define GI_NONE 0xFFFFFFFFu

/* Flags of a node (gi_node_topology.range.w). */
#define GI_NODE_LEAF 1u     /* one leaf, no children */
#define GI_NODE_POLYGON 2u  /* has four corners; a cluster above the base faces has none */
#define GI_NODE_FLAT 4u     /* the corners' two triangles are exactly the surface of its leaves */
#define GI_NODE_EMITTER 8u  /* some leaf below it emits; set by the scene, not by the hierarchy */
#define GI_NODE_BACK 16u    /* its back can be seen from somewhere: the object is not a closed outward surface */
#define GI_NODE_SKY 32u     /* a patch at infinity: corners and sphere centre are directions */
#define GI_NODE_LAMP 64u    /* what it emits is drawn per pixel (lamp.c) and no part of the leaves' indirect light */

/* Where a node is. One copy in the object's rest frame, one in the world.
 *
 *   //--------------- 16B ---------------
 *   sphere.xyz bounding-sphere centre          sphere.w radius
 *   axis.xyz   unit mean normal                axis.w   cosine of the normal cone's half angle (-1: any direction)
 *   moment.xyz sum of area * normal of leaves  moment.w area
 */
GI_STRUCT(gi_node_geometry) {
	GI_VEC4 sphere;
	GI_VEC4 axis;
	GI_VEC4 moment;
} GI_END(gi_node_geometry)

/* How the normals of a node spread: what it shows to a direction, front sides alone, is
 *
 *     P(d) = (S(d) + moment . d) / 2,   S(d) = sum of area |n . d| = about shape * sqrt(area * d' T d),   T = sum of area n n'
 *
 * exact for a flat node (shape 1) and for normals all round (shape 0.866); in the rest frame.
 *
 *   //--------------- 16B ---------------
 *   diagonal.xyz T xx yy zz    diagonal.w 0
 *   mixed.xyz    T xy yz zx    mixed.w shape
 */
GI_STRUCT(gi_node_spread) {
	GI_VEC4 diagonal;
	GI_VEC4 mixed;
} GI_END(gi_node_spread)

/* What a node is. Nodes lie in depth-first order: the first child of node n is n + 1, the node after its subtree is
 * `skip`.
 *
 *   //--------------- 16B ---------------
 *   range.x skip    range.y first leaf    range.z leaf count    range.w GI_NODE_ flags
 *   corners: vertex numbers, counter-clockwise; GI_NONE for a cluster; a triangle repeats its third corner
 */
GI_STRUCT(gi_node_topology) {
	GI_UVEC4 range;
	GI_UVEC4 corners;
} GI_END(gi_node_topology)

/* The same as gi_bvh_node in one uvec4, as rays read it: bounds in sixteenths of a word on a grid over the whole tree's
 * box, rounded outward, one cell more; then the skip, or for a leaf GI_PACKED_LEAF and its primitive (its skip is the
 * next node).
 *
 *   x lower.x | lower.y << 16    y lower.z | upper.x << 16    z upper.y | upper.z << 16    w link
 */
#define GI_PACKED_LEAF 0x80000000u
#define GI_PACKED_CELLS 65535.0f

/* A node of an object's bounding volume hierarchy, depth-first with skip links: go to n + 1 when the box is hit, to
 * `skip` when not; no stack. In the object's rest frame.
 *
 *   //--------------- 16B ---------------
 *   lower.xyz    lower.w skip, as uint bits
 *   upper.xyz    upper.w primitive number when a leaf, else GI_NONE, as uint bits
 */
GI_STRUCT(gi_bvh_node) {
	GI_VEC4 lower;
	GI_VEC4 upper;
} GI_END(gi_bvh_node)

/* What rays meet: a quad, as the two triangles a b c and a c d, standing for the leaves [first, end) of its object.
 *
 *   //--------------- 16B ---------------
 *   a.xyz  a.w first leaf, as uint bits
 *   b.xyz  b.w end leaf, as uint bits
 *   c.xyz  c.w 0
 *   d.xyz  d.w 0
 */
GI_STRUCT(gi_primitive) {
	GI_VEC4 a;
	GI_VEC4 b;
	GI_VEC4 c;
	GI_VEC4 d;
} GI_END(gi_primitive)

/* An object of the scene. Slots are dense; the sky, when there is one, is the last.
 *
 *   //--------------- 16B ---------------
 *   row0..row2  rows of the matrix world_from_object: rotation, then translation in w
 *   lower.xyz upper.xyz  bounds in the rest frame
 *   grid.xyz  where the grid of its packed BVH begins    cells.xyz  cells per metre
 *   sphere.xyz  centre of the world bounding sphere    sphere.w radius
 *   nodes.x root    nodes.y end node    nodes.z first leaf    nodes.w end leaf
 *   bvh.x root    bvh.y end    bvh.z GI_OBJECT_ flags    bvh.w first suspect
 *   extra.x end suspect    extra.y first vertex    extra.z end vertex    extra.w 0
 *
 * Suspects are the objects that may have changed what this object's entries see: the movers for one at rest, those
 * whose boxes overlap its own for a mover.
 */
GI_STRUCT(gi_object_data) {
	GI_VEC4 row0;
	GI_VEC4 row1;
	GI_VEC4 row2;
	GI_VEC4 lower;
	GI_VEC4 upper;
	GI_VEC4 grid;
	GI_VEC4 cells;
	GI_VEC4 sphere;
	GI_UVEC4 nodes;
	GI_UVEC4 bvh;
	GI_UVEC4 extra;
} GI_END(gi_object_data)

#define GI_OBJECT_MOVED 1u
#define GI_OBJECT_SKY 2u
#define GI_OBJECT_FLAT 4u /* all its surface in one plane: it cannot hide itself */

/* A leaf: x node, y object slot, z material, w 0. A material: rho, then exitance. */
GI_STRUCT(gi_material_data) {
	GI_VEC4 rho;
	GI_VEC4 exitance;
} GI_END(gi_material_data)

/* A run of threads: threads [first, first of the next) work on pair (object, other); offset is added to the thread's
 * number in the run. Runs are sorted by first; the last one ends at the dispatch's thread count.
 *   x first    y object    z other    w offset
 */

/* What one frame's dispatches need to know.
 *
 *   //--------------- 16B ---------------
 *   counts: leaves, nodes, object slots, vertices
 *   limits: entry pool, queue, most samples of a near leaf, of an emitter
 *   tolerance: form factor, of emitters, of sky patches, of the solve
 *   work: pose runs, pose threads, cut runs, cut threads
 *   grid, cells: of the packed TLAS, as of an object's
 *   misc: TLAS nodes, wide nodes, light vertices, 1 where the sky shines
 */
GI_STRUCT(gi_frame) {
	GI_UVEC4 counts;
	GI_UVEC4 limits;
	GI_VEC4 tolerance;
	GI_UVEC4 work;
	GI_UVEC4 misc;
	GI_VEC4 grid;
	GI_VEC4 cells;
} GI_END(gi_frame)

/* An entry of a row, in the segment of its (leaf, source object) pair.
 *   x node
 *   y form factor, as float bits
 *   z visible samples as a mask in bits 0..15, GI_BLOCKER_ or slot of the object that hides the others in bits 16..31
 *   w leaf in bits 0..23, samples taken in bits 24..28, GI_ENTRY_BACK
 */
#define GI_ENTRY_LEAF_MASK 0x00FFFFFFu
#define GI_ENTRY_SAMPLE_SHIFT 24u
#define GI_ENTRY_SAMPLE_MASK 0x1Fu
#define GI_ENTRY_BACK 0x80000000u
#define GI_BLOCKER_MIXED 0xFFFEu /* several objects */
#define GI_BLOCKER_NONE 0xFFFFu

/* A segment, the cut of one object in one row: x and y a block of entries, z the share of its samples that see their
 * object as float bits (close.comp), w 0.
 *
 * A block of a pool: x offset, y count in bits 0..23, size class in bits 24..31 (255: no block). Class c holds 4 << c.
 */
#define GI_BLOCK_COUNT_MASK 0x00FFFFFFu
#define GI_BLOCK_NO_CLASS 255u
#define GI_BLOCK_CLASSES 22u
#define GI_BLOCK_SMALLEST 4u

/* Row header of a leaf: x link offset, y count and class as a block, z 0, w row sum bits. */

/* What the GPU counts and decides; the head of the state buffer, copied out as the frame's report. Unsigned words;
 * *_BITS are floats >= 0, whose bits order as the floats do, so that atomicMax works on them. */
#define GI_STATE_NEW 0u            /* queue entries cut anew */
#define GI_STATE_QUEUED 1u         /* the same plus flagged ones */
#define GI_STATE_RAYS 2u
#define GI_STATE_DIRTY_ROWS 3u
#define GI_STATE_OVERFLOW 4u       /* a pool or the queue was full */
#define GI_STATE_ENTRIES 5u        /* in all rows; kept over frames */
#define GI_STATE_LINKS 6u          /* likewise */
#define GI_STATE_NOT_FINITE 7u
#define GI_STATE_SWEEPS 8u
#define GI_STATE_ACTIVE 9u         /* 1 while the solve has to go on */
#define GI_STATE_RESIDUAL_BITS 10u /* 3: rgb, of the last sweep */
#define GI_STATE_Q_BITS 13u        /* 3 */
#define GI_STATE_B_MAX_BITS 16u    /* 3 */
#define GI_STATE_BOUND_BITS 19u    /* largest of rgb */
#define GI_STATE_BOUND_RELATIVE_BITS 20u
#define GI_STATE_DONE_RESIDUAL_BITS 21u /* largest of rgb, when the solve ended */
#define GI_STATE_DONE_Q_BITS 22u
#define GI_STATE_DONE_B_MAX_BITS 23u
/* Group counts for indirect dispatches, 3 words each. */
#define GI_STATE_ARGS_FACTOR 24u
#define GI_STATE_ARGS_TRACE 27u
#define GI_STATE_ARGS_GATHER 30u
#define GI_STATE_ARGS_PULL 33u
#define GI_STATE_ARGS_WIDE 36u
#define GI_STATE_ARGS_CHECK 39u
#define GI_STATE_ARGS_RECYCLE 42u
/* What the estimate's leaves say (estimate_mean.comp); as float bits but for the last. */
#define GI_STATE_ESTIMATE_SQUARED 72u /* area mean of |H error|^2, (W/m2)^2; below 0 where noise hides it */
#define GI_STATE_ESTIMATE_POWER 73u   /* area mean of |H|^2 */
#define GI_STATE_ESTIMATE_RAYS 74u
#define GI_STATE_WORDS 96u

/* An allocator: bump pointer, pending count, then free counts per class; its lists are in the buffer behind it. */
#define GI_POOL_BUMP 0u
#define GI_POOL_PENDING 1u
#define GI_POOL_LIMIT 2u           /* elements */
#define GI_POOL_LIST 3u            /* where the free lists begin, in words */
#define GI_POOL_FREE 4u            /* GI_BLOCK_CLASSES signed counts */
#define GI_POOL_PENDING_LIST 32u   /* GI_POOL_PENDING_MAX pairs: offset, class */
#define GI_POOL_PENDING_MAX 131072u

#define GI_BIND_FRAME 0
#define GI_BIND_OBJECTS 1
#define GI_BIND_TOPOLOGY 2
#define GI_BIND_REST 3
#define GI_BIND_WORLD 4
#define GI_BIND_VERTICES_REST 5
#define GI_BIND_VERTICES_WORLD 6
#define GI_BIND_LEAVES 7
#define GI_BIND_MATERIALS 8
#define GI_BIND_BVH 9
#define GI_BIND_PRIMITIVES 10
#define GI_BIND_TLAS 11
#define GI_BIND_SEGMENTS 12
#define GI_BIND_ENTRIES 13
#define GI_BIND_ENTRY_POOL 14
#define GI_BIND_QUEUE 15
#define GI_BIND_ROWS 16
#define GI_BIND_LINKS 17
#define GI_BIND_LINK_POOL 18
#define GI_BIND_RADIOSITY 19       /* vec4 per node */
#define GI_BIND_LEAF_RADIOSITY 20  /* vec4 per leaf: rgb, largest step of the last sweep */
#define GI_BIND_NODE_EXITANCE 21   /* vec4 per node: area mean of E */
#define GI_BIND_STATE 22
#define GI_BIND_RUNS 23            /* uvec4: pose runs, then cut runs */
#define GI_BIND_SUSPECTS 24
#define GI_BIND_WIDE_NODES 25      /* nodes of more than GI_WIDE_LEAVES leaves */
#define GI_BIND_LEAF_INDIRECT 26   /* vec4 per leaf */
#define GI_BIND_LIGHT_LINKS 27     /* uvec2 per (light vertex, leaf): leaf, weight bits */
#define GI_BIND_LIGHT_FIRST 28     /* uint per light vertex, plus one */
#define GI_BIND_LIGHT 29           /* vec4 per light vertex */
#define GI_BIND_TOUCHED 30         /* uint per leaf: entries cut or flagged by this update */
#define GI_BIND_SPREAD 31

/* The estimate's own, in places whose owners its dispatches do not read; rows_bind and scene_bind bring those back. */
#define GI_BIND_ESTIMATE_ITEMS GI_BIND_RUNS          /* uvec4 per item: an entry between a point of a leaf and a leaf */
#define GI_BIND_ESTIMATE_SHARES GI_BIND_SUSPECTS     /* float per item: what its F V counts */
#define GI_BIND_ESTIMATE_CHANCES GI_BIND_WIDE_NODES  /* vec2 per leaf: end of its part of [0,1], the part */
#define GI_BIND_ESTIMATE_RESULTS GI_BIND_LIGHT_LINKS /* gi_estimate_leaf per chosen leaf */

/* A chosen leaf has this many items in all, in independent groups. */
#define GI_ESTIMATE_ITEMS 512u
#define GI_ESTIMATE_GROUPS 4u

/* A leaf that the estimate looked at.
 *
 *   //--------------- 16B ---------------
 *   light.xyz H by its row    light.w 1 where the row is closed
 *   error.x area share over chance    error.y |H error|^2    error.z rays, as uint bits    error.w leaf, as uint bits
 *   bias.xyz H's error, with the noise of the samples    bias.w part of H that is reflected and arrives again
 */
GI_STRUCT(gi_estimate_leaf) {
	GI_VEC4 light;
	GI_VEC4 error;
	GI_VEC4 bias;
} GI_END(gi_estimate_leaf)

#define GI_WIDE_LEAVES 64u

#endif
