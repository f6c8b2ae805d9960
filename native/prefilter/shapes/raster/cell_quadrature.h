// SPDX-License-Identifier: GPL-3.0-or-later

// What a cell shows of layers whose colors vary, by values at points of the parts into which arcs
// cut it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/shapes/raster/cell_colors.h"
#include "prefilter/shapes/raster/cell_slabs.h"

namespace prefilter {

/// Gauss's rule on each part of a cell between two heights and two arcs. Weights are not below 0,
/// and those of a cell add up to its area however arcs are rounded: what the cell shows is a mean
/// of values that the layers show at points. Where stops are fine it is one of means over small
/// parallelograms, of which a cell has about as many however fine they are.
class CellQuadrature {
 public:
  /// For integrals of values times x^a y^b, of powers up to `degree`.
  explicit CellQuadrature(int degree);

  /// Sets the integrals of what a cell shows less the background, its layers seen as `colors` has
  /// it. `layers` are those that are seen, up to 63 of them. Returns false where that takes more
  /// than `most_work` steps.
  bool find(std::span<const CellLayer> layers, const CellColors& colors, std::size_t most_work);
  /// The same of a cell without arcs.
  void find_full(const CellColors& colors);
  /// Of a channel, at [a * (degree + 1) + b].
  std::span<const double> sums(int channel) const { return sums_[channel]; }
  /// How many steps that took.
  std::size_t work() const { return slabs_.work(); }

 private:
  struct Rule {
    std::span<const double> nodes;  // on [0, 1]
    std::span<const double> weights;
  };
  // Where a side of a part is halfway up a row, and what it moves along the row's height.
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
  Rule along_;   // x
  Rule across_;  // y, of a slab, whose sides may slant
  // Of the cell in hand.
  Rule own_along_;
  Rule own_across_;
  bool has_fine_stops_ = false;
  CellSlabs slabs_;
  // Between the arcs of a slab: layers, whether they show anything, and whether that varies.
  struct Part {
    std::uint64_t present = 0;
    bool is_anything = false;
    bool varies = false;
  };
  std::vector<Part> parts_;
  std::array<std::vector<double>, kMaxChannels> sums_;
};

}  // namespace prefilter
