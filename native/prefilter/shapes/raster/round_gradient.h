// SPDX-License-Identifier: GPL-3.0-or-later

// Radial gradients with concentric circles, evaluated on cells.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "prefilter/shapes/paint.h"

namespace prefilter {

/// Color on cells that are far from the center and between two adjacent stops. There the color is
/// linear in the radius, whose mean follows from its gradient and curvature at the cell's center.
class RoundGradient {
 public:
  /// Nothing unless the paint is such a gradient with Spread::kPad; `side` is the side of cells in
  /// pixels.
  static std::optional<RoundGradient> of(const Paint& paint, double side);

  /// Value at a point in pixels.
  ChannelValues at(const Point2& point) const;
  /// Adds `share` times the means over cells along a row to `out`, starting with the cell around
  /// `center`, while the color is smooth. Returns the number of cells added, at most `count`.
  int add_means(const Point2& center, int count, double share, double* out) const;

 private:
  // Between two offsets the value is constant + offset * slope. It holds for all of a cell whose
  // center's offset is at least `margin` inside.
  struct Stretch {
    double low = 0.0;
    double high = 0.0;
    ChannelValues constant{};
    ChannelValues slope{};
    bool is_constant = true;
  };
  void add_stretch(double low, double high, const ChannelValues& before,
                   const ChannelValues& after);
  const Stretch* find(double radius) const;
  Point2 position_of(const Point2& point) const {
    return origin_ + point.x * along_x_ + point.y * along_y_;
  }
  template <int C>
  int add_channels(const Point2& center, int count, double share, double* out) const;

  int channels_ = 1;
  double side_ = 1.0;
  double start_radius_ = 0.0;
  double per_radius_ = 1.0;  // offset per unit of the radius
  Point2 along_x_;           // change of the position before `to_shape` along a pixel in x
  Point2 along_y_;
  Point2 origin_;      // position of the pixel (0, 0), relative to the center
  double size_ = 0.0;  // bound on a cell's size before `to_shape`
  double margin_ = 0.0;
  std::vector<Stretch> stretches_;
};

}  // namespace prefilter
