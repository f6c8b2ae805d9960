// SPDX-License-Identifier: GPL-3.0-or-later

// Refines uniformly with OpenSubdiv, then applies its limit masks to positions and texture
// coordinates.
#include "prefilter/geometry/subdivision.h"

#include <opensubdiv/far/error.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <numeric>
#include <vector>

#include "prefilter/base/cancel_check.h"
#include "prefilter/base/error.h"
#include "prefilter/base/text.h"

namespace prefilter {
namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

constexpr double kMaxTriangles = 1 << 25;
constexpr double kBytesPerTriangle = 370.0;  // measured peak
constexpr std::int64_t kMaxValence = 65535;  // limit of OpenSubdiv's Far

// A value of N components that OpenSubdiv interpolates.
template <int N>
struct Values {
  std::array<double, N> v;

  void Clear() { v.fill(0.0); }
  void AddWithWeight(const Values& other, double weight) {
    for (int i = 0; i < N; ++i) v[i] += weight * other.v[i];
  }
  // All weights that OpenSubdiv writes as float literals are meant to be multiples of 1/6.
  void AddWithWeight(const Values& other, float weight) {
    AddWithWeight(other, std::round(6.0 * weight) / 6.0);
  }
};

using Points = std::vector<Values<3>>;
using Uvs = std::vector<Values<2>>;
using Weights = std::vector<Values<1>>;
using PrimvarRefiner = Far::PrimvarRefinerReal<double>;

void check_vertex(std::int64_t vertex, const PolygonArrays& mesh, const char* rows,
                  std::size_t row) {
  if (vertex >= 0 && vertex < static_cast<std::int64_t>(mesh.vertex_count)) return;
  throw_no_vertex(std::string(rows) + " " + std::to_string(row), vertex, mesh.vertex_count);
}

void check_values(const double* values, std::size_t rows, std::size_t columns, const char* argument,
                  const char* row) {
  for (std::size_t i = 0; i < rows * columns; ++i) {
    if (!std::isfinite(values[i])) {
      throw_invalid(std::string(argument) + ": " + row + " " + std::to_string(i / columns) +
                    " holds " + to_text(values[i]) + "; all values must be finite");
    }
  }
}

void check_sharpness(const double* values, std::size_t count, const char* argument,
                     const char* what) {
  for (std::size_t i = 0; i < count; ++i) {
    if (!(values[i] >= 0.0)) {
      throw_invalid(std::string(argument) + ": " + what + " " + std::to_string(i) +
                    " has sharpness " + to_text(values[i]) + "; 0 and up is needed, " +
                    to_text(kInfiniteSharpness) + " and up being infinite");
    }
  }
}

void check_faces(const PolygonArrays& mesh, SubdivisionScheme scheme) {
  if (mesh.face_count == 0) {
    throw_invalid("face_sizes: the mesh has no faces; at least one is needed");
  }
  const bool triangles_only = scheme == SubdivisionScheme::kLoop;
  std::int64_t total = 0;
  for (std::size_t face = 0; face < mesh.face_count; ++face) {
    const std::int64_t size = mesh.face_sizes[face];
    if (triangles_only ? size != 3 : size < 3 || size > kMaxValence) {
      throw_invalid("face_sizes: face " + std::to_string(face) + " has " + std::to_string(size) +
                    " corners; " +
                    (triangles_only ? "the scheme loop needs triangles"
                                    : "3 to " + std::to_string(kMaxValence) + " are allowed"));
    }
    total += size;
  }
  if (total != static_cast<std::int64_t>(mesh.corner_count)) {
    throw_invalid("face_sizes: add up to " + std::to_string(total) + ", but face_vertices has " +
                  std::to_string(mesh.corner_count) + " entries; both must be equal");
  }
  std::vector<std::int64_t> sorted;
  const std::int64_t* corner = mesh.face_vertices;
  for (std::size_t face = 0; face < mesh.face_count; ++face) {
    sorted.assign(corner, corner + mesh.face_sizes[face]);
    corner += mesh.face_sizes[face];
    for (const std::int64_t vertex : sorted) {
      check_vertex(vertex, mesh, "face_vertices: face", face);
    }
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    if (twice != sorted.end()) {
      throw_invalid("face_vertices: face " + std::to_string(face) + " names vertex " +
                    std::to_string(*twice) + " twice; a face needs different vertices");
    }
  }
  if (mesh.kept != nullptr &&
      std::none_of(mesh.kept, mesh.kept + mesh.face_count, [](bool kept) { return kept; })) {
    throw_invalid("faces: none is chosen; at least one is needed");
  }
}

double triangles_at(const PolygonArrays& mesh, SubdivisionScheme scheme, int level) {
  // Far divides a face of n corners into n quads, and each quad into four per level.
  const double quads_per_face = std::ldexp(1.0, 2 * level);
  if (scheme == SubdivisionScheme::kLoop)
    return static_cast<double>(mesh.face_count) * quads_per_face;
  return static_cast<double>(mesh.corner_count) * quads_per_face / 2.0;
}

void check_level(const PolygonArrays& mesh, const SubdivisionOptions& options) {
  if (options.level < 1 || options.level > kMaxSubdivisionLevel) {
    throw_invalid("level: " + std::to_string(options.level) + "; 1 to " +
                  std::to_string(kMaxSubdivisionLevel) + " are allowed");
  }
  const double count = triangles_at(mesh, options.scheme, options.level);
  if (count <= kMaxTriangles) return;
  int fitting = options.level - 1;
  while (fitting > 0 && triangles_at(mesh, options.scheme, fitting) > kMaxTriangles) --fitting;
  const std::string advice = fitting > 0 ? "level " + std::to_string(fitting) + " is the highest"
                                         : "the mesh is fine enough as it is";
  throw_invalid("level: " + std::to_string(options.level) + " makes " + to_text(count) +
                " triangles, about " + to_text(std::ceil(count * kBytesPerTriangle / 1e9)) +
                " GB; 2^25 triangles are allowed: " + advice);
}

void check_polygons(const PolygonArrays& mesh, const SubdivisionOptions& options) {
  check_faces(mesh, options.scheme);
  check_level(mesh, options);
  check_values(mesh.positions, mesh.vertex_count, 3, "positions", "vertex");
  check_values(mesh.face_uvs, mesh.corner_count, 2, "face_uvs", "corner");
  check_sharpness(mesh.crease_sharpness, mesh.crease_count, "creases", "crease");
  check_sharpness(mesh.corner_sharpness, mesh.sharp_corner_count, "corners", "corner");
  for (std::size_t i = 0; i < 2 * mesh.crease_count; ++i) {
    check_vertex(mesh.crease_edges[i], mesh, "creases: crease", i / 2);
  }
  for (std::size_t i = 0; i < mesh.sharp_corner_count; ++i) {
    check_vertex(mesh.corner_vertices[i], mesh, "corners: corner", i);
  }
  const bool of_each_vertex = mesh.weights_of == WeightsOf::kVertices;
  const std::size_t weights = mesh.weights_of == WeightsOf::kNothing ? 0
                              : of_each_vertex                       ? mesh.vertex_count
                                                                     : mesh.face_count;
  for (std::size_t i = 0; i < weights; ++i) {
    if (!std::isfinite(mesh.weights[i]) || mesh.weights[i] < 0.0) {
      throw_invalid(std::string("weights: ") + (of_each_vertex ? "vertex " : "face ") +
                    std::to_string(i) + " has " + to_text(mesh.weights[i]) +
                    "; finite weights of 0 and up are needed");
    }
  }
}

Sdc::SchemeType far_scheme(SubdivisionScheme scheme) {
  switch (scheme) {
    case SubdivisionScheme::kCatmullClark:
      return Sdc::SCHEME_CATMARK;
    case SubdivisionScheme::kLoop:
      return Sdc::SCHEME_LOOP;
    case SubdivisionScheme::kBilinear:
      break;
  }
  return Sdc::SCHEME_BILINEAR;
}

Sdc::Options far_options(const SubdivisionOptions& options) {
  using Rule = Sdc::Options;
  Rule rules;
  rules.SetVtxBoundaryInterpolation(options.boundary == SubdivisionBoundary::kEdgeOnly
                                        ? Rule::VTX_BOUNDARY_EDGE_ONLY
                                        : Rule::VTX_BOUNDARY_EDGE_AND_CORNER);
  constexpr std::array kLinear = {Rule::FVAR_LINEAR_NONE,          Rule::FVAR_LINEAR_CORNERS_ONLY,
                                  Rule::FVAR_LINEAR_CORNERS_PLUS1, Rule::FVAR_LINEAR_CORNERS_PLUS2,
                                  Rule::FVAR_LINEAR_BOUNDARIES,    Rule::FVAR_LINEAR_ALL};
  rules.SetFVarLinearInterpolation(kLinear[static_cast<std::size_t>(options.uv_interpolation)]);
  return rules;
}

// Far prints its errors; they are also visible from its return values.
void silence_far() {
  static std::once_flag once;
  std::call_once(once, [] {
    Far::SetErrorCallback([](Far::ErrorType, const char*) {});
    Far::SetWarningCallback([](const char*) {});
  });
}

// The control mesh in OpenSubdiv's layout.
struct ControlMesh {
  std::vector<int> face_sizes;
  std::vector<int> face_vertices;  // indices of used vertices, in order
  std::vector<int> uv_of_corner;
  std::vector<int> crease_edges;
  std::vector<float> crease_sharpness;
  std::vector<int> sharp_corners;
  std::vector<float> corner_sharpness;
  Points points;
  Uvs uvs;
  Weights weights;  // per vertex

  explicit ControlMesh(const PolygonArrays& mesh);
  std::unique_ptr<Far::TopologyRefiner> refiner(const SubdivisionOptions& options) const;
};

ControlMesh::ControlMesh(const PolygonArrays& mesh)
    : face_sizes(mesh.face_sizes, mesh.face_sizes + mesh.face_count),
      face_vertices(mesh.corner_count),
      uv_of_corner(mesh.corner_count) {
  std::vector<int> place(mesh.vertex_count, -1);
  for (std::size_t i = 0; i < mesh.corner_count; ++i) place[mesh.face_vertices[i]] = 0;
  int used = 0;
  for (std::size_t i = 0; i < mesh.vertex_count; ++i) {
    if (place[i] < 0) continue;
    place[i] = used++;
    const double* p = mesh.positions + 3 * i;
    points.push_back({{p[0], p[1], p[2]}});
    if (mesh.weights_of == WeightsOf::kVertices) weights.push_back({{mesh.weights[i]}});
  }
  for (std::size_t i = 0; i < mesh.corner_count; ++i) {
    face_vertices[i] = place[mesh.face_vertices[i]];
  }

  std::vector<std::size_t> order(mesh.corner_count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto key = [&](std::size_t corner) {
    const double* uv = mesh.face_uvs + 2 * corner;
    return std::make_tuple(face_vertices[corner], uv[0], uv[1]);
  };
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || key(order[i - 1]) != key(order[i])) {
      const double* uv = mesh.face_uvs + 2 * order[i];
      uvs.push_back({{uv[0], uv[1]}});
    }
    uv_of_corner[order[i]] = static_cast<int>(uvs.size()) - 1;
  }

  const auto sharpness = [](double value) {
    return static_cast<float>(std::min(value, kInfiniteSharpness));
  };
  for (std::size_t i = 0; i < mesh.crease_count; ++i) {
    for (int end = 0; end < 2; ++end) {
      crease_edges.push_back(place[mesh.crease_edges[2 * i + end]]);
    }
    crease_sharpness.push_back(sharpness(mesh.crease_sharpness[i]));
  }
  for (std::size_t i = 0; i < mesh.sharp_corner_count; ++i) {
    const int vertex = place[mesh.corner_vertices[i]];
    if (vertex < 0) continue;
    sharp_corners.push_back(vertex);
    corner_sharpness.push_back(sharpness(mesh.corner_sharpness[i]));
  }
}

std::unique_ptr<Far::TopologyRefiner> ControlMesh::refiner(
    const SubdivisionOptions& options) const {
  Far::TopologyDescriptor::FVarChannel channel;
  channel.numValues = static_cast<int>(uvs.size());
  channel.valueIndices = uv_of_corner.data();
  Far::TopologyDescriptor mesh;
  mesh.numVertices = static_cast<int>(points.size());
  mesh.numFaces = static_cast<int>(face_sizes.size());
  mesh.numVertsPerFace = face_sizes.data();
  mesh.vertIndicesPerFace = face_vertices.data();
  mesh.numCreases = static_cast<int>(crease_sharpness.size());
  mesh.creaseVertexIndexPairs = crease_edges.data();
  mesh.creaseWeights = crease_sharpness.data();
  mesh.numCorners = static_cast<int>(sharp_corners.size());
  mesh.cornerVertexIndices = sharp_corners.data();
  mesh.cornerWeights = corner_sharpness.data();
  mesh.numFVarChannels = 1;
  mesh.fvarChannels = &channel;

  using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
  const Factory::Options refinement(far_scheme(options.scheme), far_options(options));
  std::unique_ptr<Far::TopologyRefiner> made(Factory::Create(mesh, refinement));
  if (made == nullptr) {
    throw_invalid("face_vertices: a vertex has more than " + std::to_string(kMaxValence) +
                  " edges");
  }
  return made;
}

void check_creases(const PolygonArrays& mesh, const ControlMesh& control,
                   const Far::TopologyLevel& base) {
  for (std::size_t i = 0; i < mesh.crease_count; ++i) {
    const int a = control.crease_edges[2 * i];
    const int b = control.crease_edges[2 * i + 1];
    if (a < 0 || b < 0 || a == b || base.FindEdge(a, b) == Far::INDEX_INVALID) {
      throw_invalid("creases: crease " + std::to_string(i) + " is between vertices " +
                    std::to_string(mesh.crease_edges[2 * i]) + " and " +
                    std::to_string(mesh.crease_edges[2 * i + 1]) + "; an edge of a face is needed");
    }
  }
}

// An array that OpenSubdiv fills, which checks for cancellation at each access.
template <typename Values>
class CancellableArray {
 public:
  CancellableArray(Values* values, CancelCheck* cancel_check)
      : values_(*values), cancel_check_(*cancel_check) {}
  auto& operator[](int i) {
    cancel_check_.step();
    return values_[i];
  }

 private:
  Values& values_;
  CancelCheck& cancel_check_;
};

// The arrays of the surface at the last level.
struct Refined {
  Points points;
  Uvs uvs;
  Weights weights;
  std::vector<int> base_faces;  // per refined face
};

Refined refine(const ControlMesh& control, const Far::TopologyRefiner& refiner, int level,
               const Run& run) {
  const PrimvarRefiner primvars(refiner);
  Refined now{control.points, control.uvs, control.weights, {}};
  now.base_faces.resize(control.face_sizes.size());
  std::iota(now.base_faces.begin(), now.base_faces.end(), 0);
  for (int l = 1; l <= level; ++l) {
    const Far::TopologyLevel& topology = refiner.GetLevel(l);
    Refined next;
    next.points.resize(topology.GetNumVertices());
    next.uvs.resize(topology.GetNumFVarValues());
    const Run part = run.part(static_cast<double>(l - 1) / level, 1.0);
    CancelCheck cancel_check(part);
    CancellableArray points(&next.points, &cancel_check);
    CancellableArray uvs(&next.uvs, &cancel_check);
    primvars.Interpolate(l, now.points, points);
    primvars.InterpolateFaceVarying(l, now.uvs, uvs);
    if (!now.weights.empty()) {
      next.weights.resize(topology.GetNumVertices());
      CancellableArray weights(&next.weights, &cancel_check);
      primvars.InterpolateVarying(l, now.weights, weights);
    }
    next.base_faces.resize(topology.GetNumFaces());
    for (int face = 0; face < topology.GetNumFaces(); ++face) {
      next.base_faces[face] = now.base_faces[topology.GetFaceParentFace(face)];
    }
    now = std::move(next);
    run.report(static_cast<double>(l) / level);
  }
  const Run limits = run.part(1.0, 1.0);
  CancelCheck cancel_check(limits);
  Points points(now.points.size());
  CancellableArray limit_points(&points, &cancel_check);
  primvars.Limit(now.points, limit_points);
  now.points = std::move(points);
  Uvs uvs(now.uvs.size());
  CancellableArray limit_uvs(&uvs, &cancel_check);
  primvars.LimitFaceVarying(now.uvs, limit_uvs);
  now.uvs = std::move(uvs);
  return now;
}

Surface triangulated(const PolygonArrays& mesh, const Refined& refined,
                     const Far::TopologyLevel& topology, const Run& run) {
  std::vector<std::int64_t> vertex_map(refined.points.size(), -1);
  std::vector<Vector3> positions;
  std::vector<double> weights;
  std::vector<std::array<std::int64_t, 3>> triangles;
  std::vector<double> uvs;
  const auto corner = [&](int vertex, int uv) {
    std::int64_t& place = vertex_map[vertex];
    if (place < 0) {
      place = static_cast<std::int64_t>(positions.size());
      positions.push_back(refined.points[vertex].v);
      if (!refined.weights.empty()) weights.push_back(std::max(0.0, refined.weights[vertex].v[0]));
    }
    uvs.insert(uvs.end(), refined.uvs[uv].v.begin(), refined.uvs[uv].v.end());
    return place;
  };
  CancelCheck cancel_check(run);
  for (int face = 0; face < topology.GetNumFaces(); ++face) {
    cancel_check.step();
    const int base = refined.base_faces[face];
    if (mesh.kept != nullptr && !mesh.kept[base]) continue;
    const Far::ConstIndexArray vertices = topology.GetFaceVertices(face);
    const Far::ConstIndexArray values = topology.GetFaceFVarValues(face);
    for (int i = 2; i < vertices.size(); ++i) {
      triangles.push_back({corner(vertices[0], values[0]), corner(vertices[i - 1], values[i - 1]),
                           corner(vertices[i], values[i])});
      if (mesh.weights_of == WeightsOf::kTriangles) weights.push_back(mesh.weights[base]);
    }
  }
  run.report(0.5);
  TexturedMesh textured;
  textured.mesh = {positions, triangles};
  textured.uvs = uvs.data();
  textured.weights = weights.data();
  textured.weights_of = mesh.weights_of;
  return make_surface(textured, run);
}

}  // namespace

Surface subdivide(const PolygonArrays& mesh, const SubdivisionOptions& options) {
  check_polygons(mesh, options);
  silence_far();
  const ControlMesh control(mesh);
  const std::unique_ptr<Far::TopologyRefiner> refiner = control.refiner(options);
  check_creases(mesh, control, refiner->GetLevel(0));
  options.run.report(0.1);
  Far::TopologyRefiner::UniformOptions refinement(options.level);
  refinement.fullTopologyInLastLevel = true;  // needed for the limit masks
  refiner->RefineUniform(refinement);
  const Refined refined = refine(control, *refiner, options.level, options.run.part(0.4, 0.8));
  const Surface surface =
      triangulated(mesh, refined, refiner->GetLevel(options.level), options.run.part(0.8, 1.0));
  options.run.report(1.0);
  return surface;
}

}  // namespace prefilter
