// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/normal_mipmaps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

NormalMipmapOptions box_options() {
  NormalMipmapOptions options;
  options.filter = mipmap_filter("box");
  options.encoded = false;
  options.wrap = {Wrap::kRepeat, Wrap::kRepeat};
  return options;
}

// Stripes of 16 texels, tilted alternately to the left and right by an angle.
Image stripes(double angle) {
  Image image(64, 64, 3);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      float* normal = image.texel(x, y);
      normal[0] = static_cast<float>((x / 16 % 2 == 0 ? 1.0 : -1.0) * std::sin(angle));
      normal[1] = 0.0F;
      normal[2] = static_cast<float>(std::cos(angle));
    }
  }
  return image;
}

// The mean over a stripe and its two edges, where lookups interpolate linearly between both sides.
double mean_height(double angle) {
  const double low = std::cos(angle);
  const double side = std::sin(angle);
  double turning = 0.0;
  constexpr int kSteps = 1000;
  for (int i = 0; i < kSteps; ++i) {
    const double x = side * (2.0 * (i + 0.5) / kSteps - 1.0);
    turning += low / std::hypot(low, x) / kSteps;
  }
  return (15.0 * low + turning) / 16.0;
}

TEST(NormalMipmaps, RoughnessAbsorbsTheVariance) {
  for (const double angle : {0.05, 0.4}) {
    const Image normals = stripes(angle);
    const Image rough(64, 64, 1, 0.3F);
    const ImageView rough_view = rough.view();
    const NormalMipmaps levels = normal_mipmaps(normals.view(), &rough_view, {}, box_options());
    ASSERT_EQ(levels.normals.size(), 6U);
    ASSERT_EQ(levels.roughness.size(), 6U);
    const float* last = levels.normals[5].texel(0, 0);
    EXPECT_NEAR(last[0], 0.0, 1e-6);
    EXPECT_NEAR(last[2], 1.0, 1e-6);
    const double square = std::pow(0.3, 4) + 2.0 * (1.0 - mean_height(angle));
    EXPECT_NEAR(*levels.roughness[5].texel(0, 0), std::pow(square, 0.25), 1e-3);
  }
}

TEST(NormalMipmaps, IgnoreLengths) {
  Image normals = stripes(0.4);
  const NormalMipmaps expected = normal_mipmaps(normals.view(), nullptr, {}, box_options());
  for (float& value : normals.data) value *= 5.0F;
  const NormalMipmaps found = normal_mipmaps(normals.view(), nullptr, {}, box_options());
  EXPECT_TRUE(found.roughness.empty());
  for (std::size_t k = 0; k < expected.normals.size(); ++k) {
    for (std::size_t i = 0; i < expected.normals[k].data.size(); ++i) {
      EXPECT_NEAR(found.normals[k].data[i], expected.normals[k].data[i], 1e-6);
    }
  }
}

TEST(NormalMipmaps, DoNotPointBelowAMapThatDoesNot) {
  // Lanczos overshoots beside a bright line, to z below 0.
  const auto line = [](float z) {
    Image image(32, 32, 3);
    for (int y = 0; y < 32; ++y) {
      for (int x = 0; x < 32; ++x) {
        float* normal = image.texel(x, y);
        normal[0] = x == 15 ? 0.0F : 1.0F;
        normal[2] = x == 15 ? 1.0F : 0.0F;
      }
    }
    image.texel(0, 0)[2] = z;
    return image;
  };
  NormalMipmapOptions options = box_options();
  options.filter = mipmap_filter("lanczos3");
  const auto lowest = [&](const Image& image) {
    float low = 1.0F;
    const NormalMipmaps made = normal_mipmaps(image.view(), nullptr, {}, options);
    for (std::size_t i = 2; i < made.normals[0].data.size(); i += 3) {
      low = std::min(low, made.normals[0].data[i]);
    }
    return low;
  };
  EXPECT_EQ(lowest(line(0.0F)), 0.0F);
  EXPECT_LT(lowest(line(-1.0F)), -0.01F);
}

TEST(NormalMipmaps, RefuseInvalidInput) {
  Image normals = stripes(0.4);
  const Image rough(32, 64, 1, 0.3F);
  const ImageView rough_view = rough.view();
  EXPECT_THROW(normal_mipmaps(rough.view(), nullptr, {}, box_options()), Error);
  EXPECT_THROW(normal_mipmaps(normals.view(), &rough_view, {}, box_options()), Error);
  Image bad_rough(64, 64, 1, 0.3F);
  *bad_rough.texel(3, 2) = std::numeric_limits<float>::infinity();
  const ImageView bad_view = bad_rough.view();
  try {
    normal_mipmaps(normals.view(), &bad_view, {}, box_options());
    FAIL() << "an infinite roughness was taken";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "roughness: the texel in row 2, column 3 holds inf; texels that count must be "
                 "finite");
  }
  normals.texel(5, 4)[1] = std::nanf("");
  try {
    normal_mipmaps(normals.view(), nullptr, {}, box_options());
    FAIL() << "a normal that is not a number was taken";
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).substr(0, 39), "normals: the texel in row 4, column 5 h");
  }
}

}  // namespace
}  // namespace prefilter
