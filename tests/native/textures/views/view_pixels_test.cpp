// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/views/view_pixels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "prefilter/textures/views/triangle_buffer.h"

namespace prefilter {
namespace {

// A view along z, with y up, in units of pixels.
View front_view(const Surface& surface, int size, int samples) {
  View view;
  view.surface = &surface;
  view.center = {0.0, 0.0, 0.0};
  view.right = {1.0, 0.0, 0.0};
  view.up = {0.0, 1.0, 0.0};
  view.toward = {0.0, 0.0, 1.0};
  view.pixel = 1.0;
  view.size = size;
  view.samples = samples;
  view.weight = 1.0;
  return view;
}

TEST(TriangleBuffer, ShowsTheFrontmostTriangles) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-6.0, 6.0);
  Surface surface;
  for (std::int32_t t = 0; t < 40; ++t) {
    for (int k = 0; k < 3; ++k) {
      surface.positions.push_back({uniform(random), uniform(random), uniform(random)});
    }
    surface.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    surface.uvs.push_back({});
    surface.areas.push_back(1.0);
  }
  constexpr int kSize = 12;
  constexpr int kSamples = 3;
  const View view = front_view(surface, kSize, kSamples);
  TriangleBuffer triangles(view, false);
  std::vector<std::uint32_t> seen;
  constexpr int kBegin = 2;
  triangles.draw(kBegin, kSize, kSamples, &seen);
  ASSERT_EQ(seen.size(), static_cast<std::size_t>(kSize * kSamples * (kSize - kBegin) * kSamples));
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const double x = (static_cast<double>(k % (kSize * kSamples)) + 0.5) / kSamples - kSize / 2.0;
    const double y = static_cast<double>(k / (kSize * kSamples)) / kSamples + 0.5 / kSamples +
                     kBegin - kSize / 2.0;
    std::uint32_t expected = TriangleBuffer::kNothing;
    double highest = -1e9;
    bool is_near_edge = false;
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
      const Vector3& a = surface.positions[3 * t];
      const Vector3& b = surface.positions[3 * t + 1];
      const Vector3& c = surface.positions[3 * t + 2];
      const auto side = [&](const Vector3& p, const Vector3& q) {
        return (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]);
      };
      const double area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
      const double of_a = side(b, c) / area;
      const double of_b = side(c, a) / area;
      const double of_c = side(a, b) / area;
      const double least = std::min({of_a, of_b, of_c});
      if (std::abs(least) < 1e-6) is_near_edge = true;
      const double depth = of_a * a[2] + of_b * b[2] + of_c * c[2];
      if (least >= 0.0 && depth > highest) {
        highest = depth;
        expected = t;
      }
    }
    if (is_near_edge) continue;
    EXPECT_EQ(seen[k], expected) << x << " " << y;
  }
}

// A slanted square of 32 units, on which the image is magnified four times.
Surface square(double slant) {
  Surface surface;
  const double c = std::cos(slant);
  const double s = std::sin(slant);
  for (const auto& [x, y] : {std::pair{-16.0, -16.0}, {16.0, -16.0}, {16.0, 16.0}, {-16.0, 16.0}}) {
    surface.positions.push_back({x * c, y, x * s});
  }
  surface.triangles = {{0, 1, 2}, {0, 2, 3}};
  const TextureCoordinate a{0.0, 0.0};
  const TextureCoordinate b{1.0, 0.0};
  const TextureCoordinate d{1.0, 1.0};
  const TextureCoordinate e{0.0, 1.0};
  surface.uvs = {{a, b, d}, {a, d, e}};
  surface.areas = {512.0, 512.0};
  return surface;
}

TEST(ViewPixels, TargetsAreMeansOverPixels) {
  constexpr int kTexels = 64;  // two per unit along each axis
  Image image(kTexels, kTexels, 1);
  std::mt19937 random(4);
  for (float& value : image.data) value = std::uniform_real_distribution<float>()(random);
  const Surface surface = square(0.0);
  View view = front_view(surface, 36, 8);
  view.step = {0.25, 0.0};
  const std::vector<ImageView> levels = {image.view()};
  const ViewPixels seen = view_pixels(view, 0, 36, levels, {Wrap::kRepeat, Wrap::kRepeat});
  // 32 x 32 in the first frame; in the second the outer columns are not covered.
  std::size_t seconds = 0;
  for (const ViewPixel& pixel : seen.pixels) seconds += pixel.is_second ? 1 : 0;
  EXPECT_EQ(seen.pixels.size(), 32U * 32U + 31U * 32U);
  EXPECT_EQ(seconds, 31U * 32U);
  for (const ViewPixel& pixel : seen.pixels) {
    EXPECT_FLOAT_EQ(pixel.mip, 1.0F);
    EXPECT_EQ(pixel.count, 1);
    EXPECT_FLOAT_EQ(pixel.trust, 1.0F);
    // The interpolated image, integrated by a finer rule.
    double sum = 0.0;
    constexpr int kRule = 40;
    for (int j = 0; j < kRule; ++j) {
      for (int i = 0; i < kRule; ++i) {
        sum += bilinear(image.view(), {Wrap::kRepeat, Wrap::kRepeat},
                        pixel.uv[0] + ((i + 0.5) / kRule - 0.5) / 32.0,
                        pixel.uv[1] + ((j + 0.5) / kRule - 0.5) / 32.0)[0];
      }
    }
    EXPECT_NEAR(pixel.target[0], sum / (kRule * kRule), 0.004);
  }
}

TEST(ViewPixels, FootprintsFollowTheLongerSide) {
  const Image image(64, 64, 1, 0.5F);
  const Surface surface = square(std::acos(0.3));
  const std::vector<ImageView> levels = {image.view()};
  const ViewPixels seen =
      view_pixels(front_view(surface, 40, 4), 0, 40, levels, {Wrap::kClamp, Wrap::kClamp});
  ASSERT_FALSE(seen.pixels.empty());
  for (const ViewPixel& pixel : seen.pixels) {
    // Two texels divided by 0.3.
    EXPECT_NEAR(pixel.mip, std::log2(2.0 / 0.3), 1e-5);
    EXPECT_EQ(pixel.count, 4);
    EXPECT_NEAR(pixel.row_mip, std::log2(2.0 / 0.3 / 4.0), 1e-5);
    EXPECT_NEAR(std::abs(pixel.along[0]), 1.0 / 32.0 / 0.3, 1e-6);
    EXPECT_NEAR(pixel.along[1], 0.0, 1e-9);
    EXPECT_FLOAT_EQ(pixel.target[0], 0.5F);
  }
}

TEST(ViewPixels, MixedPixelsHaveLessWeight) {
  Surface surface = square(0.0);
  // The other half is elsewhere in the texture.
  for (TextureCoordinate& corner : surface.uvs[1]) corner.u += 0.37;
  const Image image(64, 64, 1, 0.5F);
  const std::vector<ImageView> levels = {image.view()};
  const View view = front_view(surface, 36, 4);
  const ViewPixels seen = view_pixels(view, 0, 36, levels, {Wrap::kRepeat, Wrap::kRepeat});
  std::size_t less = 0;
  for (const ViewPixel& pixel : seen.pixels) less += pixel.trust < 1.0F ? 1 : 0;
  // The pixels on the diagonal, in both frames.
  EXPECT_EQ(less, 2U * 32U);
}

}  // namespace
}  // namespace prefilter
