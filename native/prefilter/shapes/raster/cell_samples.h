// SPDX-License-Identifier: GPL-3.0-or-later

// Cells that more arcs pass than an image can show: their layers, put one behind another sample by
// sample.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/shapes/raster/cell_colors.h"
#include "prefilter/shapes/raster/row_layers.h"
#include "prefilter/shapes/raster/sample_bits.h"

namespace prefilter {

/// Samples are in blocks of 8 x 8: what fills all of a block counts for the block, and only what
/// fills part of it for each sample, so that a layer takes time in proportion to its boundary.
class CellSamples {
 public:
  static constexpr int kSide = SampleBits::kSide;
  static constexpr int kCount = SampleBits::kCount;

  /// With `keeps_places` there are moments of any degree; else only of degree 0, of colors that are
  /// constant.
  CellSamples(const StackArcs& stack_arcs, int channels, bool keeps_places);

  /// What a cell shows less the background, its layers seen as `colors` has it.
  void compose(int column, int row, std::span<const CellLayer> layers, CellColors* colors);
  /// The integrals of a channel times x^a y^b, of powers up to `degree`, at
  /// [a * (degree + 1) + b].
  void moments(int channel, int degree, double* out) const;

 private:
  static constexpr int kBlockSide = 8;
  static constexpr int kBlockCount = kBlockSide * kBlockSide;
  static constexpr int kBlocks = kCount / kBlockCount;

  using Samples = std::vector<float>;  // by blocks, and in those by rows
  // What was put behind all of a block's samples since they were looked at one by one.
  struct Behind {
    std::array<float, kMaxChannels> color{};
    float passing = 1.0F;
  };

  void begin();
  void let_some_pass();
  double take_opaque(const SampleRows& filled);
  void take_blocks(const SampleRows& filled);
  double take_passing(const ChannelValues& color, float opaque);
  float take_part(int block, const ChannelValues& color, float opaque);
  void take_behind(int block);
  void put_constant_behind(const SampleRows& filled, const ChannelValues& color, double opacity);
  void put_varying_behind(const SampleRows& filled, std::uint32_t layer, const CellColors& colors);
  void put_full_behind(const Veil& veil);
  bool are_equal(const CellLayer& a, const CellLayer& b) const;
  std::size_t put_layer_behind(std::size_t i, std::span<const CellLayer> layers,
                               CellColors* colors);
  void compose_constant(std::span<const CellLayer> layers, CellColors* colors);
  void compose_varying(std::span<const CellLayer> layers, CellColors* colors);
  void take_background(const ChannelValues& background);

  const StackArcs& stack_arcs_;
  int channels_;
  bool keeps_places_;
  Point2 center_;
  SampleBits bits_;
  // What passes through what is there already: all or nothing, as `open_` tells, or `passing_`
  // times `behind_[].passing`; times `passing_all_`.
  bool is_opaque_ = true;
  SampleRows open_{};
  Samples passing_;
  std::array<Behind, kBlocks> behind_{};
  std::array<float, kBlocks> block_left_{};  // the sums of passing_
  std::uint64_t open_blocks_ = 0;
  std::array<std::uint64_t, kBlocks> filled_blocks_{};  // by the layer in hand
  double passing_all_ = 1.0;
  double left_ = kCount;         // the sum of what passes, without passing_all_
  std::vector<Samples> values_;  // of each channel, where they are kept
  ChannelValues sums_{};         // or their sums
};

}  // namespace prefilter
