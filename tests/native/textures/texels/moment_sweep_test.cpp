// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/texels/moment_sweep.h"

#include <gtest/gtest.h>

#include <map>
#include <mutex>
#include <tuple>

#include "geometry/texels/scenes.h"
#include "prefilter/textures/texels/levels.h"

namespace prefilter {
namespace {

using Key = std::tuple<int, int, int>;  // level, x, y
using Cells = std::map<Key, CellMoments<2>>;

Cells sweep(const Surface& surface, const Image& image, WrapModes wrap, int first_level,
            int threads) {
  const TexelTriangles triangles =
      map_to_texels({&surface}, image.width, image.height, wrap, MassOf::kArea, prefilter::Run(0));
  Cells cells;
  std::mutex mutex;
  const int last = full_level_count(image.width, image.height) - 1;
  sweep_moments<2>(triangles, image.view(), wrap, {.first_level = first_level, .last_level = last},
                   prefilter::Run(threads), [&](const MomentBlock<2>& block) {
                     const std::lock_guard<std::mutex> lock(mutex);
                     for (int y = 0; y < block.height; ++y) {
                       for (int x = 0; x < block.width; ++x) {
                         const Key key{block.level, block.x0 + x, block.y0 + y};
                         if (!block.at(x, y).empty()) cells[key] = block.at(x, y);
                       }
                     }
                   });
  return cells;
}

double total(const Cells& cells, int level) {
  double sum = 0.0;
  for (const auto& [key, moments] : cells) {
    if (std::get<0>(key) == level) sum += moments.weight[0];
  }
  return sum;
}

TEST(SweepMoments, EveryLevelHoldsTheWholeSurface) {
  const Surface surface = testing::random_surface(1, 20, -0.5, 1.5);
  for (const auto& [width, height] : {std::pair{64, 128}, std::pair{8, 256}, std::pair{2, 2}}) {
    const Image image = testing::random_image(1, width, height, 2);
    for (const Wrap wrap : {Wrap::kClamp, Wrap::kRepeat}) {
      const Cells cells = sweep(surface, image, {wrap, wrap}, 0, 2);
      for (int level = 0; level < full_level_count(width, height); ++level) {
        EXPECT_NEAR(total(cells, level), width * height, 1e-6 * width * height);
      }
    }
  }
}

TEST(SweepMoments, TheStencilOfWholeTexelsAgreesWithTheirHalves) {
  Surface surface = testing::random_surface(2, 6, 0.0, 1.0);
  const Image image = testing::random_image(2, 64, 32, 2);
  const WrapModes wrap{Wrap::kRepeat, Wrap::kClamp};
  const Cells from_halves = sweep(surface, image, wrap, 0, 1);
  const Cells from_texels = sweep(surface, image, wrap, 1, 1);
  int compared = 0;
  for (const auto& [key, moments] : from_halves) {
    if (std::get<0>(key) == 0) continue;
    ASSERT_TRUE(from_texels.contains(key));
    const CellMoments<2>& other = from_texels.at(key);
    for (int i = 0; i < 9; ++i) {
      ASSERT_NEAR(moments.weight[i], other.weight[i], 1e-9 * moments.weight[0]);
    }
    for (int c = 0; c < 2; ++c) {
      for (int i = 0; i < 4; ++i) {
        ASSERT_NEAR(moments.image[c][i], other.image[c][i], 1e-9 * moments.weight[0]);
      }
    }
    ++compared;
  }
  EXPECT_GT(compared, 1000);
}

TEST(SweepMoments, AConstantImageHasTheMomentsOfTheWeights) {
  const Surface surface = testing::random_surface(3, 10, -0.2, 1.2);
  Image image(32, 32, 2, 0.5F);
  const Cells cells = sweep(surface, image, {Wrap::kClamp, Wrap::kRepeat}, 0, 2);
  for (const auto& [key, moments] : cells) {
    for (int b = 0; b < 2; ++b) {
      for (int a = 0; a < 2; ++a) {
        ASSERT_NEAR(moments.image[1][2 * b + a], 0.5 * moments.weight[3 * b + a],
                    1e-12 * (1 + moments.weight[0]));
      }
    }
  }
}

TEST(SweepMoments, DoesNotDependOnThreads) {
  const Surface surface = testing::random_surface(4, 30, -0.5, 1.5);
  const Image image = testing::random_image(4, 128, 128, 2);
  const Cells one = sweep(surface, image, {}, 1, 1);
  const Cells many = sweep(surface, image, {}, 1, 4);
  ASSERT_EQ(one.size(), many.size());
  for (const auto& [key, moments] : one) {
    ASSERT_EQ(moments.weight, many.at(key).weight);
    ASSERT_EQ(moments.image, many.at(key).image);
  }
}

}  // namespace
}  // namespace prefilter
