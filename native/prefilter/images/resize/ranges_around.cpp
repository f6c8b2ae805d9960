// SPDX-License-Identifier: GPL-3.0-or-later

// Minima and maxima over the texels around, along columns and then along rows.
#include "prefilter/images/resize/ranges_around.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {

constexpr float kUnlimited = std::numeric_limits<float>::max();

// The source texels around target texels along an axis.
class Around {
 public:
  Around(int source_size, int target_size, Wrap wrap)
      : source_size_(source_size),
        wrap_(wrap),
        ratio_(static_cast<double>(source_size) / target_size),
        reach_(std::max(1.0, ratio_)) {}

  /// Calls visit(texel) for each, -1 for the border.
  template <typename Visit>
  void each(int target, const Visit& visit) const {
    constexpr double kOnEdge = 1e-9;  // texels that only touch do not count
    const double center = (target + 0.5) * ratio_;
    const auto first = static_cast<int>(std::floor(center - reach_ + kOnEdge));
    const auto end = static_cast<int>(std::ceil(center + reach_ - kOnEdge));
    if (end - first >= source_size_ + 2) {  // all texels, and the border
      for (int texel = wrap_ == Wrap::kBorder ? -1 : 0; texel < source_size_; ++texel) visit(texel);
      return;
    }
    for (int texel = first; texel < end; ++texel) visit(wrap_index(texel, source_size_, wrap_));
  }

 private:
  int source_size_;
  Wrap wrap_;
  double ratio_;
  double reach_;
};

// Ranges of several texels, channel by channel.
struct Ranges {
  explicit Ranges(std::size_t count) : low(count), high(count) { clear(); }
  void clear() {
    std::fill(low.begin(), low.end(), kUnlimited);
    std::fill(high.begin(), high.end(), -kUnlimited);
  }
  void add(std::size_t at, float value) { add(at, value, value); }
  void add(std::size_t at, float least, float greatest) {
    low[at] = std::min(low[at], least);
    high[at] = std::max(high[at], greatest);
  }
  std::vector<float> low;
  std::vector<float> high;
};

// Ranges over rows of the source.
class RowRanges {
 public:
  RowRanges(const TexelSource& source, std::optional<int> alpha)
      : source_(source), alpha_(alpha), channels_(static_cast<std::size_t>(source.channels)) {}

  /// Adds a row of the source, or the border's for -1.
  void add(int y, Ranges* ranges) const {
    const auto width = static_cast<std::size_t>(source_.width);
    if (y < 0) {
      for (std::size_t x = 0; x < width; ++x) add_border(x * channels_, ranges);
    } else if (!alpha_ && !source_.has_bytes()) {
      const float* const values = source_.floats().texel(0, y);
      for (std::size_t i = 0; i < width * channels_; ++i) ranges->add(i, values[i]);
    } else {
      for (std::size_t x = 0; x < width; ++x) add_texel(static_cast<int>(x), y, ranges);
    }
  }

  /// A texel of zeros; if there is alpha, it is transparent and its colors do not count.
  void add_border(std::size_t at, Ranges* ranges) const {
    for (std::size_t c = 0; c < channels_; ++c) {
      if (!alpha_ || c == static_cast<std::size_t>(*alpha_)) ranges->add(at + c, 0.0F);
    }
  }

 private:
  void add_texel(int x, int y, Ranges* ranges) const {
    const std::size_t at = static_cast<std::size_t>(x) * channels_;
    const auto value = [&](int c) {
      return source_.has_bytes() ? source_.value(source_.byte_texel(x, y)[c], c)
                                 : source_.floats().texel(x, y)[c];
    };
    const float alpha = alpha_ ? std::clamp(value(*alpha_), 0.0F, 1.0F) : 1.0F;
    for (int c = 0; c < source_.channels; ++c) {
      if (alpha_ && c == *alpha_) {
        ranges->add(at + static_cast<std::size_t>(c), alpha);
      } else if (alpha > 0.0F) {
        ranges->add(at + static_cast<std::size_t>(c), value(c));
      }
    }
  }

  const TexelSource& source_;
  std::optional<int> alpha_;
  std::size_t channels_;
};

}  // namespace

RangesAround ranges_around(const TexelSource& source, std::optional<int> alpha, int width,
                           int height, WrapModes wrap, const Run& run) {
  const auto channels = static_cast<std::size_t>(source.channels);
  RangesAround result{Image(width, height, source.channels), Image(width, height, source.channels)};
  const Around along_x(source.width, width, wrap.u);
  const Around along_y(source.height, height, wrap.v);
  const RowRanges rows(source, alpha);
  parallel_for(height, run, [&](std::int64_t row) {
    const auto y = static_cast<int>(row);
    Ranges columns(static_cast<std::size_t>(source.width) * channels);
    along_y.each(y, [&](int from) { rows.add(from, &columns); });
    Ranges texel(channels);
    for (int x = 0; x < width; ++x) {
      texel.clear();
      along_x.each(x, [&](int from) {
        if (from < 0) return rows.add_border(0, &texel);
        const std::size_t at = static_cast<std::size_t>(from) * channels;
        for (std::size_t c = 0; c < channels; ++c) {
          texel.add(c, columns.low[at + c], columns.high[at + c]);
        }
      });
      for (std::size_t c = 0; c < channels; ++c) {
        const bool counts = texel.low[c] <= texel.high[c];
        result.low.texel(x, y)[c] = counts ? texel.low[c] : -kUnlimited;
        result.high.texel(x, y)[c] = counts ? texel.high[c] : kUnlimited;
      }
    }
  });
  return result;
}

void limit_to(const RangesAround& ranges, int threads, Image* image) {
  parallel_for(image->height, Run(threads), [&](std::int64_t row) {
    const auto y = static_cast<int>(row);
    float* const values = image->texel(0, y);
    const float* const low = ranges.low.texel(0, y);
    const float* const high = ranges.high.texel(0, y);
    for (int i = 0; i < image->width * image->channels; ++i) {
      values[i] = std::clamp(values[i], low[i], high[i]);
    }
  });
}

}  // namespace prefilter
