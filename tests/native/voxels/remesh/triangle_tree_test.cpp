// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/remesh/triangle_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <random>
#include <set>
#include <vector>

namespace prefilter {
namespace {

bool do_meet(const FloatBox& a, const FloatBox& b) {
  bool overlaps = true;
  for (std::size_t k = 0; k < 3; ++k) {
    overlaps = overlaps && a.low[k] <= b.high[k] && b.low[k] <= a.high[k];
  }
  return overlaps;
}

struct Soup {
  std::vector<Vector3> positions;
  std::vector<std::array<std::int32_t, 3>> triangles;
  Box box = kEmptyBox;
};

Soup soup(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Soup made;
  for (std::size_t t = 0; t < count; ++t) {
    const Vector3 at = {20 * uniform(random), 20 * uniform(random), 5 * uniform(random)};
    const double size = t % 50 == 0 ? 15.0 : 1.0;
    const auto first = static_cast<std::int32_t>(made.positions.size());
    for (int i = 0; i < 3; ++i) {
      made.positions.push_back(
          at + Vector3{size * uniform(random), size * uniform(random), size * uniform(random)});
      made.box.include(made.positions.back());
    }
    made.triangles.push_back({first, first + 1, first + 2});
  }
  return made;
}

TEST(TriangleTree, HasAllTrianglesOnceInBoxesAroundThem) {
  for (const std::size_t count : {1U, 7U, 8U, 9U, 33U, 700U}) {
    const Soup made = soup(count, 1);
    std::vector<std::uint8_t> is_suspect(count, 0);
    for (std::size_t t = 0; t < count; t += 3) is_suspect[t] = 1;
    const TriangleTree tree =
        build_tree({made.positions, made.triangles}, is_suspect, made.box, prefilter::Run(2));
    std::multiset<std::uint32_t> found;
    for (std::size_t i = 0; i < tree.leaves.size(); ++i) {
      const TriangleLeaf& leaf = tree.leaves[i];
      const FloatBox all = tree.box(i);
      for (unsigned k = 0; k < leaf.count; ++k) {
        found.insert(leaf.triangles[k]);
        EXPECT_EQ(leaf.vertices[k], made.triangles[leaf.triangles[k]]);
        EXPECT_EQ((leaf.suspects >> k) & 1U, is_suspect[leaf.triangles[k]]);
        const FloatBox box = leaf.box(k);
        for (std::size_t a = 0; a < 3; ++a) {
          EXPECT_LE(all.low[a], box.low[a]);
          EXPECT_GE(all.high[a], box.high[a]);
          EXPECT_LE(0.0F, box.low[a]);
          EXPECT_GE(1.0F, box.high[a]);
        }
      }
    }
    EXPECT_EQ(found.size(), count);
    EXPECT_EQ(std::set<std::uint32_t>(found.begin(), found.end()).size(), count);
    EXPECT_EQ(tree.levels.back().boxes.size(), 1U);
  }
}

TEST(TriangleTree, FindsTheLeavesThatOverlapOne) {
  const Soup made = soup(1500, 4);
  for (const unsigned every : {1U, 8U, 100U}) {
    std::vector<std::uint8_t> is_suspect(made.triangles.size(), 0);
    // Suspects are chosen by position, so that some leaves contain nothing else.
    for (std::size_t t = 0; t < is_suspect.size(); ++t) {
      is_suspect[t] = made.positions[3 * t][0] < 0.0 || t % every == 0 ? 1 : 0;
    }
    const TriangleTree tree =
        build_tree({made.positions, made.triangles}, is_suspect, made.box, prefilter::Run(1));
    NearLeaves near;
    std::size_t left_out = 0;
    for (std::size_t i = 0; i < tree.leaves.size(); ++i) {
      find_near(tree, i, &near);
      const std::set<std::size_t> found(near.leaves.begin(), near.leaves.end());
      EXPECT_EQ(found.size(), near.leaves.size());
      for (std::size_t j = 0; j < tree.leaves.size(); ++j) {
        const bool has_others =
            static_cast<unsigned>(std::popcount(tree.leaves[j].suspects)) < tree.leaves[j].count;
        const bool is_met = do_meet(tree.box(i), tree.box(j));
        EXPECT_EQ(found.contains(j), is_met && (has_others || j >= i));
        left_out += is_met && !found.contains(j) ? 1 : 0;
      }
      for (std::size_t k = 0; k < near.leaves.size(); ++k) {
        EXPECT_EQ(near.boxes[k / 4].box(k % 4).low, tree.box(near.leaves[k]).low);
      }
    }
    EXPECT_GT(left_out, 10U);
  }
}

TEST(TriangleTree, ComparesFourBoxesAtOnce) {
  std::mt19937 random(6);
  const auto box = [&] {
    FloatBox made;
    for (std::size_t a = 0; a < 3; ++a) {
      const float p = static_cast<float>(random() % 5);
      const float q = static_cast<float>(random() % 5);
      made.low[a] = std::min(p, q);
      made.high[a] = std::max(p, q);
    }
    return made;
  };
  for (int round = 0; round < 500; ++round) {
    FourBoxes four;
    unsigned expected = 0;
    const FloatBox other = box();
    for (std::size_t i = 0; i < 4; ++i) {
      const FloatBox one = i == 3 && round % 2 == 0 ? FloatBox() : box();
      four.set(i, one);
      expected |= do_meet(one, other) ? 1U << i : 0U;
    }
    EXPECT_EQ(four.overlap_mask(other), expected);
  }
}

}  // namespace
}  // namespace prefilter
