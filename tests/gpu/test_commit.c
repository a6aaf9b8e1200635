/* What a commit may not do: wait for the GPU. Every function of OpenGL that does is counted. */
#include "harness.h"

#include "scenes/shapes.h"

#include <glad/gl.h>

#include <stdio.h>
#include <string.h>

static struct {
	bool on;
	uint32_t count;
	const char *name;
} waits;

static void note(const char *name)
{
	if (!waits.on)
		return;
	waits.count++;
	waits.name = name;
}

static gi_get_proc_address_fn *real_get_proc_address;
static PFNGLFINISHPROC real_finish;
static PFNGLCLIENTWAITSYNCPROC real_wait;
static PFNGLGETNAMEDBUFFERSUBDATAPROC real_read;
static PFNGLMAPNAMEDBUFFERRANGEPROC real_map;
static PFNGLGETQUERYOBJECTUIVPROC real_query;
static PFNGLGETQUERYOBJECTUI64VPROC real_query_64;

static void finish(void)
{
	note("glFinish");
	real_finish();
}

static GLenum wait_sync(GLsync sync, GLbitfield flags, GLuint64 timeout)
{
	note("glClientWaitSync");
	return real_wait(sync, flags, timeout);
}

static void read_buffer(GLuint buffer, GLintptr offset, GLsizeiptr size, void *data)
{
	note("glGetNamedBufferSubData");
	real_read(buffer, offset, size, data);
}

static void *map(GLuint buffer, GLintptr offset, GLsizeiptr length, GLbitfield access)
{
	note("glMapNamedBufferRange");
	return real_map(buffer, offset, length, access);
}

static void query(GLuint id, GLenum name, GLuint *out)
{
	note("glGetQueryObjectuiv");
	real_query(id, name, out);
}

static void query_64(GLuint id, GLenum name, GLuint64 *out)
{
	note("glGetQueryObjectui64v");
	real_query_64(id, name, out);
}

#define COUNTED(text, type, real, mine)                                                                                \
	if (strcmp(name, text) == 0) {                                                                                 \
		real = (type)real_get_proc_address(name, user);                                                        \
		return (gi_proc)(mine);                                                                                \
	}

static gi_proc counting(const char *name, void *user)
{
	COUNTED("glFinish", PFNGLFINISHPROC, real_finish, finish)
	COUNTED("glClientWaitSync", PFNGLCLIENTWAITSYNCPROC, real_wait, wait_sync)
	COUNTED("glGetNamedBufferSubData", PFNGLGETNAMEDBUFFERSUBDATAPROC, real_read, read_buffer)
	COUNTED("glMapNamedBufferRange", PFNGLMAPNAMEDBUFFERRANGEPROC, real_map, map)
	COUNTED("glGetQueryObjectuiv", PFNGLGETQUERYOBJECTUIVPROC, real_query, query)
	COUNTED("glGetQueryObjectui64v", PFNGLGETQUERYOBJECTUI64VPROC, real_query_64, query_64)
	return real_get_proc_address(name, user);
}

static gi_object add_ball(gi_context *gi, int number, gi_mobility mobility)
{
	engine_mesh mesh;
	assert_true(shape_sphere(.15f, 2, &mesh));
	gi_object_def def = gi_object_def_default();
	def.positions = mesh.positions;
	def.vertex_count = mesh.vertex_count;
	def.indices = mesh.indices;
	def.index_count = mesh.index_count;
	def.face_count = mesh.index_count / 4;
	def.mobility = mobility;
	def.pose.position[0] = .5f * (float)(number % 5) - 1;
	def.pose.position[1] = .3f + .4f * (float)(number / 25);
	def.pose.position[2] = .5f * (float)(number / 5 % 5) - 1;
	gi_object object;
	assert_gi(gi_create_object(gi, &def, &object));
	engine_mesh_free(&mesh);
	return object;
}

static void commit(gi_context *gi, const char *what)
{
	waits.on = true;
	waits.count = 0;
	assert_gi(gi_commit(gi));
	waits.on = false;
	if (waits.count)
		fail_msg("%s: %u waits, the last one in %s", what, waits.count, waits.name);
}

static void waits_for_nothing(void **state)
{
	(void)state;
	gi_context_def def = harness_def();
	real_get_proc_address = def.get_proc_address;
	def.get_proc_address = counting;
	def.row_tolerance = .1f;
	gi_context *gi = harness_context(&def);
	engine_mesh mesh;
	assert_true(shape_box((float[]){-2, 0, -2}, (float[]){2, 2, 2}, 2, true, &mesh));
	harness_add(gi, &(harness_object){.name = "room", .rho = {.5f, .5f, .5f}, .exitance = {1, 1, 1}}, &mesh);
	gi_object balls[20];
	for (int k = 0; k < 10; k++)
		balls[k] = add_ball(gi, k, k % 2 ? GI_MOBILITY_STATIC : GI_MOBILITY_MOVABLE);
	commit(gi, "the first");
	waits.on = true;
	waits.count = 0;
	harness_update(gi);
	assert_true(waits.count > 0); /* those that do are seen */
	for (int k = 10; k < 20; k++) {
		balls[k] = add_ball(gi, k, k % 2 ? GI_MOBILITY_STATIC : GI_MOBILITY_MOVABLE);
		commit(gi, "one more");
		assert_gi(gi_update(gi, NULL));
		assert_gi(gi_destroy_object(gi, balls[k - 10]));
		commit(gi, "one less");
		assert_gi(gi_update(gi, NULL));
	}
	for (int k = 10; k < 20; k++)
		assert_gi(gi_destroy_object(gi, balls[k]));
	commit(gi, "nothing but the room");
	harness_update(gi);
	printf("  22 commits, no wait\n");
	gi_context_destroy(gi);
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(waits_for_nothing)};
	return cmocka_run_group_tests_name("commit", tests, harness_open, harness_close);
}
