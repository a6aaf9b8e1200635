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

/* What a node is. Nodes lie in depth-first order: the first child of node n is n + 1, the node after its subtree is `skip`.
 *
 *   //--------------- 16B ---------------
 *   range.x skip    range.y first leaf    range.z leaf count    range.w GI_NODE_ flags
 *   corners: vertex numbers, counter-clockwise; GI_NONE for a cluster; a triangle repeats its third corner
 */
GI_STRUCT(gi_node_topology) {
	GI_UVEC4 range;
	GI_UVEC4 corners;
} GI_END(gi_node_topology)

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

#endif
