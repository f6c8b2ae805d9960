// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/shapes/raster/cell_samples.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "prefilter/base/vectors.h"

namespace prefilter {
namespace {

constexpr int kSide = CellSamples::kSide;
constexpr std::uint64_t kAll = ~std::uint64_t{0};

// What is behind so much is a quarter of 1/255, all of it together: with what samples are off by it
// stays below 1/255.
constexpr double kLeastCrowdPassing = 1.0 / 1024.0;
constexpr double kLeastLeft = CellSamples::kCount * kLeastCrowdPassing;

constexpr int kLanes = 4;
using Floats = Vector<float, kLanes>;
using Words = Vector<std::int32_t, kLanes>;

Floats load(const float* from) {
  Floats values;
  std::memcpy(&values, from, sizeof(values));
  return values;
}

void store(const Floats& values, float* to) { std::memcpy(to, &values, sizeof(values)); }

Floats all_of(float value) { return Floats{value, value, value, value}; }

float sum_of(const Floats& values) { return (values[0] + values[1]) + (values[2] + values[3]); }

// Masks of four samples by their bits.
constexpr auto kMasks = [] {
  std::array<std::array<std::int32_t, kLanes>, 16> masks{};
  for (unsigned bits = 0; bits < 16; ++bits) {
    for (unsigned i = 0; i < kLanes; ++i) masks[bits][i] = (bits >> i & 1) != 0 ? -1 : 0;
  }
  return masks;
}();

// The numbers of four samples from one on, or 0 where a word has no bit.
Floats masked(const Floats& values, std::uint64_t word, int sample) {
  Words mask;
  std::memcpy(&mask, kMasks[word >> sample & 15].data(), sizeof(mask));
  return std::bit_cast<Floats>(std::bit_cast<Words>(values) & mask);
}

// Eight words of eight bytes each: byte i of word j becomes byte j of word i.
void turn_bytes(const std::uint64_t* from, std::uint64_t* to) {
  using Bytes = Vector<std::int8_t, 16>;
  using Pairs = Vector<std::int16_t, 8>;
  using Fours = Vector<std::int32_t, 4>;
  std::array<Pairs, 4> pairs;  // of two rows each, byte by byte
  for (int i = 0; i < 4; ++i) {
    Bytes rows;
    std::memcpy(&rows, from + 2 * i, sizeof(rows));
    pairs[i] = std::bit_cast<Pairs>(
        shuffle<0, 8, 1, 9, 2, 10, 3, 11, 4, 12, 5, 13, 6, 14, 7, 15>(rows, rows));
  }
  std::array<Fours, 4> fours;  // of rows 0 to 3: bytes 0 to 3, 4 to 7; the same of rows 4 to 7
  for (int i = 0; i < 2; ++i) {
    fours[2 * i] =
        std::bit_cast<Fours>(shuffle<0, 8, 1, 9, 2, 10, 3, 11>(pairs[2 * i], pairs[2 * i + 1]));
    fours[2 * i + 1] =
        std::bit_cast<Fours>(shuffle<4, 12, 5, 13, 6, 14, 7, 15>(pairs[2 * i], pairs[2 * i + 1]));
  }
  for (int i = 0; i < 2; ++i) {
    const Fours low = shuffle<0, 4, 1, 5>(fours[i], fours[i + 2]);
    const Fours high = shuffle<2, 6, 3, 7>(fours[i], fours[i + 2]);
    std::memcpy(to + 4 * i, &low, sizeof(low));
    std::memcpy(to + 4 * i + 2, &high, sizeof(high));
  }
}

// From the cell's center.
Point2 place_of(int block, int sample) {
  const int column = 8 * (block % 8) + sample % 8;
  const int row = 8 * (block / 8) + sample / 8;
  return {(column + 0.5) / kSide - 0.5, (row + 0.5) / kSide - 0.5};
}

}  // namespace

CellSamples::CellSamples(const StackArcs& stack_arcs, int channels, bool keeps_places)
    : stack_arcs_(stack_arcs),
      channels_(channels),
      keeps_places_(keeps_places),
      bits_(stack_arcs),
      passing_(kCount),
      values_(keeps_places ? channels : 0, Samples(kCount)) {}

void CellSamples::begin() {
  open_.fill(kAll);
  is_opaque_ = true;
  passing_all_ = 1.0;
  left_ = kCount;
  for (Samples& values : values_) std::fill(values.begin(), values.end(), 0.0F);
  sums_ = {};
  if (keeps_places_) let_some_pass();
}

void CellSamples::take_blocks(const SampleRows& filled) {
  for (int row = 0; row < kBlockSide; ++row) {
    turn_bytes(filled.data() + row * kBlockSide, filled_blocks_.data() + row * kBlockSide);
  }
}

void CellSamples::let_some_pass() {
  if (!is_opaque_) return;
  is_opaque_ = false;
  behind_.fill({});
  open_blocks_ = 0;
  take_blocks(open_);
  const Floats all = all_of(1.0F);
  for (int block = 0; block < kBlocks; ++block) {
    const std::uint64_t open = filled_blocks_[block];
    block_left_[block] = static_cast<float>(std::popcount(open));
    if (open != 0) open_blocks_ |= std::uint64_t{1} << block;
    float* passing = passing_.data() + block * kBlockCount;
    for (int i = 0; i < kBlockCount; i += kLanes) store(masked(all, open, i), passing + i);
  }
}

// Takes what is filled from what passes all or nothing; returns how much that was.
double CellSamples::take_opaque(const SampleRows& filled) {
  int taken = 0;
  for (int row = 0; row < kSide; ++row) {
    taken += std::popcount(filled[row] & open_[row]);
    open_[row] &= ~filled[row];
  }
  return taken;
}

// Brings the samples of a block up to date.
void CellSamples::take_behind(int block) {
  Behind& behind = behind_[block];
  if (behind.passing == 1.0F && behind.color == Behind{}.color) return;
  float* passing = passing_.data() + block * kBlockCount;
  for (int i = 0; i < kBlockCount; i += kLanes) {
    const Floats old = load(passing + i);
    for (std::size_t c = 0; c < values_.size(); ++c) {
      float* values = values_[c].data() + block * kBlockCount + i;
      store(load(values) + old * behind.color[c], values);
    }
    store(old * behind.passing, passing + i);
  }
  block_left_[block] *= behind.passing;
  behind = {};
}

// Takes a share of what passes where a block is filled; returns what passed there.
float CellSamples::take_part(int block, const ChannelValues& color, float opaque) {
  const std::uint64_t filled = filled_blocks_[block];
  // Where values are kept, with what was put behind all of the block.
  Behind behind;
  if (keeps_places_) std::swap(behind, behind_[block]);
  Floats taken{};
  Floats left{};
  for (int i = 0; i < kBlockCount; i += kLanes) {
    float* at = passing_.data() + block * kBlockCount + i;
    const Floats old = load(at);
    const Floats passing = old * behind.passing;
    const Floats share = masked(passing, filled, i);
    const Floats rest = passing - share * opaque;
    taken += share;
    left += rest;
    store(rest, at);
    for (std::size_t c = 0; c < values_.size(); ++c) {
      float* values = values_[c].data() + block * kBlockCount + i;
      store(load(values) + (old * behind.color[c] + share * static_cast<float>(color[c])), values);
    }
  }
  block_left_[block] = sum_of(left);
  return sum_of(taken) * behind_[block].passing;
}

double CellSamples::take_passing(const ChannelValues& color, float opaque) {
  double sum = 0.0;
  for (std::uint64_t blocks = open_blocks_; blocks != 0; blocks &= blocks - 1) {
    const int block = std::countr_zero(blocks);
    if (filled_blocks_[block] == 0) continue;
    Behind& behind = behind_[block];
    if (filled_blocks_[block] == kAll) {
      sum += static_cast<double>(block_left_[block] * behind.passing);
      for (std::size_t c = 0; c < values_.size(); ++c) {
        behind.color[c] += behind.passing * static_cast<float>(color[c]);
      }
      behind.passing *= 1.0F - opaque;
    } else {
      sum += static_cast<double>(take_part(block, color, opaque));
    }
    constexpr auto kLeastInBlock = static_cast<float>(kBlockCount * kLeastCrowdPassing);
    if (block_left_[block] * behind.passing < kLeastInBlock) {
      open_blocks_ &= ~(std::uint64_t{1} << block);
    }
  }
  return sum;
}

void CellSamples::put_constant_behind(const SampleRows& filled, const ChannelValues& color,
                                      double opacity) {
  if (opacity < 1.0) let_some_pass();
  double sum = 0.0;
  if (is_opaque_) {
    sum = take_opaque(filled);
  } else {
    take_blocks(filled);
    sum = take_passing(color, static_cast<float>(opacity));
  }
  left_ -= sum * opacity;
  for (int c = 0; c < channels_; ++c) sums_[c] += passing_all_ * sum * color[c];
}

// Puts a layer whose color varies behind what is there, sample by sample.
void CellSamples::put_varying_behind(const SampleRows& filled, std::uint32_t layer,
                                     const CellColors& colors) {
  take_blocks(filled);
  double taken = 0.0;
  for (int block = 0; block < kBlocks; ++block) {
    if (filled_blocks_[block] == 0) continue;
    take_behind(block);
    for (std::uint64_t bits = filled_blocks_[block]; bits != 0; bits &= bits - 1) {
      const int sample = std::countr_zero(bits);
      const int i = block * kBlockCount + sample;
      const ChannelValues color = colors.color_at(layer, {place_of(block, sample), {}, {}});
      for (int c = 0; c < channels_; ++c) {
        values_[c][i] += passing_[i] * static_cast<float>(color[c]);
      }
      const float share = passing_[i] * static_cast<float>(colors.opacity(color));
      passing_[i] -= share;
      block_left_[block] -= share;
      taken += static_cast<double>(share);
    }
  }
  left_ -= taken;
}

void CellSamples::put_full_behind(const Veil& veil) {
  if (veil.passing == 1.0) return;
  if (!keeps_places_) {
    for (int c = 0; c < channels_; ++c) sums_[c] += passing_all_ * left_ * veil.color[c];
    passing_all_ *= veil.passing;
    return;
  }
  SampleRows all;
  all.fill(kAll);
  put_constant_behind(all, veil.color, 1.0 - veil.passing);
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
  const SampleRows& filled = bits_.fill(layers[i], center_);
  Veil veil;
  const auto put = [&](const ChannelValues& color) {
    veil.put_behind(color, colors->opacity(color), channels_);
  };
  put(colors->color(i));
  while (colors->look_at(i + 2) > i + 1 && colors->over(i + 1).passing == 1.0 &&
         are_equal(layers[i], layers[i + 1])) {
    put(colors->color(++i));
  }
  put_constant_behind(filled, veil.color, 1.0 - veil.passing);
  return i;
}

// Where it does not pass any more.
void CellSamples::take_background(const ChannelValues& background) {
  const double hidden = kCount - passing_all_ * left_;
  for (int c = 0; c < channels_; ++c) sums_[c] -= hidden * background[c];
  if (!keeps_places_) return;
  for (int block = 0; block < kBlocks; ++block) {
    take_behind(block);
    for (int c = 0; c < channels_; ++c) {
      const auto value = static_cast<float>(background[c]);
      for (int i = block * kBlockCount; i < (block + 1) * kBlockCount; ++i) {
        values_[c][i] -= (1.0F - passing_[i]) * value;
      }
    }
  }
}

void CellSamples::compose(int column, int row, std::span<const CellLayer> layers,
                          CellColors* colors) {
  center_ = {column + 0.5, row + 0.5};
  begin();
  if (colors->is_constant()) {
    compose_constant(layers, colors);
  } else {
    compose_varying(layers, colors);
  }
  take_background(colors->background());
}

void CellSamples::compose_constant(std::span<const CellLayer> layers, CellColors* colors) {
  for (std::size_t i = 0; passing_all_ * left_ > kLeastLeft; ++i) {
    const bool is_seen = colors->look_at(i + 1) > i;
    put_full_behind(colors->over(i));
    if (!is_seen || passing_all_ * left_ <= kLeastLeft) break;
    i = put_layer_behind(i, layers, colors);
  }
}

void CellSamples::compose_varying(std::span<const CellLayer> layers, CellColors* colors) {
  SampleRows all;
  all.fill(kAll);
  std::size_t next = 0;
  for (std::size_t i = 0; left_ > kLeastLeft; ++i) {
    const bool is_seen = colors->look_at(i + 1) > i;
    for (; next < colors->seen_layers().size() && left_ > kLeastLeft; ++next) {
      const auto [layer, place] = colors->seen_layers()[next];
      const bool is_full = place == CellColors::SeenLayer::kFull;
      put_varying_behind(is_full ? all : bits_.fill(layers[place], center_), layer, *colors);
    }
    if (!is_seen) break;
  }
}

// Of values that are the same all over what is around a sample, so that of a cell of one color the
// moments are exact.
void CellSamples::moments(int channel, int degree, double* out) const {
  std::fill_n(out, (degree + 1) * (degree + 1), 0.0);
  if (!keeps_places_) {
    out[0] = sums_[channel] / kCount;
    return;
  }
  // The means of x^a from side to side of what is `width` wide around a place.
  const auto mean_powers = [degree](double place, double width, auto* powers) {
    double low = 1.0;
    double high = 1.0;
    for (int a = 0; a <= degree; ++a) {
      low *= place - 0.5 * width;
      high *= place + 0.5 * width;
      (*powers)[a] = (high - low) / (width * (a + 1));
    }
  };
  constexpr int kRowsTogether = 4;
  constexpr int kVectors = kSide / kLanes;
  // Of each column: the sums over rows of y^b.
  std::array<std::array<Floats, kVectors>, Kernel::kMostDegree + 1> up{};
  for (int first = 0; first < kSide; first += kRowsTogether) {
    std::array<double, Kernel::kMostDegree + 1> powers;
    constexpr double kHeight = double{kRowsTogether} / kSide;
    mean_powers(first * (1.0 / kSide) + 0.5 * kHeight - 0.5, kHeight, &powers);
    for (int i = 0; i < kVectors; ++i) {
      const int block = first / kBlockSide * kBlockSide + i * kLanes / kBlockSide;
      const int sample = first % kBlockSide * kBlockSide + i * kLanes % kBlockSide;
      const float* values = values_[channel].data() + block * kBlockCount + sample;
      Floats sum = load(values);
      for (int row = 1; row < kRowsTogether; ++row) sum += load(values + row * kBlockSide);
      for (int b = 0; b <= degree; ++b) up[b][i] += sum * static_cast<float>(powers[b]);
    }
  }
  for (int column = 0; column < kSide; ++column) {
    std::array<double, Kernel::kMostDegree + 1> powers;
    mean_powers((column + 0.5) / kSide - 0.5, 1.0 / kSide, &powers);
    for (int a = 0; a <= degree; ++a) {
      for (int b = 0; b <= degree; ++b) {
        out[a * (degree + 1) + b] +=
            powers[a] * static_cast<double>(up[b][column / kLanes][column % kLanes]) / kCount;
      }
    }
  }
}

}  // namespace prefilter
