// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/filters/filtered_image.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/filterable.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"
#include "prefilter/filters/push_pull.h"

namespace prefilter {
namespace {

bool is_opaque(const TexelSource& bytes, int alpha) {
  constexpr std::uint8_t kOpaque = 255;
  for (int y = 0; y < bytes.height; ++y) {
    const std::uint8_t* texel = bytes.byte_texel(0, y);
    for (int x = 0; x < bytes.width; ++x, texel += bytes.channels) {
      if (texel[alpha] != kOpaque) return false;
    }
  }
  return true;
}

ValueRange widened(const ValueRange& a, const ValueRange& b) {
  return {std::min(a.low, b.low), std::max(a.high, b.high)};
}

}  // namespace

FilteredImage::FilteredImage(const TexelSource& source, const FindRead& find_read,
                             const Options& options)
    : source_(source), floats_(source.floats()), alpha_(options.alpha.value_or(0)) {
  assert(!options.alpha || *options.alpha == source.channels - 1);
  if (source.has_bytes()) {
    if (!options.needs_floats &&
        (!options.alpha || (options.stays_opaque && is_opaque(source, alpha_)))) {
      floats_ = {nullptr, source.width, source.height, source.channels};
      return;
    }
    make_floats(options);
  } else {
    check(find_read, options);
  }
  if (options.alpha) multiply_by_alpha(find_read, options);
}

void FilteredImage::make_floats(const Options& options) {
  copy_ = Image(source_.width, source_.height, source_.channels);
  floats_ = copy_.view();
  parallel_for(source_.height, options.threads, Progress(), [&](std::int64_t y) {
    const std::uint8_t* bytes = source_.byte_texel(0, static_cast<int>(y));
    float* texel = copy_.texel(0, static_cast<int>(y));
    for (int x = 0; x < source_.width; ++x) {
      for (int c = 0; c < source_.channels; ++c) *texel++ = source_.value(*bytes++, c);
    }
  });
}

void FilteredImage::check(const FindRead& find_read, const Options& options) {
  if (all_filterable(floats_, options.progress.part(0.0, 0.2), options.threads)) return;
  const std::vector<unsigned char> read = find_read();
  Image& copy = own_copy();
  for (std::size_t i = 0; i < read.size(); ++i) {
    float* texel = copy.data.data() + i * static_cast<std::size_t>(floats_.channels);
    for (int c = 0; c < floats_.channels; ++c) {
      if (is_filterable(texel[c])) continue;
      if (read[i] != 0) {
        const auto width = static_cast<std::size_t>(floats_.width);
        throw_invalid(std::string(options.name) + ": the texel in row " +
                      std::to_string(i / width) + ", column " + std::to_string(i % width) +
                      " holds " + to_text(texel[c]) + " in channel " + std::to_string(c) +
                      "; texels that count must be finite, and at most 1e30");
      }
      texel[c] = 0.0F;
    }
  }
}

void FilteredImage::multiply_by_alpha(const FindRead& find_read, const Options& options) {
  const auto opaque = [this](std::size_t i) {
    return floats_.data[i * static_cast<std::size_t>(floats_.channels) + alpha_] == 1.0F;
  };
  std::size_t i = 0;
  while (i < floats_.texel_count() && opaque(i)) ++i;
  if (i == floats_.texel_count() && options.stays_opaque) return;
  const std::vector<unsigned char> read = find_read();
  while (i < read.size() && (read[i] == 0 || opaque(i))) ++i;
  if (i == read.size() && options.stays_opaque) return;

  is_multiplied_ = true;
  Image& copy = own_copy();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr ValueRange kNothing = {kInfinity, -kInfinity};
  std::vector<std::array<ValueRange, 3>> rows(static_cast<std::size_t>(copy.height));
  for (std::array<ValueRange, 3>& row : rows) row.fill(kNothing);
  parallel_for(copy.height, options.threads, options.progress.part(0.8, 1.0),
               [&](std::int64_t row) {
                 float* texel = copy.texel(0, static_cast<int>(row));
                 const unsigned char* texel_read = read.data() + row * copy.width;
                 for (int x = 0; x < copy.width; ++x, texel += copy.channels) {
                   const float alpha = std::clamp(texel[alpha_], 0.0F, 1.0F);
                   texel[alpha_] = alpha;
                   for (int c = 0; c < alpha_; ++c) {
                     ValueRange& seen = rows[row][c];
                     if (alpha > 0.0F && texel_read[x] != 0)
                       seen = widened(seen, {texel[c], texel[c]});
                     texel[c] *= alpha;
                   }
                 }
               });
  colors_.fill(kNothing);
  for (const std::array<ValueRange, 3>& row : rows) {
    for (int c = 0; c < alpha_; ++c) colors_[c] = widened(colors_[c], row[c]);
  }
  for (ValueRange& own : colors_) {
    if (!(own.low <= own.high)) own = {0.0F, 0.0F};
  }
}

Image& FilteredImage::own_copy() {
  if (copy_.data.empty()) {
    copy_ = Image(floats_);
    floats_ = copy_.view();
  }
  return copy_;
}

ValueRange FilteredImage::solved_range(int channel, ValueRange bounds) const {
  if (!is_multiplied_) return bounds;
  if (channel == alpha_) return {0.0F, 1.0F};
  const ValueRange& own = colors_[channel];
  return {std::clamp(own.low, bounds.low, bounds.high),
          std::clamp(own.high, bounds.low, bounds.high)};
}

void FilteredImage::divide_by_alpha(WrapModes wrap, const Progress& progress, int threads,
                                    Image* level) const {
  if (!is_multiplied_) return;
  // What is covered less than this cannot be seen, and its color is mostly rounding.
  constexpr float kLeastAlpha = 1e-3F;
  std::vector<float> weights(level->view().texel_count());
  parallel_for(level->height, threads, progress.part(0.0, 0.5), [&](std::int64_t row) {
    float* texel = level->texel(0, static_cast<int>(row));
    float* weight = weights.data() + row * level->width;
    for (int x = 0; x < level->width; ++x, texel += level->channels) {
      const float alpha = texel[alpha_];
      weight[x] = alpha > kLeastAlpha ? alpha : 0.0F;
      for (int c = 0; c < alpha_; ++c) {
        const float color = weight[x] > 0.0F ? texel[c] / alpha : 0.0F;
        texel[c] = std::min(std::max(color, colors_[c].low), colors_[c].high);
      }
      texel[alpha_] = std::clamp(alpha, 0.0F, 1.0F);
    }
  });
  fill_holes(weights, wrap, alpha_, progress.part(0.5, 1.0), threads, level);
}

}  // namespace prefilter
