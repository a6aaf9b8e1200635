/* Materials of a glTF file: the diffuse part of each, its emission, and what of the rest is told. */
#include "gltf_scene.h"

#include <math.h>
#include <string.h>

static void note_unread(gltf_document *document, bool found, const char *material, const char *text)
{
	if (found)
		import_note(document->loader, material, "%s", text);
}

/* Multiplies by the mean of a texture; without one, or where it cannot be read, leaves alone. */
static void apply_mean(gltf_document *document, const cJSON *reference, const char *material, double color[3])
{
	int64_t texture = -1;
	float mean[4];
	const char *fault = "the texture names no image";
	if (!reference)
		return;
	bool found = gltf_index(document, reference, "index", GLTF_TEXTURES, &texture) && texture >= 0;
	int64_t image = found ? document->texture_images[texture] : -1;
	if (image >= 0 && gltf_image_mean(document, image, mean, &fault)) {
		for (int c = 0; c < 3; c++)
			color[c] *= (double)mean[c];
		import_note(document->loader, material, "emissive textures are read as their mean");
		return;
	}
	import_note(document->loader, material, "emissive textures are left out: %s", fault);
}

static void read_emission(gltf_document *document, const cJSON *from, engine_scene_material *material)
{
	double factor[3] = {0, 0, 0}, strength = 1;
	const cJSON *extension = gltf_extension(from, "KHR_materials_emissive_strength");
	if (!gltf_numbers(from, "emissiveFactor", 3, factor) || !gltf_number(extension, "emissiveStrength", &strength))
		import_note(document->loader, material->name, "emissions that are no finite numbers are left out");
	if (factor[0] != 0 || factor[1] != 0 || factor[2] != 0)
		apply_mean(document, gltf_member(from, "emissiveTexture"), material->name, factor);
	for (int c = 0; c < 3; c++)
		material->radiance[c] = (float)(factor[c] * strength);
}

/* The colour of the old specular-glossiness model is its diffuse reflectance, which is what rho is. */
static void read_colour(gltf_document *document, const cJSON *from, const char *name, double color[4])
{
	const cJSON *surface = gltf_member(from, "pbrMetallicRoughness");
	const cJSON *old = gltf_extension(from, "KHR_materials_pbrSpecularGlossiness");
	bool given = gltf_member(surface, "baseColorFactor") || gltf_member(surface, "baseColorTexture");
	bool sound = !given && old ? gltf_numbers(old, "diffuseFactor", 4, color)
				   : gltf_numbers(surface, "baseColorFactor", 4, color);
	if (!sound)
		import_note(document->loader, name, "colours that are no finite numbers are taken as 0.5");
	note_unread(document, gltf_member(surface, "baseColorTexture") || gltf_member(old, "diffuseTexture"), name,
		    "textures of base colours are not read, their factors are");
}

/* Alpha as coverage: what covers less than half lets the light through. */
static bool is_clear(gltf_document *document, const cJSON *from, const char *name, double alpha)
{
	const char *mode = gltf_text(from, "alphaMode");
	double cutoff = 0.5;
	if (!mode || strcmp(mode, "OPAQUE") == 0)
		return false;
	if (strcmp(mode, "MASK") == 0)
		gltf_number(from, "alphaCutoff", &cutoff);
	bool clear = alpha < cutoff;
	note_unread(document, !clear && alpha < 1, name, "transparency of alpha above a half is taken as opaque");
	return clear;
}

/* Rougher surfaces are no mirrors and no clear glass. */
static const double SMOOTH = 0.1;

static double clamp(double x, double least, double most)
{
	return x > least ? fmin(x, most) : least; /* no number: least */
}

/* The defaults are 1, where there is a surface at all. */
static double surface_factor(const cJSON *surface, const char *key, double without)
{
	double factor = 1;
	return surface && gltf_number(surface, key, &factor) ? clamp(factor, 0, 1) : without;
}

/* Of what is metal, or lets light through, that much is no longer diffuse. */
static void take_share(engine_scene_material *material, const double color[3], double share, float to[3])
{
	for (int c = 0; c < 3; c++) {
		const double part = clamp(color[c], 0, 1) * share;
		to[c] = (float)part;
		material->rho[c] = (float)clamp(color[c] - part, 0, 1 - part);
	}
}

/* A smooth metal is a mirror of its colour, what transmits is glass of its colour. */
static void read_smoothness(gltf_document *document, const cJSON *from, const double color[3],
			    engine_scene_material *material)
{
	const cJSON *surface = gltf_member(from, "pbrMetallicRoughness");
	const cJSON *transmits = gltf_extension(from, "KHR_materials_transmission");
	const double metallic = surface_factor(surface, "metallicFactor", 0);
	const bool smooth = surface_factor(surface, "roughnessFactor", 1) < SMOOTH;
	double transmission = 0, index = 1.5;
	if (transmits && !gltf_number(transmits, "transmissionFactor", &transmission))
		transmission = 0;
	transmission = clamp(transmission, 0, 1) * (1 - metallic);
	gltf_number(gltf_extension(from, "KHR_materials_ior"), "ior", &index);
	if (transmission > 0) {
		take_share(material, color, transmission, material->glass);
		material->index = (float)clamp(index, 1, 4);
		note_unread(document, !smooth, material->name, "rough glass is taken as clear");
		note_unread(document, gltf_member(transmits, "transmissionTexture"), material->name,
			    "textures of transmission are not read");
	} else if (metallic > 0 && smooth) {
		take_share(material, color, metallic, material->mirror);
	} else {
		note_unread(document, metallic > 0, material->name, "rough metals are taken as diffuse");
	}
}

static bool read_material(gltf_document *document, const cJSON *from)
{
	engine_scene_material *material = import_add_material(document->loader, gltf_text(from, "name"));
	double color[4] = {0.5, 0.5, 0.5, 1};
	if (!material)
		return false;
	read_colour(document, from, material->name, color);
	read_emission(document, from, material);
	for (int c = 0; c < 3; c++)
		material->rho[c] = (float)color[c];
	material->double_sided = cJSON_IsTrue(gltf_member(from, "doubleSided"));
	material->clear = is_clear(document, from, material->name, color[3]);
	const cJSON *surface = gltf_member(from, "pbrMetallicRoughness");
	read_smoothness(document, from, color, material);
	note_unread(document, gltf_member(surface, "metallicRoughnessTexture") || gltf_member(from, "normalTexture"),
		    material->name, "textures of roughness, metal and normals are not read");
	return true;
}

bool gltf_material_number(gltf_document *document, const cJSON *primitive, uint32_t *number)
{
	int64_t material = -1;
	if (!gltf_index(document, primitive, "material", GLTF_MATERIALS, &material))
		import_note(document->loader, NULL, "materials that the file does not hold are taken as grey");
	if (material < 0)
		return import_default_material(document->loader, number);
	uint32_t *known = &document->materials[material];
	if (*known == 0) {
		if (!read_material(document, document->tables[GLTF_MATERIALS].items[material]))
			return false;
		*known = document->loader->scene->material_count;
	}
	*number = *known - 1;
	return true;
}
