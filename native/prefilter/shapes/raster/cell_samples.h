// SPDX-License-Identifier: GPL-3.0-or-later

// Point sampling for cells crossed by more arcs than an image can resolve: layers are composited
// sample by sample.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/shapes/raster/cell_colors.h"
#include "prefilter/shapes/raster/row_layers.h"
#include "prefilter/shapes/raster/sample_bits.h"

namespace prefilter {

/// Samples are grouped in blocks of 8 x 8. A layer that fills a block costs one operation for it,
/// and only partially filled blocks are handled sample by sample, so that a layer takes time in
/// proportion to its boundary.
class CellSamples {
 public:
  static constexpr int kSide = SampleBits::kSide;
  static constexpr int kCount = SampleBits::kCount;

  /// If `keeps_samples`, values are kept per sample and moments of any degree are available;
  /// otherwise only degree 0, for constant colors.
  CellSamples(const StackArcs& stack_arcs, int channels, bool keeps_samples);

  /// Composites the layers of a cell; the result is relative to the background.
  void compose(int column, int row, std::span<const CellLayer> layers, CellColors* colors);
  /// Writes the integrals of a channel times x^a y^b, with powers up to `degree`, at [a * (degree +
  /// 1) + b].
  void moments(int channel, int degree, double* out) const;

 private:
  static constexpr int kBlockSide = 8;
  static constexpr int kBlockCount = kBlockSide * kBlockSide;
  static constexpr int kBlocks = kCount / kBlockCount;

  using Samples = std::vector<float>;  // by block, then by row within the block
  // Layers composited behind a whole block that are not yet applied to its samples.
  struct Pending {
    std::array<float, kMaxChannels> color{};
    float transmittance = 1.0F;
  };

  void begin();
  void allow_translucency();
  double close_filled(const SampleRows& filled);
  void set_filled_blocks(const SampleRows& filled);
  double composite_blocks(const ChannelValues& color, float opaque);
  float composite_block(int block, const ChannelValues& color, float opaque);
  void apply_pending(int block);
  void put_constant_behind(const SampleRows& filled, const ChannelValues& color, double opacity);
  void put_varying_behind(const SampleRows& filled, std::uint32_t layer, const CellColors& colors);
  void put_full_behind(const LayerAccumulator& accumulated);
  bool are_equal(const CellLayer& a, const CellLayer& b) const;
  std::size_t put_layer_behind(std::size_t i, std::span<const CellLayer> layers,
                               CellColors* colors);
  void compose_constant(std::span<const CellLayer> layers, CellColors* colors);
  void compose_varying(std::span<const CellLayer> layers, CellColors* colors);
  void subtract_background(const ChannelValues& background);

  const StackArcs& stack_arcs_;
  int channels_;
  bool keeps_samples_;
  Point2 center_;
  SampleBits bits_;
  // Transmittance of the layers composited so far. While all are opaque, it is 1 for the samples in
  // `open_` and 0 for others; then it is `transmittance_` times `pending_[].transmittance`. Both
  // are multiplied by `shared_transmittance_`.
  bool are_all_opaque_ = true;
  SampleRows open_{};
  Samples transmittance_;
  std::array<Pending, kBlocks> pending_{};
  std::array<float, kBlocks> block_transmittance_{};  // sum of transmittance_ over each block
  std::uint64_t open_blocks_ = 0;
  std::array<std::uint64_t, kBlocks> filled_blocks_{};  // the current layer's samples, by block
  double shared_transmittance_ = 1.0;
  double transmittance_sum_ = kCount;  // of all samples, without shared_transmittance_
  std::vector<Samples> values_;        // per channel, if kept per sample
  ChannelValues sums_{};               // otherwise their sums
};

}  // namespace prefilter
