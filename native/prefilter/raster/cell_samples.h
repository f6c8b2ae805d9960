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

/// Rows of samples, each a little farther to the right or left than the one below, so that an edge
/// of any direction but along the rows passes all columns alike. One along the rows is off by half
/// of their distance at the most.
class CellSamples {
 public:
  static constexpr int kMostRows = 128;
  static constexpr int kLeastRows = 32;
  /// How many samples so many rows have.
  static constexpr std::size_t count_of(int rows) {
    return static_cast<std::size_t>(rows) * (rows / kRowsPerColumn);
  }

  /// With `keeps_places` there are moments of any degree; else only of degree 0, of colors that are
  /// constant.
  CellSamples(const StackArcs& stack_arcs, int channels, bool keeps_places);

  /// What a cell shows less the background, its layers seen as `colors` has it, by so many rows of
  /// samples: 32, 64 or 128.
  void compose(int column, int row, std::span<const CellLayer> layers, int sample_rows,
               CellColors* colors);
  /// The integrals of a channel times x^a y^b, of powers up to `degree`, at
  /// [a * (degree + 1) + b].
  void moments(int channel, int degree, double* out) const;

 private:
  using Samples = std::vector<float>;  // by columns, and in those by rows

  static constexpr int kRowsPerColumn = 4;

  void begin(int rows);
  int first_row_above(double y) const;
  double sample_y(int sample_row) const { return (sample_row + 0.5) / rows_ - 0.5; }
  void add_winding(Point2 low, Point2 high, std::int32_t winding);
  void add_arc(const StackArc& arc);
  void add_windings(const CellLayer& layer);
  void find_share(FillRule rule);
  void put_behind(std::span<const ChannelValues> color, std::span<const ChannelValues> opacity,
                  const CellColors& colors);
  void put_constant_behind(const ChannelValues& color, double opacity);
  void put_powers_behind(const std::array<ColorPowers, kMaxChannels>& color,
                         const ColorPowers& opacity);
  void put_full_behind(std::span<const Veil> veils, const CellColors& colors);
  void put_layer_behind(std::span<const ChannelValues> color, const CellColors& colors);
  bool is_covered() const;

  const StackArcs& stack_arcs_;
  int channels_;
  bool keeps_places_;
  Point2 center_;
  int rows_ = 0;
  int columns_ = 0;
  int count_ = 0;
  std::array<float, kMostRows> offsets_{};  // of the samples of a row, in columns
  std::vector<std::int32_t> steps_;         // a column more than there are samples
  Samples passing_;                         // through what is there already
  Samples share_;                           // what of that has the next color behind it
  std::vector<Samples> values_;             // of each channel, where they are kept
  ChannelValues sums_{};                    // or their sums
  std::vector<ChannelValues> opacities_;
};

}  // namespace prefilter
