/* Bytes of a fuzzer as arguments of gi_ calls, and what must hold of their results. */
#ifndef FUZZ_INPUT_H
#define FUZZ_INPUT_H

#include "gi/gi.h"

enum { SLOTS = 8, MOST_LEAVES = 4096 };

typedef struct input {
	const uint8_t *bytes;
	size_t size;
	gi_object objects[SLOTS]; /* zero: none yet */
	bool destroyed[SLOTS];
	gi_prepared_object *prepared; /* NULL: none waits */
	gi_material prepared_materials[2];
	gi_light lights[SLOTS];
	gi_receivers receivers[SLOTS];
	bool sane;           /* so far nothing that may overflow: large places, large lamps */
	float exitance, rho; /* the largest so far */
	bool unbounded;      /* there was light that exitance and rho do not bound */
	bool settings;       /* of the context are others than it was created with */
	bool updated;        /* the report is about this input's scene */
} input;

/* Ends the program where a promise is broken. */
void require(bool holds, const char *what);
/* A result of the list. */
void check(gi_result result);
/* As a callback: a result of the list, one line. */
void check_message(gi_result result, const char *message, void *user);

/* 0 where no bytes are left. */
uint8_t next_byte(input *in);
uint32_t next_below(input *in, uint32_t limit);
/* Mostly a quiet number; else one of those that break things, or any bits. */
float next_float(input *in);
void next_floats(input *in, float *out, int count);
/* In [0, 1): for materials that are good more often than not. */
float next_share(input *in);
gi_pose next_pose(input *in);
gi_material next_material(input *in);
/* One of the slots, or a handle that nobody gave out. */
gi_object next_object(input *in);
/* What these may light is within what the report is checked against. */
void remember(input *in, const gi_material *materials, uint32_t count);

/* A cube on its way to the library: what its definition points to. */
typedef struct cube {
	float positions[24], sharpness[2], sizes[6];
	uint32_t indices[24], counts[6], face_materials[6];
	gi_material materials[2];
	gi_leaf_cut cuts[3];
	gi_leaf_choice choice;
} cube;

/* A definition of a cube, of which much may be missing or broken; gi_free_leaf_choice(&cube->choice) after its use. */
gi_object_def next_definition(input *in, gi_context *gi, cube *c);

#endif
