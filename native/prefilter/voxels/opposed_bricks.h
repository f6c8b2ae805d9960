// SPDX-License-Identifier: GPL-3.0-or-later

// Where a surface may have something across from it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/voxels/cube_table.h"

namespace prefilter {

/// The cosine between normals from which on triangles are across from each other: 134 degrees.
inline constexpr double kAcross = -0.7;

/// The bin of a direction, as a bit.
std::uint64_t direction_bit(const Vector3& direction);

/// The bins with directions that may be across from one.
std::uint64_t bits_across(const Vector3& direction);

/// The bricks of space that have, with those around them, triangles which are across.
class OpposedBricks {
 public:
  /// Of this side, where they reach into a box. Throws Error(kCancelled).
  OpposedBricks(const MeshView<std::int32_t>& mesh, std::span<const Vector3> normals, double side,
                const Box& bounds, const Progress& progress, int threads);

  bool is_empty() const { return opposed_.is_empty(); }
  bool holds(const Vector3& point) const;

  /// Whether so much passes the brick of a point that no shape is told apart.
  bool is_crowded(const Vector3& point) const;

  /// Whether a triangle may reach into one, and into the box.
  bool may_meet(const std::array<Vector3, 3>& corners) const;

 private:
  double side_;
  Box bounds_;
  struct Brick {
    bool is_crowded = false;
  };
  CubeTable<Brick> opposed_;
};

}  // namespace prefilter
