/* One object: how it is built from its definition (patches, tree for rays, what is drawn), where it is and what it is
 * made of. Building it writes to nothing that threads share. */
#ifndef GI_OBJECT_H
#define GI_OBJECT_H

#include "bvh.h"
#include "deform.h"
#include "gpu.h"
#include "hierarchy.h"
#include "material.h"
#include "drawn_chart.h"
#include "drawn_surface.h"
#include "subsurface.h"

/* Of a material of an object (emitters.c). */
typedef struct object_emission {
	double area;    /* of its leaves, m2 */
	uint32_t steps; /* while it emits it is cut 2^steps times finer than others */
	bool ranked;    /* it emitted at the last commit (rank.h) */
} object_emission;

typedef struct object_record {
	uint32_t generation; /* of the handle that owns this place; odd while alive */
	bool committed;      /* part of the uploaded scene */
	bool moved;          /* since the last update */
	bool relit; /* emission began or ended, or it is cut finer or coarser for it, or black became not black */
	bool material_changed;
	bool hidden;   /* by the host */
	bool arrives;  /* it came or is shown again, since the last update: it has no rows yet */
	bool came;     /* since the last update: no row has seen it anywhere */
	bool reshapes; /* it has another shape from the next update on */
	bool reshaped; /* since the last update */
	gi_mobility mobility;
	bool grouped;     /* one of the static objects that are one source (statics.h) */
	bool was_grouped; /* before the last commit */
	/* Numbers of the row updates that last saw it so (gi_rows). */
	uint32_t moved_update, relit_update, reshaped_update;
	/* How many objects have its arrays, but for those that are each one's own (object_share.c). */
	uint32_t *sharers;
	char *name;
	gi_pose pose;
	float scale[3]; /* of the definition: the hierarchy has it applied */
	gi_material *materials;
	gi_specular *specular;          /* of each; NULL: none is a mirror or glass */
	bool leaf_materials;            /* a leaf has the material of its number (object_leaves.c) */
	gi_leaf_uvs *leaf_uvs;          /* of each leaf; NULL: nobody asked */
	gi_subsurface_links subsurface; /* of a translucent object */
	object_emission *emission;      /* of each */
	uint32_t material_count;
	gi_hierarchy hierarchy;
	gi_bvh bvh;
	gi_drawn_surface drawn;
	gi_drawn_chart chart;  /* of one with texture coordinates; its materials are those of the definition */
	gi_textures *textures; /* of each of these; NULL: none has any */
	uint32_t *by_size;     /* numbers of its primitives (rank.h) */
	gi_deform *deform;     /* NULL: its shape does not change */

	/* Place in the uploaded scene. */
	uint32_t lowest_rank, highest_rank; /* of its primitives (rank.h) */
	uint32_t slot, node_base, leaf_base, vertex_base, bvh_base, primitive_base, material_base, light_base;
	gi_vec4 world_lower, world_upper;
	bool trails; /* some row has not seen it move yet; the box of all places where it was since then: */
	gi_vec4 trail_lower, trail_upper;
	gi_vec4 ceiling;  /* of its leaves, largest E / (1 - rho) of rgb; largest 1 / (1 - rho) */
	bool plane;       /* all of it in one plane */
	bool overlaps;    /* and parts of it cover each other */
	uint64_t created; /* how many were created before it */
	/* Ids of its leaves and nodes begin here. They are the place's: an object that takes it gets them, if they are
	 * enough. */
	uint32_t leaf_id, node_id, leaf_ids, node_ids;
} object_record;

/* ---- building ---- */

/* For whom an object is built. */
typedef struct object_builder {
	const gi_log *log;
	gpu *gpu;        /* its limits hold for the object; NULL: no context, any thread */
	uint32_t number; /* of objects created before, for the host's progress callback; used where there is a gpu */
} object_builder;

gi_result object_build(const object_builder *builder, const gi_object_def *def, object_record *out);
/* Another one of the same shape, scale and materials, in no place: what does not change of the two is there once, until
 * both are freed. False: out of memory; *out is as object_free leaves it. */
bool object_share(const object_record *object, object_record *out);
void object_free(object_record *object);
/* Lengths and places of objects, metres, are at most this: area times B, and the products of three lengths that rays
 * take, stay in the range of floats. */
#define OBJECT_MAX_LENGTH 1e9f
/* Areas of leaves, m2, are at least this, so that products of three lengths are no denormals. */
#define OBJECT_MIN_AREA 1e-24f
/* Checks all of a definition that can be checked before it is refined. */
gi_result object_check_def(const gi_log *log, const gi_object_def *def);
/* About how many leaves an object would have; or exactly, by splitting its faces, false: memory ran out. */
double object_estimate_leaves(const gi_object_def *def);
bool object_count_leaves(const gi_object_def *def, uint64_t *count);
/* A size rounded up to two digits, as messages advise it. */
double object_rounded_size(double size);
bool object_normalise_pose(const gi_log *log, gi_pose *pose, const char *object);

/* ---- one that is built ---- */

/* Of one whose shape changes: takes another shape, unless it cannot be lit; brings all but what is drawn to the shape
 * that was set last; and what is drawn, true where that was not done yet. */
gi_result object_try_shape(const gi_log *log, object_record *object, const char *name, const gi_shape *shape);
void object_apply_shape(object_record *object);
bool object_refit_drawn(object_record *object);

bool object_measure_materials(object_record *object); /* their areas */
bool object_is_alive(const object_record *object);
/* Not hidden, not destroyed: what is not seen keeps its place until the next commit, and takes part in nothing. */
bool object_is_seen(const object_record *object);
uint32_t object_flags(const object_record *object); /* GI_OBJECT_ */
void object_place(object_record *object, gi_object_data *data);
/* Rows of world_from_object. */
void object_place_rows(const gi_pose *pose, gi_object_data *data);
void object_leave_trail(object_record *object); /* before it is placed elsewhere */
void object_include_box(const object_record *object, gi_vec4 *lower, gi_vec4 *upper); /* its own and its trail */
bool object_is_smooth(const object_record *object); /* something of it is a mirror or glass */
bool object_has_glass(const object_record *object);
/* Has this material of its definition textures to be drawn with? */
bool object_is_textured(const object_record *object, uint32_t material);
bool object_is_translucent(const object_record *object);
/* As shaders see them: of a translucent object each twice, and pixels are lit by the second, which is black. */
uint32_t object_material_slots(const object_record *object);
gi_material_data object_material_data(const object_record *object, uint32_t slot);
/* rho of a translucent object's is its medium's albedo. */
void object_take_albedo(const object_record *object, gi_material *material);

#endif
