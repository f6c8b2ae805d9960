// SPDX-License-Identifier: GPL-3.0-or-later

// Composites layers by pixel coverage, and tracks in bit masks where that would not be exact.
#include "prefilter/shapes/raster/composited_rows.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

#include "prefilter/shapes/outline/fill_rule.h"
#include "prefilter/shapes/raster/paint_bounds.h"

namespace prefilter {
namespace {

// Coverage below this, or that close to 1, does not change a float.
constexpr std::uint32_t kMinCoverageSteps = 1U << (kBoxBits - 24);
constexpr std::uint32_t kFullSteps = 1U << kBoxBits;

// For a color that changes by less than this over a pixel, replacing it by its mean over the pixel
// causes an error of at most an eighth of the change, and thus of about an eighth of 1/255.
constexpr double kMaxFlatVariation = 1.0 / 256.0;
// The mean of a product of two colors that vary over a pixel differs from the product of their
// means by at most a twelfth of the product of their changes. This bound keeps it below 1/2048.
constexpr double kMaxVariationProduct = 12.0 / 2048.0;

// Modulo 2^32, values slightly below 0 count as none, too.
bool is_none(std::uint32_t steps) {
  return steps + (kMinCoverageSteps - 1) < 2 * kMinCoverageSteps - 1;
}
bool is_full(std::uint32_t steps) {
  return steps - (kFullSteps - kMinCoverageSteps) <= 2 * kMinCoverageSteps;
}

// Which of 16 pixels are covered at all, and which fully.
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
void put_mean(const double* color, double share, double* out) {
  const double opacity = kChannels < kMaxChannels ? 1.0 : color[kMaxChannels - 1];
  const double transmittance = 1.0 - share * opacity;
  for (int c = 0; c < kChannels; ++c) out[c] = transmittance * out[c] + share * color[c];
}

template <int kChannels>
void put_color(const ChannelValues& color, double share, double transmittance, double* out) {
  for (int c = 0; c < kChannels; ++c) out[c] = transmittance * out[c] + share * color[c];
}

}  // namespace

CompositedRows::CompositedRows(const LayerStack& stack, int width, int channels)
    : stack_(stack), channels_(channels), width_(width), blocks_((width - 1) / kBlock + 1) {}

template <int kChannels>
void CompositedRows::put_block(const PreparedLayer& prepared, int row, int x, int count,
                               const std::uint32_t* steps, BandValues* values) {
  BlockBits& bits = this->bits(row)[x / kBlock];
  const unsigned pixels = kAll >> (kBlock - count);
  if (!prepared.winds_once) {
    bits.marked = static_cast<std::uint16_t>(bits.marked | pixels);
    return;
  }
  CoveredBits covered = covered_bits(steps);
  covered.any &= pixels;
  covered.full &= pixels;
  if (covered.any == 0) return;
  cover(prepared, covered.any, covered.full, &bits);
  double* out = values->pixels(row - first_row_, x, x + count);
  if (prepared.means != nullptr) {
    const int first = std::countr_zero(covered.any);
    const int last = static_cast<int>(std::bit_width(covered.any)) - 1;
    run_.resize(static_cast<std::size_t>(last + 1 - first) * kChannels);
    prepared.means->find(x + first, x + last + 1, row, run_.data());
    for (unsigned left = covered.any; left != 0; left &= left - 1) {
      const int i = std::countr_zero(left);
      const bool is_full = (covered.full >> i & 1) != 0;
      const double share = is_full ? 1.0 : static_cast<std::int32_t>(steps[i]) * kBoxUnit;
      put_mean<kChannels>(run_.data() + static_cast<std::ptrdiff_t>(i - first) * kChannels, share,
                          out + static_cast<std::ptrdiff_t>(i) * kChannels);
    }
    return;
  }
  for (unsigned left = covered.any; left != 0; left &= left - 1) {
    const int i = std::countr_zero(left);
    const bool is_full = (covered.full >> i & 1) != 0;
    const double share = is_full ? 1.0 : static_cast<std::int32_t>(steps[i]) * kBoxUnit;
    put_color<kChannels>(prepared.color, share, 1.0 - share * prepared.opacity,
                         out + static_cast<std::ptrdiff_t>(i) * kChannels);
  }
}

template <int kChannels>
void CompositedRows::put_run(const PreparedLayer& prepared, int row, int begin, int end,
                             std::uint32_t steps, BandValues* values) {
  double share = 1.0;
  if (prepared.winds_once) {
    // Next to a horizontal edge a run is partially covered.
    if (is_none(steps)) return;
    if (!is_full(steps)) share = static_cast<std::int32_t>(steps) * kBoxUnit;
  } else {
    // In a run no outline passes, so the winding number is constant.
    const std::int32_t winding = static_cast<std::int32_t>(steps + kFullSteps / 2) >> kBoxBits;
    if (!is_filled(winding, prepared.fill_rule)) return;
  }
  // A translucent constant color that fully covers pixels changes no bits.
  if (prepared.means != nullptr || share < 1.0 || prepared.opacity >= 1.0) {
    for_blocks(row, begin, end, [&](BlockBits* bits, unsigned pixels) {
      cover(prepared, pixels, share < 1.0 ? 0 : pixels, bits);
    });
  }
  if (prepared.means != nullptr) {
    run_.resize(static_cast<std::size_t>(end - begin) * kChannels);
    prepared.means->find(begin, end, row, run_.data());
    double* out = values->pixels(row - first_row_, begin, end);
    for (int i = 0; i < (end - begin) * kChannels; i += kChannels) {
      put_mean<kChannels>(run_.data() + i, share, out + i);
    }
    return;
  }
  double* out = values->pixels(row - first_row_, begin, end);
  const double transmittance = 1.0 - share * prepared.opacity;
  for (int x = begin; x < end; ++x, out += kChannels) {
    put_color<kChannels>(prepared.color, share, transmittance, out);
  }
}

// Marks the pixels along horizontal lines, which cause no differences along a row.
void CompositedRows::mark_horizontal_lines(const EdgeList& edges) {
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
void CompositedRows::put_layer(const PreparedLayer& prepared, BandValues* values) {
  coverage_.take(
      [&](int row, int x, int count, const std::uint32_t* steps) {
        put_block<kChannels>(prepared, row, x, count, steps, values);
      },
      [&](int row, int begin, int end, std::uint32_t steps) {
        put_run<kChannels>(prepared, row, begin, end, steps, values);
      });
}

void CompositedRows::composite_over(int first_row, int end_row, const ChannelValues& background,
                                    BandValues* values) {
  first_row_ = first_row;
  end_row_ = end_row;
  bits_.assign(static_cast<std::size_t>(end_row - first_row) * blocks_, {});
  has_marks_.assign(static_cast<std::size_t>(end_row - first_row), 0);
  coverage_.begin(width_, first_row, end_row);
  double steepest_below = 0.0;
  const auto is_in_band = [&](const StackLayer& layer) {
    return layer.edges.high() > first_row && layer.edges.low() < end_row;
  };
  for (std::size_t i = 0; i < stack_.layers.size(); ++i) {
    const StackLayer& layer = stack_.layers[i];
    if (layer.is_cutter) continue;
    if (is_in_band(layer)) {
      if (i + 1 < stack_.layers.size() && stack_.layers[i + 1].is_cutter &&
          is_in_band(stack_.layers[i + 1])) {
        add_cutter(stack_.layers[i + 1].edges);
      }
      coverage_.add(layer.edges);
      put_layer_by_channels(prepare(layer, steepest_below), values);
      if (!layer.winds_once) mark_horizontal_lines(layer.edges);
    }
    if (has_cutter_) clear_cutter();
    if (layer.paint->kind != Paint::Kind::kConstant) {
      steepest_below = std::max(steepest_below, variation_per_pixel(*layer.paint).value);
    }
  }
  reset_marked(background, values);
}

CompositedRows::PreparedLayer CompositedRows::prepare(const StackLayer& layer,
                                                      double steepest_below) {
  const Paint& paint = *layer.paint;
  PreparedLayer prepared{paint.constant, 1.0 - max_transmittance(paint, channels_),
                         layer.winds_once, layer.fill_rule};
  if (paint.kind == Paint::Kind::kConstant) {
    if (channels_ == kMaxChannels) prepared.opacity = paint.constant[kMaxChannels - 1];
    return prepared;
  }
  prepared.means = &means_.emplace(paint);
  const PaintVariation variation = variation_per_pixel(paint);
  prepared.is_steep = variation.value > kMaxFlatVariation;
  prepared.has_varying_alpha = variation.alpha > kMaxFlatVariation;
  prepared.marks_steep =
      variation.alpha > 0.0 && variation.alpha * steepest_below > kMaxVariationProduct;
  return prepared;
}

void CompositedRows::put_layer_by_channels(const PreparedLayer& prepared, BandValues* values) {
  static_assert(kMaxChannels == 4);
  switch (channels_) {
    case 1:
      put_layer<1>(prepared, values);
      break;
    case 2:
      put_layer<2>(prepared, values);
      break;
    case 3:
      put_layer<3>(prepared, values);
      break;
    default:
      put_layer<4>(prepared, values);
      break;
  }
}

// Marks the pixels that a cutter passes: their winding number is not a whole number.
void CompositedRows::add_cutter(const EdgeList& edges) {
  has_cutter_ = true;
  coverage_.add(edges);
  const auto is_passed = [](std::uint32_t steps) {
    return !is_none((steps + kFullSteps / 2) % kFullSteps - kFullSteps / 2);
  };
  coverage_.take(
      [&](int row, int x, int count, const std::uint32_t* steps) {
        BlockBits& bits = this->bits(row)[x / kBlock];
        for (int i = 0; i < count; ++i) {
          if (is_passed(steps[i])) bits.cut = static_cast<std::uint16_t>(bits.cut | 1U << i);
        }
      },
      [](int, int, int, std::uint32_t) {});
}

void CompositedRows::clear_cutter() {
  has_cutter_ = false;
  for (BlockBits& bits : bits_) bits.cut = 0;
}

// Updates the bits of a block for a layer that covers the pixels `any`, and `full` of them fully.
void CompositedRows::cover(const PreparedLayer& prepared, unsigned any, unsigned full,
                           BlockBits* bits) {
  const unsigned in_part = any & ~full;
  const unsigned hidden = prepared.opacity >= 1.0 ? full : 0;
  unsigned rough = in_part & (bits->in_part | bits->steep);
  rough |= any & bits->cut;
  if (prepared.is_steep) rough |= in_part;
  if (prepared.has_varying_alpha) rough |= any & bits->in_part;
  if (prepared.marks_steep) rough |= any & bits->steep;
  bits->marked = static_cast<std::uint16_t>((bits->marked & ~hidden) | rough);
  bits->in_part = static_cast<std::uint16_t>((bits->in_part & ~hidden) | in_part);
  bits->steep = static_cast<std::uint16_t>((bits->steep & ~hidden) | (prepared.is_steep ? any : 0));
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
  // Covers rounding of the coordinates, in pixels.
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
