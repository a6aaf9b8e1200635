/* Poses of nodes over time: key frames, hierarchy, and matrices back to scale, rotation and translation.
 *
 * glTF 2.0 specification, appendix C (animation sampler interpolation modes). All in double: float keys go through
 * chains of parents.
 */
#include "mesh_clean.h"
#include "import_pose.h"
#include "import_build.h"

#include <math.h>
#include <string.h>

import_node import_node_default(void)
{
	return (import_node){.parent = -1,
			     .rotation = {0, 0, 0, 1},
			     .scale = {1, 1, 1},
			     .channels = {-1, -1, -1},
			     .weights_channel = -1};
}

static void normalize4(double q[4])
{
	double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
	for (int c = 0; c < 4; c++)
		q[c] /= length; /* a zero quaternion becomes NaN, and that pose is found singular */
}

/* Last key at or before time_s; the caller has dealt with times before the first and after the last. */
static uint32_t key_before(const import_channel *channel, double time_s)
{
	uint32_t low = 0, high = channel->key_count - 1;
	while (high - low > 1) {
		uint32_t middle = low + (high - low) / 2;
		if (channel->times[middle] <= time_s)
			low = middle;
		else
			high = middle;
	}
	return low;
}

/* part: 0 in-tangent, 1 value, 2 out-tangent; other interpolations have values only. */
static const float *key_values(const import_channel *channel, uint32_t key, uint32_t part)
{
	if (channel->interpolation == IMPORT_CUBIC)
		return channel->values + (3 * (size_t)key + part) * channel->components;
	return channel->values + (size_t)key * channel->components;
}

/* Spherical interpolation the short way round. */
static void slerp(const float a[4], const float b[4], double t, double out[4])
{
	double cosine = 0;
	for (int c = 0; c < 4; c++)
		cosine += (double)a[c] * b[c];
	double sign = cosine < 0 ? -1 : 1, angle = acos(fmin(fabs(cosine), 1));
	double from = 1 - t, to = t;
	if (angle > 1e-6) { /* below, the formula divides two roundings */
		from = sin((1 - t) * angle) / sin(angle);
		to = sin(t * angle) / sin(angle);
	}
	for (int c = 0; c < 4; c++)
		out[c] = from * a[c] + to * sign * b[c];
}

/* p(t) = (2t3 - 3t2 + 1) p0 + (t3 - 2t2 + t) m0 + (-2t3 + 3t2) p1 + (t3 - t2) m1, tangents times the key distance */
static void hermite(const import_channel *channel, uint32_t key, double t, double step, double *out)
{
	const float *p0 = key_values(channel, key, 1), *m0 = key_values(channel, key, 2);
	const float *p1 = key_values(channel, key + 1, 1), *m1 = key_values(channel, key + 1, 0);
	double t2 = t * t, t3 = t2 * t;
	for (uint32_t c = 0; c < channel->components; c++)
		out[c] = (2 * t3 - 3 * t2 + 1) * p0[c] + (t3 - 2 * t2 + t) * step * m0[c] + (3 * t2 - 2 * t3) * p1[c] +
			 (t3 - t2) * step * m1[c];
}

static void between_keys(const import_channel *channel, uint32_t key, double time_s, double *out)
{
	const float *a = key_values(channel, key, 1), *b = key_values(channel, key + 1, 1);
	double step = (double)channel->times[key + 1] - channel->times[key];
	double t = (time_s - channel->times[key]) / step;
	if (channel->interpolation == IMPORT_CUBIC) {
		hermite(channel, key, t, step, out);
	} else if (channel->interpolation == IMPORT_STEP) {
		for (uint32_t c = 0; c < channel->components; c++)
			out[c] = a[c];
	} else if (channel->turns) {
		slerp(a, b, t, out);
	} else {
		for (uint32_t c = 0; c < channel->components; c++)
			out[c] = (1 - t) * a[c] + t * b[c];
	}
}

void import_evaluate(const import_channel *channel, double time_s, double *out)
{
	uint32_t last = channel->key_count - 1;
	if (time_s > channel->times[0] && time_s < channel->times[last]) {
		between_keys(channel, key_before(channel, time_s), time_s, out);
	} else {
		const float *held = key_values(channel, time_s >= channel->times[last] ? last : 0, 1);
		for (uint32_t c = 0; c < channel->components; c++)
			out[c] = held[c];
	}
	if (channel->turns)
		normalize4(out);
}

/* T R S as a matrix. */
static void compose(const double t[3], const double q[4], const double s[3], double m[16])
{
	double x = q[0], y = q[1], z = q[2], w = q[3];
	const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y + z * w),     2 * (x * z - y * w),
			     2 * (x * y - z * w),     1 - 2 * (x * x + z * z), 2 * (y * z + x * w),
			     2 * (x * z + y * w),     2 * (y * z - x * w),     1 - 2 * (x * x + y * y)};
	for (int column = 0; column < 3; column++) {
		for (int row = 0; row < 3; row++)
			m[4 * column + row] = r[3 * column + row] * s[column];
		m[4 * column + 3] = 0;
		m[12 + column] = t[column];
	}
	m[15] = 1;
}

static void local_matrix(const engine_scene_graph *graph, const import_node *node, const double *time_s, double m[16])
{
	double values[IMPORT_PROPERTIES][4];
	if (node->has_matrix) {
		memcpy(m, node->matrix, sizeof node->matrix);
		return;
	}
	memcpy(values[IMPORT_TRANSLATION], node->translation, sizeof node->translation);
	memcpy(values[IMPORT_ROTATION], node->rotation, sizeof node->rotation);
	memcpy(values[IMPORT_SCALE], node->scale, sizeof node->scale);
	for (int property = 0; time_s && property < IMPORT_PROPERTIES; property++) {
		if (node->channels[property] >= 0)
			import_evaluate(&graph->channels[node->channels[property]], *time_s, values[property]);
	}
	compose(values[IMPORT_TRANSLATION], values[IMPORT_ROTATION], values[IMPORT_SCALE], m);
}

void import_multiply(const double a[16], const double b[16], double out[16])
{
	double product[16];
	for (int column = 0; column < 4; column++) {
		for (int row = 0; row < 4; row++) {
			double sum = 0;
			for (int k = 0; k < 4; k++)
				sum += a[4 * k + row] * b[4 * column + k];
			product[4 * column + row] = sum;
		}
	}
	memcpy(out, product, sizeof product);
}

void import_mark_moving(engine_scene_graph *graph)
{
	for (uint32_t k = 0; k < graph->order_count; k++) {
		import_node *node = &graph->nodes[graph->order[k]];
		node->moves = node->parent >= 0 && graph->nodes[node->parent].moves;
		for (int property = 0; property < IMPORT_PROPERTIES; property++)
			node->moves = node->moves || node->channels[property] >= 0;
	}
}

void import_pose_graph(engine_scene_graph *graph, const double *time_s)
{
	bool same = graph->posed && graph->at_rest == !time_s && (!time_s || graph->time_s == *time_s);
	for (uint32_t k = 0; !same && k < graph->order_count; k++) {
		const import_node *node = &graph->nodes[graph->order[k]];
		double *world = graph->world + 16 * (size_t)graph->order[k];
		if (graph->posed && !node->moves)
			continue;
		local_matrix(graph, node, time_s, world);
		if (node->parent >= 0)
			import_multiply(graph->world + 16 * (size_t)node->parent, world, world);
	}
	graph->posed = true;
	graph->at_rest = !time_s;
	graph->time_s = time_s ? *time_s : 0;
}

static double dot3(const double *a, const double *b)
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double determinant(const double m[16])
{
	const double *a = m, *b = m + 4, *c = m + 8;
	return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
	       a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* Shepperd's method: from the largest of the four, so that nothing small is divided by. Columns have unit length. */
static void quaternion_of(const double m[16], double q[4])
{
	double trace = m[0] + m[5] + m[10];
	int i = m[5] > m[0] ? 1 : 0;
	i = m[10] > m[5 * i] ? 2 : i;
	if (trace >= m[5 * i]) {
		q[3] = 1 + trace;
		q[0] = m[6] - m[9];
		q[1] = m[8] - m[2];
		q[2] = m[1] - m[4];
	} else {
		int j = (i + 1) % 3, k = (i + 2) % 3;
		q[i] = 1 + m[5 * i] - m[5 * j] - m[5 * k];
		q[j] = m[4 * i + j] + m[4 * j + i];
		q[k] = m[4 * i + k] + m[4 * k + i];
		q[3] = m[4 * j + k] - m[4 * k + j];
	}
	normalize4(q);
}

/* Divides the columns by their lengths. 1e-9 of the largest: thinner is a plane in float. */
static import_pose_result take_scale(double m[16], double scale[3])
{
	for (int c = 0; c < 3; c++)
		scale[c] = sqrt(dot3(m + 4 * c, m + 4 * c));
	double largest = fmax(scale[0], fmax(scale[1], scale[2]));
	for (int c = 0; c < 3; c++) {
		if (fabs(m[12 + c]) > IMPORT_FARTHEST || scale[c] > ENGINE_MESH_FARTHEST)
			return IMPORT_POSE_FAR;
		if (!isfinite(m[12 + c]) || !(scale[c] > 1e-9 * largest) || scale[c] < 1e-30)
			return IMPORT_POSE_SINGULAR;
		for (int row = 0; row < 3; row++)
			m[4 * c + row] /= scale[c];
	}
	return IMPORT_POSE_OK;
}

/* 1e-4: about the rounding of a chain of float matrices; real shear is far more. */
static bool is_sheared(const double m[16])
{
	return fabs(dot3(m, m + 4)) > 1e-4 || fabs(dot3(m + 4, m + 8)) > 1e-4 || fabs(dot3(m, m + 8)) > 1e-4;
}

/* The cofactors: the inverse transpose times the determinant. */
static void cofactors(const double m[9], double out[9])
{
	for (int i = 0; i < 3; i++) {
		for (int j = 0; j < 3; j++) {
			int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
			out[3 * i + j] = m[3 * a + c] * m[3 * b + d] - m[3 * a + d] * m[3 * b + c];
		}
	}
}

/* M = Q P, Q a rotation, P symmetric. Newton's iteration Q <- (Q + Q^-T) / 2 (Higham 1986) converges quadratically from
 * any regular matrix, first by halving: 80 steps are enough for axes of 1 : 1e-9. Row-major; det M > 0.
 */
static void polar(const double m[9], double q[9], double p[9])
{
	double largest = 0;
	for (int k = 0; k < 9; k++)
		largest = fmax(largest, fabs(m[k]));
	for (int k = 0; k < 9; k++)
		q[k] = m[k] / largest;
	for (int step = 0; step < 80; step++) {
		double c[9], change = 0;
		cofactors(q, c);
		double volume = q[0] * c[0] + q[1] * c[1] + q[2] * c[2];
		for (int k = 0; k < 9; k++) {
			double next = 0.5 * (q[k] + c[k] / volume);
			change = fmax(change, fabs(next - q[k]));
			q[k] = next;
		}
		if (change < 1e-15)
			break;
	}
	for (int i = 0; i < 3; i++) {
		for (int j = 0; j < 3; j++)
			p[3 * i + j] = q[i] * m[j] + q[3 + i] * m[3 + j] + q[6 + i] * m[6 + j];
	}
}

/* Replaces the upper 3 x 3 of m (column-major) by its rotation and gives what is left of it. */
static void take_stretch(double m[16], double stretch[9])
{
	double rows[9], rotation[9];
	for (int row = 0; row < 3; row++) {
		for (int column = 0; column < 3; column++)
			rows[3 * row + column] = m[4 * column + row];
	}
	polar(rows, rotation, stretch);
	for (int row = 0; row < 3; row++) {
		for (int column = 0; column < 3; column++)
			m[4 * column + row] = rotation[3 * row + column];
	}
}

/* The object's matrix with the world position of its mesh's zero, as the scene's coordinates have it. */
static void object_matrix(const engine_scene_graph *graph, const engine_scene_object *object, double m[16])
{
	memcpy(m, graph->world + 16 * (size_t)object->node, 16 * sizeof *m);
	for (int row = 0; row < 3; row++) {
		m[row] = object->mirrored ? -m[row] : m[row];
		m[12 + row] += m[row] * object->offset[0] + m[4 + row] * object->offset[1] +
			       m[8 + row] * object->offset[2] - graph->origin[row];
	}
}

static void write_pose(const double m[16], const double scale[3], engine_pose *pose)
{
	double rotation[4];
	quaternion_of(m, rotation);
	for (int c = 0; c < 4; c++)
		pose->rotation[c] = (float)rotation[c];
	for (int c = 0; c < 3; c++) {
		pose->translation[c] = (float)m[12 + c];
		pose->scale[c] = (float)scale[c];
	}
}

import_pose_result import_object_pose(const engine_scene_graph *graph, const engine_scene_object *object,
				      engine_pose *pose, double stretch[9])
{
	double m[16], full[16], scale[3], unused[9];
	object_matrix(graph, object, full);
	memcpy(m, full, sizeof m);
	import_pose_result result = take_scale(m, scale);
	if (result != IMPORT_POSE_OK)
		return result;
	double volume = determinant(m);
	if (!(fabs(volume) > 1e-6))
		return IMPORT_POSE_SINGULAR;
	if (!object->baked && is_sheared(m))
		return IMPORT_POSE_SHEARED;
	if (volume < 0)
		return IMPORT_POSE_MIRRORED;
	if (object->baked) {
		take_stretch(full, stretch ? stretch : unused);
		write_pose(full, (const double[3]){1, 1, 1}, pose);
	} else {
		write_pose(m, scale, pose);
	}
	return IMPORT_POSE_OK;
}

void import_transform_point(const engine_pose *pose, const float point[3], float out[3])
{
	const float *q = pose->rotation, *s = pose->scale;
	double t[3] = {pose->translation[0], pose->translation[1], pose->translation[2]};
	const double p[3] = {point[0], point[1], point[2]}; /* out may be point */
	double m[16];
	compose(t, (const double[4]){q[0], q[1], q[2], q[3]}, (const double[3]){s[0], s[1], s[2]}, m);
	for (int row = 0; row < 3; row++)
		out[row] = (float)(m[row] * p[0] + m[4 + row] * p[1] + m[8 + row] * p[2] + m[12 + row]);
}

/* A matrix that shears only at this time: the rotation of it is the motion of a body that keeps its shape. */
static import_pose_result pose_of_body(const engine_scene *scene, const engine_scene_object *object, engine_pose *pose)
{
	import_pose_result result = import_object_pose(scene->graph, object, pose, NULL);
	if (result != IMPORT_POSE_SHEARED)
		return result;
	engine_scene_object body = *object;
	body.baked = true;
	result = import_object_pose(scene->graph, &body, pose, NULL);
	if (result == IMPORT_POSE_OK)
		memcpy(pose->scale, object->rest.scale, sizeof pose->scale);
	return result;
}

bool engine_scene_pose(const engine_scene *scene, uint32_t object, double time_s, engine_pose *pose)
{
	engine_pose found;
	if (object >= scene->object_count || isnan(time_s))
		return false;
	import_pose_graph(scene->graph, &time_s);
	if (pose_of_body(scene, &scene->objects[object], &found) != IMPORT_POSE_OK)
		return false;
	*pose = found;
	return true;
}

/* glTF cameras look along -z with y up. */
bool engine_scene_camera_at(const engine_scene *scene, double time_s, engine_scene_camera *camera)
{
	if (!scene->has_camera || isnan(time_s))
		return false;
	import_pose_graph(scene->graph, &time_s);
	const double *m = scene->graph->world + 16 * (size_t)scene->camera_node;
	double up_length = sqrt(dot3(m + 4, m + 4)), back_length = sqrt(dot3(m + 8, m + 8));
	if (!(up_length > 1e-30 && up_length < 1e30 && back_length > 1e-30 && back_length < 1e30))
		return false;
	for (int c = 0; c < 3; c++) {
		double eye = m[12 + c] - scene->origin[c];
		camera->eye[c] = (float)eye;
		camera->target[c] = (float)(eye - m[8 + c] / back_length);
		camera->up[c] = (float)(m[4 + c] / up_length);
	}
	camera->vertical_fov = scene->camera_fov;
	return true;
}

/* glTF lights shine along -z. A scale is none of theirs. */
bool engine_scene_light_at(const engine_scene *scene, uint32_t light, double time_s, float position[3],
			   float direction[3])
{
	if (light >= scene->light_count || isnan(time_s))
		return false;
	import_pose_graph(scene->graph, &time_s);
	const double *m = scene->graph->world + 16 * (size_t)scene->lights[light].node;
	const double length = sqrt(dot3(m + 8, m + 8));
	double place[3];
	bool sound = length > 1e-30 && length < 1e30;
	for (int c = 0; c < 3; c++) {
		place[c] = m[12 + c] - scene->origin[c];
		sound = sound && fabs(place[c]) <= IMPORT_FARTHEST;
	}
	for (int c = 0; c < 3 && sound; c++) {
		position[c] = (float)place[c];
		direction[c] = (float)(-m[8 + c] / length);
	}
	return sound;
}
