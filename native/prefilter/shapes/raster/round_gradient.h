// SPDX-License-Identifier: GPL-3.0-or-later

// Gradients between two circles around one center, on cells.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "prefilter/shapes/paint.h"

namespace prefilter {

/// The color on a cell that is far from the center and within one stretch between stops: there it
/// is linear in the radius, which is told by its slopes and curvature at the cell's center.
class RoundGradient {
 public:
  /// Of a paint that is such a gradient, and goes on as it ends, for cells of a side in pixels;
  /// else nothing.
  static std::optional<RoundGradient> of(const Paint& paint, double side);

  /// The value at a point in pixels.
  ChannelValues at(const Point2& point) const;
  /// Adds the means over cells along a row, the first one around a point, times a share to `out`,
  /// for as long as the color is that smooth; returns over how many of `count`.
  int add_means(const Point2& center, int count, double share, double* out) const;

 private:
  // Between two offsets the value is constant + offset * slope; cells whose centers are not within
  // `margin` of these are between them.
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
  Point2 place_of(const Point2& point) const {
    return origin_ + point.x * along_x_ + point.y * along_y_;
  }
  template <int C>
  int add_channels(const Point2& center, int count, double share, double* out) const;

  int channels_ = 1;
  double side_ = 1.0;
  double start_radius_ = 0.0;
  double per_radius_ = 1.0;  // offsets
  Point2 along_x_;           // what a pixel along x adds to the place before `to_shape`
  Point2 along_y_;
  Point2 origin_;      // the place of the pixel (0, 0), from the center
  double size_ = 0.0;  // a bound on how far apart a cell's opposite sides are there
  double margin_ = 0.0;
  std::vector<Stretch> stretches_;
};

}  // namespace prefilter
