// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/compress_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Color = std::array<double, 4>;

Bytes random_texels(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  Bytes texels(static_cast<std::size_t>(4 * width * height));
  for (auto& value : texels) value = static_cast<std::uint8_t>(random() >> 24);
  return texels;
}

BlockOptions options_for(BlockFormat format) {
  BlockOptions options;
  options.format = format;
  return options;
}

Bytes compressed(const Bytes& texels, int width, int height, BlockFormat format, int threads = 1) {
  return compress_blocks(texels.data(), width, height, options_for(format),
                         prefilter::Run(threads));
}

/// Decodes texel `i` of a single-channel block, by the definition of BC4.
double decoded_channel(const std::uint8_t* block, int i) {
  const double low = block[0];
  const double high = block[1];
  std::uint64_t bits = 0;
  for (int byte = 0; byte < 6; ++byte) bits |= std::uint64_t{block[2 + byte]} << (8 * byte);
  const int index = static_cast<int>(bits >> (3 * i) & 7);
  if (index < 2) return index == 0 ? low : high;
  if (low > high) return ((8 - index) * low + (index - 1) * high) / 7;
  if (index >= 6) return index == 6 ? 0.0 : 255.0;
  return ((6 - index) * low + (index - 1) * high) / 5;
}

/// The least possible sum of squares of a single-channel block, over all pairs of endpoints.
double least_error(const Bytes& values) {
  double least = 1e30;
  for (int ends = 0; ends < 1 << 16; ++ends) {
    // Texel i has index i.
    const std::uint8_t block[8] = {static_cast<std::uint8_t>(ends & 255),
                                   static_cast<std::uint8_t>(ends >> 8),
                                   0x88,
                                   0xC6,
                                   0xFA,
                                   0,
                                   0,
                                   0};
    std::array<double, 8> palette;
    for (int i = 0; i < 8; ++i) palette[static_cast<std::size_t>(i)] = decoded_channel(block, i);
    double sum = 0.0;
    for (const int value : values) {
      double nearest = 1e30;
      for (const double found : palette) {
        nearest = std::min(nearest, (value - found) * (value - found));
      }
      sum += nearest;
      if (sum >= least) break;
    }
    least = std::min(least, sum);
  }
  return least;
}

/// Values for a single-channel block: a noisy slope, or two values with a few extremes.
Bytes channel_block(std::mt19937& random, int kind) {
  Bytes values(16);
  const int low = static_cast<int>(random() % 200);
  const int step = static_cast<int>(random() % 8);
  for (int i = 0; i < 16; ++i) {
    const int noise = static_cast<int>(random() % 8);
    int value = low + step * (i % 4) + noise;
    if (kind % 2 == 1) value = random() % 4 == 0 ? 255 * static_cast<int>(random() % 2) : value;
    values[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(std::min(value, 255));
  }
  return values;
}

/// The color of texel `i` in a BC1 block, by its definition.
Color decoded_color(const std::uint8_t* block, int i) {
  const auto end = [block](int at) {
    const int packed = block[at] | block[at + 1] << 8;
    return Color{(packed >> 11) * 255.0 / 31, (packed >> 5 & 63) * 255.0 / 63,
                 (packed & 31) * 255.0 / 31, 255.0};
  };
  const Color first = end(0);
  const Color second = end(2);
  const bool has_four = (block[0] | block[1] << 8) > (block[2] | block[3] << 8);
  const int index = block[4 + i / 4] >> (2 * (i % 4)) & 3;
  if (index < 2) return index == 0 ? first : second;
  if (!has_four && index == 3) return {0, 0, 0, 0};
  const double share = has_four ? (index - 1) / 3.0 : 0.5;
  Color mixed;
  for (int c = 0; c < 4; ++c) mixed[c] = (1 - share) * first[c] + share * second[c];
  return mixed;
}

constexpr BlockFormat kByteFormats[] = {BlockFormat::kBc1, BlockFormat::kBc1Rgb, BlockFormat::kBc3,
                                        BlockFormat::kBc4, BlockFormat::kBc5,    BlockFormat::kBc7};

TEST(CompressBlocks, WideImagesMatchTheirColumns) {
  // More blocks in a row than a task has.
  const int columns = 150;
  const Bytes texels = random_texels(4 * columns, 4, 7);
  const Bytes blocks = compressed(texels, 4 * columns, 4, BlockFormat::kBc4);
  ASSERT_EQ(blocks.size(), 8U * columns);
  for (int column = 0; column < columns; ++column) {
    Bytes part(64);
    for (int y = 0; y < 4; ++y) {
      std::copy_n(texels.begin() + 16 * (y * columns + column), 16, part.begin() + 16 * y);
    }
    const Bytes block = compressed(part, 4, 4, BlockFormat::kBc4);
    EXPECT_EQ(block, Bytes(blocks.begin() + 8 * column, blocks.begin() + 8 * column + 8));
  }
}

TEST(CompressBlocks, SizesCountBlocks) {
  const Bytes texels = random_texels(9, 6, 1);
  EXPECT_EQ(compressed(texels, 9, 6, BlockFormat::kBc1).size(), 6U * 8);
  EXPECT_EQ(compressed(texels, 9, 6, BlockFormat::kBc3).size(), 6U * 16);
  EXPECT_EQ(compressed(texels, 9, 6, BlockFormat::kBc4).size(), 6U * 8);
  EXPECT_EQ(compressed(texels, 9, 6, BlockFormat::kBc5).size(), 6U * 16);
  EXPECT_EQ(compressed(texels, 9, 6, BlockFormat::kBc1Rgb).size(), 6U * 8);
  EXPECT_EQ(compressed(texels, 9, 6, BlockFormat::kBc7).size(), 6U * 16);
  EXPECT_EQ(compressed(texels, 1, 1, BlockFormat::kBc1).size(), 8U);
}

TEST(CompressBlocks, AreTheSameForAnyNumberOfThreads) {
  const Bytes texels = random_texels(61, 87, 2);
  for (const auto format : kByteFormats) {
    const Bytes once = compressed(texels, 61, 87, format);
    for (const int threads : {0, 2, 5}) {
      EXPECT_EQ(compressed(texels, 61, 87, format, threads), once);
    }
  }
}

// libsquish alone has 1.41 to 2.05 times the error.
TEST(CompressBlocks, ChannelsAreNotFarFromTheClosestBlocks) {
  struct Case {
    BlockFormat format;
    std::size_t channel;
    std::size_t byte;
    int side;
  };
  const Case cases[] = {{BlockFormat::kBc4, 0, 0, 4},
                        {BlockFormat::kBc5, 1, 8, 4},
                        {BlockFormat::kBc3, 3, 0, 4},
                        {BlockFormat::kBc4, 0, 0, 3}};
  std::mt19937 random(11);
  for (const auto& [format, channel, byte, side] : cases) {
    double sum = 0.0;
    double least = 0.0;
    for (int kind = 0; kind < 8; ++kind) {
      const Bytes block = channel_block(random, kind);
      Bytes texels(static_cast<std::size_t>(4 * side * side));
      Bytes values;
      for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
          values.push_back(block[static_cast<std::size_t>(4 * y + x)]);
          texels[static_cast<std::size_t>(4 * (side * y + x)) + channel] = values.back();
        }
      }
      const Bytes found = compressed(texels, side, side, format);
      for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
          const double value = values[static_cast<std::size_t>(side * y + x)];
          const double off = value - decoded_channel(found.data() + byte, 4 * y + x);
          sum += off * off;
        }
      }
      least += least_error(values);
    }
    EXPECT_GE(sum, least * (1 - 1e-12));
    EXPECT_LE(sum, 1.35 * least) << static_cast<int>(format) << " " << side;
  }
}

// Two channels with eight steps each: the mean error is at most half a step.
TEST(CompressBlocks, ChannelsStayWithinHalfAStep) {
  const int width = 18;
  const int height = 7;
  const Bytes texels = random_texels(width, height, 3);
  const Bytes blocks = compressed(texels, width, height, BlockFormat::kBc5);
  for (int top = 0; top < height; top += 4) {
    for (int left = 0; left < width; left += 4) {
      const std::uint8_t* block = blocks.data() + 16 * (top / 4 * 5 + left / 4);
      for (int channel = 0; channel < 2; ++channel) {
        double sum = 0.0;
        int count = 0;
        int low = 255;
        int high = 0;
        for (int y = top; y < std::min(top + 4, height); ++y) {
          for (int x = left; x < std::min(left + 4, width); ++x) {
            const int value = texels[static_cast<std::size_t>(4 * (y * width + x) + channel)];
            const double found = decoded_channel(block + 8 * channel, 4 * (y - top) + x - left);
            sum += (found - value) * (found - value);
            ++count;
            low = std::min(low, value);
            high = std::max(high, value);
          }
        }
        EXPECT_LE(std::sqrt(sum / count), std::max(high - low, 7) / 14.0 + 1.0);
      }
    }
  }
}

TEST(CompressBlocks, KeepTwoColorsThatTheFormatHas) {
  // Endpoints are exact for multiples of 255 / 31 and 255 / 63.
  Bytes texels;
  for (int i = 0; i < 16; ++i) {
    const Bytes color = i % 3 == 0 ? Bytes{255, 0, 255, 255} : Bytes{0, 255, 0, 255};
    texels.insert(texels.end(), color.begin(), color.end());
  }
  for (const auto format : {BlockFormat::kBc1, BlockFormat::kBc1Rgb, BlockFormat::kBc3}) {
    const Bytes blocks = compressed(texels, 4, 4, format);
    const std::uint8_t* colors = blocks.data() + blocks.size() - 8;
    for (int i = 0; i < 16; ++i) {
      for (int c = 0; c < 4; ++c) {
        EXPECT_NEAR(decoded_color(colors, i)[c], texels[static_cast<std::size_t>(4 * i + c)], 1e-9);
      }
    }
  }
}

TEST(CompressBlocks, TransparentTexelsOfBc1AreBlackAndOthersOpaque) {
  Bytes texels = random_texels(4, 4, 5);
  for (std::size_t i = 0; i < 16; ++i) texels[4 * i + 3] = i < 6 ? 127 : 128;
  const Bytes block = compressed(texels, 4, 4, BlockFormat::kBc1);
  for (int i = 0; i < 16; ++i) {
    EXPECT_EQ(decoded_color(block.data(), i)[3], i < 6 ? 0.0 : 255.0);
  }
}

TEST(CompressBlocks, TexelsOfBc1RgbAreOpaqueWhateverTheirAlpha) {
  Bytes texels = random_texels(13, 9, 8);
  const Bytes blocks = compressed(texels, 13, 9, BlockFormat::kBc1Rgb);
  for (std::size_t i = 3; i < texels.size(); i += 4) texels[i] = 255;
  EXPECT_EQ(compressed(texels, 13, 9, BlockFormat::kBc1Rgb), blocks);
  for (std::size_t block = 0; block < blocks.size(); block += 8) {
    for (int i = 0; i < 16; ++i)
      EXPECT_NEAR(decoded_color(blocks.data() + block, i)[3], 255.0, 1e-9);
  }
}

// Four texels at a corner have the same best colors as a whole block with each of them four times.
TEST(CompressBlocks, TexelsBeyondTheEdgeDoNotCount) {
  const Bytes corner = random_texels(2, 2, 7);
  Bytes whole;
  for (int i = 0; i < 16; ++i) {
    const auto texel = corner.begin() + 4 * (i / 4 % 2 * 2 + i % 2);
    whole.insert(whole.end(), texel, texel + 4);
  }
  const Bytes alone = compressed(corner, 2, 2, BlockFormat::kBc3);
  const Bytes tiled = compressed(whole, 4, 4, BlockFormat::kBc3);
  for (const int i : {0, 1, 4, 5}) {
    EXPECT_EQ(decoded_color(alone.data() + 8, i), decoded_color(tiled.data() + 8, i));
    EXPECT_EQ(decoded_channel(alone.data(), i), decoded_channel(tiled.data(), i));
  }
}

TEST(CompressBlocks, WeighColorsByAlpha) {
  // Colors on no common line, so that one can only be matched at the cost of the others.
  Bytes texels;
  for (int i = 0; i < 16; ++i) {
    const Bytes color = i < 4    ? Bytes{255, 0, 0, 255}
                        : i < 10 ? Bytes{0, 255, 0, 0}
                                 : Bytes{0, 0, 255, 0};
    texels.insert(texels.end(), color.begin(), color.end());
  }
  const auto error_of_opaque = [&texels](bool weigh) {
    BlockOptions options = options_for(BlockFormat::kBc3);
    options.weigh_by_alpha = weigh;
    const Bytes blocks = compress_blocks(texels.data(), 4, 4, options, prefilter::Run(1));
    double sum = 0.0;
    for (int i = 0; i < 4; ++i) {
      const Color found = decoded_color(blocks.data() + 8, i);
      for (int c = 0; c < 3; ++c) {
        sum += std::pow(found[c] - texels[static_cast<std::size_t>(4 * i + c)], 2);
      }
    }
    return sum;
  };
  EXPECT_LT(error_of_opaque(true), 0.1 * error_of_opaque(false));
}

TEST(CompressBlocks, RefusesTexelsOfAnotherKind) {
  const Bytes bytes(64);
  const std::vector<HalfBits> halves(64);
  EXPECT_THROW(compressed(bytes, 4, 4, BlockFormat::kBc6h), Error);
  EXPECT_THROW(
      compress_blocks(halves.data(), 4, 4, options_for(BlockFormat::kBc7), prefilter::Run(1)),
      Error);
}

TEST(CompressBlocks, RefusesEmptyImages) {
  EXPECT_THROW(compressed({}, 0, 4, BlockFormat::kBc1), Error);
  EXPECT_THROW(compressed({}, 4, 0, BlockFormat::kBc1), Error);
}

TEST(CompressBlocks, CanBeCancelled) {
  const Bytes texels = random_texels(64, 64, 6);
  const prefilter::Run stop([](double) { return false; });
  try {
    compress_blocks(texels.data(), 64, 64, options_for(BlockFormat::kBc1), stop);
    FAIL() << "was not cancelled";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kCancelled);
  }
}

}  // namespace
}  // namespace prefilter
