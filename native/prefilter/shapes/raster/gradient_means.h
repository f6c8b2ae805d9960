// SPDX-License-Identifier: GPL-3.0-or-later

// The mean of a gradient between two circles over a part of a pixel, however fine its stops are.
#pragma once

#include <vector>

#include "prefilter/shapes/paint.h"

namespace prefilter {

/// Over a parallelogram along which the offset is linear, the mean of the values is exact: a
/// difference of their second integral. It takes as long for a thousand periods as for one.
class GradientMeans {
 public:
  /// The paint, of kind kRadialStops, must outlive it.
  explicit GradientMeans(const Paint& paint);
  explicit GradientMeans(Paint&&) = delete;

  /// The mean over a parallelogram with these sides around a point. It should be so small that
  /// circles are nearly straight in it.
  ChannelValues over(const Point2& center, const Point2& side, const Point2& other_side) const;
  /// The mean over a pixel around a point, in as many parts as the bend of circles needs.
  ChannelValues over_pixel(const Point2& center) const;

 private:
  // From an offset on the value is linear.
  struct Stretch {
    double begin = 0.0;
    ChannelValues value{};
    ChannelValues slope{};
    // The first and second integrals of the value, less `mean_`, at `begin`.
    ChannelValues first{};
    ChannelValues second{};
  };
  // The offset in a parallelogram, as a linear function.
  struct Offsets {
    bool is_known = true;  // not outside of a cone
    bool is_far = false;   // so that it tells no part of a period
    double middle = 0.0;
    double along = 0.0;  // what it grows by along the sides
    double across = 0.0;
    double bend = 0.0;  // the larger of its second differences over half a side
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
  double period_ = 0.0;         // 0 for none
  double stop_distance_ = 1.0;  // on average
  std::vector<Stretch> stretches_;
  ChannelValues mean_{};  // of a period
};

}  // namespace prefilter
