/* Materials of a glTF file: the diffuse part of each, its emission, and what of the rest is told. */
#include "gltf_scene.h"

#include <math.h>
#include <string.h>

static void note_unread(gltf_document *document, bool found, const char *material, const char *text)
{
	if (found)
		import_note(document->loader, material, "%s", text);
}

/* ---- textures ---- */

static engine_wrap wrap_of(const cJSON *sampler, const char *key)
{
	double mode = 10497;
	gltf_number(sampler, key, &mode);
	return mode == 33071 ? ENGINE_WRAP_CLAMP : mode == 33648 ? ENGINE_WRAP_MIRROR : ENGINE_WRAP_REPEAT;
}

/* KHR_texture_transform: scale, then rotation by an angle, then offset. */
static void read_transform(const cJSON *from, engine_texture_use *use)
{
	double offset[2] = {0, 0}, scale[2] = {1, 1}, angle = 0;
	gltf_numbers(from, "offset", 2, offset);
	gltf_numbers(from, "scale", 2, scale);
	gltf_number(from, "rotation", &angle);
	const double c = cos(angle), s = sin(angle);
	const double rows[2][3] = {{c * scale[0], s * scale[1], offset[0]}, {-s * scale[0], c * scale[1], offset[1]}};
	for (int k = 0; k < 6; k++)
		use->transform[k / 3][k % 3] = (float)rows[k / 3][k % 3];
}

/* Set of texture coordinates that a reference asks for. */
static uint32_t uv_set_of(const cJSON *reference, const cJSON *transform)
{
	double set = 0;
	gltf_number(reference, "texCoord", &set);
	gltf_number(transform, "texCoord", &set);
	return set >= 0 && set < 8 ? (uint32_t)set : 0;
}

/* The texture that a material refers to: its number and one, how it is looked up, and its mean. 0 where there is none
 * or it cannot be read, which is told. `of` is plural. */
static engine_texture_use find_texture(gltf_document *document, const cJSON *reference, const char *material,
				       const char *of, uint32_t *uv_set, float mean[4])
{
	int64_t texture = -1, sampler = -1;
	const char *fault = "the texture names no image";
	uint32_t number = 0;
	if (!reference)
		return engine_texture_use_of(0);
	const bool found = gltf_index(document, reference, "index", GLTF_TEXTURES, &texture) && texture >= 0;
	const int64_t image = found ? document->texture_images[texture] : -1;
	float found_mean[4];
	if (image < 0 || !gltf_image_texture(document, image, &number, found_mean, &fault)) {
		import_note(document->loader, material, "%s are left out: %s", of, fault);
		return engine_texture_use_of(0);
	}
	memcpy(mean, found_mean, sizeof found_mean);
	engine_texture_use use = engine_texture_use_of(number);
	const cJSON *transform = gltf_extension(reference, "KHR_texture_transform");
	gltf_index(document, document->tables[GLTF_TEXTURES].items[texture], "sampler", GLTF_SAMPLERS, &sampler);
	const cJSON *from = sampler >= 0 ? document->tables[GLTF_SAMPLERS].items[sampler] : NULL;
	use.wrap[0] = wrap_of(from, "wrapS");
	use.wrap[1] = wrap_of(from, "wrapT");
	if (transform)
		read_transform(transform, &use);
	*uv_set = uv_set_of(reference, transform);
	return use;
}

static void read_emission(gltf_document *document, const cJSON *from, engine_scene_material *material)
{
	double factor[3] = {0, 0, 0}, strength = 1;
	const cJSON *extension = gltf_extension(from, "KHR_materials_emissive_strength");
	if (!gltf_numbers(from, "emissiveFactor", 3, factor) || !gltf_number(extension, "emissiveStrength", &strength))
		import_note(document->loader, material->name, "emissions that are no finite numbers are left out");
	float mean[4] = {1, 1, 1, 1};
	uint32_t uv_set = material->uv_set;
	if (factor[0] != 0 || factor[1] != 0 || factor[2] != 0)
		material->radiance_texture = find_texture(document, gltf_member(from, "emissiveTexture"),
							  material->name, "emissive textures", &uv_set, mean);
	for (int c = 0; c < 3; c++) {
		material->radiance_factor[c] = (float)(factor[c] * strength);
		material->radiance[c] = (float)(factor[c] * strength * (double)mean[c]);
	}
	if (material->radiance_texture.number && !material->rho_texture.number) {
		material->uv_set = uv_set;
	} else if (material->radiance_texture.number && uv_set != material->uv_set) {
		material->radiance_texture.number = 0;
		import_note(document->loader, material->name,
			    "emissive textures with coordinates of their own are read as their mean");
	}
}

/* The extension that holds the old specular-glossiness model, where the material says nothing of the new one; NULL: it
 * does. */
static const cJSON *old_model(const cJSON *material)
{
	const cJSON *surface = gltf_member(material, "pbrMetallicRoughness");
	const bool given = gltf_member(surface, "baseColorFactor") || gltf_member(surface, "baseColorTexture");
	return given ? NULL : gltf_extension(material, "KHR_materials_pbrSpecularGlossiness");
}

/* The colour of the old specular-glossiness model is its diffuse reflectance, which is what rho is. Returns the factor
 * of alpha, which the colour's is times the mean of its texture's. */
static double read_colour(gltf_document *document, const cJSON *from, engine_scene_material *material, double color[4])
{
	const char *name = material->name;
	float mean[4] = {1, 1, 1, 1};
	const cJSON *old = old_model(from), *surface = old ? old : gltf_member(from, "pbrMetallicRoughness");
	const char *factor_key = old ? "diffuseFactor" : "baseColorFactor";
	const cJSON *texture = gltf_member(surface, old ? "diffuseTexture" : "baseColorTexture");
	const bool factor = gltf_member(surface, factor_key);
	if (!gltf_numbers(surface, factor_key, 4, color))
		import_note(document->loader, name, "colours that are no finite numbers are taken as 0.5");
	if (texture && !factor)
		color[0] = color[1] = color[2] = color[3] = 1;
	material->rho_texture =
	    find_texture(document, texture, name, "textures of base colours", &material->uv_set, mean);
	if (texture && !material->rho_texture.number && !factor)
		color[0] = color[1] = color[2] = 0.5;
	const double alpha = color[3];
	for (int c = 0; c < 4; c++) {
		if (c < 3 && (factor || material->rho_texture.number))
			material->rho_factor[c] = (float)color[c];
		color[c] *= (double)mean[c];
	}
	return alpha;
}

/* Alpha as coverage: what covers less than half lets the light through. Where a texture, or colours of vertices, say
 * what, face by face. factor: of what the texture has. */
static void read_alpha(gltf_document *document, const cJSON *from, engine_scene_material *material, double factor)
{
	const char *mode = gltf_text(from, "alphaMode");
	double cutoff = 0.5;
	if (!mode || strcmp(mode, "OPAQUE") == 0)
		return;
	if (strcmp(mode, "MASK") == 0)
		gltf_number(from, "alphaCutoff", &cutoff);
	material->alpha_texture = material->rho_texture;
	material->alpha_factor = (float)factor;
	material->cutoff = (float)cutoff;
	note_unread(document, !material->rho_texture.number && factor >= cutoff && factor < 1, material->name,
		    "transparency of alpha above a half is taken as opaque");
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

/* Mirrors and glass have the mean of a texture; colours of vertices tint what is left of them that is diffuse. */
static void keep_mean(engine_scene_material *material)
{
	material->rho_texture.number = 0;
	memcpy(material->rho_factor, material->rho, sizeof material->rho_factor);
}

/* A smooth metal is a mirror of its colour, what transmits is glass of its colour. */
static void read_smoothness(gltf_document *document, const cJSON *from, const double color[3],
			    engine_scene_material *material)
{
	const cJSON *surface = old_model(from) ? NULL : gltf_member(from, "pbrMetallicRoughness");
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

/* More than what is not metal reflects in front of its colour is told. */
static void note_shine(gltf_document *document, const cJSON *old, const char *name)
{
	double specular[3] = {0, 0, 0};
	gltf_numbers(old, "specularFactor", 3, specular);
	note_unread(document, fmax(specular[0], fmax(specular[1], specular[2])) > 0.1, name,
		    "specular colours of the specular-glossiness model are not read");
}

static bool read_material(gltf_document *document, const cJSON *from)
{
	engine_scene_material *material = import_add_material(document->loader, gltf_text(from, "name"));
	double color[4] = {0.5, 0.5, 0.5, 1}, alpha;
	if (!material)
		return false;
	alpha = read_colour(document, from, material, color);
	read_emission(document, from, material);
	for (int c = 0; c < 3; c++)
		material->rho[c] = (float)color[c];
	material->double_sided = cJSON_IsTrue(gltf_member(from, "doubleSided"));
	read_alpha(document, from, material, alpha);
	note_shine(document, old_model(from), material->name);
	const cJSON *surface = gltf_member(from, "pbrMetallicRoughness");
	read_smoothness(document, from, color, material);
	if (memcmp(material->mirror, (const float[3]){0}, sizeof material->mirror) != 0 ||
	    memcmp(material->glass, (const float[3]){0}, sizeof material->glass) != 0)
		keep_mean(material);
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
