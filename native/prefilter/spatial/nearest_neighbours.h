// The nearest of many points to each of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/spatial/box_tree.h"

namespace prefilter {

/// Points made ready for searches of neighbors: each position once, along the Morton curve, under
/// a tree of boxes. What follows calls them by their places along the curve.
class NeighbourSearch {
 public:
  /// The place of a point that has none.
  static constexpr std::uint32_t kNowhere = std::numeric_limits<std::uint32_t>::max();

  /// Points that hold a value that is not finite, or above 1e150, whose square would overflow, are
  /// left out. Throws Error for more than 2^32 - 1 points; Error(kCancelled).
  NeighbourSearch(std::span<const Vector3> points, const Progress& progress, int threads);

  /// The distinct positions, by their places.
  std::span<const Vector3> positions() const { return positions_; }
  /// The place of each of the points that were given; kNowhere for those left out.
  std::span<const std::uint32_t> places() const { return places_; }

  /// Called with a place; the places of the positions nearest to it, itself first and then from
  /// near to far; and the squares of their distances. From several threads at once.
  using Visit =
      std::function<void(std::uint32_t, std::span<const std::uint32_t>, std::span<const double>)>;
  /// Calls `visit` for every place, with `count` (at least 1) neighbors, or all positions where
  /// there are fewer. Which of several at one distance is taken depends on nothing but the points.
  /// Throws Error(kCancelled).
  void find(std::size_t count, const Visit& visit, const Progress& progress, int threads) const;

 private:
  std::vector<Vector3> positions_;
  std::vector<std::uint32_t> places_;
  BoxTree tree_;
};

}  // namespace prefilter
