/* What the GPU tests share: a context for the whole program, gi contexts, objects from cages.
 *
 * The OpenGL context is headless, OSMesa's or EGL's, unless RELUME_CONTEXT names a kind (osmesa, egl, glfw); without
 * one the tests are skipped with a line that says so.
 */
#ifndef TESTS_HARNESS_H
#define TESTS_HARNESS_H

#include "context.h"
#include "gi/gi.h"
#include "mesh.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

/* Group set-up and tear-down for cmocka_run_group_tests. */
int harness_open(void **state);
int harness_close(void **state);

/* Skips the test that calls it when there is no OpenGL context. */
void harness_require_context(void);

/* RELUME_SHADERS=DIRECTORY: shaders from there, to see a test fail on one broken on purpose.
 *
 * The defaults with the harness's OpenGL and silent messages (see harness_last_message). */
gi_context_def harness_def(void);
gi_context *harness_context(const gi_context_def *def);
const char *harness_last_message(void);

/* An object from a cage, which is freed; bilinear, pose and material as given. Fails the test on error. */
typedef struct harness_object {
	const char *name;
	gi_scheme scheme;
	uint32_t levels;
	float rho[3], exitance[3];
	float position[3];
	bool double_sided;
} harness_object;

/* Turns a mesh of quads into one of triangles, two each. */
void harness_cut_quads(engine_mesh *mesh);

gi_object harness_add(gi_context *gi, const harness_object *o, engine_mesh *mesh);

/* RELUME_LONG is set: everything that takes minutes, too. */
bool harness_is_long(void);

/* Paths a leaf for a reference: all of them in a long run, else a quarter. Fewer make figures noisier, never
 * biased: errors are products over two halves of the reference. */
uint32_t harness_paths(uint32_t all);

/* gi_update, gi_finish and the report; fails the test on error. */
gi_report harness_update(gi_context *gi);

#define assert_gi(call) assert_int_equal((call), GI_OK)

#endif
