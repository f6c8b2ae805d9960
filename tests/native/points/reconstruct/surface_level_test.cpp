// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/surface_level.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "points/reconstruct/test_cloud.h"
#include "prefilter/points/reconstruct/coarse_tree.h"
#include "prefilter/points/reconstruct/whole_samples.h"
#include "wavelet/random_tree.h"

namespace prefilter {
namespace {

constexpr int kDepth = 6;
constexpr int kTop = 4;

TEST(SurfaceLevel, MeanIsOneHalfForAClosedSurface) {
  for (const bool is_flipped : {false, true}) {
    const float sign = is_flipped ? -1.0F : 1.0F;
    for (const double mean : {0.2, 0.45, 0.6}) {
      const SurfaceLevel level = level_of_mean(mean, is_flipped, false);
      EXPECT_EQ(level.isovalue, 0.5F);
      EXPECT_FLOAT_EQ(level.scale, sign * static_cast<float>(0.5 / mean));
      const SurfaceLevel known = level_of_mean(mean, is_flipped, true);
      EXPECT_EQ(known.scale, sign);
      EXPECT_FLOAT_EQ(known.isovalue, static_cast<float>(mean));
    }
    const SurfaceLevel open = level_of_mean(0.19, is_flipped, false);
    EXPECT_EQ(open.scale, sign);
    EXPECT_FLOAT_EQ(open.isovalue, 0.19F);
  }
}

TEST(SurfaceLevel, RoomHasWallsOnAllSides) {
  EXPECT_TRUE(is_room({-0.5, {0.0, 0.1, -0.3}}));
  EXPECT_FALSE(is_room({-0.5, {0.0, 0.1, 0.6}}));
  EXPECT_FALSE(is_room({-0.1, {0.0, 0.0, 0.0}}));
  EXPECT_FALSE(is_room({0.5, {0.0, 0.0, 0.0}}));
}

TEST(SurfaceLevel, CanBeSetByTheOptions) {
  testing::CloudStore store(testing::sphere_cloud(2000), kDepth, kDepth - kTop);
  Slabs slabs(&store, kDepth, kTop, 0, true, 1);
  ReconstructOptions options;
  options.isovalue = Isovalue::kHalf;
  EXPECT_EQ(find_surface_level(options, true, prefilter::Run(), &slabs).scale, -1.0F);
  EXPECT_EQ(find_surface_level(options, true, prefilter::Run(), &slabs).isovalue, 0.5F);
  options.isovalue = Isovalue::kGiven;
  options.given_isovalue = 0.3;
  EXPECT_EQ(find_surface_level(options, false, prefilter::Run(), &slabs).isovalue, 0.3F);
}

// The function is 1/2 at the samples, about 1 inside and 0 outside: the Haar functions of a
// sphere's samples add up to its indicator function.
TEST(SurfaceLevel, IsOneHalfForASphere) {
  testing::CloudStore store(testing::sphere_cloud(20000), kDepth, kDepth - kTop);
  Slabs slabs(&store, kDepth, kTop, 0, true, 1);
  slabs.mean_weight = 1.0;
  compute_whole_samples(0, prefilter::Run(1), &slabs);
  EXPECT_EQ(build_coarse_tree(prefilter::Run(1), &slabs), 0.0);
  EXPECT_NEAR(slabs.coarse.root, 4.0 / 3.0 * 3.14159265 * std::pow(0.35, 3.0), 0.005);
  ReconstructOptions options;
  const SurfaceLevel level = find_surface_level(options, false, prefilter::Run(), &slabs);
  EXPECT_EQ(level.isovalue, 0.5F);
  EXPECT_NEAR(level.scale, 1.0F, 0.05F);
  for (int s = 0; s < slabs.count(); ++s) {
    const CellTree tree = tree_around(slabs, s, kContourOctants, level.scale);
    const int z = s * slabs.height();
    for (int x = 0; x < 1 << kDepth; ++x) {
      const double side = std::ldexp(1.0, -kDepth);
      const Vector3 p = {(x + 0.5) * side - 0.5, 0.0, (z + 0.5) * side - 0.5};
      const double height = length(p) - 0.35;
      if (std::abs(height) < 2.0 * side) continue;
      EXPECT_NEAR(leaf_value(tree, kDepth, {x, 1 << (kDepth - 1), z}), height < 0.0 ? 1.0 : 0.0,
                  0.1);
    }
  }
}

TEST(SurfaceLevel, LeafValuesEqualTheTrees) {
  const CellTree tree = random_tree(1, 5);
  // All cells of depth 5, found by descending from the root.
  const auto expected = [&](const CellPosition& at) {
    std::size_t block = 0;
    for (int k = 0;; ++k) {
      const int bit = 4 - k;
      const int octant = (at[0] >> bit & 1) + 2 * (at[1] >> bit & 1) + 4 * (at[2] >> bit & 1);
      const TreeLevel& level = tree.levels[static_cast<std::size_t>(k)];
      if ((level.split[block] >> octant & 1) == 0) {
        return level.blocks[block][static_cast<std::size_t>(octant)];
      }
      std::size_t child = 0;
      for (std::size_t b = 0; b <= block; ++b) {
        const int end = b < block ? 8 : octant;
        for (int o = 0; o < end; ++o) child += level.split[b] >> o & 1;
      }
      block = child;
    }
  };
  for (int z = 0; z < 32; z += 3) {
    for (int y = 0; y < 32; ++y) {
      for (int x = 0; x < 32; ++x) {
        EXPECT_EQ(leaf_value(tree, 5, {x, y, z}), expected({x, y, z}));
      }
    }
  }
}

}  // namespace
}  // namespace prefilter
