// SPDX-License-Identifier: GPL-3.0-or-later

// Between two stops a gradient along a line is linear, so the shape is cut into strips at its
// stops.
#include "prefilter/shapes/raster/gradient_strips.h"

#include <algorithm>
#include <cmath>

#include "prefilter/shapes/half_plane.h"
#include "prefilter/shapes/raster/paint_bounds.h"

namespace prefilter {
namespace {

// A narrower strip, in pixels, is painted with one color: its slope, of the inverse of its width,
// would magnify the rounding of moments.
constexpr double kMinStripWidth = 1.0 / 4096.0;

// The offset as a linear function of the shape's coordinates.
LinearFunction offset_function(const Paint& paint) {
  const Point2 axis = paint.end - paint.start;
  const Point2 unit = (1.0 / dot(axis, axis)) * axis;
  // A point p is origin + x_axis u + y_axis v; its offset is (u, v) . unit minus the value at
  // start.
  const AffineMap2& map = paint.to_shape;
  const double determinant = cross(map.x_axis, map.y_axis);
  const Point2 u{map.y_axis.y / determinant, -map.y_axis.x / determinant};
  const Point2 v{-map.x_axis.y / determinant, map.x_axis.x / determinant};
  const Point2 slope = unit.x * u + unit.y * v;
  return {slope, -dot(slope, map.origin) - dot(unit, paint.start)};
}

Paint constant_paint(const Paint& paint, const ChannelValues& value) {
  Paint out;
  out.channels = paint.channels;
  out.constant = value;
  return out;
}

// Linear color from `before` at the offset `low` to `after` at `high`.
Paint linear_paint(const Paint& paint, const LinearFunction& offset, double low, double high,
                   const ChannelValues& before, const ChannelValues& after) {
  if (before == after) return constant_paint(paint, before);
  if (high - low < kMinStripWidth * length(offset.slope)) {
    ChannelValues mean;
    for (std::size_t c = 0; c < mean.size(); ++c) mean[c] = 0.5 * (before[c] + after[c]);
    return constant_paint(paint, mean);
  }
  Paint out;
  out.kind = Paint::Kind::kLinear;
  out.channels = paint.channels;
  for (int c = 0; c < paint.channels; ++c) {
    const double slope = (after[c] - before[c]) / (high - low);
    out.constant[c] = before[c] + slope * (offset.constant - low);
    out.along_x[c] = slope * offset.slope.x;
    out.along_y[c] = slope * offset.slope.y;
  }
  return out;
}

ChannelValues mean_of(const std::vector<GradientStop>& stops) {
  ChannelValues mean{};
  for (std::size_t c = 0; c < mean.size(); ++c) {
    mean[c] = stops.front().offset * stops.front().value[c] +
              (1.0 - stops.back().offset) * stops.back().value[c];
    for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
      mean[c] += 0.5 * (stops[i + 1].offset - stops[i].offset) *
                 (stops[i].value[c] + stops[i + 1].value[c]);
    }
  }
  return mean;
}

}  // namespace

std::vector<GradientStrip> gradient_strips(const Outline& outline, const Paint& paint) {
  std::vector<GradientStrip> strips;
  const LinearFunction offset = offset_function(paint);
  double least = HUGE_VAL;
  double most = -HUGE_VAL;
  for (const Point2& point : outline.points()) {
    least = std::min(least, offset(point));
    most = std::max(most, offset(point));
  }
  const auto add = [&](double low, double high, const Paint& strip_paint) {
    if (high < least || low > most || !(low < high)) return;
    Outline part = clip_between(outline, offset, low, high);
    if (!part.empty()) strips.push_back({std::move(part), strip_paint});
  };
  const std::vector<GradientStop>& stops = paint.stops;
  if (paint.spread == Spread::kPad) {
    add(-HUGE_VAL, stops.front().offset, constant_paint(paint, stops.front().value));
    for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
      const double low = stops[i].offset;
      const double high = stops[i + 1].offset;
      add(low, high, linear_paint(paint, offset, low, high, stops[i].value, stops[i + 1].value));
    }
    add(stops.back().offset, HUGE_VAL, constant_paint(paint, stops.back().value));
    return strips;
  }
  // A shape with more periods takes the mean of a period.
  if (!(most - least <= kMaxPeriods)) {
    strips.push_back({outline, constant_paint(paint, mean_of(stops))});
    return strips;
  }
  // One period from 0 to 1, with stops at its ends.
  std::vector<GradientStop> period = stops;
  if (period.front().offset > 0.0) period.insert(period.begin(), {0.0, period.front().value});
  if (period.back().offset < 1.0) period.push_back({1.0, period.back().value});
  for (double number = std::floor(least); number <= most; number += 1.0) {
    const bool turned = paint.spread == Spread::kReflect && std::fmod(number, 2.0) != 0.0;
    for (std::size_t i = 0; i + 1 < period.size(); ++i) {
      const GradientStop& from = period[turned ? i + 1 : i];
      const GradientStop& to = period[turned ? i : i + 1];
      const double low = number + (turned ? 1.0 - from.offset : from.offset);
      const double high = number + (turned ? 1.0 - to.offset : to.offset);
      add(low, high, linear_paint(paint, offset, low, high, from.value, to.value));
    }
  }
  return strips;
}

}  // namespace prefilter
