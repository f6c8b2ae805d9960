// SPDX-License-Identifier: GPL-3.0-or-later

// Let q be the position before `to_shape`, relative to the center. The radius r = |q| has the
// gradient q / r and the second derivatives (I - q q^T / r^2) / r.
#include "prefilter/shapes/raster/round_gradient.h"

#include <algorithm>
#include <cmath>

#include "prefilter/base/double_pair.h"
#include "prefilter/shapes/raster/channel_count.h"

namespace prefilter {
namespace {

// Least distance from the center in cells. The fourth derivatives of the radius change its mean by
// 0.002 over the cube of the distance, which is then below 2e-5 of a cell.
constexpr double kMinCenterDistance = 5.0;
// Distance from a cell's center to the corner nodes of the 3 x 3 Gauss rule, sqrt(0.3).
constexpr double kMaxNodeDistance = 0.54772255750516607;

}  // namespace

std::optional<RoundGradient> RoundGradient::of(const Paint& paint, double side) {
  const double growth = paint.end_radius - paint.start_radius;
  if (paint.kind != Paint::Kind::kRadialStops || paint.spread != Spread::kPad ||
      !(paint.start == paint.end) || growth == 0.0) {
    return std::nullopt;
  }
  RoundGradient round;
  const AffineMap2& map = paint.to_shape;
  const double determinant = cross(map.x_axis, map.y_axis);
  round.channels_ = paint.channels;
  round.side_ = side;
  round.start_radius_ = paint.start_radius;
  round.per_radius_ = 1.0 / growth;
  round.along_x_ = {map.y_axis.y / determinant, -map.x_axis.y / determinant};
  round.along_y_ = {-map.y_axis.x / determinant, map.x_axis.x / determinant};
  round.origin_ = Point2{} - map.origin.x * round.along_x_ - map.origin.y * round.along_y_;
  round.origin_ = round.origin_ - paint.start;
  round.size_ =
      side * std::sqrt(dot(round.along_x_, round.along_x_) + dot(round.along_y_, round.along_y_));
  if (!std::isfinite(round.size_ * round.per_radius_)) return std::nullopt;
  round.margin_ = kMaxNodeDistance * round.size_ * std::abs(round.per_radius_);
  const auto& stops = paint.stops;
  round.add_stretch(-HUGE_VAL, stops.front().offset, stops.front().value, stops.front().value);
  for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
    round.add_stretch(stops[i].offset, stops[i + 1].offset, stops[i].value, stops[i + 1].value);
  }
  round.add_stretch(stops.back().offset, HUGE_VAL, stops.back().value, stops.back().value);
  return round;
}

void RoundGradient::add_stretch(double low, double high, const ChannelValues& before,
                                const ChannelValues& after) {
  if (!(low < high)) return;
  Stretch stretch{low, high, before, {}, before == after};
  for (int c = 0; c < channels_ && !stretch.is_constant; ++c) {
    stretch.slope[c] = (after[c] - before[c]) / (high - low);
    stretch.constant[c] = before[c] - low * stretch.slope[c];
  }
  stretches_.push_back(stretch);
}

const RoundGradient::Stretch* RoundGradient::find(double radius) const {
  if (!(radius >= kMinCenterDistance * size_)) return nullptr;
  const double offset = (radius - start_radius_) * per_radius_;
  for (const Stretch& stretch : stretches_) {
    if (offset - margin_ >= stretch.low && offset + margin_ <= stretch.high) return &stretch;
  }
  return nullptr;
}

ChannelValues RoundGradient::at(const Point2& point) const {
  const Point2 q = position_of(point);
  const double offset = (std::sqrt(dot(q, q)) - start_radius_) * per_radius_;
  const auto stretch = std::find_if(stretches_.begin(), stretches_.end() - 1,
                                    [&](const Stretch& each) { return offset < each.high; });
  if (stretch->is_constant) return stretch->constant;
  ChannelValues value;
  for (std::size_t c = 0; c < value.size(); ++c) {
    value[c] = stretch->constant[c] + offset * stretch->slope[c];
  }
  return value;
}

// The mean over a cell of a quadratic function is its value at the center plus 1/24 of the sum of
// its second derivatives. Computes two cells at once; the second may be past the last.
template <int C>
int RoundGradient::add_channels(const Point2& center, int count, double share, double* out) const {
  const Point2 step = side_ * along_x_;
  const Point2 across = side_ * along_y_;
  const double squares = dot(step, step) + dot(across, across);
  const Point2 first = position_of(center);
  ChannelPairs<C> constant{};
  ChannelPairs<C> slope{};
  const double near = kMinCenterDistance * size_;
  // Local copies, which `out` cannot alias.
  const double start_radius = start_radius_;
  const double per_radius = per_radius_;
  const double per_bend = per_radius_ / 24.0;
  double low = HUGE_VAL;  // range of offsets in the stretch
  double high = -HUGE_VAL;
  const auto add = [&](int i, double mean) {
    add_pairs<C>([&](std::size_t pair) { return constant[pair] + mean * slope[pair]; },
                 out + static_cast<std::ptrdiff_t>(i) * C);
  };
  for (int i = 0; i < count;) {
    const DoublePair place = DoublePair{0.0, 1.0} + static_cast<double>(i);
    const DoublePair x = first.x + place * step.x;
    const DoublePair y = first.y + place * step.y;
    const DoublePair radius = sqrt(x * x + y * y);
    const DoublePair offset = (radius - start_radius) * per_radius;
    // Not negative where the current stretch applies.
    DoublePair inside = lower(lower(offset - low, high - offset), radius - near);
    if (!(inside[0] >= 0.0)) {
      const Stretch* stretch = find(radius[0]);
      if (stretch == nullptr) return i;
      low = stretch->low + margin_;
      high = stretch->high - margin_;
      inside = lower(lower(offset - low, high - offset), radius - near);
      constant = channel_pairs<C>(stretch->constant);
      slope = channel_pairs<C>(stretch->slope);
      for (DoublePair& pair : constant) pair *= share;
      for (DoublePair& pair : slope) pair *= share;
    }
    const DoublePair inverse = 1.0 / radius;
    const DoublePair to_x = (x * step.x + y * step.y) * inverse;
    const DoublePair to_y = (x * across.x + y * across.y) * inverse;
    const DoublePair bend = (squares - to_x * to_x - to_y * to_y) * inverse;
    const DoublePair mean = offset + bend * per_bend;
    add(i++, mean[0]);
    if (i < count && inside[1] >= 0.0) add(i++, mean[1]);
  }
  return count;
}

int RoundGradient::add_means(const Point2& center, int count, double share, double* out) const {
  return with_channel_count(channels_, [&](auto channels) {
    return add_channels<channels()>(center, count, share, out);
  });
}

}  // namespace prefilter
