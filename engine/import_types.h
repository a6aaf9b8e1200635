/* What a scene of a file is: plain structs in metres, watts and seconds (import_file.h). */
#ifndef ENGINE_IMPORT_TYPES_H
#define ENGINE_IMPORT_TYPES_H

#include "mesh.h"
#include "texture.h"

typedef enum engine_scheme {
	ENGINE_SCHEME_BILINEAR, /* default */
	ENGINE_SCHEME_CATMULL_CLARK,
	ENGINE_SCHEME_LOOP, /* the mesh has triangles only */
} engine_scheme;

enum { ENGINE_SCENE_MAX_LEVELS = 8 };

typedef struct engine_scene_material {
	char *name;        /* never NULL; control characters are replaced by blanks */
	float rho[3];      /* linear RGB, each in [0, 1) */
	float mirror[3];   /* share of light that is reflected as by a mirror, [0, 1 - rho] */
	float glass[3];    /* share of refracted light that goes on, [0, 1 - rho]; 0 where it is a mirror */
	float index;       /* of refraction, of glass, 1..4 */
	float radiance[3]; /* L of one side, W/(m2 sr), >= 0; exitance E = pi L */
	/* Where there are textures, rho and radiance are their means: at a place they are the texture there times the
	 * factor. rho is times the colours of the mesh, too, where it has some; rho_factor is set for that without a
	 * texture as well, to 1 where the file gives no reflectance. */
	engine_texture_use rho_texture, radiance_texture;
	float rho_factor[3], radiance_factor[3];
	uint32_t uv_set; /* of a file with several sets of texture coordinates: the one of the textures */
	/* Alpha as coverage: alpha_factor times the texture's alpha times that of the mesh's colours. Faces of less
	 * than the cutoff in the mean are left out; cutoff 0: none are. */
	engine_texture_use alpha_texture;
	float alpha_factor, cutoff;
	bool double_sided; /* two back-to-back sides */
	bool used;         /* some face has it */
} engine_scene_material;

/* World from object: scale, then rotate, then translate. */
typedef struct engine_pose {
	float translation[3]; /* metres */
	float rotation[4];    /* unit quaternion x y z w */
	float scale[3];       /* each > 0: a mirrored node has its mesh mirrored instead, with its fronts kept */
} engine_pose;

typedef struct engine_scene_object {
	char *name;       /* never NULL or empty, unique in the scene ("a", "a#2", ...) */
	engine_mesh mesh; /* object space; face_materials number the scene's materials, never NULL */
	engine_pose rest; /* as the file places it, animation apart */
	engine_scheme scheme;
	uint32_t levels;     /* refinement steps, 0..ENGINE_SCENE_MAX_LEVELS, default 0 */
	bool double_sided;   /* one of its materials is */
	bool animated;       /* its pose depends on time */
	bool scale_animated; /* even the scale does: not a rigid motion */
	bool vanishes;       /* its scale is 0 at times, when engine_scene_pose() has no pose */
	bool deforms;        /* its vertices move with joints or morph targets (import_shape.h) */
	uint32_t node;       /* private, as all that follows */
	bool mirrored, baked;
	double offset[3], stretch[9];
	double rounding;            /* metres in object space: how far the file's coordinates may be off */
	struct import_shape *shape; /* of one that deforms */
} engine_scene_object;

typedef enum engine_light_type { ENGINE_LIGHT_POINT, ENGINE_LIGHT_SPOT, ENGINE_LIGHT_DIRECTIONAL } engine_light_type;

/* Files give lights in lumens (candela, lux) and emissive materials in nits, which are lumens too; the radiance of
 * materials is taken from the same numbers in W/(m2 sr). One factor for both keeps a bulb and its lampshade in
 * proportion, and pictures are exposed by what light there is. */
static const double ENGINE_WATTS_PER_LUMEN = 1;

/* A light without a surface. Where it is engine_scene_light_at() says. */
typedef struct engine_scene_light {
	char *name; /* never NULL */
	engine_light_type type;
	float intensity[3];             /* W/sr; of a directional one W/m2; 0..1e12 */
	float inner_angle, outer_angle; /* of a spot, radians: 0 <= inner < outer <= pi/2 */
	float range;                    /* metres; 0: none */
	bool animated;                  /* it moves with time */
	uint32_t node;                  /* private */
} engine_scene_light;

/* A picture of the sky, equirectangular as gi_set_sky_image takes it. */
typedef struct engine_sky {
	uint32_t width, height;
	float *radiance; /* 3 * width * height, linear, W/(m2 sr), top row first; NULL: no picture */
} engine_sky;

typedef struct engine_scene_camera {
	float eye[3], target[3], up[3]; /* world; target is 1 m ahead, up a unit vector across the view */
	float vertical_fov;             /* radians, (0, pi) */
} engine_scene_camera;

typedef struct engine_scene {
	engine_scene_material *materials;
	uint32_t material_count;
	engine_texture *textures;
	uint32_t texture_count;
	engine_scene_object *objects;
	uint32_t object_count; /* 0: an empty scene is none of our errors */
	engine_scene_light *lights;
	uint32_t light_count;
	engine_sky sky;
	double duration_s;    /* last key of the animations, 0 without */
	bool has_camera;      /* the first perspective camera of the scene */
	double origin[3];     /* metres: where the scene's 0 0 0 lies in the file; 0 but for scenes far off */
	char warning[4096];   /* one line about what was dropped or ignored, "" when nothing was */
	uint32_t camera_node; /* private */
	float camera_fov;     /* private */
	struct engine_scene_graph *graph; /* private: nodes and animation */
} engine_scene;

#endif
