// SPDX-License-Identifier: GPL-3.0-or-later

// Segments of outlines, searchable by the rows they cross.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "prefilter/base/outline.h"
#include "prefilter/geometry/moments/monotone_curve.h"
#include "prefilter/shapes/raster/cell_filter.h"

namespace prefilter {

/// Largest magnitude of coordinates, in pixels. They fit an int, and keep a precision of 2^-20
/// pixels.
inline constexpr double kMaxPixelCoordinate = 1e9;

/// Segments of outlines whose coverage is added, in runs of consecutive segments.
class EdgeList {
 public:
  /// Adds an outline, which must outlive the list. If `closes`, a line closes each open contour.
  void add(const Outline& outline, bool closes = true);

  bool empty() const { return runs_.empty(); }
  /// Vertical extent, in pixels.
  double low() const { return low_; }
  double high() const { return high_; }

  /// Calls use(const MonotoneCurve&, bool backward) for the monotone pieces, in cell coordinates,
  /// of segments that may pass between two rows of cells.
  template <typename Use>
  void for_pieces_between(int first_row, int end_row, const CellFilter& filter,
                          const Use& use) const;
  /// Calls use(controls, weight) for segments that may pass between two heights, in pixels.
  template <typename Use>
  void for_segments_between(double low, double high, const Use& use) const;

 private:
  struct SegmentRange {
    const Outline* outline = nullptr;
    std::size_t first = 0;
    std::size_t end = 0;
    double low = 0.0;
    double high = 0.0;
  };
  struct Line {
    Point2 begin;
    Point2 end;
  };
  static constexpr std::size_t kRunLength = 64;

  std::vector<SegmentRange> runs_;
  std::vector<Line> closing_;
  double low_ = HUGE_VAL;
  double high_ = -HUGE_VAL;
};

template <typename Use>
void EdgeList::for_pieces_between(int first_row, int end_row, const CellFilter& filter,
                                  const Use& use) const {
  std::array<Point2, Outline::kMostDegree + 1> cells;
  for_segments_between(filter.to_pixel(first_row), filter.to_pixel(end_row),
                       [&](std::span<const Point2> controls, double weight) {
                         std::transform(controls.begin(), controls.end(), cells.begin(),
                                        [&](const Point2& point) -> Point2 {
                                          return {filter.to_cell(point.x), filter.to_cell(point.y)};
                                        });
                         for_monotone_pieces({cells.data(), controls.size()}, weight, use);
                       });
}

template <typename Use>
void EdgeList::for_segments_between(double low, double high, const Use& use) const {
  const auto use_segment = [&](std::span<const Point2> controls, double weight) {
    double segment_low = HUGE_VAL;
    double segment_high = -HUGE_VAL;
    for (const Point2& point : controls) {
      segment_low = std::min(segment_low, point.y);
      segment_high = std::max(segment_high, point.y);
    }
    if (segment_high < low || segment_low > high) return;
    use(controls, weight);
  };
  for (const SegmentRange& range : runs_) {
    if (range.high < low || range.low > high) continue;
    for (std::size_t i = range.first; i < range.end; ++i) {
      const Outline::Segment& segment = range.outline->segments()[i];
      use_segment(range.outline->controls(segment), segment.weight);
    }
  }
  for (const Line& line : closing_) {
    const std::array<Point2, 2> controls = {line.begin, line.end};
    use_segment(controls, 0.0);
  }
}

}  // namespace prefilter
