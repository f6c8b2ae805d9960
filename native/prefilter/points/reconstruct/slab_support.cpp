// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/slab_support.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/points/reconstruct/support_field.h"

namespace prefilter {
namespace {

// In spacings: points on shorter edges and triangles are near their corners.
constexpr double kMinLongEdgeSpacings = 2.0;

float density_of(const Support& support, double cell) {
  constexpr auto kMost = static_cast<double>(std::numeric_limits<float>::max());
  const double spacing = static_cast<double>(support.spacing) * cell;
  return static_cast<float>(std::min(1.0 / (spacing * spacing), kMost));
}

class SupportFinder {
 public:
  SupportFinder(const SurfaceSamples& surface, double limit, double sign, int s, SlabMesh* slab)
      : surface_(surface), limit_(limit), slab_(*slab), field_(surface.slabs, sign, s) {}

  void find_normals();

  void add_attributes();
  void find_far_midpoints();

 private:
  using Corners = std::array<std::size_t, 3>;

  static Corners corners_of(const std::array<std::int32_t, 3>& triangle) {
    return {static_cast<std::size_t>(triangle[0]), static_cast<std::size_t>(triangle[1]),
            static_cast<std::size_t>(triangle[2])};
  }
  const Vector3& position(std::size_t v) const { return slab_.contour.mesh.positions[v]; }
  bool is_long(std::size_t a, std::size_t b) const {
    const double spacing =
        static_cast<double>(std::min(supports_[a].spacing, supports_[b].spacing));
    const Vector3 edge = position(b) - position(a);
    return length(edge) > kMinLongEdgeSpacings * std::max(1.0, spacing);
  }
  void add_if_far(const OrientedPoint& point, int a, int b);

  const SurfaceSamples& surface_;
  double limit_;
  SlabMesh& slab_;
  SupportField field_;
  std::vector<Vector3> normals_;   // area-weighted vertex normals
  std::vector<Support> supports_;  // per vertex
};

void SupportFinder::find_normals() {
  normals_.resize(slab_.contour.mesh.positions.size());
  for (const auto& triangle : slab_.contour.mesh.triangles) {
    const auto [a, b, c] = corners_of(triangle);
    const Vector3 normal = cross(position(b) - position(a), position(c) - position(a));
    for (const std::size_t v : {a, b, c}) normals_[v] = normals_[v] + normal;
  }
}

void SupportFinder::add_attributes() {
  const std::vector<VertexPlace>& places = slab_.contour.places;
  const std::size_t width = surface_.attribute_count;
  const std::size_t count = slab_.contour.mesh.positions.size();
  std::vector<float> attributes;
  attributes.reserve(count * (width + kSupportAttributes));
  for (std::size_t v = 0; v < count; ++v) {
    const int k = v < places.size() ? places[v].depth : surface_.slabs.depth();
    supports_.push_back(field_.at({position(v), normals_[v]}, k));
    const auto first = slab_.attributes.begin() + static_cast<std::ptrdiff_t>(v * width);
    attributes.insert(attributes.end(), first, first + static_cast<std::ptrdiff_t>(width));
    attributes.push_back(supports_[v].distance);
    attributes.push_back(density_of(supports_[v], surface_.cell));
  }
  slab_.attributes = std::move(attributes);
}

void SupportFinder::add_if_far(const OrientedPoint& point, int a, int b) {
  const Support support = field_.at(point, surface_.slabs.depth());
  if (static_cast<double>(support.distance) <= limit_) return;
  slab_.far_midpoints.push_back({a, b, support.distance, density_of(support, surface_.cell)});
}

void SupportFinder::find_far_midpoints() {
  std::set<std::pair<std::size_t, std::size_t>> seen;
  const auto is_near = [&](std::size_t v) {
    return static_cast<double>(supports_[v].distance) <= limit_;
  };
  const std::vector<std::array<std::int32_t, 3>>& triangles = slab_.contour.mesh.triangles;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Corners corners = corners_of(triangles[t]);
    int count = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t a = std::min(corners[i], corners[(i + 1) % 3]);
      const std::size_t b = std::max(corners[i], corners[(i + 1) % 3]);
      if (!is_near(a) || !is_near(b) || !is_long(a, b)) continue;
      ++count;
      if (!seen.insert({a, b}).second) continue;
      add_if_far({0.5 * (position(a) + position(b)), normals_[a] + normals_[b]},
                 static_cast<int>(a), static_cast<int>(b));
    }
    if (count < 2 || !std::all_of(corners.begin(), corners.end(), is_near)) continue;
    const auto [a, b, c] = corners;
    add_if_far({(1.0 / 3.0) * (position(a) + position(b) + position(c)),
                cross(position(b) - position(a), position(c) - position(a))},
               static_cast<int>(t), -1);
  }
}

}  // namespace

void add_support(const SurfaceSamples& surface, double limit, double sign, int s, SlabMesh* slab) {
  SupportFinder finder(surface, limit, sign, s, slab);
  finder.find_normals();
  finder.add_attributes();
  finder.find_far_midpoints();
}

}  // namespace prefilter
