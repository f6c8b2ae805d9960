// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/raster/composited_rows.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

#include "prefilter/outline/fill_rule.h"

namespace prefilter {
namespace {

// What a pixel is covered by less than this, or lacks up to being covered, does not show in a
// float.
constexpr std::uint32_t kLeastSteps = 1U << (kBoxBits - 24);
constexpr std::uint32_t kFullSteps = 1U << kBoxBits;

// Modulo 2^32: what is a little below 0 is none, too.
bool is_none(std::uint32_t steps) { return steps + (kLeastSteps - 1) < 2 * kLeastSteps - 1; }
bool is_full(std::uint32_t steps) { return steps - (kFullSteps - kLeastSteps) <= 2 * kLeastSteps; }

// Which of 16 pixels are covered at all, and which wholly.
struct CoveredBits {
  unsigned any = 0;
  unsigned full = 0;
};

CoveredBits covered_bits(const std::uint32_t* steps) {
  CoveredBits bits;
  for (unsigned i = 0; i < 16; ++i) {
    bits.any |= (is_none(steps[i]) ? 0U : 1U) << i;
    bits.full |= (is_full(steps[i]) ? 1U : 0U) << i;
  }
  return bits;
}

template <int kChannels>
void put_color(const ChannelValues& color, double share, double passing, double* out) {
  for (int c = 0; c < kChannels; ++c) out[c] = passing * out[c] + share * color[c];
}

}  // namespace

CompositedRows::CompositedRows(const LayerStack& stack, int width, int channels)
    : stack_(stack), channels_(channels), width_(width), blocks_((width - 1) / kBlock + 1) {}

template <int kChannels>
void CompositedRows::put_block(const Coat& coat, int row, int x, int count,
                               const std::uint32_t* steps, BandValues* values) {
  BlockBits& bits = this->bits(row)[x / kBlock];
  const unsigned pixels = kAll >> (kBlock - count);
  if (!coat.winds_once) {
    bits.marked = static_cast<std::uint16_t>(bits.marked | pixels);
    return;
  }
  CoveredBits covered = covered_bits(steps);
  covered.any &= pixels;
  covered.full &= pixels;
  if (covered.any == 0) return;
  const unsigned in_part = covered.any & ~covered.full;
  const unsigned hidden = coat.opacity >= 1.0 ? covered.full : 0;
  bits.marked = static_cast<std::uint16_t>((bits.marked & ~hidden) | (bits.in_part & in_part));
  bits.in_part = static_cast<std::uint16_t>((bits.in_part & ~hidden) | in_part);
  double* out = values->pixels(row - first_row_, x, x + count);
  for (unsigned left = covered.any; left != 0; left &= left - 1) {
    const int i = std::countr_zero(left);
    const bool is_full = (covered.full >> i & 1) != 0;
    const double share = is_full ? 1.0 : static_cast<std::int32_t>(steps[i]) * kBoxUnit;
    put_color<kChannels>(coat.color, share, 1.0 - share * coat.opacity,
                         out + static_cast<std::ptrdiff_t>(i) * kChannels);
  }
}

template <int kChannels>
void CompositedRows::put_run(const Coat& coat, int row, int begin, int end, std::uint32_t steps,
                             BandValues* values) {
  double share = 1.0;
  if (coat.winds_once) {
    // Below or above a level edge it is a part.
    if (is_none(steps)) return;
    if (!is_full(steps)) share = static_cast<std::int32_t>(steps) * kBoxUnit;
  } else {
    // Where no outline passes, all is wound around as often.
    const std::int32_t winding = static_cast<std::int32_t>(steps + kFullSteps / 2) >> kBoxBits;
    if (!is_filled(winding, coat.fill_rule)) return;
  }
  if (share < 1.0) {
    for_blocks(row, begin, end, [](BlockBits* bits, unsigned pixels) {
      bits->marked = static_cast<std::uint16_t>(bits->marked | (bits->in_part & pixels));
      bits->in_part = static_cast<std::uint16_t>(bits->in_part | pixels);
    });
  } else if (coat.opacity >= 1.0) {
    for_blocks(row, begin, end, [](BlockBits* bits, unsigned pixels) {
      bits->marked = static_cast<std::uint16_t>(bits->marked & ~pixels);
      bits->in_part = static_cast<std::uint16_t>(bits->in_part & ~pixels);
    });
  }
  double* out = values->pixels(row - first_row_, begin, end);
  const double passing = 1.0 - share * coat.opacity;
  for (int x = begin; x < end; ++x, out += kChannels) {
    put_color<kChannels>(coat.color, share, passing, out);
  }
}

// Marks what level lines pass, which make no difference from pixel to pixel.
void CompositedRows::mark_level_lines(const EdgeList& edges) {
  edges.for_segments_between(first_row_, end_row_, [&](std::span<const Point2> controls, double) {
    const Point2& first = controls.front();
    const Point2& last = controls.back();
    if (controls.size() > 2 || rounded_to_unit(first.y) != rounded_to_unit(last.y)) return;
    const double row = std::floor(first.y);
    if (row < first_row_ || row >= end_row_) return;
    const auto column = [&](double x) {
      return static_cast<int>(std::floor(std::clamp(x, 0.0, width_ - 1.0)));
    };
    for_blocks(static_cast<int>(row), column(std::min(first.x, last.x)),
               column(std::max(first.x, last.x)) + 1, [](BlockBits* bits, unsigned pixels) {
                 bits->marked = static_cast<std::uint16_t>(bits->marked | pixels);
               });
  });
}

template <int kChannels>
void CompositedRows::put_layer(const Coat& coat, BandValues* values) {
  coverage_.take(
      [&](int row, int x, int count, const std::uint32_t* steps) {
        put_block<kChannels>(coat, row, x, count, steps, values);
      },
      [&](int row, int begin, int end, std::uint32_t steps) {
        put_run<kChannels>(coat, row, begin, end, steps, values);
      });
}

void CompositedRows::put_over(int first_row, int end_row, const ChannelValues& background,
                              BandValues* values) {
  first_row_ = first_row;
  end_row_ = end_row;
  bits_.assign(static_cast<std::size_t>(end_row - first_row) * blocks_, {});
  has_marks_.assign(static_cast<std::size_t>(end_row - first_row), 0);
  coverage_.begin(width_, first_row, end_row);
  for (const StackLayer& layer : stack_.layers) {
    if (layer.edges.high() <= first_row || layer.edges.low() >= end_row) continue;
    coverage_.add(layer.edges);
    const ChannelValues& color = layer.paint->constant;
    const Coat coat{color, channels_ < kMaxChannels ? 1.0 : color[kMaxChannels - 1],
                    layer.winds_once, layer.fill_rule};
    static_assert(kMaxChannels == 4);
    switch (channels_) {
      case 1:
        put_layer<1>(coat, values);
        break;
      case 2:
        put_layer<2>(coat, values);
        break;
      case 3:
        put_layer<3>(coat, values);
        break;
      default:
        put_layer<4>(coat, values);
        break;
    }
    if (!layer.winds_once) mark_level_lines(layer.edges);
  }
  reset_marked(background, values);
}

void CompositedRows::reset_marked(const ChannelValues& background, BandValues* values) {
  for (int row = first_row_; row < end_row_; ++row) {
    for (int block = 0; block < blocks_; ++block) {
      unsigned marked = bits(row)[block].marked;
      if (marked == 0) continue;
      has_marks_[row - first_row_] = 1;
      const int x = block * kBlock;
      double* out = values->pixels(row - first_row_, x, std::min(x + kBlock, width_));
      for (; marked != 0; marked &= marked - 1) {
        std::copy_n(background.data(), channels_, out + std::countr_zero(marked) * channels_);
      }
    }
  }
}

bool CompositedRows::has_marks_within(const Point2& a, const Point2& b) const {
  // A little more, as places are rounded.
  constexpr double kSlack = 1e-6;
  const auto place = [](double at, double most) {
    return static_cast<int>(std::floor(std::clamp(at, 0.0, most)));
  };
  const int first = place(std::min(a.x, b.x) - kSlack, width_ - 1);
  const int last = place(std::max(a.x, b.x) + kSlack, width_ - 1);
  const int low = std::max(place(std::min(a.y, b.y), end_row_ - 1), first_row_);
  const int high = place(std::max(a.y, b.y), end_row_ - 1);
  for (int row = low; row <= high; ++row) {
    if (!has_marks(row)) continue;
    for (int block = first / kBlock; block <= last / kBlock; ++block) {
      const int begin = std::max(first - block * kBlock, 0);
      const int end = std::min(last + 1 - block * kBlock, kBlock);
      if ((bits(row)[block].marked & (kAll >> (kBlock - end)) & (kAll << begin)) != 0) return true;
    }
  }
  return false;
}

void CompositedRows::marked_columns(int row, OpenColumns* columns) const {
  columns->close_all(width_);
  for (int block = 0; block < blocks_; ++block) {
    columns->open(block * kBlock, bits(row)[block].marked);
  }
}

}  // namespace prefilter
