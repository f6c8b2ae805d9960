// SPDX-License-Identifier: GPL-3.0-or-later

// Coverage of pixels by outlines under the box filter (section 2.2): the fast path for it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "prefilter/base/outline.h"
#include "prefilter/base/run.h"
#include "prefilter/shapes/raster/box_curves.h"
#include "prefilter/shapes/raster/box_lines.h"
#include "prefilter/shapes/raster/difference_rows.h"
#include "prefilter/shapes/raster/edge_list.h"

namespace prefilter {

/// The largest image side, in pixels; farther coordinates are too coarse.
inline constexpr int kMaxBoxImageSide = 1 << 23;

/// Coverage of outlines in a band of rows. The contribution of a segment depends neither on the
/// band nor on other segments, so that images do not depend on how they are split.
class BoxCoverage {
 public:
  BoxCoverage() = default;
  BoxCoverage(const BoxCoverage&) = delete;
  BoxCoverage& operator=(const BoxCoverage&) = delete;

  /// Starts the rows [first_row, end_row) of an image.
  void begin(int width, int first_row, int end_row) { rows_.begin(width, first_row, end_row); }

  /// Adds an outline that winds once around its filled part. Returns false if a coordinate is not
  /// finite, or above 1e9 in magnitude.
  bool add(const Outline& outline);
  /// Adds segments whose coordinates are known to be in range.
  void add(const EdgeList& edges);

  /// See DifferenceRows::take().
  template <typename Block, typename UseRun>
  void take(const Block& block, const UseRun& use_run) {
    rows_.take(block, use_run);
  }

 private:
  bool add_polygon(std::span<const Point2> points);
  bool add_segment(std::span<const Point2> controls, double weight);

  DifferenceRows rows_;
  BoxLines lines_{&rows_};
  BoxCurves curves_{&rows_};
};

/// Target of 8-bit coverage: pixel row y begins at data + y * stride.
struct ByteRows {
  std::uint8_t* data = nullptr;
  int width = 0;   // pixels
  int height = 0;  // pixels
  std::ptrdiff_t stride = 0;
};

/// Draws outlines into images of their own, one after another, and reuses memory.
class BoxRasterizer {
 public:
  /// Writes the coverage of each pixel, 0 to 255 rounded to the nearest, into rows that must be all
  /// 0. The outline must wind once around its filled part, as the result of `resolve` does.
  /// Coverage is clamped to [0, 1]. Throws Error for coordinates that are not finite, or above 1e9
  /// in magnitude, and for sides outside 1 to kMaxBoxImageSide.
  void draw(const Outline& outline, const ByteRows& target);

 private:
  BoxCoverage coverage_;
};

/// Draws the coverage of any outline, on several threads. See BoxRasterizer::draw.
void rasterize_coverage(const Outline& outline, FillRule rule, const ByteRows& target,
                        const Run& run = {});

}  // namespace prefilter
