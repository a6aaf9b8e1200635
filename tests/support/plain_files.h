/* Plain OBJ files as people write them: a polygon a wall, no sizes of leaves, no levels. */
#ifndef TESTS_PLAIN_FILES_H
#define TESTS_PLAIN_FILES_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* From the room's own frame, metres, to the file's. */
typedef struct placement {
	double scale;
	double axis[3], angle; /* radians about it */
	double offset[3];      /* in the file's unit */
} placement;

typedef struct region {
	double lower[3], upper[3]; /* of the room's own frame; lower[0] == upper[0]: none */
} region;

typedef struct plain_file {
	const char *name;
	void (*write)(FILE *to, const placement *where);
	placement where;
	region lit, dark; /* leaves whose middles lie in the one are lit, no light comes into the other */
} plain_file;

enum { PLAIN_FILE_COUNT = 16 };
extern const plain_file plain_files[PLAIN_FILE_COUNT];

/* Writes NAME.obj and NAME.mtl into a folder; false when that failed. */
bool plain_file_write(const plain_file *file, const char *folder, char *path, size_t path_size);

/* A point of the file in the room's own frame. */
void plain_file_own(const placement *where, const double in[3], double out[3]);

#endif
