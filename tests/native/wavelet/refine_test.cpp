// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/wavelet/refine.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>

#include "prefilter/wavelet/leaf_surface.h"
#include "wavelet/random_tree.h"

namespace prefilter {
namespace {

constexpr int kSamples = 16;

// A tree of this depth with the occupancies of a function, by sampling; uniform cells are leaves.
CellTree sampled_tree(int depth, const std::function<double(const Vector3&)>& occupancy) {
  CellTree tree;
  tree.levels.resize(static_cast<std::size_t>(depth));
  const auto build = [&](const auto& self, int at_depth, const LeafPlace& at) -> float {
    const double side = std::ldexp(1.0, -at_depth);
    if (at_depth == depth) {
      return static_cast<float>(
          occupancy({(at[0] + 0.5) * side, (at[1] + 0.5) * side, (at[2] + 0.5) * side}));
    }
    TreeLevel& level = tree.levels[static_cast<std::size_t>(at_depth)];
    const std::size_t block = level.size();
    level.blocks.emplace_back();
    level.split.push_back(at_depth + 1 < depth ? 0xFF : 0);
    for (int o = 0; o < 8; ++o) {
      const float value = self(self, at_depth + 1, octant_place(at, o));
      level.blocks[block][static_cast<std::size_t>(o)] = value;
    }
    return block_mean(level.blocks[block]);
  };
  tree.root = build(build, 0, {0, 0, 0});
  for (TreeLevel& level : tree.levels) link_blocks(&level);
  return tree;
}

// The share of a cell that is inside, by sampling.
template <typename Inside>
std::function<double(const Vector3&)> share_of(double side, const Inside& inside) {
  return [=](const Vector3& middle) {
    int count = 0;
    for (int i = 0; i < kSamples * kSamples * kSamples; ++i) {
      const Vector3 offset = {static_cast<double>(i % kSamples),
                              static_cast<double>(i / kSamples % kSamples),
                              static_cast<double>(i / kSamples / kSamples)};
      Vector3 point = middle;
      for (int a = 0; a < 3; ++a) point[a] += side * ((offset[a] + 0.5) / kSamples - 0.5);
      count += inside(point) ? 1 : 0;
    }
    return static_cast<double>(count) / (kSamples * kSamples * kSamples);
  };
}

// Calls visit(depth, place, value) for all leaves.
void for_leaves(const CellTree& tree,
                const std::function<void(int, const LeafPlace&, float)>& visit) {
  const auto descend = [&](const auto& self, std::size_t level, std::size_t block,
                           const LeafPlace& at) -> void {
    for (int o = 0; o < 8; ++o) {
      const LeafPlace place = octant_place(at, o);
      if (tree.levels[level].is_split(block, o)) {
        self(self, level + 1, tree.levels[level].child(block, o), place);
      } else {
        visit(static_cast<int>(level) + 1, place,
              tree.levels[level].blocks[block][static_cast<std::size_t>(o)]);
      }
    }
  };
  descend(descend, 0, 0, {0, 0, 0});
}

TEST(Refined, LeavesKeepTheirOccupancy) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const CellTree tree = random_tree(seed, 4);
    const CellTree fine = refined(tree, 6, prefilter::Run(1));
    EXPECT_EQ(fine.depth(), 6);
    for_leaves(tree, [&](int depth, const LeafPlace& at, float value) {
      EXPECT_NEAR(occupancy_at(fine, depth, at), value, 1e-6);
    });
  }
}

TEST(Refined, ThreadsChangeNothing) {
  const CellTree tree = random_tree(7, 5);
  const CellTree one = refined(tree, 6, prefilter::Run(1));
  const CellTree many = refined(tree, 6, prefilter::Run(5));
  ASSERT_EQ(one.levels.size(), many.levels.size());
  for (std::size_t k = 0; k < one.levels.size(); ++k) {
    EXPECT_EQ(one.levels[k].blocks, many.levels[k].blocks);
    EXPECT_EQ(one.levels[k].split, many.levels[k].split);
  }
}

// The share of a cube below a plane, from the tetrahedra that it cuts off at the corners.
double share_below(const Vector3& middle, double side, const Vector3& normal, double offset) {
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    double below = offset;
    double sign = 1.0;
    for (int a = 0; a < 3; ++a) {
      const bool is_high = ((corner >> a) & 1) != 0;
      below -= normal[a] * (middle[a] + (is_high ? side : -side) / 2.0);
      if (is_high == (normal[a] > 0.0)) sign = -sign;
    }
    if (below > 0.0) sum += sign * below * below * below;
  }
  return sum / (6.0 * std::abs(normal[0] * normal[1] * normal[2]) * side * side * side);
}

TEST(Refined, APlaneStaysAPlane) {
  const Vector3 normal = {0.48, -0.6, 0.64};
  const double offset = dot({0.47, 0.52, 0.51}, normal);
  const CellTree tree = sampled_tree(
      4, [&](const Vector3& middle) { return share_below(middle, 1.0 / 16.0, normal, offset); });
  const CellTree fine = refined(tree, 6, prefilter::Run(1));
  double worst = 0.0;
  int count = 0;
  for_leaves(fine, [&](int depth, const LeafPlace& at, float value) {
    for (const int x : at) {
      // The half-space is cut off at the root's border.
      const int margin = 1 << (depth - 2);
      if (x < margin || x >= (1 << depth) - margin) return;
    }
    EXPECT_TRUE(depth == 6 || !is_fraction(value));
    const double side = std::ldexp(1.0, -depth);
    const Vector3 middle = {(at[0] + 0.5) * side, (at[1] + 0.5) * side, (at[2] + 0.5) * side};
    const double share = share_below(middle, side, normal, offset);
    worst = std::max(worst, std::abs(share - static_cast<double>(value)));
    count += depth == 6 ? 1 : 0;
  });
  EXPECT_GT(count, 1000);
  EXPECT_LT(worst, 1e-3);
}

TEST(Refined, ABallIsAsRoundAsItsCellsLet) {
  constexpr double kRadius = 0.37;
  const auto inside = [&](const Vector3& p) {
    const Vector3 q = p - Vector3{0.49, 0.51, 0.503};
    return dot(q, q) < kRadius * kRadius;
  };
  const CellTree tree = sampled_tree(5, share_of(1.0 / 32.0, inside));
  const CellTree fine = refined(tree, 6, prefilter::Run(1));
  const auto expected = share_of(1.0 / 64.0, inside);
  double worst = 0.0;
  double sum = 0.0;
  int count = 0;
  for_leaves(fine, [&](int depth, const LeafPlace& at, float value) {
    if (depth < 6) return;
    const Vector3 middle = {(at[0] + 0.5) / 64.0, (at[1] + 0.5) / 64.0, (at[2] + 0.5) / 64.0};
    const double off = std::abs(expected(middle) - static_cast<double>(value));
    worst = std::max(worst, off);
    sum += off;
    ++count;
  });
  EXPECT_LT(worst, 0.04);
  EXPECT_LT(sum / count, 0.005);
}

TEST(Refined, FullBesideEmptyIsSplit) {
  // Half of the root, in cells of depth 2: all are full or empty.
  const CellTree tree = sampled_tree(2, [](const Vector3& p) { return p[0] < 0.5 ? 1.0 : 0.0; });
  EXPECT_FALSE(has_coarse_surface(tree));
  const CellTree fine = refined(tree, 5, prefilter::Run(1));
  for_leaves(fine, [&](int depth, const LeafPlace& at, float value) {
    EXPECT_EQ(value, at[0] < 1 << (depth - 1) ? 1.0F : 0.0F);
    const bool is_beside = at[0] == 1 << (depth - 1) || at[0] + 1 == 1 << (depth - 1);
    EXPECT_TRUE(depth == 5 || !is_beside);
  });
}

TEST(Refined, FineLeavesDoNotChange) {
  const CellTree tree = sampled_tree(
      4, share_of(1.0 / 16.0, [](const Vector3& p) { return p[0] + p[1] + 0.3 * p[2] < 1.1; }));
  const CellTree same = refined(tree, 4, prefilter::Run(1));
  EXPECT_FALSE(has_coarse_surface(tree));
  for_leaves(tree, [&](int depth, const LeafPlace& at, float value) {
    EXPECT_EQ(occupancy_at(same, depth, at), value);
  });
}

}  // namespace
}  // namespace prefilter
