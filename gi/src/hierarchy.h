/* The patch hierarchy of one object: leaves are the finest faces, their parents the coarser faces, and above the base
 * faces a binary cluster tree gives the object one root. Everything in the object's rest frame (scale applied), all
 * numbers local to the object.
 *
 *            root (cluster)
 *            /           \
 *       cluster         face 2         level 0: base faces of the cage
 *       /     \        / | | \
 *   face 0  face 1    leaves           level 1: finest faces
 *
 * Nodes and leaves lie in depth-first order, so each node covers a contiguous range of leaves.
 */
#ifndef GI_HIERARCHY_H
#define GI_HIERARCHY_H

#include "refine.h"

#include "gi_shared.h"
#include "vec3d.h"

/* What adds up over the leaves of a node: areas times normals, areas, outer products of those by area, bounds. */
typedef struct gi_node_sums {
	gi_vec3d moment;
	double area, outer[6]; /* xx yy zz xy yz zx */
	gi_vec3d lower, upper;
} gi_node_sums;

typedef struct gi_hierarchy {
	uint32_t vertex_count;
	gi_vec4 *vertices; /* xyz; w 0 */
	uint32_t leaf_count;
	uint32_t *leaf_node; /* node of a leaf; its corners are the node's */
	uint32_t *leaf_material;
	uint32_t *leaf_face; /* face number in the finest level of the gi_refined it came from */
	uint32_t node_count; /* node 0 is the root */
	gi_node_geometry *geometry;
	gi_node_spread *spread;
	gi_node_topology *topology; /* GI_NODE_EMITTER and GI_NODE_SKY are not set here */
	gi_vec4 lower, upper;       /* bounds of the vertices */
	double area;                /* sum of the leaves', of a shape that changes as it was built */
	double volume;              /* signed; meaningful when closed */
	bool closed;                /* no boundary edges */
	bool deforms;               /* vertices may change: which nodes are polygons does not */
	bool out_of_memory;         /* why gi_hierarchy_build failed; all else is zero then */
} gi_hierarchy;

/* Area of the triangles a b c and a c d. */
double gi_quad_area(const float a[3], const float b[3], const float c[3], const float d[3]);

/* Builds the hierarchy. Faces of zero area (below 1e-12 of the squared diagonal of the bounds) become no leaves. False
 * with a message when nothing is left, or memory ran out. GI_NODE_BACK is set on every node unless the object is closed
 * and its signed volume is positive. */
bool gi_hierarchy_build(const gi_refined *refined, gi_hierarchy *out, char *message, size_t message_size);

/* Of one that deforms, built of a gi_refined with stencils, whose vertices are others now: bounds, volume and all
 * measures of nodes anew, a function of the vertices alone. Which leaf hangs below which node stays. sums: room for
 * node_count. */
void gi_hierarchy_refit(gi_hierarchy *hierarchy, gi_node_sums *sums);

void gi_hierarchy_free(gi_hierarchy *hierarchy);

/* Names the first broken rule, or NULL: areas of children add up to their parent's (1e-5 relative), ranges nest,
 * spheres and cones hold their leaves, flags and corners agree. */
const char *gi_validate_hierarchy(const gi_hierarchy *hierarchy);

#endif
