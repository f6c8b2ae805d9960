// SPDX-License-Identifier: GPL-3.0-or-later

// Paints of shapes: constant values and gradients.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/names.h"
#include "prefilter/base/outline.h"

namespace prefilter {

/// A value of up to kMaxChannels channels.
using ChannelValues = std::array<double, kMaxChannels>;

/// How a gradient continues before its first and after its last stop.
enum class Spread : std::uint8_t { kPad, kRepeat, kReflect };

inline constexpr Named<Spread> kSpreads[] = {
    {"pad", Spread::kPad}, {"repeat", Spread::kRepeat}, {"reflect", Spread::kReflect}};

/// A stop of a gradient, which is linear between stops.
struct GradientStop {
  double offset = 0.0;  // in [0, 1], not decreasing
  ChannelValues value{};
};

/// Values over a shape: constant, linear, or a gradient with stops along a line or a radius.
struct Paint {
  enum class Kind : std::uint8_t { kConstant, kLinear, kLinearStops, kRadialStops };

  Kind kind = Kind::kConstant;
  int channels = 1;
  /// kConstant and kLinear: the value at (x, y) is constant + x * along_x + y * along_y.
  ChannelValues constant{1.0, 1.0, 1.0, 1.0};
  ChannelValues along_x{};
  ChannelValues along_y{};

  /// kLinearStops: offset 0 is at `start` and offset 1 at `end`. kRadialStops: offset 0 is on the
  /// circle of start_radius around `start`, offset 1 on the circle of end_radius around `end`. Both
  /// are mapped by `to_shape`.
  std::vector<GradientStop> stops;
  Spread spread = Spread::kPad;
  Point2 start;
  Point2 end;
  double start_radius = 0.0;
  double end_radius = 0.0;
  AffineMap2 to_shape;

  /// The offset of a point of the shape, before `spread` is applied, for a paint with stops;
  /// nothing outside the cone of a radial gradient.
  std::optional<double> offset_at(const Point2& point) const;

  /// The value at a point of the shape.
  ChannelValues at(const Point2& point) const;

  /// The paint of a shape transformed by a map of rank 2.
  Paint transformed(const AffineMap2& map) const;
};

}  // namespace prefilter
