// SPDX-License-Identifier: GPL-3.0-or-later

// Compositing of layers by their coverage of each pixel, where that is exact.
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

/// Under the box filter, a pixel that one layer covers partially and all others fully or not at all
/// is a mean of two colors. A pixel is marked for a more exact method if the outlines of several
/// layers pass it, if an outline passes it that may wind more than once, or if a varying color
/// meets an outline, a kink or jump of its own, or steep colors below it. An opaque layer that
/// fully covers a pixel removes the mark.
class CompositedRows {
 public:
  /// The stack must outlive this object.
  CompositedRows(const LayerStack& stack, int width, int channels);

  /// Composites the layers over `values`, the pixel rows [first_row, end_row). Marked pixels are
  /// reset to `background`.
  void composite_over(int first_row, int end_row, const ChannelValues& background,
                      BandValues* values);

  bool has_marks(int row) const { return has_marks_[row - first_row_] != 0; }
  /// Whether a marked pixel in the band overlaps the box between two points.
  bool has_marks_within(const Point2& a, const Point2& b) const;
  /// Opens the marked columns of a row.
  void marked_columns(int row, OpenColumns* columns) const;

 private:
  static constexpr int kBlock = 16;
  static constexpr unsigned kAll = (1U << kBlock) - 1;

  /// Bits of a block's pixels: partially covered by some layer, marked, with varying colors, and
  /// passed by the cutter of the current layer.
  struct BlockBits {
    std::uint16_t in_part = 0;
    std::uint16_t marked = 0;
    std::uint16_t steep = 0;
    std::uint16_t cut = 0;
  };
  /// The color of a layer, prepared for compositing.
  struct PreparedLayer {
    ChannelValues color;
    double opacity = 1.0;
    bool winds_once = true;
    FillRule fill_rule = FillRule::kNonzero;
    /// for a varying color
    const PaintMeans* means = nullptr;
    bool is_steep = false;           // matters which part of a pixel it covers
    bool has_varying_alpha = false;  // its alpha varies within partially covered pixels
    bool marks_steep = false;        // marks pixels over steep colors, even if fully covered
  };

  BlockBits* bits(int row) {
    return bits_.data() + static_cast<std::size_t>(row - first_row_) * blocks_;
  }
  const BlockBits* bits(int row) const {
    return bits_.data() + static_cast<std::size_t>(row - first_row_) * blocks_;
  }
  PreparedLayer prepare(const StackLayer& layer, double steepest_below);
  void put_layer_by_channels(const PreparedLayer& prepared, BandValues* values);
  void add_cutter(const EdgeList& edges);
  void clear_cutter();
  static void cover(const PreparedLayer& prepared, unsigned any, unsigned full, BlockBits* bits);
  template <int kChannels>
  void put_layer(const PreparedLayer& prepared, BandValues* values);
  template <int kChannels>
  void put_block(const PreparedLayer& prepared, int row, int x, int count,
                 const std::uint32_t* steps, BandValues* values);
  template <int kChannels>
  void put_run(const PreparedLayer& prepared, int row, int begin, int end, std::uint32_t steps,
               BandValues* values);
  void mark_horizontal_lines(const EdgeList& edges);
  // Calls use(BlockBits*, pixels) for the blocks that contain the pixels [begin, end) of a row,
  // with a bit mask of these pixels.
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
  std::optional<PaintMeans> means_;  // of the current layer
  std::vector<double> run_;
};

}  // namespace prefilter
