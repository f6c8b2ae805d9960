// SPDX-License-Identifier: GPL-3.0-or-later

// A contour whose sharp loops have not been triangulated yet.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// Fallback positions of vertices between cells: first the position before sampling, then the
/// position determined by the two cells alone, then the midpoint between the cells' centers, where
/// loops never fold. All three are on one line along an axis.
class Crossings {
 public:
  Crossings() = default;
  /// Starts with the positions before sampling; `set` adds the others per vertex.
  explicit Crossings(std::vector<Vector3> fitted)
      : middles_(std::move(fitted)), others_(middles_.size()), axes_(middles_.size(), 0) {}

  void set(std::size_t v, std::size_t axis, double middle, double plain) {
    axes_[v] = static_cast<std::uint8_t>(axis);
    others_[v] = {std::exchange(middles_[v][axis], middle), plain};
  }

  std::size_t size() const { return middles_.size(); }
  const Vector3& middle(std::size_t v) const { return middles_[v]; }
  Vector3 fitted(std::size_t v) const { return along(v, others_[v].fitted); }
  /// The new position must be on the vertex's line.
  void move_middle(std::size_t v, const Vector3& position) { middles_[v] = position; }

  /// Moves a vertex to its next fallback position; returns whether there is one.
  bool put_back(std::size_t v, Vector3* position) const {
    if (*position == middle(v)) return false;
    const Vector3 plain = along(v, others_[v].plain);
    if (*position == plain) {
      *position = middle(v);
    } else {
      *position = *position == fitted(v) ? plain : fitted(v);
    }
    return true;
  }

 private:
  struct Others {
    double fitted;
    double plain;
  };

  Vector3 along(std::size_t v, double place) const {
    Vector3 position = middles_[v];
    position[axes_[v]] = place;
    return position;
  }

  std::vector<Vector3> middles_;
  std::vector<Others> others_;  // coordinate along the axis
  std::vector<std::uint8_t> axes_;
};

/// A loop of a contour whose vertices lie on different sides of an edge.
struct SharpLoop {
  std::array<std::int32_t, 12> corners;
  int count = 0;
  // Its triangles without the edge, as a range of all sharp loops' triangles.
  std::size_t first = 0;
  std::size_t end = 0;

  std::int32_t from(std::size_t side) const { return corners[side]; }
  std::int32_t to(std::size_t side) const {
    return corners[(side + 1) % static_cast<std::size_t>(count)];
  }
};

/// A contour of which some loops are not triangulated yet.
struct LoopedMesh {
  std::vector<Vector3> positions;
  // Triangles of all other loops.
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<SharpLoop> loops;
  std::vector<std::array<std::int32_t, 3>> loop_triangles;
};

}  // namespace prefilter
