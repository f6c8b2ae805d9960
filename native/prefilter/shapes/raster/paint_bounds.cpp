// SPDX-License-Identifier: GPL-3.0-or-later

// Bounds from the slope of the offset, which is largest along the line through both centers.
#include "prefilter/shapes/raster/paint_bounds.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace prefilter {
namespace {

constexpr int kPaintBoundsAlpha = kMaxChannels - 1;

}  // namespace

bool is_cone(const Paint& paint) {
  if (paint.kind != Paint::Kind::kRadialStops) return false;
  const Point2 axis = paint.end - paint.start;
  const double growth = paint.end_radius - paint.start_radius;
  return dot(axis, axis) >= growth * growth;
}

// Along a ray from the apex of the circles, the radius grows by at least |growth| - |axis| per unit
// of the offset.
double offset_per_pixel(const Paint& paint) {
  const Point2 axis = paint.end - paint.start;
  const AffineMap2& map = paint.to_shape;
  const double determinant = cross(map.x_axis, map.y_axis);
  const Point2 along_x{map.y_axis.y / determinant, -map.x_axis.y / determinant};
  const Point2 along_y{-map.y_axis.x / determinant, map.x_axis.x / determinant};
  // The spectral norm of the linear map.
  const double squares = dot(along_x, along_x) + dot(along_y, along_y);
  const double area = cross(along_x, along_y);
  const double root = std::sqrt(std::max(squares * squares - 4.0 * area * area, 0.0));
  const double pixel = std::sqrt(0.5 * (squares + root));
  if (paint.kind == Paint::Kind::kLinearStops) return pixel / length(axis);
  if (is_cone(paint)) return HUGE_VAL;
  return pixel / (std::abs(paint.end_radius - paint.start_radius) - length(axis));
}

bool has_fine_stops(const Paint& paint) {
  // Distance in pixels at which few pixels are cut by several circles.
  constexpr double kFinePixels = 4.0;
  // Near the sides of a cone, circles become arbitrarily dense.
  constexpr std::size_t kMaxConeStops = 16;
  if (paint.kind != Paint::Kind::kRadialStops) return false;
  const bool repeats = paint.spread != Spread::kPad;
  if (is_cone(paint)) return repeats || paint.stops.size() > kMaxConeStops;
  const double pixels = kFinePixels * offset_per_pixel(paint);
  if (repeats && pixels >= 1.0) return true;
  // Whether three stops, including those of the next period, are within this distance.
  std::vector<double> offsets;
  for (const GradientStop& stop : paint.stops) {
    if (offsets.empty() || offsets.back() < stop.offset) offsets.push_back(stop.offset);
  }
  if (repeats) {
    if (offsets.front() > 0.0) offsets.insert(offsets.begin(), 0.0);
    if (offsets.back() < 1.0) offsets.push_back(1.0);
    offsets.push_back(1.0 + offsets[1]);
  }
  for (std::size_t i = 0; i + 2 < offsets.size(); ++i) {
    if (offsets[i + 2] - offsets[i] < pixels) return true;
  }
  return false;
}

bool has_jumps(const Paint& paint) {
  const auto& stops = paint.stops;
  for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
    if (!(stops[i].offset < stops[i + 1].offset) && stops[i].value != stops[i + 1].value) {
      return true;
    }
  }
  return paint.spread == Spread::kRepeat && stops.front().value != stops.back().value;
}

double max_transmittance(const Paint& paint, int channels) {
  if (channels < kMaxChannels) return 0.0;
  if (is_cone(paint)) return 1.0;
  double least = 1.0;
  switch (paint.kind) {
    case Paint::Kind::kConstant:
      least = paint.constant[kPaintBoundsAlpha];
      break;
    case Paint::Kind::kLinear:
      least = paint.along_x[kPaintBoundsAlpha] == 0.0 && paint.along_y[kPaintBoundsAlpha] == 0.0
                  ? paint.constant[kPaintBoundsAlpha]
                  : 0.0;
      break;
    default:
      for (const GradientStop& stop : paint.stops) {
        least = std::min(least, stop.value[kPaintBoundsAlpha]);
      }
      break;
  }
  return 1.0 - std::clamp(least, 0.0, 1.0);
}

PaintVariation variation_per_pixel(const Paint& paint) {
  PaintVariation variation;
  const auto include = [&](int channel, double change) {
    variation.value = std::max(variation.value, change);
    if (channel == kPaintBoundsAlpha) variation.alpha = change;
  };
  if (paint.kind == Paint::Kind::kConstant || paint.kind == Paint::Kind::kLinear) {
    for (int c = 0; c < paint.channels; ++c) {
      include(c, std::abs(paint.along_x[c]) + std::abs(paint.along_y[c]));
    }
    return variation;
  }
  const double per_pixel = offset_per_pixel(paint);
  for (int c = 0; c < paint.channels; ++c) {
    double steepest = 0.0;
    for (std::size_t i = 0; i + 1 < paint.stops.size(); ++i) {
      const double step = paint.stops[i + 1].offset - paint.stops[i].offset;
      const double change = std::abs(paint.stops[i + 1].value[c] - paint.stops[i].value[c]);
      if (step > 0.0 && change > 0.0) {
        // The diagonal of a pixel is shorter than twice its side.
        steepest = std::max(steepest, std::min(2.0 * change / step * per_pixel, change));
      }
    }
    include(c, steepest);
  }
  if (is_cone(paint) && paint.channels == kMaxChannels) {
    variation = {std::max(variation.value, 1.0), 1.0};
  }
  return variation;
}

}  // namespace prefilter
