/* A renderer draws a mesh of its own, a wavy ground below a lamp, in a shader of its own with the library's light. */
#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>
#include <gi/gi.h>
#include <math.h>
#include <stdio.h>
enum { SIDE = 64, VERTICES = 6 * SIDE * SIDE, PIXELS = 65 };
static struct {
	float position[VERTICES][3];     /* the renderer's mesh; its cage is one flat face */
	gi_vertex_light light[VERTICES]; /* what of the library's light each vertex takes */
} mesh;
static gi_proc find_gl(const char *name, void *user)
{
	return user ? NULL : (gi_proc)eglGetProcAddress(name);
}
static gi_result add_square(gi_context *gi, float half, float y, float z, gi_material material, gi_object *out)
{
	const float corners[12] = {-half, y, z, half, y, z, half, y, -z, -half, y, -z};
	gi_object_def def = gi_object_def_default();
	def.positions = corners;
	def.indices = (const uint32_t[]){0, 1, 2, 3};
	def.vertex_count = def.index_count = 4;
	def.materials = &material;
	def.face_count = def.material_count = 1;
	def.leaf_size = .1f;
	def.undrawn = true; /* by the library */
	return gi_create_object(gi, &def, out);
}
static void draw(uint32_t first_light)
{
	const char *const text[4] = {
	    "#version 450\n#define GI_LIGHT_UNIT 0\n", gi_glsl("gi_light.glsl"),
	    "layout(location = 0) in vec3 p; layout(location = 1) in uvec4 light; layout(location = 2) in vec4 weight;"
	    "layout(location = 0) uniform uint first; out vec3 shown; out gl_PerVertex { vec4 gl_Position; };"
	    "void main() { shown = gi_light_at_vertex(first, light, weight); gl_Position = vec4(p.xz / 2, 0, 1); }",
	    "#version 450\nin vec3 shown; out vec4 c; void main() { c = shown.xyzz; }"};
	const GLuint program = glCreateShaderProgramv(GL_VERTEX_SHADER, 3, text);
	GLuint pipeline, array, buffer;
	glGenProgramPipelines(1, &pipeline);
	glUseProgram(0); /* the library leaves one of its own bound */
	glBindProgramPipeline(pipeline);
	glUseProgramStages(pipeline, GL_VERTEX_SHADER_BIT, program);
	glUseProgramStages(pipeline, GL_FRAGMENT_SHADER_BIT, glCreateShaderProgramv(GL_FRAGMENT_SHADER, 1, text + 3));
	glProgramUniform1ui(program, 0, first_light);
	glGenVertexArrays(1, &array);
	glBindVertexArray(array);
	glGenBuffers(1, &buffer);
	glBindBuffer(GL_ARRAY_BUFFER, buffer);
	glBufferData(GL_ARRAY_BUFFER, sizeof mesh, &mesh, GL_STATIC_DRAW);
	glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, NULL);
	glVertexAttribIPointer(1, 4, GL_UNSIGNED_INT, 32, (char *)sizeof mesh.position);
	glVertexAttribPointer(2, 4, GL_FLOAT, GL_FALSE, 32, (char *)sizeof mesh.position + 16);
	glEnableVertexAttribArray(0), glEnableVertexAttribArray(1), glEnableVertexAttribArray(2);
	glDrawArrays(GL_TRIANGLES, 0, VERTICES);
}
int main(void)
{
	const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_NONE},
		     version[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5, EGL_NONE},
		     size[] = {EGL_WIDTH, PIXELS, EGL_HEIGHT, PIXELS, EGL_NONE};
	const EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
	EGLConfig config = NULL;
	EGLint count;
	eglInitialize(display, NULL, NULL);
	eglBindAPI(EGL_OPENGL_API);
	eglChooseConfig(display, wanted, &config, 1, &count);
	const EGLSurface surface = eglCreatePbufferSurface(display, config, size);
	if (!eglMakeCurrent(display, surface, surface, eglCreateContext(display, config, NULL, version)))
		return 77;
	for (int k = 0; k < VERTICES; k++) {
		const int quad = k / 6, corner = "021123"[k % 6] - '0';
		const float x = (float)(quad % SIDE + corner % 2) / 16, z = (float)(quad / SIDE + corner / 2) / 16;
		mesh.position[k][0] = x - 2, mesh.position[k][2] = z - 2;
		mesh.position[k][1] = .02f * sinf(9 * x) * sinf(9 * z);
	}
	const gi_material grey = {{.5f, .5f, .5f}, {0, 0, 0}}, lamp = {{0, 0, 0}, {10, 10, 10}};
	gi_context_def def = gi_context_def_default();
	def.get_proc_address = find_gl;
	def.pixel_lamps = 0; /* the leaves have all the light */
	gi_context *gi = NULL;
	gi_object above, ground;
	gi_object_range range;
	gi_buffers buffers;
	if (gi_context_create(&def, &gi) || add_square(gi, .5f, 2, -.5f, lamp, &above) ||
	    add_square(gi, 2, 0, 2, grey, &ground) || gi_commit(gi) || gi_update(gi, NULL) ||
	    gi_map_vertices(gi, ground, *mesh.position, NULL, VERTICES, mesh.light) ||
	    gi_get_object_range(gi, ground, &range) || gi_get_buffers(gi, &buffers))
		return 1;
	glBindTextureUnit(0, buffers.light_indirect_texture);
	draw(range.first_light);
	float middle = 0;
	glReadPixels(PIXELS / 2, PIXELS / 2, 1, 1, GL_RED, GL_FLOAT, &middle);
	const float by_hand = .7348f; /* E 4 / pi s atan s, s = x / sqrt(1 + x2), x = 0.5 m / 2 m */
	printf("the ground below the lamp receives %.4f W/m2, by hand %.4f\n", (double)middle, (double)by_hand);
	gi_context_destroy(gi);
	return fabsf(middle - by_hand) > .02f * by_hand;
}
