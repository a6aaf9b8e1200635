/* What a shape that changes costs beside the same object in one shape that moves as far: both in turn, frame by frame.
 *
 *     LP_NUM_THREADS=0 skin_cost [walker | cloth | tentacle] [FRAMES [LEAVES [TOLERANCE]]]
 *
 * Medians over the frames, ms: processor time of this process of setting the shape and the pose, and of the update;
 * wall time of each pass as the report has it. Entries of pairs of the object's own leaves: how many there are, of them
 * those with a form factor of zero and those of which no ray is seen.
 */
#include "demos/file_scene.h"
#include "samples.h"
#include "scenes/body.h"
#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979, FRAMES_A_SECOND = 24, SECONDS_ROUND = 6;

enum { ROUND = 12, RINGS = 40, CLOTH = 30, WARM_UP = 3 };

typedef struct stage {
	const char *figure;
	bool rigid;
	gi_context *gi;
	file_scene file;  /* of the walker */
	engine_mesh mesh; /* of the others */
	float *positions;
	gi_object object;
	samples set_ms, update_ms, pass_ms[GI_PASS_COUNT], entries, rays;
	gi_report last;
} stage;

static void need(bool ok, const char *what)
{
	if (ok)
		return;
	fprintf(stderr, "skin_cost: %s\n", what);
	exit(1);
}

static gi_context *open_gi(engine_context *context, float tolerance)
{
	gi_context_def def = gi_context_def_default();
	gi_context *gi = NULL;
	def.get_proc_address = engine_context_find_gl;
	def.get_proc_user = context;
	def.row_tolerance = tolerance;
	def.profile = true;
	def.shader_directory = getenv("RELUME_SHADERS");
	need(gi_context_create(&def, &gi) == GI_OK, "no context");
	return gi;
}

/* ---- the walker of demos/scenes ---- */

static void load_walker(stage *s, uint32_t leaves)
{
	char message[512] = "";
	s->file = (file_scene){.program = "skin_cost", .leaves = leaves ? leaves : 1000};
	need(file_scene_load(&s->file, RELUME_SOURCE_DIR "/demos/scenes/walker.gltf", message, sizeof message),
	     message);
	uint32_t figure = 0;
	for (uint32_t k = 0; k < s->file.scene.object_count; k++)
		figure = strcmp(s->file.scene.objects[k].name, "figure") == 0 ? k : figure;
	for (uint32_t k = 0; k < s->file.scene.object_count && s->rigid; k++)
		s->file.scene.objects[k].deforms = false;
	need(file_scene_create(&s->file, s->gi, message, sizeof message), message);
	need(file_scene_animate(&s->file, s->gi, 0) == GI_OK, "animate");
	for (uint32_t k = 0; k < s->file.scene.object_count; k++)
		s->file.scene.objects[k].deforms = s->file.scene.objects[k].deforms && k == figure;
	s->object = s->file.handles[figure];
}

/* ---- figures made here ---- */

static gi_object add(stage *s, const char *name, engine_mesh *mesh, float rho, float exitance)
{
	const gi_material material = {{rho, rho, rho}, {exitance, exitance, exitance}};
	gi_object_def def = scene_mesh_def(mesh);
	gi_object out;
	def.name = name;
	def.materials = &material;
	def.material_count = 1;
	need(gi_create_object(s->gi, &def, &out) == GI_OK, name);
	engine_mesh_free(mesh);
	return out;
}

static void add_room(stage *s)
{
	engine_mesh m;
	need(shape_box((float[]){-2.2f, 0, -2.2f}, (float[]){2.2f, 2.6f, 2.2f}, 8, true, &m), "room");
	add(s, "room", &m, .7f, 0);
	need(shape_quad((float[]){-.4f, 2.59f, -.4f}, (float[]){.8f, 0, 0}, (float[]){0, 0, .8f}, 3, 3, &m), "lamp");
	add(s, "lamp", &m, 0, 20);
}

/* A tube about y that tapers, closed at both ends. */
static bool make_tentacle(engine_mesh *m)
{
	*m = (engine_mesh){.vertex_count = ROUND * RINGS + 2};
	const uint32_t quads = ROUND * (RINGS - 1), faces = quads + 2 * ROUND;
	m->positions = calloc(3 * (size_t)m->vertex_count, sizeof(float));
	m->indices = calloc(4 * (size_t)faces, sizeof(uint32_t));
	m->face_counts = calloc(faces, sizeof(uint32_t));
	if (!m->positions || !m->indices || !m->face_counts)
		return false;
	for (int r = 0; r < RINGS; r++)
		for (int k = 0; k < ROUND; k++) {
			float *p = m->positions + 3 * (size_t)(r * ROUND + k);
			const float up = (float)r / (RINGS - 1), turn = 2 * (float)PI * (float)k / ROUND;
			p[0] = (.28f - .2f * up) * cosf(turn);
			p[1] = 1.8f * up;
			p[2] = -(.28f - .2f * up) * sinf(turn);
		}
	m->positions[3 * (m->vertex_count - 1) + 1] = 1.82f;
	uint32_t *at = m->indices;
	for (uint32_t r = 0; r + 1 < RINGS; r++)
		for (uint32_t k = 0; k < ROUND; k++) {
			const uint32_t a = r * ROUND, b = a + ROUND, next = (k + 1) % ROUND;
			const uint32_t quad[4] = {a + k, a + next, b + next, b + k};
			memcpy(at, quad, sizeof quad);
			at += 4;
			m->face_counts[m->face_count++] = 4;
		}
	for (uint32_t k = 0; k < 2 * ROUND; k++) {
		const uint32_t first = k < ROUND ? 0 : ROUND * (RINGS - 1),
			       middle = m->vertex_count - (k < ROUND ? 2 : 1);
		const uint32_t a = first + k % ROUND, b = first + (k + 1) % ROUND;
		const uint32_t three[3] = {k < ROUND ? b : a, k < ROUND ? a : b, middle};
		memcpy(at, three, sizeof three);
		at += 3;
		m->face_counts[m->face_count++] = 3;
	}
	m->index_count = (uint32_t)(at - m->indices);
	return true;
}

static bool make_cloth(engine_mesh *m)
{
	return shape_quad((float[]){-.7f, .3f, 0}, (float[]){1.4f, 0, 0}, (float[]){0, 1.4f, 0}, CLOTH, CLOTH, m);
}

static void load_made(stage *s, uint32_t leaves)
{
	const bool cloth = strcmp(s->figure, "cloth") == 0;
	const gi_material material = {.rho = {.6f, .5f, .4f}};
	add_room(s);
	need(cloth ? make_cloth(&s->mesh) : make_tentacle(&s->mesh), "figure");
	s->positions = calloc(3 * (size_t)s->mesh.vertex_count, sizeof *s->positions);
	need(s->positions != NULL, "memory");
	gi_object_def def = scene_mesh_def(&s->mesh);
	def.name = s->figure;
	def.deforms = true;
	def.materials = &material;
	def.material_count = 1;
	def.double_sided = cloth;
	while (leaves > (uint32_t)s->mesh.face_count << 2 * def.levels)
		def.levels++;
	need(gi_create_object(s->gi, &def, &s->object) == GI_OK, "figure");
}

/* The rigid one is bent, too: what rays meet of a straight one is less. */
static const double BENT_S = .3;

/* Waves run through the cloth; the tentacle's rings turn and swing, the further up the more. */
static void bend(stage *s, double time_s)
{
	const bool cloth = strcmp(s->figure, "cloth") == 0;
	const float t = (float)(2 * PI * time_s);
	for (uint32_t v = 0; v < s->mesh.vertex_count; v++) {
		const float *p = s->mesh.positions + 3 * (size_t)v;
		float *q = s->positions + 3 * (size_t)v;
		const float angle = .5f * sinf(t) * p[1] * p[1] / 1.8f, c = cosf(angle), d = sinf(angle);
		q[0] = cloth ? p[0] : c * p[0] + .3f * d * p[1];
		q[1] = cloth ? p[1] : c * p[1] - d * p[0];
		q[2] = p[2] + (cloth ? .12f : .1f * p[1]) * sinf(4 * (cloth ? p[0] : p[1]) - t + 2 * p[1]);
	}
}

/* ---- a frame ---- */

static gi_pose pose_at(double time_s)
{
	const double way = time_s / SECONDS_ROUND * 2 * PI;
	return (gi_pose){{(float)(.95 * sin(way)), 0, (float)(.95 * cos(way))},
			 {0, (float)sin(way / 2), 0, (float)cos(way / 2)}};
}

static void set(stage *s, double time_s)
{
	const bool file = s->file.handles != NULL;
	gi_result result = GI_OK;
	if (file && !s->rigid)
		result = file_scene_animate(&s->file, s->gi, time_s);
	else
		result = gi_set_pose(s->gi, s->object, pose_at(time_s));
	if (!result && !file && !s->rigid) {
		bend(s, time_s);
		result = gi_set_positions(s->gi, s->object, s->positions);
	}
	need(result == GI_OK, "set");
}

static void play(stage *s, int frame)
{
	const double began = processor_ms();
	set(s, (frame + 3) / FRAMES_A_SECOND);
	const double between = processor_ms();
	need(!gi_update(s->gi, NULL) && !gi_finish(s->gi) && !gi_get_report(s->gi, &s->last), "update");
	const double end = processor_ms();
	if (frame < 0)
		return;
	samples_add(&s->set_ms, between - began);
	samples_add(&s->update_ms, end - between);
	samples_add(&s->entries, (double)s->last.new_entries);
	samples_add(&s->rays, (double)s->last.rays);
	for (int k = 0; k < GI_PASS_COUNT; k++)
		samples_add(&s->pass_ms[k], (double)s->last.pass_ms[k]);
}

static void open_stage(stage *s, engine_context *context, uint32_t leaves, float tolerance)
{
	s->gi = open_gi(context, tolerance);
	if (strcmp(s->figure, "walker") == 0)
		load_walker(s, leaves);
	else
		load_made(s, leaves);
	if (s->positions) {
		bend(s, BENT_S);
		need(gi_set_positions(s->gi, s->object, s->positions) == GI_OK, "bend");
	}
	need(!gi_commit(s->gi) && !gi_update(s->gi, NULL) && !gi_finish(s->gi), "commit");
}

static void close_stage(stage *s)
{
	gi_context_destroy(s->gi);
	if (s->file.handles)
		file_scene_free(&s->file);
	engine_mesh_free(&s->mesh);
	free(s->positions);
}

/* ---- what is told ---- */

static void tell_own(const stage *s)
{
	uint32_t leaves = 0;
	uint64_t count = 0;
	need(!gi_read_leaves(s->gi, NULL, 0, &leaves) && !gi_read_entries(s->gi, NULL, 0, &count), "read");
	gi_leaf *l = calloc(leaves + 1, sizeof *l);
	gi_entry *e = calloc(count + 1, sizeof *e);
	need(l && e, "memory");
	need(!gi_read_leaves(s->gi, l, leaves, &leaves) && !gi_read_entries(s->gi, e, count, &count), "read");
	uint64_t own = 0, of = 0, to = 0, zero = 0, hidden = 0, single = 0, rays = 0, mine = 0;
	for (uint32_t k = 0; k < leaves; k++)
		mine += l[k].object.index1 == s->object.index1;
	for (uint64_t k = 0; k < count; k++) {
		const bool at = l[e[k].leaf].object.index1 == s->object.index1;
		const bool from = e[k].leaf_count && l[e[k].first_leaf].object.index1 == s->object.index1;
		of += at && !from;
		to += from && !at;
		if (!at || !from)
			continue;
		own++;
		zero += e[k].samples == 0;
		hidden += e[k].samples > 0 && e[k].visible == 0;
		single += e[k].leaf_count == 1;
		rays += e[k].samples;
	}
	printf("  leaves %u, of the figure %u; entries %.0f: own %.0f (factor 0: %.0f, hidden %.0f, leaves %.0f, rays "
	       "%.0f), of its rows for others %.0f, of others for it %.0f\n",
	       leaves, (unsigned)mine, (double)count, (double)own, (double)zero, (double)hidden, (double)single,
	       (double)rays, (double)of, (double)to);
	free(l);
	free(e);
}

static void tell(const stage *walks, const stage *rigid)
{
	const double w = samples_median(&walks->update_ms), r = samples_median(&rigid->update_ms);
	const double ws = samples_median(&walks->set_ms), rs = samples_median(&rigid->set_ms);
	printf("  %-10s %9s %9s\n", "", "deforming", "rigid");
	printf("  %-10s %9.2f %9.2f\n", "set", ws, rs);
	printf("  %-10s %9.2f %9.2f   ratio %.2f, with set %.2f\n", "update", w, r, w / r, (w + ws) / (r + rs));
	for (int k = 0; k < GI_PASS_COUNT; k++) {
		const double a = samples_median(&walks->pass_ms[k]), b = samples_median(&rigid->pass_ms[k]);
		if (a > 0 || b > 0)
			printf("  %-10s %9.2f %9.2f\n", gi_pass_name((gi_pass)k), a, b);
	}
	printf("  %-10s %9.0f %9.0f\n", "new entries", samples_median(&walks->entries),
	       samples_median(&rigid->entries));
	printf("  %-10s %9.0f %9.0f\n", "rays", samples_median(&walks->rays), samples_median(&rigid->rays));
	printf("  %-10s %9.0f %9.0f\n", "uploaded", (double)walks->last.uploaded_bytes,
	       (double)rigid->last.uploaded_bytes);
}

int main(int argc, char **argv)
{
	static stage walks, rigid = {.rigid = true};
	const int frames = argc > 2 ? atoi(argv[2]) : 48;
	const uint32_t leaves = argc > 3 ? (uint32_t)atoi(argv[3]) : 0;
	const float tolerance = argc > 4 ? (float)atof(argv[4]) : .05f;
	walks.figure = rigid.figure = argc > 1 ? argv[1] : "walker";
	engine_context_def def = engine_context_def_default();
	def.width = def.height = 64;
	def.hidden = true;
	char message[256];
	engine_context *context = engine_context_create(&def, message, sizeof message);
	need(context && frames > 0,
	     context ? "usage: skin_cost [walker | cloth | tentacle] [FRAMES [LEAVES [TOLERANCE]]]" : message);
	open_stage(&walks, context, leaves, tolerance);
	open_stage(&rigid, context, leaves, tolerance);
	for (int frame = -WARM_UP; frame < frames; frame++) {
		play(&walks, frame);
		play(&rigid, frame);
	}
	printf("%s, %d frames, processor ms, medians\n", walks.figure, frames);
	tell_own(&walks);
	tell(&walks, &rigid);
	close_stage(&walks);
	close_stage(&rigid);
	engine_context_destroy(context);
	return 0;
}
