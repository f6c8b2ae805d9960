// SPDX-License-Identifier: GPL-3.0-or-later

// Finds where a surface may have another one opposite to it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/voxels/cube_table.h"

namespace prefilter {

/// Cosine between normals up to which triangles are opposed: 134 degrees.
inline constexpr double kAcross = -0.7;

/// The bin of a direction, as a bit.
std::uint64_t direction_bit(const Vector3& direction);

/// The bins of directions that may be opposed to a direction, as bits.
std::uint64_t bits_across(const Vector3& direction);

/// Cubes of space that contain opposed triangles, in the cube itself or in a neighbor.
class OpposedBricks {
 public:
  /// Bricks have side `side`; only those that overlap `bounds` are kept. Throws Error(kCancelled).
  OpposedBricks(const MeshView<std::int32_t>& mesh, std::span<const Vector3> normals, double side,
                const Box& bounds, const Run& run);

  bool is_empty() const { return opposed_.is_empty(); }
  bool holds(const Vector3& point) const;

  /// Whether the brick of a point contains too many sheets to distinguish shapes.
  bool is_crowded(const Vector3& point) const;

  /// Whether a triangle may overlap one of the bricks and the bounds.
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
