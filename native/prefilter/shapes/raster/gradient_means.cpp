// SPDX-License-Identifier: GPL-3.0-or-later

// Where the offset is t + a x + b y for x and y in [-1/2, 1/2], the mean of f is
//
// (F(t + (a + b) / 2) - F(t + (a - b) / 2) - F(t - (a - b) / 2) + F(t - (a + b) / 2)) / (a b)
//
// with F'' = f. For a periodic f the mean is subtracted first, so that F is periodic and small.
#include "prefilter/shapes/raster/gradient_means.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace prefilter {
namespace {

// Beyond this offset, a double does not determine the position within a period.
constexpr double kMaxOffset = 1e12;
// Below these, differences of the second integral lose precision; a strip then takes the mean along
// its length. The first bounds the product of both slopes, the second their ratio.
constexpr double kMinSlopeProduct = 1e-9;
constexpr double kMinSlopeRatio = 1e-6;

}  // namespace

GradientMeans::GradientMeans(const Paint& paint) : paint_(paint) {
  if (paint.spread != Spread::kPad) period_ = paint.spread == Spread::kReflect ? 2.0 : 1.0;
  if (period_ == 0.0) {
    add_stretch(-1.0, paint.stops.front().offset, paint.stops.front().value,
                paint.stops.front().value);
    for (std::size_t i = 0; i + 1 < paint.stops.size(); ++i) {
      add_stretch(paint.stops[i].offset, paint.stops[i + 1].offset, paint.stops[i].value,
                  paint.stops[i + 1].value);
    }
    add_stretch(paint.stops.back().offset, 2.0, paint.stops.back().value, paint.stops.back().value);
  } else {
    add_stops(false, 0.0);
    if (period_ == 2.0) add_stops(true, 1.0);
  }
  stop_distance_ = (period_ == 2.0 ? 2.0 : 1.0) / static_cast<double>(stretches_.size());
  integrate();
}

// Adds the stops of one period that begins at `begin`.
void GradientMeans::add_stops(bool turned, double begin) {
  std::vector<GradientStop> stops = paint_.stops;
  stops.insert(stops.begin(), {0.0, stops.front().value});
  stops.push_back({1.0, stops.back().value});
  if (turned) {
    std::reverse(stops.begin(), stops.end());
    for (GradientStop& stop : stops) stop.offset = 1.0 - stop.offset;
  }
  for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
    add_stretch(begin + stops[i].offset, begin + stops[i + 1].offset, stops[i].value,
                stops[i + 1].value);
  }
}

void GradientMeans::add_stretch(double begin, double end, const ChannelValues& from,
                                const ChannelValues& to) {
  if (!(begin < end)) return;
  Stretch stretch{begin, from, {}, {}, {}};
  for (std::size_t c = 0; c < from.size(); ++c) {
    stretch.slope[c] = (to[c] - from[c]) / (end - begin);
    mean_[c] += 0.5 * (end - begin) * (from[c] + to[c]);
  }
  stretches_.push_back(stretch);
}

void GradientMeans::integrate() {
  for (double& mean : mean_) mean = period_ > 0.0 ? mean / period_ : 0.0;
  for (std::size_t c = 0; c < mean_.size(); ++c) {
    const auto add_up = [&](double constant) {
      double first = constant;
      double second = 0.0;
      for (std::size_t i = 0; i < stretches_.size(); ++i) {
        Stretch& stretch = stretches_[i];
        stretch.first[c] = first;
        stretch.second[c] = second;
        const double end =
            i + 1 < stretches_.size() ? stretches_[i + 1].begin : std::max(period_, stretch.begin);
        const double width = end - stretch.begin;
        const double value = stretch.value[c] - mean_[c];
        second += width * (first + width * (value / 2.0 + width * stretch.slope[c] / 6.0));
        first += width * (value + width * stretch.slope[c] / 2.0);
      }
      return second;
    };
    const double drift = add_up(0.0);
    if (period_ > 0.0) add_up(-drift / period_);
  }
}

double GradientMeans::reduced(double offset) const {
  return period_ > 0.0 ? offset - period_ * std::floor(offset / period_) : offset;
}

const GradientMeans::Stretch& GradientMeans::stretch_at(double offset) const {
  const auto after =
      std::upper_bound(stretches_.begin() + 1, stretches_.end(), offset,
                       [](double value, const Stretch& stretch) { return value < stretch.begin; });
  return *(after - 1);
}

void GradientMeans::add_first(double offset, double factor, ChannelValues* sum) const {
  const double place = reduced(offset);
  const Stretch& stretch = stretch_at(place);
  const double d = place - stretch.begin;
  for (std::size_t c = 0; c < sum->size(); ++c) {
    (*sum)[c] += factor * (stretch.first[c] +
                           d * (stretch.value[c] - mean_[c] + d * stretch.slope[c] / 2.0));
  }
}

void GradientMeans::add_second(double offset, double factor, ChannelValues* sum) const {
  const double place = reduced(offset);
  const Stretch& stretch = stretch_at(place);
  const double d = place - stretch.begin;
  for (std::size_t c = 0; c < sum->size(); ++c) {
    (*sum)[c] += factor * (stretch.second[c] +
                           d * (stretch.first[c] + d * ((stretch.value[c] - mean_[c]) / 2.0 +
                                                        d * stretch.slope[c] / 6.0)));
  }
}

// Whether the value is linear at offsets within `half` of a reduced one.
bool GradientMeans::is_linear_around(double offset, double half, const Stretch& stretch) const {
  const bool is_first = &stretch == &stretches_.front();
  const bool is_last = &stretch == &stretches_.back();
  const bool is_extended = period_ == 0.0;
  const double end = is_last ? period_ : (&stretch + 1)->begin;
  return ((is_first && is_extended) || offset - half >= stretch.begin) &&
         ((is_last && is_extended) || offset + half <= end);
}

ChannelValues GradientMeans::mean_between(double low, double high) const {
  ChannelValues mean = mean_;
  const double factor = 1.0 / (high - low);
  add_first(high, factor, &mean);
  add_first(low, -factor, &mean);
  return mean;
}

ChannelValues GradientMeans::mean_of(const Offsets& offsets) const {
  const double reach = 0.5 * (offsets.along + offsets.across);
  const double spread = 0.5 * (offsets.along - offsets.across);
  const double t = reduced(offsets.middle);
  const Stretch& stretch = stretch_at(t);
  if (is_linear_around(t, reach, stretch)) {
    ChannelValues value = stretch.value;
    for (std::size_t c = 0; c < value.size(); ++c)
      value[c] += (t - stretch.begin) * stretch.slope[c];
    return value;
  }
  const double slopes = offsets.along * offsets.across;
  const double wide = std::max(offsets.along, offsets.across);
  const double narrow = std::min(offsets.along, offsets.across);
  if (slopes < kMinSlopeProduct || narrow < kMinSlopeRatio * wide) {
    return mean_between(t - 0.5 * wide, t + 0.5 * wide);
  }
  const double factor = 1.0 / slopes;
  ChannelValues mean = mean_;
  add_second(t + reach, factor, &mean);
  add_second(t + spread, -factor, &mean);
  add_second(t - spread, -factor, &mean);
  add_second(t - reach, factor, &mean);
  return mean;
}

GradientMeans::Offsets GradientMeans::offsets_in(const Point2& center, const Point2& side,
                                                 const Point2& other_side) const {
  const auto at = [&](double along, double across) {
    return paint_.offset_at(center + along * side + across * other_side);
  };
  Offsets offsets;
  const std::optional<double> middle = at(0.0, 0.0);
  const std::optional<double> left = at(-0.5, 0.0);
  const std::optional<double> right = at(0.5, 0.0);
  const std::optional<double> low = at(0.0, -0.5);
  const std::optional<double> high = at(0.0, 0.5);
  if (!middle || !left || !right || !low || !high) {
    offsets.is_known = false;
    return offsets;
  }
  const double bend_along = *left + *right - 2.0 * *middle;
  const double bend_across = *low + *high - 2.0 * *middle;
  // Simpson's rule.
  offsets.middle = *middle + (bend_along + bend_across) / 6.0;
  offsets.along = std::abs(*right - *left);
  offsets.across = std::abs(*high - *low);
  offsets.bend = std::max(std::abs(bend_along), std::abs(bend_across));
  const double farthest = std::abs(*middle) + offsets.along + offsets.across + offsets.bend;
  offsets.is_known = farthest < kMaxOffset;
  offsets.is_far = !offsets.is_known;
  return offsets;
}

ChannelValues GradientMeans::mean_over(const Point2& center, const Point2& side,
                                       const Point2& other_side) const {
  const Offsets offsets = offsets_in(center, side, other_side);
  if (offsets.is_known) return mean_of(offsets);
  return offsets.is_far && period_ > 0.0 ? mean_ : paint_.at(center);
}

ChannelValues GradientMeans::mean_over_pixel(const Point2& center) const {
  // Largest deviation of the offset from a linear function, in distances between stops.
  constexpr double kMaxBend = 1.0 / 64.0;
  // The mean over more periods than this hardly depends on where they begin and end.
  constexpr double kMaxPeriodsInPixel = 32.0;
  constexpr int kMaxParts = 16;
  const Offsets whole = offsets_in(center, {1.0, 0.0}, {0.0, 1.0});
  // Pixels cut by a cone's side are handled elsewhere.
  if (!whole.is_known) return mean_over(center, {1.0, 0.0}, {0.0, 1.0});
  const double t = reduced(whole.middle);
  const bool has_many = std::max(whole.along, whole.across) > kMaxPeriodsInPixel * period_;
  int parts = 1;
  if (!(has_many && period_ > 0.0) &&
      !is_linear_around(t, whole.along + whole.across + whole.bend, stretch_at(t))) {
    while (parts < kMaxParts && whole.bend > kMaxBend * stop_distance_ * parts * parts) {
      parts *= 2;
    }
  }
  if (parts == 1) return mean_of(whole);
  ChannelValues sum{};
  const double size = 1.0 / parts;
  for (int j = 0; j < parts; ++j) {
    for (int i = 0; i < parts; ++i) {
      const Point2 middle = center + Point2{(i + 0.5) * size - 0.5, (j + 0.5) * size - 0.5};
      const ChannelValues value = mean_over(middle, {size, 0.0}, {0.0, size});
      for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += size * size * value[c];
    }
  }
  return sum;
}

}  // namespace prefilter
