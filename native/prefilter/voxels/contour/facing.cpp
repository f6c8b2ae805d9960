// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/facing.h"

#include <algorithm>
#include <optional>
#include <unordered_map>

namespace prefilter {
namespace {

constexpr double kLeastFacing = 0.05;
constexpr double kLeastArea = 1e-12;  // double area of a triangle, relative to a cell's face
constexpr double kAlong = 0.9396926207859084;           // 20 degrees
constexpr double kFacingBorderReach = 2.0;              // cells
constexpr double kFacingEdgeReach = 0.3;                // cells
constexpr double kCrossingReach = 0.2;                  // cells
constexpr double kOnCrossing = 0.05;                    // cells
constexpr double kFacingOpposed = -0.1736481776669303;  // 100 degrees

// The common side of two triangles.
struct SharedSide {
  Vector3 middle;
  bool is_convex;
};

SharedSide side_between(const MeshView<std::int32_t>& mesh,
                        const std::array<std::uint32_t, 2>& triangles) {
  const auto& first = mesh.triangles[triangles[0]];
  Vector3 sum{};
  Vector3 far{};
  for (const std::int32_t corner : mesh.triangles[triangles[1]]) {
    const Vector3& at = mesh.positions[static_cast<std::size_t>(corner)];
    if (std::find(first.begin(), first.end(), corner) != first.end()) {
      sum = sum + at;
    } else {
      far = at;
    }
  }
  const Vector3 middle = 0.5 * sum;
  const auto [a, b, c] = mesh.corners(triangles[0]);
  return {middle, dot(cross(b - a, c - a), far - middle) < 0.0};
}

// A corner's sample, of the triangle's region, whose plane the triangle follows; null if none.
const SourcePoint* sample_along(const MeshView<std::int32_t>& mesh, std::size_t triangle,
                                std::int32_t label, const VertexSamples& samples, bool is_turned) {
  const auto [a, b, c] = mesh.corners(triangle);
  const Vector3 normal = cross(b - a, c - a);
  for (const std::int32_t corner : mesh.triangles[triangle]) {
    if (static_cast<std::size_t>(corner) >= samples.index.size()) continue;
    const SourcePoint* sample = samples.of(corner);
    if (sample == nullptr || sample->label != label) continue;
    const double height = dot(normal, sample->normal);
    if ((is_turned ? -height : height) >= kAlong * length(normal)) return sample;
  }
  return nullptr;
}

// The nearest point on the intersection line of the planes of two surface points.
std::optional<Vector3> crossing_near(const Vector3& point, const SourcePoint& one,
                                     const SourcePoint& other) {
  const double cosine = dot(one.normal, other.normal);
  const double rest = 1.0 - cosine * cosine;
  if (!(rest > 0.0)) return std::nullopt;
  const double height = dot(point - one.position, one.normal);
  const double other_height = dot(point - other.position, other.normal);
  return point - ((height - cosine * other_height) / rest) * one.normal -
         ((other_height - cosine * height) / rest) * other.normal;
}

// Whether two regions intersect near a point.
bool cross_near(const Vector3& point, const SourcePoint& one, const SourcePoint& other,
                const FeatureSurface& surface) {
  const std::optional<Vector3> crossing = crossing_near(point, one, other);
  if (!crossing || !(length(*crossing - point) < kCrossingReach * surface.cell())) return false;
  const double reach = kOnCrossing * surface.cell();
  return surface.nearest(*crossing, reach, one.label).has_value() &&
         surface.nearest(*crossing, reach, other.label).has_value();
}

}  // namespace

std::unordered_set<std::int32_t> turned_labels(const VertexSamples& samples) {
  std::unordered_map<std::int32_t, double> facing;
  for (std::size_t i = 0; i < samples.samples.size(); ++i) {
    facing[samples.samples[i].label] += static_cast<double>(samples.facing[i]);
  }
  std::unordered_set<std::int32_t> turned;
  for (const auto& [label, sum] : facing) {
    if (sum < 0.0) turned.insert(label);
  }
  return turned;
}

bool is_upside_down(const MeshView<std::int32_t>& mesh, std::size_t triangle, std::int32_t label,
                    const VertexSamples& samples, const std::unordered_set<std::int32_t>& turned,
                    double cell) {
  const auto [a, b, c] = mesh.corners(triangle);
  const Vector3 normal = cross(b - a, c - a);
  if (length(normal) < kLeastArea * cell * cell) return true;
  bool is_any = false;
  for (const std::int32_t corner : mesh.triangles[triangle]) {
    if (static_cast<std::size_t>(corner) >= samples.index.size()) continue;
    const SourcePoint* sample = samples.of(corner);
    if (sample == nullptr || sample->label != label) return false;
    const double height = dot(normal, sample->normal);
    if ((turned.contains(sample->label) ? -height : height) >= kLeastFacing * length(normal)) {
      return false;
    }
    is_any = true;
  }
  return is_any;
}

bool are_at_edge(const MeshView<std::int32_t>& mesh, std::span<const std::int32_t> labels,
                 const std::array<std::uint32_t, 2>& triangles, const FeatureSurface& surface,
                 const VertexSamples& samples, const std::unordered_set<std::int32_t>& turned) {
  const SharedSide side = side_between(mesh, triangles);
  const std::int32_t first = labels[triangles[0]];
  const std::int32_t second = labels[triangles[1]];
  // A crevice does not count, unless it lies between two parts, which have no border.
  if (!side.is_convex &&
      (first == second ||
       surface.nearest_border(side.middle, kFacingBorderReach * surface.cell(), first, second))) {
    return false;
  }
  std::array<Vector3, 2> normals;
  std::array<std::optional<SourcePoint>, 2> nearest;
  for (std::size_t i = 0; i < 2; ++i) {
    const std::int32_t label = labels[triangles[i]];
    const bool is_turned = turned.contains(label);
    const SourcePoint* sample = sample_along(mesh, triangles[i], label, samples, is_turned);
    if (sample == nullptr) return false;
    nearest[i] = surface.nearest(side.middle, kFacingEdgeReach * surface.cell(), label);
    if (!nearest[i]) return false;
    normals[i] = is_turned ? -1.0 * sample->normal : sample->normal;
  }
  if (!(dot(normals[0], normals[1]) < kFacingOpposed)) return false;
  // Adjacent parts leave a slit, whose end is not an edge of either.
  return side.is_convex || cross_near(side.middle, *nearest[0], *nearest[1], surface);
}

}  // namespace prefilter
