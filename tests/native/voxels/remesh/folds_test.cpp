// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/remesh/folds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace prefilter {
namespace {

using Triangle = std::array<std::int32_t, 3>;
using Flags = std::vector<std::uint8_t>;
using Pairs = std::vector<std::array<std::uint32_t, 2>>;

// A sheet of squares with random heights, some of which have no area.
struct Sheet {
  std::vector<Vector3> positions;
  std::vector<Triangle> triangles;

  explicit Sheet(double height) {
    constexpr std::int32_t kSide = 20;
    std::mt19937 random(5);
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
    for (std::int32_t i = 0; i < (kSide + 1) * (kSide + 1); ++i) {
      positions.push_back({i % (kSide + 1) + 0.8 * uniform(), i / (kSide + 1) + 0.8 * uniform(),
                           height * uniform()});
      if (i % 50 == 49) positions.back() = positions[positions.size() - 2];
    }
    for (std::int32_t i = 0; i < kSide * kSide; ++i) {
      const std::int32_t a = i / kSide * (kSide + 1) + i % kSide;
      triangles.push_back({a, a + 1, a + kSide + 2});
      triangles.push_back({a, a + kSide + 2, a + kSide + 1});
    }
  }

  MeshView<std::int32_t> view() const { return {positions, triangles}; }

  bool share_side(std::size_t t, std::size_t u) const {
    return std::count_if(triangles[t].begin(), triangles[t].end(), [&](std::int32_t v) {
             return std::find(triangles[u].begin(), triangles[u].end(), v) != triangles[u].end();
           }) == 2;
  }

  double cosine(std::size_t t, std::size_t u) const {
    std::array<Vector3, 2> normals;
    for (const std::size_t i : {0U, 1U}) {
      const auto [a, b, c] = view().corners(i == 0 ? t : u);
      normals[i] = cross(b - a, c - a);
    }
    const double sizes = length(normals[0]) * length(normals[1]);
    return sizes > 0.0 ? dot(normals[0], normals[1]) / sizes : 1.0;
  }

  // Brute force over all pairs.
  Pairs folds(const Flags& is_suspect) const {
    Pairs found;
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      for (std::uint32_t u = t + 1; u < triangles.size(); ++u) {
        const bool is_counted = is_suspect.empty() || (is_suspect[t] | is_suspect[u]) != 0;
        if (is_counted && share_side(t, u) && cosine(t, u) < kFold) found.push_back({t, u});
      }
    }
    return found;
  }
};

Pairs in_order(Pairs pairs) {
  for (auto& pair : pairs) std::sort(pair.begin(), pair.end());
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

TEST(FoldedPairs, TurnByMoreThan120Degrees) {
  for (const double height : {0.2, 1.5, 4.0, 1e-3}) {
    const Sheet sheet(height);
    const Pairs expected = sheet.folds({});
    if (height > 1.0) {
      EXPECT_GT(expected.size(), 10U);
    }
    EXPECT_EQ(in_order(folded_pairs(sheet.view(), 0, {}, {})), expected) << height;
  }
}

TEST(FoldedPairs, HaveAtLeastOneSuspect) {
  const Sheet sheet(3.0);
  Flags is_suspect(sheet.triangles.size(), 0);
  for (std::size_t t = 0; t < is_suspect.size(); t += 5) is_suspect[t] = 1;
  const Pairs expected = sheet.folds(is_suspect);
  EXPECT_GT(expected.size(), 10U);
  EXPECT_EQ(in_order(folded_pairs(sheet.view(), 0, is_suspect, {})), expected);
}

}  // namespace
}  // namespace prefilter
