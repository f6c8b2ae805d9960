// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/raster/cell_samples.h"

#include <algorithm>
#include <cmath>

#include "prefilter/outline/fill_rule.h"

namespace prefilter {
namespace {

// What is behind so much does not show.
constexpr float kLeastPassing = 1e-6F;

// Bits of a row's number, the other way round, in (0, 1).
double reversed_bits(int row, int rows) {
  double value = 0.5 / rows;
  for (int bit = 1; bit < rows; bit *= 2) {
    if ((row & bit) != 0) value += 0.5 / bit;
  }
  return value;
}

}  // namespace

CellSamples::CellSamples(const StackArcs& stack_arcs, int channels, bool keeps_places)
    : stack_arcs_(stack_arcs),
      channels_(channels),
      keeps_places_(keeps_places),
      steps_(count_of(kMostRows) + kMostRows),
      passing_(count_of(kMostRows)),
      share_(count_of(kMostRows)),
      values_(keeps_places ? channels : 0, Samples(count_of(kMostRows))) {}

void CellSamples::begin(int rows) {
  if (rows != rows_) {
    rows_ = rows;
    columns_ = rows / kRowsPerColumn;
    count_ = rows_ * columns_;
    for (int row = 0; row < rows; ++row) {
      offsets_[row] = static_cast<float>(reversed_bits(row, rows));
    }
  }
  std::fill_n(passing_.begin(), count_, 1.0F);
  for (Samples& values : values_) std::fill_n(values.begin(), count_, 0.0F);
  sums_ = {};
}

// The first row of samples at a height or above it.
int CellSamples::first_row_above(double y) const {
  return std::clamp(static_cast<int>(std::ceil((y + 0.5) * rows_ - 0.5)), 0, rows_);
}

// Along a line; samples on its right wind more often.
void CellSamples::add_winding(Point2 low, Point2 high, std::int32_t winding) {
  const int end = first_row_above(high.y);
  int row = first_row_above(low.y);
  if (row >= end) return;
  const double slope = (high.x - low.x) / (high.y - low.y);
  const auto step = static_cast<float>(slope * columns_ / rows_);
  const auto first =
      static_cast<float>((low.x + (sample_y(row) - low.y) * slope + 0.5) * columns_ + 1.0);
  // The first column with a sample to the right; the last of steps_ has none.
  for (int i = 0; row < end; ++row, ++i) {
    const float column = first + step * static_cast<float>(i) - offsets_[row];
    const auto at = static_cast<int>(std::clamp(column, 0.0F, static_cast<float>(columns_)));
    steps_[at * rows_ + row] += winding;
  }
}

void CellSamples::add_arc(const StackArc& arc) {
  if (arc.curve == StackArc::kLine) {
    add_winding(arc.low, arc.high, arc.winding);
    return;
  }
  const StackCurve& curve = stack_arcs_.curve(arc);
  const ParametricCurve& whole = stack_arcs_.piece(curve).curve;
  // A line where the middle of the arc is closer to it than a sample to the next.
  constexpr int kMostLines = 8;
  const Point2 middle = whole.at(0.5 * (curve.t_begin + curve.t_end)) - center_;
  const Point2 way = arc.high - arc.low;
  const double off = std::fabs(cross(way, middle - arc.low));
  const bool is_straight = off * 16.0 * columns_ < std::max(std::fabs(way.x), way.y);
  const int lines = is_straight ? 1 : kMostLines;
  const bool rises = whole.at(curve.t_begin).y < whole.at(curve.t_end).y;
  Point2 low = arc.low;
  for (int i = 1; i <= lines; ++i) {
    const double share = static_cast<double>(rises ? i : lines - i) / lines;
    Point2 high = arc.high;
    if (i < lines) {
      high = whole.at(curve.t_begin + share * (curve.t_end - curve.t_begin)) - center_;
      high.y = std::clamp(high.y, low.y, arc.high.y);
    }
    if (high.y > low.y) add_winding(low, high, arc.winding);
    low = high;
  }
}

// Sets steps_ to what the winding numbers of a layer are higher by than left of each sample.
void CellSamples::add_windings(const CellLayer& layer) {
  std::fill_n(steps_.begin(), count_ + rows_, 0);
  std::fill_n(steps_.begin(), rows_, layer.base);
  for (const SideStep& step : layer.steps) {
    for (int row = first_row_above(step.y); row < rows_; ++row) steps_[row] += step.winding;
  }
  for (const StackArc& arc : layer.arcs) add_arc(arc);
}

// Of where the windings fill a sample.
void CellSamples::find_share(FillRule rule) {
  std::array<std::int32_t, kMostRows> windings{};
  // The bits of a winding number that tell.
  const std::int32_t bits = rule == FillRule::kNonzero ? -1 : 1;
  for (int column = 0; column < columns_; ++column) {
    const std::int32_t* steps = steps_.data() + column * rows_;
    const float* passing = passing_.data() + column * rows_;
    float* share = share_.data() + column * rows_;
    for (int row = 0; row < rows_; ++row) {
      windings[row] += steps[row];
      share[row] = (windings[row] & bits) != 0 ? passing[row] : 0.0F;
    }
  }
}

void CellSamples::put_constant_behind(const ChannelValues& color, double opacity) {
  const auto opaque = static_cast<float>(opacity);
  const float* share = share_.data();
  float* passing = passing_.data();
  if (keeps_places_) {
    for (int c = 0; c < channels_; ++c) {
      const auto value = static_cast<float>(color[c]);
      float* values = values_[c].data();
      for (int i = 0; i < count_; ++i) values[i] += share[i] * value;
    }
    for (int i = 0; i < count_; ++i) passing[i] -= share[i] * opaque;
    return;
  }
  std::array<float, kMostRows> sums{};
  for (int i = 0; i < count_; i += rows_) {
    for (int row = 0; row < rows_; ++row) {
      sums[row] += share[i + row];
      passing[i + row] -= share[i + row] * opaque;
    }
  }
  double sum = 0.0;
  for (int row = 0; row < rows_; ++row) sum += sums[row];
  for (int c = 0; c < channels_; ++c) sums_[c] += sum * color[c];
}

void CellSamples::put_powers_behind(const std::array<ColorPowers, kMaxChannels>& color,
                                    const ColorPowers& opacity) {
  const auto at = [](const ColorPowers& p, float u, float v) {
    const auto of = [&p](int k) { return static_cast<float>(p[k]); };
    return of(0) + u * (of(1) + u * of(3) + v * of(4)) + v * (of(2) + v * of(5));
  };
  for (int i = 0; i < count_; ++i) {
    const int row = i % rows_;
    const float u =
        (static_cast<float>(i / rows_) + offsets_[row]) / static_cast<float>(columns_) - 0.5F;
    const auto v = static_cast<float>(sample_y(row));
    for (int c = 0; c < channels_; ++c) values_[c][i] += share_[i] * at(color[c], u, v);
    passing_[i] -= share_[i] * std::clamp(at(opacity, u, v), 0.0F, 1.0F);
  }
}

// What opacity holds is the same in all channels.
void CellSamples::put_behind(std::span<const ChannelValues> color,
                             std::span<const ChannelValues> opacity, const CellColors& colors) {
  if (color.size() == 1) {
    put_constant_behind(color[0], opacity[0][0]);
    return;
  }
  std::array<ColorPowers, kMaxChannels> color_powers;
  std::array<ColorPowers, kMaxChannels> opacity_powers;
  colors.powers(color, &color_powers);
  colors.powers(opacity, &opacity_powers);
  put_powers_behind(color_powers, opacity_powers[0]);
}

void CellSamples::put_full_behind(std::span<const Veil> veils, const CellColors& colors) {
  if (std::all_of(veils.begin(), veils.end(), [](const Veil& v) { return v.passing == 1.0; })) {
    return;
  }
  std::vector<ChannelValues> values;
  opacities_.clear();
  for (const Veil& veil : veils) {
    values.push_back(veil.color);
    opacities_.push_back({1.0 - veil.passing});
  }
  std::copy_n(passing_.begin(), count_, share_.begin());
  put_behind(values, opacities_, colors);
}

void CellSamples::put_layer_behind(std::span<const ChannelValues> color, const CellColors& colors) {
  opacities_.clear();
  for (const ChannelValues& value : color) opacities_.push_back({colors.opacity(value)});
  put_behind(color, opacities_, colors);
}

bool CellSamples::is_covered() const {
  return std::all_of(passing_.begin(), passing_.begin() + count_,
                     [](float passing) { return passing < kLeastPassing; });
}

void CellSamples::compose(int column, int row, std::span<const CellLayer> layers, int sample_rows,
                          CellColors* colors) {
  center_ = {column + 0.5, row + 0.5};
  begin(sample_rows);
  bool covered = false;
  for (std::size_t i = 0; !covered; ++i) {
    const bool is_seen = colors->look_at(i + 1) > i;
    put_full_behind(colors->over(i), *colors);
    if (!is_seen) break;
    add_windings(layers[i]);
    find_share(layers[i].fill_rule);
    put_layer_behind(colors->color(i), *colors);
    covered = is_covered();
  }
  // Less the background where it does not pass any more.
  ChannelValues taken = colors->background();
  for (double& value : taken) value = -value;
  for (int i = 0; i < count_; ++i) share_[i] = 1.0F - passing_[i];
  put_constant_behind(taken, 0.0);
}

void CellSamples::moments(int channel, int degree, double* out) const {
  const double share_of_sample = 1.0 / count_;
  std::fill_n(out, (degree + 1) * (degree + 1), 0.0);
  if (!keeps_places_) {
    out[0] = sums_[channel] * share_of_sample;
    return;
  }
  const Samples& values = values_[channel];
  for (int row = 0; row < rows_; ++row) {
    std::array<double, Kernel::kMostDegree + 1> along{};
    for (int column = 0; column < columns_; ++column) {
      const double u = (column + static_cast<double>(offsets_[row])) / columns_ - 0.5;
      double value = values[column * rows_ + row];
      for (int a = 0; a <= degree; ++a) {
        along[a] += value;
        value *= u;
      }
    }
    double power = share_of_sample;
    for (int b = 0; b <= degree; ++b) {
      for (int a = 0; a <= degree; ++a) out[a * (degree + 1) + b] += along[a] * power;
      power *= sample_y(row);
    }
  }
}

}  // namespace prefilter
