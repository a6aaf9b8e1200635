/* A closed room with objects of every kind of cage whose shapes change: what the tests of moving skin play. */
#ifndef TESTS_DEFORMING_SCENE_H
#define TESTS_DEFORMING_SCENE_H

#include "harness.h"

enum { BENT_BOX, BENT_SPLIT, BENT_BALL, BENT_LOOP, BENT_SHEET, BENT_KINDS };

typedef struct bent {
	engine_mesh mesh; /* as defined */
	float *positions; /* of now */
	gi_pose pose;
	gi_object object;
} bent;

typedef struct deforming_scene {
	gi_context *gi;
	bent bent[BENT_KINDS];
	gi_object block; /* rigid, between them */
	gi_pose block_pose;
	float exitance; /* of BENT_SPLIT */
	bool mirror;    /* BENT_BALL is one */
} deforming_scene;

/* Fills in meshes and poses; opens no context. */
void deforming_scene_make(deforming_scene *s);
void deforming_scene_free(deforming_scene *s);

/* Creates it all in s->gi, at the shapes of the definition. */
void deforming_scene_create(deforming_scene *s);

/* Shapes and poses of frame k, of some of the objects: others keep theirs. Sets them in s->gi where there is one. */
void deforming_scene_play(deforming_scene *s, int frame);

/* Sets all shapes and poses of now in s->gi. */
void deforming_scene_set(const deforming_scene *s);

#endif
