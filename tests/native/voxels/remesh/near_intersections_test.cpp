// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/remesh/near_intersections.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace prefilter {
namespace {

struct Sheets {
  std::vector<Vector3> positions;
  std::vector<std::array<std::int32_t, 3>> triangles;

  // Adds 16 x 16 unit squares at height(x), facing up or down.
  template <typename Height>
  void add(const Height& height, bool faces_down) {
    constexpr std::int32_t kSide = 16;
    const auto first = static_cast<std::int32_t>(positions.size());
    for (int i = 0; i <= kSide; ++i) {
      for (int j = 0; j <= kSide; ++j) {
        positions.push_back({static_cast<double>(i), static_cast<double>(j), height(i)});
      }
    }
    for (std::int32_t i = 0; i < kSide; ++i) {
      for (std::int32_t j = 0; j < kSide; ++j) {
        const std::int32_t a = first + i * (kSide + 1) + j;
        const std::int32_t b = a + kSide + 1;
        triangles.push_back({a, faces_down ? a + 1 : b, faces_down ? b : a + 1});
        triangles.push_back({b, faces_down ? a + 1 : b + 1, faces_down ? b + 1 : a + 1});
      }
    }
  }

  std::vector<std::uint8_t> rough() const {
    return keep_rough_suspects({positions, triangles}, 0,
                               std::vector<std::uint8_t>(triangles.size(), 1), 2.0, {});
  }
};

TEST(KeepRoughSuspects, DropsSlightlyBentSurfaces) {
  Sheets sheets;
  sheets.add([](int i) { return 2.0 * std::sin(0.3 * i); }, false);
  sheets.add([](int i) { return 12.0 + 2.0 * std::sin(0.3 * i); }, true);
  EXPECT_EQ(sheets.rough(), std::vector<std::uint8_t>(sheets.triangles.size(), 0));
}

TEST(KeepRoughSuspects, KeepsOpposedSurfacesAndEdges) {
  Sheets thin;
  thin.add([](int) { return 0.2; }, false);
  thin.add([](int) { return 0.7; }, true);
  EXPECT_EQ(thin.rough(), std::vector<std::uint8_t>(thin.triangles.size(), 1));
  Sheets ridge;
  ridge.add([](int i) { return 3.0 * std::min(i, 16 - i); }, false);
  const std::vector<std::uint8_t> is_rough = ridge.rough();
  for (std::size_t t = 0; t < is_rough.size(); ++t) {
    const auto row = static_cast<int>(t / 32);
    if (row == 7 || row == 8) {
      EXPECT_EQ(is_rough[t], 1) << t;
    }
    if (row < 4 || row > 11) {
      EXPECT_EQ(is_rough[t], 0) << t;
    }
  }
}

TEST(KeepRoughSuspects, KeepsAllOfFewSuspects) {
  Sheets sheets;
  sheets.add([](int) { return 0.0; }, false);
  std::vector<std::uint8_t> is_suspect(sheets.triangles.size(), 0);
  is_suspect[5] = 1;
  EXPECT_EQ(keep_rough_suspects({sheets.positions, sheets.triangles}, 0, is_suspect, 2.0, {}),
            is_suspect);
}

}  // namespace
}  // namespace prefilter
