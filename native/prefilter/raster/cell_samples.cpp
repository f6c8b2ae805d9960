// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/raster/cell_samples.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "prefilter/base/vectors.h"
#include "prefilter/outline/fill_rule.h"

namespace prefilter {
namespace {

constexpr int kRows = CellSamples::kRows;
constexpr int kColumns = CellSamples::kColumns;

// What is behind so much is less than a sixtieth of 1/255: of a sample, and of all of them.
constexpr float kLeastPassing = 1.0F / 16384.0F;
constexpr double kLeastLeft = CellSamples::kCount / 16384.0;

// How far the samples of a row are to the right, in columns: numbers of rows, shuffled.
constexpr std::array<float, kRows> kOffsets = [] {
  std::array<float, kRows> offsets{};
  for (unsigned row = 0; row < kRows; ++row) {
    unsigned mixed = (row * 83 + 7) % kRows;
    mixed ^= mixed >> 3;
    mixed = mixed * 91 % kRows;
    mixed ^= mixed >> 4;
    offsets[row] = (static_cast<float>(mixed) + 0.5F) / kRows;
  }
  return offsets;
}();

double sample_y(int row) { return (row + 0.5) / kRows - 0.5; }

// The first row of samples at a height or above it.
int first_row_above(double y) {
  return std::clamp(static_cast<int>(std::ceil((y + 0.5) * kRows - 0.5)), 0, kRows);
}

// As many rows as a vector holds of a type.
template <typename T>
constexpr int kLanes = 16 / static_cast<int>(sizeof(T));
template <typename T>
using Lanes = Vector<T, kLanes<T>>;

template <typename Values>
Values load(const auto* from) {
  Values values;
  std::memcpy(&values, from, sizeof(values));
  return values;
}

void store(const auto& values, auto* to) { std::memcpy(to, &values, sizeof(values)); }

// Masks of four rows by their bits.
constexpr auto kMasks = [] {
  std::array<std::array<std::int32_t, 4>, 16> masks{};
  for (unsigned bits = 0; bits < 16; ++bits) {
    for (unsigned row = 0; row < 4; ++row) masks[bits][row] = (bits >> row & 1) != 0 ? -1 : 0;
  }
  return masks;
}();

// Numbers of four rows from one on, or 0 where a word has no bit.
Lanes<float> masked(const Lanes<float>& values, std::uint64_t word, int row) {
  return std::bit_cast<Lanes<float>>(std::bit_cast<Lanes<std::int32_t>>(values) &
                                     load<Lanes<std::int32_t>>(kMasks[word >> row & 15].data()));
}

// A bit of each of eight bytes that are -1 or 0.
std::uint64_t bits_of(std::uint64_t bytes) {
  return (bytes & 0x8040201008040201u) * 0x0101010101010101u >> 56;
}

// A bit of each of 16 rows that is not 0.
template <typename Count>
std::uint64_t bits_of_rows(const std::array<Lanes<Count>, 16 / kLanes<Count>>& rows) {
  std::array<std::int8_t, 16> masks;
  for (int part = 0; part < 16 / kLanes<Count>; ++part) {
    store(convert<Vector<std::int8_t, kLanes<Count>>>(rows[part] != Lanes<Count>{}),
          masks.data() + part * kLanes<Count>);
  }
  const auto words = std::bit_cast<std::array<std::uint64_t, 2>>(masks);
  return bits_of(words[0]) | bits_of(words[1]) << 8;
}

// Whether a layer fills what it winds around an odd number of times: where no number can be beyond
// 1 and -1, both rules say so.
bool fills_odd(const CellLayer& layer) {
  if (layer.fill_rule == FillRule::kEvenOdd) return true;
  std::int64_t least = layer.base;
  std::int64_t most = layer.base;
  for (const SideStep& step : layer.steps) (step.winding < 0 ? least : most) += step.winding;
  for (const StackArc& arc : layer.arcs) (arc.winding < 0 ? least : most) += arc.winding;
  return least >= -1 && most <= 1;
}

// The winding numbers left of each row.
std::array<std::int32_t, kRows> left_windings(const CellLayer& layer) {
  std::array<std::int32_t, kRows> left;
  left.fill(layer.base);
  for (const SideStep& step : layer.steps) {
    for (int row = first_row_above(step.y); row < kRows; ++row) left[row] += step.winding;
  }
  return left;
}

// Calls use(row, column) for the first sample right of a line in each row that it passes; behind
// the last column there is none.
void for_steps_of_line(Point2 low, Point2 high, const auto& use) {
  const int begin = first_row_above(low.y);
  const int end = first_row_above(high.y);
  if (begin >= end) return;
  const double slope = (high.x - low.x) / (high.y - low.y);
  const auto step = static_cast<float>(slope * kColumns / kRows);
  const auto first =
      static_cast<float>((low.x + (sample_y(begin) - low.y) * slope + 0.5) * kColumns + 1.0);
  std::array<std::int32_t, kRows> columns;
  for (int row = begin; row < end; ++row) {
    const float column = first + step * static_cast<float>(row - begin) - kOffsets[row];
    columns[row] =
        static_cast<std::int32_t>(std::min(std::max(column, 0.0F), static_cast<float>(kColumns)));
  }
  for (int row = begin; row < end; ++row) use(row, columns[row]);
}

}  // namespace

Point2 CellSamples::place(int row, int column) {
  return {(column + static_cast<double>(kOffsets[row])) / kColumns - 0.5, sample_y(row)};
}

CellSamples::CellSamples(const StackArcs& stack_arcs, int channels, bool keeps_places)
    : stack_arcs_(stack_arcs),
      channels_(channels),
      keeps_places_(keeps_places),
      narrow_steps_(kCount + kRows),
      wide_steps_(kCount + kRows),
      passing_(kCount),
      values_(keeps_places ? channels : 0, Samples(kCount)) {}

void CellSamples::begin() {
  for (auto& words : open_) words.fill(~std::uint64_t{0});
  is_opaque_ = true;
  passing_all_ = 1.0;
  left_ = kCount;
  for (Samples& values : values_) std::fill(values.begin(), values.end(), 0.0F);
  sums_ = {};
  if (keeps_places_) let_some_pass();
}

template <typename Use>
void CellSamples::for_steps(const StackArc& arc, const Use& use) const {
  if (arc.curve == StackArc::kLine) {
    for_steps_of_line(arc.low, arc.high, use);
    return;
  }
  const StackCurve& curve = stack_arcs_.curve(arc);
  const ParametricCurve& whole = stack_arcs_.piece(curve).curve;
  // A line where the middle of the arc is closer to it than a sample to the next.
  constexpr int kMostLines = 8;
  const Point2 middle = whole.at(0.5 * (curve.t_begin + curve.t_end)) - center_;
  const Point2 way = arc.high - arc.low;
  const double off = std::fabs(cross(way, middle - arc.low));
  const bool is_straight = off * 16.0 * kColumns < std::max(std::fabs(way.x), way.y);
  if (is_straight) {
    for_steps_of_line(arc.low, arc.high, use);
    return;
  }
  const bool rises = whole.at(curve.t_begin).y < whole.at(curve.t_end).y;
  Point2 low = arc.low;
  for (int i = 1; i <= kMostLines; ++i) {
    const double share = static_cast<double>(rises ? i : kMostLines - i) / kMostLines;
    Point2 high = arc.high;
    if (i < kMostLines) {
      high = whole.at(curve.t_begin + share * (curve.t_end - curve.t_begin)) - center_;
      high.y = std::clamp(high.y, low.y, arc.high.y);
    }
    if (high.y > low.y) for_steps_of_line(low, high, use);
    low = high;
  }
}

void CellSamples::fill_odd(const CellLayer& layer) {
  constexpr int kAll = kColumns * kWords;
  std::array<std::uint64_t, kAll + kWords> flips{};  // behind the last column, too
  for (const StackArc& arc : layer.arcs) {
    if (arc.winding % 2 == 0) continue;
    for_steps(arc, [&flips](int row, int column) {
      flips[column * kWords + row / kWordRows] ^= std::uint64_t{1} << (row % kWordRows);
    });
  }
  std::array<std::uint64_t, kWords> odd{};
  if (layer.base % 2 != 0) odd.fill(~std::uint64_t{0});
  for (const SideStep& step : layer.steps) {
    if (step.winding % 2 == 0) continue;
    for (int row = first_row_above(step.y); row < kRows; ++row) {
      odd[row / kWordRows] ^= std::uint64_t{1} << (row % kWordRows);
    }
  }
  for (int column = 0; column < kColumns; ++column) {
    for (int word = 0; word < kWords; ++word) {
      odd[word] ^= flips[column * kWords + word];
      filled_[column][word] = odd[word];
    }
  }
}

// Leaves steps of 0.
template <typename Count>
void CellSamples::fill_by_windings(const CellLayer& layer, std::vector<Count>* steps) {
  const auto left = left_windings(layer);
  for (int row = 0; row < kRows; ++row) (*steps)[row] = static_cast<Count>(left[row]);
  for (const StackArc& arc : layer.arcs) {
    for_steps(arc, [steps = steps->data(), winding = arc.winding](int row, int column) {
      Count& step = steps[column * kRows + row];
      step = static_cast<Count>(step + winding);
    });
  }
  for (auto& words : filled_) words = {};
  for (int block = 0; block < kRows; block += 16) {
    std::array<Lanes<Count>, 16 / kLanes<Count>> windings{};
    Count* step = steps->data() + block;
    for (int column = 0; column < kColumns; ++column, step += kRows) {
      for (int part = 0; part < 16 / kLanes<Count>; ++part) {
        windings[part] += load<Lanes<Count>>(step + part * kLanes<Count>);
        store(Lanes<Count>{}, step + part * kLanes<Count>);
      }
      filled_[column][block / kWordRows] |= bits_of_rows<Count>(windings) << (block % kWordRows);
    }
    std::fill_n(step, 16, Count{0});
  }
}

void CellSamples::fill(const CellLayer& layer) {
  if (fills_odd(layer)) {
    fill_odd(layer);
    return;
  }
  std::int64_t most = std::abs(static_cast<std::int64_t>(layer.base));
  for (const SideStep& step : layer.steps) most += std::abs(step.winding);
  for (const StackArc& arc : layer.arcs) most += std::abs(arc.winding);
  if (most <= 127) {
    fill_by_windings(layer, &narrow_steps_);
  } else {
    fill_by_windings(layer, &wide_steps_);
  }
}

void CellSamples::let_some_pass() {
  if (!is_opaque_) return;
  is_opaque_ = false;
  constexpr Lanes<float> kAll = {1.0F, 1.0F, 1.0F, 1.0F};
  for (int i = 0; i < kCount; i += kLanes<float>) {
    const int row = i % kRows;
    const std::uint64_t word = open_[i / kRows][row / kWordRows];
    store(masked(kAll, word, row % kWordRows), passing_.data() + i);
  }
}

// Takes what is filled from what passes all or nothing; returns how much that was.
double CellSamples::take_opaque() {
  int taken = 0;
  for (int column = 0; column < kColumns; ++column) {
    for (int word = 0; word < kWords; ++word) {
      std::uint64_t& open = open_[column][word];
      const std::uint64_t filled = filled_[column][word];
      taken += std::popcount(filled & open);
      open &= ~filled;
    }
  }
  return taken;
}

// Likewise a share of what passes, in a word of a column; returns what passed where it is filled.
float CellSamples::take_passing(int column, int word, const ChannelValues& color, float opaque) {
  const std::uint64_t filled = filled_[column][word];
  const int first = column * kRows + word * kWordRows;
  Lanes<float> sums{};
  Lanes<float> most{};
  for (int row = 0; row < kWordRows; row += kLanes<float>) {
    float* at = passing_.data() + first + row;
    auto passing = load<Lanes<float>>(at);
    const Lanes<float> share = masked(passing, filled, row);
    sums += share;
    passing -= share * opaque;
    store(passing, at);
    most = select(passing > most, passing, most);
    for (std::size_t c = 0; c < values_.size(); ++c) {
      float* values = values_[c].data() + first + row;
      store(load<Lanes<float>>(values) + share * static_cast<float>(color[c]), values);
    }
  }
  if (std::max({most[0], most[1], most[2], most[3]}) < kLeastPassing) open_[column][word] = 0;
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

double CellSamples::take_passing(const ChannelValues& color, float opaque) {
  double sum = 0.0;
  for (int column = 0; column < kColumns; ++column) {
    for (int word = 0; word < kWords; ++word) {
      if ((filled_[column][word] & open_[column][word]) == 0) continue;
      sum += static_cast<double>(take_passing(column, word, color, opaque));
    }
  }
  return sum;
}

void CellSamples::put_constant_behind(const ChannelValues& color, double opacity) {
  if (opacity < 1.0) let_some_pass();
  const double sum = is_opaque_ ? take_opaque() : take_passing(color, static_cast<float>(opacity));
  left_ -= sum * opacity;
  for (int c = 0; c < channels_; ++c) sums_[c] += passing_all_ * sum * color[c];
}

void CellSamples::put_powers_behind(const std::array<ColorPowers, kMaxChannels>& color,
                                    const ColorPowers& opacity) {
  const auto at = [](const ColorPowers& p, float u, float v) {
    const auto of = [&p](int k) { return static_cast<float>(p[k]); };
    return of(0) + u * (of(1) + u * of(3) + v * of(4)) + v * (of(2) + v * of(5));
  };
  double taken = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const int row = i % kRows;
    if ((filled_[i / kRows][row / kWordRows] >> (row % kWordRows) & 1) == 0) continue;
    const Point2 point = place(row, i / kRows);
    const auto u = static_cast<float>(point.x);
    const auto v = static_cast<float>(point.y);
    for (int c = 0; c < channels_; ++c) values_[c][i] += passing_[i] * at(color[c], u, v);
    const float share = passing_[i] * std::clamp(at(opacity, u, v), 0.0F, 1.0F);
    passing_[i] -= share;
    taken += static_cast<double>(share);
  }
  left_ -= taken;
}

// What opacity holds is the same in all channels.
void CellSamples::put_nodes_behind(std::span<const ChannelValues> color,
                                   std::span<const ChannelValues> opacity,
                                   const CellColors& colors) {
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
  if (!keeps_places_) {
    const Veil& veil = veils.front();
    for (int c = 0; c < channels_; ++c) sums_[c] += passing_all_ * left_ * veil.color[c];
    passing_all_ *= veil.passing;
    return;
  }
  for (auto& words : filled_) words.fill(~std::uint64_t{0});
  if (veils.size() == 1) {
    put_constant_behind(veils[0].color, 1.0 - veils[0].passing);
    return;
  }
  std::vector<ChannelValues> values;
  std::vector<ChannelValues> opacities;
  for (const Veil& veil : veils) {
    values.push_back(veil.color);
    opacities.push_back({1.0 - veil.passing});
  }
  put_nodes_behind(values, opacities, colors);
}

bool CellSamples::are_equal(const CellLayer& a, const CellLayer& b) const {
  return a.fill_rule == b.fill_rule && a.base == b.base && std::ranges::equal(a.steps, b.steps) &&
         std::ranges::equal(a.arcs, b.arcs, [&](const StackArc& arc, const StackArc& other) {
           return stack_arcs_.are_equal(arc, other);
         });
}

// Puts a layer behind, together with those below it that fill the same. Returns the last of them.
std::size_t CellSamples::put_layer_behind(std::size_t i, std::span<const CellLayer> layers,
                                          CellColors* colors) {
  fill(layers[i]);
  if (colors->nodes() > 1) {
    std::vector<ChannelValues> opacities;
    for (const ChannelValues& value : colors->color(i)) {
      opacities.push_back({colors->opacity(value)});
    }
    put_nodes_behind(colors->color(i), opacities, *colors);
    return i;
  }
  Veil veil;
  const auto put = [&](const ChannelValues& color) {
    veil.put_behind(color, colors->opacity(color), channels_);
  };
  put(colors->color(i)[0]);
  while (colors->look_at(i + 2) > i + 1 && colors->over(i + 1)[0].passing == 1.0 &&
         are_equal(layers[i], layers[i + 1])) {
    put(colors->color(++i)[0]);
  }
  put_constant_behind(veil.color, 1.0 - veil.passing);
  return i;
}

// Where it does not pass any more.
void CellSamples::take_background(const ChannelValues& background) {
  const double hidden = kCount - passing_all_ * left_;
  for (int c = 0; c < channels_; ++c) {
    sums_[c] -= hidden * background[c];
    if (!keeps_places_) continue;
    const auto value = static_cast<float>(background[c]);
    for (int i = 0; i < kCount; ++i) values_[c][i] -= (1.0F - passing_[i]) * value;
  }
}

void CellSamples::compose(int column, int row, std::span<const CellLayer> layers,
                          CellColors* colors) {
  center_ = {column + 0.5, row + 0.5};
  begin();
  for (std::size_t i = 0; passing_all_ * left_ > kLeastLeft; ++i) {
    const bool is_seen = colors->look_at(i + 1) > i;
    put_full_behind(colors->over(i), *colors);
    if (!is_seen || passing_all_ * left_ <= kLeastLeft) break;
    i = put_layer_behind(i, layers, colors);
  }
  take_background(colors->background());
}

void CellSamples::moments(int channel, int degree, double* out) const {
  std::fill_n(out, (degree + 1) * (degree + 1), 0.0);
  if (!keeps_places_) {
    out[0] = sums_[channel] / kCount;
    return;
  }
  // Of each row, of u^a.
  std::array<std::array<float, kRows>, Kernel::kMostDegree + 1> along{};
  for (int column = 0; column < kColumns; ++column) {
    const float* values = values_[channel].data() + column * kRows;
    for (int row = 0; row < kRows; ++row) {
      const float u = (static_cast<float>(column) + kOffsets[row]) / kColumns - 0.5F;
      float value = values[row];
      for (int a = 0; a <= degree; ++a) {
        along[a][row] += value;
        value *= u;
      }
    }
  }
  for (int row = 0; row < kRows; ++row) {
    double power = 1.0 / kCount;
    for (int b = 0; b <= degree; ++b) {
      for (int a = 0; a <= degree; ++a) {
        out[a * (degree + 1) + b] += static_cast<double>(along[a][row]) * power;
      }
      power *= sample_y(row);
    }
  }
}

}  // namespace prefilter
