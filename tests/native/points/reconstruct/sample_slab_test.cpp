// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/sample_slab.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "prefilter/points/reconstruct/sample_index.h"

namespace prefilter {
namespace {

SampleCells cells_at(const std::set<CellKey>& keys) {
  SampleCells cells;
  for (const CellKey key : keys) {
    SampleCell cell;
    cell.key = key;
    cell.weight = 1.0F;
    cell.normal = {0.0F, 0.0F, 1.0F};
    cell.position = {0.25F, 0.5F, 0.75F};
    cell.flux = {0.0F, 0.0F, 0.75F};
    cells.cells.push_back(cell);
  }
  return cells;
}

// Random cells of a depth: each cell between two heights is taken with probability `share`.
std::set<CellKey> random_keys(int depth, int low, int high, double share, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform;
  std::set<CellKey> keys;
  const int side = 1 << depth;
  for (int z = low; z < high; ++z) {
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        if (uniform(random) < share) keys.insert(cell_key({x, y, z}));
      }
    }
  }
  return keys;
}

int neighbors_of(const CellPosition& at, const std::set<CellPosition>& cells) {
  int count = -1;
  for (int z = -1; z <= 1; ++z) {
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) {
        count += static_cast<int>(cells.count({at[0] + x, at[1] + y, at[2] + z}));
      }
    }
  }
  return count;
}

TEST(SampleSlab, CellsAreCrossedIfThreeNeighborsHaveSamples) {
  constexpr int kDepth = 4;
  constexpr int kTop = 2;
  constexpr int kHeight = 1 << (kDepth - kTop);
  for (unsigned seed = 0; seed < 6; ++seed) {
    const double share = 0.02 * (1 << seed) / 2.0;
    std::vector<SampleSlab> slabs;
    std::vector<std::set<CellPosition>> all(kDepth + 1);
    for (int s = 0; s < 3; ++s) {
      // For one seed the middle slab is empty.
      const double own = seed == 2 && s == 1 ? 0.0 : share;
      const std::set<CellKey> keys =
          random_keys(kDepth, s * kHeight, (s + 1) * kHeight, own, 10 * seed + s);
      slabs.push_back(make_sample_slab(cells_at(keys), kDepth, kTop, 0));
      for (const CellKey key : keys) {
        CellPosition at = cell_position(key);
        for (int k = kDepth; k >= kTop; --k) {
          all[static_cast<std::size_t>(k)].insert(at);
          for (std::int32_t& x : at) x /= 2;
        }
      }
    }
    for (std::size_t s = 0; s < 3; ++s) {
      find_crossed_cells(s > 0 ? &slabs[s - 1] : nullptr, s < 2 ? &slabs[s + 1] : nullptr, 1.0,
                         &slabs[s]);
      for (int k = kTop; k <= kDepth; ++k) {
        const SampleLevel& level = slabs[s].at(k);
        ASSERT_EQ(level.occupied.size(), level.size());
        for (std::size_t i = 0; i < level.size(); ++i) {
          const CellPosition at = cell_position(level.samples.cells[i].key);
          const int neighbors = neighbors_of(at, all[static_cast<std::size_t>(k)]);
          ASSERT_EQ(level.occupied[i], neighbors + 1) << seed << " " << s << " " << k;
          ASSERT_EQ(level.is_crossed(i), neighbors >= 3) << seed << " " << s << " " << k;
        }
      }
    }
  }
}

TEST(SampleSlab, CoarserCellsContainTheSameSamples) {
  constexpr int kDepth = 5;
  const std::set<CellKey> keys = random_keys(kDepth, 0, 1 << kDepth, 0.02, 4);
  SampleSlab slab = make_sample_slab(cells_at(keys), kDepth, 0, 0);
  ASSERT_EQ(slab.at(0).size(), 1U);
  for (int k = kDepth; k >= 0; --k) {
    // Sums in coordinates of the root cell.
    double weight = 0.0;
    Vector3 position{};
    double flux = 0.0;
    const std::vector<SampleCell>& cells = slab.at(k).samples.cells;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const SampleCell& cell = cells[i];
      EXPECT_TRUE(i == 0 || cells[i - 1].key < cell.key);
      const CellPosition at = cell_position(cell.key);
      weight += static_cast<double>(cell.weight);
      for (std::size_t a = 0; a < 3; ++a) {
        position[a] += std::ldexp(
            static_cast<double>(cell.position[a] + cell.weight * static_cast<float>(at[a])), -k);
      }
      flux += std::ldexp(
          static_cast<double>(cell.flux[2] + cell.normal[2] * static_cast<float>(at[2])), -k);
      if (k == 0) continue;
      const std::uint32_t parent = slab.at(k).parents[i];
      const CellPosition above = cell_position(slab.at(k - 1).samples.cells[parent].key);
      EXPECT_EQ(above, (CellPosition{at[0] / 2, at[1] / 2, at[2] / 2}));
    }
    Vector3 wanted{};
    for (const CellKey key : keys) {
      const CellPosition at = cell_position(key);
      const Vector3 within = {0.25, 0.5, 0.75};
      for (std::size_t a = 0; a < 3; ++a) wanted[a] += std::ldexp(at[a] + within[a], -kDepth);
    }
    EXPECT_EQ(weight, static_cast<double>(keys.size()));
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(position[a], wanted[a], 1e-5 * wanted[a]);
    EXPECT_NEAR(flux, wanted[2], 1e-5 * wanted[2]);
  }
}

TEST(SampleIndex, FindsTheCellsAroundAPoint) {
  constexpr int kDepth = 4;
  constexpr int kSide = 1 << kDepth;
  const std::set<CellKey> keys = random_keys(kDepth, 0, kSide, 0.4, 5);
  const SampleSlab slab = make_sample_slab(cells_at(keys), kDepth, 0, 0);
  constexpr int kLow = 3;
  constexpr int kHigh = 12;
  SampleIndex index(kDepth, kLow, kHigh);
  index.add(slab.at(kDepth));
  index.finish();
  std::mt19937 random(6);
  std::uniform_real_distribution<double> place(-2.0, kSide + 2.0);
  for (int i = 0; i < 300; ++i) {
    const Vector3 point = {place(random), place(random), place(random)};
    const int reach = i % 4;
    CellPosition middle;
    for (std::size_t a = 0; a < 3; ++a) {
      middle[a] = std::clamp(static_cast<int>(std::floor(point[a])), 0, kSide - 1);
    }
    std::set<CellPosition> wanted;
    for (const CellKey key : keys) {
      const CellPosition at = cell_position(key);
      bool is_near = at[2] >= kLow && at[2] < kHigh;
      for (std::size_t a = 0; a < 3; ++a) is_near = is_near && std::abs(at[a] - middle[a]) <= reach;
      if (is_near) wanted.insert(at);
    }
    std::set<CellPosition> found;
    index.for_near(point, reach, [&](const SampleCells& cells, std::size_t c, const Vector3& low) {
      const CellPosition at = cell_position(cells.cells[c].key);
      EXPECT_EQ(low, (Vector3{static_cast<double>(at[0]), static_cast<double>(at[1]),
                              static_cast<double>(at[2])}));
      EXPECT_TRUE(found.insert(at).second);
    });
    ASSERT_EQ(found, wanted);
  }
}

}  // namespace
}  // namespace prefilter
