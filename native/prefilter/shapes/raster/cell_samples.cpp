// SPDX-License-Identifier: GPL-3.0-or-later

// Supersampling on 64 x 64 points with bit masks, used where exact areas would take too many steps.
#include "prefilter/shapes/raster/cell_samples.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "prefilter/base/vectors.h"

namespace prefilter {
namespace {

constexpr int kCellSamplesSide = CellSamples::kSide;
constexpr std::uint64_t kCellSamplesAll = ~std::uint64_t{0};

// Compositing stops at this mean transmittance, a quarter of 1/255; together with the sampling
// error the result stays within 1/255.
constexpr double kMinSampledTransmittance = 1.0 / 1024.0;
constexpr double kMinTransmittanceSum = CellSamples::kCount * kMinSampledTransmittance;

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

// Lane masks for each pattern of four sample bits.
constexpr auto kMasks = [] {
  std::array<std::array<std::int32_t, kLanes>, 16> masks{};
  for (unsigned bits = 0; bits < 16; ++bits) {
    for (unsigned i = 0; i < kLanes; ++i) masks[bits][i] = (bits >> i & 1) != 0 ? -1 : 0;
  }
  return masks;
}();

// The values of four samples, or 0 where their bit in `word` is not set.
Floats masked(const Floats& values, std::uint64_t word, int sample) {
  Words mask;
  std::memcpy(&mask, kMasks[word >> sample & 15].data(), sizeof(mask));
  return std::bit_cast<Floats>(std::bit_cast<Words>(values) & mask);
}

// Transposes an 8 x 8 matrix of bytes: byte i of word j becomes byte j of word i.
void transpose_bytes(const std::uint64_t* from, std::uint64_t* to) {
  using Bytes = Vector<std::int8_t, 16>;
  using Pairs = Vector<std::int16_t, 8>;
  using Fours = Vector<std::int32_t, 4>;
  std::array<Pairs, 4> pairs;  // two rows each, interleaved by byte
  for (int i = 0; i < 4; ++i) {
    Bytes rows;
    std::memcpy(&rows, from + 2 * i, sizeof(rows));
    pairs[i] = std::bit_cast<Pairs>(
        shuffle<0, 8, 1, 9, 2, 10, 3, 11, 4, 12, 5, 13, 6, 14, 7, 15>(rows, rows));
  }
  std::array<Fours, 4> fours;  // bytes 0 to 3 and 4 to 7 of rows 0 to 3, then of rows 4 to 7
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

// Position of a sample, relative to the cell's center.
Point2 position_of(int block, int sample) {
  const int column = 8 * (block % 8) + sample % 8;
  const int row = 8 * (block / 8) + sample / 8;
  return {(column + 0.5) / kCellSamplesSide - 0.5, (row + 0.5) / kCellSamplesSide - 0.5};
}

}  // namespace

CellSamples::CellSamples(const StackArcs& stack_arcs, int channels, bool keeps_samples)
    : stack_arcs_(stack_arcs),
      channels_(channels),
      keeps_samples_(keeps_samples),
      bits_(stack_arcs),
      transmittance_(kCount),
      values_(keeps_samples ? channels : 0, Samples(kCount)) {}

void CellSamples::begin() {
  open_.fill(kCellSamplesAll);
  are_all_opaque_ = true;
  shared_transmittance_ = 1.0;
  transmittance_sum_ = kCount;
  for (Samples& values : values_) std::fill(values.begin(), values.end(), 0.0F);
  sums_ = {};
  if (keeps_samples_) allow_translucency();
}

void CellSamples::set_filled_blocks(const SampleRows& filled) {
  for (int row = 0; row < kBlockSide; ++row) {
    transpose_bytes(filled.data() + row * kBlockSide, filled_blocks_.data() + row * kBlockSide);
  }
}

void CellSamples::allow_translucency() {
  if (!are_all_opaque_) return;
  are_all_opaque_ = false;
  pending_.fill({});
  open_blocks_ = 0;
  set_filled_blocks(open_);
  const Floats all = all_of(1.0F);
  for (int block = 0; block < kBlocks; ++block) {
    const std::uint64_t open = filled_blocks_[block];
    block_transmittance_[block] = static_cast<float>(std::popcount(open));
    if (open != 0) open_blocks_ |= std::uint64_t{1} << block;
    float* transmittance = transmittance_.data() + block * kBlockCount;
    for (int i = 0; i < kBlockCount; i += kLanes) store(masked(all, open, i), transmittance + i);
  }
}

// Removes the filled samples from the open ones; returns how many were removed.
double CellSamples::close_filled(const SampleRows& filled) {
  int removed = 0;
  for (int row = 0; row < kCellSamplesSide; ++row) {
    removed += std::popcount(filled[row] & open_[row]);
    open_[row] &= ~filled[row];
  }
  return removed;
}

// Applies pending layers to the samples of a block.
void CellSamples::apply_pending(int block) {
  Pending& pending = pending_[block];
  if (pending.transmittance == 1.0F && pending.color == Pending{}.color) return;
  float* transmittance = transmittance_.data() + block * kBlockCount;
  for (int i = 0; i < kBlockCount; i += kLanes) {
    const Floats old = load(transmittance + i);
    for (std::size_t c = 0; c < values_.size(); ++c) {
      float* values = values_[c].data() + block * kBlockCount + i;
      store(load(values) + old * pending.color[c], values);
    }
    store(old * pending.transmittance, transmittance + i);
  }
  block_transmittance_[block] *= pending.transmittance;
  pending = {};
}

// Composites a layer behind the filled samples of a block; returns the sum of their transmittance
// before.
float CellSamples::composite_block(int block, const ChannelValues& color, float opaque) {
  const std::uint64_t filled = filled_blocks_[block];
  // Where values are kept per sample, pending layers of the block are applied in the same pass.
  Pending pending;
  if (keeps_samples_) std::swap(pending, pending_[block]);
  Floats covered{};
  Floats remaining_sum{};
  for (int i = 0; i < kBlockCount; i += kLanes) {
    float* at = transmittance_.data() + block * kBlockCount + i;
    const Floats old = load(at);
    const Floats transmittance = old * pending.transmittance;
    const Floats share = masked(transmittance, filled, i);
    const Floats remaining = transmittance - share * opaque;
    covered += share;
    remaining_sum += remaining;
    store(remaining, at);
    for (std::size_t c = 0; c < values_.size(); ++c) {
      float* values = values_[c].data() + block * kBlockCount + i;
      store(load(values) + (old * pending.color[c] + share * static_cast<float>(color[c])), values);
    }
  }
  block_transmittance_[block] = sum_of(remaining_sum);
  return sum_of(covered) * pending_[block].transmittance;
}

double CellSamples::composite_blocks(const ChannelValues& color, float opaque) {
  double sum = 0.0;
  for (std::uint64_t blocks = open_blocks_; blocks != 0; blocks &= blocks - 1) {
    const int block = std::countr_zero(blocks);
    if (filled_blocks_[block] == 0) continue;
    Pending& pending = pending_[block];
    if (filled_blocks_[block] == kCellSamplesAll) {
      sum += static_cast<double>(block_transmittance_[block] * pending.transmittance);
      for (std::size_t c = 0; c < values_.size(); ++c) {
        pending.color[c] += pending.transmittance * static_cast<float>(color[c]);
      }
      pending.transmittance *= 1.0F - opaque;
    } else {
      sum += static_cast<double>(composite_block(block, color, opaque));
    }
    constexpr auto kMinInBlock = static_cast<float>(kBlockCount * kMinSampledTransmittance);
    if (block_transmittance_[block] * pending.transmittance < kMinInBlock) {
      open_blocks_ &= ~(std::uint64_t{1} << block);
    }
  }
  return sum;
}

void CellSamples::put_constant_behind(const SampleRows& filled, const ChannelValues& color,
                                      double opacity) {
  if (opacity < 1.0) allow_translucency();
  double sum = 0.0;
  if (are_all_opaque_) {
    sum = close_filled(filled);
  } else {
    set_filled_blocks(filled);
    sum = composite_blocks(color, static_cast<float>(opacity));
  }
  transmittance_sum_ -= sum * opacity;
  for (int c = 0; c < channels_; ++c) sums_[c] += shared_transmittance_ * sum * color[c];
}

// Composites a layer of varying color, sample by sample.
void CellSamples::put_varying_behind(const SampleRows& filled, std::uint32_t layer,
                                     const CellColors& colors) {
  set_filled_blocks(filled);
  double removed = 0.0;
  for (int block = 0; block < kBlocks; ++block) {
    if (filled_blocks_[block] == 0) continue;
    apply_pending(block);
    for (std::uint64_t bits = filled_blocks_[block]; bits != 0; bits &= bits - 1) {
      const int sample = std::countr_zero(bits);
      const int i = block * kBlockCount + sample;
      const ChannelValues color = colors.color_at(layer, {position_of(block, sample), {}, {}});
      for (int c = 0; c < channels_; ++c) {
        values_[c][i] += transmittance_[i] * static_cast<float>(color[c]);
      }
      const float share = transmittance_[i] * static_cast<float>(colors.opacity(color));
      transmittance_[i] -= share;
      block_transmittance_[block] -= share;
      removed += static_cast<double>(share);
    }
  }
  transmittance_sum_ -= removed;
}

void CellSamples::put_full_behind(const LayerAccumulator& accumulated) {
  if (accumulated.transmittance == 1.0) return;
  if (!keeps_samples_) {
    for (int c = 0; c < channels_; ++c)
      sums_[c] += shared_transmittance_ * transmittance_sum_ * accumulated.color[c];
    shared_transmittance_ *= accumulated.transmittance;
    return;
  }
  SampleRows all;
  all.fill(kCellSamplesAll);
  put_constant_behind(all, accumulated.color, 1.0 - accumulated.transmittance);
}

bool CellSamples::are_equal(const CellLayer& a, const CellLayer& b) const {
  return a.fill_rule == b.fill_rule && a.base == b.base && std::ranges::equal(a.steps, b.steps) &&
         std::ranges::equal(a.arcs, b.arcs, [&](const StackArc& arc, const StackArc& other) {
           return stack_arcs_.are_equal(arc, other);
         });
}

// Composites a layer, together with the layers below it that fill the same region. Returns the last
// of them.
std::size_t CellSamples::put_layer_behind(std::size_t i, std::span<const CellLayer> layers,
                                          CellColors* colors) {
  const SampleRows& filled = bits_.fill(layers[i], center_);
  LayerAccumulator accumulated;
  const auto put = [&](const ChannelValues& color) {
    accumulated.put_behind(color, colors->opacity(color), channels_);
  };
  put(colors->color(i));
  while (colors->examine(i + 2) > i + 1 && colors->over(i + 1).transmittance == 1.0 &&
         are_equal(layers[i], layers[i + 1])) {
    put(colors->color(++i));
  }
  put_constant_behind(filled, accumulated.color, 1.0 - accumulated.transmittance);
  return i;
}

// Subtracts the background where it is hidden.
void CellSamples::subtract_background(const ChannelValues& background) {
  const double hidden = kCount - shared_transmittance_ * transmittance_sum_;
  for (int c = 0; c < channels_; ++c) sums_[c] -= hidden * background[c];
  if (!keeps_samples_) return;
  for (int block = 0; block < kBlocks; ++block) {
    apply_pending(block);
    for (int c = 0; c < channels_; ++c) {
      const auto value = static_cast<float>(background[c]);
      for (int i = block * kBlockCount; i < (block + 1) * kBlockCount; ++i) {
        values_[c][i] -= (1.0F - transmittance_[i]) * value;
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
  subtract_background(colors->background());
}

void CellSamples::compose_constant(std::span<const CellLayer> layers, CellColors* colors) {
  for (std::size_t i = 0; shared_transmittance_ * transmittance_sum_ > kMinTransmittanceSum; ++i) {
    const bool is_seen = colors->examine(i + 1) > i;
    put_full_behind(colors->over(i));
    if (!is_seen || shared_transmittance_ * transmittance_sum_ <= kMinTransmittanceSum) break;
    i = put_layer_behind(i, layers, colors);
  }
}

void CellSamples::compose_varying(std::span<const CellLayer> layers, CellColors* colors) {
  SampleRows all;
  all.fill(kCellSamplesAll);
  std::size_t next = 0;
  for (std::size_t i = 0; transmittance_sum_ > kMinTransmittanceSum; ++i) {
    const bool is_seen = colors->examine(i + 1) > i;
    for (; next < colors->seen_layers().size() && transmittance_sum_ > kMinTransmittanceSum;
         ++next) {
      const auto [layer, place] = colors->seen_layers()[next];
      const bool is_full = place == CellColors::SeenLayer::kFull;
      put_varying_behind(is_full ? all : bits_.fill(layers[place], center_), layer, *colors);
    }
    if (!is_seen) break;
  }
}

// Samples count as constant over their square, so that the moments of a cell of one color are
// exact.
void CellSamples::moments(int channel, int degree, double* out) const {
  std::fill_n(out, (degree + 1) * (degree + 1), 0.0);
  if (!keeps_samples_) {
    out[0] = sums_[channel] / kCount;
    return;
  }
  // Means of x^a over an interval of this width around `place`.
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
  constexpr int kVectors = kCellSamplesSide / kLanes;
  // For each column, the sums of y^b over rows.
  std::array<std::array<Floats, kVectors>, Kernel::kMostDegree + 1> up{};
  for (int first = 0; first < kCellSamplesSide; first += kRowsTogether) {
    std::array<double, Kernel::kMostDegree + 1> powers;
    constexpr double kHeight = double{kRowsTogether} / kCellSamplesSide;
    mean_powers(first * (1.0 / kCellSamplesSide) + 0.5 * kHeight - 0.5, kHeight, &powers);
    for (int i = 0; i < kVectors; ++i) {
      const int block = first / kBlockSide * kBlockSide + i * kLanes / kBlockSide;
      const int sample = first % kBlockSide * kBlockSide + i * kLanes % kBlockSide;
      const float* values = values_[channel].data() + block * kBlockCount + sample;
      Floats sum = load(values);
      for (int row = 1; row < kRowsTogether; ++row) sum += load(values + row * kBlockSide);
      for (int b = 0; b <= degree; ++b) up[b][i] += sum * static_cast<float>(powers[b]);
    }
  }
  for (int column = 0; column < kCellSamplesSide; ++column) {
    std::array<double, Kernel::kMostDegree + 1> powers;
    mean_powers((column + 0.5) / kCellSamplesSide - 0.5, 1.0 / kCellSamplesSide, &powers);
    for (int a = 0; a <= degree; ++a) {
      for (int b = 0; b <= degree; ++b) {
        out[a * (degree + 1) + b] +=
            powers[a] * static_cast<double>(up[b][column / kLanes][column % kLanes]) / kCount;
      }
    }
  }
}

}  // namespace prefilter
