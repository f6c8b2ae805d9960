// SPDX-License-Identifier: GPL-3.0-or-later

// Mean of a radial gradient over a part of a pixel, independent of how fine its stops are.
#pragma once

#include <vector>

#include "prefilter/shapes/paint.h"

namespace prefilter {

/// The mean over a parallelogram in which the offset is linear is exact: a difference of second
/// integrals. A thousand periods take as long as one.
class GradientMeans {
 public:
  /// The paint, of kind kRadialStops, must outlive this object.
  explicit GradientMeans(const Paint& paint);
  explicit GradientMeans(Paint&&) = delete;

  /// Mean over a parallelogram with these sides around a point. It should be so small that circles
  /// are almost straight in it.
  ChannelValues mean_over(const Point2& center, const Point2& side, const Point2& other_side) const;
  /// Mean over the pixel around a point, split into as many parts as the curvature of circles
  /// requires.
  ChannelValues mean_over_pixel(const Point2& center) const;

 private:
  // The value is linear from `begin` to the next stretch.
  struct Stretch {
    double begin = 0.0;
    ChannelValues value{};
    ChannelValues slope{};
    // First and second integrals of the value minus `mean_`, at `begin`.
    ChannelValues first{};
    ChannelValues second{};
  };
  // The offset in a parallelogram, as a linear function.
  struct Offsets {
    bool is_known = true;  // false outside the cone
    bool is_far = false;   // too large to determine the position within a period
    double middle = 0.0;
    double along = 0.0;  // increase along each side
    double across = 0.0;
    double bend = 0.0;  // the larger of the second differences over half a side
  };

  void add_stops(bool turned, double begin);
  void add_stretch(double begin, double end, const ChannelValues& from, const ChannelValues& to);
  void integrate();
  Offsets offsets_in(const Point2& center, const Point2& side, const Point2& other_side) const;
  ChannelValues mean_of(const Offsets& offsets) const;
  ChannelValues mean_between(double low, double high) const;
  double reduced(double offset) const;
  bool is_linear_around(double offset, double half, const Stretch& stretch) const;
  const Stretch& stretch_at(double offset) const;
  void add_first(double offset, double factor, ChannelValues* sum) const;
  void add_second(double offset, double factor, ChannelValues* sum) const;

  const Paint& paint_;
  double period_ = 0.0;         // 0 if not periodic
  double stop_distance_ = 1.0;  // on average
  std::vector<Stretch> stretches_;
  ChannelValues mean_{};  // over a period
};

}  // namespace prefilter
