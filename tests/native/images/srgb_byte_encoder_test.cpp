// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/images/srgb_byte_encoder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "prefilter/images/transfer.h"

namespace prefilter {
namespace {

int nearest_byte(float linear) { return static_cast<int>(linear_to_srgb(linear) * 255.0F + 0.5F); }

// Tests the floats on both sides of all 255 transitions between bytes, and many more in between.
TEST(SrgbByteEncoder, GivesTheNearestByte) {
  const SrgbByteEncoder& encoder = SrgbByteEncoder::instance();
  int begins = 0;
  int before = 0;
  float value = 0.0F;
  while (value < 1.0F) {
    const int byte = encoder(value);
    ASSERT_EQ(byte, nearest_byte(value)) << value;
    ASSERT_GE(byte, before);
    ASSERT_LE(byte, before + 1);
    if (byte > before) {
      ++begins;
      float least = value;
      while (encoder(std::nextafter(least, 0.0F)) == byte) least = std::nextafter(least, 0.0F);
      EXPECT_EQ(nearest_byte(least), byte);
      EXPECT_EQ(nearest_byte(std::nextafter(least, 0.0F)), byte - 1);
      EXPECT_EQ(encoder(std::nextafter(least, 0.0F)), byte - 1);
    }
    before = byte;
    value += 1.0F / (1 << 20);
  }
  EXPECT_EQ(begins, 255);
}

TEST(SrgbByteEncoder, EndsAtZeroAndOne) {
  const SrgbByteEncoder& encoder = SrgbByteEncoder::instance();
  for (const float below : {-1.0F, -0.0F, -std::numeric_limits<float>::infinity(),
                            std::numeric_limits<float>::quiet_NaN(), 0.0F}) {
    EXPECT_EQ(encoder(below), 0);
  }
  for (const float above : {1.0F, 2.0F, std::numeric_limits<float>::infinity()}) {
    EXPECT_EQ(encoder(above), 255);
  }
}

}  // namespace
}  // namespace prefilter
