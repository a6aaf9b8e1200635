/* OBJ and PLY through assimp. Positions, polygons and materials only: what comes apart by normals and texture
 * coordinates is welded again afterwards.
 */
#include "mesh_clean.h"
#include "scene_internal.h"

#include <assimp/cimport.h>
#include <assimp/material.h>
#include <assimp/mesh.h>
#include <assimp/scene.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static bool is_ply(const scene_loader *loader)
{
	size_t length = strlen(loader->path);
	return length >= 4 && strcasecmp(loader->path + length - 4, ".ply") == 0;
}

static void read_color(const struct aiMaterial *from, const char *key, float rgb[3])
{
	struct aiColor4D color;
	if (aiGetMaterialColor(from, key, 0, 0, &color) != aiReturn_SUCCESS)
		return;
	rgb[0] = color.r;
	rgb[1] = color.g;
	rgb[2] = color.b;
}

static bool add_material(scene_loader *loader, const struct aiMaterial *from)
{
	struct aiString name = {0};
	aiGetMaterialString(from, AI_MATKEY_NAME, &name);
	engine_scene_material *material = scene_add_material(loader, name.data);
	if (!material)
		return false;
	/* assimp's stand-in for faces without usemtl, and what it makes up for a PLY (white), are no statements of a
	 * file. */
	if (is_ply(loader) || strcmp(name.data, AI_DEFAULT_MATERIAL_NAME) == 0)
		return true;
	read_color(from, "$clr.diffuse", material->rho);
	read_color(from, "$clr.emissive", material->radiance);
	return true;
}

/* A face of one or two corners is a point or a line. */
static void add_face(engine_mesh *part, const struct aiFace *face)
{
	if (face->mNumIndices < 3)
		return;
	memcpy(part->indices + part->index_count, face->mIndices, face->mNumIndices * sizeof *part->indices);
	part->index_count += face->mNumIndices;
	part->face_counts[part->face_count++] = face->mNumIndices;
}

static bool fill_part(engine_mesh *part, const struct aiMesh *mesh)
{
	size_t corners = 0;
	for (unsigned f = 0; f < mesh->mNumFaces; f++)
		corners += mesh->mFaces[f].mNumIndices;
	part->positions = malloc((3 * (size_t)mesh->mNumVertices + 1) * sizeof(float));
	part->face_counts = malloc(((size_t)mesh->mNumFaces + 1) * sizeof(uint32_t));
	part->indices = malloc((corners + 1) * sizeof(uint32_t));
	if (!part->positions || !part->face_counts || !part->indices || corners > UINT32_MAX)
		return false;
	part->vertex_count = mesh->mNumVertices;
	memcpy(part->positions, mesh->mVertices, 3 * (size_t)mesh->mNumVertices * sizeof(float));
	for (unsigned f = 0; f < mesh->mNumFaces; f++)
		add_face(part, &mesh->mFaces[f]);
	return true;
}

static bool append_mesh(scene_loader *loader, engine_mesh *mesh, const struct aiMesh *from)
{
	if (!from->mVertices || !from->mFaces || from->mMaterialIndex >= loader->scene->material_count)
		return true; /* points, lines or nothing */
	engine_mesh part = {0};
	bool appended = fill_part(&part, from) && engine_mesh_append(mesh, &part, from->mMaterialIndex);
	engine_mesh_free(&part);
	return appended || scene_fail(loader, "out of memory for a mesh of %u vertices", from->mNumVertices);
}

static bool add_node(scene_loader *loader, const struct aiScene *from, const struct aiNode *node)
{
	engine_mesh mesh = {0};
	scene_object_def def = {.name = node->mName.data};
	for (unsigned i = 0; i < node->mNumMeshes; i++) {
		if (!append_mesh(loader, &mesh, from->mMeshes[node->mMeshes[i]])) {
			engine_mesh_free(&mesh);
			return false;
		}
	}
	if (mesh.face_count > 0 && !scene_add_object(loader, &def, &mesh))
		return false;
	engine_mesh_free(&mesh);
	for (unsigned i = 0; i < node->mNumChildren; i++) {
		if (!add_node(loader, from, node->mChildren[i]))
			return false;
	}
	return true;
}

static bool convert(scene_loader *loader, const struct aiScene *from)
{
	/* Both formats place their objects in world space: one node at the origin serves all. */
	if (!scene_make_graph(loader, 1))
		return false;
	for (unsigned i = 0; i < from->mNumMaterials; i++) {
		if (!add_material(loader, from->mMaterials[i]))
			return false;
	}
	if (!from->mRootNode || !add_node(loader, from, from->mRootNode))
		return false;
	return loader->faces_seen > 0 || scene_fail(loader, "holds no faces");
}

/* Opens what a mtllib line names, beside the OBJ. */
static bool library_exists(const char *obj_path, const char *name)
{
	char path[2048];
	const char *slash = strrchr(obj_path, '/');
	int folder = slash ? (int)(slash - obj_path + 1) : 0;
	snprintf(path, sizeof path, "%.*s%s", folder, obj_path, name);
	FILE *file = fopen(path, "rb");
	if (file)
		fclose(file);
	return file != NULL;
}

/* assimp only logs a missing .mtl; a scene whose lamps have gone out should say why. */
static void warn_of_missing_library(scene_loader *loader)
{
	FILE *file = fopen(loader->path, "rb");
	char line[1024], name[512];
	/* The line stands before the first face in every file seen; 1,000 lines of comments are enough. */
	for (int i = 0; file && i < 1000 && fgets(line, sizeof line, file) && line[0] != 'f'; i++) {
		if (sscanf(line, "mtllib %511[^\r\n]", name) != 1)
			continue;
		if (!library_exists(loader->path, name))
			scene_note(loader, name, "material libraries cannot be opened");
		break;
	}
	if (file)
		fclose(file);
}

/* Reads lines to the end of the header and sums up its elements. False: the header does not end. */
static bool read_ply_header(FILE *file, double *elements)
{
	char line[1024];
	for (int i = 0; i < 1000 && fgets(line, sizeof line, file); i++) {
		double count = 0;
		if (strcmp(line, "end_header\n") == 0 || strcmp(line, "end_header\r\n") == 0)
			return true;
		if (sscanf(line, " element %*s %lf", &count) == 1)
			*elements += count;
	}
	return false;
}

/* assimp 5.2.5 reads the header of a PLY that was cut off there for ever, and makes room for what a header states
 * before it looks for it. An element takes a byte or more.
 */
static bool check_ply(scene_loader *loader)
{
	FILE *file = fopen(loader->path, "rb");
	double elements = 0;
	bool ended = file && read_ply_header(file, &elements);
	long size = ended && fseek(file, 0, SEEK_END) == 0 ? ftell(file) : 0;
	if (file)
		fclose(file);
	if (!ended)
		return scene_fail(loader, "is no PLY file, or cut off in its header");
	return elements <= (double)size ||
	       scene_fail(loader, "states %.0f vertices and faces in a file of %ld bytes", elements, size);
}

bool scene_read_assimp(scene_loader *loader)
{
	if (!is_ply(loader))
		warn_of_missing_library(loader);
	else if (!check_ply(loader))
		return false;
	const struct aiScene *from = aiImportFile(loader->path, 0);
	if (!from)
		return scene_fail(loader, "%s", aiGetErrorString());
	bool converted = convert(loader, from);
	aiReleaseImport(from);
	return converted;
}
