// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/views/view_system.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace prefilter {
namespace {

constexpr int kUnknowns = 4 + 1;  // texels of the levels of 2 x 2 and 1 x 1

// An independent lookup: the weights of the texels of all levels, of 4 x 4, 2 x 2 and 1 x 1.
std::array<double, 21> lookup(double u, double v, double mip) {
  std::array<double, 21> weights{};
  const std::array<int, 3> sizes = {4, 2, 1};
  int begin = 0;
  for (int level = 0; level < 3; ++level) {
    const double share = std::max(0.0, 1.0 - std::abs(std::clamp(mip, 0.0, 2.0) - level));
    const int n = sizes[static_cast<std::size_t>(level)];
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        // Clamped: positions beyond the outer centers read the outer texels.
        const double x = std::clamp(u * n - 0.5, 0.0, n - 1.0);
        const double y = std::clamp(v * n - 0.5, 0.0, n - 1.0);
        weights[static_cast<std::size_t>(begin + j * n + i)] =
            share * std::max(0.0, 1.0 - std::abs(x - i)) * std::max(0.0, 1.0 - std::abs(y - j));
      }
    }
    begin += n * n;
  }
  return weights;
}

std::array<double, 21> row(const ViewPixel& pixel) {
  std::array<double, 21> sum{};
  for (int i = 1; i <= pixel.count; ++i) {
    const double at = static_cast<double>(i) / (pixel.count + 1.0) - 0.5;
    const auto one =
        lookup(pixel.uv[0] + at * pixel.along[0], pixel.uv[1] + at * pixel.along[1], pixel.row_mip);
    for (std::size_t k = 0; k < 21; ++k) sum[k] += one[k] / pixel.count;
  }
  return sum;
}

struct Scene {
  std::vector<Image> levels;
  std::vector<ViewPixels> seen;
};

Scene random_scene(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  Scene scene;
  for (const int n : {4, 2, 1}) {
    scene.levels.emplace_back(n, n, 1);
    for (float& value : scene.levels.back().data) value = uniform(random);
  }
  for (int view = 0; view < 5; ++view) {
    ViewPixels seen;
    seen.weight = 0.5 + view;
    for (int i = 0; i < 30; ++i) {
      ViewPixel pixel;
      pixel.uv = {uniform(random), uniform(random)};
      pixel.along = {0.3F * uniform(random), 0.2F * uniform(random)};
      pixel.mip = 2.5F * uniform(random);
      pixel.row_mip = 1.5F * uniform(random);
      pixel.count = static_cast<std::uint8_t>(1 + i % 3);
      pixel.is_second = i % 4 == 3;
      pixel.trust = i % 5 == 0 ? 0.1F : 1.0F;
      pixel.target[0] = uniform(random);
      seen.pixels.push_back(pixel);
    }
    scene.seen.push_back(seen);
  }
  return scene;
}

// The objective without the terms of the starting values; `steadiness` is the factor of changes.
double objective(const Scene& scene, const std::array<double, 21>& texels, double steadiness,
                 bool is_row, double* changes) {
  double sum = 0.0;
  *changes = 0.0;
  for (const ViewPixels& seen : scene.seen) {
    double before = 0.0;
    double trust = 1.0;
    for (const ViewPixel& pixel : seen.pixels) {
      const auto weights = is_row ? row(pixel) : lookup(pixel.uv[0], pixel.uv[1], pixel.mip);
      double error = pixel.target[0];
      for (std::size_t k = 0; k < 21; ++k) error -= weights[k] * texels[k];
      sum += seen.weight * pixel.trust * error * error;
      if (pixel.is_second) {
        const double change = error - before;
        *changes += seen.weight * std::min<double>(trust, pixel.trust) * change * change;
      }
      before = error;
      trust = pixel.trust;
    }
  }
  return sum + steadiness * *changes;
}

class ViewSystemTest : public ::testing::TestWithParam<Lookups> {};

// Moving any texel either way does not lower the objective.
TEST_P(ViewSystemTest, SolutionIsOptimal) {
  const Scene scene = random_scene(7);
  std::vector<ImageView> levels;
  std::array<double, 21> start{};
  std::size_t count = 0;
  for (const Image& level : scene.levels) {
    levels.push_back(level.view());
    for (const float value : level.data) start[count++] = value;
  }
  ViewFitOptions options;
  options.lookups = GetParam();
  options.steadiness = 0.7;
  const auto both = [&](const std::array<double, 21>& texels, double steadiness, double* changes) {
    double of_one = 0.0;
    double of_row = 0.0;
    const double one = objective(scene, texels, steadiness, false, &of_one);
    const double rows = objective(scene, texels, steadiness, true, &of_row);
    if (GetParam() == Lookups::kTrilinear) {
      *changes = of_one;
      return one;
    }
    if (GetParam() == Lookups::kAnisotropic) {
      *changes = of_row;
      return rows;
    }
    *changes = 0.5 * (of_one + of_row);
    return 0.5 * (one + rows);
  };
  double changes = 0.0;
  const double errors = both(start, 0.0, &changes);
  const double steadiness = options.steadiness * errors / changes;
  for (const int threads : {1, 3}) {
    options.run = prefilter::Run(threads);
    ViewSystem system(levels, {1e-6, 1e-6, 1e-6}, scene.seen, options, prefilter::Run());
    SolveOptions range;
    range.ranges.fill({-100.0F, 100.0F});
    const std::vector<Image> solved = system.solve(range, prefilter::Run());
    ASSERT_EQ(solved.size(), 2U);
    std::array<double, 21> texels = start;
    for (std::size_t k = 0; k < 4; ++k) texels[16 + k] = solved[0].data[k];
    texels[20] = solved[1].data[0];
    double unused = 0.0;
    const double least = both(texels, steadiness, &unused);
    EXPECT_LT(least, both(start, steadiness, &unused));
    for (std::size_t k = 21 - kUnknowns; k < 21; ++k) {
      for (const double step : {-0.02, 0.02}) {
        std::array<double, 21> other = texels;
        other[k] += step;
        EXPECT_GT(both(other, steadiness, &unused), least) << k << " " << step;
      }
    }
  }
}

// Texels stay within their range.
TEST_P(ViewSystemTest, SolutionIsWithinItsRange) {
  const Scene scene = random_scene(8);
  std::vector<ImageView> levels;
  for (const Image& level : scene.levels) levels.push_back(level.view());
  ViewFitOptions options;
  options.lookups = GetParam();
  options.steadiness = 0.0;
  ViewSystem system(levels, {1e-6, 1e-6, 1e-6}, scene.seen, options, prefilter::Run());
  SolveOptions range;
  range.ranges.fill({0.45F, 0.55F});
  for (const Image& level : system.solve(range, prefilter::Run())) {
    for (const float value : level.data) {
      EXPECT_GE(value, 0.45F);
      EXPECT_LE(value, 0.55F);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(AllLookups, ViewSystemTest,
                         ::testing::Values(Lookups::kTrilinear, Lookups::kAnisotropic,
                                           Lookups::kBoth));

}  // namespace
}  // namespace prefilter
