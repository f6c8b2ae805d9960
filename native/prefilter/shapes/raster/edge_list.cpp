// SPDX-License-Identifier: GPL-3.0-or-later

// Runs of 64 segments carry their vertical extent, so that a band skips most others.
#include "prefilter/shapes/raster/edge_list.h"

#include <algorithm>

namespace prefilter {

void EdgeList::add(const Outline& outline, bool closes) {
  const std::size_t count = outline.segments().size();
  for (std::size_t first = 0; first < count; first += kRunLength) {
    SegmentRange range{&outline, first, std::min(first + kRunLength, count), HUGE_VAL, -HUGE_VAL};
    for (std::size_t i = range.first; i < range.end; ++i) {
      for (const Point2& point : outline.controls(outline.segments()[i])) {
        range.low = std::min(range.low, point.y);
        range.high = std::max(range.high, point.y);
      }
    }
    runs_.push_back(range);
    low_ = std::min(low_, range.low);
    high_ = std::max(high_, range.high);
  }
  if (!closes) return;
  for (std::size_t contour = 0; contour < outline.contour_count(); ++contour) {
    const auto segments = outline.contour(contour);
    if (segments.empty()) continue;
    const Point2& begin = outline.begin_of(contour);
    const Point2& end = outline.controls(segments.back()).back();
    if (!(begin == end)) closing_.push_back({end, begin});
  }
}

}  // namespace prefilter
