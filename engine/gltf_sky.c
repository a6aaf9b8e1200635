/* EXT_lights_image_based of a glTF scene as a picture of its sky, all round (equirectangular). */
#include "gltf_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

/* Brighter radiance the library does not take, W/(m2 sr). */
static const double BRIGHTEST = 3e11;

/* Columns of the picture: four faces of the cube lie side by side round the horizon. Places looked at in each texel, a
 * side: with one alone a sun of one texel would be there or not. */
enum { LEAST_COLUMNS = 256, MOST_COLUMNS = 2048, PLACES = 4 };

/* Where the light of a direction is known from: six faces, or harmonics. */
typedef struct environment {
	const engine_texture *faces[6]; /* +x -x +y -y +z -z; NULL: harmonics */
	double harmonics[9][3];         /* of the radiance */
	double linear[256];             /* of sRGB values */
	double rotation[4];             /* world from environment: x y z w */
	double intensity;
} environment;

/* ---- what the file says ---- */

/* Numbers of the images of the largest mip. */
static const char *find_faces(gltf_document *document, const cJSON *light, environment *e)
{
	const cJSON *mip = gltf_member(light, "specularImages"), *item;
	uint32_t textures[6];
	int count = 0;
	if (!mip)
		return "it has no specularImages";
	cJSON_ArrayForEach(item, mip->child)
	{
		const double number = cJSON_IsNumber(item) ? item->valuedouble : -1;
		const char *fault;
		float mean[4];
		if (count == 6 || !(number >= 0 && number < document->tables[GLTF_IMAGES].count))
			return "its specularImages are not six images of the file";
		if (!gltf_image_texture(document, (int64_t)number, &textures[count++], mean, &fault))
			return fault;
	}
	if (count < 6)
		return "its specularImages are not six images of the file";
	for (int k = 0; k < 6; k++)
		e->faces[k] = &document->loader->scene->textures[textures[k] - 1];
	return NULL;
}

/* Of the irradiance, pi, 2 pi / 3 and pi / 4 times that of the radiance by band (Ramamoorthi and Hanrahan, "An
 * efficient representation for irradiance environment maps", 2001). */
static bool read_harmonics(const cJSON *light, environment *e)
{
	static const double bands[9] = {1, 2. / 3, 2. / 3, 2. / 3, .25, .25, .25, .25, .25};
	const cJSON *item, *number;
	int count = 0;
	cJSON_ArrayForEach(item, gltf_member(light, "irradianceCoefficients"))
	{
		int channels = 0;
		cJSON_ArrayForEach(number, item)
		{
			if (count == 9 || channels == 3 || !cJSON_IsNumber(number) || !isfinite(number->valuedouble))
				return false;
			e->harmonics[count][channels++] = number->valuedouble / (PI * bands[count]);
		}
		if (channels != 3)
			return false;
		count++;
	}
	return count == 9;
}

static const char *read_environment(gltf_document *document, const cJSON *light, environment *e)
{
	*e = (environment){.rotation = {0, 0, 0, 1}, .intensity = 1};
	double *q = e->rotation;
	if (!gltf_number(light, "intensity", &e->intensity) || !gltf_numbers(light, "rotation", 4, q) ||
	    !(e->intensity >= 0))
		return "its intensity or rotation is no finite number, or below 0";
	const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
	if (!(length > 1e-6 && length < 1e6))
		return "its rotation is no unit quaternion";
	for (int c = 0; c < 4; c++)
		q[c] /= length;
	for (int v = 0; v < 256; v++)
		e->linear[v] = engine_linear_of_srgb(v / 255.0);
	const char *fault = find_faces(document, light, e);
	if (!fault)
		return NULL;
	if (!read_harmonics(light, e))
		return fault;
	import_note(document->loader, gltf_text(light, "name"), "image-based lights are read by their coefficients: %s",
		    fault);
	return NULL;
}

/* ---- what is seen in a direction ---- */

/* v turned by the conjugate: v + 2 w (v x q) + 2 (v x q) x q. */
static void into_environment(const double q[4], const double v[3], double out[3])
{
	double across[3];
	for (int k = 0; k < 3; k++)
		across[k] = 2 * (v[(k + 1) % 3] * q[(k + 2) % 3] - v[(k + 2) % 3] * q[(k + 1) % 3]);
	for (int k = 0; k < 3; k++)
		out[k] = v[k] + q[3] * across[k] + across[(k + 1) % 3] * q[(k + 2) % 3] -
			 across[(k + 2) % 3] * q[(k + 1) % 3];
}

static uint32_t texel_of(double place, uint32_t size)
{
	return (uint32_t)fmin(fmax(0.5 * (place + 1) * size, 0), size - 1.0);
}

/* OpenGL's faces (table 8.19 of its specification), each mirrored left to right, as the extension has them: what is
 * seen from inside. Colours of PNG are divided by alpha (RGBD). */
static void look_at_faces(const environment *e, const double d[3], double radiance[3])
{
	/* of each face: axis and sign of what grows to the right and downwards */
	static const struct {
		int right, down;
		double right_sign, down_sign;
	} sides[6] = {{2, 1, 1, -1}, {2, 1, -1, -1}, {0, 2, -1, 1}, {0, 2, -1, -1}, {0, 1, -1, -1}, {0, 1, 1, -1}};
	int axis = 0;
	for (int k = 1; k < 3; k++)
		if (fabs(d[k]) > fabs(d[axis]))
			axis = k;
	const int face = 2 * axis + (d[axis] < 0);
	const engine_image_pixels *p = &e->faces[face]->pixels;
	const double far = fabs(d[axis]);
	const uint32_t column = texel_of(sides[face].right_sign * d[sides[face].right] / far, p->width),
		       row = texel_of(sides[face].down_sign * d[sides[face].down] / far, p->height);
	const uint8_t *texel = p->rgba + 4 * ((size_t)row * p->width + column);
	for (int c = 0; c < 3; c++)
		radiance[c] += e->linear[texel[c]] * 255 / fmax(texel[3], 1);
}

/* The real harmonics of bands 0 to 2, in the order of their numbers. */
static void look_at_harmonics(const environment *e, const double d[3], double radiance[3])
{
	const double x = d[0], y = d[1], z = d[2];
	const double basis[9] = {0.282094792,
				 0.488602512 * y,
				 0.488602512 * z,
				 0.488602512 * x,
				 1.092548431 * x * y,
				 1.092548431 * y * z,
				 0.315391565 * (3 * z * z - 1),
				 1.092548431 * x * z,
				 0.546274215 * (x * x - y * y)};
	for (int c = 0; c < 3; c++) {
		double sum = 0;
		for (int k = 0; k < 9; k++)
			sum += basis[k] * e->harmonics[k][c];
		radiance[c] += fmax(sum, 0);
	}
}

/* ---- the picture ---- */

/* A texel: the first row is above, the middle column towards -z, those right of it towards +x. */
static void fill_texel(const environment *e, const engine_sky *sky, uint32_t column, uint32_t row, float *texel)
{
	double sum[3] = {0};
	for (int k = 0; k < PLACES * PLACES; k++) {
		const double round = 2 * PI * ((column + (k % PLACES + .5) / PLACES) / sky->width - .5);
		const double down = PI * (row + (k / PLACES + .5) / PLACES) / sky->height;
		const double world[3] = {sin(down) * sin(round), cos(down), -sin(down) * cos(round)};
		double direction[3];
		into_environment(e->rotation, world, direction);
		if (e->faces[0])
			look_at_faces(e, direction, sum);
		else
			look_at_harmonics(e, direction, sum);
	}
	const double factor = ENGINE_WATTS_PER_LUMEN * e->intensity / (PLACES * PLACES);
	for (int c = 0; c < 3; c++)
		texel[c] = (float)fmin(sum[c] * factor, BRIGHTEST);
}

static bool fill(const environment *e, engine_sky *sky)
{
	const uint32_t wanted = e->faces[0] ? 4 * e->faces[0]->pixels.width : LEAST_COLUMNS;
	sky->width = wanted < LEAST_COLUMNS ? LEAST_COLUMNS : wanted > MOST_COLUMNS ? MOST_COLUMNS : wanted;
	sky->height = sky->width / 2;
	sky->radiance = malloc(3 * sizeof *sky->radiance * sky->width * sky->height);
	for (uint32_t row = 0; sky->radiance && row < sky->height; row++)
		for (uint32_t column = 0; column < sky->width; column++)
			fill_texel(e, sky, column, row, sky->radiance + 3 * ((size_t)row * sky->width + column));
	return sky->radiance != NULL;
}

bool gltf_read_sky(gltf_document *document, const cJSON *scene)
{
	const cJSON *reference = gltf_extension(scene, "EXT_lights_image_based");
	const cJSON *lights = gltf_member(gltf_extension(document->root, "EXT_lights_image_based"), "lights");
	double number = -1;
	environment e;
	if (!reference)
		return true;
	const bool sound = gltf_number(reference, "light", &number) && number >= 0 && number < INT32_MAX;
	const cJSON *light = sound && cJSON_IsArray(lights) ? cJSON_GetArrayItem(lights, (int)number) : NULL;
	const char *fault = cJSON_IsObject(light) ? read_environment(document, light, &e) : "the file does not hold it";
	if (fault) {
		import_note(document->loader, gltf_text(light, "name"), "image-based lights are left out: %s", fault);
		return true;
	}
	return fill(&e, &document->loader->scene->sky) ||
	       import_fail(document->loader, "out of memory for a picture of the sky");
}
