// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/fit_values.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "prefilter/voxels/contour/contour_slab.h"

namespace prefilter {
namespace {

constexpr int kDepth = 5;
constexpr int kSide = 1 << kDepth;
constexpr double kShift = 0.15;  // of the tree's plane from the samples', in cells
constexpr float kIsovalue = 0.5F;

struct Plane {
  Vector3 middle = {16.2, 15.7, 16.1};
  Vector3 normal = {0.48, 0.6, 0.64};

  double distance(const Vector3& p) const { return dot(p - middle, normal); }
};

// A tree of cells of one size whose values fall from 1 to 0 across a plane.
CellTree tree_of(const Plane& plane, double shift) {
  CellTree tree;
  tree.levels.resize(kDepth);
  std::vector<CellCoordinates> cells = {{0, 0, 0}};
  for (int k = 0; k < kDepth; ++k) {
    TreeLevel& level = tree.levels[static_cast<std::size_t>(k)];
    std::vector<CellCoordinates> next;
    const double size = std::ldexp(1.0, kDepth - k - 1);
    for (const CellCoordinates& cell : cells) {
      OctantValues values;
      for (int o = 0; o < 8; ++o) {
        const CellCoordinates at = octant_at(cell, o);
        Vector3 center;
        for (std::size_t a = 0; a < 3; ++a) center[a] = (at[a] + 0.5) * size;
        const double value = 0.5 - 0.4 * (plane.distance(center) - shift);
        values[static_cast<std::size_t>(o)] = static_cast<float>(std::clamp(value, 0.0, 1.0));
        next.push_back(at);
      }
      level.blocks.push_back(values);
      level.split.push_back(k + 1 < kDepth ? 255 : 0);
    }
    link_blocks(&level);
    cells = std::move(next);
  }
  return tree;
}

// One sample per cell the plane crosses, off the plane by normal noise of this deviation.
SampleLevel level_of(const Plane& plane, double noise) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(1.0, kSide - 1.0);
  std::normal_distribution<double> off(0.0, noise > 0.0 ? noise : 1.0);
  std::map<CellKey, SampleCell> cells;
  for (int i = 0; i < 6000; ++i) {
    Vector3 p = {uniform(random), uniform(random), uniform(random)};
    const double move = plane.distance(p) + (noise > 0.0 ? off(random) : 0.0);
    for (std::size_t a = 0; a < 3; ++a) p[a] -= move * plane.normal[a];
    CellPosition at;
    bool is_inside = true;
    for (std::size_t a = 0; a < 3; ++a) {
      at[a] = static_cast<int>(std::floor(p[a]));
      is_inside = is_inside && at[a] >= 0 && at[a] < kSide;
    }
    if (!is_inside) continue;
    SampleCell& cell = cells[cell_key(at)];
    cell.key = cell_key(at);
    cell.weight += 1.0F;
    for (std::size_t a = 0; a < 3; ++a) {
      const double within = p[a] - at[a];
      cell.normal[a] += static_cast<float>(plane.normal[a]);
      cell.position[a] += static_cast<float>(within);
      cell.flux[a] += static_cast<float>(within * plane.normal[a]);
    }
  }
  SampleLevel level;
  for (const auto& [key, cell] : cells) level.samples.cells.push_back(cell);
  return level;
}

class FitValues : public testing::Test {
 protected:
  void take(double noise) {
    level_ = level_of(plane_, noise);
    index_ = SampleIndex(kDepth, 0, kSide);
    index_.add(level_);
    index_.finish();
  }

  CellTree fitted(const HeightRange& heights, const SampleNoise& noise, int largest = 4) const {
    const SampleFit fit([this](int) -> const SampleIndex& { return index_; }, kDepth, noise);
    CellTree tree = tree_of(plane_, kShift);
    fit_values(fit, kIsovalue, {heights, largest}, &tree);
    return tree;
  }

  // Root mean square distance of the contour from the plane, away from the root's border.
  double error(const CellTree& tree) const {
    const ContourSlab contour = contour_slab(tree, kIsovalue, Interpolant::kLinear, {0, kSide});
    double sum = 0.0;
    int count = 0;
    for (const Vector3& vertex : contour.mesh.positions) {
      const Vector3 p = static_cast<double>(kSide) * vertex;
      if (length(p - plane_.middle) > 10.0) continue;
      sum += plane_.distance(p) * plane_.distance(p);
      ++count;
    }
    EXPECT_GT(count, 300);
    return std::sqrt(sum / count);
  }

  Plane plane_;
  SampleLevel level_;
  SampleIndex index_{kDepth, 0, kSide};
};

TEST_F(FitValues, MovesThePlaneToItsSamples) {
  take(0.0);
  EXPECT_NEAR(error(tree_of(plane_, kShift)), kShift, 0.01);
  EXPECT_LT(error(fitted({0, kSide}, {})), 0.01);
}

TEST_F(FitValues, FollowNoiseOnlyPartly) {
  constexpr double kNoise = 0.5;
  take(kNoise);
  const double followed = error(fitted({0, kSide}, {kNoise, 1.0, 1.0}));
  // The fit may keep a part of the shift, and follows little of the noise.
  EXPECT_LT(followed, 1.2 * kShift);
  EXPECT_GT(followed, 0.3 * kShift);
}

TEST_F(FitValues, AgreesBetweenNeighboringSlabs) {
  take(0.1);
  const SampleNoise noise = {0.1, 1.0, 1.0};
  const CellTree whole = fitted({0, kSide}, noise);
  const CellTree below = fitted({0, 16}, noise);
  const CellTree above = fitted({16, kSide}, noise);
  const auto contour = [](const CellTree& tree, const HeightRange& heights) {
    return contour_slab(tree, kIsovalue, Interpolant::kLinear, heights).mesh.positions;
  };
  EXPECT_EQ(contour(whole, {0, 16}), contour(below, {0, 16}));
  EXPECT_EQ(contour(whole, {16, kSide}), contour(above, {16, kSide}));
}

TEST_F(FitValues, KeepsLargerLeaves) {
  take(0.0);
  const CellTree before = tree_of(plane_, kShift);
  EXPECT_EQ(fitted({0, kSide}, {}, 0).levels.back().blocks, before.levels.back().blocks);
  EXPECT_NE(fitted({0, kSide}, {}, 1).levels.back().blocks, before.levels.back().blocks);
}

TEST_F(FitValues, WithoutSamplesNothingChanges) {
  index_.finish();
  const CellTree before = tree_of(plane_, kShift);
  EXPECT_EQ(fitted({0, kSide}, {}).levels.back().blocks, before.levels.back().blocks);
}

}  // namespace
}  // namespace prefilter
