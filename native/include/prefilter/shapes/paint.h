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

/// What a gradient does before its first stop and behind its last.
enum class Spread : std::uint8_t { kPad, kRepeat, kReflect };

inline constexpr Named<Spread> kSpreads[] = {
    {"pad", Spread::kPad}, {"repeat", Spread::kRepeat}, {"reflect", Spread::kReflect}};

/// The value at one place of a gradient; between stops it is linear.
struct GradientStop {
  double offset = 0.0;  // in [0, 1], none below the one before it
  ChannelValues value{};
};

/// The values over a shape: constant, linear, or along a line or a radius by stops.
struct Paint {
  enum class Kind : std::uint8_t { kConstant, kLinear, kLinearStops, kRadialStops };

  Kind kind = Kind::kConstant;
  int channels = 1;
  /// kConstant and kLinear: at (x, y) it is constant + x * along_x + y * along_y.
  ChannelValues constant{1.0, 1.0, 1.0, 1.0};
  ChannelValues along_x{};
  ChannelValues along_y{};

  /// kLinearStops: offset 0 is at `start`, 1 at `end`. kRadialStops: 0 is on the circle of
  /// start_radius around `start`, 1 on that of end_radius around `end`. Both before `to_shape`.
  std::vector<GradientStop> stops;
  Spread spread = Spread::kPad;
  Point2 start;
  Point2 end;
  double start_radius = 0.0;
  double end_radius = 0.0;
  AffineMap2 to_shape;

  /// The offset at a point of the shape of a paint with stops, before `spread`; nothing outside of
  /// the cone of circles.
  std::optional<double> offset_at(const Point2& point) const;

  /// The value at a point of the shape.
  ChannelValues at(const Point2& point) const;

  /// For a shape that is moved by a map, of rank 2.
  Paint transformed(const AffineMap2& map) const;
};

}  // namespace prefilter
