// SPDX-License-Identifier: GPL-3.0-or-later

// With q the place before `to_shape`, from the center, the radius r = |q| has the slope q / r, and
// the second derivatives (I - q q^T / r^2) / r.
#include "prefilter/raster/round_gradient.h"

#include <algorithm>
#include <cmath>

namespace prefilter {
namespace {

// The center is so many cells away at least: what the fourth derivatives of the radius add to its
// mean, 0.002 over its cube in cells, is then below 2e-5 of a cell.
constexpr double kFarCells = 5.0;
// From a cell's center to the farthest of the places where colors that are not smooth are told.
constexpr double kFarthestNode = 0.54772255750516607;

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
  round.margin_ = kFarthestNode * round.size_ * std::abs(round.per_radius_);
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
  Stretch stretch{low, high, before, {}};
  for (int c = 0; c < channels_ && !(before == after); ++c) {
    stretch.slope[c] = (after[c] - before[c]) / (high - low);
    stretch.constant[c] = before[c] - low * stretch.slope[c];
  }
  stretches_.push_back(stretch);
}

const RoundGradient::Stretch* RoundGradient::find(double radius) const {
  if (!(radius >= kFarCells * size_)) return nullptr;
  const double offset = (radius - start_radius_) * per_radius_;
  for (const Stretch& stretch : stretches_) {
    if (offset - margin_ >= stretch.low && offset + margin_ <= stretch.high) return &stretch;
  }
  return nullptr;
}

ChannelValues RoundGradient::at(const Point2& point) const {
  const Point2 q = place_of(point);
  const double offset = (std::sqrt(dot(q, q)) - start_radius_) * per_radius_;
  const auto stretch = std::find_if(stretches_.begin(), stretches_.end() - 1,
                                    [&](const Stretch& each) { return offset < each.high; });
  if (stretch->slope == ChannelValues{}) return stretch->constant;
  ChannelValues value;
  for (std::size_t c = 0; c < value.size(); ++c) {
    value[c] = stretch->constant[c] + offset * stretch->slope[c];
  }
  return value;
}

bool RoundGradient::powers(const Point2& center, std::array<ColorPowers, kMaxChannels>* out) const {
  const Point2 q = place_of(center);
  const double radius = std::sqrt(dot(q, q));
  const Stretch* stretch = find(radius);
  if (stretch == nullptr) return false;
  const double to_x = side_ * dot(q, along_x_) / radius;
  const double to_y = side_ * dot(q, along_y_) / radius;
  const double area = side_ * side_;
  const ColorPowers offset = {
      (radius - start_radius_) * per_radius_,
      to_x * per_radius_,
      to_y * per_radius_,
      0.5 * (area * dot(along_x_, along_x_) - to_x * to_x) / radius * per_radius_,
      (area * dot(along_x_, along_y_) - to_x * to_y) / radius * per_radius_,
      0.5 * (area * dot(along_y_, along_y_) - to_y * to_y) / radius * per_radius_,
  };
  for (int c = 0; c < channels_; ++c) {
    for (std::size_t k = 0; k < offset.size(); ++k) (*out)[c][k] = stretch->slope[c] * offset[k];
    (*out)[c][0] += stretch->constant[c];
  }
  return true;
}

// From one stretch to the next, without a jump, the color is that of the first one, and of what
// offsets are above the stop the difference of the slopes.
bool RoundGradient::node_powers(const Point2& center,
                                std::array<ColorPowers, kMaxChannels>* out) const {
  std::array<double, kColorNodes> offsets;
  for (std::size_t i = 0; i < kColorNodes; ++i) {
    const Point2 q = place_of(center + side_ * color_node(i));
    offsets[i] = (std::sqrt(dot(q, q)) - start_radius_) * per_radius_;
  }
  const auto [low, high] = std::minmax_element(offsets.begin(), offsets.end());
  if (!std::isfinite(*high)) return false;
  const auto first = std::find_if(stretches_.begin(), stretches_.end() - 1,
                                  [&](const Stretch& each) { return *low < each.high; });
  const auto next = first + 1;
  const double stop = first->high;
  const bool is_bent = *high > stop;
  if (is_bent) {
    if (*high > next->high) return false;
    for (int c = 0; c < channels_; ++c) {
      const double before = first->constant[c] + stop * first->slope[c];
      const double after = next->constant[c] + stop * next->slope[c];
      if (!(std::abs(after - before) <= 1e-12)) return false;
    }
  }
  const ColorPowers powers = powers_of_nodes(offsets);
  ColorPowers above{};
  if (is_bent) {
    for (double& offset : offsets) offset = std::max(offset - stop, 0.0);
    above = powers_of_nodes(offsets);
  }
  for (int c = 0; c < channels_; ++c) {
    const double bend = is_bent ? next->slope[c] - first->slope[c] : 0.0;
    for (std::size_t k = 0; k < powers.size(); ++k) {
      (*out)[c][k] = first->slope[c] * powers[k] + bend * above[k];
    }
    (*out)[c][0] += first->constant[c];
  }
  return true;
}

template <int C>
int RoundGradient::add_channels(const Point2& center, int count, double share, double* out) const {
  // The mean over a cell of what is quadratic: at its center, and a 24th of the second derivatives.
  const Point2 step = side_ * along_x_;
  const Point2 across = side_ * along_y_;
  const double squares = dot(step, step) + dot(across, across);
  const Point2 first = place_of(center);
  const Stretch* stretch = nullptr;
  ChannelValues constant{};
  ChannelValues slope{};
  const double near = kFarCells * size_;
  for (int i = 0; i < count; ++i) {
    const Point2 q = first + static_cast<double>(i) * step;
    const double radius = std::sqrt(dot(q, q));
    const double offset = (radius - start_radius_) * per_radius_;
    if (stretch == nullptr || offset - margin_ < stretch->low || offset + margin_ > stretch->high) {
      stretch = find(radius);
      if (stretch == nullptr) return i;
      for (int c = 0; c < C; ++c) {
        constant[c] = share * stretch->constant[c];
        slope[c] = share * stretch->slope[c];
      }
    }
    if (!(radius >= near)) return i;
    const double inverse = 1.0 / radius;
    const double to_x = dot(q, step) * inverse;
    const double to_y = dot(q, across) * inverse;
    const double bend = (squares - to_x * to_x - to_y * to_y) * inverse;
    const double mean = offset + bend * (per_radius_ / 24.0);
    for (int c = 0; c < C; ++c) out[i * C + c] += constant[c] + mean * slope[c];
  }
  return count;
}

int RoundGradient::add_means(const Point2& center, int count, double share, double* out) const {
  switch (channels_) {
    case 1:
      return add_channels<1>(center, count, share, out);
    case 2:
      return add_channels<2>(center, count, share, out);
    case 3:
      return add_channels<3>(center, count, share, out);
    default:
      return add_channels<4>(center, count, share, out);
  }
}

}  // namespace prefilter
