// OGRE 1.12 draws the room of host_room.h by its own meshes, materials and GL3Plus render system, and takes the light
// of the library. Under X, Xvfb will do: Debian's OGRE makes its context by GLX.
//
//     ogre_host [PREFIX]    pictures: PREFIX_host_0.png and so on, default ogre; 77: no window, no OpenGL 4.5
#include "host_room.h"

#include <Ogre.h>

#include <glad/gl.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

extern "C" gi_proc glXGetProcAddressARB(const unsigned char *name);

// A texture unit that OGRE leaves alone: it uses the first 16. Its prefab sphere has a radius of 50 units.
enum { UNIT = 15, FRAMES = 4 };
static const float BALL_SCALE = HOST_BALL_RADIUS / 50;

// Attributes by OGRE's names; the map rides in texture coordinates, numbers as floats.
static const char *const VERTEX = "in vec4 vertex;\n"
				  "in vec4 uv1;\n"
				  "in vec4 uv2;\n"
				  "uniform mat4 clip_from_object;\n"
				  "uniform float first_light;\n"
				  "uniform vec3 rho, exitance;\n"
				  "out vec3 radiance;\n"
				  "void main()\n"
				  "{\n"
				  "	vec3 h = gi_light_at_vertex(uint(first_light), uvec4(uv1), uv2);\n"
				  "	radiance = gi_radiance(rho, exitance, h);\n"
				  "	gl_Position = clip_from_object * vertex;\n"
				  "}\n";
static const char *const FRAGMENT = "#version 330\n"
				    "in vec3 radiance;\n"
				    "out vec4 color;\n"
				    "void main()\n"
				    "{\n"
				    "	color = vec4(radiance, 1);\n"
				    "}\n";

static const std::string &group = Ogre::RGN_DEFAULT;

static gi_proc find_gl(const char *name, void *)
{
	return glXGetProcAddressARB(reinterpret_cast<const unsigned char *>(name));
}

static Ogre::Vector3 vector_of(const float v[3])
{
	return Ogre::Vector3(v[0], v[1], v[2]);
}

static Ogre::Vector4 light_of(const gi_vertex_light &m)
{
	return Ogre::Vector4(float(m.light[0]), float(m.light[1]), float(m.light[2]), float(m.light[3]));
}

static void make_programs()
{
	Ogre::HighLevelGpuProgramManager &programs = Ogre::HighLevelGpuProgramManager::getSingleton();
	const std::string text = std::string("#version 330\n") + gi_glsl("gi_light.glsl") + VERTEX;
	Ogre::HighLevelGpuProgramPtr vertex =
	    programs.createProgram("lit.vert", group, "glsl", Ogre::GPT_VERTEX_PROGRAM);
	vertex->setSource(text);
	Ogre::HighLevelGpuProgramPtr fragment =
	    programs.createProgram("lit.frag", group, "glsl", Ogre::GPT_FRAGMENT_PROGRAM);
	fragment->setSource(FRAGMENT);
	vertex->load();
	fragment->load();
}

static Ogre::MaterialPtr make_material(const std::string &name, const gi_material &m, uint32_t first_light)
{
	Ogre::MaterialPtr material = Ogre::MaterialManager::getSingleton().create(name, group);
	Ogre::Pass *pass = material->getTechnique(0)->getPass(0);
	pass->setVertexProgram("lit.vert");
	pass->setFragmentProgram("lit.frag");
	Ogre::GpuProgramParametersSharedPtr values = pass->getVertexProgramParameters();
	values->setNamedAutoConstant("clip_from_object", Ogre::GpuProgramParameters::ACT_WORLDVIEWPROJ_MATRIX);
	values->setNamedConstant("rho", vector_of(m.rho));
	values->setNamedConstant("exitance", vector_of(m.exitance));
	values->setNamedConstant("first_light", float(first_light));
	values->setNamedConstant("gi_light_texels", int(UNIT));
	return material;
}

// A grid of 32 x 32 quads.
static Ogre::ManualObject *make_wall(Ogre::SceneManager *scene, const host_room &room, int k)
{
	const unsigned side = 33;
	const host_wall &wall = host_walls[k];
	const Ogre::Vector3 corner = vector_of(wall.corner), u = vector_of(wall.u), v = vector_of(wall.v);
	const Ogre::Vector3 normal = u.crossProduct(v).normalisedCopy();
	std::vector<Ogre::Vector3> positions, normals(side * side, normal);
	std::vector<gi_vertex_light> map(side * side);
	for (unsigned n = 0; n < side * side; n++)
		positions.push_back(corner + u * (float(n % side) / (side - 1)) + v * (float(n / side) / (side - 1)));
	host_room_map(&room, k, positions[0].ptr(), normals[0].ptr(), side * side, map.data());
	const Ogre::MaterialPtr material = make_material(wall.name, wall.material, room.ranges[k].first_light);
	Ogre::ManualObject *object = scene->createManualObject(wall.name);
	object->begin(material->getName(), Ogre::RenderOperation::OT_TRIANGLE_LIST, group);
	for (unsigned n = 0; n < side * side; n++) {
		object->position(positions[n]);
		object->normal(normal);
		object->textureCoord(0, 0);
		object->textureCoord(light_of(map[n]));
		object->textureCoord(Ogre::Vector4(map[n].weight));
	}
	for (unsigned n = 0; n < side * (side - 1); n++)
		if (n % side + 1 < side)
			object->quad(n, n + 1, n + 1 + side, n + side);
	object->end();
	return object;
}

// One element of all vertices of a mesh.
static std::vector<Ogre::Vector3> read_vertices(const Ogre::VertexData *data, Ogre::VertexElementSemantic semantic)
{
	const Ogre::VertexElement *element = data->vertexDeclaration->findElementBySemantic(semantic);
	Ogre::HardwareVertexBufferSharedPtr buffer = data->vertexBufferBinding->getBuffer(element->getSource());
	std::vector<Ogre::Vector3> out(data->vertexCount);
	unsigned char *bytes = static_cast<unsigned char *>(buffer->lock(Ogre::HardwareBuffer::HBL_READ_ONLY));
	for (size_t n = 0; n < out.size(); n++, bytes += buffer->getVertexSize()) {
		float *values;
		element->baseVertexPointerToElement(bytes, &values);
		out[n] = vector_of(values);
	}
	buffer->unlock();
	return out;
}

// OGRE's own sphere: the map becomes a vertex buffer more of its mesh.
static Ogre::Entity *make_ball(Ogre::SceneManager *scene, const host_room &room)
{
	Ogre::Entity *ball = scene->createEntity("ball", Ogre::SceneManager::PT_SPHERE);
	Ogre::SubMesh *mesh = ball->getMesh()->getSubMesh(0);
	Ogre::VertexData *data = mesh->useSharedVertices ? ball->getMesh()->sharedVertexData : mesh->vertexData;
	const std::vector<Ogre::Vector3> positions = read_vertices(data, Ogre::VES_POSITION),
					 normals = read_vertices(data, Ogre::VES_NORMAL);
	std::vector<gi_vertex_light> map(positions.size());
	host_room_map(&room, HOST_BALL, positions[0].ptr(), normals[0].ptr(), uint32_t(map.size()), map.data());
	std::vector<Ogre::Vector4> values;
	for (const gi_vertex_light &m : map) {
		values.push_back(light_of(m));
		values.push_back(Ogre::Vector4(m.weight));
	}
	const unsigned short source = data->vertexBufferBinding->getNextIndex();
	const size_t half = sizeof values[0];
	Ogre::HardwareVertexBufferSharedPtr buffer = Ogre::HardwareBufferManager::getSingleton().createVertexBuffer(
	    2 * half, map.size(), Ogre::HardwareBuffer::HBU_STATIC);
	buffer->writeData(0, buffer->getSizeInBytes(), values.data());
	data->vertexDeclaration->addElement(source, 0, Ogre::VET_FLOAT4, Ogre::VES_TEXTURE_COORDINATES, 1);
	data->vertexDeclaration->addElement(source, half, Ogre::VET_FLOAT4, Ogre::VES_TEXTURE_COORDINATES, 2);
	data->vertexBufferBinding->setBinding(source, buffer);
	ball->setMaterial(make_material("ball", host_ball_material, room.ranges[HOST_BALL].first_light));
	return ball;
}

static Ogre::Camera *make_camera(Ogre::SceneManager *scene)
{
	Ogre::Camera *camera = scene->createCamera("camera");
	Ogre::Matrix4 view, clip;
	for (int k = 0; k < 16; k++) {
		view[k % 4][k / 4] = host_view_from_world[k];
		clip[k % 4][k / 4] = host_clip_from_view[k];
	}
	scene->getRootSceneNode()->createChildSceneNode()->attachObject(camera);
	camera->setCustomViewMatrix(true, Ogre::Affine3(view));
	camera->setCustomProjectionMatrix(true, clip);
	return camera;
}

static Ogre::RenderTexture *make_target(Ogre::Camera *camera)
{
	Ogre::TexturePtr texture = Ogre::TextureManager::getSingleton().createManual(
	    "picture", group, Ogre::TEX_TYPE_2D, HOST_WIDTH, HOST_HEIGHT, 0, Ogre::PF_FLOAT32_RGBA,
	    Ogre::TU_RENDERTARGET);
	Ogre::RenderTexture *target = texture->getBuffer()->getRenderTarget();
	Ogre::Viewport *viewport = target->addViewport(camera);
	viewport->setBackgroundColour(Ogre::ColourValue::Black);
	viewport->setOverlaysEnabled(false);
	target->setAutoUpdated(false);
	return target;
}

// OGRE has the top row first.
static void read_target(Ogre::RenderTexture *target, std::vector<float> &out)
{
	const Ogre::Box all(0, 0, HOST_WIDTH, HOST_HEIGHT);
	const size_t row = 4 * HOST_WIDTH;
	target->copyContentsToMemory(all, Ogre::PixelBox(all, Ogre::PF_FLOAT32_RGBA, out.data()));
	for (size_t y = 0; y < HOST_HEIGHT / 2; y++)
		std::swap_ranges(&out[y * row], &out[y * row] + row, &out[(HOST_HEIGHT - 1 - y) * row]);
}

static Ogre::RenderWindow *open_window(Ogre::Root &root)
{
	root.loadPlugin(OGRE_PLUGINS "/RenderSystem_GL3Plus");
	root.setRenderSystem(root.getAvailableRenderers().front());
	root.initialise(false);
	const Ogre::NameValuePairList options = {{"hidden", "true"}};
	return root.createRenderWindow("relume", HOST_WIDTH, HOST_HEIGHT, false, &options);
}

static bool play(Ogre::Root &root, const char *prefix)
{
	host_room room;
	float place[3];
	host_room_open(&room, find_gl, nullptr, BALL_SCALE);
	host_room_move(&room, 0, place);
	Ogre::SceneManager *scene = root.createSceneManager();
	make_programs();
	for (int k = 0; k < HOST_WALLS; k++)
		scene->getRootSceneNode()->attachObject(make_wall(scene, room, k));
	Ogre::SceneNode *mover = scene->getRootSceneNode()->createChildSceneNode();
	mover->attachObject(make_ball(scene, room));
	mover->setScale(Ogre::Vector3(BALL_SCALE));
	Ogre::RenderTexture *target = make_target(make_camera(scene));

	std::vector<float> host[2], gi[2];
	double ms = 0;
	for (int frame = 0; frame < FRAMES; frame++) {
		host_room_move(&room, float(frame) / (FRAMES - 1), place);
		mover->setPosition(vector_of(place));
		const auto began = std::chrono::steady_clock::now();
		glBindTextureUnit(UNIT, room.buffers.light_indirect_texture);
		target->update();
		glFinish();
		if (frame)
			ms +=
			    std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began).count();
		if (frame && frame + 1 < FRAMES)
			continue;
		const int end = frame > 0;
		host[end].resize(4 * HOST_PIXELS);
		gi[end].resize(4 * HOST_PIXELS);
		read_target(target, host[end]);
		host_room_draw(&room, gi[end].data());
	}
	float *const hosts[2] = {host[0].data(), host[1].data()}, *const gis[2] = {gi[0].data(), gi[1].data()};
	const bool right = host_room_judge(&room, prefix, hosts, gis, ms / (FRAMES - 1));
	host_room_close(&room);
	return right;
}

int main(int argc, char **argv)
{
	Ogre::LogManager log;
	log.createLog("", true, false, true); // not a file
	Ogre::Root root("", "", "");
	try {
		open_window(root);
	} catch (const Ogre::Exception &e) {
		std::fprintf(stderr, "ogre_host: skipped, no window: %s\n", e.getDescription().c_str());
		return 77;
	}
	return play(root, argc > 1 ? argv[1] : "ogre") ? 0 : 1;
}
