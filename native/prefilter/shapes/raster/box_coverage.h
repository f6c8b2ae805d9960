// SPDX-License-Identifier: GPL-3.0-or-later

// What outlines cover of pixels: the box filter of chapter 2, on a way of its own.
#pragma once

#include <cstddef>
#include <cstdint>

#include "prefilter/base/outline.h"
#include "prefilter/base/progress.h"
#include "prefilter/shapes/raster/box_curves.h"
#include "prefilter/shapes/raster/box_lines.h"
#include "prefilter/shapes/raster/difference_rows.h"
#include "prefilter/shapes/raster/edge_list.h"

namespace prefilter {

/// Images wider or higher than this have pixels too far away.
inline constexpr int kMostBoxPixels = 1 << 23;

/// The coverage of outlines in a band of rows. What a segment adds depends neither on the band nor
/// on what is added with it.
class BoxCoverage {
 public:
  BoxCoverage() = default;
  BoxCoverage(const BoxCoverage&) = delete;
  BoxCoverage& operator=(const BoxCoverage&) = delete;

  /// For the rows [first_row, end_row) of an image.
  void begin(int width, int first_row, int end_row) { rows_.begin(width, first_row, end_row); }

  /// An outline that winds once round what it fills. Coordinates must be finite, and within 1e9;
  /// returns false where one is not.
  bool add(const Outline& outline);
  /// The same of segments that are known to be within.
  void add(const EdgeList& edges);

  /// As DifferenceRows::take().
  template <typename Block, typename Run>
  void take(const Block& block, const Run& run) {
    rows_.take(block, run);
  }

 private:
  bool add_polygon(std::span<const Point2> points);
  bool add_segment(std::span<const Point2> controls, double weight);

  DifferenceRows rows_;
  BoxLines lines_{&rows_};
  BoxCurves curves_{&rows_};
};

/// Where coverage goes, of 8 bits: the row y of pixels begins at data + y * stride.
struct ByteRows {
  std::uint8_t* data = nullptr;
  int width = 0;   // pixels
  int height = 0;  // pixels
  std::ptrdiff_t stride = 0;
};

/// Draws outlines one after another, each into an image of its own, with memory that is kept.
class BoxRasterizer {
 public:
  /// Writes what an outline covers of each pixel, 0 to 255 rounded to the nearest, into rows that
  /// are all 0. The outline has to wind once round what it fills, as `resolve` makes it; below 0
  /// and above 1 coverage is cut off. Throws Error for coordinates that are not finite, or farther
  /// away than 1e9 pixels, and for sizes that are not 1 to kMostBoxPixels.
  void draw(const Outline& outline, const ByteRows& target);

 private:
  BoxCoverage coverage_;
};

/// The same for any outline, on several threads.
void rasterize_coverage(const Outline& outline, FillRule rule, const ByteRows& target,
                        int threads = 0, const Progress& progress = {});

}  // namespace prefilter
