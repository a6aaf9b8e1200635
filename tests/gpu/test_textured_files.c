/* Textures of glTF files in the picture, by what gi_play does: a square of two colours as a cage, and as the fine mesh
 * that stands before a simplified one; faces without coordinates beside them.
 */
#include "scene_files.h"

#include "demos/file_scene.h"
#include "target.h"

#include <glad/gl.h>

enum { SIZE = 32, CELLS = 40, MOST_CORNERS = (CELLS + 1) * (CELLS + 1) };

/* Two pixels, white and black. */
#define HALF_WHITE "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAIAAAB7QOjdAAAAD0lEQVR4nGP4//8/AwMDAA74Av7Ji4P1AAAAAElFTkSuQmCC"

/* scene.bin: n x n cells of the square -1..1, y = 0, which looks up. */
typedef struct square {
	float positions[MOST_CORNERS][3], uvs[MOST_CORNERS][2];
	uint32_t indices[6 * CELLS * CELLS];
} square;

static square square_of;

static void make_square(uint32_t n)
{
	for (uint32_t k = 0; k < (n + 1) * (n + 1); k++) {
		const float u = (float)(k % (n + 1)) / (float)n, v = (float)(k / (n + 1)) / (float)n;
		const float p[3] = {2 * u - 1, 0, 2 * v - 1};
		memcpy(square_of.positions[k], p, sizeof p);
		square_of.uvs[k][0] = u;
		square_of.uvs[k][1] = v;
	}
	for (uint32_t c = 0; c < n * n; c++) {
		const uint32_t a = c / n * (n + 1) + c % n,
			       corners[6] = {a, a + n + 1, a + 1, a + 1, a + n + 1, a + n + 2};
		memcpy(square_of.indices + 6 * c, corners, sizeof corners);
	}
}

static const char *write_scene(uint32_t n, bool mapped, const char *material)
{
	static char text[4096];
	const unsigned corners = (n + 1) * (n + 1);
	make_square(n);
	write_file("scene.bin", &square_of, sizeof square_of);
	snprintf(
	    text, sizeof text,
	    "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
	    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0%s},\"indices\":2,\"material\":0}]}],"
	    "\"materials\":[{%s}],\"textures\":[{\"source\":0,\"sampler\":0},{\"source\":0,"
	    "\"sampler\":1}],\"samplers\":[{\"wrapS\":33071,\"wrapT\":33071},{\"wrapS\":33071,\"magFilter\":9728}],"
	    "\"images\":[{\"uri\":\"data:image/png;base64," HALF_WHITE "\"}],"
	    "\"buffers\":[{\"uri\":\"scene.bin\",\"byteLength\":%zu}],\"bufferViews\":["
	    "{\"buffer\":0,\"byteOffset\":0,\"byteLength\":%u},{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%u},"
	    "{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%u}],\"accessors\":["
	    "{\"bufferView\":0,\"componentType\":5126,\"count\":%u,\"type\":\"VEC3\",\"min\":[-1,0,-1],"
	    "\"max\":[1,0,1]},{\"bufferView\":1,\"componentType\":5126,\"count\":%u,\"type\":\"VEC2\"},"
	    "{\"bufferView\":2,\"componentType\":5125,\"count\":%u,\"type\":\"SCALAR\"}]}",
	    mapped ? ",\"TEXCOORD_0\":1" : "", material, sizeof square_of, 12 * corners, offsetof(square, uvs),
	    8 * corners, offsetof(square, indices), 24 * n * n, corners, corners, 6 * n * n);
	return write_text("scene.gltf", text);
}

/* Seen from straight above. */
static void draw(gi_context *gi, float pixels[SIZE * SIZE][4])
{
	target picture = target_make(SIZE);
	target_draw(&picture, gi, target_look_down(SIZE));
	memcpy(pixels, picture.pixels, sizeof *pixels * SIZE * SIZE);
	target_free(&picture);
}

static void draw_file(const char *path, uint32_t cage_faces, float pixels[SIZE * SIZE][4])
{
	char fault[512] = "";
	gi_context_def def = harness_def();
	def.sky = GI_SKY_ON;
	def.sky_exitance[0] = def.sky_exitance[1] = def.sky_exitance[2] = 2;
	file_scene f = {.program = "test_textured_files", .leaves = 64, .lit = true, .cage_faces = cage_faces};
	if (!file_scene_load(&f, path, fault, sizeof fault))
		fail_msg("%s", fault);
	gi_context *gi = harness_context(&def);
	if (!file_scene_create(&f, gi, fault, sizeof fault))
		fail_msg("%s", fault);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	draw(gi, pixels);
	gi_context_destroy(gi);
	file_scene_free(&f);
}

#define PAINTED                                                                                                        \
	"\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"baseColorFactor\":[0.5,1,1,1],\"baseColorTexture\":{"        \
	"\"index\":0}}"
#define TURNED                                                                                                         \
	"\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"baseColorTexture\":{\"index\":0,\"extensions\":{"            \
	"\"KHR_texture_transform\":{\"offset\":[1,0],\"scale\":[-1,1]}}}}"
#define SHINING                                                                                                        \
	"\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"baseColorFactor\":[0,0,0,1]},\"emissiveFactor\":[1,0.5,1],"  \
	"\"emissiveTexture\":{\"index\":0}"

/* Seen from near, texels are squares. */
#define SQUARES "\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"baseColorTexture\":{\"index\":1}}"

static const float PI = 3.14159265f;

/* Where the texture is a ramp, left of the middle and right of it. */
enum { NO_RAMP = 0, RAMP = SIZE / 4 };

/* Of pixels beside a ramp. */
static void expect_halves(const char *name, const float pixels[SIZE * SIZE][4], const float left[3],
			  const float right[3], int ramp)
{
	for (int k = 0; k < SIZE * SIZE; k++) {
		const int column = k % SIZE;
		const float *wanted = column < SIZE / 2 ? left : right;
		for (int c = 0; c < 3 && (column < SIZE / 2 - ramp || column >= SIZE / 2 + ramp); c++)
			if (fabsf(pixels[k][c] - wanted[c]) > 1e-3f)
				fail_msg("%s: pixel %d %d, channel %d: %g is not %g", name, column, k / SIZE, c,
					 (double)pixels[k][c], (double)wanted[c]);
	}
}

/* A picture of two rows, white above black. */
static const uint8_t upright[] = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00,
    0x00, 0x01, 0x00, 0x00, 0x00, 0x02, 0x08, 0x02, 0x00, 0x00, 0x00, 0x16, 0xe3, 0x21, 0x70, 0x00, 0x00, 0x00,
    0x0f, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0xf8, 0xff, 0xff, 0x3f, 0x03, 0x10, 0x00, 0x00, 0x11, 0xf6,
    0x02, 0xfe, 0xa2, 0xb6, 0xa1, 0x8c, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

/* Of OBJ v goes up: the upper row lies where v is above a half. */
static void obj_pictures_stand_upright(void **state)
{
	static float pixels[SIZE * SIZE][4];
	(void)state;
	harness_require_context();
	write_file("upright.png", upright, sizeof upright);
	write_text("square.mtl", "newmtl painted\nmap_Kd -clamp on upright.png\n");
	draw_file(write_text("square.obj", "mtllib square.mtl\nv -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nvt 0 0\nvt 1 0\n"
					   "vt 1 1\nvt 0 1\nusemtl painted\nf 1/1 2/2 3/3 4/4\n"),
		  0, pixels);
	for (int i = 0; i < SIZE; i++) {
		const float lower = pixels[(SIZE / 4 - 2) * SIZE + i][1],
			    upper = pixels[(3 * SIZE / 4 + 2) * SIZE + i][1];
		assert_true(lower < 1e-3f && fabsf(upper - 2 / PI) < .03f);
	}
}

static void squares_are_drawn_with_their_textures(void **state)
{
	static float pixels[SIZE * SIZE][4];
	static const float black[3];
	const float lit[3] = {1 / PI, 2 / PI, 2 / PI}, white[3] = {2 / PI, 2 / PI, 2 / PI}, shines[3] = {1, .5f, 1};
	(void)state;
	harness_require_context();
	draw_file(write_scene(2, true, PAINTED), 0, pixels);
	expect_halves("a cage", pixels, lit, black, RAMP);
	draw_file(write_scene(2, true, SQUARES), 0, pixels);
	expect_halves("squares", pixels, white, black, NO_RAMP);
	draw_file(write_scene(CELLS, true, PAINTED), 40, pixels);
	expect_halves("a fine mesh", pixels, lit, black, RAMP);
	draw_file(write_scene(2, true, TURNED), 0, pixels);
	expect_halves("turned", pixels, black, white, RAMP);
	draw_file(write_scene(2, true, SHINING), 0, pixels);
	expect_halves("shining", pixels, shines, black, RAMP);
	draw_file(write_scene(CELLS, true, SHINING), 40, pixels);
	expect_halves("a fine mesh that shines", pixels, shines, black, RAMP);
	/* Without coordinates all of it has the mean. */
	draw_file(write_scene(2, false, PAINTED), 0, pixels);
	const float mean[3] = {.5f / PI, 1 / PI, 1 / PI};
	expect_halves("no coordinates", pixels, mean, mean, NO_RAMP);
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(squares_are_drawn_with_their_textures),
					   cmocka_unit_test(obj_pictures_stand_upright)};
	if (make_folder(NULL))
		return 1;
	const int failed = cmocka_run_group_tests_name("textured files", tests, harness_open, harness_close);
	remove_folder(NULL);
	return failed;
}
