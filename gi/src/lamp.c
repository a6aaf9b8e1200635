#include "lamp.h"

#include "compiler.h"
#include "context.h"
#include "vec3d.h"

#include <math.h>
#include <string.h>

/* Polygons of one object before neighbours are joined: an emitting quad of 16 x 16 faces. */
enum { CANDIDATES = 256 };

/* A curved lamp is cut until it has this many polygons: their contours then give its light within some per cent. */
enum { CURVED_POLYGONS = 12 };

/* Corners closer than this share of a polygon's size are one; sines below it are straight. */
static const double JOIN_TOLERANCE = 1e-4;

typedef struct candidate {
	lamp_polygon polygon;
	uint32_t node; /* GI_NONE: joined of several */
	bool curved;
} candidate;

typedef struct candidates {
	uint32_t count;
	bool overflow;
	candidate list[CANDIDATES];
} candidates;

/* ---- cutting one object ---- */

static gi_vec3d corner_at(const lamp_polygon *p, int k)
{
	const float *c = p->corner[k & 3];
	return (gi_vec3d){c[0], c[1], c[2]};
}

static double polygon_area(const lamp_polygon *p)
{
	return gi_quad_area(p->corner[0], p->corner[1], p->corner[2], p->corner[3]);
}

static bool emission_is_uniform(const object_record *o, gi_uvec4 range)
{
	const float *first = o->materials[o->hierarchy.leaf_material[range.y]].exitance;
	for (uint32_t leaf = range.y + 1; leaf < range.y + range.z; leaf++)
		if (memcmp(first, o->materials[o->hierarchy.leaf_material[leaf]].exitance, 3 * sizeof(float)) != 0)
			return false;
	return true;
}

static bool emits(const object_record *o, gi_uvec4 range)
{
	for (uint32_t leaf = range.y; leaf < range.y + range.z; leaf++)
		if (material_emits(&o->materials[o->hierarchy.leaf_material[leaf]]))
			return true;
	return false;
}

/* How far the vertices of the node's leaves rise above the plane through the middle of the polygon's corners. */
static double bulge_of(const gi_hierarchy *h, gi_uvec4 range, const lamp_polygon *p)
{
	const gi_vec3d normal = {p->normal[0], p->normal[1], p->normal[2]};
	double plane = 0, most = 0;
	for (int k = 0; k < 4; k++)
		plane += 0.25 * gi_vec3d_dot(normal, corner_at(p, k));
	for (uint32_t leaf = range.y; leaf < range.y + range.z; leaf++) {
		const uint32_t *corners = &h->topology[h->leaf_node[leaf]].corners.x;
		for (int k = 0; k < 4; k++)
			most = fmax(most, gi_vec3d_dot(normal, gi_vec3d_from(h->vertices[corners[k]])) - plane);
	}
	return most;
}

static candidate make_candidate(const object_record *o, uint32_t node)
{
	const gi_hierarchy *h = &o->hierarchy;
	const gi_node_topology *t = &h->topology[node];
	const gi_node_geometry *g = &h->geometry[node];
	candidate c = {.node = node, .curved = !(t->range.w & GI_NODE_FLAT)};
	lamp_polygon *p = &c.polygon;
	const uint32_t *corners = &t->corners.x;
	for (int k = 0; k < 4; k++)
		memcpy(p->corner[k], &h->vertices[corners[k]], sizeof p->corner[k]);
	memcpy(p->normal, &g->axis, sizeof p->normal);
	/* Rounding is no bulge. */
	const double bulge = bulge_of(h, t->range, p);
	p->bulge = bulge > JOIN_TOLERANCE * g->sphere.w ? (float)bulge : 0.0f;
	/* What a curved surface emits, its polygon emits. */
	const double area = polygon_area(p), scale = area > 0 ? g->moment.w / area : 0;
	const float *e = o->materials[h->leaf_material[t->range.y]].exitance;
	for (int k = 0; k < 3; k++)
		p->exitance[k] = (float)(e[k] * scale);
	p->power = g->moment.w * (e[0] + e[1] + e[2]) / 3;
	return c;
}

/* The coarsest nodes below (and with) `node` that are polygons of one emission. */
static void collect(const object_record *o, uint32_t node, bool split, candidates *out)
{
	const gi_node_topology *topology = o->hierarchy.topology;
	const gi_uvec4 range = topology[node].range;
	if (!emits(o, range) || out->overflow)
		return;
	const bool leaf = range.w & GI_NODE_LEAF;
	if (leaf || (!split && (range.w & GI_NODE_POLYGON) && emission_is_uniform(o, range))) {
		out->overflow = out->count == CANDIDATES;
		if (!out->overflow)
			out->list[out->count++] = make_candidate(o, node);
		return;
	}
	for (uint32_t child = node + 1; child < range.x; child = topology[child].range.x)
		collect(o, child, false, out);
}

/* ---- joining ---- */

static bool is_quad(const lamp_polygon *p)
{
	return memcmp(p->corner[2], p->corner[3], sizeof p->corner[2]) != 0;
}

static bool is_near(gi_vec3d a, gi_vec3d b, double tolerance)
{
	return gi_vec3d_length(gi_vec3d_sub(a, b)) <= tolerance;
}

static bool is_straight(gi_vec3d a, gi_vec3d b, gi_vec3d c)
{
	const gi_vec3d u = gi_vec3d_sub(b, a), v = gi_vec3d_sub(c, b);
	return gi_vec3d_length(gi_vec3d_cross(u, v)) <= JOIN_TOLERANCE * gi_vec3d_length(u) * gi_vec3d_length(v);
}

static void set_corner(lamp_polygon *p, int k, gi_vec3d v)
{
	p->corner[k][0] = (float)v.x;
	p->corner[k][1] = (float)v.y;
	p->corner[k][2] = (float)v.z;
}

/* Two quads with a common edge, whose sides go straight on beyond it, are one quad: a takes b in. */
static bool join(lamp_polygon *a, const lamp_polygon *b)
{
	if (memcmp(a->exitance, b->exitance, sizeof a->exitance) != 0)
		return false;
	const double tolerance = JOIN_TOLERANCE * sqrt(polygon_area(a));
	for (int i = 0; i < 4; i++)
		for (int j = 0; j < 4; j++) {
			const gi_vec3d start = corner_at(a, i), end = corner_at(a, i + 1);
			if (!is_near(start, corner_at(b, j + 1), tolerance) ||
			    !is_near(end, corner_at(b, j), tolerance) ||
			    !is_straight(corner_at(a, i + 3), start, corner_at(b, j + 2)) ||
			    !is_straight(corner_at(b, j + 3), end, corner_at(a, i + 2)))
				continue;
			const gi_vec3d corners[4] = {corner_at(a, i + 2), corner_at(a, i + 3), corner_at(b, j + 2),
						     corner_at(b, j + 3)};
			for (int k = 0; k < 4; k++)
				set_corner(a, k, corners[k]);
			a->power += b->power;
			return true;
		}
	return false;
}

static bool may_join(const candidate *a, const candidate *b)
{
	const gi_vec3d n = {a->polygon.normal[0], a->polygon.normal[1], a->polygon.normal[2]};
	const gi_vec3d m = {b->polygon.normal[0], b->polygon.normal[1], b->polygon.normal[2]};
	return !a->curved && !b->curved && gi_vec3d_dot(n, m) > 1 - JOIN_TOLERANCE && is_quad(&a->polygon) &&
	       is_quad(&b->polygon);
}

static void join_neighbours(candidates *c)
{
	for (bool joined = true; joined;) {
		joined = false;
		for (uint32_t a = 0; a < c->count; a++)
			for (uint32_t b = a + 1; b < c->count; b++)
				if (may_join(&c->list[a], &c->list[b]) &&
				    join(&c->list[a].polygon, &c->list[b].polygon)) {
					c->list[b--] = c->list[--c->count];
					joined = true;
				}
	}
}

/* Curved polygons one level finer. */
static void split_curved(const object_record *o, const candidates *from, candidates *to)
{
	to->count = 0;
	to->overflow = false;
	for (uint32_t k = 0; k < from->count; k++) {
		const candidate *c = &from->list[k];
		if (c->curved)
			collect(o, c->node, true, to);
		else if (to->count < CANDIDATES)
			to->list[to->count++] = *c;
		else
			to->overflow = true;
	}
}

static bool any_curved(const candidates *c)
{
	for (uint32_t k = 0; k < c->count; k++)
		if (c->list[k].curved)
			return true;
	return false;
}

/* The polygons of one object; false when they are too many. */
static bool cut_object(const object_record *o, candidates *out)
{
	out->count = 0;
	out->overflow = false;
	collect(o, 0, false, out);
	if (out->overflow)
		return false;
	join_neighbours(out);
	while (any_curved(out) && out->count < CURVED_POLYGONS) {
		static GI_THREAD_LOCAL candidates finer; /* too large for a stack */
		split_curved(o, out, &finer);
		if (finer.overflow || finer.count > GI_LAMP_MAX || finer.count == out->count)
			break;
		*out = finer;
	}
	return out->count <= GI_LAMP_MAX;
}

/* ---- choosing ---- */

static void mark(gi_context *gi, const object_record *o, bool lamp, bool upload)
{
	gi_node_topology *topology = gi->scene.topology + o->node_base;
	const uint32_t count = o->hierarchy.node_count;
	if (((topology->range.w & GI_NODE_LAMP) != 0) == lamp)
		return;
	for (uint32_t k = 0; k < count; k++)
		topology[k].range.w = lamp ? topology[k].range.w | GI_NODE_LAMP : topology[k].range.w & ~GI_NODE_LAMP;
	if (upload)
		gpu_buffer_upload(&gi->gpu, &gi->scene.topology_gpu, sizeof *topology * o->node_base,
				  sizeof *topology * count, topology);
}

static double power_of(const gi_context *gi, const object_record *o)
{
	const gi_vec4 e = gi->scene.node_exitance[o->node_base];
	return o->hierarchy.area * ((double)e.x + e.y + e.z);
}

/* The strongest emitter weaker than (power, slot), so that equals keep their order; GI_NONE when there is none. */
static uint32_t next_emitter(const gi_context *gi, double *power, uint32_t after)
{
	const gi_scene *s = &gi->scene;
	uint32_t best = GI_NONE;
	double most = 0;
	for (uint32_t slot = 0; slot < s->slot_count; slot++) {
		if (s->slots[slot] == GI_NONE)
			continue;
		const double p = power_of(gi, &s->objects[s->slots[slot]]);
		if (p > most && (p < *power || (p == *power && slot > after))) {
			most = p;
			best = slot;
		}
	}
	*power = most;
	return best;
}

static void take_object(const gi_context *gi, gi_lamps *next, uint32_t slot)
{
	static GI_THREAD_LOCAL candidates cut;
	if (!cut_object(&gi->scene.objects[gi->scene.slots[slot]], &cut) ||
	    next->count + cut.count > gi->def.pixel_lamps)
		return;
	for (uint32_t k = 0; k < cut.count; k++) {
		cut.list[k].polygon.slot = slot;
		next->polygon[next->count++] = cut.list[k].polygon;
	}
}

static bool is_lamp(const gi_lamps *lamps, uint32_t slot)
{
	for (uint32_t k = 0; k < lamps->count; k++)
		if (lamps->polygon[k].slot == slot)
			return true;
	return false;
}

void lamps_select(gi_context *gi, bool upload)
{
	const gi_scene *s = &gi->scene;
	gi_lamps next = {.generation = gi->lamps.generation + 1};
	double power = INFINITY;
	uint32_t slot = GI_NONE;
	/* Nobody looks at more emitters than there may be polygons. */
	for (uint32_t k = 0; k < gi->def.pixel_lamps && (slot = next_emitter(gi, &power, slot)) != GI_NONE; k++)
		take_object(gi, &next, slot);
	for (slot = 0; slot < s->slot_count; slot++)
		if (s->slots[slot] != GI_NONE)
			mark(gi, &s->objects[s->slots[slot]], is_lamp(&next, slot), upload);
	gi->lamps = next;
}
