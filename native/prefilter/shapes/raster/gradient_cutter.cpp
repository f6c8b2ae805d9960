// SPDX-License-Identifier: GPL-3.0-or-later

// In the coordinates before `to_shape`, the points with offset s are on the circle around start + s
// axis with the radius start_radius + s growth.
#include "prefilter/shapes/raster/gradient_cutter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "prefilter/shapes/raster/edge_list.h"
#include "prefilter/shapes/raster/paint_bounds.h"

namespace prefilter {
namespace {

// Largest change of slope over a pixel at which a kink may be ignored: the error of Gaussian
// quadrature is then within 0.3 and 1.2 of 1/255. The second bound applies where means over whole
// pixels are exact, so that only pixels with outlines are affected.
constexpr double kMaxIgnoredKink = 1.0 / 16.0;
constexpr double kMaxIgnoredKinkAtOutlines = 1.0 / 4.0;

// A circle around a box, in the coordinates before `to_shape`.
struct Disc {
  Point2 center;
  double radius = 0.0;
};

Disc disc_around(const Box2& box, const AffineMap2& map) {
  const double determinant = cross(map.x_axis, map.y_axis);
  const auto before = [&](const Point2& point) -> Point2 {
    const Point2 off = point - map.origin;
    return {cross(off, map.y_axis) / determinant, cross(map.x_axis, off) / determinant};
  };
  Disc disc;
  disc.center = before({0.5 * (box.low.x + box.high.x), 0.5 * (box.low.y + box.high.y)});
  for (const Point2& corner :
       {box.low, Point2{box.high.x, box.low.y}, box.high, Point2{box.low.x, box.high.y}}) {
    disc.radius = std::max(disc.radius, length(before(corner) - disc.center));
  }
  return disc;
}

class CutterBuilder {
 public:
  CutterBuilder(const Paint& paint, const Disc& disc)
      : paint_(paint),
        disc_(disc),
        axis_(paint.end - paint.start),
        growth_(paint.end_radius - paint.start_radius) {}

  Outline build() {
    if (!has_fine_stops(paint_)) add_circles();
    if (is_cone(paint_)) add_cone();
    return std::move(outline_);
  }

 private:
  // The largest magnitude of an offset whose circle can meet the disc.
  double farthest_offset() const {
    const double reach =
        disc_.radius + length(paint_.start - disc_.center) + std::abs(paint_.start_radius);
    return reach / std::abs(std::abs(growth_) - length(axis_));
  }

  void add_circles() {
    find_kinks();
    if (paint_.spread == Spread::kPad) {
      for (const double kink : kinks_) add_circle(kink);
    } else {
      add_periods();
    }
  }

  // Collects the offsets in [0, 1] at which the color jumps or its slope does.
  void find_kinks() {
    // An interval of offsets with linear color.
    struct Stretch {
      double end = 0.0;
      ChannelValues slope{};
      ChannelValues first{};
      ChannelValues last{};
    };
    const auto& stops = paint_.stops;
    std::vector<Stretch> stretches = {{stops.front().offset, {}, stops[0].value, stops[0].value}};
    for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
      const double width = stops[i + 1].offset - stops[i].offset;
      if (!(width > 0.0)) continue;
      Stretch stretch{stops[i + 1].offset, {}, stops[i].value, stops[i + 1].value};
      for (int c = 0; c < paint_.channels; ++c) {
        stretch.slope[c] = (stretch.last[c] - stretch.first[c]) / width;
      }
      stretches.push_back(stretch);
    }
    stretches.push_back({1.0, {}, stops.back().value, stops.back().value});
    const double per_pixel = offset_per_pixel(paint_);
    const double small_kink = has_jumps(paint_) ? kMaxIgnoredKink : kMaxIgnoredKinkAtOutlines;
    const auto add = [&](const Stretch& before, const Stretch& after) {
      for (int c = 0; c < paint_.channels; ++c) {
        const double slope = after.slope[c] - before.slope[c];
        if (std::abs(before.last[c] - after.first[c]) > 0.0 ||
            std::abs(slope) * per_pixel > small_kink) {
          kinks_.push_back(before.end);
          return;
        }
      }
    };
    for (std::size_t i = 0; i + 1 < stretches.size(); ++i) {
      add(stretches[i], stretches[i + 1]);
    }
    if (paint_.spread == Spread::kPad) return;
    // Adjacent periods share a circle at their common offset, which add_periods() adds.
    std::erase_if(kinks_, [](double kink) { return !(kink > 0.0 && kink < 1.0); });
  }

  void add_periods() {
    const double most = std::min(std::ceil(farthest_offset()), kMaxPeriods);
    for (double period = -most; period <= most; period += 1.0) {
      add_circle(period);
      const bool turned = paint_.spread == Spread::kReflect && std::fmod(period, 2.0) != 0.0;
      for (const double kink : kinks_) add_circle(period + (turned ? 1.0 - kink : kink));
    }
  }

  void add_circle(double offset) {
    const Point2 center = paint_.start + offset * axis_;
    const double radius = paint_.start_radius + offset * growth_;
    if (!(radius > 0.0)) return;
    if (std::abs(length(center - disc_.center) - radius) > disc_.radius) return;
    if (offset == last_offset_) return;
    last_offset_ = offset;
    const std::array<Point2, 8> around = {{{1.0, 0.0},
                                           {1.0, 1.0},
                                           {0.0, 1.0},
                                           {-1.0, 1.0},
                                           {-1.0, 0.0},
                                           {-1.0, -1.0},
                                           {0.0, -1.0},
                                           {1.0, -1.0}}};
    std::array<Point2, 8> points;
    for (std::size_t i = 0; i < points.size(); ++i) {
      points[i] = paint_.to_shape(center + radius * around[i]);
      if (!is_near(points[i])) return;
    }
    outline_.move_to(points[0]);
    for (std::size_t i = 1; i < points.size(); i += 2) {
      outline_.conic_to(points[i], 1.0 / std::numbers::sqrt2, points[(i + 1) % points.size()]);
    }
    outline_.close();
  }

  // Adds the sides of the cone from its apex; they are parallel if the radii are equal.
  void add_cone() {
    const double along = length(axis_);
    const Point2 unit = (1.0 / along) * axis_;
    const Point2 across{-unit.y, unit.x};
    const double sine = growth_ / along;
    const double cosine = std::sqrt(std::max(1.0 - sine * sine, 0.0));
    for (const double side : {-1.0, 1.0}) {
      // The point where the side touches the start circle, and the side's direction.
      const Point2 normal = side * cosine * across - sine * unit;
      const Point2 touched = paint_.start + paint_.start_radius * normal;
      const Point2 way = cosine * unit + side * sine * across;
      const double reach = 2.0 * (disc_.radius + length(touched - disc_.center));
      const Point2 begin = paint_.to_shape(touched - reach * way);
      const Point2 end = paint_.to_shape(touched + reach * way);
      if (!is_near(begin) || !is_near(end)) continue;
      outline_.move_to(begin);
      outline_.line_to(end);
      outline_.close();
    }
  }

  static bool is_near(const Point2& point) {
    return std::abs(point.x) <= kMaxPixelCoordinate && std::abs(point.y) <= kMaxPixelCoordinate;
  }

  const Paint& paint_;
  Disc disc_;
  Point2 axis_;
  double growth_;
  double last_offset_ = HUGE_VAL;
  std::vector<double> kinks_;
  Outline outline_;
};

}  // namespace

Outline gradient_cutter(const Paint& paint, const Box2& box) {
  if (paint.kind != Paint::Kind::kRadialStops || box.empty()) return {};
  return CutterBuilder(paint, disc_around(box, paint.to_shape)).build();
}

}  // namespace prefilter
