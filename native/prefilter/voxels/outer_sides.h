// SPDX-License-Identifier: GPL-3.0-or-later

// Determines which points of a surface bound a solid.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <mutex>
#include <unordered_map>

#include "prefilter/base/geometry.h"
#include "prefilter/geometry/spatial/winding_numbers.h"

namespace prefilter {

/// Tests whether surface points bound the solid rather than lie inside another part; lengths are in
/// cells. Safe for concurrent use; cached values depend on the mesh alone.
class OuterSides {
 public:
  /// `occupancy(point)` returns the occupancy of the cell that contains a point. Keeps references
  /// to both.
  OuterSides(const std::function<float(const Vector3&)>& occupancy, const WindingNumbers& winding)
      : occupancy_(occupancy), winding_(winding) {}

  /// A cheap necessary condition: gaps narrower than the test distance count as filled.
  bool may_be(const Vector3& point, const Vector3& normal) const;
  bool is_outer(const Vector3& point, const Vector3& normal) const;

  /// Winding number of a point, accurate in proportion to its distance from 1/2: computed from the
  /// number of a nearby point and the surface between.
  double winding_at(const Vector3& point) const;

 private:
  // Winding number near a point, the same for all points of a cube of this side.
  double winding_near(const Vector3& point, double side) const;

  const std::function<float(const Vector3&)>& occupancy_;
  const WindingNumbers& winding_;

  struct Known {
    std::mutex mutex;
    std::unordered_map<std::uint64_t, double> numbers;
  };
  // Caches by cube side, divided into shards to reduce lock contention.
  static constexpr std::size_t kShares = 64;
  mutable std::array<std::array<Known, kShares>, 3> known_;
};

}  // namespace prefilter
