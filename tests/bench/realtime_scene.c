#include "realtime_scene.h"

#include "ray_tree.h"
#include "samples.h"
#include "trace_light.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct vertex {
	float position[3], normal[3];
	uint32_t object;
} vertex;

/* What is put together before it is uploaded. */
typedef struct assembly {
	const trace_scene *scene;
	realtime_scene *out;
	vertex *vertices; /* three a triangle, in the instance's space */
	uint32_t triangle_count;
	uint32_t first[REALTIME_MOST_INSTANCES + 1]; /* triangles of instances */
	ray_tree trees[REALTIME_MOST_INSTANCES];
	uint32_t node_count; /* of all orders and trees */
} assembly;

/* ---- triangles ---- */

static void add_object(assembly *a, uint32_t number)
{
	const trace_object *o = &a->scene->objects[number];
	mat4 world;
	if (o->moves)
		glm_mat4_identity(world);
	else
		glm_mat4_copy((vec4 *)o->world, world);
	for (uint32_t t = 0; t < o->triangle_count; t++) {
		vertex *to = a->vertices + 3 * (size_t)a->triangle_count++;
		vec3 flat;
		for (int k = 0; k < 3; k++) {
			const size_t corner = 3 * (size_t)o->corners[3 * (size_t)t + (size_t)k];
			glm_mat4_mulv3(world, o->positions + corner, 1, to[k].position);
			if (o->normals)
				glm_mat4_mulv3(world, o->normals + corner, 0, to[k].normal);
			to[k].object = number;
		}
		vec3 u, v;
		glm_vec3_sub(to[1].position, to[0].position, u);
		glm_vec3_sub(to[2].position, to[0].position, v);
		glm_vec3_crossn(u, v, flat);
		for (int k = 0; k < 3 && !o->normals; k++)
			glm_vec3_copy(flat, to[k].normal);
	}
}

static bool add_all(assembly *a)
{
	uint32_t triangles = 0;
	for (uint32_t k = 0; k < a->scene->object_count; k++)
		triangles += a->scene->objects[k].triangle_count;
	a->vertices = malloc(3 * sizeof *a->vertices * (triangles + 1));
	if (!a->vertices)
		return false;
	for (uint32_t k = 0; k < a->scene->object_count; k++)
		if (!a->scene->objects[k].moves)
			add_object(a, k);
	uint32_t instances = 1;
	a->first[1] = a->triangle_count;
	for (uint32_t k = 0; k < a->scene->object_count; k++)
		if (a->scene->objects[k].moves && instances < REALTIME_MOST_INSTANCES) {
			add_object(a, k);
			a->out->mover[instances++] = k;
			a->first[instances] = a->triangle_count;
		}
	a->out->block.counts[0] = instances;
	return a->triangle_count == triangles && a->first[1] > 0;
}

/* ---- trees ---- */

static bool build_tree(assembly *a, uint32_t instance)
{
	const uint32_t first = a->first[instance], count = a->first[instance + 1] - first;
	float *corners = malloc(9 * sizeof *corners * count);
	for (size_t k = 0; corners && k < 3 * (size_t)count; k++)
		memcpy(corners + 3 * k, a->vertices[3 * (size_t)first + k].position, 3 * sizeof *corners);
	const bool ok = corners && ray_tree_build(corners, count, &a->trees[instance]);
	free(corners);
	const uint32_t range[4] = {a->node_count, a->trees[instance].node_count, first, 0};
	memcpy(a->out->block.instances[instance].range, range, sizeof range);
	a->node_count += RAY_TREE_ORDERS * a->trees[instance].node_count;
	return ok;
}

/* ---- uploads ---- */

static void make_texture(realtime_scene *s, int which, GLenum format, const void *data, size_t size)
{
	glCreateBuffers(1, &s->buffers[which]);
	glNamedBufferStorage(s->buffers[which], (GLsizeiptr)size, data, 0);
	glCreateTextures(GL_TEXTURE_BUFFER, 1, &s->textures[which]);
	glTextureBuffer(s->textures[which], format, s->buffers[which]);
}

static bool upload_nodes(assembly *a)
{
	ray_tree_node *nodes = malloc(sizeof *nodes * a->node_count);
	size_t at = 0;
	for (uint32_t k = 0; nodes && k < a->out->block.counts[0]; k++) {
		const size_t count = RAY_TREE_ORDERS * (size_t)a->trees[k].node_count;
		memcpy(nodes + at, a->trees[k].nodes, count * sizeof *nodes);
		at += count;
	}
	if (nodes)
		make_texture(a->out, 0, GL_RGBA32UI, nodes, at * sizeof *nodes);
	free(nodes);
	return nodes != NULL;
}

/* A triangle for rays: corner and two edges, then its normals, four floats each. */
static void write_triangle(const vertex *v, float *triangle, float *normals)
{
	memset(triangle, 0, 12 * sizeof *triangle);
	memset(normals, 0, 12 * sizeof *normals);
	memcpy(triangle, v[0].position, 3 * sizeof *triangle);
	memcpy(triangle + 3, &v[0].object, sizeof v[0].object);
	for (int k = 1; k < 3; k++)
		for (int c = 0; c < 3; c++)
			triangle[4 * k + c] = v[k].position[c] - v[0].position[c];
	for (int k = 0; k < 3; k++)
		memcpy(normals + 4 * k, v[k].normal, 3 * sizeof *normals);
}

/* In the order of the trees' leaves. */
static bool upload_triangles(assembly *a)
{
	const size_t size = 12 * sizeof(float) * a->triangle_count;
	float *triangles = malloc(size), *normals = malloc(size);
	for (uint32_t k = 0; triangles && normals && k < a->out->block.counts[0]; k++)
		for (uint32_t t = 0; t < a->trees[k].triangle_count; t++) {
			const size_t to = 12 * (size_t)(a->first[k] + t);
			write_triangle(a->vertices + 3 * (size_t)(a->first[k] + a->trees[k].triangles[t]),
				       triangles + to, normals + to);
		}
	const bool ok = triangles && normals;
	if (ok) {
		make_texture(a->out, 1, GL_RGBA32UI, triangles, size);
		make_texture(a->out, 2, GL_RGBA32F, normals, size);
	}
	free(triangles);
	free(normals);
	return ok;
}

/* Shared vertices, as the objects have them: the rasteriser shades each once. */
static bool upload_vertices(assembly *a)
{
	realtime_scene *s = a->out;
	uint32_t vertices = 0, indices = 0;
	for (uint32_t k = 0; k < a->scene->object_count; k++)
		vertices += a->scene->objects[k].vertex_count;
	vertex *v = calloc(vertices, sizeof *v);
	uint32_t *index = malloc(3 * sizeof *index * a->triangle_count);
	vertices = 0;
	for (uint32_t instance = 0; v && index && instance < s->block.counts[0]; instance++) {
		s->index_first[instance] = indices;
		for (uint32_t k = 0; k < a->scene->object_count; k++) {
			const trace_object *o = &a->scene->objects[k];
			if (instance ? k != s->mover[instance] : o->moves)
				continue;
			for (size_t t = 0; t < 3 * (size_t)o->triangle_count; t++) {
				const uint32_t at = vertices + o->corners[t];
				index[indices] = at;
				v[at] = a->vertices[indices++];
			}
			vertices += o->vertex_count;
		}
		s->index_first[instance + 1] = indices;
	}
	const bool ok = v && index;
	if (ok) {
		glCreateBuffers(1, &s->vertices);
		glNamedBufferStorage(s->vertices, (GLsizeiptr)(sizeof *v * vertices), v, 0);
		glCreateBuffers(1, &s->indices);
		glNamedBufferStorage(s->indices, (GLsizeiptr)(sizeof *index * indices), index, 0);
	}
	free(v);
	free(index);
	return ok;
}

static void make_vertex_array(realtime_scene *s)
{
	glCreateVertexArrays(1, &s->vertex_array);
	glVertexArrayVertexBuffer(s->vertex_array, 0, s->vertices, 0, sizeof(vertex));
	glVertexArrayElementBuffer(s->vertex_array, s->indices);
	for (GLuint k = 0; k < 3; k++) {
		glEnableVertexArrayAttrib(s->vertex_array, k);
		glVertexArrayAttribBinding(s->vertex_array, k, 0);
	}
	glVertexArrayAttribFormat(s->vertex_array, 0, 3, GL_FLOAT, GL_FALSE, offsetof(vertex, position));
	glVertexArrayAttribFormat(s->vertex_array, 1, 3, GL_FLOAT, GL_FALSE, offsetof(vertex, normal));
	glVertexArrayAttribIFormat(s->vertex_array, 2, 1, GL_UNSIGNED_INT, offsetof(vertex, object));
}

/* ---- materials ---- */

static bool add_lights(realtime_scene *s)
{
	trace_lights lights;
	if (!trace_lights_find(s->scene, &lights) || lights.count > REALTIME_MOST_LIGHTS) {
		trace_lights_free(&lights);
		return false;
	}
	s->block.counts[1] = lights.count;
	for (uint32_t k = 0; k < lights.count; k++) {
		const trace_light *from = &lights.lights[k];
		realtime_light *to = &s->block.lights[k];
		memcpy(to->origin, from->origin, sizeof(vec3));
		memcpy(to->u, from->u, sizeof(vec3));
		memcpy(to->v, from->v, sizeof(vec3));
		memcpy(to->exitance, from->exitance, sizeof(vec3));
		to->origin[3] = from->power_up_to;
		to->u[3] = trace_lights_density(&lights, from->exitance);
	}
	trace_lights_free(&lights);
	return true;
}

static void add_materials(realtime_scene *s)
{
	for (uint32_t k = 0; k < s->scene->object_count; k++) {
		const trace_object *from = &s->scene->objects[k];
		realtime_object *to = &s->block.objects[k];
		memcpy(to->rho, from->rho, sizeof(vec3));
		memcpy(to->exitance, from->exitance, sizeof(vec3));
		memcpy(to->reflectance, from->specular.reflectance, sizeof(vec3));
		memcpy(to->transmittance, from->specular.transmittance, sizeof(vec3));
		to->reflectance[3] = from->specular.index;
	}
}

bool realtime_scene_create(const trace_scene *scene, realtime_scene *out, char *message, size_t message_size)
{
	*out = (realtime_scene){.scene = scene};
	assembly a = {.scene = scene, .out = out};
	bool ok = add_all(&a);
	const double began = now_ms();
	for (uint32_t k = 0; ok && k < out->block.counts[0]; k++)
		ok = build_tree(&a, k);
	out->build_ms = now_ms() - began;
	ok = ok && upload_nodes(&a) && upload_triangles(&a) && upload_vertices(&a) && add_lights(out);
	for (uint32_t k = 0; k < REALTIME_MOST_INSTANCES; k++)
		ray_tree_free(&a.trees[k]);
	free(a.vertices);
	if (ok) {
		make_vertex_array(out);
		add_materials(out);
		return true;
	}
	realtime_scene_destroy(out);
	snprintf(message, message_size, "the scene does not fit into memory, or has too many movers or lights");
	return false;
}

void realtime_scene_destroy(realtime_scene *s)
{
	glDeleteVertexArrays(1, &s->vertex_array);
	glDeleteBuffers(1, &s->vertices);
	glDeleteBuffers(1, &s->indices);
	glDeleteTextures(3, s->textures);
	glDeleteBuffers(3, s->buffers);
	*s = (realtime_scene){0};
}

void realtime_scene_pose(realtime_scene *s)
{
	for (uint32_t k = 0; k < s->block.counts[0]; k++) {
		realtime_instance *i = &s->block.instances[k];
		if (k == 0)
			glm_mat4_identity(i->world_from_object);
		else
			glm_mat4_copy((vec4 *)s->scene->objects[s->mover[k]].world, i->world_from_object);
		glm_mat4_inv(i->world_from_object, i->object_from_world);
	}
	for (uint32_t k = 0; k < s->scene->object_count; k++) {
		vec4 *world = (vec4 *)s->scene->objects[k].world;
		mat4 inverse;
		glm_mat4_inv(world, inverse);
		glm_mat4_mul(s->has_before ? s->before[k] : world, inverse, s->block.objects[k].before_from_now);
		glm_mat4_copy(world, s->before[k]);
	}
	s->has_before = true;
}
