#include "shadow.h"

#include "context.h"
#include "vec3d.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Edge of a depth map, texels. */
enum { MAP_SIZE = 512 };

/* Objects of at most this many flat polygons are looked at polygon by polygon for walls, which hide nothing. */
enum { WALL_POLYGONS = 64 };

/* Where casters lie within these slopes to each side of a lamp's normal (63 degrees) maps are plain perspectives of
 * them alone; else maps of the whole hemisphere. */
static const double WIDEST = 2;

/* Sectors of a hemisphere's map overlap by this share of its half width, an eighth of a texel: no texel between two is
 * missed. */
static const float SECTOR_OVERLAP = 5e-4f;

/* A frustum's borders are multiples of its width over this, so that maps keep their texels while something moves. */
static const double BORDER_STEPS = 16;

/* Texels between a border and the nearest shadow, for filters. */
static const double BORDER_TEXELS = 4;

/* A sample looks this share of the way to its neighbours aside, to both sides: shadows of neighbours then meet. */
static const double LOOK_ASIDE = 0.25;

/* Maps begin at this share of their depth: floats then tell depths in the far half apart to about 1e-4 of it. */
static const double NEAREST_SHARE = 1e-3;

/* Vertices this share of the scene's size behind a wall still lie on it. */
static const double WALL_SLACK = 1e-4;

typedef struct wall {
	float corner[4][3]; /* rest frame */
	gpu_range range;
} wall;

typedef struct shadow_caster {
	gpu_range range;
	uint32_t wall_count; /* 0: too many to look at */
	wall *walls;
	bool whole; /* none of its polygons is left out */
	uint32_t first_range, end_range;
	gi_vec3d box[8]; /* world */
} shadow_caster;

typedef struct caster_vertex {
	float position[3];
	uint32_t slot;
} caster_vertex;

/* ---- the mesh ---- */

/* The next of the coarsest flat polygons that tile the object, GI_NONE after the last; *node is where the walk is. */
static uint32_t next_flat(const gi_hierarchy *h, uint32_t *node)
{
	while (*node < h->node_count) {
		const gi_uvec4 range = h->topology[*node].range;
		const uint32_t found = *node;
		if ((range.w & GI_NODE_LEAF) || ((range.w & GI_NODE_POLYGON) && (range.w & GI_NODE_FLAT))) {
			*node = range.x;
			return found;
		}
		++*node;
	}
	return GI_NONE;
}

static uint32_t add_polygon(uint32_t *indices, const gi_node_topology *t, uint32_t base)
{
	const gi_uvec4 c = t->corners;
	const uint32_t six[6] = {c.x + base, c.y + base, c.z + base, c.x + base, c.z + base, c.w + base};
	const uint32_t count = c.z == c.w ? 3 : 6;
	memcpy(indices, six, sizeof *six * count);
	return count;
}

static bool add_walls(const gi_hierarchy *h, shadow_caster *c, uint32_t polygons)
{
	if (polygons > WALL_POLYGONS)
		return true;
	c->walls = calloc(polygons + 1, sizeof *c->walls);
	if (!c->walls)
		return false;
	uint32_t at = c->range.first, node = 0, found;
	while ((found = next_flat(h, &node)) != GI_NONE) {
		wall *w = &c->walls[c->wall_count++];
		const uint32_t *corners = &h->topology[found].corners.x;
		for (int k = 0; k < 4; k++)
			memcpy(w->corner[k], &h->vertices[corners[k]], sizeof w->corner[k]);
		w->range = (gpu_range){at, corners[2] == corners[3] ? 3 : 6};
		at += w->range.count;
	}
	return true;
}

static bool add_caster(const scene_object *o, uint32_t slot, shadow_caster *c, caster_vertex *vertices,
		       uint32_t *indices, uint32_t *index_count)
{
	const gi_hierarchy *h = &o->hierarchy;
	for (uint32_t v = 0; v < h->vertex_count; v++) {
		memcpy(vertices[o->vertex_base + v].position, &h->vertices[v], 3 * sizeof(float));
		vertices[o->vertex_base + v].slot = slot;
	}
	c->range.first = *index_count;
	uint32_t node = 0, found, polygons = 0;
	for (; (found = next_flat(h, &node)) != GI_NONE; polygons++)
		*index_count += add_polygon(indices + *index_count, &h->topology[found], o->vertex_base);
	c->range.count = *index_count - c->range.first;
	return add_walls(h, c, polygons);
}

gi_result shadow_create(gi_context *gi, gi_shadow *shadow)
{
	const gi_scene *s = &gi->scene;
	shadow->casters = calloc(s->slot_count + 1, sizeof *shadow->casters);
	shadow->drawn_rows = calloc(s->slot_count + 1, sizeof *shadow->drawn_rows);
	shadow->caster_count = s->slot_count;
	caster_vertex *vertices = calloc(s->vertex_count + 1, sizeof *vertices);
	uint32_t *indices = calloc(6 * (size_t)s->leaf_count + 1, sizeof *indices), index_count = 0;
	bool ok = shadow->casters && shadow->drawn_rows && vertices && indices;
	for (uint32_t slot = 0; ok && slot < s->slot_count; slot++)
		if (s->slots[slot] != GI_NONE)
			ok = add_caster(&s->objects[s->slots[slot]], slot, &shadow->casters[slot], vertices, indices,
					&index_count);
	static const gpu_attribute attributes[] = {{3, false, 0}, {1, true, offsetof(caster_vertex, slot)}, {0}};
	gi_result result = GI_OK;
	if (ok)
		result = gpu_mesh_create(&gi->gpu, &shadow->mesh, attributes, sizeof *vertices, s->vertex_count,
					 vertices, index_count, indices);
	else
		result = gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	free(vertices);
	free(indices);
	if (!result && !shadow->program)
		result = gpu_program_draw(&gi->gpu, "shadow.vert", "shadow.frag", &shadow->program);
	if (!result)
		result = gpu_buffer_allocate(&gi->gpu, &shadow->uniforms, sizeof shadow->lamps, NULL);
	return result;
}

void shadow_invalidate(gi_context *gi, gi_shadow *shadow)
{
	for (uint32_t k = 0; shadow->casters && k < shadow->caster_count; k++)
		free(shadow->casters[k].walls);
	free(shadow->casters);
	free(shadow->drawn_rows);
	free(shadow->ranges);
	gpu_mesh_free(&gi->gpu, &shadow->mesh);
	gpu_buffer_free(&gi->gpu, &shadow->uniforms);
	*shadow = (gi_shadow){.program = shadow->program, .maps = shadow->maps, .generation = shadow->generation};
}

void shadow_free(gi_context *gi, gi_shadow *shadow)
{
	shadow_invalidate(gi, shadow);
	gpu_depth_maps_free(&gi->gpu, &shadow->maps);
	gpu_program_free(&shadow->program);
}

/* ---- what casts shadows ---- */

static gi_vec3d to_world(const gi_object_data *d, const float p[3])
{
	const gi_vec4 *rows[3] = {&d->row0, &d->row1, &d->row2};
	double out[3];
	for (int r = 0; r < 3; r++)
		out[r] = (double)rows[r]->x * p[0] + (double)rows[r]->y * p[1] + (double)rows[r]->z * p[2] + rows[r]->w;
	return (gi_vec3d){out[0], out[1], out[2]};
}

static gi_vec3d turn_to_world(const gi_object_data *d, const float p[3])
{
	const gi_vec3d zero = to_world(d, (const float[3]){0, 0, 0});
	return gi_vec3d_sub(to_world(d, p), zero);
}

/* Corners of the rest box, in the world: a tighter hull than the world's box of a turned object. */
static void place_box(const gi_object_data *d, gi_vec3d box[8])
{
	const float *lower = &d->lower.x, *upper = &d->upper.x;
	for (int k = 0; k < 8; k++) {
		const float p[3] = {k & 1 ? upper[0] : lower[0], k & 2 ? upper[1] : lower[1],
				    k & 4 ? upper[2] : lower[2]};
		box[k] = to_world(d, p);
	}
}

/* Does the whole scene lie on the front of the polygon's plane? Then it comes between no two points. */
static bool hides_nothing(const gi_context *gi, const gi_shadow *shadow, uint32_t slot, const wall *w)
{
	const gi_object_data *d = &gi->scene.object_data[slot];
	gi_vec3d c[4];
	for (int k = 0; k < 4; k++)
		c[k] = to_world(d, w->corner[k]);
	const gi_vec3d normal = gi_vec3d_cross(gi_vec3d_sub(c[2], c[0]), gi_vec3d_sub(c[3], c[1]));
	const double length = gi_vec3d_length(normal);
	if (!(length > 0))
		return true;
	const double slack = -WALL_SLACK * sqrt(length) * length, plane = gi_vec3d_dot(normal, c[0]);
	for (uint32_t k = 0; k < shadow->caster_count; k++) {
		if (k == slot || gi->scene.slots[k] == GI_NONE)
			continue;
		for (int b = 0; b < 8; b++)
			if (gi_vec3d_dot(normal, shadow->casters[k].box[b]) - plane < slack)
				return false;
	}
	/* Its own object polygon by polygon: a room's walls are seen from inside only. */
	const shadow_caster *own = &shadow->casters[slot];
	for (uint32_t k = 0; k < own->wall_count; k++)
		for (int b = 0; b < 4; b++)
			if (gi_vec3d_dot(normal, to_world(d, own->walls[k].corner[b])) - plane < slack)
				return false;
	return true;
}

static bool add_range(gi_shadow *shadow, uint32_t *count, gpu_range range, bool may_merge)
{
	if (may_merge && *count && shadow->ranges[*count - 1].first + shadow->ranges[*count - 1].count == range.first) {
		shadow->ranges[*count - 1].count += range.count;
		return true;
	}
	if (*count == shadow->range_capacity) {
		const uint32_t capacity = 2 * *count + 64;
		gpu_range *grown = realloc(shadow->ranges, sizeof *grown * capacity);
		if (!grown)
			return false;
		shadow->ranges = grown;
		shadow->range_capacity = capacity;
	}
	shadow->ranges[(*count)++] = range;
	return true;
}

/* The ranges of each object that can hide something. */
static bool find_casters(const gi_context *gi, gi_shadow *shadow)
{
	uint32_t count = 0;
	bool ok = true;
	for (uint32_t slot = 0; slot < shadow->caster_count; slot++)
		place_box(&gi->scene.object_data[slot], shadow->casters[slot].box);
	for (uint32_t slot = 0; ok && slot < shadow->caster_count; slot++) {
		shadow_caster *c = &shadow->casters[slot];
		c->first_range = count;
		if (!c->wall_count && c->range.count)
			ok = add_range(shadow, &count, c->range, false);
		for (uint32_t k = 0; ok && k < c->wall_count; k++)
			if (!hides_nothing(gi, shadow, slot, &c->walls[k]))
				ok = add_range(shadow, &count, c->walls[k].range, count > c->first_range);
		c->end_range = count;
	}
	return ok;
}

/* ---- lamps ---- */

/* Samples of the unit square whose shadows of a straight edge, summed, come nearest to the true ramp over all
 * directions of the edge (annealed; a grid leaves steps of a quarter where the edge runs along it). The first four lie
 * near the corners, the others follow from the outside in. */
static const float PATTERN_1[1][2] = {{0.5f, 0.5f}};
static const float PATTERN_2[2][2] = {{0.702f, 0.270f}, {0.298f, 0.730f}};
static const float PATTERN_4[4][2] = {{0.140f, 0.369f}, {0.860f, 0.631f}, {0.630f, 0.139f}, {0.370f, 0.862f}};
static const float PATTERN_8[8][2] = {{0.273f, 0.079f}, {0.727f, 0.923f}, {0.889f, 0.180f}, {0.110f, 0.820f},
				      {0.185f, 0.438f}, {0.815f, 0.562f}, {0.544f, 0.307f}, {0.455f, 0.692f}};
static const float PATTERN_16[16][2] = {{0.207f, 0.170f}, {0.872f, 0.771f}, {0.889f, 0.092f}, {0.156f, 0.912f},
					{0.047f, 0.340f}, {0.939f, 0.382f}, {0.737f, 0.937f}, {0.422f, 0.063f},
					{0.096f, 0.634f}, {0.520f, 0.868f}, {0.665f, 0.200f}, {0.766f, 0.497f},
					{0.331f, 0.739f}, {0.294f, 0.467f}, {0.466f, 0.307f}, {0.573f, 0.598f}};
static const float PATTERN_32[32][2] = {
	{0.077f, 0.129f}, {0.901f, 0.936f}, {0.915f, 0.118f}, {0.097f, 0.835f}, {0.218f, 0.980f}, {0.023f, 0.661f},
	{0.618f, 0.024f}, {0.731f, 0.965f}, {0.959f, 0.385f}, {0.294f, 0.051f}, {0.765f, 0.073f}, {0.924f, 0.566f},
	{0.093f, 0.283f}, {0.430f, 0.895f}, {0.121f, 0.442f}, {0.873f, 0.776f}, {0.584f, 0.848f}, {0.841f, 0.299f},
	{0.479f, 0.161f}, {0.185f, 0.725f}, {0.242f, 0.193f}, {0.359f, 0.784f}, {0.781f, 0.589f}, {0.236f, 0.537f},
	{0.554f, 0.237f}, {0.700f, 0.699f}, {0.314f, 0.352f}, {0.677f, 0.325f}, {0.651f, 0.486f}, {0.519f, 0.640f},
	{0.369f, 0.592f}, {0.458f, 0.416f}};

/* Where samples look aside, one after the other. */
static const float ASIDE[4][2] = {{1.0f, 0.0f}, {0.0f, 1.0f}, {0.7f, 0.7f}, {-0.7f, 0.7f}};

static const float (*pattern_of(uint32_t samples))[2]
{
	switch (samples) {
	case 1:
		return PATTERN_1;
	case 2:
		return PATTERN_2;
	case 4:
		return PATTERN_4;
	case 8:
		return PATTERN_8;
	case 16:
		return PATTERN_16;
	default:
		return PATTERN_32;
	}
}

/* Samples of each lamp: as many as the shaders of one or two lamps know, else powers of two by its share of the
 * power. */
static void share_samples(const gi_lamps *lamps, uint32_t samples[GI_LAMP_MAX])
{
	const bool few = lamps->count <= 2;
	uint32_t total = lamps->count;
	for (uint32_t k = 0; k < lamps->count; k++)
		samples[k] = few ? GI_LAMP_FEW_SAMPLES : 1;
	while (!few) {
		uint32_t best = GI_NONE;
		double most = 0;
		for (uint32_t k = 0; k < lamps->count; k++) {
			const double share = lamps->polygon[k].power / samples[k];
			if (share > most && total + samples[k] <= GI_LAMP_SAMPLE_MAX) {
				most = share;
				best = k;
			}
		}
		if (best == GI_NONE)
			return;
		total += samples[best];
		samples[best] *= 2;
	}
}

/* A lamp's frame and corners in the world, and what its frustum has to hold. */
typedef struct placed {
	gi_vec3d x, y, z, origin, corner[4];
	float (*samples)[2]; /* in the frame */
	uint32_t sample_count;
	double sample_lower[2], sample_upper[2];
	double spacing; /* of the samples */
	bool hemisphere;
	double nearest, farthest, lower[2], upper[2]; /* along z; slopes x/z, y/z. Of a hemisphere: distances e */
} placed;

static gi_vec3d unit(gi_vec3d v)
{
	const double length = gi_vec3d_length(v);
	return length > 0 ? gi_vec3d_scale(v, 1 / length) : (gi_vec3d){1, 0, 0};
}

static void place_frame(const gi_context *gi, const lamp_polygon *p, placed *l)
{
	const gi_object_data *d = &gi->scene.object_data[p->slot];
	l->origin = (gi_vec3d){0, 0, 0};
	for (int k = 0; k < 4; k++) {
		l->corner[k] = to_world(d, p->corner[k]);
		l->origin = gi_vec3d_add(l->origin, gi_vec3d_scale(l->corner[k], 0.25));
	}
	l->z = unit(turn_to_world(d, p->normal));
	const gi_vec3d edge = gi_vec3d_sub(l->corner[1], l->corner[0]);
	l->x = unit(gi_vec3d_sub(edge, gi_vec3d_scale(l->z, gi_vec3d_dot(edge, l->z))));
	l->y = gi_vec3d_cross(l->z, l->x);
}

static gi_vec3d in_frame(const placed *l, gi_vec3d p)
{
	const gi_vec3d q = gi_vec3d_sub(p, l->origin);
	return (gi_vec3d){gi_vec3d_dot(l->x, q), gi_vec3d_dot(l->y, q), gi_vec3d_dot(l->z, q)};
}

static void place_samples(placed *l, gi_vec4 *out)
{
	const gi_vec3d p = gi_vec3d_sub(l->corner[2], l->corner[0]), q = gi_vec3d_sub(l->corner[3], l->corner[1]);
	l->spacing = sqrt(0.5 * gi_vec3d_length(gi_vec3d_cross(p, q)) / l->sample_count);
	const float(*pattern)[2] = pattern_of(l->sample_count);
	for (int axis = 0; axis < 2; axis++) {
		l->sample_lower[axis] = INFINITY;
		l->sample_upper[axis] = -INFINITY;
	}
	gi_vec3d c[4];
	for (int k = 0; k < 4; k++)
		c[k] = in_frame(l, l->corner[k]);
	for (uint32_t k = 0; k < l->sample_count; k++) {
		const double u = pattern[k][0], v = pattern[k][1];
		const double w[4] = {(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v};
		double at[2] = {0, 0};
		for (int i = 0; i < 4; i++) {
			at[0] += w[i] * c[i].x;
			at[1] += w[i] * c[i].y;
		}
		out[k] = (gi_vec4){(float)at[0], (float)at[1], ASIDE[k & 3][0], ASIDE[k & 3][1]};
		for (int axis = 0; axis < 2; axis++) {
			l->sample_lower[axis] = fmin(l->sample_lower[axis], at[axis]);
			l->sample_upper[axis] = fmax(l->sample_upper[axis], at[axis]);
		}
	}
}

/* ---- the window ---- */

static void reach_point(placed *l, gi_vec3d q)
{
	const double at[2] = {q.x, q.y};
	for (int axis = 0; axis < 2; axis++) {
		l->lower[axis] = fmin(l->lower[axis], (at[axis] - l->sample_upper[axis]) / q.z);
		l->upper[axis] = fmax(l->upper[axis], (at[axis] - l->sample_lower[axis]) / q.z);
	}
	l->farthest = fmax(l->farthest, q.z);
}

/* The part of a box in front of z = nearest: its corners there and where its edges cross. */
static void reach_box(placed *l, const gi_vec3d box[8])
{
	gi_vec3d q[8];
	for (int k = 0; k < 8; k++) {
		q[k] = in_frame(l, box[k]);
		if (q[k].z >= l->nearest)
			reach_point(l, q[k]);
	}
	for (int k = 0; k < 8; k++)
		for (int bit = 1; bit < 8; bit *= 2) {
			const gi_vec3d a = q[k], b = q[k ^ bit];
			if ((a.z < l->nearest) == (b.z < l->nearest) || (k & bit))
				continue;
			const double t = (l->nearest - a.z) / (b.z - a.z);
			gi_vec3d cut = gi_vec3d_add(a, gi_vec3d_scale(gi_vec3d_sub(b, a), t));
			cut.z = l->nearest;
			reach_point(l, cut);
		}
}

static double closest_z(const placed *l, const gi_vec3d box[8], double *farthest)
{
	double closest = INFINITY;
	*farthest = -INFINITY;
	for (int k = 0; k < 8; k++) {
		const double z = in_frame(l, box[k]).z;
		closest = fmin(closest, z);
		*farthest = fmax(*farthest, z);
	}
	return closest;
}

/* A curved lamp does not hide itself: its surface lies about its polygons, and a sample on one would see the next one's
 * edge. */
static uint32_t own_shadow(const lamp_polygon *p, const gi_shadow *shadow)
{
	return p->bulge > 0 && p->slot < shadow->caster_count ? p->slot : GI_NONE;
}

/* Height over the lamp's plane from where on something casts: what lies in it does not, but for rounding. */
static double lowest_caster(const lamp_polygon *p, const placed *l)
{
	return 1.05 * p->bulge + 1e-4 * l->spacing;
}

/* Depths of the whole hemisphere: to the casters' farthest corner. */
static void take_hemisphere(const gi_shadow *shadow, uint32_t hole, placed *l)
{
	double aside = 0, farthest = 0;
	for (int axis = 0; axis < 2; axis++)
		aside = fmax(aside, fmax(-l->sample_lower[axis], l->sample_upper[axis]));
	for (uint32_t k = 0; k < shadow->caster_count; k++) {
		const shadow_caster *c = &shadow->casters[k];
		for (int b = 0; b < 8 && c->first_range < c->end_range && k != hole; b++) {
			const gi_vec3d q = in_frame(l, c->box[b]);
			farthest = fmax(farthest, fmax(q.z, 0) + fmax(fabs(q.x), fabs(q.y)) + aside);
		}
	}
	l->hemisphere = true;
	l->farthest = 1.01 * farthest;
	l->nearest = NEAREST_SHARE * farthest;
}

/* Fits the window to the casters before the lamp; false when there are none. */
static bool fit(const gi_shadow *shadow, const lamp_polygon *p, placed *l)
{
	double closest = INFINITY, farthest = 0, z;
	const uint32_t hole = own_shadow(p, shadow);
	for (uint32_t k = 0; k < shadow->caster_count; k++) {
		const shadow_caster *c = &shadow->casters[k];
		if (c->first_range == c->end_range || k == hole)
			continue;
		const double from = closest_z(l, c->box, &z);
		if (z <= lowest_caster(p, l))
			continue;
		closest = fmin(closest, from);
		farthest = fmax(farthest, z);
	}
	if (!(farthest > 0))
		return false;
	l->nearest = fmax(fmax(0.99 * closest, 1.05 * p->bulge), NEAREST_SHARE * farthest);
	l->farthest = l->nearest;
	for (int axis = 0; axis < 2; axis++) {
		l->lower[axis] = INFINITY;
		l->upper[axis] = -INFINITY;
	}
	for (uint32_t k = 0; k < shadow->caster_count; k++)
		if (shadow->casters[k].first_range < shadow->casters[k].end_range && k != hole)
			reach_box(l, shadow->casters[k].box);
	l->farthest *= 1.01;
	for (int axis = 0; axis < 2; axis++)
		if (l->lower[axis] < -WIDEST || l->upper[axis] > WIDEST) {
			take_hemisphere(shadow, hole, l);
			return true;
		}
	return l->upper[0] > l->lower[0];
}

/* One square window of slopes: borders on a grid, a margin of some texels. */
static void square_window(const placed *l, double lower[2], double *width)
{
	double from[2], to[2];
	const double span = fmax(l->upper[0] - l->lower[0], l->upper[1] - l->lower[1]);
	const double step = exp2(ceil(log2(fmax(span, 1e-6)))) / BORDER_STEPS;
	*width = 0;
	for (int axis = 0; axis < 2; axis++) {
		from[axis] = floor(l->lower[axis] / step) * step;
		to[axis] = ceil(l->upper[axis] / step) * step;
		*width = fmax(*width, to[axis] - from[axis]);
	}
	for (int axis = 0; axis < 2; axis++)
		lower[axis] = 0.5 * (from[axis] + to[axis] - *width) - *width * BORDER_TEXELS / MAP_SIZE;
	*width *= 1 + 2 * BORDER_TEXELS / MAP_SIZE;
}

static gi_vec4 frame_row(gi_vec3d axis, gi_vec3d origin)
{
	return (gi_vec4){(float)axis.x, (float)axis.y, (float)axis.z, (float)-gi_vec3d_dot(axis, origin)};
}

static void fill_lamp(const lamp_polygon *p, const placed *l, bool casts, gi_lamp *out)
{
	for (int k = 0; k < 4; k++)
		out->corner[k] = (gi_vec4){(float)l->corner[k].x, (float)l->corner[k].y, (float)l->corner[k].z, 0};
	out->exitance = (gi_vec4){p->exitance[0], p->exitance[1], p->exitance[2], (float)lowest_caster(p, l)};
	out->frame_x = frame_row(l->x, l->origin);
	out->frame_y = frame_row(l->y, l->origin);
	out->frame_z = frame_row(l->z, l->origin);
	if (!casts) {
		out->range.y = 0;
		return;
	}
	double lower[2] = {-1, -1}, width = 2;
	if (!l->hemisphere)
		square_window(l, lower, &width);
	const double n = l->nearest, f = l->farthest;
	out->map = (gi_vec4){(float)(1 / width), l->hemisphere ? 1.0f : 0.0f, (float)(-lower[0] / width),
			     (float)(-lower[1] / width)};
	out->depth = (gi_vec4){(float)(f / (f - n)), (float)(-f * n / (f - n)), (float)(width / MAP_SIZE),
			       (float)(LOOK_ASIDE * l->spacing)};
}

/* ---- drawing ---- */

/* A sample's sector (+x, -x, +y, -y) as matrices from the world, column-major: to clip coordinates of its map, x =
 * 2 u e - e and so on with the u and e of shade_shared.h; and to distances inside the sector's planes. A perspective
 * has no sectors, and all points are inside. */
static void sector_matrices(const gi_lamp *l, gi_vec4 sample, int sector, float clip[16], float planes[16])
{
	const float *x = &l->frame_x.x, *y = &l->frame_y.x, *z = &l->frame_z.x;
	const float along = 2 * l->depth.x - 1, sign = sector & 1 ? -1.0f : 1.0f;
	for (int k = 0; k < 4; k++) {
		const float last = k == 3 ? 1.0f : 0.0f;
		const float d[2] = {x[k] - last * sample.x, y[k] - last * sample.y};
		const float major = sign * d[sector / 2], minor = d[1 - sector / 2], e = z[k] + l->map.y * major;
		clip[4 * k + 0] = 2 * (d[0] * l->map.x + e * l->map.z) - e;
		clip[4 * k + 1] = 2 * (d[1] * l->map.x + e * l->map.w) - e;
		clip[4 * k + 2] = along * e + 2 * last * l->depth.y;
		clip[4 * k + 3] = e;
		const float inside[3] = {major - minor + SECTOR_OVERLAP * e, major + minor + SECTOR_OVERLAP * e,
					 z[k] - last * l->exitance.w};
		for (int row = 0; row < 3; row++)
			planes[4 * k + row] = l->map.y > 0 ? inside[row] : last;
		planes[4 * k + 3] = 0;
	}
}

/* Does the box lie outside of one of the planes as a whole? */
static bool is_outside(const gi_vec3d box[8], const float planes[16])
{
	for (int row = 0; row < 3; row++) {
		const float *m = planes + row;
		int outside = 0;
		for (int b = 0; b < 8; b++)
			outside += m[0] * box[b].x + m[4] * box[b].y + m[8] * box[b].z + m[12] < 0;
		if (outside == 8)
			return true;
	}
	return false;
}

/* The casters but `hole` and those outside; ranges one after the other are drawn at once. */
static void draw_casters(const gi_shadow *shadow, uint32_t hole, const float planes[16])
{
	gpu_range open = {0, 0};
	for (uint32_t k = 0; k < shadow->caster_count; k++) {
		const shadow_caster *c = &shadow->casters[k];
		if (k == hole || is_outside(c->box, planes))
			continue;
		for (uint32_t r = c->first_range; r < c->end_range; r++) {
			const gpu_range next = shadow->ranges[r];
			if (open.first + open.count == next.first) {
				open.count += next.count;
				continue;
			}
			gpu_mesh_draw_ranges(&shadow->mesh, shadow->program, &open, 1);
			open = next;
		}
	}
	gpu_mesh_draw_ranges(&shadow->mesh, shadow->program, &open, 1);
}

static void draw_maps(const gi_shadow *shadow, const lamp_polygon *polygon, const gi_lamp *lamp)
{
	const uint32_t hole = own_shadow(polygon, shadow);
	const bool hemisphere = lamp->map.y > 0;
	for (uint32_t k = 0; k < lamp->range.y; k++) {
		const uint32_t layer = lamp->range.x + k;
		gpu_depth_maps_begin_layer(&shadow->maps, layer, !hemisphere);
		for (int sector = 0; sector < (hemisphere ? 4 : 1); sector++) {
			float matrices[2][16];
			sector_matrices(lamp, shadow->lamps.samples[layer], sector, matrices[0], matrices[1]);
			gpu_set_matrices(shadow->program, 0, 2, matrices[0]);
			draw_casters(shadow, hole, matrices[1]);
		}
	}
}

static bool poses_changed(const gi_context *gi, gi_shadow *shadow)
{
	bool changed = false;
	for (uint32_t slot = 0; slot < shadow->caster_count; slot++) {
		const gi_object_data *d = &gi->scene.object_data[slot];
		changed = changed || memcmp(shadow->drawn_rows[slot], &d->row0, sizeof *shadow->drawn_rows) != 0;
		memcpy(shadow->drawn_rows[slot], &d->row0, sizeof *shadow->drawn_rows);
	}
	return changed;
}

static void place_lamps(const gi_context *gi, gi_shadow *shadow)
{
	const gi_lamps *lamps = &gi->lamps;
	gi_lamp_block *block = &shadow->lamps;
	uint32_t samples[GI_LAMP_MAX], first = 0;
	share_samples(lamps, samples);
	block->counts = (gi_uvec4){lamps->count, 0, 0, 0};
	for (uint32_t k = 0; k < lamps->count; k++) {
		placed l = {.sample_count = samples[k]};
		place_frame(gi, &lamps->polygon[k], &l);
		place_samples(&l, block->samples + first);
		block->lamps[k].range = (gi_uvec4){first, samples[k], 0, 0};
		fill_lamp(&lamps->polygon[k], &l, fit(shadow, &lamps->polygon[k], &l), &block->lamps[k]);
		first += samples[k];
	}
	block->counts.y = first;
}

gi_result shadow_update(gi_context *gi, gi_shadow *shadow)
{
	const bool moved = poses_changed(gi, shadow);
	if (shadow->drawn && !moved && shadow->drawn_lamps == gi->lamps.generation) {
		/* The report tells what the last gi_draw did. */
		if (!gi->timers[GI_PASS_SHADOW].pending)
			gi->timers[GI_PASS_SHADOW].ms = 0;
		return GI_OK;
	}
	if (!find_casters(gi, shadow))
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	place_lamps(gi, shadow);
	gpu_buffer_upload(&gi->gpu, &shadow->uniforms, 0, sizeof shadow->lamps, &shadow->lamps);
	gi_result result = gpu_depth_maps_create(&gi->gpu, &shadow->maps, MAP_SIZE, shadow->lamps.counts.y);
	if (result)
		return result;
	if (shadow->lamps.counts.y) {
		gpu_timer_begin(&gi->gpu, &gi->timers[GI_PASS_SHADOW]);
		gpu_draw_cull_backs(false);
		gpu_draw_clip(true);
		for (uint32_t k = 0; k < shadow->lamps.counts.x; k++)
			draw_maps(shadow, &gi->lamps.polygon[k], &shadow->lamps.lamps[k]);
		gpu_draw_clip(false);
		gpu_draw_cull_backs(true);
		gpu_timer_end(&gi->gpu, &gi->timers[GI_PASS_SHADOW]);
		shadow->generation++;
	}
	shadow->drawn = true;
	shadow->drawn_lamps = gi->lamps.generation;
	return GI_OK;
}
