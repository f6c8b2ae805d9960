// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/quad_surface.h"

#include <algorithm>
#include <cmath>

namespace prefilter {
namespace {

// Triangles with a smaller height relative to their length have no normal.
constexpr double kQuadSurfaceNarrow = 1e-6;

// Two adjacent triangles: the cosine between their normals, -1 if one has none, and a value
// proportional to the volume between them and a large sphere through their corners.
struct Cut {
  double cosine;
  double gap;
};

Cut cut_of(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  const Vector3 ab = b - a;
  const Vector3 ac = c - a;
  const Vector3 ad = d - a;
  const Vector3 bc = c - b;
  const Vector3 cd = d - c;
  const Vector3 one = cross(ab, ac);
  const Vector3 other = cross(ac, ad);
  const double area = std::sqrt(dot(one, one));
  const double other_area = std::sqrt(dot(other, other));
  const double sides = dot(ab, ab) + dot(bc, bc) + dot(ac, ac);
  const double other_sides = dot(ac, ac) + dot(cd, cd) + dot(ad, ad);
  const bool is_narrow =
      area <= kQuadSurfaceNarrow * sides || other_area <= kQuadSurfaceNarrow * other_sides;
  return {is_narrow ? -1.0 : dot(one, other) / (area * other_area),
          area * sides + other_area * other_sides};
}
}  // namespace

std::vector<std::array<std::int32_t, 3>> QuadSurface::triangles() const {
  std::vector<std::array<std::int32_t, 3>> triangles;
  triangles.reserve(2 * quads.size());
  for (const auto& [a, b, c, d] : quads) {
    triangles.push_back({a, b, c});
    triangles.push_back({a, c, d});
  }
  return triangles;
}

void QuadSurface::turn(std::size_t quad) {
  constexpr double kFlat = 0.8;
  constexpr double kLess = 1.0 - 1e-6;
  Quad& corners = quads[quad];
  const auto at = [&](std::size_t k) -> const Vector3& {
    return positions[static_cast<std::size_t>(corners[k])];
  };
  const Cut first = cut_of(at(0), at(1), at(2), at(3));
  const Cut second = cut_of(at(1), at(2), at(3), at(0));
  const bool is_bent = std::min(first.cosine, second.cosine) < kFlat;
  const bool is_worse = is_bent ? second.cosine > first.cosine : second.gap < kLess * first.gap;
  if (is_worse) std::rotate(corners.begin(), corners.begin() + 1, corners.end());
}

}  // namespace prefilter
