// SPDX-License-Identifier: GPL-3.0-or-later

// Normalizes coordinates to about 1.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// Maps to coordinates in which a box spans [-1, 1] along its longest side, and back. The scale of
/// a box of size 0 is 0.
struct UnitFrame {
  Vector3 middle{};
  double scale = 0.0;

  explicit UnitFrame(const Box& box) {
    for (std::size_t a = 0; a < 3; ++a) {
      middle[a] = box.low[a] / 2.0 + box.high[a] / 2.0;
      scale = std::max(scale, box.high[a] / 2.0 - box.low[a] / 2.0);
    }
  }
  bool has_size() const { return scale > 0.0 && std::isfinite(1.0 / scale); }
  Vector3 to(const Vector3& p) const {
    Vector3 result;
    for (std::size_t a = 0; a < 3; ++a) result[a] = (p[a] - middle[a]) / scale;
    return result;
  }
  Vector3 back(const Vector3& p) const {
    Vector3 result;
    for (std::size_t a = 0; a < 3; ++a) result[a] = middle[a] + scale * p[a];
    return result;
  }
};

/// The frame around all vertices that triangles use.
inline UnitFrame frame_of(const InputMesh& mesh) {
  Box box = kEmptyBox;
  for (const auto& triangle : mesh.triangles) {
    for (const auto v : triangle) box.include(mesh.positions[static_cast<std::size_t>(v)]);
  }
  return UnitFrame(box);
}

}  // namespace prefilter
