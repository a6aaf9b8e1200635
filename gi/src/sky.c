/* The sky as an object at infinity: patches (sky_patch.h) seen as directions. Its rows' entries are what closes a row
 * of an open scene, and the light of a sky that shines.
 */
#include "sky.h"

#include "context.h"
#include "host_memory.h"
#include "sky_image.h"

#include <math.h>
#include <string.h>

enum { SKY_POINTS = (1 << SKY_LEVELS) + 1, SKY_STEP = SKY_GRID >> SKY_LEVELS };

static double distance(gi_vec3d a, gi_vec3d b)
{
	return sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) + (a.z - b.z) * (a.z - b.z));
}

/* Of the grid of SKY_LEVELS, which all skies have. */
static uint32_t vertex_of(int face, int i, int j)
{
	return (uint32_t)((face * SKY_POINTS + j / SKY_STEP) * SKY_POINTS + i / SKY_STEP);
}

/* Finer patches have vertices of their own. */
static gi_uvec4 add_corners(gi_hierarchy *h, const gi_vec3d c[4])
{
	const uint32_t first = h->vertex_count;
	for (int k = 0; k < 4; k++)
		h->vertices[h->vertex_count++] = (gi_vec4){(float)c[k].x, (float)c[k].y, (float)c[k].z, 0};
	return (gi_uvec4){first, first + 1, first + 2, first + 3};
}

static void place_node(gi_hierarchy *h, uint32_t n, sky_patch p)
{
	gi_vec3d c[4];
	sky_patch_corners(p, c);
	gi_vec3d m = {c[0].x + c[1].x + c[2].x + c[3].x, c[0].y + c[1].y + c[2].y + c[3].y,
		      c[0].z + c[1].z + c[2].z + c[3].z};
	const double s = 1 / sqrt(m.x * m.x + m.y * m.y + m.z * m.z);
	m = (gi_vec3d){m.x * s, m.y * s, m.z * s};
	double radius = 0;
	for (int k = 0; k < 4; k++)
		radius = fmax(radius, distance(m, c[k]));
	/* A hair more than the corners, for rounding. */
	h->geometry[n].sphere = (gi_vec4){(float)m.x, (float)m.y, (float)m.z, (float)(radius * 1.0001)};
	h->geometry[n].axis = (gi_vec4){(float)-m.x, (float)-m.y, (float)-m.z, 1.0f};
	h->geometry[n].moment = (gi_vec4){0, 0, 0, (float)sky_patch_angle(p)};
	if (p.size < SKY_STEP)
		h->topology[n].corners = add_corners(h, c);
	else
		h->topology[n].corners =
		    (gi_uvec4){vertex_of(p.face, p.i, p.j), vertex_of(p.face, p.i + p.size, p.j),
			       vertex_of(p.face, p.i + p.size, p.j + p.size), vertex_of(p.face, p.i, p.j + p.size)};
}

static uint32_t build_node(const sky_image *image, gi_hierarchy *h, uint32_t n, sky_patch p)
{
	place_node(h, n, p);
	uint32_t flags = GI_NODE_POLYGON | GI_NODE_SKY, next = n + 1;
	const bool split = image ? image->split[n] : p.size > SKY_STEP;
	if (!split)
		flags |= GI_NODE_LEAF;
	if (image)
		flags |= GI_NODE_PICTURE | (image->fine[n] ? 1u << GI_NODE_FINER_SHIFT : 0);
	for (int k = 0; split && k < 4; k++)
		next = build_node(image, h, next, sky_patch_child(p, k));
	h->topology[n].range = (gi_uvec4){next, 0, 0, flags};
	return next;
}

static uint32_t count_nodes(const sky_image *image)
{
	uint32_t per_face = 0;
	for (uint32_t level = 0, nodes = 1; level <= SKY_LEVELS; level++, nodes *= 4)
		per_face += nodes;
	return image ? image->node_count : SKY_FACES * per_face;
}

bool sky_build(const sky_image *image, gi_hierarchy *out)
{
	const uint32_t grid = SKY_FACES * SKY_POINTS * SKY_POINTS, finer = count_nodes(image) - count_nodes(NULL);
	*out = (gi_hierarchy){.node_count = count_nodes(image)};
	out->geometry = gi_calloc(out->node_count, sizeof *out->geometry);
	out->topology = gi_calloc(out->node_count, sizeof *out->topology);
	out->vertices = gi_calloc(grid + 4 * finer, sizeof *out->vertices);
	if (!out->geometry || !out->topology || !out->vertices) {
		gi_hierarchy_free(out);
		return false;
	}
	uint32_t next = 0;
	out->vertex_count = grid;
	for (int face = 0; face < SKY_FACES; face++) {
		for (int j = 0; j <= SKY_GRID; j += SKY_STEP)
			for (int i = 0; i <= SKY_GRID; i += SKY_STEP) {
				const gi_vec3d d = sky_direction(face, i, j);
				out->vertices[vertex_of(face, i, j)] = (gi_vec4){(float)d.x, (float)d.y, (float)d.z, 0};
			}
		next = build_node(image, out, next, (sky_patch){face, 0, 0, SKY_GRID});
	}
	return true;
}

/* ---- its light ---- */

bool sky_is_lit(const gi_context *gi, const gi_context_def *def)
{
	const float *e = def->sky_exitance;
	return gi->sky.image || e[0] + e[1] + e[2] > 0;
}

gi_vec4 sky_exitance(const gi_context *gi, uint32_t k)
{
	const float *e = gi->def.sky_exitance;
	if (!gi->sky.image)
		return (gi_vec4){e[0], e[1], e[2], 0};
	const float *mean = gi->sky.image->mean[k];
	return (gi_vec4){e[0] + mean[0], e[1] + mean[1], e[2] + mean[2], 0};
}

void sky_brightest(const gi_context *gi, float out[3])
{
	memcpy(out, gi->def.sky_exitance, 3 * sizeof *out);
	for (uint32_t k = 0; gi->sky.image && k < gi->sky.image->node_count; k++) {
		const gi_vec4 e = sky_exitance(gi, k);
		for (int c = 0; c < 3; c++)
			out[c] = fmaxf(out[c], (&e.x)[c]);
	}
}

void sky_take(gi_context *gi)
{
	gi_sky_state *sky = &gi->sky;
	const bool same =
	    sky->seen == sky->image && memcmp(sky->seen_exitance, gi->def.sky_exitance, sizeof sky->seen_exitance) == 0;
	sky->uploaded = sky->uploaded && same;
	memcpy(sky->seen_exitance, gi->def.sky_exitance, sizeof sky->seen_exitance);
	if (sky->seen == sky->image)
		return;
	sky_image_free(sky->seen);
	sky->seen = sky->image;
}

/* Writes the sky's B, which is its E: no pass computes it. */
void sky_relight(gi_context *gi)
{
	gi_scene *s = &gi->scene;
	if (!s->slot_count || s->sky_slot == GI_NONE)
		return;
	const uint32_t first = s->object_data[s->sky_slot].nodes.x, count = s->object_data[s->sky_slot].nodes.y - first;
	/* gi_finish before the commit that takes other patches in. */
	if (gi->sky.image && gi->sky.image->node_count != count)
		return;
	for (uint32_t k = 0; k < count; k++)
		s->node_exitance[first + k] = sky_exitance(gi, k);
	gpu_buffer_upload(&gi->gpu, &s->node_exitance_gpu, sizeof(gi_vec4) * first, sizeof(gi_vec4) * count,
			  s->node_exitance + first);
	gpu_buffer_upload(&gi->gpu, &gi->solver.radiosity, sizeof(gi_vec4) * (GI_NODE_B * s->node_count + first),
			  sizeof(gi_vec4) * count, s->node_exitance + first);
	sky_take(gi);
}

/* ---- other pictures ---- */

static const gi_node_topology *nodes_of(const gi_scene *s, uint32_t *first, uint32_t *count)
{
	*first = *count = 0;
	if (!s->slot_count || s->sky_slot == GI_NONE)
		return NULL;
	*first = s->object_data[s->sky_slot].nodes.x;
	*count = s->object_data[s->sky_slot].nodes.y - *first;
	return s->topology + *first;
}

static bool nodes_are_same(const gi_node_topology *a, uint32_t a_first, const gi_node_topology *b, uint32_t b_first,
			   uint32_t count)
{
	for (uint32_t k = 0; k < count; k++)
		if (a[k].range.x - a_first != b[k].range.x - b_first || a[k].range.w != b[k].range.w)
			return false;
	return true;
}

bool sky_is_same(const gi_scene *a, const gi_scene *b)
{
	uint32_t a_first, b_first, a_count, b_count;
	const gi_node_topology *of_a = nodes_of(a, &a_first, &a_count), *of_b = nodes_of(b, &b_first, &b_count);
	return a_count == b_count && nodes_are_same(of_a, a_first, of_b, b_first, a_count);
}

gi_result sky_set_image(gi_context *gi, sky_image *image)
{
	gi_sky_state *sky = &gi->sky;
	uint32_t first, count;
	const gi_node_topology *nodes = nodes_of(&gi->scene, &first, &count);
	if (image && sky_image_is_black(image)) {
		sky_image_free(image);
		image = NULL;
	}
	if (nodes) {
		gi_hierarchy patches;
		if (!sky_build(image, &patches)) {
			sky_image_free(image);
			return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
		}
		/* Other patches are another scene: the next update begins with a commit. */
		if (count != patches.node_count || !nodes_are_same(nodes, first, patches.topology, 0, count))
			gi->scene.regroup = true;
		gi_hierarchy_free(&patches);
	}
	const bool lit = sky_is_lit(gi, &gi->def);
	if (sky->image != sky->seen)
		sky_image_free(sky->image);
	sky->image = image;
	gi->light_changed = gi->light_changed || nodes != NULL;
	gi->rows.rebuild = gi->rows.rebuild || (nodes != NULL && lit != sky_is_lit(gi, &gi->def));
	return GI_OK;
}

void sky_free(gi_context *gi)
{
	gi_sky_state *owner = &gi->sky;
	if (owner->seen != owner->image)
		sky_image_free(owner->seen);
	sky_image_free(owner->image);
	SKY_BUFFERS(BUFFER_FREE)
}
