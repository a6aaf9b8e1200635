/* Nodes, which lie depth-first, as levels of faces: those not split reach down to the finest. */
#include "split_pieces.h"

#include "host_memory.h"

#include <string.h>

static bool allocate_level(gi_refine_level *to, uint32_t count, bool top)
{
	to->face_count = count;
	to->corners = gi_malloc(sizeof *to->corners * (count + 1));
	to->material = gi_malloc(sizeof *to->material * (count + 1));
	to->parent = top ? NULL : gi_malloc(sizeof *to->parent * (count + 1));
	return to->corners && to->material && (top || to->parent);
}

static bool is_on_level(const split_node *n, uint32_t level)
{
	return n->depth == level || (n->leaf && n->depth < level);
}

/* place[k]: number of node k on the level above, then on this one. */
static bool export_level(const splitter *s, uint32_t level, uint32_t *place, const uint32_t *materials,
			 gi_refine_level *to)
{
	uint32_t count = 0;
	for (uint32_t k = 0; k < s->node_count; k++)
		count += is_on_level(&s->nodes[k], level);
	if (!allocate_level(to, count, level == 0))
		return false;
	count = 0;
	for (uint32_t k = 0; k < s->node_count; k++) {
		const split_node *n = &s->nodes[k];
		if (!is_on_level(n, level))
			continue;
		memcpy(to->corners[count], n->corners, sizeof n->corners);
		to->material[count] = materials ? materials[n->face] : 0;
		if (level > 0)
			to->parent[count] = n->depth == level ? n->parent : k;
		count++;
	}
	/* Nodes come before their children, so no parent's place is lost before it was asked for. */
	for (uint32_t k = 0; level > 0 && k < count; k++)
		to->parent[k] = place[to->parent[k]];
	count = 0;
	for (uint32_t k = 0; k < s->node_count; k++)
		if (is_on_level(&s->nodes[k], level))
			place[k] = count++;
	return true;
}

bool split_export_levels(const splitter *s, const uint32_t *materials, gi_refined *out)
{
	uint32_t *place = gi_malloc(sizeof *place * (s->node_count + 1));
	out->levels = gi_calloc(s->depth + 1, sizeof *out->levels);
	bool enough = place && out->levels;
	for (; enough && out->level_count <= s->depth; out->level_count++)
		enough = export_level(s, out->level_count, place, materials, &out->levels[out->level_count]);
	gi_free(place);
	return enough;
}

/* The finest level's. */
bool split_export_parted(const splitter *s, gi_refined *out)
{
	const uint32_t finest = out->level_count - 1;
	out->parted = gi_malloc(out->levels[finest].face_count + 1);
	if (!out->parted)
		return false;
	uint32_t count = 0;
	for (uint32_t k = 0; k < s->node_count; k++)
		if (is_on_level(&s->nodes[k], finest))
			out->parted[count++] = s->nodes[k].parted;
	return true;
}

bool split_export_points(const splitter *s, gi_refined *out)
{
	out->vertex_count = s->point_count;
	out->positions = gi_malloc(sizeof *out->positions * (s->point_count + 1));
	out->normals = gi_calloc(s->point_count + 1, sizeof *out->normals);
	if (!out->positions || !out->normals)
		return false;
	for (uint32_t k = 0; k < s->point_count; k++)
		split_round_point(s->points[k], out->positions[k]);
	return true;
}

bool split_export_faces(const splitter *s, gi_refined *out)
{
	const uint32_t finest = out->level_count - 1;
	out->faces = gi_malloc(sizeof *out->faces * ((size_t)out->levels[finest].face_count + 1));
	if (!out->faces)
		return false;
	uint32_t count = 0;
	for (uint32_t k = 0; k < s->node_count; k++)
		if (is_on_level(&s->nodes[k], finest))
			out->faces[count++] = s->nodes[k].face;
	return true;
}
