#include "import_shape.h"
#include "import_build.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- life -------------------------------------------------------------------------------------------------------- */

void engine_followers_free(engine_followers *f)
{
	free(f->source);
	free(f->bind);
	*f = (engine_followers){0};
}

/* ---- the file's vertices ----------------------------------------------------------------------------------------- */

/* Joints as the graph is posed. */
static void place_joints(const engine_scene_graph *graph, import_shape *shape)
{
	for (uint32_t j = 0; j < shape->joint_count; j++)
		import_multiply(graph->world + 16 * (size_t)shape->nodes[j], shape->inverse[j], shape->matrices[j]);
}

/* The mean of a vertex's joints by weight; false where none has any: it stays. */
static bool blend(const import_shape *shape, uint32_t vertex, double m[16])
{
	double sum = 0;
	memset(m, 0, 16 * sizeof *m);
	for (int k = 0; shape->joint_count && k < IMPORT_INFLUENCES; k++) {
		size_t at = (size_t)IMPORT_INFLUENCES * vertex + (size_t)k;
		double weight = (double)shape->weights[at];
		if (!(weight > 0))
			continue;
		for (int i = 0; i < 16; i++)
			m[i] += weight * shape->matrices[shape->joints[at]][i];
		sum += weight;
	}
	for (int i = 0; sum > 0 && i < 16; i++)
		m[i] /= sum;
	return sum > 0;
}

static void transform(const double m[16], const double p[3], double out[3])
{
	for (int row = 0; row < 3; row++)
		out[row] = m[row] * p[0] + m[4 + row] * p[1] + m[8 + row] * p[2] + m[12 + row];
}

/* Where a point is that m takes to p, by Cramer's rule; false: m is singular. */
static bool transform_back(const double m[16], const double p[3], double out[3])
{
	const double *a = m, *b = m + 4, *c = m + 8, q[3] = {p[0] - m[12], p[1] - m[13], p[2] - m[14]};
	const double bc[3] = {b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]};
	const double ca[3] = {c[1] * a[2] - c[2] * a[1], c[2] * a[0] - c[0] * a[2], c[0] * a[1] - c[1] * a[0]};
	const double ab[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
	double volume = a[0] * bc[0] + a[1] * bc[1] + a[2] * bc[2];
	if (!(fabs(volume) > 1e-30))
		return false;
	out[0] = (bc[0] * q[0] + bc[1] * q[1] + bc[2] * q[2]) / volume;
	out[1] = (ca[0] * q[0] + ca[1] * q[1] + ca[2] * q[2]) / volume;
	out[2] = (ab[0] * q[0] + ab[1] * q[1] + ab[2] * q[2]) / volume;
	return isfinite(out[0]) && isfinite(out[1]) && isfinite(out[2]);
}

/* How far the morph targets move a vertex. */
static void morph(const import_shape *shape, uint32_t vertex, const double *weights, double out[3])
{
	const float *delta = shape->deltas + 3 * (size_t)shape->target_count * vertex;
	out[0] = out[1] = out[2] = 0;
	for (uint32_t t = 0; t < shape->target_count; t++, delta += 3)
		for (int c = 0; c < 3; c++)
			out[c] += weights[t] * (double)delta[c];
}

/* ---- object space ------------------------------------------------------------------------------------------------ */

/* What became of the mesh as it was read: moved, mirrored, stretched (import_object.c, import_place.c). */
static void to_object(const engine_scene_object *object, const double read[3], float out[3])
{
	const double *s = object->stretch;
	double p[3];
	for (int c = 0; c < 3; c++) {
		bool turned = object->mirrored && c == 0;
		p[c] = turned ? -read[c] - object->offset[c] : read[c] - object->offset[c];
	}
	for (int row = 0; row < 3; row++)
		out[row] =
		    (float)(object->baked ? s[3 * row] * p[0] + s[3 * row + 1] * p[1] + s[3 * row + 2] * p[2] : p[row]);
}

static bool from_object(const engine_scene_object *object, const float point[3], double out[3])
{
	const double *s = object->stretch;
	const double m[16] = {s[0], s[3], s[6], 0, s[1], s[4], s[7], 0, s[2], s[5], s[8], 0, 0, 0, 0, 1};
	double p[3] = {(double)point[0], (double)point[1], (double)point[2]};
	if (object->baked && !transform_back(m, p, p))
		return false;
	for (int c = 0; c < 3; c++) {
		double read = p[c] + object->offset[c];
		out[c] = object->mirrored && c == 0 ? -read : read;
	}
	return true;
}

/* ---- following --------------------------------------------------------------------------------------------------- */

/* The file's vertices along the axis that they reach farthest on. */
typedef struct locator {
	const import_shape *shape;
	uint32_t *order;
	int axis;
} locator;

typedef struct placed {
	float at;
	uint32_t vertex;
} placed;

static int by_place(const void *a, const void *b)
{
	const placed *p = a, *q = b;
	int order = (p->at > q->at) - (p->at < q->at);
	return order ? order : (p->vertex > q->vertex) - (p->vertex < q->vertex);
}

static bool make_locator(const import_shape *shape, locator *out)
{
	double widest = -1;
	*out = (locator){.shape = shape, .order = malloc((shape->vertex_count + 1) * sizeof *out->order)};
	placed *list = malloc((shape->vertex_count + 1) * sizeof *list);
	for (int axis = 0; axis < 3; axis++) {
		float lower = INFINITY, upper = -INFINITY;
		for (uint32_t v = 0; v < shape->vertex_count; v++) {
			lower = fminf(lower, shape->rest[3 * (size_t)v + (size_t)axis]);
			upper = fmaxf(upper, shape->rest[3 * (size_t)v + (size_t)axis]);
		}
		if ((double)upper - (double)lower > widest) {
			widest = (double)upper - (double)lower;
			out->axis = axis;
		}
	}
	bool enough = list && out->order;
	for (uint32_t v = 0; enough && v < shape->vertex_count; v++)
		list[v] = (placed){shape->rest[3 * (size_t)v + (size_t)out->axis], v};
	if (enough)
		qsort(list, shape->vertex_count, sizeof *list, by_place);
	for (uint32_t v = 0; enough && v < shape->vertex_count; v++)
		out->order[v] = list[v].vertex;
	free(list);
	if (!enough)
		free(out->order);
	return enough;
}

/* Tries the vertex at a place of the order. False where it and all beyond it are farther than the nearest so far. */
static bool try_vertex(const locator *l, int64_t place, const double p[3], double *least, uint32_t *nearest)
{
	if (place < 0 || place >= l->shape->vertex_count)
		return false;
	uint32_t vertex = l->order[place];
	const float *at = l->shape->rest + 3 * (size_t)vertex;
	double distance = 0, along = (double)at[l->axis] - p[l->axis];
	if (along * along > *least)
		return false;
	for (int c = 0; c < 3; c++)
		distance += ((double)at[c] - p[c]) * ((double)at[c] - p[c]);
	if (distance < *least || (distance == *least && vertex < *nearest)) {
		*least = distance;
		*nearest = vertex;
	}
	return true;
}

static uint32_t find_nearest(const locator *l, const double p[3])
{
	uint32_t low = 0, high = l->shape->vertex_count, nearest = 0;
	double least = INFINITY;
	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		if ((double)l->shape->rest[3 * (size_t)l->order[middle] + (size_t)l->axis] < p[l->axis])
			low = middle + 1;
		else
			high = middle;
	}
	bool up = true, down = true;
	for (int64_t step = 0; up || down; step++) {
		up = up && try_vertex(l, (int64_t)low + step, p, &least, &nearest);
		down = down && try_vertex(l, (int64_t)low - 1 - step, p, &least, &nearest);
	}
	return nearest;
}

/* Joints are at rest. */
static void bind_point(const import_shape *shape, const double read[3], uint32_t source, double bind[3])
{
	double m[16], moved[3];
	morph(shape, source, shape->rest_weights, moved);
	if (!blend(shape, source, m)) {
		for (int c = 0; c < 3; c++)
			bind[c] = read[c] - moved[c];
	} else if (transform_back(m, read, bind)) {
		for (int c = 0; c < 3; c++)
			bind[c] -= moved[c];
	} else { /* all that its joints take to one place is the vertex itself */
		for (int c = 0; c < 3; c++)
			bind[c] = (double)shape->bind[3 * (size_t)source + (size_t)c];
	}
}

bool engine_scene_follow(const engine_scene *scene, uint32_t number, const float *points, uint32_t count,
			 engine_followers *out)
{
	const engine_scene_object *object = &scene->objects[number];
	import_shape *shape = object->shape;
	locator l;
	*out = (engine_followers){.count = count,
				  .source = malloc(((size_t)count + 1) * sizeof *out->source),
				  .bind = malloc(((size_t)count + 1) * sizeof *out->bind)};
	if (!out->source || !out->bind || !make_locator(shape, &l)) {
		engine_followers_free(out);
		return false;
	}
	import_pose_graph(scene->graph, NULL);
	place_joints(scene->graph, shape);
	for (uint32_t k = 0; k < count; k++) {
		double read[3] = {0, 0, 0};
		from_object(object, points + 3 * (size_t)k, read);
		out->source[k] = find_nearest(&l, read);
		bind_point(shape, read, out->source[k], out->bind[k]);
	}
	free(l.order);
	return true;
}

void engine_scene_shape(const engine_scene *scene, uint32_t number, const engine_followers *f, double time_s,
			float *points)
{
	const engine_scene_object *object = &scene->objects[number];
	import_shape *shape = object->shape;
	double weights[IMPORT_MOST_TARGETS];
	memcpy(weights, shape->rest_weights, sizeof weights);
	import_pose_graph(scene->graph, &time_s);
	place_joints(scene->graph, shape);
	if (shape->weights_channel >= 0)
		import_evaluate(&scene->graph->channels[shape->weights_channel], time_s, weights);
	for (uint32_t k = 0; k < f->count; k++) {
		double m[16], p[3];
		morph(shape, f->source[k], weights, p);
		for (int c = 0; c < 3; c++)
			p[c] += f->bind[k][c];
		if (blend(shape, f->source[k], m)) {
			const double q[3] = {p[0], p[1], p[2]};
			transform(m, q, p);
		}
		to_object(object, p, points + 3 * (size_t)k);
	}
}
