// SPDX-License-Identifier: GPL-3.0-or-later

// Which of a surface's points bound a solid.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <mutex>
#include <unordered_map>

#include "prefilter/base/geometry.h"
#include "prefilter/geometry/spatial/winding_numbers.h"

namespace prefilter {

/// Whether points of the surface bound the solid, and are not within another part; lengths are
/// cells. Threads may share one: what is known depends on the mesh alone.
class OuterSides {
 public:
  /// `occupancy(point)` is that of the cell that holds a point. Holds both.
  OuterSides(const std::function<float(const Vector3&)>& occupancy, const WindingNumbers& winding)
      : occupancy_(occupancy), winding_(winding) {}

  /// Where a gap is narrower than this far it is filled, whichever of its sides is moved.
  bool may_be(const Vector3& point, const Vector3& normal) const;
  bool is_outer(const Vector3& point, const Vector3& normal) const;

  /// The winding number of a point, as good as its distance from a half is large: by that of a
  /// point nearby, and what is between them.
  double winding_at(const Vector3& point) const;

 private:
  // Of a point in a cube of this side, the same for all points of the cube.
  double winding_near(const Vector3& point, double side) const;

  const std::function<float(const Vector3&)>& occupancy_;
  const WindingNumbers& winding_;

  struct Known {
    std::mutex mutex;
    std::unordered_map<std::uint64_t, double> numbers;
  };
  // By the sides of cubes, in shares that threads rarely want at once.
  static constexpr std::size_t kShares = 64;
  mutable std::array<std::array<Known, kShares>, 3> known_;
};

}  // namespace prefilter
