/* The OpenGL of drawing: meshes, depth maps, framebuffers, state. The other half of gpu.c; nothing else in gi/ calls
 * OpenGL. */
#ifndef GI_GPU_DRAW_H
#define GI_GPU_DRAW_H

#include "gpu.h"

/* Vertices and indices behind one vertex array. */
typedef struct gpu_mesh {
	uint32_t array;
	gpu_buffer vertices, indices;
	uint64_t index_count;
} gpu_mesh;

/* One vertex attribute at its location in the array: 1..4 floats or unsigned integers. components 0 ends a list. */
typedef struct gpu_attribute {
	uint32_t components;
	bool integer;
	uint32_t offset; /* bytes into the vertex */
} gpu_attribute;

gi_result gpu_mesh_create(gpu *g, gpu_mesh *mesh, const char *label, const gpu_attribute *attributes,
			  uint32_t vertex_bytes, uint64_t vertex_count, const void *vertices, uint64_t index_count,
			  const uint32_t *indices);
/* One more attribute, floats one vertex after the other, of a buffer that stays the caller's. */
void gpu_mesh_add_floats(const gpu *g, const gpu_mesh *mesh, uint32_t location, uint32_t components,
			 const gpu_buffer *buffer);
void gpu_mesh_free(gpu *g, gpu_mesh *mesh);
void gpu_mesh_draw(const gpu *g, const gpu_mesh *mesh, uint32_t program);
/* Draws the mesh `count` times; gl_InstanceID tells which. */
void gpu_mesh_draw_instances(const gpu *g, const gpu_mesh *mesh, uint32_t program, uint32_t count);
void gpu_mesh_draw_lines(const gpu *g, const gpu_mesh *mesh, uint32_t program);

/* A part of a mesh's indices. */
typedef struct gpu_range {
	uint32_t first, count;
} gpu_range;

void gpu_mesh_draw_ranges(const gpu *g, const gpu_mesh *mesh, uint32_t program, const gpu_range *ranges,
			  uint32_t count);

/* Square depth maps of one size: the layers of an array texture that compares when sampled. */
typedef struct gpu_depth_maps {
	uint32_t texture, framebuffer, plain_sampler, size, layers;
	uint64_t bytes;
} gpu_depth_maps;

/* Keeps what is there when it is the same. */
gi_result gpu_depth_maps_create(gpu *g, gpu_depth_maps *maps, uint32_t size, uint32_t layers);
void gpu_depth_maps_free(gpu *g, gpu_depth_maps *maps);
/* Clears a layer to the farthest depth and makes it what is drawn into. With a border its outermost texels stay clear:
 * beyond the map nothing hides anything. */
void gpu_depth_maps_begin_layer(const gpu *g, const gpu_depth_maps *maps, uint32_t layer, bool border);
/* Compared at `unit`, as plain values at the next. */
void gpu_depth_maps_bind(const gpu *g, const gpu_depth_maps *maps, uint32_t unit);

/* Textures of one size to draw into: up to three of four components, and a depth. */
typedef enum gpu_format { GPU_FORMAT_NONE, GPU_FORMAT_FLOAT, GPU_FORMAT_UNSIGNED } gpu_format; /* of 32 bits */
enum { GPU_TARGET_COLORS = 3 };

typedef struct gpu_target {
	uint32_t framebuffer, color[GPU_TARGET_COLORS], depth, width, height;
	uint64_t bytes;
} gpu_target;

/* Keeps what is there when it is the same size and has as many colours, which are those before the first NONE. */
gi_result gpu_target_create(gpu *g, gpu_target *target, const char *label, const gpu_format formats[GPU_TARGET_COLORS],
			    bool depth, uint32_t width, uint32_t height);
void gpu_target_free(gpu *g, gpu_target *target);
/* Clears the target's first colour to 0. */
void gpu_target_clear(const gpu *g, const gpu_target *target);
/* Read by texelFetch. */
void gpu_bind_texture(const gpu *g, uint32_t unit, uint32_t texture);

/* A texture of the host's, by one of its samplers; 0: as the texture itself says. */
void gpu_bind_host_texture(const gpu *g, uint32_t unit, uint32_t texture, uint32_t sampler);
/* Is there such an object? Of two dimensions, of one layer and one sample. */
bool gpu_is_host_texture(const gpu *g, uint32_t name);
bool gpu_is_host_sampler(const gpu *g, uint32_t name);

/* ---- the host's state (gpu_state.c) ---- */

enum {
	GPU_CLIP_DISTANCES = 3, /* that a vertex shader may write */
	GPU_DRAW_BUFFERS = 8,   /* that OpenGL promises */
	GPU_CAPABILITIES = 23,
	GPU_BLEND_VALUES = 6
};

typedef enum gpu_state_value {
	GPU_STATE_FRAMEBUFFER,
	GPU_STATE_DEPTH_FUNCTION,
	GPU_STATE_DEPTH_MASK,
	GPU_STATE_CULL_FACE,
	GPU_STATE_FRONT_FACE,
	GPU_STATE_PROVOKING_VERTEX,
	GPU_STATE_CLIP_ORIGIN,
	GPU_STATE_CLIP_DEPTH,
	GPU_STATE_VALUES
} gpu_state_value;

/* What drawing changes and a host may have set. */
typedef struct gpu_draw_state {
	bool capabilities[GPU_CAPABILITIES], blend[GPU_DRAW_BUFFERS], color_mask[GPU_DRAW_BUFFERS][4], scissor;
	int values[GPU_STATE_VALUES], blend_values[GPU_BLEND_VALUES], scissor_box[4], polygon_mode[2];
	float viewport[4], line_width;
	double depth_range[2];
} gpu_draw_state;

/* What clip coordinates mean, as glClipControl has it, and which of two depths is the nearer one. */
typedef struct gpu_convention {
	bool upper_left, zero_to_one, reversed;
} gpu_convention;

/* Remembers the host's state, then sets: depth test and writes on, no blending, no scissor, back faces culled, OpenGL's
 * own convention, whatever the host has set. */
void gpu_draw_begin(const gpu *g, gpu_draw_state *state);
void gpu_draw_end(const gpu *g, const gpu_draw_state *state);
void gpu_draw_convention(const gpu *g, gpu_convention convention);
/* May the host's framebuffer be drawn into? Before gpu_draw_begin. */
bool gpu_host_is_complete(const gpu *g);
/* Into the first draw buffer of the host's framebuffer. */
void gpu_draw_to_host(const gpu *g, const gpu_draw_state *state, uint32_t width, uint32_t height);
/* Into a target, whose depth is cleared to the farthest; colours are left as they are. */
void gpu_draw_to_target(const gpu *g, const gpu_target *target, gpu_convention convention);
/* Nothing is culled, or backs: of pictures, or of pictures that are mirrored. */
typedef enum gpu_cull { GPU_CULL_NONE, GPU_CULL_BACKS, GPU_CULL_MIRRORED_BACKS } gpu_cull;
void gpu_draw_cull(const gpu *g, gpu_cull cull);
/* Only the pixels lower..upper - 1 are drawn, until gpu_draw_unscissored(). */
void gpu_draw_scissor(const gpu *g, const int lower[2], const int upper[2]);
void gpu_draw_unscissored(const gpu *g);
/* Clips what is drawn by the vertex shader's gl_ClipDistance. */
void gpu_draw_clip(const gpu *g, bool clip);
/* Lines over what is drawn: what is there is multiplied by the colour, depths win by a little and are not written. */
void gpu_draw_multiplied(const gpu *g, bool on, gpu_convention convention);

/* What is drawn is added to what is there, whatever the depth. */
void gpu_draw_added(const gpu *g, bool on);
/* The same, but only where it is no deeper than what is there; depths are not written. */
void gpu_draw_added_in_front(const gpu *g, bool on, gpu_convention convention);

/* A part of the buffer; offset a multiple of 256. */
void gpu_bind_uniform_range(const gpu *g, uint32_t binding, const gpu_buffer *buffer, uint64_t offset, uint64_t bytes);
void gpu_set_corner(const gpu *g, uint32_t program, int location, const int corner[2]);

#endif
