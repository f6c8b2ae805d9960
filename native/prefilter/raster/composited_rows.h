// SPDX-License-Identifier: GPL-3.0-or-later

// Layers put over each other by how much they cover of each pixel, as far as that says what shows.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "prefilter/raster/band_values.h"
#include "prefilter/raster/box_coverage.h"
#include "prefilter/raster/layer_stack.h"
#include "prefilter/raster/open_columns.h"

namespace prefilter {

/// Under the box filter a pixel that one layer covers in part, and all others wholly or not at all,
/// is a mean of two colors. Where outlines of several layers meet in a pixel, or one that may wind
/// more than once passes it, it is marked, for others to find what shows there. An opaque layer
/// that covers a pixel takes the mark away.
class CompositedRows {
 public:
  /// Of a stack of constant colors, which must outlive it.
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

  /// Bits of the pixels of a block that some layer covers in part, and of those with a mark.
  struct BlockBits {
    std::uint16_t in_part = 0;
    std::uint16_t marked = 0;
  };
  /// A layer's color, ready to be put over others.
  struct Coat {
    ChannelValues color;
    double opacity = 1.0;
    bool winds_once = true;
    FillRule fill_rule = FillRule::kNonzero;
  };

  BlockBits* bits(int row) {
    return bits_.data() + static_cast<std::size_t>(row - first_row_) * blocks_;
  }
  const BlockBits* bits(int row) const {
    return bits_.data() + static_cast<std::size_t>(row - first_row_) * blocks_;
  }
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
};

}  // namespace prefilter
