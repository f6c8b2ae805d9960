// SPDX-License-Identifier: GPL-3.0-or-later

#include <astcenc.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "prefilter/base/error.h"
#include "prefilter/textures/compress_blocks.h"
#include "prefilter/textures/supercompress.h"

namespace prefilter {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Halves = std::vector<HalfBits>;

constexpr BlockFormat kOfBytes[] = {
    BlockFormat::kEtc2Rgb, BlockFormat::kEtc2Rgba, BlockFormat::kEacR11,  BlockFormat::kEacRg11,
    BlockFormat::kAstc4x4, BlockFormat::kAstc6x6,  BlockFormat::kAstc8x8, BlockFormat::kUastc};
constexpr BlockFormat kOfFloats[] = {BlockFormat::kAstc4x4Hdr, BlockFormat::kAstc6x6Hdr};

BlockOptions mobile_options(BlockFormat format) {
  BlockOptions options;
  options.format = format;
  return options;
}

template <class Channel>
std::vector<Channel> random_texels(int width, int height, unsigned largest, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Channel> texels(static_cast<std::size_t>(4 * width * height));
  for (auto& value : texels) value = static_cast<Channel>(random() % (largest + 1));
  return texels;
}

template <class Channel>
Bytes compressed(const std::vector<Channel>& texels, int width, int height, BlockFormat format,
                 int threads = 1) {
  return compress_blocks(texels.data(), width, height, mobile_options(format),
                         prefilter::Run(threads));
}

/// HDR blocks decoded by astcenc.
std::vector<float> decoded_mobile(Bytes blocks, int width, int height, BlockFormat format) {
  const auto side = static_cast<unsigned>(layout_of(format).columns);
  astcenc_config config{};
  astcenc_config_init(ASTCENC_PRF_HDR_RGB_LDR_A, side, side, 1, ASTCENC_PRE_FASTEST,
                      ASTCENC_FLG_DECOMPRESS_ONLY, &config);
  astcenc_context* context = nullptr;
  astcenc_context_alloc(&config, 1, &context, nullptr);
  std::vector<float> texels(static_cast<std::size_t>(4 * width * height));
  void* data = texels.data();
  astcenc_image image{static_cast<unsigned>(width), static_cast<unsigned>(height), 1,
                      ASTCENC_TYPE_F32, &data};
  const astcenc_swizzle kept{ASTCENC_SWZ_R, ASTCENC_SWZ_G, ASTCENC_SWZ_B, ASTCENC_SWZ_A};
  EXPECT_EQ(astcenc_decompress_image(context, blocks.data(), blocks.size(), &image, &kept, 0),
            ASTCENC_SUCCESS);
  astcenc_context_free(context);
  return texels;
}

/// A power of two from 2^-14 to 2^15 as a half float.
HalfBits power_of_two(int exponent) { return static_cast<HalfBits>((exponent + 15) << 10); }

TEST(MobileBlocks, SizesCountBlocks) {
  const Bytes texels = random_texels<std::uint8_t>(9, 13, 255, 1);
  for (const BlockFormat format : kOfBytes) {
    const BlockLayout& layout = layout_of(format);
    const int columns = (9 + layout.columns - 1) / layout.columns;
    const int rows = (13 + layout.rows - 1) / layout.rows;
    EXPECT_EQ(compressed(texels, 9, 13, format).size(),
              static_cast<std::size_t>(columns * rows * layout.bytes))
        << layout.name;
  }
}

TEST(MobileBlocks, AreTheSameForAnyNumberOfThreads) {
  const Bytes bytes = random_texels<std::uint8_t>(71, 29, 255, 2);
  for (const BlockFormat format : kOfBytes) {
    EXPECT_EQ(compressed(bytes, 71, 29, format, 3), compressed(bytes, 71, 29, format))
        << layout_of(format).name;
  }
  const Halves halves = random_texels<HalfBits>(71, 29, 0x7bff, 3);
  for (const BlockFormat format : kOfFloats) {
    EXPECT_EQ(compressed(halves, 71, 29, format, 3), compressed(halves, 71, 29, format))
        << layout_of(format).name;
  }
}

// sRGB decoders round differently, so the closest block may be another.
TEST(MobileBlocks, AstcDependsOnTheEncoding) {
  const Bytes texels = random_texels<std::uint8_t>(48, 48, 255, 4);
  BlockOptions options = mobile_options(BlockFormat::kAstc4x4);
  const Bytes linear = compress_blocks(texels.data(), 48, 48, options, prefilter::Run(1));
  options.is_srgb = true;
  EXPECT_NE(compress_blocks(texels.data(), 48, 48, options, prefilter::Run(1)), linear);
}

TEST(MobileBlocks, HdrHoldsAllHalfFloats) {
  const int width = 12;
  const int height = 12 * 30;
  Halves texels(static_cast<std::size_t>(4 * width * height));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      HalfBits* texel = texels.data() + 4 * (y * width + x);
      std::fill_n(texel, 3, power_of_two(y / 12 - 14));
      texel[3] = power_of_two(0);
    }
  }
  for (const BlockFormat format : kOfFloats) {
    const Bytes blocks = compressed(texels, width, height, format);
    const std::vector<float> found = decoded_mobile(blocks, width, height, format);
    for (int y = 0; y < height; ++y) {
      for (int i = 0; i < 4 * width; ++i) {
        const double wanted = i % 4 == 3 ? 1.0 : std::ldexp(1.0, y / 12 - 14);
        EXPECT_NEAR(found[static_cast<std::size_t>(4 * y * width + i)], wanted, 1e-3 * wanted);
      }
    }
  }
}

TEST(MobileBlocks, HdrHasNoNegativeValues) {
  Halves texels(static_cast<std::size_t>(4 * 12 * 12), power_of_two(0));
  for (std::size_t i = 0; i < texels.size(); i += 4) texels[i] = power_of_two(3) | 0x8000;
  for (const BlockFormat format : kOfFloats) {
    const std::vector<float> found =
        decoded_mobile(compressed(texels, 12, 12, format), 12, 12, format);
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i], i % 4 == 0 ? 0.0F : 1.0F);
  }
}

TEST(MobileBlocks, CanBeCancelled) {
  const Bytes texels = random_texels<std::uint8_t>(64, 64, 255, 6);
  const prefilter::Run stop([](double) { return false; });
  EXPECT_THROW(compress_blocks(texels.data(), 64, 64, mobile_options(BlockFormat::kAstc8x8), stop),
               Error);
}

TEST(MobileBlocks, RefuseMissingInput) {
  const Bytes bytes(4);
  const Halves halves(4);
  EXPECT_THROW(compressed(bytes, 1, 1, BlockFormat::kAstc4x4Hdr), Error);
  EXPECT_THROW(compressed(halves, 1, 1, BlockFormat::kAstc4x4), Error);
}

TEST(Supercompress, RecordsTheContentSize) {
  const Bytes bytes(300000, 7);
  const Bytes frame = supercompress(bytes.data(), bytes.size(), prefilter::Run());
  EXPECT_LT(frame.size(), 100U);
  // RFC 8878: the magic number, then a header whose upper two bits select a length of 4 bytes.
  EXPECT_EQ((Bytes(frame.begin(), frame.begin() + 4)), (Bytes{0x28, 0xb5, 0x2f, 0xfd}));
  ASSERT_EQ(frame[4] >> 6, 2);
  const std::size_t at = frame[4] & 0x20 ? 5 : 6;
  EXPECT_EQ(frame[at] | frame[at + 1] << 8 | frame[at + 2] << 16, 300000);
}

TEST(Supercompress, HardlyGrowsNoise) {
  const Bytes noise = random_texels<std::uint8_t>(300, 300, 255, 8);
  const Bytes frame = supercompress(noise.data(), noise.size(), prefilter::Run());
  EXPECT_LT(frame.size(), noise.size() + 100);
}

TEST(Supercompress, CanBeCancelled) {
  const Bytes noise = random_texels<std::uint8_t>(300, 300, 255, 9);
  const prefilter::Run stop([](double) { return false; });
  EXPECT_THROW(supercompress(noise.data(), noise.size(), stop), Error);
}

}  // namespace
}  // namespace prefilter
