// SPDX-License-Identifier: GPL-3.0-or-later

// Integrals over a cell of layers whose colors vary, by quadrature on the parts between arcs.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/shapes/raster/cell_colors.h"
#include "prefilter/shapes/raster/cell_slabs.h"

namespace prefilter {

/// Gaussian quadrature on each part of a cell between two heights and two arcs. Weights are not
/// negative and add up to the cell's area however arcs are rounded, so a cell's value is a mean of
/// composited values at points. If stops are fine, it is a mean of means over small parallelograms,
/// whose number per cell is independent of how fine the stops are.
class CellQuadrature {
 public:
  /// For integrals of values times x^a y^b, with powers up to `degree`.
  explicit CellQuadrature(int degree);

  /// Computes the integrals of a cell's composited color minus the background. `layers` are the
  /// visible layers, at most 63. Returns false if that takes more than `most_work` steps.
  bool find(std::span<const CellLayer> layers, const CellColors& colors, std::size_t most_work);
  /// Computes the integrals of a cell without arcs.
  void find_full(const CellColors& colors);
  /// Integrals of a channel, at [a * (degree + 1) + b].
  std::span<const double> sums(int channel) const { return sums_[channel]; }
  /// Steps taken.
  std::size_t work() const { return slabs_.work(); }

 private:
  struct Rule {
    std::span<const double> nodes;  // on [0, 1]
    std::span<const double> weights;
  };
  // Side of a part at the middle of a row, and its shift over the row's height.
  struct FineSide {
    double x = 0.0;
    double shift = 0.0;
  };
  static Rule rule_of(int points);

  void begin(const CellColors& colors);
  void add_slab(std::span<const CellLayer> layers, const CellColors& colors, double low,
                double high);
  void set_parts(std::span<const CellLayer> layers, const CellColors& colors);
  bool add_constant_slab(const CellColors& colors, double low, double high);
  void add_row(const CellColors& colors, std::uint64_t present, double left, double width, double y,
               double weight);
  void add_fine_slab(const CellColors& colors, double low, double high);
  void add_fine_row(const CellColors& colors, double low, double high);
  void add_parallelograms(const CellColors& colors, std::uint64_t present, const FineSide& left,
                          const FineSide& right, double low, double high);
  void add_value(const ChannelValues& value, const Point2& point, double weight);

  int degree_;
  int channels_ = 0;
  Rule along_;   // in x
  Rule across_;  // in y over a slab, whose sides may slant
  // For the current cell.
  Rule cell_along_;
  Rule cell_across_;
  bool has_fine_stops_ = false;
  CellSlabs slabs_;
  // Part of a slab between two arcs: its layers, whether any is visible, and whether the color
  // varies.
  struct Part {
    std::uint64_t present = 0;
    bool is_visible = false;
    bool varies = false;
  };
  std::vector<Part> parts_;
  std::array<std::vector<double>, kMaxChannels> sums_;
};

}  // namespace prefilter
