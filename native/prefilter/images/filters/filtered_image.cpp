// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/images/filters/filtered_image.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/filterable.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"
#include "prefilter/images/filters/push_pull.h"

namespace prefilter {
namespace {

constexpr std::uint8_t kOpaque = 255;
constexpr float kByteUnit = 1.0F / 255.0F;

bool is_opaque(const TexelSource& bytes, int alpha) {
  for (int y = 0; y < bytes.height; ++y) {
    const std::uint8_t* texel = bytes.byte_texel(0, y);
    std::uint8_t least = kOpaque;
    for (int x = 0; x < bytes.width; ++x) least &= texel[x * bytes.channels + alpha];
    if (least != kOpaque) return false;
  }
  return true;
}

// Reads colors multiplied by alpha, the last channel.
template <int C, typename Value>
void read_multiplied(const std::uint8_t* byte, int count, const Value& value, float* to) {
  for (int i = 0; i < count; ++i, byte += C, to += C) {
    const float alpha = value(byte[C - 1], C - 1);
    for (int c = 0; c < C - 1; ++c) to[c] = value(byte[c], c) * alpha;
    to[C - 1] = alpha;
  }
}

template <int C, typename Value>
void read_plain(const std::uint8_t* byte, int count, const Value& value, float* to) {
  for (int i = 0; i < count; ++i, byte += C, to += C) {
    for (int c = 0; c < C; ++c) to[c] = value(byte[c], c);
  }
}

template <typename Value>
void read_texels(const std::uint8_t* bytes, int channels, bool is_multiplied, int count,
                 const Value& value, float* to) {
  switch (channels) {
    case 1:
      return read_plain<1>(bytes, count, value, to);
    case 2:
      if (is_multiplied) return read_multiplied<2>(bytes, count, value, to);
      return read_plain<2>(bytes, count, value, to);
    case 3:
      return read_plain<3>(bytes, count, value, to);
    default:
      if (is_multiplied) return read_multiplied<4>(bytes, count, value, to);
      return read_plain<4>(bytes, count, value, to);
  }
}

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr ValueRange kEmptyRange = {kInfinity, -kInfinity};

ValueRange widened(const ValueRange& a, const ValueRange& b) {
  return {std::min(a.low, b.low), std::max(a.high, b.high)};
}

}  // namespace

FilteredImage::FilteredImage(const TexelSource& source, const FindRead& find_read,
                             const Options& options)
    : source_(source), floats_(source.floats()), alpha_(options.alpha.value_or(0)) {
  assert(!options.alpha || *options.alpha == source.channels - 1);
  if (source.has_bytes()) {
    const bool is_plain = !options.alpha || (options.stays_opaque && is_opaque(source, alpha_));
    if (options.is_read_by_rows || (!options.needs_floats && is_plain)) {
      floats_ = {nullptr, source.width, source.height, source.channels};
      has_shares_ = bytes_are_shares();
      is_multiplied_ = !is_plain;
      if (is_multiplied_) find_byte_colors(options);
      return;
    }
    copy_ = to_floats(source, options.run.threads());
    floats_ = copy_.view();
  } else {
    check(find_read, options);
  }
  if (options.alpha) multiply_by_alpha(find_read, options);
}

bool FilteredImage::bytes_are_shares() const {
  for (int c = 0; c < source_.channels; ++c) {
    for (int byte = 0; byte <= kOpaque; ++byte) {
      const float share = static_cast<float>(byte) / 255.0F;
      if (source_.value(static_cast<std::uint8_t>(byte), c) != share) return false;
    }
  }
  return true;
}

void FilteredImage::read(int y, int begin, int end, float* values) const {
  assert(floats_.data == nullptr);
  const std::uint8_t* const bytes = source_.byte_texel(begin, y);
  if (has_shares_ && !is_multiplied_) {
    const int count = (end - begin) * source_.channels;
    for (int i = 0; i < count; ++i) values[i] = static_cast<float>(bytes[i]) * kByteUnit;
  } else if (has_shares_) {
    const auto share = [](std::uint8_t byte, int) { return static_cast<float>(byte) * kByteUnit; };
    read_texels(bytes, source_.channels, is_multiplied_, end - begin, share, values);
  } else {
    const auto value = [this](std::uint8_t byte, int c) { return source_.value(byte, c); };
    read_texels(bytes, source_.channels, is_multiplied_, end - begin, value, values);
  }
}

// Finds the ranges of the colors that occur; byte values need not be increasing.
void FilteredImage::find_byte_colors(const Options& options) {
  using Seen = std::array<std::array<unsigned char, 256>, 3>;
  constexpr int kRows = 64;
  std::vector<Seen> parts(static_cast<std::size_t>(range_count(source_.height, kRows)));
  parallel_ranges(source_.height, kRows, options.run, [&](std::int64_t begin, std::int64_t end) {
    Seen& seen = parts[static_cast<std::size_t>(begin / kRows)];
    const std::uint8_t* texel = source_.byte_texel(0, static_cast<int>(begin));
    for (std::int64_t i = 0; i < (end - begin) * source_.width; ++i) {
      const unsigned char is_seen = texel[alpha_] != 0 ? 1 : 0;
      for (int c = 0; c < alpha_; ++c) seen[c][texel[c]] |= is_seen;
      texel += source_.channels;
    }
  });
  for (int c = 0; c < alpha_; ++c) {
    ValueRange& range = colors_[c];
    range = kEmptyRange;
    for (int byte = 0; byte <= kOpaque; ++byte) {
      const bool is_seen = std::any_of(parts.begin(), parts.end(),
                                       [&](const Seen& seen) { return seen[c][byte] != 0; });
      const float value = source_.value(static_cast<std::uint8_t>(byte), c);
      if (is_seen) range = widened(range, {value, value});
    }
    if (!(range.low <= range.high)) range = {0.0F, 0.0F};
  }
}

void FilteredImage::check(const FindRead& find_read, const Options& options) {
  if (all_filterable(floats_, options.run.part(0.0, 0.2))) return;
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
  std::vector<std::array<ValueRange, 3>> rows(static_cast<std::size_t>(copy.height));
  for (std::array<ValueRange, 3>& row : rows) row.fill(kEmptyRange);
  parallel_for(copy.height, options.run.part(0.8, 1.0), [&](std::int64_t row) {
    float* texel = copy.texel(0, static_cast<int>(row));
    const unsigned char* texel_read = read.data() + row * copy.width;
    for (int x = 0; x < copy.width; ++x, texel += copy.channels) {
      const float alpha = std::clamp(texel[alpha_], 0.0F, 1.0F);
      texel[alpha_] = alpha;
      for (int c = 0; c < alpha_; ++c) {
        ValueRange& seen = rows[row][c];
        if (alpha > 0.0F && texel_read[x] != 0) seen = widened(seen, {texel[c], texel[c]});
        texel[c] *= alpha;
      }
    }
  });
  colors_.fill(kEmptyRange);
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

void FilteredImage::divide_by_alpha(WrapModes wrap, const Run& run, Image* level) const {
  if (!is_multiplied_) return;
  // Colors below this alpha are invisible, and mostly rounding errors.
  constexpr float kMinVisibleAlpha = 1e-3F;
  std::vector<float> weights(level->view().texel_count());
  const Stages stages(run, {1, 1});
  parallel_for(level->height, stages[0], [&](std::int64_t row) {
    float* texel = level->texel(0, static_cast<int>(row));
    float* weight = weights.data() + row * level->width;
    for (int x = 0; x < level->width; ++x, texel += level->channels) {
      const float alpha = texel[alpha_];
      weight[x] = alpha > kMinVisibleAlpha ? alpha : 0.0F;
      for (int c = 0; c < alpha_; ++c) {
        const float color = weight[x] > 0.0F ? texel[c] / alpha : 0.0F;
        texel[c] = std::min(std::max(color, colors_[c].low), colors_[c].high);
      }
      texel[alpha_] = std::clamp(alpha, 0.0F, 1.0F);
    }
  });
  fill_holes(weights, wrap, alpha_, stages[1], level);
}

}  // namespace prefilter
