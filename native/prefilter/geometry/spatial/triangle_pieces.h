// SPDX-License-Identifier: GPL-3.0-or-later

// Small triangles: measures and subdivision.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "prefilter/base/geometry.h"

namespace prefilter {

inline Vector3 triangle_middle(const std::array<Vector3, 3>& p) {
  return (1.0 / 3.0) * (p[0] + p[1] + p[2]);
}

inline double triangle_area(const std::array<Vector3, 3>& p) {
  return 0.5 * length(cross(p[1] - p[0], p[2] - p[0]));
}

inline Box triangle_box(const std::array<Vector3, 3>& corners) {
  Box box = kEmptyBox;
  for (const Vector3& corner : corners) box.include(corner);
  return box;
}

/// Halves a triangle at its longest side, if that is longer than `size`.
inline std::optional<std::array<std::array<Vector3, 3>, 2>> halves_of(
    const std::array<Vector3, 3>& corners, double size) {
  std::size_t longest = 0;
  double most = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3 side = corners[(i + 1) % 3] - corners[i];
    if (dot(side, side) > most) {
      most = dot(side, side);
      longest = i;
    }
  }
  if (most <= size * size) return std::nullopt;
  const Vector3& a = corners[longest];
  const Vector3& b = corners[(longest + 1) % 3];
  const Vector3& c = corners[(longest + 2) % 3];
  const Vector3 middle = 0.5 * (a + b);
  return {{{{a, middle, c}, {middle, b, c}}}};
}

/// Subdivides a triangle until no side is longer than `size`, and calls visit(corners) for the
/// pieces. Skips parts for which `may_be(corners)` is false.
template <typename MayBe, typename Visit>
void for_pieces(const std::array<Vector3, 3>& corners, double size, const MayBe& may_be,
                const Visit& visit) {
  if (!may_be(corners)) return;
  const auto halves = halves_of(corners, size);
  if (!halves) {
    visit(corners);
    return;
  }
  for (const auto& half : *halves) for_pieces(half, size, may_be, visit);
}

}  // namespace prefilter
