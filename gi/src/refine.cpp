/* OpenSubdiv (Far) behind gi/src/refine.h: the one C++ file of the library.
 *
 * A cage goes through three stages, each of which may throw:
 *
 *   gi_refine_cage --check_cage, clean_cage--> Cage --refine--> Far::TopologyRefiner
 *       --export_*--> gi_refined (gi_malloc)
 *
 * Everything is validated before OpenSubdiv sees it, because it reports trouble to stderr and not to its caller.
 * Points are interpolated in double and stored as float: a flat wall stays flat to the last bit of a float.
 */
#include "refine.h"

#include "faces.h"
#include "host_memory.h"
#include "polygon.h"

#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace
{

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

constexpr uint32_t max_levels = 8;
/* About 4 GiB inside OpenSubdiv; a hierarchy of that many leaves is far beyond any frame. */
constexpr uint64_t max_faces = uint64_t(1) << 24;
/* OpenSubdiv numbers the corners round a face or a vertex with 16 bits. */
constexpr uint32_t max_valence = 65535;
/* Squared, and summed over a few million faces, this still fits a float. */
constexpr double max_coordinate = 1e15;

/* Cleared. */
template <class T> T *allocate_block(size_t count)
{
	void *memory = gi_calloc(std::max<size_t>(count, 1), sizeof(T));
	if (!memory)
		throw std::bad_alloc();
	return static_cast<T *>(memory);
}

struct Free {
	void operator()(void *memory) const
	{
		gi_free(memory);
	}
};
template <class T> using Block = std::unique_ptr<T[], Free>;

/* The library's memory for the standard library. */
template <class T> struct Allocator {
	using value_type = T;
	Allocator() = default;
	template <class U> Allocator(const Allocator<U> &)
	{
	}
	T *allocate(size_t count)
	{
		return allocate_block<T>(count);
	}
	void deallocate(T *memory, size_t)
	{
		gi_free(memory);
	}
	friend bool operator==(const Allocator &, const Allocator &)
	{
		return true;
	}
	friend bool operator!=(const Allocator &, const Allocator &)
	{
		return false;
	}
};
template <class T> using Array = std::vector<T, Allocator<T>>;

/* What is wrong with the cage, in one line for the user. */
class Bad_cage : public std::runtime_error
{
      public:
	using std::runtime_error::runtime_error;
};

[[noreturn, gnu::format(printf, 1, 2)]] void reject(const char *format, ...)
{
	char line[256];
	va_list arguments;
	va_start(arguments, format);
	std::vsnprintf(line, sizeof line, format, arguments);
	va_end(arguments);
	throw Bad_cage(line);
}

/* A point as OpenSubdiv's interpolation wants it. */
struct Point {
	glm::dvec3 value{0.0};

	void Clear(void * = nullptr)
	{
		value = glm::dvec3(0.0);
	}
	void AddWithWeight(const Point &other, double weight)
	{
		value += weight * other.value;
	}
};

using Points = Array<Point>;

/* A sum of the caller's vertices, in order of their numbers, which OpenSubdiv interpolates as it does points. */
struct Sum {
	using Term = std::pair<uint32_t, double>;
	Array<Term> terms;

	void Clear(void * = nullptr)
	{
		terms.clear();
	}
	void AddWithWeight(const Sum &other, double weight)
	{
		if (weight == 0.0)
			return;
		Array<Term> merged;
		merged.reserve(terms.size() + other.terms.size());
		auto own = terms.begin();
		for (const Term &term : other.terms) {
			while (own != terms.end() && own->first < term.first)
				merged.push_back(*own++);
			const bool both = own != terms.end() && own->first == term.first;
			merged.push_back({term.first, weight * term.second + (both ? (own++)->second : 0.0)});
		}
		merged.insert(merged.end(), own, terms.end());
		terms.swap(merged);
	}
};

using Sums = Array<Sum>;
using Refiner_ptr = std::unique_ptr<Far::TopologyRefiner>;

/* The cage without what carries no surface: repeated corners, faces of fewer than three different corners, unused
 * vertices. */
struct Cage {
	Points points;
	Array<int> counts;
	Array<int> indices;
	Array<uint32_t> corners; /* of each index, the caller's number of it */
	Array<uint32_t> materials;
	Array<uint32_t> faces;   /* of each, the caller's number */
	Array<uint32_t> origins; /* likewise of each point */
	Array<int> crease_vertices;
	Array<float> crease_sharpness;
};

/* ---- the caller's arrays ---- */

/* An enum that came from C may hold any number; C++ may not even look at it as an enum before that is ruled out. */
void check_enums(const gi_refine_cage &cage)
{
	int scheme, boundary;
	static_assert(sizeof scheme == sizeof cage.scheme && sizeof boundary == sizeof cage.boundary, "enums are ints");
	std::memcpy(&scheme, &cage.scheme, sizeof scheme);
	std::memcpy(&boundary, &cage.boundary, sizeof boundary);
	if (scheme < GI_REFINE_BILINEAR || scheme > GI_REFINE_LOOP)
		reject("unknown subdivision scheme %d", scheme);
	if (boundary < GI_REFINE_BOUNDARY_EDGE_AND_CORNER || boundary > GI_REFINE_BOUNDARY_EDGE_ONLY)
		reject("unknown boundary rule %d", boundary);
}

void check_arrays(const gi_refine_cage &cage, uint32_t levels)
{
	if (levels > max_levels)
		reject("%u refinement levels; at most %u are possible", levels, max_levels);
	if (cage.vertex_count == 0 || cage.face_count == 0 || !cage.positions || !cage.indices)
		reject("the cage has no faces");
	if (cage.crease_count > 0 && (!cage.crease_vertices || !cage.crease_sharpness))
		reject("the cage has %u creases but no arrays for them", cage.crease_count);
	if (cage.vertex_count > max_faces || cage.face_count > max_faces)
		reject("too many faces or vertices (%u, %u)", cage.face_count, cage.vertex_count);
}

void check_counts(const gi_refine_cage &cage)
{
	uint64_t sum = 0;
	for (uint32_t face = 0; face < cage.face_count; face++) {
		const uint32_t count = gi_corner_count(cage.face_counts, face);
		if (count < 3)
			reject("face %u has %u corners; a face needs three", face, count);
		if (count > max_valence)
			reject("face %u has %u corners; at most %u are possible", face, count, max_valence);
		sum += count;
	}
	if (sum != cage.index_count)
		reject("the faces have %llu corners but there are %u indices", (unsigned long long)sum,
		       cage.index_count);
}

void check_indices(const gi_refine_cage &cage)
{
	for (uint32_t i = 0; i < cage.index_count; i++)
		if (cage.indices[i] >= cage.vertex_count)
			reject("index %u is vertex %u; there are %u vertices", i, cage.indices[i], cage.vertex_count);
	for (uint32_t i = 0; i < cage.crease_count; i++) {
		const uint32_t *ends = cage.crease_vertices + 2 * size_t(i);
		if (ends[0] >= cage.vertex_count || ends[1] >= cage.vertex_count)
			reject("crease %u joins vertices %u and %u; there are %u vertices", i, ends[0], ends[1],
			       cage.vertex_count);
		if (!std::isfinite(cage.crease_sharpness[i]) || cage.crease_sharpness[i] < 0.0f)
			reject("crease %u has a sharpness that is negative or not finite", i);
	}
}

void check_positions(const gi_refine_cage &cage)
{
	for (int axis = 0; axis < 3; axis++)
		if (!std::isfinite(cage.scale[axis]) || cage.scale[axis] == 0.0f)
			reject("the scale is zero or not finite");
	for (size_t i = 0; i < 3 * size_t(cage.vertex_count); i++) {
		const double value = double(cage.positions[i]) * cage.scale[i % 3];
		if (!std::isfinite(value))
			reject("vertex %zu has a coordinate that is not finite", i / 3);
		if (std::fabs(value) > max_coordinate)
			reject("vertex %zu has a coordinate beyond 1e15", i / 3);
	}
}

/* ---- clean-up ---- */

/* The corners of a face without repeats of the one before (a triangle written as a quad repeats its third corner), as
 * places among the indices. */
void clean_face(const uint32_t *indices, uint32_t first, uint32_t count, Array<uint32_t> &out)
{
	out.clear();
	for (uint32_t i = first; i < first + count; i++)
		if (i == first || indices[i] != indices[i - 1])
			out.push_back(i);
	while (out.size() > 1 && indices[out.back()] == indices[first])
		out.pop_back();
}

void check_face(const gi_refine_cage &cage, uint32_t face, const Array<uint32_t> &corners)
{
	if (cage.scheme == GI_REFINE_LOOP && corners.size() != 3)
		reject("face %u has %zu corners; Loop subdivision takes triangles alone", face, corners.size());
	Array<uint32_t> sorted;
	for (uint32_t corner : corners)
		sorted.push_back(cage.indices[corner]);
	std::sort(sorted.begin(), sorted.end());
	const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
	if (twice != sorted.end())
		reject("face %u passes through vertex %u twice", face, *twice);
}

/* A mirroring scale turns surfaces inside out; corners in the opposite order turn them back (as glTF demands). */
bool mirrors(const gi_refine_cage &cage)
{
	return ((cage.scale[0] < 0.0f) + (cage.scale[1] < 0.0f) + (cage.scale[2] < 0.0f)) % 2 == 1;
}

using Corner = double[3];

void add_corner(const gi_refine_cage &cage, uint32_t corner, Cage &out)
{
	out.indices.push_back(int(cage.indices[corner]));
	out.corners.push_back(corner);
}

/* A bilinear face becomes quads about its middle or two triangles, which cover the notch of a face that is not convex:
 * such a one is cut into triangles first. Smooth schemes round a cage off anyway, and take it as it is.
 */
void add_face(const gi_refine_cage &cage, uint32_t face, const Array<uint32_t> &corners, Cage &out)
{
	const uint32_t count = uint32_t(corners.size());
	const uint32_t material = cage.face_materials ? cage.face_materials[face] : 0;
	Block<Corner> points(allocate_block<Corner>(count));
	for (uint32_t i = 0; i < count; i++)
		for (int axis = 0; axis < 3; axis++)
			points[i][axis] =
			    double(cage.positions[3 * size_t(cage.indices[corners[i]]) + axis]) * cage.scale[axis];
	if (count == 3 || cage.scheme != GI_REFINE_BILINEAR || gi_polygon_is_convex(points.get(), count)) {
		out.counts.push_back(int(count));
		for (uint32_t corner : corners)
			add_corner(cage, corner, out);
		out.materials.push_back(material);
		out.faces.push_back(face);
		return;
	}
	using Triangle = uint32_t[3];
	Block<Triangle> triangles(allocate_block<Triangle>(count));
	const uint32_t made = gi_polygon_cut(points.get(), count, triangles.get());
	if (made == 0)
		reject(
		    "face %u crosses itself, or has more than %d corners and is not convex; cut it into convex faces",
		    face, GI_POLYGON_MAX_CORNERS);
	for (uint32_t t = 0; t < made; t++) {
		out.counts.push_back(3);
		for (uint32_t corner : triangles[t])
			add_corner(cage, corners[corner], out);
		out.materials.push_back(material);
		out.faces.push_back(face);
	}
}

void clean_faces(const gi_refine_cage &cage, Cage &out)
{
	Array<uint32_t> corners;
	uint32_t next = 0;
	const bool mirror = mirrors(cage);
	for (uint32_t face = 0; face < cage.face_count; face++) {
		const uint32_t count = gi_corner_count(cage.face_counts, face);
		clean_face(cage.indices, next, count, corners);
		next += count;
		if (corners.size() < 3)
			continue;
		check_face(cage, face, corners);
		if (mirror)
			std::reverse(corners.begin() + 1, corners.end());
		add_face(cage, face, corners, out);
	}
	if (out.counts.empty())
		reject("no face of the cage has three different corners");
}

/* Keeps the vertices that faces use, in their order. Returns the new number of each old vertex, or -1. */
Array<int> clean_points(const gi_refine_cage &cage, Cage &out)
{
	Array<int> valence(cage.vertex_count, 0);
	for (int index : out.indices)
		if (++valence[index] > int(max_valence) / 2)
			reject("vertex %d has more than %u faces", index, max_valence / 2);
	Array<int> renumbered(cage.vertex_count, -1);
	for (uint32_t vertex = 0; vertex < cage.vertex_count; vertex++) {
		if (valence[vertex] == 0)
			continue;
		renumbered[vertex] = int(out.points.size());
		Point point;
		for (int axis = 0; axis < 3; axis++)
			point.value[axis] = double(cage.positions[3 * size_t(vertex) + axis]) * cage.scale[axis];
		out.points.push_back(point);
		out.origins.push_back(vertex);
	}
	for (int &index : out.indices)
		index = renumbered[index];
	return renumbered;
}

using Edge = std::pair<int, int>;

/* Calls visit(from, to) for the edges of every face, as the face walks them. */
template <class Visit> void for_each_edge(const Cage &cage, Visit visit)
{
	size_t first = 0;
	for (int count : cage.counts) {
		for (int i = 0; i < count; i++)
			visit(cage.indices[first + i], cage.indices[first + (i + 1) % count]);
		first += count;
	}
}

Array<Edge> cage_edges(const Cage &cage)
{
	Array<Edge> edges;
	edges.reserve(cage.indices.size());
	for_each_edge(cage, [&](int from, int to) { edges.push_back(std::minmax({from, to})); });
	std::sort(edges.begin(), edges.end());
	return edges;
}

void clean_creases(const gi_refine_cage &cage, const Array<int> &renumbered, Cage &out)
{
	if (cage.crease_count == 0)
		return;
	const Array<Edge> edges = cage_edges(out);
	for (uint32_t i = 0; i < cage.crease_count; i++) {
		const uint32_t *ends = cage.crease_vertices + 2 * size_t(i);
		const Edge edge = std::minmax({renumbered[ends[0]], renumbered[ends[1]]});
		if (!std::binary_search(edges.begin(), edges.end(), edge))
			reject("crease %u joins vertices %u and %u, which no face joins", i, ends[0], ends[1]);
		out.crease_vertices.insert(out.crease_vertices.end(), {edge.first, edge.second});
		out.crease_sharpness.push_back(cage.crease_sharpness[i]);
	}
}

Cage clean_cage(const gi_refine_cage &cage)
{
	Cage out;
	clean_faces(cage, out);
	const Array<int> renumbered = clean_points(cage, out);
	clean_creases(cage, renumbered, out);
	return out;
}

/* ---- OpenSubdiv ---- */

/* The limit masks of Catmull-Clark hold round quads; faces of more than four corners have no place in a level. Both are
 * gone after one refinement. */
uint32_t least_levels(const Cage &cage, gi_refine_scheme scheme)
{
	for (int count : cage.counts)
		if (count > 4 || (scheme == GI_REFINE_CATMULL_CLARK && count != 4))
			return 1;
	return 0;
}

void check_size(const Cage &cage, gi_refine_scheme scheme, uint32_t levels)
{
	uint64_t faces = cage.counts.size();
	if (levels > 0)
		faces = (scheme == GI_REFINE_LOOP ? 4 * faces : cage.indices.size()) << 2 * (levels - 1);
	if (faces > max_faces)
		reject("too many faces: %llu after %u levels; at most %llu are possible", (unsigned long long)faces,
		       levels, (unsigned long long)max_faces);
}

Sdc::SchemeType scheme_type(gi_refine_scheme scheme)
{
	switch (scheme) {
	case GI_REFINE_BILINEAR:
		return Sdc::SCHEME_BILINEAR;
	case GI_REFINE_CATMULL_CLARK:
		return Sdc::SCHEME_CATMARK;
	case GI_REFINE_LOOP:
		return Sdc::SCHEME_LOOP;
	}
	reject("unknown subdivision scheme");
}

Refiner_ptr make_refiner(const Cage &cage, gi_refine_scheme scheme, gi_refine_boundary boundary, uint32_t levels)
{
	Far::TopologyDescriptor topology;
	topology.numVertices = int(cage.points.size());
	topology.numFaces = int(cage.counts.size());
	topology.numVertsPerFace = cage.counts.data();
	topology.vertIndicesPerFace = cage.indices.data();
	topology.numCreases = int(cage.crease_sharpness.size());
	topology.creaseVertexIndexPairs = cage.crease_vertices.data();
	topology.creaseWeights = cage.crease_sharpness.data();

	Sdc::Options options;
	options.SetVtxBoundaryInterpolation(boundary == GI_REFINE_BOUNDARY_EDGE_ONLY
						? Sdc::Options::VTX_BOUNDARY_EDGE_ONLY
						: Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
	using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
	Refiner_ptr refiner(Factory::Create(topology, Factory::Options(scheme_type(scheme), options)));
	if (!refiner)
		reject("OpenSubdiv refuses the cage: the faces round some edge or vertex do not form a surface");

	Far::TopologyRefiner::UniformOptions uniform{int(levels)};
	uniform.fullTopologyInLastLevel = true; /* limit masks look at the neighbours */
	refiner->RefineUniform(uniform);
	return refiner;
}

/* Points, or sums. */
template <class Values> Values interpolate(const Far::TopologyRefiner &refiner, Values points)
{
	const Far::PrimvarRefinerReal<double> primvar(refiner);
	for (int level = 1; level <= refiner.GetMaxLevel(); level++) {
		Values finer(size_t(refiner.GetLevel(level).GetNumVertices()));
		primvar.Interpolate(level, points, finer);
		points.swap(finer);
	}
	return points;
}

/* ---- what the caller gets ---- */

void export_faces(const Far::TopologyLevel &level, const Array<uint32_t> &finest_vertex, gi_refine_level &out)
{
	for (int face = 0; face < level.GetNumFaces(); face++) {
		const Far::ConstIndexArray vertices = level.GetFaceVertices(face);
		for (int i = 0; i < 4; i++)
			out.corners[face][i] = vertices.size() > 4
						   ? UINT32_MAX
						   : finest_vertex[vertices[std::min(i, vertices.size() - 1)]];
	}
}

void export_parents(const Far::TopologyLevel &level, const gi_refine_level &above, gi_refine_level &out)
{
	out.parent = allocate_block<uint32_t>(out.face_count);
	for (uint32_t face = 0; face < out.face_count; face++) {
		out.parent[face] = uint32_t(level.GetFaceParentFace(int(face)));
		out.material[face] = above.material[out.parent[face]];
	}
}

void export_levels(const Far::TopologyRefiner &refiner, const Cage &cage, gi_refined &out)
{
	const int finest = refiner.GetMaxLevel();
	out.levels = allocate_block<gi_refine_level>(size_t(finest) + 1);
	out.level_count = uint32_t(finest) + 1;
	for (int level = 0; level <= finest; level++) {
		gi_refine_level &to = out.levels[level];
		to.face_count = uint32_t(refiner.GetLevel(level).GetNumFaces());
		to.corners = allocate_block<uint32_t[4]>(to.face_count);
		to.material = allocate_block<uint32_t>(to.face_count);
		if (level == 0)
			std::copy(cage.materials.begin(), cage.materials.end(), to.material);
		else
			export_parents(refiner.GetLevel(level), out.levels[level - 1], to);
	}
	/* A vertex of a level is followed down to its descendant in the finest. */
	Array<uint32_t> descendant(size_t(refiner.GetLevel(finest).GetNumVertices()));
	for (size_t i = 0; i < descendant.size(); i++)
		descendant[i] = uint32_t(i);
	for (int level = finest; level >= 0; level--) {
		const Far::TopologyLevel &from = refiner.GetLevel(level);
		if (level < finest) {
			Array<uint32_t> coarser(size_t(from.GetNumVertices()));
			for (size_t i = 0; i < coarser.size(); i++)
				coarser[i] = descendant[from.GetVertexChildVertex(int(i))];
			descendant.swap(coarser);
		}
		export_faces(from, descendant, out.levels[level]);
	}
}

/* Has the limit surface one normal at the vertex? Not on an edge that is still sharp between two faces. */
bool is_smooth(const Far::TopologyLevel &level, int vertex)
{
	if (level.IsVertexNonManifold(vertex))
		return false;
	for (int edge : level.GetVertexEdges(vertex))
		if (!level.IsEdgeBoundary(edge) && level.GetEdgeSharpness(edge) > 0.0f)
			return false;
	return true;
}

/* The unit normal of two tangents, or zero where they span no plane: the sine of their angle is the test, so scale
 * plays no part; 1e-6 is what interpolation in double of coordinates given as float can still tell from parallel. */
glm::dvec3 tangent_normal(const glm::dvec3 &tangent1, const glm::dvec3 &tangent2)
{
	const glm::dvec3 normal = glm::cross(tangent1, tangent2);
	const double length = glm::length(normal);
	const bool plane = length > 1e-6 * glm::length(tangent1) * glm::length(tangent2);
	return plane && length > 0.0 ? normal / length : glm::dvec3(0.0);
}

void export_points(const Points &points, float (*out)[3])
{
	for (size_t i = 0; i < points.size(); i++)
		for (int axis = 0; axis < 3; axis++)
			out[i][axis] = float(points[i].value[axis]);
}

void export_limit(const Far::TopologyRefiner &refiner, const Points &points, gi_refined &out)
{
	Points limit(points.size()), tangents1(points.size()), tangents2(points.size());
	Far::PrimvarRefinerReal<double>(refiner).Limit(points, limit, tangents1, tangents2);
	export_points(limit, out.positions);
	const Far::TopologyLevel &level = refiner.GetLevel(refiner.GetMaxLevel());
	for (size_t i = 0; i < points.size(); i++) {
		if (!is_smooth(level, int(i)))
			continue;
		const glm::dvec3 normal = tangent_normal(tangents1[i].value, tangents2[i].value);
		for (int axis = 0; axis < 3; axis++)
			out.normals[i][axis] = float(normal[axis]);
	}
}

void export_vertices(const Far::TopologyRefiner &refiner, const Points &points, gi_refined &out)
{
	out.vertex_count = uint32_t(points.size());
	out.positions = allocate_block<float[3]>(points.size());
	out.normals = allocate_block<float[3]>(points.size());
	if (refiner.GetSchemeType() == Sdc::SCHEME_BILINEAR)
		export_points(points, out.positions);
	else
		export_limit(refiner, points, out);
}

void export_sums(const Sums &sums, gi_stencils &out)
{
	size_t terms = 0;
	for (const Sum &sum : sums)
		terms += sum.terms.size();
	if (terms > UINT32_MAX || !gi_stencils_reserve(&out, uint32_t(sums.size()), uint32_t(terms)))
		throw std::bad_alloc();
	for (const Sum &sum : sums) {
		for (const Sum::Term &term : sum.terms)
			gi_stencils_add_term(&out, term.first, term.second);
		gi_stencils_end_point(&out);
	}
}

/* The same masks as those that make the positions, on sums. */
void export_stencils(const Far::TopologyRefiner &refiner, const Cage &cage, gi_refined &out)
{
	Sums sums(cage.origins.size());
	for (size_t i = 0; i < sums.size(); i++)
		sums[i].terms.push_back({cage.origins[i], 1.0});
	sums = interpolate(refiner, sums);
	if (refiner.GetSchemeType() == Sdc::SCHEME_BILINEAR)
		return export_sums(sums, out.points);
	Sums limit(sums.size()), tangents1(sums.size()), tangents2(sums.size());
	Far::PrimvarRefinerReal<double>(refiner).Limit(sums, limit, tangents1, tangents2);
	const Far::TopologyLevel &level = refiner.GetLevel(refiner.GetMaxLevel());
	for (size_t i = 0; i < sums.size(); i++)
		if (!is_smooth(level, int(i))) {
			tangents1[i].Clear();
			tangents2[i].Clear();
		}
	export_sums(limit, out.points);
	export_sums(tangents1, out.tangents[0]);
	export_sums(tangents2, out.tangents[1]);
}

/* Of the faces of the finest level, those of the caller. */
void export_origins(const Cage &cage, gi_refined &out)
{
	Array<uint32_t> faces(cage.faces);
	for (uint32_t level = 1; level < out.level_count; level++) {
		const gi_refine_level &here = out.levels[level];
		Array<uint32_t> finer(here.face_count);
		for (uint32_t face = 0; face < here.face_count; face++)
			finer[face] = faces[here.parent[face]];
		faces.swap(finer);
	}
	out.faces = allocate_block<uint32_t>(faces.size());
	std::copy(faces.begin(), faces.end(), out.faces);
}

/* The faces apart from each other, each at its texture coordinates, refined as the cage is but flat. */
void export_uvs(const Cage &cage, const gi_refine_cage &source, uint32_t levels, gi_refined &out)
{
	Cage apart;
	apart.counts = cage.counts;
	for (uint32_t corner : cage.corners) {
		const float *uv = source.uvs + 2 * size_t(corner);
		apart.indices.push_back(int(apart.points.size()));
		apart.points.push_back({{double(uv[0]), double(uv[1]), 0.0}});
	}
	const gi_refine_scheme flat = source.scheme == GI_REFINE_LOOP ? GI_REFINE_LOOP : GI_REFINE_BILINEAR;
	const Refiner_ptr refiner = make_refiner(apart, flat, GI_REFINE_BOUNDARY_EDGE_AND_CORNER, levels);
	const Points points = interpolate(*refiner, apart.points);
	const Far::TopologyLevel &finest = refiner->GetLevel(int(levels));
	out.uvs = allocate_block<float[4][2]>(size_t(finest.GetNumFaces()));
	for (int face = 0; face < finest.GetNumFaces(); face++) {
		const Far::ConstIndexArray corners = finest.GetFaceVertices(face);
		for (int k = 0; k < 4; k++)
			for (int axis = 0; axis < 2; axis++)
				out.uvs[face][k][axis] =
				    float(points[corners[std::min(k, corners.size() - 1)]].value[axis]);
	}
}

/* Is every edge walked as often one way as the other? Then the surface has no boundary, and what it encloses hides its
 * backs. Two faces an edge is the usual case; simplified scans also fold edges of four. */
bool is_closed(const Cage &cage)
{
	Array<std::pair<Edge, int>> walks;
	walks.reserve(cage.indices.size());
	for_each_edge(cage, [&](int from, int to) { walks.push_back({std::minmax({from, to}), from < to ? 1 : -1}); });
	std::sort(walks.begin(), walks.end());
	int balance = 0;
	for (size_t i = 0; i < walks.size(); i++) {
		balance += walks[i].second;
		const bool last = i + 1 == walks.size() || walks[i + 1].first != walks[i].first;
		if (last && balance != 0)
			return false;
	}
	return true;
}

void refine(const gi_refine_cage &source, uint32_t levels, gi_refined &out)
{
	check_enums(source);
	check_arrays(source, levels);
	check_counts(source);
	check_indices(source);
	check_positions(source);
	const Cage cage = clean_cage(source);
	levels = std::max(levels, least_levels(cage, source.scheme));
	check_size(cage, source.scheme, levels);

	const Refiner_ptr refiner = make_refiner(cage, source.scheme, source.boundary, levels);
	export_levels(*refiner, cage, out);
	export_vertices(*refiner, interpolate(*refiner, cage.points), out);
	if (source.stencils)
		export_stencils(*refiner, cage, out);
	if (source.stencils || source.numbered)
		export_origins(cage, out);
	if (source.uvs)
		export_uvs(cage, source, levels, out);
	out.closed = is_closed(cage);
}

bool fail(gi_refined *out, char *message, size_t message_size, const char *text)
{
	gi_refined_free(out);
	if (message && message_size > 0)
		std::snprintf(message, message_size, "%s", text);
	return false;
}

} // namespace

bool gi_refine(const gi_refine_cage *cage, uint32_t levels, gi_refined *out, char *message, size_t message_size)
{
	*out = gi_refined{};
	try {
		refine(*cage, levels, *out);
		return true;
	} catch (const std::bad_alloc &) {
		fail(out, message, message_size, "out of memory while refining the cage");
		out->out_of_memory = true;
		return false;
	} catch (const std::exception &error) {
		return fail(out, message, message_size, error.what());
	} catch (...) {
		return fail(out, message, message_size, "refining the cage failed");
	}
}

void gi_refined_free(gi_refined *refined)
{
	if (!refined)
		return;
	for (uint32_t i = 0; i < refined->level_count; i++) {
		gi_free(refined->levels[i].corners);
		gi_free(refined->levels[i].parent);
		gi_free(refined->levels[i].material);
	}
	gi_free(refined->levels);
	gi_free(refined->positions);
	gi_free(refined->normals);
	gi_free(refined->parted);
	gi_free(refined->faces);
	gi_free(refined->uvs);
	gi_stencils_free(&refined->points);
	for (gi_stencils &tangents : refined->tangents)
		gi_stencils_free(&tangents);
	*refined = gi_refined{};
}
