/* Relume gi: dynamic radiosity for a game loop.
 *
 * The library computes the diffuse global illumination of moving objects on any OpenGL 4.5 device:
 *
 *     B_i = E_i + rho_i * sum_j F_ij V_ij B_j
 *
 * B radiosity and E exitance in W/m2 per RGB channel, rho reflectance in [0,1), F_ij the fraction of what leaves patch
 * i that would arrive at patch j with nothing in between, V_ij in [0,1] how much of j patch i sees. H = B - E over rho
 * is irradiance.
 *
 * How to use it:
 *
 *     gi_context_def def = gi_context_def_default();
 *     def.get_proc_address = find_gl; // calls glfwGetProcAddress or the like; an OpenGL 4.5 context is current
 *     gi_context *gi = NULL;
 *     gi_result result = gi_context_create(&def, &gi);
 *     ... gi_create_object() for everything, gi_commit() once ...
 *     every frame:  gi_set_pose() on what moves;  gi_update(gi, NULL);  gi_draw();  gi_get_report();
 *
 * Rules. One thread at a time per context, the OpenGL context it was created in current; gi_prepare_object takes none
 * and runs on any thread. The library leaves these pieces of OpenGL state changed: bound program, vertex array,
 * shader-storage buffer bindings 0..36 and uniform buffer bindings 0 and 1 (the indexed ones), texture units 0..43 with
 * their samplers, the GL_DISPATCH_INDIRECT_BUFFER binding. It takes nothing for granted: drawing state is set and given
 * back, whatever it was. Calls are not made between glBeginConditionalRender or glBeginTransformFeedback and their
 * ends. Errors that the host left in glGetError stay there, but for calls that end with GI_ERROR_OUT_OF_MEMORY.
 * Matrices are column-major float[16] as OpenGL and cglm have them, clip space as gi_view says. Lengths are metres, but
 * any unit does if it is the same everywhere; coordinates and positions are at most 1e9, areas of leaves at least
 * 1e-24. Surfaces emit and reflect on the side their normal points to (corners counter-clockwise seen from there);
 * their back is black and opaque.
 *
 * Where surfaces lie in one place, nearer than about 1e-6 of their coordinates, one is seen: a front before any back;
 * of those that look the same way one that emitted at gi_commit, else that of the object of less area, else of the one
 * created later; within an object the smaller polygon. A carpet lies on the floor, a lamp on the ceiling, a wall that
 * is there twice counts once. Leaves that are covered keep B and H as if they were on top; nothing of them arrives
 * anywhere.
 *
 * Errors. Functions return a gi_result; whatever is not GI_OK left the scene as it was, and one line that says what to
 * do about it went to the message callback. All but those that only set and get values need the OpenGL context current
 * and say GI_ERROR_WRONG_CONTEXT where it is not; a context that shares objects with it is another one.
 */
#ifndef GI_GI_H
#define GI_GI_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Before what the library exports. GI_SHARED: it is a DLL; CMake's gi::gi_shared sets it. */
#if defined(_WIN32) && defined(GI_BUILDING)
#define GI_API __declspec(dllexport)
#elif defined(_WIN32) && defined(GI_SHARED)
#define GI_API __declspec(dllimport)
#elif defined(__GNUC__) && defined(GI_BUILDING)
#define GI_API __attribute__((visibility("default")))
#else
#define GI_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define GI_VERSION_MAJOR 0
#define GI_VERSION_MINOR 1
#define GI_VERSION_PATCH 0
#define GI_VERSION (GI_VERSION_MAJOR * 10000 + GI_VERSION_MINOR * 100 + GI_VERSION_PATCH)

/* GI_VERSION of the library that the program runs with, which may be another than that of this header. */
GI_API uint32_t gi_version(void);

/* ---- results ----------------------------------------------------------------------------------------------------- */

/* Name, text: one table, so that they cannot drift. */
#define GI_RESULTS(X)                                                                                                  \
	X(GI_OK, "success")                                                                                            \
	X(GI_ERROR_INVALID_ARGUMENT, "an argument is out of its range")                                                \
	X(GI_ERROR_INVALID_DEF, "a definition was not made by its _default function")                                  \
	X(GI_ERROR_INVALID_HANDLE, "a handle is stale, was never valid or is another context's")                       \
	X(GI_ERROR_INVALID_GEOMETRY, "the geometry cannot be used")                                                    \
	X(GI_ERROR_INVALID_MATERIAL, "a value of a material is out of its range")                                      \
	X(GI_ERROR_INVALID_POSE, "the pose is not a rotation and a translation")                                       \
	X(GI_ERROR_NOT_COMMITTED, "there was no gi_commit yet, or no gi_update since")                                 \
	X(GI_ERROR_NO_OPENGL_45, "no OpenGL 4.5 context is current")                                                   \
	X(GI_ERROR_SHADER, "a shader did not compile")                                                                 \
	X(GI_ERROR_OUT_OF_MEMORY, "out of memory")                                                                     \
	X(GI_ERROR_WRONG_CONTEXT, "the OpenGL context of the gi_context is not current")                               \
	X(GI_ERROR_FRAMEBUFFER, "the bound framebuffer cannot be drawn into")

#define GI_RESULT_ENUM(name, text) name,
typedef enum gi_result { GI_RESULTS(GI_RESULT_ENUM) GI_RESULT_COUNT } gi_result;

/* The text of the table above; never NULL. */
GI_API const char *gi_result_text(gi_result result);

/* Receives one line, without a newline, for every error and warning. `result` says how severe it is: what the call
 * fails with, or GI_OK of a warning. The text is gone when the callback returns. */
typedef void gi_message_fn(gi_result result, const char *message, void *user);

/* Hears that step `done` of `total` of something long begins; total 0: how many there are is not known. `what` says
 * what it is in a few words for people, e.g. "compiling shaders", and is gone when the callback returns. Called by
 * gi_context_create, gi_create_object, gi_commit, by a gi_update that builds every row after a commit, and where
 * compute shaders are compiled later. It may draw and show a frame if it leaves the buffer and texture bindings
 * alone that the library uses (see Rules); it must not call the library. Nothing stops what has begun, as no driver
 * takes back what it computes: a program that must end within a second ends without gi_context_destroy
 * (demos/interrupt.c). */
typedef void gi_progress_fn(const char *what, uint32_t done, uint32_t total, void *user);

/* Where the library's memory comes from. NULL for all functions, the default: malloc. The library asks for
 * everything of its own here, on the thread that called it; what OpenSubdiv, the C library and the driver take for
 * themselves it does not. An update of a scene in motion asks for nothing once it has seen as much move before.
 * Sizes are bytes; memory is aligned as malloc's is. */
/* NULL: out of memory. */
typedef void *gi_allocate_fn(size_t size, void *user);
/* NULL: memory is as it was. */
typedef void *gi_reallocate_fn(void *memory, size_t old_size, size_t new_size, void *user);
/* size: as last allocated; memory is never NULL. */
typedef void gi_free_fn(void *memory, size_t size, void *user);

typedef struct gi_allocator {
	gi_allocate_fn *allocate;
	gi_reallocate_fn *reallocate;
	gi_free_fn *free;
	void *user; /* handed to all three */
} gi_allocator;

/* ---- handles ----------------------------------------------------------------------------------------------------- */

typedef struct gi_context gi_context;

/* By value; zero is no object. The handle of a destroyed object, or of another context's, is detected, never
 * followed. */
typedef struct gi_object {
	uint32_t index1;
	uint32_t generation;
	uint32_t context; /* no two contexts of a program have the same */
} gi_object;

/* ---- context ----------------------------------------------------------------------------------------------------- */

typedef void (*gi_proc)(void);
/* Finds an OpenGL function; NULL: there is none of this name. */
typedef gi_proc gi_get_proc_address_fn(const char *name, void *user);

/* Whether a row also looks at what lies beyond all objects. */
typedef enum gi_sky {
	GI_SKY_AUTO, /* a sky unless one closed object that does not move encloses the others (default) */
	GI_SKY_OFF,  /* none: rows close without it; right for rooms closed by several objects, wrong for open scenes */
	GI_SKY_ON,
} gi_sky;

typedef struct gi_context_def {
	/* Required. Asked by gi_context_create alone; each context keeps the functions that it was given. */
	gi_get_proc_address_fn *get_proc_address;
	void *get_proc_user;      /* handed to get_proc_address */
	gi_message_fn *message;   /* default NULL: messages go to stderr */
	gi_progress_fn *progress; /* default NULL: nobody hears of it */
	void *user;               /* handed to message and progress */
	gi_allocator allocator;   /* default all NULL: malloc; copied */
	/* Copied; *.comp etc. are read from here; default NULL: those built in */
	const char *shader_directory;

	/* How fine. A source node is taken whole by a row once its form factor is below row_tolerance; (1e-6, 1],
	 * default 0.01. Entries per leaf grow about as 1/row_tolerance, the error falls with it. */
	float row_tolerance;
	/* Emitters are cut at row_tolerance / this, less where they cover more than 1 / this of the scene's area:
	 * not at all finer from a half on; >= 1, default 20 */
	float emitter_refinement;
	uint32_t emitter_samples; /* visibility rays per emitter entry that is partly hidden; 4..16, default 16 */

	/* The same for leaves whose form factor exceeds row_tolerance; up to four times as many, 16 at most, where
	 * it exceeds 0.04; 1..16, default 4 */
	uint32_t near_samples;

	/* When the solve stops: it is certain that at every leaf, channel by channel, B is off by at most
	 * solve_tolerance * (R + largest R / 100000). R = B - E is the light that the leaf reflects, the largest
	 * that of all leaves: what lamps give does not count, and where it is dark the light there does, down to a
	 * hundred-thousandth of the brightest place. (0, 1], default 0.1: the worst leaf is then off by 1 % in
	 * truth, others by far less. Single precision ends between 1e-6 and 1e-4 times gi_report.amplification, the
	 * higher the darker the darkest place: below that the solve ends with GI_OUTCOME_ROUNDING, and the report
	 * has the bound. */
	float solve_tolerance;
	/* Per frame, 1..1000, default 100. Few sweeps make no light: B stays within [E, largest E / (1 - rho)]
	 * whatever they leave to do, and where light from before is no help the solve starts from B = E by itself. */
	uint32_t max_sweeps;

	gi_sky sky;
	float sky_exitance[3]; /* pi * radiance of the sky, W/m2; 0..1e12, default 0 */

	/* Lamp polygons that gi_draw lights per pixel, with soft shadows; 0..32, default 32. The rest lights through
	 * the leaves: 0 makes drawing several times cheaper on a software renderer, and shadows as coarse as the
	 * leaves. */
	uint32_t pixel_lamps;

	/* Texels a side of the depth maps that those lamps' shadows come from, 16 maps for one lamp or two; 64..4096,
	 * default 512. Shadows are off by up to three texels: by half a per cent of the distance from the lamp where
	 * casters fill 60 degrees of its view. Twice as many take four times the memory, 16 MiB at the default, and
	 * up to four times the time when something moves. */
	uint32_t shadow_map_size;

	/* Shadows of curved objects are cast by what is drawn of them instead of by their leaves: as round as they
	 * look, and a detailed mesh by itself, not by its cage. A frame in which something moves draws as many more
	 * triangles into every map, 16 times as many at the default draw_levels. Default false. */
	bool fine_shadows;

	/* Photons that each emitting object sends through each mirror or glass object, for caustics; 0..2^20, default
	 * 16384. A photon takes some four rays, when something moved that it meets. 0: none; emitters are then found
	 * by what rows see in mirrors and glass, as other surfaces are: right on the whole, but leaf by leaf mostly
	 * noise. */
	uint32_t caustic_photons;

	/* How many leaves an update that solved looks at to estimate the error of its rows
	 * (gi_report.sampling_estimate); 0..65536, default 0: none, at no cost. Each takes 512 rays; 256 leaves are
	 * a good number. */
	uint32_t estimate_leaves;

	/* Most a single GPU buffer may take, MiB; default 0: what the renderer binds, mostly 2048. Rows, 16 bytes an
	 * entry, are what comes near it; scenes that need more end with GI_ERROR_OUT_OF_MEMORY, told
	 * by gi_commit or, of rows, by gi_update before a ray is traced. All buffers together take
	 * about three times the largest. */
	uint32_t max_buffer_mib;

	bool profile;      /* measure ms per pass with GPU timers; default true */
	uint32_t internal; /* set by gi_context_def_default */
} gi_context_def;

GI_API gi_context_def gi_context_def_default(void);

/* Hands the shaders of every scene to the driver and does not wait for them: drivers that compile on threads of their
 * own do so while the host loads its scene, and the first gi_commit waits for what is left. Shaders that are not there
 * (shader_directory) fail here with GI_ERROR_SHADER, those that do not compile fail in gi_commit. On failure *out is
 * NULL.
 *
 * The rest is compiled when first wanted: what updates take where something moves, once an object is created that is
 * not GI_MOBILITY_STATIC; what static objects take, and commits that keep rows, by the first such gi_commit; by the
 * first gi_update with a budget or with estimate_leaves, by gi_draw for each kind of picture (mode, overlay, number of
 * lamps) and by gi_trace_paths. A driver may also put off its
 * part to the first use, as Mesa's llvmpipe does. Who wants no hitch later calls each once behind the loading
 * screen. Drivers keep what they compiled, so that the second start is fast (Mesa: ~/.cache/mesa_shader_cache). */
GI_API gi_result gi_context_create(const gi_context_def *def, gi_context **out);

/* The settings in force: those of creation, and what was set since. shader_directory is the library's copy. */
GI_API gi_result gi_get_context_def(const gi_context *gi, gi_context_def *out);

/* Other values than those of gi_context_def, with the same ranges; the light becomes what a context created with them
 * would have. What the next gi_update then takes, whatever its budget: */

/* A solve, from the light that is there. */
GI_API gi_result gi_set_solve(gi_context *gi, float solve_tolerance, uint32_t max_sweeps);

/* Another colour: a solve, no rays. Every row anew where the sky begins to shine or ceases to: a black one is cut
 * coarser. `sky` is asked by the next gi_commit; only where a sky comes or goes that keeps no rows. */
GI_API gi_result gi_set_sky(gi_context *gi, gi_sky sky, const float exitance[3]);

/* Light from a picture of the sky, added to sky_exitance. radiance: 3 * width * height floats, linear RGB, W/m2/sr,
 * each in 0..3e11, copied; NULL: no picture, as at first. Sides are 1..32768 texels. The picture goes all round
 * (equirectangular): its first row is what lies straight above, along +y, its last one what lies below; columns go once
 * round from left to right, the middle one towards -z, as a glTF camera looks. A gradient is a picture one texel wide.
 * rotation: a quaternion x y z w that turns all this, world from picture; NULL: none.
 *
 * Rows have the means of some 11 degrees, and where a patch has more than a sixteenth of all the sky's light (a sun),
 * patches down to 0.18 degrees: edges of its shadows are as sharp as leaves are fine. What gi_draw shows in mirrors and
 * gi_trace_paths see the picture itself, averaged down to 2048 x 1024 where it is larger. Light below the sun's edge in
 * a budget's bounds counts as the sun's: stale_bound is large under a bright sun.
 *
 * The next gi_update takes a solve and no rays, as for gi_set_sky; where other patches than before become bright, or
 * the sky begins or ceases to shine, it commits by itself and builds every row. This call takes 50 to 200 ms of
 * processor time. GI_ERROR_INVALID_ARGUMENT where a value is out of range; needs no OpenGL. */
GI_API gi_result gi_set_sky_image(gi_context *gi, const float *radiance, uint32_t width, uint32_t height,
				  const float rotation[4]);

/* Every row anew, as after a gi_commit that keeps none; nothing where the values are those in force. */
GI_API gi_result gi_set_rows(gi_context *gi, float row_tolerance, float emitter_refinement, uint32_t emitter_samples,
			     uint32_t near_samples);

/* A solve: what is drawn per pixel is left out of the light of leaves. */
GI_API gi_result gi_set_pixel_lamps(gi_context *gi, uint32_t pixel_lamps);

/* Nothing more than gi_context_def says of it; where nothing else changes, an update at rest estimates nothing. */
GI_API gi_result gi_set_estimate_leaves(gi_context *gi, uint32_t estimate_leaves);

/* Compiles all shaders again, those of shader_directory as they are now: for work on shaders while a program runs.
 * The next gi_update builds everything anew. GI_ERROR_SHADER where one does not compile: then none is exchanged. */
GI_API gi_result gi_reload_shaders(gi_context *gi);

/* Frees everything, its OpenGL objects too. NULL is fine. Where its OpenGL context is not current, or gone already,
 * what it holds there is left to that context, with a line (GI_ERROR_WRONG_CONTEXT). */
GI_API void gi_context_destroy(gi_context *gi);

/* ---- objects ----------------------------------------------------------------------------------------------------- */

typedef struct gi_material {
	float rho[3];      /* reflectance, linear RGB, each in [0,1) */
	float exitance[3]; /* E, W/m2, 0..1e12; a glTF emissive radiance L is E = pi L */
} gi_material;

/* What a material is besides: a mirror or glass. All 0: neither.
 *
 * Both are smooth: normals between their leaves are interpolated, where the leaves meet at less than 40 degrees.
 * What emitters send through them falls on other surfaces as caustics, as fine as gi_context_def.caustic_photons are
 * many, leaf by leaf and, where gi_draw lights per pixel, pixel by pixel. What other surfaces reflect, and the sky,
 * lights leaves by way of them too: each ray of a row that ends on one goes on, by up to 16 surfaces, and what it finds
 * counts for all of its entry, so that leaves beside a large mirror are some 3 % noisy, unbiased (docs/accuracy.md).
 * Whenever something moves all of these rays are followed anew. Channel by channel rho + reflectance and rho +
 * transmittance are at most 1; what is missing is absorbed. A material has one of the two, not both; what a mirror
 * reflects by its rho is seen directly alone, not in other mirrors. */
typedef struct gi_specular {
	float reflectance[3]; /* of a mirror, at any angle, each in [0,1]; its back is black */
	/* Of glass: share of the light refracted at a crossing that goes on, each in [0,1]. How much is refracted
	 * and how much reflected Fresnel's equations say; it takes a closed object */
	float transmittance[3];
	/* Of refraction behind the surface, over that before it; 1..4 for glass, window glass 1.5 */
	float index;
} gi_specular;

/* What an object is filled with: light that enters at one leaf is scattered below the surface and leaves at others, by
 * the dipole of Jensen, Marschner, Levoy and Hanrahan (A Practical Model for Subsurface Light Transport, 2001):
 *
 *     B_i = E_i + sum_j S_ij H_j,    S_ij = 1/A_i int_i int_j R_d(|x - y|) dy dx
 *
 * R_d is that of a half space, by the straight distance, whatever the object's shape; where this would give back more
 * than a half space does (thin sheets, creases), less is taken. All light that arrives enters: reflection by the outer
 * surface is not in it. Lengths are those of the world, scale applied; coefficients are per metre. Where all three
 * colours have a mean free path 1 / (scattering + absorption) far below the size of leaves the object is diffuse, of
 * the half space's reflectance; where it is far above the size of the object, nearly black: what passes through is
 * lost. gi_draw shows all its light as that of leaves, so GI_MODE_DIRECT shows none. */
typedef struct gi_subsurface {
	float scattering[3]; /* reduced scattering coefficient sigma_s' = (1 - g) sigma_s of r g b, 1/m; 0..1e9 */
	float absorption[3]; /* absorption coefficient sigma_a, 1/m; 0..1e9 */
	float index;         /* of refraction, over that outside; 1..2.5, marble 1.5, milk and skin 1.3 */
} gi_subsurface;

/* World from object: rotate, then translate. A scale belongs to gi_object_def, or gi_set_scale. */
typedef struct gi_pose {
	float position[3]; /* metres, each within 1e9 of 0 */
	float rotation[4]; /* quaternion x y z w; normalised by the library, must not be zero */
} gi_pose;

GI_API gi_pose gi_pose_identity(void);

typedef enum gi_scheme {
	GI_SCHEME_BILINEAR, /* keeps the cage's shape (default) */
	GI_SCHEME_CATMULL_CLARK,
	GI_SCHEME_LOOP, /* triangles only */
} gi_scheme;

typedef enum gi_boundary {
	GI_BOUNDARY_EDGE_AND_CORNER, /* boundary edges and corners stay sharp (default) */
	GI_BOUNDARY_EDGE_ONLY,       /* corners are rounded */
} gi_boundary;

/* A straight line along which the leaves of a face are cut, where another surface stands on it or ends close above it:
 * a leaf that is partly under a wall has one B for both sides of it. */
typedef struct gi_leaf_cut {
	uint32_t face;
	/* Object space as gi_object_def.positions; what is off the face's plane is projected to it */
	float from[3], to[3];
	/* Another surface stands on it: what is drawn does not blend the light of its sides; default false */
	bool parts;
} gi_leaf_cut;

/* What an object is to rows. The light is the same within the row tolerance; what differs is what it costs. Static
 * objects hang below common nodes: from afar many of them are one, so that rows grow with the logarithm of their
 * number. Every row that faces a movable object has entries for it alone, so that it may move at the price of those.
 *
 * A static object may move, come, go, be hidden or relit all the same, which costs what a moving one costs; once it was
 * given another pose after a commit it is movable. The update after such a move, or after one was hidden, shown or
 * destroyed, commits by itself: that takes time with the size of the scene, and what gi_commit says holds of it. */
typedef enum gi_mobility {
	GI_MOBILITY_AUTOMATIC, /* static until it is first moved, where there are many objects (default) */
	GI_MOBILITY_MOVABLE,
	GI_MOBILITY_STATIC,
} gi_mobility;

/* Where there are at least so many objects that are static or never moved, hidden ones too, GI_MOBILITY_AUTOMATIC is
 * static; with fewer common nodes save little, and it is movable. gi_commit counts. */
#define GI_AUTOMATIC_OBJECTS 64

/* One object: a control cage, refined by OpenSubdiv into its leaves. All arrays are copied before gi_create_object
 * returns. */
typedef struct gi_object_def {
	const char *name; /* default NULL; for messages: the first 127 bytes */

	const float *positions; /* 3 * vertex_count */
	uint32_t vertex_count;
	/* face_count corners per face, each >= 3; NULL: all 4. Of bilinear faces those that are not convex are cut
	 * into triangles; one that crosses itself is GI_ERROR_INVALID_GEOMETRY */
	const uint32_t *face_counts;
	uint32_t face_count;
	const uint32_t *indices; /* index_count vertex numbers, faces back to back */
	uint32_t index_count;
	const uint32_t *face_materials;  /* face_count numbers below material_count; NULL: all 0 */
	const uint32_t *crease_vertices; /* 2 * crease_count: edges */
	const float *crease_sharpness;   /* crease_count, >= 0, 10 and more is sharp for ever */
	uint32_t crease_count;

	gi_scheme scheme;
	gi_boundary boundary;
	uint32_t levels; /* refinement steps, 0..8, default 0 */
	/* > 0: instead of levels, edges of leaves are about this long at most, metres; default 0. Each face of a
	 * bilinear cage is split for itself: quads into grids of n x m cells, triangles at their longest edges.
	 * Smooth schemes refine alike everywhere, until the mean leaf edge is at most this, 8 times at most. More
	 * leaves than the renderer holds are GI_ERROR_INVALID_GEOMETRY, before any work. */
	float leaf_size;
	/* With leaf_size and a bilinear cage: face_count, of single faces, 0: leaf_size; NULL: none */
	const float *leaf_sizes;
	/* Likewise: leaf_cut_count; flat convex faces are cut along them; gi_choose_leaves finds such lines */
	const gi_leaf_cut *leaf_cuts;
	uint32_t leaf_cut_count;
	/* Smooth schemes are drawn this many steps finer than the leaves, 0..4, default 2; fewer where that would be
	 * more than 200,000 faces, 8 steps in all, or than there is memory for */
	uint32_t draw_levels;

	const gi_material *materials; /* material_count; NULL: one of rho 0.5 */
	uint32_t material_count;
	const gi_specular *specular; /* material_count, or one without materials; default NULL: no mirrors, no glass */
	/* One medium, of the whole object, for good; default NULL: none. Each rho is then the diffuse reflectance of a
	 * half space of it, at most 0.9999, whatever materials say, now and in gi_set_material; none is a mirror or
	 * glass. Takes half a millisecond a leaf to make and some 5 KB to keep. */
	const gi_subsurface *subsurface;
	gi_mobility mobility; /* default automatic */
	bool double_sided;    /* adds a back-to-back side that reflects too; default false */

	float scale[3]; /* default 1 1 1; not zero, not negative */
	gi_pose pose;

	/* A detailed mesh to draw instead of the cage's surface, lit through it (a scan and its simplified cage); NULL:
	 * none. */
	const float *draw_positions; /* 3 * draw_vertex_count, object space */
	uint32_t draw_vertex_count;
	const uint32_t *draw_indices; /* draw_index_count, three a triangle */
	uint32_t draw_index_count;

	/* Neighbouring leaves share light at their common corners where their normals differ by less than this,
	 * degrees; 0..180, default 0: 40, or 70 with a detailed mesh, whose cage has edges that it has not */
	float light_edge;
	/* For hosts that draw it themselves (gi_map_vertices): gi_draw leaves it out, and nothing is built or kept for
	 * that. It gives, takes and blocks light like any other. Default false */
	bool undrawn;
	/* Its shape may change: gi_set_positions, gi_set_joints, gi_set_scale ("moving skin" below). It is movable
	 * whatever mobility says, GI_MOBILITY_STATIC is an error; no subsurface. Default false */
	bool deforms;
	/* Four joints of each vertex of the cage, and likewise of the mesh that is drawn, for gi_set_joints: 4 *
	 * vertex_count numbers below joint_count and their weights, >= 0 and of any sum, by which they are divided. A
	 * vertex whose weights are all 0 follows no joint. NULL, the default: none does */
	const uint32_t *joints, *draw_joints;
	const float *joint_weights, *draw_joint_weights;
	uint32_t joint_count;
	/* Each leaf is a material of its own, at first that of its face: material m of gi_set_material and the like is
	 * then leaf m, and gi_set_leaf_materials sets many. What a texture, or a colour of vertices, gives each leaf
	 * in the mean. Takes some 100 bytes a leaf; default false. */
	bool leaf_materials;
	/* 2 * index_count: texture coordinates u v of the corners of faces, in the order of indices, for
	 * gi_get_leaf_uvs and, without a draw mesh, gi_set_textures; default NULL. Takes 20 bytes a triangle and 8 a
	 * vertex of what is drawn */
	const float *uvs;
	/* The same of the mesh that is drawn, 2 * draw_index_count: of the corners of its triangles, in the order of
	 * draw_indices, for gi_set_textures; and of each triangle the material whose textures it has, draw_index_count
	 * / 3 numbers below material_count. Default NULL: no coordinates; all 0 */
	const float *draw_uvs;
	const uint32_t *draw_face_materials;

	uint32_t internal;
} gi_object_def;

GI_API gi_object_def gi_object_def_default(void);

/* Refines the cage (CPU). The object takes part after the next gi_commit. On failure *out is zero. Faces with the
 * corners of an earlier one in the same order round, wherever their list begins, are left out, with a warning that
 * counts them: by position, or by number where there are creases. */
GI_API gi_result gi_create_object(gi_context *gi, const gi_object_def *def, gi_object *out);

/* Another object of the shape, scale, materials, textures, mobility and name that `of` has at present, at `pose` and
 * not hidden: the chairs of a hall. It takes a microsecond or two and 1 KB of host memory: refinement, hierarchy,
 * trees, subsurface links and drawn surface are there once for all that came of one object; the last that is destroyed
 * frees them, either may go first. All else is as if gi_create_object had made it, to the bit: it takes part after the
 * next gi_commit, and pose, materials, textures, mobility may be set for each. On the GPU it takes what any object
 * takes, but that 8,000 vertices that are drawn, and more, are there once.
 *
 * With leaf_materials each has values of its own, 40 bytes a leaf. One of an object that deforms begins with its shape
 * of now, that was set last, and goes its own way: some 1.3 KB a leaf for what a shape takes. A scale is part of the
 * shape: another one takes gi_create_object, or gi_set_scale on what deforms. On failure *out is zero. */
GI_API gi_result gi_create_instance(gi_context *gi, gi_object of, gi_pose pose, gi_object *out);

/* An object built ahead, without a context: what takes time of a creation, refinement, hierarchy, trees and what is
 * drawn (1.2 s for a cage of 100,000 triangles), behind the host's back. */
typedef struct gi_prepared_object gi_prepared_object;

/* Builds one on any thread, no OpenGL context needed; as many threads at once as wanted, beside one that uses a
 * gi_context. They share nothing: what the definition points to is only read, so that several threads may be given
 * the same one, and is the caller's again when the call returns. Errors and messages as of gi_create_object, on the
 * thread that calls, to `message` with `user`; NULL: to stderr. `allocator`, NULL: malloc, is called on that thread,
 * and later wherever parts of the object are freed, in a context that has another one too. On failure *out is NULL.
 * The object belongs to no thread: one at a time may use it. */
GI_API gi_result gi_prepare_object(const gi_object_def *def, gi_message_fn *message, void *user,
				   const gi_allocator *allocator, gi_prepared_object **out);

/* gi_create_object from what was prepared: the same object to the bit, in microseconds. Called where gi is used.
 * Takes *prepared and makes it NULL; on failure that is left as it was, and *out is zero. GI_ERROR_INVALID_GEOMETRY
 * where it has more leaves than this context's renderer holds, which nobody knew before. */
GI_API gi_result gi_create_prepared_object(gi_context *gi, gi_prepared_object **prepared, gi_object *out);

/* Of one that no context took; on any thread. NULL is fine. */
GI_API void gi_free_prepared_object(gi_prepared_object *prepared);

/* How fine a whole scene is cut, where the host has no sizes of its own. */
typedef struct gi_leaf_choice_def {
	uint32_t leaves;      /* about so many in all; default 0: 4,000 on a software renderer, 20,000 on others */
	float leaf_size;      /* > 0: this size on large objects instead, metres; default 0 */
	uint32_t most_leaves; /* more are refused; default 100,000 */
	/* Small objects and lamps get leaves smaller by up to this factor; (0, 1], default 0.25 */
	float finest;
	/* Of each object: it will move, and where it stood no edge of light may stay; NULL: none does */
	const bool *moves;
	/* Faces are cut below edges that end closer above them than this share of a leaf; [0, 1], default 0.5 */
	float contact;
	uint32_t internal;
} gi_leaf_choice_def;

GI_API gi_leaf_choice_def gi_leaf_choice_def_default(void);

/* What was chosen. */
typedef struct gi_leaf_choice {
	uint32_t leaves;  /* of all objects given */
	float leaf_size;  /* of the largest, metres */
	float least_size; /* of the smallest and of lamps, metres */
	uint32_t cuts;    /* lines along which faces are cut */
	void *memory;     /* what the definitions' leaf_sizes and leaf_cuts point to */
} gi_leaf_choice;

/* Chooses leaf sizes for a scene from its bounds, areas and lamps: sets leaf_size, leaf_sizes, leaf_cuts and
 * leaf_cut_count of every definition whose levels and leaf_size are 0; others keep theirs and are counted. An object,
 * or a part of a mesh that shares no vertices with the rest, gets leaves the smaller the smaller it is. Where faces of
 * bilinear cages cross, touch or come close to one another in the poses given, moving objects at rest, they are cut
 * along the lines of contact: one leaf on both sides of a wall would light the dark one.
 *
 * Create the objects next, then gi_free_leaf_choice. GI_ERROR_INVALID_ARGUMENT, before any work, with a line that says
 * how many leaves there would be and which size fits, where they are more than most_leaves; whatever gi_create_object
 * would say of a definition. On failure *out is zero and the definitions are as they were. */
GI_API gi_result gi_choose_leaves(gi_context *gi, const gi_leaf_choice_def *def, gi_object_def *objects, uint32_t count,
				  gi_leaf_choice *out);

/* The definitions' leaf_sizes and leaf_cuts are gone with it. A zero one is fine. */
GI_API void gi_free_leaf_choice(gi_leaf_choice *choice);

/* From the next gi_update on the object is not there, as if it were hidden; the next gi_commit gives its place away. */
GI_API gi_result gi_destroy_object(gi_context *gi, gi_object object);

GI_API bool gi_object_is_valid(const gi_context *gi, gi_object object);

/* Values, free to change every frame; they take effect in the next gi_update. Rows follow by themselves. */
GI_API gi_result gi_set_pose(gi_context *gi, gi_object object, gi_pose pose);
GI_API gi_result gi_get_pose(const gi_context *gi, gi_object object, gi_pose *out);
GI_API gi_result gi_set_material(gi_context *gi, gi_object object, uint32_t material, gi_material value);
GI_API uint32_t gi_material_count(const gi_context *gi, gi_object object); /* 0 of a stale handle */
GI_API gi_result gi_get_material(const gi_context *gi, gi_object object, uint32_t material, gi_material *out);
GI_API gi_result gi_set_specular(gi_context *gi, gi_object object, uint32_t material, gi_specular value);
GI_API gi_result gi_get_specular(const gi_context *gi, gi_object object, uint32_t material, gi_specular *out);

/* Where on its object's faces a leaf lies. */
typedef struct gi_leaf_uvs {
	/* Texture coordinates at its corners a b c d, a triangle repeats its third; 0 without gi_object_def.uvs. Linear
	 * in the triangles a b c and a c d: a texture's mean over these two is the leaf's. Of a flat face of more than
	 * three corners, coordinates are linear in the triangles from its first corner to the others. */
	float uvs[4][2];
	uint32_t face; /* of gi_object_def; of the second side too */
} gi_leaf_uvs;

/* Of an object made with uvs or leaf_materials; leaves in the order of gi_read_leaves. Copies up to `capacity`; uvs may
 * be NULL to ask for the count. */
GI_API gi_result gi_get_leaf_uvs(const gi_context *gi, gi_object object, gi_leaf_uvs *uvs, uint32_t capacity,
				 uint32_t *count);

/* Reflectance and exitance of `count` leaves from `first` on, of an object made with leaf_materials; they take effect
 * in the next gi_update, as gi_set_material: a solve, and rows where something begins or ceases to shine or to reflect.
 * Nothing is set where one value is out of range. */
GI_API gi_result gi_set_leaf_materials(gi_context *gi, gi_object object, uint32_t first, uint32_t count,
				       const gi_material *values);

/* ---- textures in the picture ------------------------------------------------------------------------------------- */

/* Light goes from leaf to leaf, and what leaves reflect and emit their materials say: means over a texture, where the
 * host sets them (gi_object_def.leaf_materials). gi_draw shows such means too, unless it is given the textures: then
 * each pixel has the texel's own reflectance and exitance, lit by the same light,
 *
 *     L = (E + rho H) / pi,    rho = factor * base colour,    E = factor * emissive
 *
 * H that of the leaves and of what lights per pixel. The light does not change by it, and a scene without textures pays
 * nothing. One with some draws a part for each material that has some, and keeps 16 bytes more a pixel. Not by texels:
 * what is seen in mirrors and through glass has the means of leaves, so has what a shining surface gives to others, and
 * what alpha cuts out is whole in shadows and heat maps (gi_overlay). */
typedef struct gi_textures {
	/* OpenGL names of textures with the target GL_TEXTURE_2D, complete, with floats or normalised integers: sRGB
	 * where they hold sRGB, for shaders see what is sampled. 0: none, that is the material's. */
	uint32_t base_color; /* rgb rho, taken to [0, 1]; a coverage, for alpha_cutoff */
	uint32_t emissive;   /* rgb E, taken as 0 below it */
	/* Names of sampler objects; 0: filters and wrapping are the texture's own */
	uint32_t base_color_sampler, emissive_sampler;
	float base_color_factor[4]; /* each in [0, 1]; default 1 */
	float emissive_factor[3];   /* W/m2, each in 0..1e12; default 1. Of a glTF radiance L it is pi L */
	/* u and v in the texture = rows times (u, v, 1) of the object's coordinates; default 1 0 0, 0 1 0. OpenGL's
	 * (0, 0) is the first texel that was uploaded, as glTF has it of rows from the top */
	float base_color_transform[2][3], emissive_transform[2][3];
	/* > 0: what has less coverage is not drawn: glTF's alphaCutoff. It casts shadows and takes light as if it were.
	 * Default 0: all is drawn */
	float alpha_cutoff;
	uint32_t internal;
} gi_textures;

GI_API gi_textures gi_textures_default(void);

/* Of a material of the object's definition, by face_materials, or draw_face_materials of its draw mesh: leaf_materials
 * or not. NULL, or names of 0: none again. The next gi_draw shows it, no gi_commit and no gi_update are needed; other
 * values are free to come every frame, first textures and none again cost that gi_draw the upload of what is drawn.
 *
 * The textures stay the host's: what it writes into them is seen. One that it deletes is taken back first, unless the
 * object was destroyed: gi_draw says GI_ERROR_INVALID_ARGUMENT and draws nothing while one is missing. Setting them
 * needs the OpenGL context current, for names are looked up. GI_ERROR_INVALID_ARGUMENT: a value is out of its range, a
 * name is none of this OpenGL context or of integers, the object has no coordinates (gi_object_def.uvs, draw_uvs) or
 * gi_subsurface, or fewer materials. */
GI_API gi_result gi_set_textures(gi_context *gi, gi_object object, uint32_t material, const gi_textures *textures);
/* What is set; the defaults where there are none. */
GI_API gi_result gi_get_textures(const gi_context *gi, gi_object object, uint32_t material, gi_textures *out);

/* ---- moving skin ------------------------------------------------------------------------------------------------- */

/* Shapes of an object that was created with gi_object_def.deforms: a figure that walks, a flag, what grows. Values,
 * free to change every frame, that take effect in the next gi_update:
 *
 *     world = pose (scale (joints (positions)))
 *
 * Which leaves there are, how they hang together, how fine they are drawn and cut as emitters, and which of surfaces in
 * one place is seen (Rules) stays what the definition's positions made it: they should be those of a pose in which
 * nothing is squeezed, a figure's bind pose. All else is a function of the shape, by OpenSubdiv's masks on the cage:
 * rows are those of a context in which an object of that definition had this shape from the first, bit for bit. It
 * costs what a move costs, and all pairs of leaves of the object anew, of which those are left out whose form factor is
 * about a hundredth of the row tolerance or less: 1.1 to 1.35 times a move in all, and 2 us of the CPU a leaf. Rays
 * meet it leaf by leaf, however flat it is. Turned inside out it is lit on the side its normals point to then.
 *
 * GI_ERROR_INVALID_GEOMETRY, with the shape as it was: a number that is not finite, a vertex farther than 1e9 m from
 * the object's origin, a leaf of less than 1e-24 m2 (the line names its face). GI_ERROR_INVALID_ARGUMENT: the object
 * was created without deforms. */

/* Of the cage: 3 * vertex_count of the definition. */
GI_API gi_result gi_set_positions(gi_context *gi, gi_object object, const float *positions);
/* Of the mesh that is drawn in the cage's place: 3 * draw_vertex_count. It does not follow the cage by itself; where
 * both have joints those move both. */
GI_API gi_result gi_set_draw_positions(gi_context *gi, gi_object object, const float *positions);
/* Linear blend skinning: each vertex goes to the mean of where its joints take it, by weight. matrices: count (that of
 * the definition) times 16, column-major, object space from that of the positions: of glTF the inverse of the mesh's
 * place times the joint's place times its inverse bind matrix. All are the identity until they are set. */
GI_API gi_result gi_set_joints(gi_context *gi, gi_object object, const float *matrices, uint32_t count);
/* Instead of gi_object_def.scale, each > 0 and as different as wanted. */
GI_API gi_result gi_set_scale(gi_context *gi, gi_object object, const float scale[3]);

/* What is hidden gives, takes and blocks no light and is not drawn; its leaves are there and black. Like a move it
 * takes no gi_commit and effect in the next gi_update, and costs like one. Default: not hidden. (A gi_sky that is
 * chosen automatically does not look at it: a room encloses the others while it is hidden too.) */
GI_API gi_result gi_set_hidden(gi_context *gi, gi_object object, bool hidden);
GI_API gi_result gi_get_hidden(const gi_context *gi, gi_object object, bool *out);

/* From the next gi_commit on, e.g. static where something that was carried is put down for good. */
GI_API gi_result gi_set_mobility(gi_context *gi, gi_object object, gi_mobility mobility);
/* What it is now: GI_MOBILITY_MOVABLE if it was given another pose after a commit. */
GI_API gi_result gi_get_mobility(const gi_context *gi, gi_object object, gi_mobility *out);

/* Takes in what was created and gives away the places of what was destroyed. Rows and B of objects that stay are
 * kept, if those have at least half of the leaves and there is a sky as before; what came, and what of the others
 * sees it or saw what went, is the next gi_update's work, under a budget if that has one. Otherwise that builds
 * every row. Either way rows are those of a context in which the scene was built at once, bit for bit, if objects
 * were created in the same order there, those that went too: samples are drawn by ids that belong to a handle's
 * index1, which is given again. An empty scene is fine: it is black. Leaves, nodes and links get new numbers. B of
 * what stays is kept; what came is lit by its own rows after an exact update, and by the row of the nearest leaf
 * that faces its way while its own wait for a budget. Does not wait for the GPU. GI_ERROR_OUT_OF_MEMORY, before any
 * work, where a buffer would be larger than the renderer binds; GI_ERROR_SHADER, every time, when a shader does not
 * compile. */
GI_API gi_result gi_commit(gi_context *gi);

/* ---- lights ------------------------------------------------------------------------------------------------------ */

/* Lights without a surface: a point that shines all round or into a cone, and a sun. They light leaves by rays that are
 * remembered: 16 of each leaf and light, from points spread over the leaf, so that edges of sunlight are where they
 * should be. Rays are traced again for leaves that something moved before, or that moved, and for all of them where the
 * light moved; a light at rest costs nothing, and a new colour a solve, no rays. All of that is done by the next
 * gi_update, whatever its budget: at most 16 rays a leaf and light (gi_report.light_rays).
 *
 * What they light reflects it as ever: B, rows, bounds and gi_trace_paths have their light. Mirrors and glass are
 * opaque to them: they hide what is behind, and no light of these lights goes on by way of them, but it does once
 * it was reflected by something else. Below surfaces (gi_subsurface) it is scattered as other light. */
typedef struct gi_light {
	uint32_t index1; /* by value; zero is no light. Stale ones and those of other contexts are detected */
	uint32_t generation;
	uint32_t context;
} gi_light;

typedef enum gi_light_type {
	GI_LIGHT_POINT,       /* E = I cos / d^2 */
	GI_LIGHT_SPOT,        /* the same within a cone */
	GI_LIGHT_DIRECTIONAL, /* a sun, at no place: E = E_sun cos */
} gi_light_type;

/* Who adds the direct light of a light to pictures. Its reflections are in them in any case. */
typedef enum gi_light_shown {
	/* gi_draw, pixel by pixel with shadow maps (default); GI_MOST_PIXEL_LIGHTS of them, further ones by leaves */
	GI_LIGHT_BY_PIXELS,
	GI_LIGHT_BY_LEAVES, /* the leaves: as coarse as they are, at no cost a pixel */
	GI_LIGHT_BY_HOST,   /* the host: neither gi_draw nor the indirect light of gi_get_buffers has it */
} gi_light_shown;

/* Most lights at a time, switched off ones too; and most that gi_draw shows pixel by pixel. */
#define GI_MOST_LIGHTS 256
#define GI_MOST_PIXEL_LIGHTS 16

/* Falloffs are those of glTF's KHR_lights_punctual. */
typedef struct gi_light_def {
	gi_light_type type; /* default GI_LIGHT_POINT */
	/* Linear RGB, each 0..1e12. Point and spot: radiant intensity, W/sr: what a lamp of P watts all round has is
	 * P / (4 pi); directional: irradiance of a surface that faces it, W/m2. default 1 1 1 */
	float intensity[3];
	float position[3];  /* metres, world, each within 1e9 of 0; not of a directional one; default 0 0 0 */
	float direction[3]; /* world, in which it shines; spot and directional; any length but 0; default 0 0 -1 */
	/* Spot: radians from the axis to where light begins to fall off, and to where there is none:
	 * clamp((cos - cos outer) / (cos inner - cos outer))^2. 0 <= inner < outer <= pi/2; default 0 and pi/4 */
	float inner_angle, outer_angle;
	/* Point and spot: > 0: what lights is multiplied by max(0, 1 - (d / range)^4), nothing from d = range on,
	 * metres; 0, the default: 1 / d^2 alone */
	float range;
	/* Point and spot: shadows are as soft as those of a ball of this radius, metres; what arrives is that of a
	 * point all the same. Nothing should be nearer than that, or it hides a part. >= 0, default 0 */
	float radius;
	/* Directional: radius of its disc in the sky, radians; the sun's is 0.00465. [0, 0.5], default 0 */
	float angular_radius;
	gi_light_shown shown; /* default GI_LIGHT_BY_PIXELS */
	bool enabled;         /* default true; off and on again costs rays only where something moved meanwhile */
	uint32_t internal;
} gi_light_def;

GI_API gi_light_def gi_light_def_default(void);

/* They take effect in the next gi_update; no gi_commit is needed. On failure *out is zero. GI_ERROR_INVALID_ARGUMENT
 * where a value is out of its range, or there are GI_MOST_LIGHTS. */
GI_API gi_result gi_create_light(gi_context *gi, const gi_light_def *def, gi_light *out);
/* All values, as often as wanted: `def` from gi_get_light or gi_light_def_default. */
GI_API gi_result gi_set_light(gi_context *gi, gi_light light, const gi_light_def *def);
GI_API gi_result gi_get_light(const gi_context *gi, gi_light light, gi_light_def *out);
GI_API gi_result gi_destroy_light(gi_context *gi, gi_light light);
GI_API bool gi_light_is_valid(const gi_context *gi, gi_light light);

/* ---- frames ------------------------------------------------------------------------------------------------------ */

/* What an update may cost, or how exact it has to be. All zero: exact, every row is that of a rebuild, bit for bit.
 *
 * A row (all that one leaf receives) is refreshed whole or waits. Rows that an update would change most go first, by a
 * certified bound; a row that waits keeps the light of poses it knew, and gi_report counts it and bounds what all
 * waiting rows are off by (stale_bound). Updates after gi_invalidate, and after a gi_commit that keeps no rows, build
 * every row whatever the budget.
 *
 * Under rays or error alone every row is looked at, and none waits for more than some 70 updates for lack of budget.
 * Given time, an update keeps to it: it looks at as many rows as fit, bounds the others by what any row may become
 * (stale_bound is larger then), takes as many sweeps as fit, one at least, which the next update goes on with
 * (solve_bound says how far that is), and refreshes one row at least. Rows go by their bound, the size of their leaf,
 * the square of their age and their cost: none waits for ever. It takes some ten updates to learn what things take.
 * Where an update commits, because a static object moved or was hidden, that takes what it takes; rows and solve get
 * what is left of ms, a tenth of it at least. */
typedef struct gi_view gi_view;

typedef struct gi_budget {
	float ms;      /* > 0: aim for so many milliseconds of GPU time in gi_update; needs gi_context_def.profile */
	uint64_t rays; /* > 0: about so many rays */
	/* > 0: rows wait whose part in stale_relative is at most this, if B changes about as much as in the update
	 * before; they wait even when nothing moves, until an update asks for less. [0, 1] */
	float error;

	/* The camera whose picture counts: rows of leaves that it does not see wait longer, but not for ever; what rows
	 * become is the same. Only the matrices are read, by this call. NULL: all of the scene counts alike. */
	const gi_view *view;
} gi_budget;

/* Brings rows and B up to date with the poses and materials. Issues GPU work and does not wait for it. Nothing
 * changed, nothing waits and converged: no dispatch, no upload. budget may be NULL: exact. Objects created since the
 * last gi_commit take no part yet. GI_ERROR_NOT_COMMITTED before the first one. */
GI_API gi_result gi_update(gi_context *gi, const gi_budget *budget);

/* Makes the next gi_update build every row from scratch; B is kept. The result is the same bits an update gives. */
GI_API void gi_invalidate(gi_context *gi);

/* Makes the next solve start from B = E (a cold start). */
GI_API void gi_reset_radiosity(gi_context *gi);

/* Waits for the GPU; afterwards gi_get_report is about the last gi_update. For tests, benchmarks and loading screens.
 */
GI_API gi_result gi_finish(gi_context *gi);

/* Why the solve ended: > 0 usable, 0 not run, < 0 failed. */
typedef enum gi_outcome {
	GI_OUTCOME_NOT_FINITE = -2, /* a NaN or infinity appeared */
	GI_OUTCOME_TRUNCATED = -1,  /* the entry pool was full; the next gi_update grows it and builds anew */
	GI_OUTCOME_NOT_RUN = 0,
	GI_OUTCOME_CONVERGED = 1, /* the bound meets the tolerance */
	GI_OUTCOME_SWEEPS = 2,    /* max_sweeps spent; the next frame goes on from here */
	GI_OUTCOME_AT_REST = 3,   /* nothing had changed: no work */
	GI_OUTCOME_ROUNDING = 4,  /* single precision ends here, above the tolerance: the next frame is at rest */
} gi_outcome;

/* How the solve went on from sweep to sweep. */
typedef enum gi_method {
	GI_METHOD_JACOBI,
	GI_METHOD_CHEBYSHEV, /* takes about the square root of the sweeps; where Jacobi would take some more */
} gi_method;

typedef enum gi_pass {
	GI_PASS_POSE,     /* moved nodes and vertices to the world */
	GI_PASS_CHOOSE,   /* under a budget: which rows to refresh */
	GI_PASS_CUT,      /* new cuts */
	GI_PASS_FACTOR,   /* form factors of new entries */
	GI_PASS_FLAG,     /* which entries at rest a mover may have changed */
	GI_PASS_TRACE,    /* visibility rays */
	GI_PASS_CLOSE,    /* row sums */
	GI_PASS_CAUSTICS, /* photons through mirrors and glass */
	GI_PASS_LIGHTS,   /* rays to lights without a surface */
	GI_PASS_SOLVE,    /* sweeps */
	GI_PASS_LIGHT,    /* indirect irradiance of what is drawn */
	GI_PASS_RECEIVE,  /* light of receivers */
	GI_PASS_ESTIMATE, /* how far off the rows are (def.estimate_leaves) */
	GI_PASS_SHADOW,   /* shadow maps (gi_draw) */
	GI_PASS_DRAW,     /* the picture (gi_draw) */
	GI_PASS_COUNT
} gi_pass;

GI_API const char *gi_pass_name(gi_pass pass);

/* One frame in figures. Reports come when the GPU is done with them, a frame or two late unless gi_finish waits. */
typedef struct gi_report {
	uint64_t frame; /* which gi_update, counted from 1 */
	gi_outcome outcome;

	uint32_t objects, leaves, nodes; /* nodes: leaves and their ancestors */
	uint64_t entries;                /* in all rows, receivers' too, hidden ones too */
	uint64_t links;                  /* entries the solve reads: not hidden, not black */
	uint64_t new_entries;            /* cut anew this frame */
	uint64_t flagged_entries;        /* at rest, but retested since a mover may have changed them */
	uint64_t dirty_entries;          /* new_entries + flagged_entries */
	uint64_t dirty_rows;             /* rows with at least one of those */
	/* Rows of which something that is seen is other than it was: summed and closed again */
	uint64_t closed_rows;
	uint64_t rays;
	uint64_t light_rays; /* of those, to lights without a surface (gi_light) */

	uint64_t waiting_rows; /* under a budget: not refreshed although something of them may have changed */
	/* Their entries that may have; of rows not assessed, how many of theirs bring light */
	uint64_t waiting_entries;
	/* Under a budget: rows whose entries this update looked at to choose; all that may have changed, or as many
	 * as fit into budget.ms */
	uint32_t assessed_rows;
	/* Certified: the solution of the rows as they are and that of the rows of an exact update differ nowhere by
	 * more, W/m2; what B is off by as a whole is at most solve_bound + stale_bound */
	float stale_bound;
	float stale_relative; /* stale_bound over the largest light reflected; 3e38 where nothing reflects any yet */

	uint32_t sweeps;
	/* Jacobi alone: sweeps so far and those it would still have taken, when last foretold */
	uint32_t jacobi_sweeps;
	gi_method method;  /* the last one used; GI_METHOD_CHEBYSHEV where jacobi_sweeps were too many */
	float residual;    /* largest |E + rho H - B| the last sweep found, and what rounding may hide of it, W/m2 */
	float contraction; /* q = max_i rho_i * sum_j F_ij V_ij, below 1 */
	/* A >= 1: |B - B*|max <= A * residual, whatever B; at most 1 / (1 - q), and often far less */
	float amplification;
	/* Certified: |B - B*|max for the B stored and the rows as they are, rounding included, W/m2 */
	float solve_bound;
	/* Certified: no B is off by more than this times (R + largest R / 100000), see solve_tolerance; 3e38 where
	 * nothing is certain yet */
	float solve_relative;
	/* What more sweeps cannot take from solve_bound: about 1e-7 A times the largest R, W/m2 */
	float rounding_bound;
	float radiosity_max; /* largest B, W/m2 */
	float reflected_max; /* largest R = B - E, W/m2 */

	/* Error of visibility and discretisation, estimated on def.estimate_leaves random leaves, others in every
	 * update: area-weighted RMS over all leaves of |H - what finer rows would give|, rgb norm, W/m2; and over
	 * the RMS of |H|. 0 without def.estimate_leaves, or where it drowns in the estimate's own noise. See
	 * docs/accuracy.md. */
	float sampling_estimate;
	float sampling_relative;
	float sampling_squared; /* the estimate's square, (W/m2)^2, below 0 where noise says so; average this */
	/* The same where it is dark: area-weighted RMS over all leaves of the error over the leaf's own |H|, which
	 * counts as a hundredth of the scene's RMS of |H| at least. Light that leaks into a dark room shows here,
	 * not above. */
	float sampling_local;
	float sampling_local_squared; /* its square, below 0 where noise says so; average this */
	uint64_t sampling_rays;       /* taken for it, not in rays */

	uint32_t dispatches;     /* compute dispatches issued by gi_update */
	uint64_t uploaded_bytes; /* by gi_update */
	uint64_t gpu_bytes;      /* all buffers of the context, and those kept for the next commit */
	/* GPU time of this update's passes, SHADOW and DRAW of the last gi_draw; 0 of those that did not run, and
	 * without def.profile */
	float pass_ms[GI_PASS_COUNT];
	float update_ms; /* CPU time inside gi_update, ms */
} gi_report;

/* The newest finished report; all zero but for sizes before the first. */
GI_API gi_result gi_get_report(gi_context *gi, gi_report *out);

/* ---- picture ----------------------------------------------------------------------------------------------------- */

typedef enum gi_mode {
	GI_MODE_GLOBAL, /* direct + indirect (default) */
	GI_MODE_DIRECT,
	GI_MODE_INDIRECT,
} gi_mode;

typedef enum gi_overlay {
	GI_OVERLAY_NONE,
	GI_OVERLAY_WIREFRAME, /* the leaves' edges over the picture */
	/* Heat maps take the picture's place: display colours in [0,1], linear; show them with an exposure of 1. */
	GI_OVERLAY_DIRTY,    /* share of each row's entries touched by the last update */
	GI_OVERLAY_RESIDUAL, /* last |R_k+1 - R_k| of each leaf over the largest R, logarithmic: 1e-8 to 0.1 */
	/* The nodes gi_view.overlay_depth levels below their objects' roots, each in a colour of its own */
	GI_OVERLAY_HIERARCHY,
	/* What the row of the leaf gi_view.overlay_leaf has of all others, which is drawn cyan; dark blue: nothing. */
	GI_OVERLAY_SENDERS,    /* share of its irradiance that the entry brings, logarithmic: 1e-4 to 1 */
	GI_OVERLAY_VISIBILITY, /* how much of them it sees, V */
	/* Share of all its form factors that their object alone hides, logarithmic: 1e-4 to 1. Where several hide a
	 * node it is the one that rays met first, in an update maybe another than in a rebuild */
	GI_OVERLAY_BLOCKERS,
	/* Receivers and probes over the picture, as white surfaces that give back what falls on them, radiance H / pi:
	 * discs across their normals, seen from the front alone, and balls of those that see all round, lit by the
	 * ball's normal. Rims are dark; black: it sees nothing that light comes from, within a solid */
	GI_OVERLAY_RECEIVERS,
} gi_overlay;

struct gi_view {
	float view_from_world[16];
	float clip_from_view[16];
	uint32_t width, height; /* viewport, pixels; from 1 to what the device draws, 16384 mostly */
	gi_mode mode;
	gi_overlay overlay;
	uint32_t overlay_leaf;  /* as gi_read_leaves counts, gi_pick_leaf; default 0 */
	uint32_t overlay_depth; /* default 0: objects as a whole; beyond the last level: leaves */
	/* Of receivers: > 0: metres, at most a twentieth of the picture's height; default 0: 6 pixels, however far */
	float overlay_radius;

	/* What clip_from_view leads to, as the host would tell glClipControl: which state OpenGL is in is not looked
	 * at. All false by default. */
	bool clip_upper_left;  /* y points down in the framebuffer */
	bool clip_zero_to_one; /* z is in [0,1], not [-1,1] */
	/* The nearer of two depths is the larger one: cleared to 0, compared with GL_GREATER. Depths are written as
	 * with glDepthRange(0, 1): a host that reverses that negates z instead */
	bool depth_reversed;
};

GI_API gi_view gi_view_default(void);

/* Draws the committed objects into the bound framebuffer: linear radiance (W/m2/sr) in RGB, alpha 1; needs a depth
 * attachment. Does not clear: the host clears colour and depth and draws its own things before or after. Direct light
 * per pixel with soft shadows of area emitters, indirect light interpolated from the leaves. Back faces are not drawn:
 * one looks into a room through its walls from behind.
 *
 * At most gi_context_def.pixel_lamps polygons emit per pixel (an emitting object is cut into as few as tile it);
 * objects beyond that, the weakest, light through the leaves. Each costs a pass over the picture. Shadow maps are
 * drawn again only after something moved. Reflectance and exitance are those of the leaves, or of textures
 * (gi_set_textures). Surfaces go through pictures of the viewport's size before they reach the framebuffer: one that is
 * multisampled gets the same value in all samples of a pixel. */
GI_API gi_result gi_draw(gi_context *gi, const gi_view *view);

/* No leaf. */
#define GI_NO_LEAF 0xFFFFFFFFu

/* The leaf whose front a ray meets first, as gi_read_leaves counts, or GI_NO_LEAF: for tools that show what is under
 * the cursor. Backs are looked through, as in gi_draw; poses are those of the last gi_update. origin: world;
 * direction: any length but 0. On the CPU, some 10 ns a leaf of the objects whose ball the ray meets. */
GI_API gi_result gi_pick_leaf(gi_context *gi, const float origin[3], const float direction[3], uint32_t *leaf);

/* ---- light for a host's own meshes and shaders ------------------------------------------------------------------- */

/* A host that draws its own meshes takes the light of the leaves from buffers, in its own shaders:
 *
 *     once a mesh:       gi_map_vertices(gi, object, ...) and its result into a vertex buffer or buffer texture
 *     after an update:   gi_get_buffers(); where `layout` is another than before, gi_get_object_range() of each
 *     in the shader:     gi_light_at_vertex(first_light, light, weight) of gi_light.glsl gives H; radiance is
 *                        (rho H + E) / pi
 *
 * Where the host has no area lamps of its own, gi_context_def.pixel_lamps is to be 0: then H has all light, else all
 * but that of the lamps that gi_draw lights per pixel. Of lights without a surface gi_light_def.shown says the same.
 * gi_object_def.undrawn spares what only gi_draw takes. */

/* Where a vertex has its light from: corners that leaves share (light vertices), counted from the first one of its
 * object. 32 bytes: as vertex attributes an integer and a float one of four, as a buffer texture two texels of
 * GL_RGBA32UI. */
typedef struct gi_vertex_light {
	uint32_t light[4];
	float weight[4]; /* >= 0, sum 1 */
} gi_vertex_light;

/* Finds for each of `count` points of a host's mesh the closest point of the object's leaves, of those whose normal is
 * within 90 degrees of the point's own while there is one near, and what the light vertices round it count there. The
 * mesh may be as fine as wanted, and stand off its cage. positions: 3 * count, metres, in the space of
 * gi_object_def.positions, scale not applied. normals: 3 * count, of any length, or NULL: none. out: count.
 *
 * What comes out holds for as long as the object lives, over commits, moves and updates; an object that was destroyed
 * and created again is to be mapped again. CPU work, no OpenGL: 100,000 points take about a second, the same points
 * give the same bits. GI_ERROR_INVALID_ARGUMENT where a number is not finite. On failure out is undefined. */
GI_API gi_result gi_map_vertices(const gi_context *gi, gi_object object, const float *positions, const float *normals,
				 uint32_t count, gi_vertex_light *out);
/* The same of an object that was prepared, on any thread. Messages go to `message` with `user`; NULL: to stderr. */
GI_API gi_result gi_map_prepared_vertices(const gi_prepared_object *prepared, const float *positions,
					  const float *normals, uint32_t count, gi_vertex_light *out,
					  gi_message_fn *message, void *user);

/* OpenGL names of what updates write, an element a vec4. They may be read at any time in the context that updates are
 * issued in, and are to be written by the library alone. No barrier is needed before they are read as storage blocks,
 * buffer textures, uniform blocks, by copies or glGetBufferSubData; as vertex attributes glMemoryBarrier(
 * GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT), into pixels GL_PIXEL_BUFFER_BARRIER_BIT after gi_update. In another context
 * that shares objects: after a fence, and bound again there.
 *
 * The textures are the same bytes as GL_TEXTURE_BUFFER of GL_RGBA32UI, for usamplerBuffer and uintBitsToFloat
 * (gi_light.glsl): software renderers read them several times faster than storage blocks. */
typedef struct gi_buffers {
	uint32_t leaf_radiosity; /* per leaf: B rgb, W/m2, w 0; what follows leaf_count elements is the solver's */
	/* per leaf: irradiance H from everything but what gi_draw lights per pixel (pixel_lamps), rgb, W/m2 */
	uint32_t leaf_indirect;
	uint32_t light_indirect; /* per light vertex: the same, interpolated to the corners of the leaves */
	uint32_t leaf_radiosity_texture, leaf_indirect_texture, light_indirect_texture;
	uint32_t leaf_count, light_count; /* elements */
	/* Another number than before: there was a gi_commit, or a gi_update that committed by itself (gi_mobility).
	 * Names, counts and the ranges of all objects are to be asked for again; those of before are gone. */
	uint32_t layout;
} gi_buffers;

/* Costs nothing: may be called every frame. GI_ERROR_NOT_COMMITTED before the first gi_commit. */
GI_API gi_result gi_get_buffers(gi_context *gi, gi_buffers *out);

/* Where an object's elements stand in those buffers: what gi_map_vertices counts from first_light on, and leaves in the
 * order of gi_read_leaves. They stay until gi_buffers.layout changes. */
typedef struct gi_object_range {
	uint32_t first_leaf, leaf_count;
	uint32_t first_light, light_count;
} gi_object_range;

/* GI_ERROR_NOT_COMMITTED for an object that no gi_commit has taken in yet. */
GI_API gi_result gi_get_object_range(const gi_context *gi, gi_object object, gi_object_range *out);

/* Text of a file of GLSL for hosts' shaders, NULL: there is none of that name. They are installed too, in
 * share/gi/glsl (CMake: gi_GLSL_DIR, pkg-config: glsldir). "gi_light.glsl": the light of leaves and light vertices. */
GI_API const char *gi_glsl(const char *name);

/* ---- receivers --------------------------------------------------------------------------------------------------- */

/* Points that light falls on and that give none: vertices or lightmap texels of the host's own meshes, probes for
 * characters, particles and fog. Each has a row as a leaf has one, follows what moves as leaves do, and is no part of
 * the solve: with receivers and without, leaves have the same light to the bit. Their light is in a GPU buffer, which
 * every gi_update brings up to date.
 *
 *     gi_receivers_def def = gi_receivers_def_default();
 *     def.positions = ...; def.normals = ...; def.count = ...;
 *     gi_create_receivers(gi, &def, &texels);  gi_commit(gi);
 *     every frame:  gi_update(gi, NULL);  gi_get_receiver_buffer(gi, texels, &light);  the host's shaders read it
 */
typedef struct gi_receivers {
	uint32_t index1; /* zero is none */
	uint32_t generation;
	uint32_t context;
} gi_receivers;

typedef struct gi_receivers_def {
	/* 3 * count, metres, each within 1e9 of 0. With an object: in its space, times its scale; else of `pose` */
	const float *positions;
	/* 3 * count, of any length but 0, which light falls on the side of; NULL: none, and then harmonics are
	 * needed */
	const float *normals;
	uint32_t count; /* from 1 */
	/* 0, the default: irradiance along the normal. 1 or 2: spherical harmonics of the irradiance along all normals,
	 * up to that band, 4 or 9 coefficients a colour: where there is no normal, or a normal map follows. A receiver
	 * is then a point that sees all round. Band 1 alone is up to 35 % off along a normal, band 2 up to 8 % */
	uint32_t harmonics;
	/* Side of the square across the normal that light is taken the mean over, a lightmap's texel, metres; default
	 * 0: about a point, a 4096th of its coordinates wide. Nothing to harmonics */
	float size;
	/* How far points are moved along their normals before anything else, metres, at most 1e9; default 0. A point in
	 * the plane of a surface, within about 1e-6 of its coordinates, receives what falls on either side of that,
	 * by its normal. One that is deeper sees the surface's inside, which is black, or nothing: vertices of a mesh
	 * finer than its cage need an offset of as much as the two are apart, texels of walls none. */
	float offset;
	/* How fine their rows are. What a receiver gets is that of its own row alone, whose few rays nothing evens
	 * out, as reflection does those of leaves. Sources are cut at row_tolerance / refinement, to the next power of
	 * two, 1..1024, default 4; those that emit at their own tolerance, if that is less. Of what reflects an entry
	 * at that tolerance has so many visibility rays, one that brings less fewer; 1..16, default 3. Refinement 1 and
	 * samples 1 are what leaves have: a third of the entries and of the time, and where light comes through a door
	 * four times the noise, 16 % for 4 */
	float refinement;
	uint32_t samples;
	gi_object object; /* that they are fixed to; default zero: none. Where it is destroyed they stay */
	gi_pose pose;     /* of those of no object; default none */
	uint32_t internal;
} gi_receivers_def;

GI_API gi_receivers_def gi_receivers_def_default(void);

/* Copies all arrays. They take part after the next gi_commit, which keeps the rows of what stays, of receivers too;
 * under a budget those that came are dark until their rows were refreshed. On failure *out is zero.
 * GI_ERROR_INVALID_ARGUMENT: no point, a position or a normal out of its range. */
GI_API gi_result gi_create_receivers(gi_context *gi, const gi_receivers_def *def, gi_receivers *out);

/* The next gi_commit gives their place away; until then the buffer is as it is. */
GI_API gi_result gi_destroy_receivers(gi_context *gi, gi_receivers receivers);
GI_API bool gi_receivers_are_valid(const gi_context *gi, gi_receivers receivers);

/* Free to change every frame; in the next gi_update all of their rows are made anew, and nothing else. */
GI_API gi_result gi_set_receivers_pose(gi_context *gi, gi_receivers receivers, gi_pose pose);
/* As many points as the definition has; NULL: those that are there. */
GI_API gi_result gi_set_receivers(gi_context *gi, gi_receivers receivers, const float *positions, const float *normals);

/* Where the light of a set is: vec4 [first, first + stride * count) of an OpenGL buffer, std430, point after point. The
 * name and the range are valid until the first gi_update after the next gi_commit, of after one that commits by itself
 * (gi_mobility); gi_get_report().frame tells nothing new of them. GI_ERROR_NOT_COMMITTED before the first gi_update
 * after the gi_commit that took the set in.
 *
 *   stride 1: irradiance rgb, W/m2; w the share of what the point sees that light can come from: 0 within a solid
 *   stride 4, 9: c_lm rgb in the order (0,0) (1,-1) (1,0) (1,1) (2,-2) (2,-1) (2,0) (2,1) (2,2); w of the first as
 *       above. E(n) = sum of c_lm Y_lm(n), W/m2, Y_lm real and normalised: 0.282095, 0.488603 (y z x),
 *       1.092548 (xy yz), 0.315392 (3zz - 1), 1.092548 xz, 0.546274 (xx - yy): c_lm = A_l L_lm of Ramamoorthi and
 *       Hanrahan (An Efficient Representation for Irradiance Environment Maps, 2001). World axes.
 *
 * All light counts, emitters' and that of lights without a surface too, whatever gi_draw lights per pixel; but for
 * lights that the host draws itself (GI_LIGHT_BY_HOST). The library writes the buffer by a compute shader in gi_update;
 * a host that reads it as a storage block or texture buffer needs no barrier of its own, one that reads it otherwise
 * glMemoryBarrier with the bit for that. It must not write it. */
typedef struct gi_receiver_buffer {
	uint32_t buffer;
	uint32_t first, count, stride;
} gi_receiver_buffer;

GI_API gi_result gi_get_receiver_buffer(const gi_context *gi, gi_receivers receivers, gi_receiver_buffer *out);

/* Copies up to `capacity` vec4 of it: for tests; waits for the GPU. *count: how many there are, 0 on error. light may
 * be NULL to ask for the count. */
GI_API gi_result gi_read_receivers(gi_context *gi, gi_receivers receivers, float *light, uint32_t capacity,
				   uint32_t *count);

/* ---- probes ------------------------------------------------------------------------------------------------------ */

/* A grid of receivers that see all round, for characters, particles and fog, and a look-up between them for the host's
 * shaders (gi_glsl("gi_probe.glsl")) that asks only those that see the place: each knows in 256 directions the planes
 * of the surfaces within the diagonal of a cell, so that a wall of any thickness above spacing / 20 hides what is
 * behind it. They are traced again where something moved near a probe. */
typedef struct gi_probes_def {
	float lower[3];     /* the first probe, metres, each within 1e9 of 0; world */
	float spacing;      /* > 0: between neighbours along each axis, metres */
	uint32_t count[3];  /* along x, y and z, each from 1 */
	uint32_t harmonics; /* 1 or 2; default 2: band 1 alone is up to 35 % off along a normal, band 2 up to 8 % */
	float refinement;   /* as of gi_receivers_def, and samples; defaults 4 and 3 */
	uint32_t samples;
	uint32_t internal;
} gi_probes_def;

GI_API gi_probes_def gi_probes_def_default(void);

/* Receivers in the order x, then y, then z, which stay where they are: of the functions for receivers those that move
 * them refuse. Errors as of gi_create_receivers. */
GI_API gi_result gi_create_probes(gi_context *gi, const gi_probes_def *def, gi_receivers *out);

/* As shaders have it: gi_probe_grid of gi_probe.glsl, three vec4. */
typedef struct gi_probe_grid {
	float lower[3], spacing;
	uint32_t count[3], first_light; /* where its light begins, in vec4 */
	uint32_t stride, first_plane;   /* vec4 a probe, 4 or 9; where its planes begin */
	uint32_t unused[2];
} gi_probe_grid;

/* OpenGL names: of the buffers for storage blocks, of their buffer textures (GL_RGBA32UI) for samplers. They and the
 * grid's numbers are valid as long as those of gi_get_receiver_buffer, and the same barriers hold. */
typedef struct gi_probe_buffers {
	uint32_t light, planes;
	uint32_t light_texture, planes_texture;
	gi_probe_grid grid;
} gi_probe_buffers;

GI_API gi_result gi_get_probe_buffers(const gi_context *gi, gi_receivers probes, gi_probe_buffers *out);

/* ---- read-back (waits for the GPU) ------------------------------------------------------------------------------- */

typedef struct gi_leaf {
	/* World; a triangle repeats its third corner; the surface is the triangles a b c and a c d */
	float corners[4][3];
	float area; /* m2 */
	float rho[3], exitance[3];
	float radiosity[3];  /* B */
	float irradiance[3]; /* H = sum_j F_ij V_ij B_j */
	float row_sum;       /* sum_j F_ij V_ij over lit and reflecting sides */
	gi_object object;
} gi_leaf;

/* Copies up to `capacity` leaves; *count is how many there are, 0 on error. leaves may be NULL to ask for the count.
 * Between a gi_commit and the first gi_update after it corners are those of the committed poses, B is what the next
 * solve starts from, and objects that came have no rows: irradiance and row_sum are 0. */
GI_API gi_result gi_read_leaves(gi_context *gi, gi_leaf *leaves, uint32_t capacity, uint32_t *count);

/* One entry of a row: leaf `leaf` receives from `node`, an ancestor or self of leaves [first_leaf, first_leaf +
 * leaf_count). */
typedef struct gi_entry {
	uint32_t leaf, node;
	uint32_t first_leaf, leaf_count; /* 0, 0 for a patch of sky */
	float form_factor;               /* F, unoccluded */
	uint32_t visible, samples;       /* V = visible / samples; visible <= samples <= 16 */
	uint32_t back;                   /* 1: a black back, no light comes from it */
} gi_entry;

/* Copies up to `capacity` entries in no particular order. entries may be NULL to ask for the count. */
GI_API gi_result gi_read_entries(gi_context *gi, gi_entry *entries, uint64_t capacity, uint64_t *count);

/* One link: what the solve multiplies. B_leaf = E + rho * sum weight * B_node. `node` is the leaf where one of the
 * entry's rays ended, or the patch of sky; of a ray that met a mirror or glass there is another link, specular, to
 * where it went from there. */
typedef struct gi_link {
	uint32_t leaf, node;
	uint32_t first_leaf, leaf_count;
	float weight;      /* F V after the row was closed; specular: the largest of weights */
	float weights[3];  /* per RGB channel: weight, times what the mirrors and glass on the way leave of the light */
	uint32_t specular; /* 1: through mirrors or glass. What emitters give comes as caustics, where there are any */
} gi_link;

GI_API gi_result gi_read_links(gi_context *gi, gi_link *links, uint64_t capacity, uint64_t *count);

/* The fraction of what leaves the whole of `from` that arrives directly at `to`. `to` zero: at anything (the mean row
 * sum).
 *
 * It is read off the rows. Where `to` is static (gi_mobility) and so small or far that rows have it below a node
 * with others, one of those, drawn at random by what they show, stands for all of them: the sum over all objects is
 * what it would be, but a single small one is hit or missed by each leaf of `from`. The result is right on average
 * over such objects, and off by up to the form factor of the node, about row_tolerance, over the root of the number
 * of leaves of `from`. Set `to` to GI_MOBILITY_MOVABLE and commit where it matters. */
GI_API gi_result gi_form_factor(gi_context *gi, gi_object from, gi_object to, double *out);

/* The same to `count` objects at once, for one read-back: out[k] is towards to[k]. */
GI_API gi_result gi_form_factors(gi_context *gi, gi_object from, const gi_object *to, uint32_t count, double *out);

/* ---- ground truth ------------------------------------------------------------------------------------------------ */

typedef struct gi_path_options {
	uint32_t paths; /* of every leaf, 1..2^24; powers of two stratify best; default 256 */
	uint32_t seed;  /* another seed gives an independent result; default 1 */
} gi_path_options;

GI_API gi_path_options gi_path_options_default(void);

/* What the leaves' irradiance should be: path tracing on the GPU, with the rays of the rows but without rows, cuts,
 * closing or solve, so that what it finds is free of their errors. Use it to see how far a row_tolerance is from the
 * truth in a scene of your own: compare with gi_leaf.irradiance, both area means over a leaf, W/m2, in the order of
 * gi_read_leaves().
 *
 * Unbiased; the noise falls at least as 1 / sqrt(paths), some 10 % of the irradiance of a leaf at 256 paths in a room
 * lit by a lamp. A path has 2,000 vertices at most in the mean: where rho is above some 0.999 noise grows instead of
 * the time, and most results are below the truth while a few are far above it. Two calls with seeds of their own are
 * two independent halves R1, R2: the mean over leaves of (H - R1) (H - R2) is the squared error of H free of the noise
 * of both, and their difference says how large that noise is. The same scene, renderer and seed give the same bits.
 *
 * `options` NULL: the defaults. irradiance: 3 * capacity floats; *count is how many leaves there are, and of those the
 * first `capacity` are traced. The scene is that of the last gi_update(): poses and materials set since then are not in
 * it; without an update since the last gi_commit() the result is GI_ERROR_NOT_COMMITTED. Paths do not go below
 * surfaces: GI_ERROR_INVALID_ARGUMENT in a scene with gi_subsurface. What lies beyond all objects is sky_exitance where
 * the rows have a sky (gi_sky), else black. Changes nothing of rows and light.
 *
 * For loading screens and tests, not for frames: waits for the GPU, after dispatches short enough for a desktop to stay
 * alive, a second for about 200,000 paths on two cores without a GPU. The first call compiles a shader. */
GI_API gi_result gi_trace_paths(gi_context *gi, const gi_path_options *options, float *irradiance, uint32_t capacity,
				uint32_t *count);

#ifdef __cplusplus
}
#endif

#endif
