/* What a node knows of the leaves below it. */
#ifndef GI_HIERARCHY_NODE_H
#define GI_HIERARCHY_NODE_H

#include "hierarchy.h"
#include "hierarchy_quad.h"
#include "vec3d.h"

/* Flat: every corner this near the plane, in units of the node's radius, and the areas this near each other. Positions
 * are rounded to float (6e-8); what bends by less than 1e-5 changes no form factor that float arithmetic could show. */
#define GI_FLAT_TOLERANCE 1e-5

/* All of it, once the node's leaves are there, and its children are measured. */
void gi_node_measure(gi_hierarchy *h, uint32_t node);

/* The same by sums of children, for what is measured anew every frame: leaf after leaf they are other bits. */
void gi_node_measure_by(gi_hierarchy *h, uint32_t node, const gi_node_sums *sums);
gi_node_sums gi_node_no_sums(void);
void gi_node_add_quad(gi_node_sums *to, const quad *leaf);
void gi_node_add_sums(gi_node_sums *to, const gi_node_sums *child);

/* Single measures, for what builds and what checks. */
gi_vec3d gi_node_farthest_corner(const gi_hierarchy *h, uint32_t node, gi_vec3d from, double *distance);
bool gi_node_is_flat(const gi_hierarchy *h, uint32_t node);
double gi_node_least_cosine(const gi_hierarchy *h, uint32_t node, gi_vec3d axis);
gi_vec3d gi_node_normal(const gi_hierarchy *h, uint32_t node);
double gi_node_thickness(const gi_hierarchy *h, uint32_t node);

#endif
