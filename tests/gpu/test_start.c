/* The start: where shaders that are missing or broken are told, and what a host hears on the way to the first light. */
#define _POSIX_C_SOURCE 200809L
#include "snapshot.h"

#include "hud.h"
#include "scenes/body.h"
#include "scenes/shapes.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- a folder of shaders, one of them not ours ---- */

typedef struct folder {
	char path[64];
} folder;

static void path_in(const folder *f, const char *name, char out[512])
{
	snprintf(out, 512, "%s/%s", f->path, name);
}

/* Calls do_to with each of the library's shaders. */
static void for_each_shader(const folder *f, void (*do_to)(const folder *f, const char *name))
{
	DIR *shaders = opendir(RELUME_SOURCE_DIR "/shaders");
	assert_non_null(shaders);
	for (const struct dirent *entry; (entry = readdir(shaders));)
		if (entry->d_name[0] != '.')
			do_to(f, entry->d_name);
	closedir(shaders);
}

static void link_to(const folder *f, const char *name)
{
	char from[512], to[512];
	snprintf(from, sizeof from, RELUME_SOURCE_DIR "/shaders/%s", name);
	path_in(f, name, to);
	assert_int_equal(symlink(from, to), 0);
}

static void take_away(const folder *f, const char *name)
{
	char path[512];
	path_in(f, name, path);
	unlink(path);
}

static folder open_folder(void)
{
	folder f = {"/tmp/relume-shaders-XXXXXX"};
	assert_non_null(mkdtemp(f.path));
	for_each_shader(&f, link_to);
	return f;
}

static void close_folder(const folder *f)
{
	for_each_shader(f, take_away);
	assert_int_equal(rmdir(f->path), 0);
}

static void replace(const folder *f, const char *name, const char *text)
{
	char path[512];
	take_away(f, name);
	path_in(f, name, path);
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fputs(text, file);
	assert_int_equal(fclose(file), 0);
}

/* ---- shaders ---- */

static gi_object add_floor(gi_context *gi)
{
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-1, 0, -1}, (float[]){0, 0, 2}, (float[]){2, 0, 0}, 4, 4, &mesh));
	return harness_add(gi, &(harness_object){.name = "floor", .rho = {.5f, .6f, .7f}}, &mesh);
}

static void add_light(gi_context *gi)
{
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-.5f, 2, -.5f}, (float[]){1, 0, 0}, (float[]){0, 0, 1}, 1, 1, &mesh));
	harness_add(gi, &(harness_object){.name = "light", .exitance = {10, 10, 10}}, &mesh);
}

static void expect_line_about(const char *shader)
{
	const char *message = harness_last_message();
	if (!strstr(message, shader) || strchr(message, '\n'))
		fail_msg("not a line about %s: '%s'", shader, message);
}

static void missing_shaders_fail_at_once(void **state)
{
	(void)state;
	static const char *const names[] = {"light.comp", "buffers.glsl"};
	gi_context_def def = harness_def();
	for (int k = 0; k < 2; k++) {
		const folder f = open_folder();
		gi_context *gi = NULL;
		take_away(&f, names[k]);
		def.shader_directory = f.path;
		assert_int_equal(gi_context_create(&def, &gi), GI_ERROR_SHADER);
		assert_null(gi);
		expect_line_about(names[k]);
		close_folder(&f);
	}
}

/* By the first commit, and by every one after it; the scene stays uncommitted. */
static void broken_shaders_fail_in_commit(void **state)
{
	(void)state;
	static const char *const texts[] = {"#version 450 core\nvoid main() { nonsense; nonsense; }\n",
					    "#version 450 core\nlayout(local_size_x = 1) in;\nvoid other() {}\n"};
	gi_context_def def = harness_def();
	for (int k = 0; k < 2; k++) {
		const folder f = open_folder();
		replace(&f, "close.comp", texts[k]);
		def.shader_directory = f.path;
		gi_context *gi = harness_context(&def);
		add_floor(gi);
		for (int attempt = 0; attempt < 2; attempt++) {
			assert_int_equal(gi_commit(gi), GI_ERROR_SHADER);
			expect_line_about("close.comp");
			assert_int_equal(gi_update(gi, NULL), GI_ERROR_NOT_COMMITTED);
		}
		gi_context_destroy(gi);
		close_folder(&f);
	}
}

/* One that is wanted later fails there, and what does without it goes on. */
static void broken_later_shaders_fail_when_wanted(void **state)
{
	(void)state;
	const folder f = open_folder();
	replace(&f, "assess.comp", "#version 450 core\nvoid main() { nonsense; }\n");
	gi_context_def def = harness_def();
	def.shader_directory = f.path;
	gi_context *gi = harness_context(&def);
	const gi_object floor = add_floor(gi);
	add_light(gi);
	assert_gi(gi_commit(gi));
	assert_int_equal(harness_update(gi).outcome, GI_OUTCOME_CONVERGED);
	const gi_pose pose = {.position = {.1f, 0, 0}, .rotation = {0, 0, 0, 1}};
	assert_gi(gi_set_pose(gi, floor, pose));
	const gi_budget budget = {.rays = 100};
	assert_int_equal(gi_update(gi, &budget), GI_ERROR_SHADER);
	expect_line_about("assess.comp");
	assert_int_equal(gi_update(gi, &budget), GI_ERROR_SHADER);
	assert_int_equal(harness_update(gi).outcome, GI_OUTCOME_CONVERGED);
	gi_context_destroy(gi);
	close_folder(&f);
}

static void take_away_translucent(const folder *f, const char *name)
{
	if (strstr(name, "translucent") || strstr(name, "diffusion"))
		take_away(f, name);
}

/* Nothing of light below surfaces is compiled, or read, in a scene without; with it the first update says what is
 * missing. */
static void translucent_objects_alone_want_their_shaders(void **state)
{
	(void)state;
	const folder f = open_folder();
	for_each_shader(&f, take_away_translucent);
	gi_context_def def = harness_def();
	def.shader_directory = f.path;
	gi_context *gi = harness_context(&def);
	const gi_object floor = add_floor(gi);
	add_light(gi);
	assert_gi(gi_commit(gi));
	assert_int_equal(harness_update(gi).outcome, GI_OUTCOME_CONVERGED);
	assert_gi(gi_set_pose(gi, floor, (gi_pose){{.1f, 0, 0}, {0, 0, 0, 1}}));
	assert_gi(gi_update(gi, &(gi_budget){.rays = 100}));
	const gi_subsurface medium = {{100, 100, 100}, {1, 1, 1}, 1.3f};
	engine_mesh mesh;
	assert_true(shape_sphere(.3f, 2, &mesh));
	gi_object_def ball = scene_mesh_def(&mesh);
	ball.subsurface = &medium;
	gi_object object;
	assert_gi(gi_create_object(gi, &ball, &object));
	engine_mesh_free(&mesh);
	assert_gi(gi_commit(gi));
	assert_int_equal(gi_update(gi, NULL), GI_ERROR_SHADER);
	expect_line_about("translucent");
	assert_gi(gi_destroy_object(gi, object));
	assert_gi(gi_commit(gi));
	assert_int_equal(harness_update(gi).outcome, GI_OUTCOME_CONVERGED);
	gi_context_destroy(gi);
	for_each_shader(&f, take_away);
	assert_int_equal(rmdir(f.path), 0);
}

/* What was computed by shaders that do something else is gone with them; those that do not compile change nothing. */
static void reloaded_shaders_take_over(void **state)
{
	(void)state;
	const folder f = open_folder();
	gi_context_def def = harness_def();
	def.shader_directory = f.path;
	gi_context *gi = harness_context(&def);
	assert_gi(gi_reload_shaders(gi)); /* before they were waited for */
	add_floor(gi);
	add_light(gi);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	snapshot before = snapshot_take(gi);

	replace(&f, "close.comp", "#version 450 core\nvoid main() { nonsense; }\n");
	assert_int_equal(gi_reload_shaders(gi), GI_ERROR_SHADER);
	expect_line_about("close.comp");
	assert_int_equal(harness_update(gi).outcome, GI_OUTCOME_AT_REST);

	/* Rows of nothing: what is left is E. */
	replace(&f, "factor.comp", "#version 450 core\nlayout(local_size_x = 64) in;\nvoid main() {}\n");
	take_away(&f, "close.comp");
	link_to(&f, "close.comp");
	assert_gi(gi_reload_shaders(gi));
	harness_update(gi);
	snapshot dark = snapshot_take(gi);
	assert_true(snapshot_hash_radiosity(&dark) != snapshot_hash_radiosity(&before));

	take_away(&f, "factor.comp");
	link_to(&f, "factor.comp");
	assert_gi(gi_reload_shaders(gi));
	assert_true(harness_update(gi).rays > 0);
	snapshot after = snapshot_take(gi);
	snapshot_expect_same_rows(&before, &after, "the same shaders once more");
	assert_true(snapshot_hash_radiosity(&after) == snapshot_hash_radiosity(&before));
	snapshot_free(&before);
	snapshot_free(&dark);
	snapshot_free(&after);
	gi_context_destroy(gi);
	close_folder(&f);
}

/* ---- progress ---- */

typedef struct listener {
	uint32_t heard, shaders, objects, light;
	uint32_t last_done; /* of the kind last heard */
	char last[128];
	engine_hud *hud; /* draws what it hears; NULL: does not */
} listener;

static uint32_t *kind_of(listener *l, const char *what)
{
	return strstr(what, "shaders") ? &l->shaders : strstr(what, "object") ? &l->objects : &l->light;
}

static void listen(const char *what, uint32_t done, uint32_t total, void *user)
{
	listener *l = user;
	assert_true(what[0] && !strchr(what, '\n'));
	assert_true(total == 0 || done <= total);
	if (strcmp(what, l->last) == 0)
		assert_true(done > l->last_done);
	l->heard++;
	*kind_of(l, what) += 1;
	l->last_done = done;
	snprintf(l->last, sizeof l->last, "%s", what);
	if (!l->hud)
		return;
	engine_hud_text(l->hud, 0, 0, 1, (float[]){1, 1, 1, 1}, "%s", what);
	engine_hud_draw(l->hud, 64, 64);
}

static gi_context *listened_context(listener *l)
{
	gi_context_def def = harness_def();
	def.message = NULL;
	def.progress = listen;
	def.user = l;
	gi_context *gi = harness_context(&def);
	add_floor(gi);
	add_light(gi);
	assert_gi(gi_commit(gi));
	return gi;
}

static void the_way_to_first_light_is_told(void **state)
{
	(void)state;
	listener l = {0};
	gi_context *gi = listened_context(&l);
	assert_true(l.shaders >= 16 && l.objects >= 2);
	assert_int_equal(l.light, 0);
	harness_update(gi);
	assert_true(l.light >= 5);

	/* Frames after that, a rebuild among them, are silent. */
	const uint32_t heard = l.heard;
	gi_invalidate(gi);
	harness_update(gi);
	harness_update(gi);
	assert_int_equal(l.heard, heard);

	/* More objects, more to tell, but for the shaders; of light only where all rows are built again. */
	const listener before = l;
	add_light(gi);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	assert_int_equal(l.shaders, before.shaders);
	assert_true(l.objects > before.objects);
	assert_int_equal(l.light, before.light);
	for (int k = 0; k < 8; k++)
		add_floor(gi);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	assert_int_equal(l.shaders, before.shaders);
	assert_true(l.light > before.light);
	gi_context_destroy(gi);
}

static void drawing_progress_changes_nothing(void **state)
{
	(void)state;
	snapshot taken[2];
	for (int k = 0; k < 2; k++) {
		listener l = {0};
		char message[256];
		harness_require_context();
		l.hud = k ? engine_hud_create(message, sizeof message) : NULL;
		gi_context *gi = listened_context(&l);
		assert_int_equal(harness_update(gi).outcome, GI_OUTCOME_CONVERGED);
		taken[k] = snapshot_take(gi);
		gi_context_destroy(gi);
		engine_hud_destroy(l.hud);
	}
	snapshot_expect_same_rows(&taken[0], &taken[1], "with progress drawn");
	assert_true(snapshot_largest(&taken[0]) > 0);
	assert_int_equal(snapshot_hash_radiosity(&taken[0]), snapshot_hash_radiosity(&taken[1]));
	snapshot_free(&taken[0]);
	snapshot_free(&taken[1]);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(missing_shaders_fail_at_once),
	    cmocka_unit_test(broken_shaders_fail_in_commit),
	    cmocka_unit_test(broken_later_shaders_fail_when_wanted),
	    cmocka_unit_test(translucent_objects_alone_want_their_shaders),
	    cmocka_unit_test(the_way_to_first_light_is_told),
	    cmocka_unit_test(reloaded_shaders_take_over),
	    cmocka_unit_test(drawing_progress_changes_nothing),
	};
	return cmocka_run_group_tests_name("start", tests, harness_open, harness_close);
}
