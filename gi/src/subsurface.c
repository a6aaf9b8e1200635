#include "subsurface.h"

#include "bits.h"
#include "dipole.h"
#include "host_memory.h"
#include "vec3d.h"

#include <math.h>
#include <string.h>

/* What one point a side may be off by: of what the link carries, and as a share of the albedo. What is no more than
 * LEAST of that may be off by all of it. */
static const double TOLERANCE = 0.08, TOLERANCE_OF_ALL = 1e-4, LEAST = 1e-5;

/* Below this |dR_d| / R_d from end to end a few points a side do. */
static const double SMOOTH = 3;

/* Rounding of weights and their sums takes nothing beyond the albedo, which is below 1 where nothing is absorbed. */
static const double ROUNDED = 1 - 1e-6, LARGEST_ALBEDO = 0.9999;

/* Points on a side of a leaf where R_d is narrow. */
enum { GRADED = 4 };

/* A leaf: its triangles, one or two, with three points on each; a flat quad is one polygon. */
typedef struct patch {
	gi_vec3d quad[4];
	gi_vec3d triangles[2][3], normals[2];
	gi_vec3d points[6];
	double weights[6]; /* areas that the points stand for */
	uint32_t triangle_count;
	bool flat;
	gi_vec3d centre;
	double radius, area;
} patch;

/* R_d and its integral from a distance on, by s = 1 + squared distance / z_r2: linear between STEPS values an octave.
 * They are asked for some thousand times a leaf. */
enum { STEP_BITS = 7, STEPS = 1 << STEP_BITS };
typedef struct curve {
	gi_dipole dipole;
	double per_depth2, albedo;
	uint32_t octaves;
	double (*values)[2]; /* STEPS * octaves + 2: R_d, beyond */
} curve;

/* Of one row, as it is built. */
typedef struct share {
	uint32_t node;
	double weight[3];
} share;

typedef struct builder {
	const gi_hierarchy *h;
	curve curves[3];
	patch *patches;
	gi_vec3d *centroids; /* node_count: means of the leaves' centres, by area */
	uint32_t *first;     /* of each leaf's shares; leaf_count + 1 */
	share *shares;
	size_t share_count, share_room;
	double (*kept)[3];    /* node_count: what of its links is kept */
	double (*columns)[3]; /* node_count */
	uint32_t *value;      /* node_count: its value, GI_NONE: not wanted */
} builder;

/* ---- the medium ---- */

const char *gi_subsurface_fault(const gi_subsurface *m)
{
	for (int c = 0; c < 3; c++) {
		if (!(m->scattering[c] >= 0.0f && m->scattering[c] <= 1e9f))
			return "its scattering coefficient is outside 0..1e9 1/m";
		if (!(m->absorption[c] >= 0.0f && m->absorption[c] <= 1e9f))
			return "its absorption coefficient is outside 0..1e9 1/m";
	}
	return m->index >= 1.0f && m->index <= 2.5f ? NULL : "its index of refraction is outside 1..2.5";
}

/* ---- leaves ---- */

static void add_triangle(patch *p, gi_vec3d a, gi_vec3d b, gi_vec3d c)
{
	const double area = gi_vec3d_length(gi_vec3d_triangle(a, b, c));
	if (!(area > 0))
		return;
	const gi_vec3d corners[3] = {a, b, c}, sum = gi_vec3d_add(a, gi_vec3d_add(b, c));
	memcpy(p->triangles[p->triangle_count], corners, sizeof corners);
	p->normals[p->triangle_count] = gi_vec3d_unit(gi_vec3d_triangle(a, b, c));
	for (uint32_t k = 0; k < 3; k++) {
		const uint32_t at = 3 * p->triangle_count + k;
		p->points[at] = gi_vec3d_scale(gi_vec3d_add(sum, gi_vec3d_scale(corners[k], 3)), 1.0 / 6);
		p->weights[at] = area / 3;
	}
	p->centre = gi_vec3d_add(p->centre, gi_vec3d_scale(sum, area / 3));
	p->area += area;
	p->triangle_count++;
}

static patch patch_of(const gi_hierarchy *h, uint32_t leaf)
{
	const uint32_t *corners = &h->topology[h->leaf_node[leaf]].corners.x;
	gi_vec3d v[4];
	for (int k = 0; k < 4; k++)
		v[k] = gi_vec3d_from(h->vertices[corners[k]]);
	patch p = {.quad = {v[0], v[1], v[2], v[3]}};
	add_triangle(&p, v[0], v[1], v[2]);
	add_triangle(&p, v[0], v[2], v[3]);
	p.centre = gi_vec3d_scale(p.centre, 1 / p.area);
	p.flat = p.triangle_count == 2 && gi_vec3d_dot(p.normals[0], p.normals[1]) > 1 - 1e-12;
	for (int k = 0; k < 4; k++)
		p.radius = fmax(p.radius, gi_vec3d_length(gi_vec3d_sub(v[k], p.centre)));
	return p;
}

static void find_centroids(builder *b)
{
	const gi_hierarchy *h = b->h;
	for (uint32_t n = 0; n < h->node_count; n++) {
		const gi_uvec4 range = h->topology[n].range;
		gi_vec3d sum = {0, 0, 0};
		double area = 0;
		for (uint32_t leaf = range.y; leaf < range.y + range.z; leaf++) {
			const patch *p = &b->patches[leaf];
			sum = gi_vec3d_add(sum, gi_vec3d_scale(p->centre, p->area));
			area += p->area;
		}
		b->centroids[n] = gi_vec3d_scale(sum, 1 / area);
	}
}

/* ---- R_d ---- */

static bool make_curve(curve *c, const gi_subsurface *medium, int channel, double farthest)
{
	const gi_dipole d = gi_dipole_of(medium->scattering[channel], medium->absorption[channel], medium->index);
	const double ratio = farthest / d.depth[0];
	*c = (curve){.dipole = d,
		     .per_depth2 = 1 / (d.depth[0] * d.depth[0]),
		     .albedo = fmin(gi_dipole_albedo(&d), LARGEST_ALBEDO),
		     .octaves = (uint32_t)ceil(log2(1 + ratio * ratio)) + 1};
	c->values = gi_malloc(sizeof *c->values * (STEPS * c->octaves + 2));
	for (uint32_t k = 0; c->values && k < STEPS * c->octaves + 2; k++) {
		const double s = ldexp(1 + (double)(k % STEPS) / STEPS, (int)(k / STEPS));
		const double squared = (s - 1) / c->per_depth2;
		c->values[k][0] = gi_dipole_exitance(&d, squared);
		c->values[k][1] = gi_dipole_beyond(&d, squared);
	}
	return c->values != NULL;
}

/* The exponent and the first bits behind it number the step. */
static double look_up(const curve *c, double squared, int which)
{
	const double s = 1 + squared * c->per_depth2;
	uint64_t bits;
	memcpy(&bits, &s, sizeof bits);
	const uint64_t step = (bits >> (52 - STEP_BITS)) - ((uint64_t)1023 << STEP_BITS);
	if (step >= (uint64_t)STEPS * c->octaves)
		return 0;
	const double along =
	    (double)(bits & (((uint64_t)1 << (52 - STEP_BITS)) - 1)) * (1.0 / (1ull << (52 - STEP_BITS)));
	const double a = c->values[step][which], b = c->values[step + 1][which];
	return a + along * (b - a);
}

/* ---- integrals ---- */

/* Gauss and Legendre's of eight points on [0,1]: half of them, the others mirrored. */
static const double GAUSS_AT[4] = {0.01985507175123188, 0.10166676129318664, 0.2372337950418355, 0.4082826787521751};
static const double GAUSS_WEIGHT[4] = {0.05061426814518813, 0.11119051722668724, 0.15685332293894364,
				       0.18134189168918100};

/* Of an edge, as seen from the foot of x on the triangle's plane: the integral over the angle of what lies before it.
 * In the plane R_d r dr has a primitive, so that only the angle is left to sum up, however narrow R_d is. */
static void add_edge(const builder *b, gi_vec3d from, gi_vec3d to, gi_vec3d normal, double height2, double out[3])
{
	const gi_vec3d edge = gi_vec3d_sub(to, from);
	const double length = gi_vec3d_length(edge);
	const double distance = gi_vec3d_dot(normal, gi_vec3d_cross(from, to)) / length;
	if (!(fabs(distance) > 1e-12 * length))
		return;
	const double begin = atan2(gi_vec3d_dot(from, edge) / length, fabs(distance));
	const double end = atan2(gi_vec3d_dot(to, edge) / length, fabs(distance));
	const double signed_angle = distance > 0 ? end - begin : begin - end;
	for (int c = 0; c < 3; c++)
		out[c] += signed_angle * look_up(&b->curves[c], height2, 1);
	for (int k = 0; k < 8; k++) {
		const double at = k < 4 ? GAUSS_AT[k] : 1 - GAUSS_AT[7 - k];
		const double radius = distance / cos(begin + at * (end - begin));
		const double weight = signed_angle * GAUSS_WEIGHT[k < 4 ? k : 7 - k];
		for (int c = 0; c < 3; c++)
			out[c] -= weight * look_up(&b->curves[c], height2 + radius * radius, 1);
	}
}

/* Integral of R_d over a leaf, from one point, which may be its own: then it lies in its triangles' planes, though
 * the leaf be bent by more than a mean free path. */
static void add_over_patch(const builder *b, gi_vec3d x, const patch *p, bool own, double weight, double out[3])
{
	double sum[3] = {0};
	for (uint32_t t = 0; t < (p->flat ? 1 : p->triangle_count); t++) {
		const gi_vec3d *v = p->flat ? p->quad : p->triangles[t];
		const uint32_t count = p->flat ? 4 : 3;
		const double height = own ? 0 : gi_vec3d_dot(p->normals[t], gi_vec3d_sub(x, v[0]));
		const gi_vec3d foot = gi_vec3d_sub(x, gi_vec3d_scale(p->normals[t], height));
		for (uint32_t k = 0; k < count; k++)
			add_edge(b, gi_vec3d_sub(v[k], foot), gi_vec3d_sub(v[(k + 1) % count], foot), p->normals[t],
				 height * height, sum);
	}
	for (int c = 0; c < 3; c++)
		out[c] += weight * fmax(sum[c], 0);
}

static double squared_distance(gi_vec3d a, gi_vec3d b)
{
	const gi_vec3d d = gi_vec3d_sub(a, b);
	return gi_vec3d_dot(d, d);
}

static void add_point(const builder *b, gi_vec3d x, gi_vec3d y, double weight, double out[3])
{
	const double squared = squared_distance(x, y);
	for (int c = 0; c < 3; c++)
		out[c] += weight * look_up(&b->curves[c], squared, 0);
}

/* Mean over a leaf of what its points see of another, where that changes within a small part of it: points crowd at the
 * edges, as t2 (3 - 2 t) of Gauss and Legendre's. */
static void integrate_narrow(const builder *b, const patch *to, const patch *from, double out[3])
{
	static const double AT[GRADED] = {0.0137928, 0.2549876, 0.7450124, 0.9862072};
	static const double SHARE[GRADED] = {0.0674265, 0.4325735, 0.4325735, 0.0674265};
	const gi_vec3d *q = to->quad, along = gi_vec3d_sub(q[1], q[0]), across = gi_vec3d_sub(q[2], q[3]);
	double sum[3] = {0}, whole = 0;
	for (int k = 0; k < GRADED * GRADED; k++) {
		const double s = AT[k % GRADED], t = AT[k / GRADED];
		const gi_vec3d low = gi_vec3d_add(q[0], gi_vec3d_scale(along, s));
		const gi_vec3d high = gi_vec3d_add(q[3], gi_vec3d_scale(across, s)), up = gi_vec3d_sub(high, low);
		const gi_vec3d sideways = gi_vec3d_add(gi_vec3d_scale(along, 1 - t), gi_vec3d_scale(across, t));
		const double area =
		    SHARE[k % GRADED] * SHARE[k / GRADED] * gi_vec3d_length(gi_vec3d_cross(sideways, up));
		add_over_patch(b, gi_vec3d_add(low, gi_vec3d_scale(up, t)), from, from == to, area, sum);
		whole += area;
	}
	for (int c = 0; c < 3; c++)
		out[c] += sum[c] / whole;
}

/* Does one point a side do, or of what lies within `whole` one for each piece of radius `other`? The mean of R_d over
 * a square of half diagonal r is off from its centre's by r2 / 12 times the Laplacian, about R_d times its steepness
 * squared. */
static bool one_point_does(const builder *b, double distance, double radius, double whole, double other, double area)
{
	const double nearest = fmax(distance - radius - whole, 0);
	const double at = distance > 1.5 * (radius + whole) ? distance : nearest;
	for (int c = 0; c < 3; c++) {
		const curve *v = &b->curves[c];
		const double bend = gi_dipole_steepness(&v->dipole, at);
		const double off = bend * bend * (radius * radius + other * other) / 12;
		if (area * look_up(v, nearest * nearest, 0) > LEAST * v->albedo &&
		    (off > TOLERANCE || off * area * look_up(v, at * at, 0) > TOLERANCE_OF_ALL * v->albedo))
			return false;
	}
	return true;
}

static bool is_smooth(const builder *b, double distance, double size)
{
	double most = 0;
	for (int c = 0; c < 3; c++)
		most = fmax(most, size * gi_dipole_steepness(&b->curves[c].dipole, fmax(distance - size, 0)));
	return most < SMOOTH;
}

static void integrate_leaf(const builder *b, const patch *to, const patch *from, double out[3])
{
	const double distance = sqrt(squared_distance(to->centre, from->centre));
	if (one_point_does(b, distance, to->radius, from->radius, from->radius, from->area))
		add_point(b, to->centre, from->centre, from->area, out);
	else if (!is_smooth(b, distance, to->radius + from->radius))
		integrate_narrow(b, to, from, out);
	else
		for (uint32_t k = 0; k < 9 * to->triangle_count * from->triangle_count; k++) {
			const uint32_t x = k % (3 * to->triangle_count), y = k / (3 * to->triangle_count);
			add_point(b, to->points[x], from->points[y], to->weights[x] / to->area * from->weights[y], out);
		}
}

/* ---- the cut ---- */

static bool add_share(builder *b, uint32_t node, const double weight[3])
{
	if (b->share_count == b->share_room) {
		const size_t room = 2 * b->share_room + 1024;
		share *more = gi_realloc(b->shares, sizeof *more * room);
		if (!more)
			return false;
		b->shares = more;
		b->share_room = room;
	}
	b->shares[b->share_count++] = (share){node, {weight[0], weight[1], weight[2]}};
	return true;
}

static bool cut_row(builder *b, uint32_t leaf)
{
	const gi_hierarchy *h = b->h;
	const patch *to = &b->patches[leaf];
	b->first[leaf] = (uint32_t)b->share_count;
	for (uint32_t n = 0; n < h->node_count;) {
		const gi_uvec4 range = h->topology[n].range;
		const gi_vec4 sphere = h->geometry[n].sphere;
		const double area = h->geometry[n].moment.w;
		double weight[3] = {0};
		if (range.z == 1) {
			integrate_leaf(b, to, &b->patches[range.y], weight);
		} else {
			const gi_vec3d centre = b->centroids[n], off = gi_vec3d_sub(centre, gi_vec3d_from(sphere));
			const double distance = sqrt(squared_distance(to->centre, centre));
			const double radius = sphere.w + gi_vec3d_length(off);
			if (!one_point_does(b, distance, to->radius, radius, 0.5 * radius, area)) {
				n++;
				continue;
			}
			for (uint32_t child = n + 1; child < range.x; child = h->topology[child].range.x)
				add_point(b, to->centre, b->centroids[child], h->geometry[child].moment.w, weight);
		}
		if (weight[0] + weight[1] + weight[2] > 0 && !add_share(b, n, weight))
			return false;
		n = range.x;
	}
	return true;
}

/* ---- no more than the albedo ---- */

static double sum_of_row(const builder *b, uint32_t leaf, int c)
{
	double sum = 0;
	for (uint32_t k = b->first[leaf]; k < b->first[leaf + 1]; k++)
		sum += b->shares[k].weight[c];
	return sum;
}

/* Of what enters at a node, how much leaves: of links to it, then of those to what holds it, too. */
static void sum_columns(builder *b)
{
	const gi_hierarchy *h = b->h;
	for (uint32_t leaf = 0; leaf < h->leaf_count; leaf++)
		for (uint32_t k = b->first[leaf]; k < b->first[leaf + 1]; k++)
			for (int c = 0; c < 3; c++)
				b->columns[b->shares[k].node][c] += b->patches[leaf].area * b->shares[k].weight[c] /
								    h->geometry[b->shares[k].node].moment.w;
	for (uint32_t n = 0; n < h->node_count; n++)
		for (uint32_t child = n + 1; child < h->topology[n].range.x; child = h->topology[child].range.x)
			for (int c = 0; c < 3; c++)
				b->columns[child][c] += b->columns[n][c];
}

/* A link keeps the lesser share of its two ends: then neither rows nor columns are above the albedo. */
static void scale_down(builder *b)
{
	const gi_hierarchy *h = b->h;
	sum_columns(b);
	for (uint32_t n = h->node_count; n-- > 0;) {
		const gi_uvec4 range = h->topology[n].range;
		for (int c = 0; c < 3; c++) {
			double kept = 1;
			if (range.x == n + 1) {
				const double most = fmax(sum_of_row(b, range.y, c), b->columns[n][c]);
				kept = most > b->curves[c].albedo * ROUNDED ? b->curves[c].albedo * ROUNDED / most : 1;
			}
			for (uint32_t child = n + 1; child < range.x; child = h->topology[child].range.x)
				kept = fmin(kept, b->kept[child][c]);
			b->kept[n][c] = kept;
		}
	}
	for (uint32_t leaf = 0; leaf < h->leaf_count; leaf++)
		for (uint32_t k = b->first[leaf]; k < b->first[leaf + 1]; k++)
			for (int c = 0; c < 3; c++)
				b->shares[k].weight[c] *=
				    fmin(b->kept[h->leaf_node[leaf]][c], b->kept[b->shares[k].node][c]);
}

/* ---- values ---- */

/* Calls back with each part of a large cluster: its largest nodes that are small, or leaves. */
static uint32_t next_part(const gi_hierarchy *h, uint32_t n)
{
	while (h->topology[n].range.z > GI_LARGE_CLUSTER)
		n++;
	return n;
}

/* Wanted are the nodes that links lead to, and the parts of large ones. */
static void number_values(builder *b, gi_subsurface_links *out)
{
	const gi_hierarchy *h = b->h;
	memset(b->value, 0xFF, sizeof *b->value * h->node_count);
	for (size_t k = 0; k < b->share_count; k++)
		b->value[b->shares[k].node] = 0;
	for (uint32_t n = 0; n < h->node_count; n++) {
		const gi_uvec4 range = h->topology[n].range;
		if (b->value[n] == GI_NONE || range.z <= GI_LARGE_CLUSTER)
			continue;
		for (uint32_t part = next_part(h, n); part < range.x; part = h->topology[part].range.x) {
			part = next_part(h, part);
			b->value[part] = 0;
		}
	}
	uint32_t small = h->leaf_count, large;
	for (uint32_t n = 0; n < h->node_count; n++) {
		const gi_uvec4 range = h->topology[n].range;
		if (range.z == 1)
			b->value[n] = range.y;
		else if (b->value[n] != GI_NONE && range.z <= GI_LARGE_CLUSTER)
			b->value[n] = small++;
	}
	large = small;
	for (uint32_t n = 0; n < h->node_count; n++)
		if (b->value[n] != GI_NONE && h->topology[n].range.z > GI_LARGE_CLUSTER)
			b->value[n] = large++;
	out->leaf_count = h->leaf_count;
	out->small_count = small - h->leaf_count;
	out->large_count = large - small;
}

/* Of a cluster: its leaves or parts, by area. Counts them where `links` is NULL. */
static uint32_t fill_cluster(const builder *b, uint32_t n, gi_uvec4 *links)
{
	const gi_hierarchy *h = b->h;
	const gi_uvec4 range = h->topology[n].range;
	const bool large = range.z > GI_LARGE_CLUSTER;
	uint32_t count = 0;
	double area = 0;
	for (uint32_t leaf = range.y; leaf < range.y + range.z; leaf++)
		area += b->patches[leaf].area;
	for (uint32_t part = n + 1; part < range.x; part = h->topology[part].range.x) {
		while (h->topology[part].range.z > (large ? GI_LARGE_CLUSTER : 1))
			part++;
		const gi_uvec4 of = h->topology[part].range;
		double mine = 0;
		for (uint32_t leaf = of.y; leaf < of.y + of.z; leaf++)
			mine += b->patches[leaf].area;
		const uint32_t weight = gi_bits_from_float((float)(mine / area));
		if (links)
			links[count] = (gi_uvec4){b->value[part], weight, weight, weight};
		count++;
	}
	return count;
}

static void fill_links(const builder *b, gi_subsurface_links *out)
{
	const gi_hierarchy *h = b->h;
	for (uint32_t leaf = 0; leaf < h->leaf_count; leaf++) {
		out->first[leaf] = b->first[leaf];
		for (uint32_t k = b->first[leaf]; k < b->first[leaf + 1]; k++) {
			const share *s = &b->shares[k];
			out->links[k] = (gi_uvec4){b->value[s->node], gi_bits_from_float((float)s->weight[0]),
						   gi_bits_from_float((float)s->weight[1]),
						   gi_bits_from_float((float)s->weight[2])};
		}
	}
	uint32_t row = h->leaf_count, at = b->first[h->leaf_count];
	for (int large = 0; large < 2; large++)
		for (uint32_t n = 0; n < h->node_count; n++) {
			const uint32_t leaves = h->topology[n].range.z;
			if (leaves == 1 || b->value[n] == GI_NONE || (leaves > GI_LARGE_CLUSTER) != (large == 1))
				continue;
			out->first[row++] = at;
			at += fill_cluster(b, n, out->links + at);
		}
	out->first[row] = at;
}

static size_t count_links(const builder *b)
{
	size_t count = b->share_count;
	for (uint32_t n = 0; n < b->h->node_count; n++)
		if (b->h->topology[n].range.z > 1 && b->value[n] != GI_NONE)
			count += fill_cluster(b, n, NULL);
	return count;
}

/* ---- building ---- */

static bool begin(builder *b, const gi_hierarchy *h, const gi_subsurface *medium)
{
	*b = (builder){.h = h};
	const double farthest = 4 * (double)h->geometry[0].sphere.w;
	for (int c = 0; c < 3; c++)
		if (!make_curve(&b->curves[c], medium, c, farthest))
			return false;
	b->patches = gi_malloc(sizeof *b->patches * h->leaf_count);
	b->centroids = gi_malloc(sizeof *b->centroids * h->node_count);
	b->first = gi_malloc(sizeof *b->first * ((size_t)h->leaf_count + 1));
	b->kept = gi_malloc(sizeof *b->kept * h->node_count);
	b->columns = gi_calloc(h->node_count, sizeof *b->columns);
	b->value = gi_malloc(sizeof *b->value * h->node_count);
	return b->patches && b->centroids && b->first && b->kept && b->columns && b->value;
}

static bool build(builder *b, gi_subsurface_links *out)
{
	const gi_hierarchy *h = b->h;
	for (uint32_t leaf = 0; leaf < h->leaf_count; leaf++)
		b->patches[leaf] = patch_of(h, leaf);
	find_centroids(b);
	for (uint32_t leaf = 0; leaf < h->leaf_count; leaf++)
		if (!cut_row(b, leaf))
			return false;
	b->first[h->leaf_count] = (uint32_t)b->share_count;
	scale_down(b);
	number_values(b, out);
	const size_t rows = (size_t)out->leaf_count + out->small_count + out->large_count;
	out->first = gi_malloc(sizeof *out->first * (rows + 1));
	out->links = gi_malloc(sizeof *out->links * (count_links(b) + 1));
	if (!out->first || !out->links)
		return false;
	fill_links(b, out);
	for (int c = 0; c < 3; c++)
		out->albedo[c] = (float)b->curves[c].albedo;
	return true;
}

bool gi_subsurface_build(const gi_hierarchy *h, const gi_subsurface *medium, gi_subsurface_links *out)
{
	builder b;
	*out = (gi_subsurface_links){0};
	const bool ok = begin(&b, h, medium) && build(&b, out);
	for (int c = 0; c < 3; c++)
		gi_free(b.curves[c].values);
	gi_free(b.patches);
	gi_free(b.centroids);
	gi_free(b.first);
	gi_free(b.shares);
	gi_free(b.kept);
	gi_free(b.columns);
	gi_free(b.value);
	if (!ok)
		gi_subsurface_free(out);
	return ok;
}

void gi_subsurface_free(gi_subsurface_links *s)
{
	gi_free(s->first);
	gi_free(s->links);
	*s = (gi_subsurface_links){0};
}
