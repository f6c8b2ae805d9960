// SPDX-License-Identifier: GPL-3.0-or-later

// The gain from higher effort, and the search of ETC2's modes on blocks that it should recover.
#include "prefilter/textures/block_effort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/textures/blocks/encoders.h"
#include "prefilter/textures/compress_blocks.h"
#include "prefilter/textures/decode_blocks.h"

namespace prefilter {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr int kSide = 68;  // more texels than in a coarse level
constexpr BlockEffort kEfforts[] = {BlockEffort::kFast, BlockEffort::kNormal, BlockEffort::kBest};
constexpr BlockFormat kFormats[] = {
    BlockFormat::kBc1Rgb,  BlockFormat::kBc3,     BlockFormat::kBc4,      BlockFormat::kBc5,
    BlockFormat::kBc7,     BlockFormat::kEtc2Rgb, BlockFormat::kEtc2Rgba, BlockFormat::kAstc4x4,
    BlockFormat::kAstc6x6, BlockFormat::kUastc};

Bytes compressed(const Bytes& texels, int width, int height, BlockFormat format, BlockEffort effort,
                 int threads = 1) {
  BlockOptions options;
  options.format = format;
  options.effort = effort;
  return compress_blocks(texels.data(), width, height, options, prefilter::Run(threads));
}

Bytes decoded(const Bytes& blocks, int width, int height, BlockFormat format) {
  DecodeOptions options;
  options.format = format;
  return decode_blocks(blocks, width, height, options, prefilter::Run(1));
}

/// The sum of squares over the first channels.
double error(const Bytes& found, const Bytes& wanted, int channels) {
  double sum = 0.0;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (static_cast<int>(i % 4) < channels) sum += std::pow(found[i] - wanted[i], 2);
  }
  return sum;
}

int channels_of(BlockFormat format) {
  if (format == BlockFormat::kBc4) return 1;
  if (format == BlockFormat::kBc5) return 2;
  return format == BlockFormat::kBc3 || format == BlockFormat::kEtc2Rgba ? 4 : 3;
}

/// Waves with noise, as in a coarse level; alpha is 255 or noise.
Bytes coarse_level(int width, int height, bool has_alpha, unsigned seed) {
  std::mt19937 random(seed);
  Bytes texels;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 4; ++c) {
        const double wave = 90.0 * std::sin(0.5 * x + c) * std::cos(0.4 * y - c);
        const double noise = static_cast<double>(random() % 61) - 30.0;
        const double value = c == 3 && !has_alpha ? 255.0 : 127.5 + wave + noise;
        texels.push_back(static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0))));
      }
    }
  }
  return texels;
}

TEST(BlockEffort, MoreComesCloser) {
  const Bytes texels = coarse_level(kSide, kSide, false, 1);
  for (const BlockFormat format : kFormats) {
    double before = INFINITY;
    for (const BlockEffort effort : kEfforts) {
      const Bytes blocks = compressed(texels, kSide, kSide, format, effort);
      const double now = error(decoded(blocks, kSide, kSide, format), texels, channels_of(format));
      EXPECT_LE(now, before) << layout_of(format).name << ' ' << static_cast<int>(effort);
      before = now;
    }
  }
}

TEST(BlockEffort, FastIsAnotherSearch) {
  const Bytes texels = coarse_level(kSide, kSide, false, 2);
  for (const BlockFormat format : kFormats) {
    EXPECT_NE(compressed(texels, kSide, kSide, format, BlockEffort::kFast),
              compressed(texels, kSide, kSide, format, BlockEffort::kBest))
        << layout_of(format).name;
  }
}

Bytes encoded(ByteEncoder* encoder, const Bytes& block) {
  Bytes found(16);
  encoder->encode({block.data(), 1, 4, 4}, found.data());
  return found;
}

TEST(BlockEffort, NormalBc7StopsWhereItIsClose) {
  const auto one = make_bc7f_encoder(BlockEffort::kNormal);
  const auto other = make_bc7enc_encoder(BlockEffort::kNormal);
  const auto chosen = make_bc7_encoder(BlockEffort::kNormal);
  const auto error_of = [](const Bytes& block, const Bytes& texels) {
    return error(decoded(block, 4, 4, BlockFormat::kBc7), texels, 4);
  };
  std::mt19937 random(7);
  int close = 0, left = 0, improved = 0;
  for (int i = 0; i < 400; ++i) {
    // A slope in a direction of its own, with noise of up to 7 steps.
    Bytes texels;
    const int noise = static_cast<int>(random() % 8);
    for (int k = 0; k < 64; ++k) {
      const int slope = (i % 7) * (k / 4 % 4) + (i % 5) * (k / 16) * (k % 4);
      const int value = 90 + slope + static_cast<int>(random() % (noise + 1));
      texels.push_back(static_cast<std::uint8_t>(k % 4 == 3 ? 255 : value));
    }
    const Bytes first = encoded(one.get(), texels);
    const Bytes second = encoded(other.get(), texels);
    const Bytes found = encoded(chosen.get(), texels);
    const double before = error_of(first, texels);
    if (before <= 32.0) {
      EXPECT_EQ(found, first);
      ++close;
      if (error_of(second, texels) < before) ++left;
    } else {
      EXPECT_EQ(error_of(found, texels), std::min(before, error_of(second, texels)));
      if (error_of(second, texels) < before) ++improved;
    }
  }
  // Both cases occur.
  EXPECT_GT(close, left);
  EXPECT_GT(left, 0);
  EXPECT_GT(improved, 0);
}

TEST(BlockEffort, OpaqueTexelsOfBc7StayOpaque) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    const Bytes texels = coarse_level(kSide, kSide, false, seed);
    for (const BlockEffort effort : kEfforts) {
      const Bytes blocks = compressed(texels, kSide, kSide, BlockFormat::kBc7, effort);
      const Bytes found = decoded(blocks, kSide, kSide, BlockFormat::kBc7);
      for (std::size_t i = 3; i < found.size(); i += 4) ASSERT_EQ(found[i], 255);
    }
  }
}

TEST(BlockEffort, OneColorIsNeverFarOff) {
  for (const BlockEffort effort : kEfforts) {
    for (const int value : {0, 1, 77, 128, 254, 255}) {
      Bytes texels;
      for (int i = 0; i < 16; ++i) {
        for (const int c : {value, 255 - value, value / 2, 255}) {
          texels.push_back(static_cast<std::uint8_t>(c));
        }
      }
      const Bytes of_bc7 =
          decoded(compressed(texels, 4, 4, BlockFormat::kBc7, effort), 4, 4, BlockFormat::kBc7);
      EXPECT_LE(error(of_bc7, texels, 4), 16.0 * 3) << value;
      const Bytes of_etc2 = decoded(compressed(texels, 4, 4, BlockFormat::kEtc2Rgb, effort), 4, 4,
                                    BlockFormat::kEtc2Rgb);
      EXPECT_LE(error(of_etc2, texels, 3), 16.0 * 3 * 9) << value;
    }
  }
}

// Single-color images, including edge blocks with only a few texels.
TEST(BlockEffort, FlatLevelsStayFlat) {
  constexpr int kWidth = 7, kHeight = 6;
  std::mt19937 random(7);
  for (int i = 0; i < 300; ++i) {
    const std::array<int, 4> color = {static_cast<int>(random() % 256),
                                      static_cast<int>(random() % 256),
                                      static_cast<int>(random() % 256), 255};
    Bytes texels;
    for (int t = 0; t < kWidth * kHeight; ++t) {
      for (const int c : color) texels.push_back(static_cast<std::uint8_t>(c));
    }
    for (const BlockEffort effort : kEfforts) {
      const Bytes found =
          decoded(compressed(texels, kWidth, kHeight, BlockFormat::kEtc2Rgb, effort), kWidth,
                  kHeight, BlockFormat::kEtc2Rgb);
      for (std::size_t t = 4; t < found.size(); ++t) ASSERT_EQ(found[t], found[t - 4]) << i;
    }
  }
}

TEST(BlockEffort, BlocksDoNotDependOnThreads) {
  const Bytes texels = coarse_level(70, 21, true, 3);
  for (const BlockFormat format : {BlockFormat::kBc7, BlockFormat::kEtc2Rgba}) {
    for (const BlockEffort effort : kEfforts) {
      EXPECT_EQ(compressed(texels, 70, 21, format, effort, 3),
                compressed(texels, 70, 21, format, effort));
    }
  }
}

// Texels beyond the edge do not count: blocks of a 3 x 2 level are as close as any others.
TEST(BlockEffort, TexelsInsideAreWhatCounts) {
  const Bytes texels = coarse_level(3, 2, false, 4);
  for (const BlockFormat format : {BlockFormat::kBc7, BlockFormat::kEtc2Rgb}) {
    double before = INFINITY;
    for (const BlockEffort effort : kEfforts) {
      const Bytes found = decoded(compressed(texels, 3, 2, format, effort), 3, 2, format);
      EXPECT_LE(error(found, texels, 3), before);
      before = error(found, texels, 3);
    }
  }
}

TEST(BlockEffort, CoarseLevelsGetTheBestByDefault) {
  const auto same = [](int width, int height, BlockEffort one, BlockEffort other) {
    const Bytes texels = coarse_level(width, height, false, 5);
    return compressed(texels, width, height, BlockFormat::kEtc2Rgb, one) ==
           compressed(texels, width, height, BlockFormat::kEtc2Rgb, other);
  };
  EXPECT_TRUE(same(128, 32, BlockEffort::kNormal, BlockEffort::kBest));
  EXPECT_FALSE(same(128, 32, BlockEffort::kNormal, BlockEffort::kFast));
  EXPECT_TRUE(same(128, 36, BlockEffort::kNormal, BlockEffort::kFast));
}

TEST(BlockEffort, NamesAreChecked) {
  EXPECT_EQ(block_effort_named("fast"), BlockEffort::kFast);
  EXPECT_EQ(block_effort_named("best"), BlockEffort::kBest);
  EXPECT_THROW(block_effort_named("slow"), Error);
  EXPECT_THROW(block_effort_named(""), Error);
}

/// Random blocks, in which five bits of red, green or blue and their step select the mode.
Bytes random_etc2(int count, unsigned seed) {
  std::mt19937 random(seed);
  Bytes blocks;
  for (int i = 0; i < 8 * count; ++i) blocks.push_back(static_cast<std::uint8_t>(random()));
  return blocks;
}

enum class EtcMode { kIndividual, kDifferential, kT, kH, kPlanar };

EtcMode mode_of(const std::uint8_t* block) {
  if ((block[3] & 2) == 0) return EtcMode::kIndividual;
  const auto leaves = [](int byte) {
    const int step = byte & 7;
    const int sum = (byte >> 3) + (step >= 4 ? step - 8 : step);
    return sum < 0 || sum > 31;
  };
  if (leaves(block[0])) return EtcMode::kT;
  if (leaves(block[1])) return EtcMode::kH;
  return leaves(block[2]) ? EtcMode::kPlanar : EtcMode::kDifferential;
}

// The texels of any ETC2 block can be encoded exactly. For random blocks of each mode, decoded by
// etcpak, the search recovers most of them and comes close to the others.
TEST(Etc2Search, FindsBlocksAgain) {
  constexpr int kBlocks = 1200;
  const Bytes blocks = random_etc2(kBlocks, 6);
  std::array<int, 5> counts{};
  std::array<int, 5> exact{};
  std::array<double, 5> errors{};
  for (int i = 0; i < kBlocks; ++i) {
    const Bytes block(blocks.begin() + 8 * i, blocks.begin() + 8 * (i + 1));
    const Bytes texels = decoded(block, 4, 4, BlockFormat::kEtc2Rgb);
    const Bytes again = compressed(texels, 4, 4, BlockFormat::kEtc2Rgb, BlockEffort::kBest);
    const double off = error(decoded(again, 4, 4, BlockFormat::kEtc2Rgb), texels, 3);
    const auto mode = static_cast<std::size_t>(mode_of(block.data()));
    ++counts[mode];
    exact[mode] += off == 0.0 ? 1 : 0;
    errors[mode] += off;
  }
  constexpr double kExactAtLeast[] = {0.5, 0.75, 0.85, 0.6, 1.0};
  constexpr double kSquareAtMost[] = {32.0, 7.0, 6.0, 28.0, 0.0};
  for (std::size_t mode = 0; mode < 5; ++mode) {
    ASSERT_GT(counts[mode], 20) << mode;
    EXPECT_GE(exact[mode], kExactAtLeast[mode] * counts[mode]) << mode;
    EXPECT_LE(errors[mode] / (48 * counts[mode]), kSquareAtMost[mode]) << mode;
  }
}

}  // namespace
}  // namespace prefilter
