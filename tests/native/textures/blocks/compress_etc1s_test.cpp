// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/compress_etc1s.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "prefilter/base/error.h"
#include "prefilter/textures/decode_blocks.h"

namespace prefilter {
namespace {

using Bytes = std::vector<std::uint8_t>;

struct Image {
  int width;
  int height;
  Bytes rgba;
};

/// Gray waves with noise, and different waves of alpha.
Image waves(int width, int height) {
  std::mt19937 random(7);
  Image image{width, height, Bytes(std::size_t{4} * static_cast<std::size_t>(width * height))};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double value = 128.0 + 90.0 * std::sin(0.2 * x) * std::cos(0.13 * y);
      std::uint8_t* texel = image.rgba.data() + 4 * (std::ptrdiff_t{y} * width + x);
      const auto noise = static_cast<double>(random() % 8);
      std::fill_n(texel, 3, static_cast<std::uint8_t>(value + noise));
      texel[3] = static_cast<std::uint8_t>(8 * x);
    }
  }
  return image;
}

Etc1sTexture compressed(const std::vector<Image>& levels, const Etc1sOptions& options,
                        const prefilter::Run& run = prefilter::Run()) {
  std::vector<Etc1sImage> images;
  for (const Image& level : levels) {
    images.push_back({level.rgba.data(), level.width, level.height});
  }
  return compress_etc1s(images, options, run);
}

std::vector<Bytes> decoded(const Etc1sTexture& texture, const std::vector<Image>& levels) {
  std::vector<Etc1sLevel> parts;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    parts.push_back(
        {levels[i].width, levels[i].height, texture.levels[i].color, texture.levels[i].alpha});
  }
  return decode_etc1s({texture.endpoint_count, texture.selector_count, texture.endpoints,
                       texture.selectors, texture.tables},
                      parts, prefilter::Run());
}

TEST(CompressEtc1s, GivesBackColorsAndAlphaOfAllLevels) {
  const std::vector<Image> levels = {waves(32, 30), waves(16, 15), waves(1, 1)};
  Etc1sOptions options;
  options.has_alpha = true;
  const std::vector<Bytes> found = decoded(compressed(levels, options), levels);
  ASSERT_EQ(found.size(), levels.size());
  for (std::size_t i = 0; i < levels.size(); ++i) {
    ASSERT_EQ(found[i].size(), levels[i].rgba.size());
    for (std::size_t channel = 0; channel < 4; ++channel) {
      double error = 0.0;
      for (std::size_t at = channel; at < found[i].size(); at += 4) {
        error += std::abs(double{1} * found[i][at] - levels[i].rgba[at]);
      }
      EXPECT_LT(4.0 * error / static_cast<double>(found[i].size()), 6.0) << i << " " << channel;
    }
  }
}

TEST(CompressEtc1s, KeepsAlphaOnlyWhereItIsAskedTo) {
  const std::vector<Image> levels = {waves(8, 8)};
  const Etc1sTexture texture = compressed(levels, {});
  EXPECT_TRUE(texture.levels[0].alpha.empty());
  const std::vector<Bytes> found = decoded(texture, levels);
  for (std::size_t at = 3; at < found[0].size(); at += 4) EXPECT_EQ(found[0][at], 255);
}

TEST(CompressEtc1s, RepeatsTexelsAtEdges) {
  // Texels beyond an edge must not affect a single-color block.
  const Image image{5, 6, Bytes(std::size_t{4} * 5 * 6, 132)};
  const std::vector<Bytes> found = decoded(compressed({image}, {}), {image});
  for (const std::uint8_t value : found[0]) {
    EXPECT_TRUE(value == 255 || value == 132) << int{value};
  }
}

TEST(CompressEtc1s, DoesNotDependOnThreads) {
  const std::vector<Image> levels = {waves(200, 120)};
  Etc1sOptions options;
  const Etc1sTexture one = compressed(levels, options, prefilter::Run(1));
  const Etc1sTexture five = compressed(levels, options, prefilter::Run(5));
  EXPECT_EQ(one.endpoints, five.endpoints);
  EXPECT_EQ(one.selectors, five.selectors);
  EXPECT_EQ(one.tables, five.tables);
  EXPECT_EQ(one.levels[0].color, five.levels[0].color);
}

TEST(CompressEtc1s, RefusesInvalidSettings) {
  const std::vector<Image> levels = {waves(4, 4)};
  EXPECT_THROW(compressed({}, {}), Error);
  EXPECT_THROW(compressed({Image{0, 4, {}}}, {}), Error);
  for (const int quality : {kMinEtc1sQuality - 1, kMaxEtc1sQuality + 1}) {
    Etc1sOptions options;
    options.quality = quality;
    EXPECT_THROW(compressed(levels, options), Error);
  }
  EXPECT_THROW(compressed(levels, {}, prefilter::Run([](double) { return false; })), Error);
  const std::uint8_t texel[4] = {};
  const std::vector<Etc1sImage> huge = {{texel, 1 << 20, 1 << 20}};
  EXPECT_THROW(compress_etc1s(huge, {}, prefilter::Run()), Error);
}

/// A selector codebook whose table has a code for one symbol only, bit by bit: three flags, the
/// numbers of symbols and lengths, the length in the order of the format, and the symbol.
Bytes selectors_of_one_symbol(int code_length) {
  const std::vector<int> order = {17, 18, 19, 20, 0, 8, 7, 9, 6, 10, 5, 11};
  const auto place = std::find(order.begin(), order.end(), code_length) - order.begin();
  const auto count = static_cast<std::uint64_t>(order.size());
  const std::uint64_t bits =
      1 << 3 | count << (3 + 14) | std::uint64_t{1} << (3 + 14 + 5 + 3 * place);
  Bytes bytes;
  for (int i = 0; i < 64; i += 8) bytes.push_back(static_cast<std::uint8_t>(bits >> i));
  return bytes;
}

TEST(DecodeEtc1s, RefusesLongCodesOfOneSymbol) {
  const std::vector<Image> levels = {waves(32, 32)};
  Etc1sTexture texture = compressed(levels, {});
  for (const int length : {9, 10}) {
    texture.selectors = selectors_of_one_symbol(length);
    EXPECT_NO_THROW(decoded(texture, levels)) << length;
  }
  texture.selectors = selectors_of_one_symbol(11);
  EXPECT_THROW(decoded(texture, levels), Error);
}

}  // namespace
}  // namespace prefilter
