// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/images/exr_tiles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "prefilter/images/half_float.h"
#include "prefilter/images/transfer.h"

namespace prefilter {
namespace {

float value_of(std::uint16_t half) {
  const int exponent = (half >> 10) & 31;
  const auto fraction = static_cast<float>(half & 1023);
  const float magnitude =
      exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024.0F + fraction, exponent - 25);
  return (half & 0x8000) != 0 ? -magnitude : magnitude;
}

TEST(HalfFloat, KeepsRepresentableValues) {
  for (int bits = 0; bits < 1 << 16; ++bits) {
    const auto half = static_cast<std::uint16_t>(bits);
    if ((half & 0x7c00) == 0x7c00) continue;
    EXPECT_EQ(half_bits(value_of(half)), half);
  }
}

TEST(HalfFloat, RoundsToTheNearestAndTiesToEven) {
  for (std::uint16_t half = 0; half < 0x7bff; ++half) {
    const float between = (value_of(half) + value_of(half + 1)) / 2.0F;
    EXPECT_EQ(half_bits(between), half % 2 == 0 ? half : half + 1);
    EXPECT_EQ(half_bits(std::nextafter(between, 0.0F)), half);
    EXPECT_EQ(half_bits(std::nextafter(between, 1e9F)), half + 1);
    EXPECT_EQ(half_bits(-std::nextafter(between, 1e9F)), 0x8000 | (half + 1));
  }
}

TEST(HalfFloat, IsInfiniteBeyondItsRange) {
  EXPECT_EQ(half_bits(std::nextafter(65520.0F, 0.0F)), 0x7bff);
  EXPECT_EQ(half_bits(65520.0F), 0x7c00);
  EXPECT_EQ(half_bits(-1e30F), 0xfc00);
  EXPECT_EQ(half_bits(std::numeric_limits<float>::infinity()), 0x7c00);
  const std::uint16_t missing = half_bits(std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(missing & 0x7c00, 0x7c00);
  EXPECT_NE(missing & 0x03ff, 0);
}

std::int32_t word(const ExrChunks& chunks, std::size_t at) {
  std::int32_t found = 0;
  std::memcpy(&found, chunks.bytes.data() + at, sizeof(found));
  return found;
}

TEST(ExrTiles, ChunksSayWhereTheyBelong) {
  Image image(130, 200, 3);
  for (std::size_t i = 0; i < image.data.size(); ++i) {
    image.data[i] = static_cast<float>((i * 2654435761U) % 1000) / 1000.0F;
  }
  const ExrChunks chunks = exr_tiles(image.view(), 5, 1, 3, {.threads = 3});
  ASSERT_EQ(chunks.sizes.size(), 9U);
  std::size_t at = 0;
  for (int i = 0; i < 9; ++i) {
    EXPECT_EQ(word(chunks, at), i % 3);
    EXPECT_EQ(word(chunks, at + 4), 1 + i / 3);
    EXPECT_EQ(word(chunks, at + 8), 5);
    EXPECT_EQ(word(chunks, at + 12), 5);
    EXPECT_EQ(word(chunks, at + 16) + 20, chunks.sizes[i]);
    at += static_cast<std::size_t>(chunks.sizes[i]);
  }
  EXPECT_EQ(at, chunks.bytes.size());
}

TEST(ExrTiles, IncompressibleTilesAreStoredRaw) {
  const float texel[] = {0.25F, 0.5F, 1.0F};
  const ExrChunks chunks = exr_tiles(ImageView{texel, 1, 1, 3}, 0, 0, 1, {});
  ASSERT_EQ(chunks.bytes.size(), 20U + 6U);
  const std::uint16_t expected[] = {half_bits(1.0F), half_bits(0.5F), half_bits(0.25F)};
  EXPECT_EQ(std::memcmp(chunks.bytes.data() + 20, expected, sizeof(expected)), 0);
}

TEST(ExrTiles, BytesAreDecoded) {
  const ByteValues values = byte_values(true);
  for (const bool multiplies : {false, true}) {
    for (const bool half : {false, true}) {
      std::vector<std::uint8_t> bytes(70 * 65 * 4);
      Image floats(70, 65, 4);
      for (std::size_t i = 0; i < bytes.size(); ++i) {
        bytes[i] = static_cast<std::uint8_t>(i * 37 % 251);
        floats.data[i] = values[i % 4][bytes[i]];
      }
      const ExrTileOptions options{.half = half, .has_alpha = true, .multiplies = multiplies};
      const TexelSource source(bytes.data(), 70, 65, 4, &values);
      EXPECT_EQ(exr_tiles(source, 0, 0, 2, options).bytes,
                exr_tiles(floats.view(), 0, 0, 2, options).bytes);
    }
  }
}

}  // namespace
}  // namespace prefilter
