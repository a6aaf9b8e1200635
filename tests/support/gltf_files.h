/* For tests of glTF files: scene.bin with numbers that all of them take, and JSON around it as macros. */
#ifndef TESTS_UNIT_GLTF_FILES_H
#define TESTS_UNIT_GLTF_FILES_H

#include "scene_files.h"

/* scene.bin: what all the glTF files here take their numbers from. Offsets in bytes stand beside the fields. */
typedef struct binary {
	float square[4][3];      /*   0: unit square in z = 0, front towards +z */
	uint16_t indices[6];     /*  48: two triangles */
	float times[3];          /*  60: 0 1 2 s */
	float positions[3][3];   /*  72: translation keys */
	float rotations[3][4];   /* 108: 0, 90, 180 degrees about y */
	float bad[4][3];         /* 156: the square with a NaN */
	float cubic[9][3];       /* 204: in-tangent, value, out-tangent of three keys */
	float flat[4][3];        /* 312: all on one line */
	uint16_t far_indices[6]; /* 360: one out of range */
	float scales[3][3];      /* 372: 1, 2, 2 */
	float zero_scales[3][3]; /* 408: 1, 0, 1 */
	float times_falling[3];  /* 444 */
} binary;                        /* 456 */

static const float half = 0.70710678f;

static binary make_binary(void)
{
	return (binary){
	    .square = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
	    .indices = {0, 1, 2, 0, 2, 3},
	    .times = {0, 1, 2},
	    .positions = {{0, 0, 0}, {2, 0, 0}, {2, 4, 0}},
	    .rotations = {{0, 0, 0, 1}, {0, half, 0, half}, {0, 1, 0, 0}},
	    .bad = {{0, 0, 0}, {1, NAN, 0}, {1, 1, 0}, {0, 1, 0}},
	    .cubic = {{0}, {0, 0, 0}, {3, 0, 0}, {3, 0, 0}, {2, 0, 0}, {0}, {0}, {2, 4, 0}, {0}},
	    .flat = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}},
	    .far_indices = {0, 1, 2, 0, 2, 4},
	    .scales = {{1, 1, 1}, {2, 2, 2}, {2, 2, 2}},
	    .zero_scales = {{1, 1, 1}, {0, 1, 1}, {1, 1, 1}},
	    .times_falling = {0, 2, 1},
	};
}

/* clang-format off */
#define VIEW(offset, length) "{\"buffer\":0,\"byteOffset\":" #offset ",\"byteLength\":" #length "}"
#define ACCESSOR(view, component, count, type) \
	"{\"bufferView\":" #view ",\"componentType\":" #component ",\"count\":" #count ",\"type\":\"" type "\"}"

/* Accessors: 0 square, 1 indices, 2 times, 3 positions, 4 rotations, 5 bad, 6 cubic, 7 flat, 8 far, 9 scales,
 * 10 zero scales, 11 falling times.
 */
#define ACCESSORS \
	"\"bufferViews\":[" VIEW(0, 48) "," VIEW(48, 12) "," VIEW(60, 12) "," VIEW(72, 36) "," VIEW(108, 48) "," \
	VIEW(156, 48) "," VIEW(204, 108) "," VIEW(312, 48) "," VIEW(360, 12) "," VIEW(372, 36) "," VIEW(408, 36) "," \
	VIEW(444, 12) "],\"accessors\":[" ACCESSOR(0, 5126, 4, "VEC3") "," ACCESSOR(1, 5123, 6, "SCALAR") "," \
	ACCESSOR(2, 5126, 3, "SCALAR") "," ACCESSOR(3, 5126, 3, "VEC3") "," ACCESSOR(4, 5126, 3, "VEC4") "," \
	ACCESSOR(5, 5126, 4, "VEC3") "," ACCESSOR(6, 5126, 9, "VEC3") "," ACCESSOR(7, 5126, 4, "VEC3") "," \
	ACCESSOR(8, 5123, 6, "SCALAR") "," ACCESSOR(9, 5126, 3, "VEC3") "," ACCESSOR(10, 5126, 3, "VEC3") "," \
	ACCESSOR(11, 5126, 3, "SCALAR") "]"
#define BUFFER "\"buffers\":[{\"byteLength\":456,\"uri\":\"scene%20file.bin\"}]"
#define HEAD "{\"asset\":{\"version\":\"2.0\"},"
#define TAIL "," BUFFER "," ACCESSORS "}"
#define SQUARE "{\"attributes\":{\"POSITION\":0},\"indices\":1}"
#define MESH "\"meshes\":[{\"primitives\":[" SQUARE "]}]"
#define ONE_NODE(members) HEAD "\"nodes\":[{\"mesh\":0" members "}]," MESH TAIL
#define ONE_MATERIAL(members) \
	HEAD "\"nodes\":[{\"mesh\":0}],\"materials\":[{\"name\":\"paint\"," members "}],\"meshes\":[{" \
	"\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,\"material\":0}]}]" TAIL
#define ONE_PRIMITIVE(primitive) \
	HEAD "\"nodes\":[{\"mesh\":0,\"name\":\"thing\"}],\"meshes\":[{\"primitives\":[" primitive "]}]" TAIL
#define ANIMATED(path, sampler) \
	HEAD "\"nodes\":[{\"mesh\":0}],\"animations\":[{\"samplers\":[" sampler "],\"channels\":[{\"sampler\":0," \
	"\"target\":{\"node\":0,\"path\":\"" path "\"}}]}]," MESH TAIL
/* clang-format on */

static engine_scene load_gltf(const char *text)
{
	return load(write_text("a.gltf", text));
}

static void check_gltf_refused(const char *text, const char *words)
{
	check_refused(write_text("a.gltf", text), words);
}

/* Loads, with these words in the warning. */
static void check_gltf_told(const char *text, const char *words)
{
	check_told(write_text("a.gltf", text), words);
}

static engine_pose pose_at(const engine_scene *scene, uint32_t object, double time_s)
{
	engine_pose pose;
	assert_true(engine_scene_pose(scene, object, time_s, &pose));
	return pose;
}

static int make_gltf_folder(void **state)
{
	if (make_folder(state))
		return -1;
	binary bytes = make_binary();
	write_file("scene file.bin", &bytes, sizeof bytes);
	return 0;
}

#endif
