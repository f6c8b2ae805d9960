// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/geometry/texels/tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <random>

namespace prefilter {
namespace {

// The number of texels between two tiles along a periodic axis.
int texels_between(int a, int b, int count, int size) {
  const auto begin = [](int tile) { return tile * Tiles::kSize; };
  const auto end = [&](int tile) { return std::min(begin(tile + 1), size); };
  const int low = std::min(a, b);
  const int high = std::max(a, b);
  static_cast<void>(count);
  return std::min(begin(high) - end(low), begin(low) + size - end(high));
}

TEST(Tiles, TilesOfOneColorAreATileApart) {
  for (int size = 1; size <= 12 * Tiles::kSize; ++size) {
    const int count = (size + Tiles::kSize - 1) / Tiles::kSize;
    for (int a = 0; a < count; ++a) {
      const int color = tile_color(a, count, size);
      EXPECT_GE(color, 0);
      EXPECT_LT(color, kTileColors);
      for (int b = a + 1; b < count; ++b) {
        if (tile_color(b, count, size) != color) continue;
        EXPECT_GE(texels_between(a, b, count, size), Tiles::kSize)
            << size << ": " << a << ", " << b;
      }
    }
  }
}

TEST(Tiles, HaveTheTrianglesThatMeetThem) {
  TexelTriangles triangles;
  triangles.width = 100;
  triangles.height = 70;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int t = 0; t < 500; ++t) {
    MassTriangle triangle{};
    const double x = 80.0 * unit(random);
    const double y = 60.0 * unit(random);
    for (GridPoint& corner : triangle.corners) {
      corner = {std::min(x + 30.0 * unit(random), 100.0), std::min(y + 30.0 * unit(random), 70.0)};
    }
    triangles.triangles.push_back(triangle);
  }
  const Tiles tiles(triangles, prefilter::Run(3));
  ASSERT_EQ(tiles.count(), 4 * 3);
  for (std::int64_t tile = 0; tile < tiles.count(); ++tile) {
    const auto [x0, y0, x1, y1] = tiles.window(tile);
    EXPECT_TRUE(std::is_sorted(tiles.begin(tile), tiles.end(tile)));
    for (std::uint32_t t = 0; t < triangles.triangles.size(); ++t) {
      const auto& p = triangles.triangles[t].corners;
      const auto [left, right] = std::minmax({p[0].x, p[1].x, p[2].x});
      const auto [bottom, top] = std::minmax({p[0].y, p[1].y, p[2].y});
      const bool meets = left < x1 && right > x0 && bottom < y1 && top > y0;
      const bool is_there = std::binary_search(tiles.begin(tile), tiles.end(tile), t);
      if (meets) {
        EXPECT_TRUE(is_there) << tile << ", " << t;
      }
      if (is_there) {
        EXPECT_TRUE(left <= x1 && right >= x0 && bottom <= y1 && top >= y0) << tile << ", " << t;
      }
    }
  }
  std::mutex mutex;
  std::vector<std::int64_t> visited;
  tiles.for_each_apart(prefilter::Run(3), [&](std::int64_t tile) {
    const std::lock_guard lock(mutex);
    visited.push_back(tile);
  });
  std::sort(visited.begin(), visited.end());
  ASSERT_EQ(visited.size(), 12U);
  for (std::int64_t tile = 0; tile < 12; ++tile) EXPECT_EQ(visited[tile], tile);
}

}  // namespace
}  // namespace prefilter
