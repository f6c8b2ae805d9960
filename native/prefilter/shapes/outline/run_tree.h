// SPDX-License-Identifier: GPL-3.0-or-later

// Tree of bounding boxes over monotone runs. Finds pairs of pieces that may intersect, and the
// pieces hit by a ray.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/shapes/outline/monotone_contours.h"

namespace prefilter {

/// A piece by the index of its contour and its index in that contour.
struct PieceId {
  std::uint32_t contour = 0;
  std::uint32_t piece = 0;

  friend auto operator<=>(const PieceId&, const PieceId&) = default;
};

/// Winding numbers around one point, one per layer. Most of them are 0.
class LayerWindings {
 public:
  explicit LayerWindings(std::size_t layers) : values_(layers, 0) {}

  int operator[](std::size_t layer) const { return values_[layer]; }
  /// Layers passed to `add`; a layer may occur more than once.
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

/// Direction of a ray.
enum class RayAxis : std::uint8_t { kX, kY };

class RunTree {
 public:
  /// The contours must outlive the tree. Boxes closer than `precision` count as overlapping.
  RunTree(const MonotoneContours& contours, double precision);

  /// Appends each pair of pieces whose boxes overlap once. Neighbors along a run, which meet only
  /// at their joint, are left out. Returns false if there are more than `most` pairs.
  bool append_pairs(std::size_t most, std::vector<std::pair<PieceId, PieceId>>* pairs) const;

  /// Adds the winding numbers around a point, counted along a ray from it toward +x or +y. Pieces
  /// through the point must be listed in `excluded`.
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
  struct PairSearch;
  void pairs_within(std::uint32_t node, PairSearch* search) const;
  void pairs_between(std::uint32_t a, std::uint32_t b, PairSearch* search) const;
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
