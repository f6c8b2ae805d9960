// SPDX-License-Identifier: GPL-3.0-or-later

// Cuts the arcs in a cell where they cross, and records the layers on both sides of each part.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/shapes/raster/key_index.h"
#include "prefilter/shapes/raster/row_layers.h"

namespace prefilter {

/// Part of an arc; arcs of several layers may overlap along it.
struct SweptPart {
  static constexpr std::uint32_t kLeftSide = UINT32_MAX;

  std::uint32_t arc = kLeftSide;  // index into CellSweep::arcs(), or the left side of the cell
  double low = 0.0;               // heights relative to the cell's center
  double high = 0.0;
  std::uint32_t left = 0;  // states on both sides
  std::uint32_t right = 0;
};

/// Sweeps upward through a cell. Between two heights at which an arc ends or two arcs cross, the
/// order of the arcs is their order at the middle. The error of a missed crossing is the area
/// between two arcs that close.
class CellSweep {
 public:
  /// A state is a bit mask of present layers; the highest bit marks kNothing.
  static constexpr std::size_t kMaxSweptLayers = 63;
  /// State to the left of the cell, in which nothing is visible.
  static constexpr std::uint32_t kNothing = 0;

  explicit CellSweep(const StackArcs& stack_arcs) : stack_arcs_(stack_arcs) {}

  /// Sweeps the cell at a column of a row, for at most kMaxSweptLayers layers. Returns false if
  /// that takes more than `most_work` steps.
  bool sweep(int column, int row, std::span<const CellLayer> layers, std::size_t most_work);
  /// Steps taken.
  std::size_t work() const { return work_; }

  std::span<const SweptPart> parts() const { return parts_; }
  const StackArc& arc(const SweptPart& part) const { return *arcs_[part.arc].arc; }
  /// Number of states, including kNothing, and the layers present in a state.
  std::size_t state_count() const { return states_.keys().size(); }
  std::uint64_t present_in(std::uint32_t state) const { return states_.keys()[state]; }
  /// Point of an arc at a height.
  Point2 point_at(const StackArc& arc, double y) const { return {x_at(arc, y), y}; }
  /// Parameter of a curved arc at a height.
  double parameter_at(const StackArc& arc, double y) const;

 private:
  struct SweptArc {
    const StackArc* arc = nullptr;
    std::uint32_t layer = 0;  // index among the cell's layers
    std::uint32_t part = kNoPart;
    double slope = 0.0;  // dx / dy, for lines
    double x = 0.0;
  };
  static constexpr std::uint32_t kNoPart = UINT32_MAX;
  static constexpr std::uint64_t kNothingKey = std::uint64_t{1} << kMaxSweptLayers;

  void collect_arcs(std::span<const CellLayer> layers);
  void add_crossings();
  void add_crossings_of(const SweptArc& a, const SweptArc& b);
  void add_roots(const SweptArc& a, const SweptArc& b, double low, double at_low, double high,
                 double at_high, int depth);
  double root_between(const SweptArc& a, const SweptArc& b, double low, double at_low, double high,
                      double at_high) const;
  void sweep_slab(std::span<const CellLayer> layers, double low, double high);
  void set_left_side(std::span<const CellLayer> layers, double y);
  void cross(const SweptArc& arc, std::span<const CellLayer> layers);
  void add_part(std::uint32_t arc, double low, double high, std::uint32_t left,
                std::uint32_t right);
  double x_at(const StackArc& arc, double y) const;
  double x_at(const SweptArc& arc, double y) const;

  const StackArcs& stack_arcs_;
  Point2 center_;
  std::vector<SweptArc> arcs_;
  std::vector<double> heights_;
  std::vector<std::uint32_t> order_;
  std::vector<std::int32_t> windings_;
  std::uint64_t present_ = 0;
  std::uint32_t side_part_ = kNoPart;
  std::vector<SweptPart> parts_;
  KeyIndex states_;
  std::size_t work_ = 0;
};

}  // namespace prefilter
