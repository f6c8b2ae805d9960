// SPDX-License-Identifier: GPL-3.0-or-later

// BC7 and BC6H, decoded by bcdec, which is independent of the encoders.
#define BCDEC_STATIC
#define BCDEC_IMPLEMENTATION
#include <bcdec.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <random>

#include "prefilter/base/error.h"
#include "prefilter/textures/compress_blocks.h"

namespace prefilter {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Halves = std::vector<HalfBits>;

constexpr HalfBits kLargestHalf = 0x7bff;  // 65504
constexpr HalfBits kHalfOne = 0x3c00;
constexpr HalfBits kMinus = 0x8000;

BlockOptions options_of(BlockFormat format) {
  BlockOptions options;
  options.format = format;
  return options;
}

/// RGBA of the texels inside, row by row. `decode` writes a block's texels with the given number of
/// channels; alpha is 0 for three.
template <class Channel>
std::vector<Channel> decoded(const Bytes& blocks, int width, int height, int channels,
                             const std::function<void(const std::uint8_t*, Channel*)>& decode) {
  std::vector<Channel> texels(static_cast<std::size_t>(4 * width * height));
  const int columns = (width + 3) / 4;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::array<Channel, 64> block;
      decode(blocks.data() + 16 * (y / 4 * columns + x / 4), block.data());
      const auto* texel = block.data() + channels * (4 * (y % 4) + x % 4);
      std::copy_n(texel, channels, texels.begin() + 4 * (y * width + x));
    }
  }
  return texels;
}

Bytes through_bc7(const Bytes& texels, int width, int height) {
  const Bytes blocks = compress_blocks(texels.data(), width, height, options_of(BlockFormat::kBc7),
                                       prefilter::Run(1));
  return decoded<std::uint8_t>(
      blocks, width, height, 4,
      [](const std::uint8_t* block, std::uint8_t* out) { bcdec_bc7(block, out, 16); });
}

Halves through_bc6h(const Halves& texels, int width, int height) {
  const Bytes blocks = compress_blocks(texels.data(), width, height, options_of(BlockFormat::kBc6h),
                                       prefilter::Run(1));
  return decoded<HalfBits>(blocks, width, height, 3, [](const std::uint8_t* block, HalfBits* out) {
    bcdec_bc6h_half(block, out, 12, 0);
  });
}

/// The rank of a half float among all; neighbors differ by 1.
int rank_of(HalfBits half) { return half & kMinus ? -(half & 0x7fff) : half; }

double rms_error(const Bytes& found, const Bytes& wanted, int first, int end) {
  double sum = 0.0;
  for (std::size_t i = 0; i < wanted.size(); i += 4) {
    for (int c = first; c < end; ++c) {
      const auto at = i + static_cast<std::size_t>(c);
      sum += std::pow(found[at] - wanted[at], 2);
    }
  }
  return std::sqrt(sum / (static_cast<double>(wanted.size()) / 4 * (end - first)));
}

/// Different waves in each channel, which no line of colors can follow.
double wave(int x, int y, int c) {
  return std::sin(0.08 * x + 0.4 * c) * std::cos(0.06 * y + 0.9 * c);
}

Bytes waves_of_bytes(int width, int height, bool has_alpha) {
  Bytes texels;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 4; ++c) {
        const double value = c == 3 && !has_alpha ? 255.0 : 127.5 + 120 * wave(x, y, c);
        texels.push_back(static_cast<std::uint8_t>(std::lround(value)));
      }
    }
  }
  return texels;
}

TEST(Bc7, IsWithinAFewSteps) {
  for (const bool has_alpha : {false, true}) {
    const Bytes texels = waves_of_bytes(37, 22, has_alpha);
    const Bytes found = through_bc7(texels, 37, 22);
    EXPECT_LT(rms_error(found, texels, 0, 3), has_alpha ? 3.0 : 2.0);
    EXPECT_LT(rms_error(found, texels, 3, 4), has_alpha ? 3.0 : 1e-9);
  }
}

TEST(Bc7, OpaqueTexelsStayOpaque) {
  std::mt19937 random(2);
  Bytes noise(4 * 64 * 64);
  for (auto& value : noise) value = static_cast<std::uint8_t>(random() >> 24);
  Bytes slope = noise;
  for (std::size_t i = 0; i < slope.size(); ++i) {
    slope[i] = static_cast<std::uint8_t>(noise[i / 4096 % 7 * 4 + i % 4] + i / 4 % 64);
  }
  for (Bytes texels : {noise, slope}) {
    for (std::size_t i = 3; i < texels.size(); i += 4) texels[i] = 255;
    const Bytes found = through_bc7(texels, 64, 64);
    for (std::size_t i = 3; i < texels.size(); i += 4) ASSERT_EQ(found[i], 255) << i / 4;
  }
}

TEST(Bc7, FlatBlocksAreExact) {
  std::mt19937 random(1);
  for (int i = 0; i < 50; ++i) {
    Bytes texel;
    for (int c = 0; c < 4; ++c) texel.push_back(static_cast<std::uint8_t>(random() >> 24));
    if (i % 2 == 0) texel[3] = 255;
    Bytes texels;
    for (int k = 0; k < 15; ++k) texels.insert(texels.end(), texel.begin(), texel.end());
    const Bytes found = through_bc7(texels, 3, 5);
    for (std::size_t k = 0; k < texels.size(); ++k) EXPECT_NEAR(found[k], texels[k], 1);
  }
}

TEST(Bc7, TakesOneTexelAndOddSides) {
  for (const auto& [width, height] : {std::pair(1, 1), {5, 7}, {1, 9}, {257, 1}}) {
    const Bytes texels = waves_of_bytes(width, height, true);
    EXPECT_LT(rms_error(through_bc7(texels, width, height), texels, 0, 4), 3.0);
  }
}

/// Brightness from 2^-8 to 2^8 in waves, as half floats.
Halves waves_of_halves(int width, int height) {
  Halves texels;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 4; ++c) {
        texels.push_back(static_cast<HalfBits>(kHalfOne + std::lround(8 * 1024 * wave(x, y, c))));
      }
    }
  }
  return texels;
}

TEST(Bc6h, FollowsBrightnessOverManyPowersOfTwo) {
  const Halves texels = waves_of_halves(37, 22);
  const Halves found = through_bc6h(texels, 37, 22);
  double sum = 0.0;
  for (std::size_t i = 0; i < texels.size(); ++i) {
    if (i % 4 < 3) sum += std::pow(rank_of(found[i]) - rank_of(texels[i]), 2);
  }
  // A step of 1024 is a factor of two.
  EXPECT_LT(std::sqrt(sum / (37.0 * 22 * 3)), 128.0);
}

TEST(Bc6h, FlatBlocksAreWithinAFractionOfAPercent) {
  for (const HalfBits value :
       {HalfBits{0}, HalfBits{1}, HalfBits{0x1234}, kHalfOne, HalfBits{0x5678}, kLargestHalf}) {
    const Halves texels(4 * 35, value);
    const Halves found = through_bc6h(texels, 5, 7);
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (i % 4 == 3) continue;
      EXPECT_NEAR(rank_of(found[i]), rank_of(value), 4) << value;
    }
  }
}

TEST(Bc6h, NegativeTexelsBecomeZero) {
  const Halves found = through_bc6h(Halves(4, kMinus | kHalfOne), 1, 1);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(found[c], 0);
}

// A block with the brightest and the darkest half float has finite texels only.
TEST(Bc6h, ExtremesStayFinite) {
  std::mt19937 random(3);
  Halves texels(4 * 64 * 16);
  const std::array<HalfBits, 4> values = {0, 1, kHalfOne, kLargestHalf};
  for (auto& value : texels) value = values[random() % 4] | (random() % 2 ? kMinus : HalfBits{0});
  for (const HalfBits found : through_bc6h(texels, 64, 16)) {
    EXPECT_LE(found & 0x7fff, kLargestHalf);
  }
}

TEST(Bc6h, IsTheSameForAnyNumberOfThreads) {
  const Halves texels = waves_of_halves(301, 9);
  const Bytes once =
      compress_blocks(texels.data(), 301, 9, options_of(BlockFormat::kBc6h), prefilter::Run(1));
  for (const int threads : {0, 2, 5}) {
    EXPECT_EQ(compress_blocks(texels.data(), 301, 9, options_of(BlockFormat::kBc6h),
                              prefilter::Run(threads)),
              once);
  }
}

TEST(Bc6h, CanBeCancelled) {
  const Halves texels = waves_of_halves(64, 64);
  const prefilter::Run stop([](double) { return false; });
  EXPECT_THROW(compress_blocks(texels.data(), 64, 64, options_of(BlockFormat::kBc6h), stop), Error);
}

}  // namespace
}  // namespace prefilter
