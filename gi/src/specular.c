#include "specular.h"

#include "binding.h"
#include "context.h"
#include "host_memory.h"
#include "smooth.h"

#include <string.h>

struct gi_smooth {
	bool built; /* for the committed scene */
	SMOOTH_BUFFERS(BUFFER_MEMBER)
};

/* As large as the scene's arrays. */
typedef struct specular_sizes {
	uint32_t primitives, materials;
} specular_sizes;

/* Does anything that is seen reflect as a mirror or refract, as of the last commit and the materials of now? */
static bool is_wanted(const gi_context *gi)
{
	const gi_scene *s = &gi->scene;
	for (uint32_t slot = 0; slot < s->slot_count; slot++)
		if (scene_object_in(s, slot) && object_is_seen(scene_object_in(s, slot)) &&
		    object_is_smooth(scene_object_in(s, slot)))
			return true;
	return false;
}

static specular_sizes sizes_of(const gi_scene *s)
{
	specular_sizes sizes = {0, 0};
	for (uint32_t slot = 0; slot < s->slot_count; slot++) {
		const object_record *o = scene_object_in(s, slot);
		const uint32_t primitives = o ? o->primitive_base + o->bvh.primitive_count : 0,
			       materials = o ? o->material_base + object_material_slots(o) : 0;
		sizes.primitives = primitives > sizes.primitives ? primitives : sizes.primitives;
		sizes.materials = materials > sizes.materials ? materials : sizes.materials;
	}
	return sizes;
}

static gi_smooth_material smooth_material(const gi_specular *s)
{
	return (gi_smooth_material){{s->reflectance[0], s->reflectance[1], s->reflectance[2], s->index},
				    {s->transmittance[0], s->transmittance[1], s->transmittance[2], 0}};
}

static gi_result upload_normals(gi_context *gi, uint32_t primitives)
{
	const gi_scene *s = &gi->scene;
	gi_uvec4 *normals = gi_calloc((size_t)primitives + 1, sizeof *normals);
	bool enough = normals != NULL;
	for (uint32_t slot = 0; enough && slot < s->slot_count; slot++) {
		const object_record *o = scene_object_in(s, slot);
		if (o && object_is_smooth(o))
			enough =
			    gi_smooth_normals(o->bvh.primitives, o->bvh.primitive_count, &normals[o->primitive_base].x);
	}
	const gi_result result = enough ? gpu_buffer_allocate(&gi->gpu, &gi->smooth->normals, buffer_labels.SMOOTH,
							      sizeof *normals * primitives, normals)
					: gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	gi_free(normals);
	return result;
}

static gi_result upload_materials(gi_context *gi, uint32_t count)
{
	const gi_scene *s = &gi->scene;
	gi_smooth_material *materials = gi_calloc((size_t)count + 1, sizeof *materials);
	if (!materials)
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	for (uint32_t slot = 0; slot < s->slot_count; slot++) {
		const object_record *o = scene_object_in(s, slot);
		for (uint32_t m = 0; o && o->specular && m < o->material_count; m++)
			materials[o->material_base + m] = smooth_material(&o->specular[m]);
	}
	const gi_result result = gpu_buffer_replace(&gi->gpu, &gi->smooth->materials, buffer_labels.SMOOTH_MATERIALS,
						    sizeof *materials * count, materials);
	gi_free(materials);
	return result;
}

static gi_result upload_corner_lights(gi_context *gi)
{
	const gi_scene *s = &gi->scene;
	gi_uvec4 *lights = gi_calloc((size_t)s->leaf_count + 1, sizeof *lights);
	if (!lights)
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	for (uint32_t slot = 0; slot < s->slot_count; slot++) {
		const object_record *o = scene_object_in(s, slot);
		for (uint32_t leaf = 0; o && leaf < o->hierarchy.leaf_count; leaf++)
			for (int k = 0; k < 4; k++)
				(&lights[o->leaf_base + leaf].x)[k] =
				    o->light_base + o->drawn.corner_light[4 * leaf + (uint32_t)k];
	}
	const gi_result result = gpu_buffer_allocate(&gi->gpu, &gi->smooth->corner_lights, buffer_labels.CORNER_LIGHTS,
						     sizeof *lights * s->leaf_count, lights);
	gi_free(lights);
	return result;
}

static bool materials_changed(const gi_scene *s)
{
	bool changed = false;
	for (uint32_t slot = 0; slot < s->slot_count; slot++) {
		const object_record *o = scene_object_in(s, slot);
		changed = changed || (o && o->specular && o->material_changed);
	}
	return changed;
}

gi_result specular_update(gi_context *gi)
{
	if (!is_wanted(gi)) {
		specular_free(gi);
		return GI_OK;
	}
	if (!gi->smooth)
		gi->smooth = gi_calloc(1, sizeof *gi->smooth);
	if (!gi->smooth)
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	const bool changed = materials_changed(&gi->scene);
	if (gi->smooth->built && !changed)
		return GI_OK;
	/* Another object may have become smooth: all is made anew. */
	const specular_sizes sizes = sizes_of(&gi->scene);
	gi_result result = upload_materials(gi, sizes.materials);
	if (!result)
		result = upload_normals(gi, sizes.primitives);
	if (!result && !gi->smooth->built)
		result = upload_corner_lights(gi);
	gi->smooth->built = !result;
	return result;
}

void specular_invalidate(gi_context *gi)
{
	if (gi->smooth)
		gi->smooth->built = false;
}

bool specular_is_ready(const gi_context *gi)
{
	return gi->smooth && gi->smooth->built;
}

void specular_bind(const gi_context *gi)
{
	const gi_smooth *owner = gi->smooth;
	SMOOTH_BUFFERS(BUFFER_BIND)
}

void specular_free(gi_context *gi)
{
	gi_smooth *owner = gi->smooth;
	if (!owner)
		return;
	SMOOTH_BUFFERS(BUFFER_FREE)
	gi_free(owner);
	gi->smooth = NULL;
}
