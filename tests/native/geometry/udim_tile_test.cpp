// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/geometry/udim_tile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

// The share of a triangle's area in a tile, from a grid of samples.
double sampled_share(const std::array<TextureCoordinate, 3>& uvs, int column, int row) {
  constexpr int kSteps = 700;
  int inside = 0;
  int all = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; i + j < kSteps; ++j) {
      const double b = (i + 1.0 / 3.0) / kSteps;
      const double c = (j + 1.0 / 3.0) / kSteps;
      const double a = 1.0 - b - c;
      const double u = a * uvs[0].u + b * uvs[1].u + c * uvs[2].u;
      const double v = a * uvs[0].v + b * uvs[1].v + c * uvs[2].v;
      inside += std::floor(u) == column && std::floor(v) == row;
      ++all;
    }
  }
  return static_cast<double>(inside) / all;
}

Surface random_surface(unsigned seed, int triangles) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-0.5, 3.0);
  Surface surface;
  for (int k = 0; k < triangles; ++k) {
    surface.triangles.push_back({3 * k, 3 * k + 1, 3 * k + 2});
    surface.areas.push_back(1.0 + k);
    surface.uvs.emplace_back();
    for (TextureCoordinate& uv : surface.uvs.back()) {
      uv = {uniform(random), uniform(random)};
      if (k % 3 == 1) uv.v = 0.75;        // a line in the texture
      if (k % 3 == 2) uv.u = 1.5 * uv.v;  // a slanted line
      surface.positions.push_back({uv.u, uv.v, uniform(random)});
    }
  }
  return surface;
}

// A triangle that is a line in the texture, on the edge between two tiles, belongs to one of them.
TEST(UdimTile, TrianglesOnEdgesBelongToTheNextTile) {
  for (const bool along_u : {false, true}) {
    Surface surface;
    surface.triangles = {{0, 1, 2}};
    surface.areas = {2.0};
    surface.positions = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
    surface.uvs.emplace_back();
    const double places[3] = {1.2, 1.4, 1.8};
    for (int i = 0; i < 3; ++i) {
      surface.uvs[0][i] =
          along_u ? TextureCoordinate{places[i], 1.0} : TextureCoordinate{1.0, places[i]};
    }
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        const bool is_there = row == 1 && column == 1;
        EXPECT_NEAR(udim_tile(surface, 1001 + 10 * row + column).total_area(), is_there ? 2.0 : 0.0,
                    1e-12)
            << column << ", " << row;
      }
    }
  }
}

TEST(UdimTile, SharesMatchSampling) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    Surface surface = random_surface(seed, 3);
    for (int k = 0; k < 3; ++k) {
      Surface one = surface;
      one.triangles = {surface.triangles[k]};
      one.uvs = {surface.uvs[k]};
      one.areas = {surface.areas[k]};
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
          const Surface tile = udim_tile(one, 1001 + column + 10 * row);
          EXPECT_NEAR(tile.total_area() / one.total_area(), sampled_share(one.uvs[0], column, row),
                      4e-3)
              << "seed " << seed << " triangle " << k << " tile " << column << ", " << row;
        }
      }
    }
  }
}

TEST(UdimTile, IndicesNameVerticesAndUvsLieInTheSquare) {
  const Surface tile = udim_tile(random_surface(1, 200), 1012);
  ASSERT_GT(tile.triangle_count(), 0u);
  ASSERT_EQ(tile.triangles.size(), tile.areas.size());
  ASSERT_EQ(tile.uvs.size(), tile.areas.size());
  for (std::size_t k = 0; k < tile.triangle_count(); ++k) {
    EXPECT_GT(tile.areas[k], 0.0);
    for (int i = 0; i < 3; ++i) {
      const TextureCoordinate& uv = tile.uvs[k][i];
      ASSERT_LT(static_cast<std::size_t>(tile.triangles[k][i]), tile.positions.size());
      const auto& position = tile.positions[tile.triangles[k][i]];
      EXPECT_GE(uv.u, 0.0);
      EXPECT_LE(uv.u, 1.0);
      EXPECT_GE(uv.v, 0.0);
      EXPECT_LE(uv.v, 1.0);
      EXPECT_NEAR(position[0], uv.u + 1.0, 1e-13);
      EXPECT_NEAR(position[1], uv.v + 1.0, 1e-13);
    }
  }
}

TEST(UdimTile, RefusesInvalidNumbers) {
  for (const int number : {-1, 0, 1000, 10000}) {
    EXPECT_THROW(udim_tile(Surface(), number), Error) << number;
  }
}

}  // namespace
}  // namespace prefilter
