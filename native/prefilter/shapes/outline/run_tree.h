// SPDX-License-Identifier: GPL-3.0-or-later

// A tree of boxes over monotone runs: which of their pieces may meet, and which lie beside a point.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/shapes/outline/monotone_contours.h"

namespace prefilter {

/// A piece, by the numbers of its contour and of itself in that.
struct PieceId {
  std::uint32_t contour = 0;
  std::uint32_t piece = 0;

  friend auto operator<=>(const PieceId&, const PieceId&) = default;
};

/// Winding numbers of a point, one for each layer. Most of them are 0.
class LayerWindings {
 public:
  explicit LayerWindings(std::size_t layers) : values_(layers, 0) {}

  int operator[](std::size_t layer) const { return values_[layer]; }
  /// Layers that something was added to, and maybe more than once.
  std::span<const std::uint32_t> touched() const { return touched_; }
  void add(std::uint32_t layer, int winding) {
    if (winding == 0) return;
    values_[layer] += winding;
    touched_.push_back(layer);
  }
  void clear() {
    for (const std::uint32_t layer : touched_) values_[layer] = 0;
    touched_.clear();
  }

 private:
  std::vector<int> values_;
  std::vector<std::uint32_t> touched_;
};

/// The direction of a ray.
enum class RayAxis : std::uint8_t { kX, kY };

class RunTree {
 public:
  /// The contours must outlive it. What is no farther apart than `precision` meets.
  RunTree(const MonotoneContours& contours, double precision);

  /// Appends pairs of pieces whose boxes meet, each pair once. Neighbors along a run cannot meet
  /// elsewhere than at their joint, and are left out. Returns false where there are more than
  /// `most`.
  bool append_pairs(std::size_t most, std::vector<std::pair<PieceId, PieceId>>* pairs) const;

  /// Adds to `windings` what the pieces on the ray from a point upward in x,
  /// or in y, contribute to the winding numbers at that point. `excluded` are left out: those that
  /// the point lies on.
  void add_windings(const Point2& point, RayAxis axis, std::span<const PieceId> excluded,
                    LayerWindings* windings) const;

 private:
  struct Node {
    Box2 box;
    std::uint32_t first = 0;         // run
    std::uint32_t count = 0;         // of runs
    std::uint32_t second_child = 0;  // 0: a leaf; the first child is the node behind this one
    bool has_whole_contours = false;
  };

  std::uint32_t build_contours(std::span<const std::uint32_t> order);
  std::uint32_t build_runs(std::uint32_t first, std::uint32_t count, bool is_whole);
  struct FoundPairs;
  void pairs_within(std::uint32_t node, FoundPairs* found) const;
  void pairs_between(std::uint32_t a, std::uint32_t b, FoundPairs* found) const;
  template <RayAxis axis>
  void add_on_ray(const Point2& point, std::span<const PieceId> excluded,
                  LayerWindings* windings) const;
  template <RayAxis axis>
  int run_winding(const MonotoneRun& run, const Point2& point,
                  std::span<const PieceId> excluded) const;

  const MonotoneContours& contours_;
  double precision_;
  std::vector<Node> nodes_;
};

}  // namespace prefilter
