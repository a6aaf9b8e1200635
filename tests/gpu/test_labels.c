/* What a debugger shows of the library: every object of OpenGL's has a label, passes are groups, and nothing that is
 * issued is a serious message of the driver's. */
#include "harness.h"

#include "scenes/shapes.h"

#include <glad/gl.h>

#include <stdio.h>
#include <string.h>

enum { NAMES = 4096, SIZE = 32, MOST_GROUPS = 256 };

/* ---- what the driver says ---- */

static struct {
	uint32_t serious;
	char last[512];
	uint32_t depth, deepest;
	char groups[MOST_GROUPS][64]; /* names that were seen */
	uint32_t group_count;
} heard;

static void note_group(const char *name)
{
	for (uint32_t k = 0; k < heard.group_count; k++)
		if (strcmp(heard.groups[k], name) == 0)
			return;
	assert_true(heard.group_count < MOST_GROUPS);
	snprintf(heard.groups[heard.group_count++], sizeof *heard.groups, "%s", name);
}

static void GLAD_API_PTR hear(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length,
			      const GLchar *message, const void *user)
{
	(void)source;
	(void)id;
	(void)length;
	(void)user;
	if (type == GL_DEBUG_TYPE_PUSH_GROUP) {
		note_group(message);
		heard.depth++;
		heard.deepest = heard.depth > heard.deepest ? heard.depth : heard.deepest;
	} else if (type == GL_DEBUG_TYPE_POP_GROUP) {
		assert_true(heard.depth > 0);
		heard.depth--;
	} else if (severity == GL_DEBUG_SEVERITY_HIGH) {
		heard.serious++;
		snprintf(heard.last, sizeof heard.last, "%s", message);
	}
}

static bool group_seen(const char *name)
{
	for (uint32_t k = 0; k < heard.group_count; k++)
		if (strcmp(heard.groups[k], name) == 0)
			return true;
	return false;
}

/* The driver speaks at all: of a call that is wrong, and of one that is a group. */
static void listen(void)
{
	memset(&heard, 0, sizeof heard);
	glEnable(GL_DEBUG_OUTPUT);
	glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
	glDebugMessageControl(GL_DONT_CARE, GL_DONT_CARE, GL_DONT_CARE, 0, NULL, GL_TRUE);
	glDebugMessageCallback(hear, NULL);
	glBindTexture(GL_TRIANGLES, 0);
	assert_int_equal(glGetError(), GL_INVALID_ENUM);
	assert_int_equal(heard.serious, 1);
	heard.serious = 0;
}

/* ---- objects by name ---- */

typedef GLboolean(GLAD_API_PTR *is_fn)(GLuint name);

static const struct kind {
	const char *what;
	GLenum label;
	is_fn *is;
	bool wanted; /* there is at least one */
} kinds[] = {
    {"buffer", GL_BUFFER, &glad_glIsBuffer, true},
    {"texture", GL_TEXTURE, &glad_glIsTexture, true},
    {"program", GL_PROGRAM, &glad_glIsProgram, true},
    {"framebuffer", GL_FRAMEBUFFER, &glad_glIsFramebuffer, true},
    {"vertex array", GL_VERTEX_ARRAY, &glad_glIsVertexArray, true},
    {"sampler", GL_SAMPLER, &glad_glIsSampler, true},
    {"query", GL_QUERY, &glad_glIsQuery, false}, /* software renderers are timed by the clock */
    {"shader", GL_SHADER, &glad_glIsShader, true},
    {"renderbuffer", GL_RENDERBUFFER, &glad_glIsRenderbuffer, false},
};
enum { KINDS = sizeof kinds / sizeof *kinds };

static bool hosts[KINDS][NAMES];

static void note_hosts(void)
{
	for (size_t k = 0; k < KINDS; k++)
		for (GLuint name = 1; name < NAMES; name++)
			hosts[k][name] = (*kinds[k].is)(name);
}

/* Of all that is there and was not before. */
static uint32_t count_labels(const struct kind *kind, const bool before[NAMES])
{
	uint32_t count = 0;
	for (GLuint name = 1; name < NAMES; name++) {
		if (before[name] || !(*kind->is)(name))
			continue;
		char label[128] = "";
		glGetObjectLabel(kind->label, name, sizeof label, NULL, label);
		if (strncmp(label, "gi ", 3) != 0 || strlen(label) < 6)
			fail_msg("%s %u has the label '%s'", kind->what, name, label);
		count++;
	}
	return count;
}

static void expect_labels(void)
{
	for (size_t k = 0; k < KINDS; k++) {
		const uint32_t count = count_labels(&kinds[k], hosts[k]);
		printf("  %s: %u\n", kinds[k].what, count);
		assert_true(count > 0 || !kinds[k].wanted);
	}
}

/* The driver may keep a program for its own state; that it is to be deleted is known. */
static bool is_deleted(const struct kind *kind, GLuint name)
{
	GLint deleted = 0;
	if (!(*kind->is)(name))
		return true;
	if (kind->label == GL_PROGRAM)
		glGetProgramiv(name, GL_DELETE_STATUS, &deleted);
	else if (kind->label == GL_SHADER)
		glGetShaderiv(name, GL_DELETE_STATUS, &deleted);
	return deleted;
}

static void expect_none(void)
{
	for (size_t k = 0; k < KINDS; k++)
		for (GLuint name = 1; name < NAMES; name++)
			if (!hosts[k][name] && !is_deleted(&kinds[k], name)) {
				char label[128] = "";
				glGetObjectLabel(kinds[k].label, name, sizeof label, NULL, label);
				fail_msg("%s '%s' was never deleted", kinds[k].what, label);
			}
}

/* ---- a context that does all it can ---- */

static gi_object add(gi_context *gi, const char *name, float y, bool up, float exitance)
{
	engine_mesh mesh;
	const float x[3] = {2, 0, 0}, z[3] = {0, 0, 2};
	assert_true(shape_quad((float[]){-1, y, -1}, up ? z : x, up ? x : z, 4, 4, &mesh));
	return harness_add(gi, &(harness_object){.name = name, .rho = {.5f, .5f, .5f}, .exitance = {exitance, 1, 1}},
			   &mesh);
}

static void add_receiver(gi_context *gi)
{
	static const float position[3] = {.2f, .5f, .1f}, normal[3] = {0, 1, 0};
	gi_receivers_def def = gi_receivers_def_default();
	gi_receivers receivers;
	def.positions = position;
	def.normals = normal;
	def.count = 1;
	assert_gi(gi_create_receivers(gi, &def, &receivers));
}

static void draw(gi_context *gi, gi_overlay overlay)
{
	gi_view view = gi_view_default();
	const float world[16] = {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1},
		    clip[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -.2f, 0, 0, 0, 0, 1};
	memcpy(view.view_from_world, world, sizeof world);
	memcpy(view.clip_from_view, clip, sizeof clip);
	view.width = view.height = SIZE;
	view.overlay = overlay;
	assert_gi(gi_draw(gi, &view));
}

static void do_everything(gi_context *gi)
{
	add(gi, "floor", 0, true, 0);
	add(gi, "lamp", 2, false, 20);
	const gi_object more = add(gi, "another lamp", 1.5f, false, 30);
	assert_gi(gi_set_specular(gi, more, 0, (gi_specular){.transmittance = {.5f, .5f, .5f}, .index = 1.5f}));
	add_receiver(gi);
	assert_gi(gi_commit(gi));
	const gi_light_def def = gi_light_def_default();
	gi_light light;
	assert_gi(gi_create_light(gi, &def, &light));
	harness_update(gi);
	assert_gi(gi_set_pose(gi, more, (gi_pose){{.5f, .25f, 0}, {0, 0, 0, 1}}));
	assert_gi(gi_update(gi, &(gi_budget){.rays = 100}));
	harness_update(gi);
	for (gi_overlay overlay = GI_OVERLAY_NONE; overlay <= GI_OVERLAY_RECEIVERS; overlay++)
		draw(gi, overlay);
	float irradiance[3 * 64];
	uint32_t count;
	assert_gi(gi_trace_paths(gi, &(gi_path_options){.paths = 1, .seed = 1}, irradiance, 64, &count));
	/* Objects come and go under a budget: rows are kept, and what came borrows some. */
	add(gi, "shelf", 1, true, 0);
	assert_gi(gi_commit(gi));
	assert_gi(gi_update(gi, &(gi_budget){.rays = 100}));
	assert_gi(gi_destroy_object(gi, more));
	assert_gi(gi_commit(gi));
	harness_update(gi);
	draw(gi, GI_OVERLAY_NONE);
}

static GLuint make_framebuffer(GLuint parts[2])
{
	GLuint framebuffer;
	glCreateRenderbuffers(2, parts);
	glNamedRenderbufferStorage(parts[0], GL_RGBA32F, SIZE, SIZE);
	glNamedRenderbufferStorage(parts[1], GL_DEPTH_COMPONENT32F, SIZE, SIZE);
	glCreateFramebuffers(1, &framebuffer);
	glNamedFramebufferRenderbuffer(framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, parts[0]);
	glNamedFramebufferRenderbuffer(framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, parts[1]);
	glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
	return framebuffer;
}

static void expect_groups(void)
{
	static const char *const calls[] = {"gi_commit", "gi_update", "gi_draw", "assess"};
	for (size_t k = 0; k < sizeof calls / sizeof *calls; k++)
		if (!group_seen(calls[k]))
			fail_msg("there was no group '%s'", calls[k]);
	for (int pass = 0; pass < GI_PASS_COUNT; pass++)
		if (!group_seen(gi_pass_name((gi_pass)pass)))
			fail_msg("there was no group of the pass '%s'", gi_pass_name((gi_pass)pass));
	assert_int_equal(heard.depth, 0);
	assert_int_equal(heard.deepest, 2);
}

static void try_with(bool profile)
{
	GLuint parts[2], framebuffer = make_framebuffer(parts);
	note_hosts();
	listen();
	gi_context_def def = harness_def();
	def.estimate_leaves = 8;
	def.profile = profile;
	gi_context *gi = harness_context(&def);
	do_everything(gi);
	expect_labels();
	gi_context_destroy(gi);
	if (heard.serious)
		fail_msg("%u serious messages, the last one: %s", heard.serious, heard.last);
	expect_groups();
	expect_none();
	glDebugMessageCallback(NULL, NULL);
	glDisable(GL_DEBUG_OUTPUT);
	glDeleteFramebuffers(1, &framebuffer);
	glDeleteRenderbuffers(2, parts);
}

static void everything_has_a_label(void **state)
{
	(void)state;
	harness_require_context();
	try_with(true);
	try_with(false);
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(everything_has_a_label)};
	return cmocka_run_group_tests_name("labels", tests, harness_open, harness_close);
}
