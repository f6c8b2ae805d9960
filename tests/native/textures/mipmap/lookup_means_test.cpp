// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/mipmap/lookup_means.h"

#include <gtest/gtest.h>

#include <cmath>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

constexpr WrapModes kRepeat = {Wrap::kRepeat, Wrap::kRepeat};

Image means(const Image& normals, const Image& roughness, WrapModes wrap = kRepeat,
            int threads = 1) {
  return lookup_means(normals.view(), roughness.view(), wrap, 0.02F, prefilter::Run(threads));
}

Image all(float x, float y, float z) {
  Image normals(4, 4, 3);
  for (int i = 0; i < 16; ++i) {
    normals.data[3 * i] = x;
    normals.data[3 * i + 1] = y;
    normals.data[3 * i + 2] = z;
  }
  return normals;
}

TEST(LookupMeans, UniformMapsAreTheirMeans) {
  const Image found = means(all(0.6F, 0.0F, 0.8F), Image(4, 4, 1, 0.5F));
  for (int i = 0; i < 16; ++i) {
    EXPECT_NEAR(found.data[4 * i], 0.6, 1e-6);
    EXPECT_NEAR(found.data[4 * i + 1], 0.0, 1e-6);
    EXPECT_NEAR(found.data[4 * i + 2], -0.2, 1e-6);
    EXPECT_NEAR(found.data[4 * i + 3], 0.0625, 1e-6);
  }
}

TEST(LookupMeans, OnlyZeroLengthsMatter) {
  const Image found = means(all(0.06F, 0.0F, 0.08F), Image(4, 4, 1));
  EXPECT_NEAR(found.data[0], 0.6, 1e-6);
  const Image none = means(all(0.01F, 0.0F, 0.0F), Image(4, 4, 1));
  EXPECT_EQ(none.data[0], 0.0F);
  EXPECT_EQ(none.data[2], 0.0F);
}

TEST(LookupMeans, SmallSlopesKeepTheirPrecision) {
  const Image found = means(all(1e-4F, 0.0F, 1.0F), Image(4, 4, 1));
  EXPECT_NEAR(found.data[2], -0.5e-8, 1e-13);
}

TEST(LookupMeans, RoughnessIsInterpolatedBeforeItIsUsed) {
  // Columns of 0 and 1: lookups along u are the distance to a column of 0, up to half a texel.
  Image roughness(4, 4, 1);
  for (int y = 0; y < 4; ++y) *roughness.texel(1, y) = *roughness.texel(3, y) = 1.0F;
  const Image found = means(all(0.0F, 0.0F, 1.0F), roughness);
  const double low = std::pow(0.5, 5) / 5.0 / 0.5;  // mean of x^4 over [0, 1/2]
  const double high = (1.0 - std::pow(0.5, 5)) / 5.0 / 0.5;
  // The two-point rule is exact up to the third power.
  EXPECT_NEAR(found.texel(0, 0)[3], low, 4e-4);
  EXPECT_NEAR(found.texel(1, 0)[3], high, 4e-4);
}

TEST(LookupMeans, ThreadsDoNotMatter) {
  Image normals(33, 21, 3);
  Image roughness(33, 21, 1);
  for (std::size_t i = 0; i < normals.data.size(); ++i) {
    normals.data[i] = std::sin(static_cast<float>(i * i));
  }
  for (std::size_t i = 0; i < roughness.data.size(); ++i) {
    roughness.data[i] = std::fabs(std::cos(static_cast<float>(i)));
  }
  EXPECT_EQ(means(normals, roughness, kRepeat, 1).data, means(normals, roughness, kRepeat, 4).data);
}

TEST(LookupMeans, RefusesMapsThatDoNotFit) {
  EXPECT_THROW(means(Image(4, 4, 4), Image(4, 4, 1)), Error);
  EXPECT_THROW(means(Image(4, 4, 3), Image(4, 4, 3)), Error);
  EXPECT_THROW(means(Image(4, 4, 3), Image(4, 2, 1)), Error);
}

}  // namespace
}  // namespace prefilter
