// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/screened_solve.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "points/reconstruct/test_cloud.h"
#include "prefilter/geometry/spatial/morton.h"
#include "prefilter/points/reconstruct/coarse_tree.h"
#include "prefilter/points/reconstruct/surface_level.h"
#include "prefilter/points/reconstruct/whole_samples.h"

namespace prefilter {
namespace {

constexpr int kLevels = 3;
constexpr int kSide = 1 << kLevels;

// A regular grid of cells as a tree, with the samples of each cell.
struct Grid {
  CellTree tree;
  std::vector<NodeLevel> levels{kLevels};

  Grid() {
    tree.levels.resize(kLevels);
    for (int k = 0; k < kLevels; ++k) {
      const auto level = static_cast<std::size_t>(k);
      const std::size_t blocks = std::size_t{1} << (3 * k);
      tree.levels[level].blocks.resize(blocks);
      tree.levels[level].split.assign(blocks, k + 1 < kLevels ? 0xFF : 0);
      link_blocks(&tree.levels[level]);
      levels[level].has_flux.assign(blocks, 0xFF);
      levels[level].fluxes.resize(8 * blocks);
      for (std::size_t b = 0; b < blocks; ++b) {
        levels[level].places.push_back(b);
        levels[level].first_flux.push_back(static_cast<std::uint32_t>(8 * b));
      }
    }
  }
  BlockSources sources() const {
    BlockSources found;
    for (const NodeLevel& level : levels) {
      found.emplace_back();
      for (std::size_t b = 0; b < level.places.size(); ++b) found.back().push_back({&level, b});
    }
    return found;
  }
  float& value(const std::array<int, 3>& cell) {
    const std::uint64_t place = morton_index(cell);
    return tree.levels.back().blocks[place >> 3U][place & 7U];
  }
  OctantFlux& flux(const std::array<int, 3>& cell) {
    return levels.back().fluxes[morton_index(cell)];
  }
};

template <typename Visit>
void for_cells(const Visit& visit) {
  for (int z = 0; z < kSide; ++z) {
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) visit(std::array<int, 3>{x, y, z});
    }
  }
}

// The energy by its definition: sums over faces between cells and over cells with samples.
double energy(Grid* grid, double middle) {
  constexpr double kScreening = 2.0;
  double sum = 0.0;
  for_cells([&](const std::array<int, 3>& cell) {
    const OctantFlux& own = grid->flux(cell);
    for (std::size_t a = 0; a < 3; ++a) {
      if (cell[a] + 1 == kSide) continue;
      std::array<int, 3> next = cell;
      ++next[a];
      const OctantFlux& other = grid->flux(next);
      const double difference = -static_cast<double>(own.moment[a]) -
                                static_cast<double>(other.area[a] - other.moment[a]);
      const double off = static_cast<double>(grid->value(next) - grid->value(cell)) - difference;
      sum += off * off;
    }
    if (!(own.sampled.area > 0.0F)) return;
    double at_samples = static_cast<double>(grid->value(cell));
    double squared = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      squared += static_cast<double>(own.area[a]) * static_cast<double>(own.area[a]);
      const double off = static_cast<double>(own.sampled.moment[a] / own.sampled.area) - 0.5;
      std::array<int, 3> next = cell;
      next[a] += off > 0.0 ? 1 : -1;
      if (next[a] < 0 || next[a] == kSide) continue;
      at_samples += std::abs(off) * static_cast<double>(grid->value(next) - grid->value(cell));
    }
    const auto area = static_cast<double>(own.sampled.area);
    const double coherence = std::min(squared / (area * area), 1.0);
    sum += kScreening * area * coherence * (at_samples - middle) * (at_samples - middle);
  });
  return sum;
}

// Adds samples of a plane through the grid, with noise, cell by cell.
void add_plane_samples(double noise, std::mt19937* random, Grid* grid) {
  std::normal_distribution<double> normal;
  constexpr double kHeight = 4.3;
  for_cells([&](const std::array<int, 3>& cell) {
    if (cell[2] != 4) return;
    OctantFlux& flux = grid->flux(cell);
    const double area = 1.0 + noise * normal(*random);
    const double height = kHeight - cell[2] + 0.3 * noise * normal(*random);
    flux.area = {static_cast<float>(noise * normal(*random)), 0.0F, static_cast<float>(area)};
    flux.moment = {flux.area[0] / 2.0F, 0.0F, static_cast<float>(area * height)};
    flux.sampled.area = static_cast<float>(std::abs(area));
    const float mean = flux.sampled.area;
    flux.sampled.moment = {mean / 2.0F, mean / 2.0F, mean * static_cast<float>(height)};
  });
}

TEST(ScreenedSolve, KeepsAConsistentSolution) {
  Grid grid;
  std::mt19937 random(3);
  add_plane_samples(0.0, &random, &grid);
  // The function is 1 below the plane, and at the mean of two known neighbors it is 1/2.
  const auto expected = [](int z) { return z < 4 ? 1.0F : z == 4 ? 0.3F : 0.0F; };
  for_cells([&](const std::array<int, 3>& cell) { grid.value(cell) = expected(cell[2]); });
  const double before = energy(&grid, 0.5);
  solve_screened(grid.sources(), kLevels - 1, 0.5F, &grid.tree);
  EXPECT_LE(energy(&grid, 0.5), before + 1e-6);
  for_cells([&](const std::array<int, 3>& cell) {
    EXPECT_NEAR(grid.value(cell), expected(cell[2]), 0.1F) << cell[2];
  });
}

// The energy is minimal where no step along any coordinate lowers it.
TEST(ScreenedSolve, ApproachesTheLeastSquaresMinimum) {
  for (const float middle : {0.5F, -0.5F}) {
    Grid grid;
    std::mt19937 random(5);
    add_plane_samples(0.4, &random, &grid);
    for_cells([&](const std::array<int, 3>& cell) {
      grid.value(cell) = cell[2] < 4 ? 0.5F + middle : middle - 0.5F;
    });
    const double before = energy(&grid, static_cast<double>(middle));
    solve_screened(grid.sources(), kLevels - 1, middle, &grid.tree);
    const double found = energy(&grid, static_cast<double>(middle));
    EXPECT_LT(found, before);
    // Coordinate descent: the energy is a parabola along each coordinate.
    Grid best = grid;
    for (int round = 0; round < 2; ++round) {
      for_cells([&](const std::array<int, 3>& cell) {
        float& x = best.value(cell);
        const float old = x;
        const double at = energy(&best, static_cast<double>(middle));
        x = old + 0.01F;
        const double high = energy(&best, static_cast<double>(middle));
        x = old - 0.01F;
        const double low = energy(&best, static_cast<double>(middle));
        x = old + static_cast<float>(0.005 * (low - high) / (high + low - 2.0 * at));
      });
    }
    EXPECT_LT(found, 1.1 * energy(&best, static_cast<double>(middle)));
  }
}

// Misaligned scans add surface that does not exist, and their differences contradict each other.
TEST(ScreenedSolve, IsOneHalfAtSamplesOfMisalignedScans) {
  constexpr int kDepth = 6;
  testing::TestCloud cloud = testing::sphere_cloud(40000);
  for (std::size_t i = 0; i < cloud.points.size(); i += 2) cloud.points[i][0] += 0.8 / 64.0;
  testing::CloudStore store(cloud, kDepth, 3);
  Slabs slabs(&store, kDepth, kDepth - 3, 0, true, 1);
  compute_whole_samples(0, prefilter::Run(1), &slabs);
  build_coarse_tree(prefilter::Run(1), &slabs);
  const auto off_at_samples = [&](SlabStage stage) {
    slabs.advance_to(0, slabs.count(), stage);
    double sum = 0.0;
    double count = 0.0;
    for (int s = 0; s < slabs.count(); ++s) {
      const CellTree tree = tree_around(slabs, s, kContourOctants, 1.0F);
      for (const SampleCell& cell : slabs.samples(s)->at(kDepth).samples.cells) {
        const double value = static_cast<double>(leaf_value(tree, kDepth, cell_position(cell.key)));
        sum += std::abs(value - 0.5);
        count += 1.0;
      }
    }
    return sum / count;
  };
  const double before = off_at_samples(SlabStage::kValues);
  slabs.target = 0.5F;
  EXPECT_LT(off_at_samples(SlabStage::kSolved), 0.9 * before);
}

}  // namespace
}  // namespace prefilter
