// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/images/transfer.h"

#include <gtest/gtest.h>

namespace prefilter {
namespace {

TEST(Srgb, HasTheStandardsFixedPoints) {
  EXPECT_EQ(srgb_to_linear(0.0F), 0.0F);
  EXPECT_NEAR(srgb_to_linear(1.0F), 1.0F, 1e-6);
  EXPECT_NEAR(srgb_to_linear(0.5F), 0.2140411F, 1e-6);
  EXPECT_NEAR(srgb_to_linear(0.04045F), 0.0031308F, 1e-6);
}

TEST(Srgb, EncodesWhatItDecodes) {
  for (float value = -1.5F; value < 3.0F; value += 0.01F) {
    EXPECT_NEAR(linear_to_srgb(srgb_to_linear(value)), value, 2e-6);
  }
}

TEST(Srgb, LeavesAlpha) {
  const Image image(3, 2, 4, 0.5F);
  const Image decoded = decode_srgb(image.view(), 2);
  EXPECT_NEAR(decoded.texel(2, 1)[2], 0.2140411F, 1e-6);
  EXPECT_EQ(decoded.texel(2, 1)[3], 0.5F);
}

}  // namespace
}  // namespace prefilter
