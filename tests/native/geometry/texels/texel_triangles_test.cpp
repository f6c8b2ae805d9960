// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/geometry/texels/texel_triangles.h"

#include <gtest/gtest.h>

#include "geometry/texels/scenes.h"
#include "prefilter/base/error.h"
#include "prefilter/geometry/texels/coverage.h"

namespace prefilter {
namespace {

TexelTriangles map(const Surface& surface, Wrap u, Wrap v) {
  return map_to_texels({&surface}, 8, 4, {u, v}, MassOf::kArea, prefilter::Run(0));
}

TEST(MapToTexels, KeepsTheMassUnlessABorderDropsIt) {
  const Surface surface = testing::random_surface(1, 50, -2.5, 3.5);
  for (const Wrap u : {Wrap::kClamp, Wrap::kRepeat}) {
    for (const Wrap v : {Wrap::kClamp, Wrap::kRepeat}) {
      EXPECT_NEAR(map(surface, u, v).total_mass, 32.0, 1e-9);
    }
  }
  // A square of 3 x 3 tiles, one of which is the image.
  Surface nine = testing::one_triangle({{{-1, -1}, {2, -1}, {2, 2}}});
  nine.uvs.push_back({{{-1, -1}, {2, 2}, {-1, 2}}});
  nine.areas.push_back(1.0);
  EXPECT_NEAR(map(nine, Wrap::kBorder, Wrap::kBorder).total_mass, 32.0 / 9.0, 1e-9);
  EXPECT_NEAR(map(nine, Wrap::kBorder, Wrap::kClamp).total_mass, 32.0 / 3.0, 1e-9);
}

TEST(MapToTexels, StaysInsideTheImage) {
  const Surface surface = testing::random_surface(2, 50, -2.5, 3.5);
  for (const Wrap u : {Wrap::kClamp, Wrap::kRepeat, Wrap::kBorder}) {
    for (const Wrap v : {Wrap::kClamp, Wrap::kRepeat, Wrap::kBorder}) {
      for (const MassTriangle& triangle : map(surface, u, v).triangles) {
        EXPECT_GT(triangle.mass, 0.0);
        for (const GridPoint& corner : triangle.corners) {
          EXPECT_TRUE(corner.x >= 0 && corner.x <= 8 && corner.y >= 0 && corner.y <= 4);
        }
      }
    }
  }
}

TEST(MapToTexels, PutsWholeTilesIntoTheUniformPart) {
  const Surface large = testing::one_triangle({{{0, 0}, {100, 0}, {0, 100}}});
  const TexelTriangles mapped = map(large, Wrap::kRepeat, Wrap::kRepeat);
  // 4,950 of the 5,000 tiles' area.
  EXPECT_NEAR(mapped.uniform_mass() / mapped.total_mass, 0.99, 1e-9);
  EXPECT_EQ(mapped.triangles.size(), 100U);
}

TEST(MapToTexels, RepeatAddsUpToTheSameCoverageAsShiftedTriangles) {
  const Surface moved = testing::one_triangle({{{3.1, -4.9}, {3.9, -4.8}, {3.4, -4.1}}});
  const Surface home = testing::one_triangle({{{0.1, 0.1}, {0.9, 0.2}, {0.4, 0.9}}});
  const auto expected = texel_masses(map(home, Wrap::kRepeat, Wrap::kRepeat), prefilter::Run(1));
  const auto found = texel_masses(map(moved, Wrap::kRepeat, Wrap::kRepeat), prefilter::Run(1));
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-5);
}

TEST(MapToTexels, ClampsToTheEdgeTexels) {
  const Surface outside = testing::one_triangle({{{2, 0.1}, {3, 0.2}, {2.5, 0.2}}});
  const auto masses = texel_masses(map(outside, Wrap::kClamp, Wrap::kClamp), prefilter::Run(1));
  EXPECT_NEAR(masses[7], 32.0F, 1e-4);
}

TEST(MapToTexels, RefusesTooManyTiles) {
  const Surface huge = testing::one_triangle({{{0, 0}, {2000, 0}, {0, 2000}}});
  EXPECT_THROW(map(huge, Wrap::kRepeat, Wrap::kRepeat), Error);
  const Surface far = testing::one_triangle({{{1e12, 0}, {1e12, 1}, {1e12, 2}}});
  EXPECT_THROW(map(far, Wrap::kRepeat, Wrap::kClamp), Error);
  EXPECT_THROW(map(far, Wrap::kClamp, Wrap::kClamp), Error);
  const Surface away = testing::one_triangle({{{1e6, 0}, {1e9, 1}, {1e9, 2}}});
  EXPECT_NO_THROW(map(away, Wrap::kClamp, Wrap::kClamp));
}

TEST(Coverage, KnowsTouchedTexelsWithoutArea) {
  const Surface flat = testing::one_triangle({{{0.1, 0.1}, {0.4, 0.1}, {0.2, 0.1}}}, 0.0);
  const std::vector<unsigned char> touched = touched_texels({&flat}, 8, 4, {}, prefilter::Run(1));
  const std::vector<unsigned char> expected{1, 1, 1, 1, 0, 0, 0, 0};
  for (std::size_t i = 0; i < touched.size(); ++i) {
    EXPECT_EQ(touched[i], i < 8 ? expected[i] : 0) << i;
  }
}

TEST(Coverage, LooksUpTheTexelsAround) {
  // Inside the upper right half of texel (2, 1), where lookups read columns 2 and 3, rows 1 and 2.
  const Surface small =
      testing::one_triangle({{{2.6 / 8, 1.6 / 4}, {2.9 / 8, 1.6 / 4}, {2.7 / 8, 1.9 / 4}}});
  const std::vector<unsigned char> read = looked_up_texels({&small}, 8, 4, {}, prefilter::Run(1));
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 8; ++x) {
      const bool expected = (x == 2 || x == 3) && (y == 1 || y == 2);
      EXPECT_EQ(read[8 * y + x] != 0, expected) << x << " " << y;
    }
  }
}

}  // namespace
}  // namespace prefilter
