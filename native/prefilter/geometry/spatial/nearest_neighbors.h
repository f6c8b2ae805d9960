// SPDX-License-Identifier: GPL-3.0-or-later

// Nearest neighbors within a point cloud.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/geometry/spatial/box_tree.h"

namespace prefilter {

/// The result of a search; reusable to avoid allocations.
class Neighbors {
 public:
  /// Neighbors from near to far, and their squared distances.
  std::span<const std::uint32_t> places() const { return places_; }
  std::span<const double> squares() const { return squares_; }

 private:
  friend class NeighborSearch;
  void clear(std::size_t most);
  void add(std::uint32_t place, double square);

  std::size_t most_ = 0;
  double worst_ = 0.0;  // squared distance beyond which candidates are rejected
  std::vector<std::uint32_t> places_;
  std::vector<double> squares_;
};

/// A searchable copy of points: distinct positions in Morton order, with a bounding box tree.
/// Positions are identified by their index ("place") in this order.
class NeighborSearch {
 public:
  /// The place of a point that was left out.
  static constexpr std::uint32_t kNowhere = std::numeric_limits<std::uint32_t>::max();

  /// Leaves out points with a coordinate that is not finite, or above 1e150, whose square would
  /// overflow. Throws Error for more than 2^31 - 1 points; Error(kCancelled).
  NeighborSearch(std::span<const Vector3> points, const Run& run);

  /// The distinct positions, indexed by place.
  std::span<const Vector3> positions() const { return positions_; }
  /// The place of each input point; kNowhere for omitted ones.
  std::span<const std::uint32_t> places() const { return places_; }

  /// Finds the `count` positions, at least 1, that are nearest to a position, including itself; all
  /// of them if there are fewer. Ties are resolved deterministically.
  void find(std::uint32_t place, std::size_t count, Neighbors* found) const;

  /// The place of the position nearest to a finite point, if it is closer than the square root of
  /// `squared`; else kNowhere.
  std::uint32_t nearest(const Vector3& point, double squared) const;

  /// Calls `visit(place)` for all positions closer to a point than the square root of `squared`.
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

  /// The bounding box of the positions.
  Box box() const { return tree_.is_empty() ? kEmptyBox : tree_.nodes()[0].box; }

 private:
  std::vector<Vector3> positions_;
  std::vector<std::uint32_t> places_;
  BoxTree tree_;
};

}  // namespace prefilter
