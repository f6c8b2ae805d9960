// SPDX-License-Identifier: GPL-3.0-or-later

// Layers put over each other by how much they cover of each pixel, as far as that says what shows.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "prefilter/shapes/raster/band_values.h"
#include "prefilter/shapes/raster/box_coverage.h"
#include "prefilter/shapes/raster/layer_stack.h"
#include "prefilter/shapes/raster/open_columns.h"
#include "prefilter/shapes/raster/paint_means.h"

namespace prefilter {

/// Under the box filter a pixel that one layer covers in part, and all others wholly or not at all,
/// is a mean of two colors. Where outlines of several layers meet in a pixel, or one that may wind
/// more than once passes it, it is marked, for others to find what shows there; so is one where a
/// color that varies meets an outline, a kink or a jump of its own, or steep colors below it. An
/// opaque layer that covers a pixel takes the mark away.
class CompositedRows {
 public:
  /// Of a stack, which must outlive it.
  CompositedRows(const LayerStack& stack, int width, int channels);

  /// Puts the layers over what `values`, those of the pixel rows [first_row, end_row), hold; pixels
  /// with a mark are left as `background`.
  void put_over(int first_row, int end_row, const ChannelValues& background, BandValues* values);

  bool has_marks(int row) const { return has_marks_[row - first_row_] != 0; }
  /// Whether there is one in a pixel that the box between two points meets, in the band.
  bool has_marks_within(const Point2& a, const Point2& b) const;
  /// The columns with a mark in a row.
  void marked_columns(int row, OpenColumns* columns) const;

 private:
  static constexpr int kBlock = 16;
  static constexpr unsigned kAll = (1U << kBlock) - 1;

  /// Bits of the pixels of a block that some layer covers in part, of those with a mark, of those
  /// with colors that vary, and of those that the cutter of the layer in hand passes.
  struct BlockBits {
    std::uint16_t in_part = 0;
    std::uint16_t marked = 0;
    std::uint16_t steep = 0;
    std::uint16_t cut = 0;
  };
  /// A layer's color, ready to be put over others.
  struct Coat {
    ChannelValues color;
    double opacity = 1.0;
    bool winds_once = true;
    FillRule fill_rule = FillRule::kNonzero;
    /// Of a color that varies.
    const PaintMeans* means = nullptr;
    bool is_steep = false;     // so that it counts which part of a pixel is covered
    bool is_veil = false;      // so that it counts where in a pixel it is how opaque
    bool marks_steep = false;  // also of what it covers all over
  };

  BlockBits* bits(int row) {
    return bits_.data() + static_cast<std::size_t>(row - first_row_) * blocks_;
  }
  const BlockBits* bits(int row) const {
    return bits_.data() + static_cast<std::size_t>(row - first_row_) * blocks_;
  }
  Coat coat_of(const StackLayer& layer, double steepest_below);
  void put_layer_of_channels(const Coat& coat, BandValues* values);
  void add_cutter(const EdgeList& edges);
  void forget_cutter();
  static void cover(const Coat& coat, unsigned any, unsigned full, BlockBits* bits);
  template <int kChannels>
  void put_layer(const Coat& coat, BandValues* values);
  template <int kChannels>
  void put_block(const Coat& coat, int row, int x, int count, const std::uint32_t* steps,
                 BandValues* values);
  template <int kChannels>
  void put_run(const Coat& coat, int row, int begin, int end, std::uint32_t steps,
               BandValues* values);
  void mark_level_lines(const EdgeList& edges);
  // Calls use(BlockBits*, pixels) for the blocks of the pixels [begin, end) of a row, with bits of
  // those.
  template <typename Use>
  void for_blocks(int row, int begin, int end, const Use& use) {
    for (int block = begin / kBlock; block * kBlock < end; ++block) {
      const int first = std::max(begin - block * kBlock, 0);
      const int last = std::min(end - block * kBlock, kBlock);
      use(bits(row) + block, (kAll >> (kBlock - last)) & (kAll << first));
    }
  }
  void reset_marked(const ChannelValues& background, BandValues* values);

  const LayerStack& stack_;
  int channels_;
  int width_;
  int blocks_;
  int first_row_ = 0;
  int end_row_ = 0;
  BoxCoverage coverage_;
  std::vector<BlockBits> bits_;
  std::vector<std::uint8_t> has_marks_;
  bool has_cutter_ = false;
  std::optional<PaintMeans> means_;  // of the layer in hand
  std::vector<double> run_;
};

}  // namespace prefilter
