// SPDX-License-Identifier: GPL-3.0-or-later

// Cells that more arcs pass than an image can show: winding numbers summed up on a fine grid.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/raster/cell_colors.h"
#include "prefilter/raster/row_layers.h"

namespace prefilter {

/// Rows of samples, each farther to the right than the one below by another part of their distance,
/// in no order that edges could have, too. So an edge of any direction is off by what lies between
/// half of two rows at the most, and mostly by a tenth of that.
class CellSamples {
 public:
  static constexpr int kRows = 128;
  static constexpr int kColumns = 32;
  static constexpr int kCount = kRows * kColumns;

  /// Where a sample is, from the cell's center.
  static Point2 place(int row, int column);

  /// With `keeps_places` there are moments of any degree; else only of degree 0, of colors that are
  /// constant.
  CellSamples(const StackArcs& stack_arcs, int channels, bool keeps_places);

  /// What a cell shows less the background, its layers seen as `colors` has it.
  void compose(int column, int row, std::span<const CellLayer> layers, CellColors* colors);
  /// The integrals of a channel times x^a y^b, of powers up to `degree`, at
  /// [a * (degree + 1) + b].
  void moments(int channel, int degree, double* out) const;

 private:
  static constexpr int kWordRows = 64;
  static constexpr int kWords = kRows / kWordRows;

  using Samples = std::vector<float>;  // by columns, and in those by rows
  // A bit a row, of each column.
  using Bits = std::array<std::array<std::uint64_t, kWords>, kColumns>;

  void begin();
  template <typename Use>
  void for_steps(const StackArc& arc, const Use& use) const;
  void fill_odd(const CellLayer& layer);
  template <typename Count>
  void fill_by_windings(const CellLayer& layer, std::vector<Count>* steps);
  void fill(const CellLayer& layer);
  void let_some_pass();
  double take_opaque();
  float take_passing(int column, int word, const ChannelValues& color, float opaque);
  double take_passing(const ChannelValues& color, float opaque);
  void put_constant_behind(const ChannelValues& color, double opacity);
  void put_powers_behind(const std::array<ColorPowers, kMaxChannels>& color,
                         const ColorPowers& opacity);
  void put_nodes_behind(std::span<const ChannelValues> color,
                        std::span<const ChannelValues> opacity, const CellColors& colors);
  void put_full_behind(std::span<const Veil> veils, const CellColors& colors);
  bool are_equal(const CellLayer& a, const CellLayer& b) const;
  std::size_t put_layer_behind(std::size_t i, std::span<const CellLayer> layers,
                               CellColors* colors);
  void take_background(const ChannelValues& background);

  const StackArcs& stack_arcs_;
  int channels_;
  bool keeps_places_;
  Point2 center_;
  std::vector<std::int8_t> narrow_steps_;  // a column more than there are samples; 0 between layers
  std::vector<std::int32_t> wide_steps_;   // likewise
  Bits filled_{};                          // by the layer in hand
  // What passes through what is there already: all or nothing, as `open_` tells, or `passing_`,
  // which does not show where it is not open; times `passing_all_`.
  bool is_opaque_ = true;
  Bits open_{};
  Samples passing_;
  double passing_all_ = 1.0;
  double left_ = kCount;         // the sum of that, without passing_all_
  std::vector<Samples> values_;  // of each channel, where they are kept
  ChannelValues sums_{};         // or their sums
};

}  // namespace prefilter
