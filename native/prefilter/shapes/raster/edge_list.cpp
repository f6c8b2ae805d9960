// SPDX-License-Identifier: GPL-3.0-or-later

// Runs of 64 segments carry their vertical extent, so that a band skips most others.
#include "prefilter/shapes/raster/edge_list.h"

#include <algorithm>

namespace prefilter {

void EdgeList::add(const Outline& outline, bool closes) {
  const std::size_t count = outline.segments().size();
  for (std::size_t first = 0; first < count; first += kRunLength) {
    Run run{&outline, first, std::min(first + kRunLength, count), HUGE_VAL, -HUGE_VAL};
    for (std::size_t i = run.first; i < run.end; ++i) {
      for (const Point2& point : outline.controls(outline.segments()[i])) {
        run.low = std::min(run.low, point.y);
        run.high = std::max(run.high, point.y);
      }
    }
    runs_.push_back(run);
    low_ = std::min(low_, run.low);
    high_ = std::max(high_, run.high);
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
