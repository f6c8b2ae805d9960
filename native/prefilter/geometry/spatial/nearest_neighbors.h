// SPDX-License-Identifier: GPL-3.0-or-later

// The nearest of many points to each of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/geometry/spatial/box_tree.h"

namespace prefilter {

/// What a search found; used for one search after another.
class Neighbors {
 public:
  /// Places from near to far, and the squares of their distances.
  std::span<const std::uint32_t> places() const { return places_; }
  std::span<const double> squares() const { return squares_; }

 private:
  friend class NeighborSearch;
  void clear(std::size_t most);
  void add(std::uint32_t place, double square);

  std::size_t most_ = 0;
  double worst_ = 0.0;  // what is no nearer than the root of this is of no interest
  std::vector<std::uint32_t> places_;
  std::vector<double> squares_;
};

/// Points made ready for searches of their neighbors: each position once, along the Morton curve,
/// under a tree of boxes. All that follows names them by their places on the curve.
class NeighborSearch {
 public:
  /// The place of a point that has none.
  static constexpr std::uint32_t kNowhere = std::numeric_limits<std::uint32_t>::max();

  /// Points that hold a value that is not finite, or above 1e150, whose square would overflow, are
  /// left out. Throws Error for more than 2^31 - 1 points; Error(kCancelled).
  NeighborSearch(std::span<const Vector3> points, const Progress& progress, int threads);

  /// The distinct positions, by their places.
  std::span<const Vector3> positions() const { return positions_; }
  /// The place of each of the points that were given; kNowhere for those left out.
  std::span<const std::uint32_t> places() const { return places_; }

  /// The `count` positions (at least 1) nearest to one of them, which is one of these; all of them
  /// where there are fewer. Which of several at one distance it is depends on nothing but the
  /// points.
  void find(std::uint32_t place, std::size_t count, Neighbors* found) const;

  /// The place of the position that is nearest to any finite point, and nearer than the root of
  /// `squared`; kNowhere where there is none.
  std::uint32_t nearest(const Vector3& point, double squared) const;

  /// Calls `visit(place)` for all positions nearer to a point than the root of `squared`.
  template <typename Visit>
  void for_near(const Vector3& point, double squared, const Visit& visit) const {
    if (tree_.is_empty()) return;
    const auto may_be = [&](double square, std::size_t) { return square < squared; };
    tree_.search(point, may_be, [&](std::size_t leaf) {
      const BoxTree::Node& node = tree_.nodes()[leaf];
      for (std::uint32_t i = node.begin; i < node.end; ++i) {
        const Vector3 offset = positions_[i] - point;
        if (dot(offset, offset) < squared) visit(i);
      }
    });
  }

  /// The box of the positions.
  Box box() const { return tree_.is_empty() ? kEmptyBox : tree_.nodes()[0].box; }

 private:
  std::vector<Vector3> positions_;
  std::vector<std::uint32_t> places_;
  BoxTree tree_;
};

}  // namespace prefilter
