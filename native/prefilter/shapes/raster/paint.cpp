// SPDX-License-Identifier: GPL-3.0-or-later

// Gradients as in SVG 1.1, chapter 13, and the HTML canvas's two-circle radial gradient.
#include "prefilter/shapes/paint.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace prefilter {
namespace {

// Offset of a point in a gradient between two circles: the largest offset whose circle passes
// through the point and has a radius of at least 0. None outside the cone.
std::optional<double> radial_offset(const Paint& paint, const Point2& p) {
  const Point2 axis = paint.end - paint.start;
  const Point2 to_point = p - paint.start;
  const double growth = paint.end_radius - paint.start_radius;
  // Solves |to_point - s axis| = start_radius + s growth.
  const double a = dot(axis, axis) - growth * growth;
  const double b = dot(to_point, axis) + paint.start_radius * growth;
  const double c = dot(to_point, to_point) - paint.start_radius * paint.start_radius;
  const auto is_allowed = [&](double s) { return paint.start_radius + s * growth >= 0.0; };
  if (std::abs(a) <= 1e-12 * growth * growth) {
    const double s = c / (2.0 * b);
    return std::isfinite(s) && is_allowed(s) ? std::optional(s) : std::nullopt;
  }
  const double discriminant = b * b - a * c;
  if (!(discriminant >= 0.0)) return std::nullopt;
  const double root = std::sqrt(discriminant);
  // Avoids cancellation: one root is q / a, the other follows from their product c / a.
  const double q = b + std::copysign(root, b);
  const double first = q / a;
  const double second = q == 0.0 ? first : c / q;
  const double high = std::max(first, second);
  const double low = std::min(first, second);
  if (is_allowed(high)) return high;
  return is_allowed(low) ? std::optional(low) : std::nullopt;
}

double spread_offset(Spread spread, double offset) {
  if (spread == Spread::kPad) return std::clamp(offset, 0.0, 1.0);
  if (!(std::abs(offset) < 1e15)) return 1.0;
  if (spread == Spread::kRepeat) return offset - std::floor(offset);
  const double twice = offset - 2.0 * std::floor(0.5 * offset);
  return twice > 1.0 ? 2.0 - twice : twice;
}

ChannelValues value_of_stops(const std::vector<GradientStop>& stops, double offset) {
  const auto after =
      std::upper_bound(stops.begin(), stops.end(), offset,
                       [](double value, const GradientStop& stop) { return value < stop.offset; });
  if (after == stops.begin()) return stops.front().value;
  if (after == stops.end()) return stops.back().value;
  const GradientStop& before = *(after - 1);
  const double share = (offset - before.offset) / (after->offset - before.offset);
  ChannelValues value;
  for (std::size_t c = 0; c < value.size(); ++c) {
    value[c] = before.value[c] + share * (after->value[c] - before.value[c]);
  }
  return value;
}

}  // namespace

std::optional<double> Paint::offset_at(const Point2& point) const {
  const Point2 from_origin = point - to_shape.origin;
  const double determinant = cross(to_shape.x_axis, to_shape.y_axis);
  const Point2 p{cross(from_origin, to_shape.y_axis) / determinant,
                 cross(to_shape.x_axis, from_origin) / determinant};
  if (kind == Kind::kRadialStops) return radial_offset(*this, p);
  const Point2 axis = end - start;
  return dot(p - start, axis) / dot(axis, axis);
}

ChannelValues Paint::at(const Point2& point) const {
  if (kind == Kind::kConstant || kind == Kind::kLinear) {
    ChannelValues value;
    for (std::size_t c = 0; c < value.size(); ++c) {
      value[c] = constant[c] + point.x * along_x[c] + point.y * along_y[c];
    }
    return value;
  }
  const std::optional<double> offset = offset_at(point);
  if (offset) return value_of_stops(stops, spread_offset(spread, *offset));
  return channels == kMaxChannels ? ChannelValues{} : stops.back().value;
}

Paint Paint::transformed(const AffineMap2& map) const {
  Paint moved = *this;
  moved.to_shape = {map.linear(to_shape.x_axis), map.linear(to_shape.y_axis), map(to_shape.origin)};
  // The new paint at map(p) has the value of the old paint at p.
  const double determinant = cross(map.x_axis, map.y_axis);
  for (int c = 0; c < channels; ++c) {
    const double by_x = (map.y_axis.y * along_x[c] - map.x_axis.y * along_y[c]) / determinant;
    const double by_y = (map.x_axis.x * along_y[c] - map.y_axis.x * along_x[c]) / determinant;
    moved.along_x[c] = by_x;
    moved.along_y[c] = by_y;
    moved.constant[c] = constant[c] - by_x * map.origin.x - by_y * map.origin.y;
  }
  return moved;
}

}  // namespace prefilter
