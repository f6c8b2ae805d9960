// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/geometry/corner_points.h"

#include <string>
#include <unordered_map>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

constexpr double kMaxCornerCoordinate = 1e150;
constexpr std::int32_t kNone = -1;

void check(const InputMesh& surface, std::span<const std::int32_t> origins,
           std::span<const std::int32_t> labels, std::size_t triangles) {
  check_mesh(surface, kMaxCornerCoordinate);
  if (labels.size() != triangles) {
    throw_invalid("labels: found " + std::to_string(labels.size()) + " for " +
                  std::to_string(triangles) + " triangles; one each is needed");
  }
  if (origins.size() != surface.triangles.size()) {
    throw_invalid("origins: found " + std::to_string(origins.size()) + " for " +
                  std::to_string(surface.triangles.size()) + " triangles; one each is needed");
  }
  for (std::size_t t = 0; t < origins.size(); ++t) {
    if (origins[t] >= 0 && static_cast<std::size_t>(origins[t]) < triangles) continue;
    throw_invalid("origins: item " + std::to_string(t) + " names triangle " +
                  std::to_string(origins[t]) + ", but there are " + std::to_string(triangles));
  }
}

}  // namespace

CornerPoints find_corner_points(const InputMesh& surface, std::span<const std::int32_t> origins,
                                const InputMesh& mesh, std::span<const std::int32_t> labels,
                                const Run& run) {
  check_mesh(mesh, kMaxCornerCoordinate);
  check(surface, origins, labels, mesh.triangles.size());

  // Query points: each vertex with the label of its first triangle, then vertices with further
  // labels.
  const std::size_t vertices = surface.positions.size();
  std::vector<std::int32_t> origin_of(vertices, kNone);
  std::vector<std::size_t> vertex_of;
  std::unordered_map<std::uint64_t, std::int32_t> others;
  CornerPoints result;
  result.corners.resize(surface.triangles.size());
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto triangle = surface.triangles[t];
    const std::int32_t label = labels[static_cast<std::size_t>(origins[t])];
    for (std::size_t i = 0; i < 3; ++i) {
      const auto vertex = static_cast<std::size_t>(triangle[i]);
      if (origin_of[vertex] == kNone) origin_of[vertex] = origins[t];
      auto point = static_cast<std::int32_t>(vertex);
      if (labels[static_cast<std::size_t>(origin_of[vertex])] != label) {
        const std::uint64_t key =
            (static_cast<std::uint64_t>(vertex) << 32U) | static_cast<std::uint32_t>(label);
        const auto [found, is_new] =
            others.try_emplace(key, static_cast<std::int32_t>(vertices + vertex_of.size()));
        if (is_new) {
          vertex_of.push_back(vertex);
          origin_of.push_back(origins[t]);
        }
        point = found->second;
      }
      result.corners[t][i] = point;
    }
  }
  std::vector<Vector3> points;
  points.reserve(origin_of.size());
  for (const Vector3& position : surface.positions) points.push_back(position);
  for (const std::size_t vertex : vertex_of) points.push_back(surface.positions[vertex]);
  // Vertices without triangles use the origin of the first triangle.
  for (std::int32_t& origin : origin_of) origin = origin == kNone ? 0 : origin;

  const NearestPoints tree(mesh, labels, run.part(0.05, 0.5));
  result.points = tree.find_on(points, origin_of, run.part(0.5, 1.0));
  return result;
}

}  // namespace prefilter
