// OpenSceneGraph draws the room of host_room.h by its own meshes and shaders, in an embedded viewer on an EGL context
// of ours, and takes the light of the library.
//
//     osg_host [PREFIX]    pictures: PREFIX_host_0.png and so on, default osg; 77: no OpenGL context
#include "host_room.h"

#include <osg/CullFace>
#include <osg/Geometry>
#include <osg/MatrixTransform>
#include <osg/Program>
#include <osg/ShapeDrawable>
#include <osgViewer/Viewer>

#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <chrono>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

// Attributes that OpenSceneGraph has no use for, and a texture unit.
enum { LIGHT = 6, WEIGHT = 7, UNIT = 15, FRAMES = 4 };

static const char *const VERTEX = "in vec4 osg_Vertex;\n"
				  "in uvec4 light;\n"
				  "in vec4 weight;\n"
				  "uniform mat4 osg_ModelViewProjectionMatrix;\n"
				  "uniform int first_light;\n"
				  "uniform vec3 rho, exitance;\n"
				  "out vec3 radiance;\n"
				  "void main()\n"
				  "{\n"
				  "	vec3 h = gi_light_at_vertex(uint(first_light), light, weight);\n"
				  "	radiance = gi_radiance(rho, exitance, h);\n"
				  "	gl_Position = osg_ModelViewProjectionMatrix * osg_Vertex;\n"
				  "}\n";
static const char *const FRAGMENT = "#version 330\n"
				    "in vec3 radiance;\n"
				    "out vec4 color;\n"
				    "void main()\n"
				    "{\n"
				    "	color = vec4(radiance, 1);\n"
				    "}\n";

static gi_proc find_gl(const char *name, void *)
{
	return eglGetProcAddress(name);
}

// OpenSceneGraph as Debian has it wants what is deprecated, too.
static bool open_context()
{
	const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
				     4,
				     EGL_CONTEXT_MINOR_VERSION,
				     5,
				     EGL_CONTEXT_OPENGL_PROFILE_MASK,
				     EGL_CONTEXT_OPENGL_COMPATIBILITY_PROFILE_BIT,
				     EGL_NONE};
	const EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
	if (!eglInitialize(display, nullptr, nullptr) || !eglBindAPI(EGL_OPENGL_API))
		return false;
	const EGLContext context = eglCreateContext(display, nullptr, EGL_NO_CONTEXT, attributes);
	return context != EGL_NO_CONTEXT && eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context);
}

// A grid of 32 x 32 quads.
static osg::ref_ptr<osg::Geometry> make_wall(const host_wall &wall)
{
	const unsigned side = 33;
	osg::ref_ptr<osg::Vec3Array> vertices = new osg::Vec3Array, normals = new osg::Vec3Array;
	osg::ref_ptr<osg::DrawElementsUInt> triangles = new osg::DrawElementsUInt(GL_TRIANGLES);
	const osg::Vec3 corner(wall.corner[0], wall.corner[1], wall.corner[2]), u(wall.u[0], wall.u[1], wall.u[2]),
	    v(wall.v[0], wall.v[1], wall.v[2]);
	for (unsigned k = 0; k < side * side; k++) {
		vertices->push_back(corner + u * (float(k % side) / (side - 1)) + v * (float(k / side) / (side - 1)));
		normals->push_back(u ^ v);
		if (k % side + 1 == side || k / side + 1 == side)
			continue;
		for (unsigned next : {0u, 1u, side, side, 1u, side + 1})
			triangles->push_back(k + next);
	}
	osg::ref_ptr<osg::Geometry> geometry = new osg::Geometry;
	geometry->setVertexArray(vertices);
	geometry->setNormalArray(normals, osg::Array::BIND_PER_VERTEX);
	geometry->addPrimitiveSet(triangles);
	return geometry;
}

static osg::ref_ptr<osg::Geometry> make_ball()
{
	osg::ref_ptr<osg::TessellationHints> hints = new osg::TessellationHints;
	hints->setDetailRatio(1.5f);
	return new osg::ShapeDrawable(new osg::Sphere(osg::Vec3(), HOST_BALL_RADIUS), hints);
}

// Gives a mesh its share of the light as two attributes more.
static void map_light(const host_room &room, int surface, osg::Geometry *geometry)
{
	const osg::Vec3Array *vertices = static_cast<osg::Vec3Array *>(geometry->getVertexArray());
	const osg::Vec3Array *normals = static_cast<osg::Vec3Array *>(geometry->getNormalArray());
	const unsigned count = vertices->size();
	std::vector<gi_vertex_light> map(count);
	host_room_map(&room, surface, vertices->front().ptr(), normals->front().ptr(), count, map.data());
	osg::ref_ptr<osg::Vec4uiArray> light = new osg::Vec4uiArray(osg::Array::BIND_PER_VERTEX);
	osg::ref_ptr<osg::Vec4Array> weight = new osg::Vec4Array(osg::Array::BIND_PER_VERTEX);
	for (const gi_vertex_light &m : map) {
		light->push_back(osg::Vec4ui(m.light[0], m.light[1], m.light[2], m.light[3]));
		weight->push_back(osg::Vec4(m.weight[0], m.weight[1], m.weight[2], m.weight[3]));
	}
	light->setPreserveDataType(true); // integers stay integers
	geometry->setVertexAttribArray(LIGHT, light);
	geometry->setVertexAttribArray(WEIGHT, weight);
	geometry->setUseDisplayList(false);
	geometry->setUseVertexBufferObjects(true);
}

static void set_material(osg::StateSet *state, const gi_material &m, int first_light)
{
	state->addUniform(new osg::Uniform("rho", osg::Vec3(m.rho[0], m.rho[1], m.rho[2])));
	state->addUniform(new osg::Uniform("exitance", osg::Vec3(m.exitance[0], m.exitance[1], m.exitance[2])));
	state->addUniform(new osg::Uniform("first_light", first_light));
}

static osg::ref_ptr<osg::Program> make_program()
{
	osg::ref_ptr<osg::Program> program = new osg::Program;
	const std::string text = std::string("#version 330\n") + gi_glsl("gi_light.glsl") + VERTEX;
	program->addShader(new osg::Shader(osg::Shader::VERTEX, text));
	program->addShader(new osg::Shader(osg::Shader::FRAGMENT, FRAGMENT));
	program->addBindAttribLocation("light", LIGHT);
	program->addBindAttribLocation("weight", WEIGHT);
	return program;
}

// Before a picture.
struct take_light : osg::Camera::DrawCallback {
	const host_room *room;
	explicit take_light(const host_room *r) : room(r)
	{
	}
	void operator()(osg::RenderInfo &info) const override
	{
		osg::State &state = *info.getState();
		osg::GLExtensions *gl = state.get<osg::GLExtensions>();
		gl->glActiveTexture(GL_TEXTURE0 + UNIT);
		glBindTexture(GL_TEXTURE_BUFFER, room->buffers.light_indirect_texture);
		gl->glActiveTexture(GL_TEXTURE0 + state.getActiveTextureUnit());
	}
};

static void set_camera(osg::Camera *camera, const host_room *room)
{
	camera->setViewMatrix(osg::Matrixf(host_view_from_world));
	camera->setProjectionMatrix(osg::Matrixf(host_clip_from_view));
	camera->setProjectionResizePolicy(osg::Camera::FIXED);
	camera->setComputeNearFarMode(osg::CullSettings::DO_NOT_COMPUTE_NEAR_FAR);
	camera->setClearColor(osg::Vec4(0, 0, 0, 1));
	camera->setDrawBuffer(GL_COLOR_ATTACHMENT0);
	camera->setReadBuffer(GL_COLOR_ATTACHMENT0);
	camera->setInitialDrawCallback(new take_light(room));
}

static osg::ref_ptr<osg::Group> make_scene(const host_room &room, osg::MatrixTransform *mover)
{
	osg::ref_ptr<osg::Group> scene = new osg::Group;
	osg::StateSet *state = scene->getOrCreateStateSet();
	state->setAttributeAndModes(make_program());
	state->setAttributeAndModes(new osg::CullFace);
	state->addUniform(new osg::Uniform("gi_light_texels", int(UNIT)));
	for (int k = 0; k < HOST_SURFACES; k++) {
		osg::ref_ptr<osg::Geometry> mesh = k == HOST_BALL ? make_ball() : make_wall(host_walls[k]);
		map_light(room, k, mesh);
		set_material(mesh->getOrCreateStateSet(), k == HOST_BALL ? host_ball_material : host_walls[k].material,
			     int(room.ranges[k].first_light));
		(k == HOST_BALL ? mover : scene.get())->addChild(mesh);
	}
	scene->addChild(mover);
	return scene;
}

int main(int argc, char **argv)
{
	if (!open_context()) {
		std::fprintf(stderr, "osg_host: skipped, no OpenGL 4.5 compatibility context\n");
		return 77;
	}
	host_room room;
	float place[3];
	host_room_open(&room, find_gl, nullptr, 1);
	host_room_move(&room, 0, place);
	osg::ref_ptr<osg::MatrixTransform> mover = new osg::MatrixTransform;
	osgViewer::Viewer viewer;
	viewer.setThreadingModel(osgViewer::ViewerBase::SingleThreaded);
	osg::ref_ptr<osgViewer::GraphicsWindowEmbedded> window =
	    viewer.setUpViewerAsEmbeddedInWindow(0, 0, HOST_WIDTH, HOST_HEIGHT);
	window->getState()->setUseModelViewAndProjectionUniforms(true);
	window->getState()->setUseVertexAttributeAliasing(true);
	window->setDefaultFboId(room.host_framebuffer);
	set_camera(viewer.getCamera(), &room);
	viewer.setSceneData(make_scene(room, mover));
	viewer.realize();

	std::vector<float> host[2], gi[2];
	double ms = 0;
	for (int frame = 0; frame < FRAMES; frame++) {
		host_room_move(&room, float(frame) / (FRAMES - 1), place);
		mover->setMatrix(osg::Matrix::translate(place[0], place[1], place[2]));
		const auto began = std::chrono::steady_clock::now();
		host_room_bind(&room);
		viewer.frame();
		glFinish();
		if (frame)
			ms +=
			    std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began).count();
		if (frame && frame + 1 < FRAMES)
			continue;
		const int end = frame > 0;
		host[end].resize(4 * HOST_PIXELS);
		gi[end].resize(4 * HOST_PIXELS);
		host_room_read(&room, host[end].data());
		host_room_draw(&room, gi[end].data());
	}
	float *const hosts[2] = {host[0].data(), host[1].data()}, *const gis[2] = {gi[0].data(), gi[1].data()};
	const bool right = host_room_judge(&room, argc > 1 ? argv[1] : "osg", hosts, gis, ms / (FRAMES - 1));
	host_room_close(&room);
	return right ? 0 : 1;
}
