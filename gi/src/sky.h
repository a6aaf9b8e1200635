/* The sky: patches at infinity, of one colour or of a picture. */
#ifndef GI_SKY_H
#define GI_SKY_H

#include "buffers.h"
#include "gpu.h"
#include "hierarchy.h"

struct sky_image;
struct gi_scene;

typedef struct gi_sky_state {
	struct sky_image *image; /* as of gi_set_sky_image, NULL: none */
	struct sky_image *seen;  /* as of the last update or commit; mostly the same */
	float seen_exitance[3];  /* of gi_context_def, likewise */
	bool uploaded;           /* texels are those of `seen` */
	SKY_BUFFERS(BUFFER_MEMBER)
} gi_sky_state;

/* As a hierarchy of directions; image NULL: of one colour. False: out of memory. */
bool sky_build(const struct sky_image *image, gi_hierarchy *out);
/* With the picture of now and the colour of def, which is added to it. */
bool sky_is_lit(const gi_context *gi, const gi_context_def *def);
/* Of its k-th node, W/m2. */
gi_vec4 sky_exitance(const gi_context *gi, uint32_t k);
void sky_brightest(const gi_context *gi, float out[3]); /* of all nodes */
/* Sets the sky's light to that of the definition and the picture, where the scene has a sky. */
void sky_relight(gi_context *gi);
/* What the scene shows from now on; after a commit. */
void sky_take(gi_context *gi);
/* Have both no sky, or one of the same patches? */
bool sky_is_same(const struct gi_scene *a, const struct gi_scene *b);
/* Takes the picture, NULL: none; on failure it is freed. */
gi_result sky_set_image(gi_context *gi, struct sky_image *image);
void sky_free(gi_context *gi);

/* For shaders that look up the picture (sky_image.glsl). Is there one to see? */
bool sky_shows_image(const gi_context *gi);
gi_result sky_upload_texels(gi_context *gi);
void sky_bind(const gi_context *gi, uint32_t program, int location);

#endif
