/* Shadows of the lamps: a depth map per sample point on a lamp, drawn again when something moved. */
#ifndef GI_SHADOW_H
#define GI_SHADOW_H

#include "casters.h"
#include "occluder_mask.h"
#include "screen_rect.h"

struct gi_context;

/* Of one lamp: where in the picture it may be hidden, as a camera saw it last. */
typedef struct shadow_seen {
	bool known;
	float clip_from_world[16];
	uint32_t size[2];
	screen_rect rect;
} shadow_seen;

typedef struct gi_shadow {
	uint32_t program;
	gi_casters casters;
	gpu_depth_maps maps;
	uint32_t lamp_count, map_count;
	gi_lamp lamps[GI_LAMP_MAX];
	gpu_buffer uniforms;              /* lamps */
	occluder_mask masks[GI_LAMP_MAX]; /* where each lamp may be hidden */
	uint64_t *mask_rows;
	gpu_buffer mask_words;
	shadow_seen seen[GI_LAMP_MAX]; /* of the maps that are drawn */
	uint32_t drawn_lamps;          /* generation of gi_lamps that the maps show */
	bool drawn;                    /* the maps were drawn for the poses in drawn_rows */
	bool reshaped;                 /* a caster has had another shape since */
	uint64_t poses;                /* goes up where an object has another pose than in the picture before */
	float (*drawn_rows)[12];       /* by slot */
	struct lamp_box *boxes;        /* scratch: of the casters */
} gi_shadow;

/* Builds the casters of the committed scene. */
gi_result shadow_create(struct gi_context *gi, gi_shadow *shadow);

/* The object has another shape now; nothing where there are no casters yet. False when memory ran out. */
bool shadow_reshape(struct gi_context *gi, gi_shadow *shadow, uint32_t slot);

/* Brings lamps and maps up to the poses of the last update; nothing when they are. Leaves another framebuffer bound
 * when it drew. */
gi_result shadow_update(struct gi_context *gi, gi_shadow *shadow);

/* Where in the picture the lamp may be hidden from what is seen. Costs a look at every bounding sphere where camera or
 * shadows are others than before. */
screen_rect shadow_rect(const struct gi_context *gi, gi_shadow *shadow, uint32_t lamp, const float clip_from_world[16],
			const uint32_t size[2]);

/* Drops what depends on the committed scene; the program stays. */
void shadow_invalidate(struct gi_context *gi, gi_shadow *shadow);
void shadow_free(struct gi_context *gi, gi_shadow *shadow);

#endif
