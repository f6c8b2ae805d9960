// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/plane_patches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <random>

#include "prefilter/geometry/spatial/morton.h"

namespace prefilter {
namespace {

constexpr int kDepth = 3;
constexpr int kSide = 1 << kDepth;

// Volume of the part of the unit cube (unit square for two components) where n p < d: a sum over
// its corners, for n > 0.
double volume_below(const std::vector<double>& n, double d) {
  double sum = 0.0;
  double scale = 1.0;
  for (std::size_t a = 0; a < n.size(); ++a) scale *= n[a] * static_cast<double>(a + 1);
  for (std::size_t corner = 0; corner < std::size_t{1} << n.size(); ++corner) {
    double rest = d;
    double sign = 1.0;
    for (std::size_t a = 0; a < n.size(); ++a) {
      if (((corner >> a) & 1) == 0) continue;
      rest -= n[a];
      sign = -sign;
    }
    sum += sign * std::pow(std::max(rest, 0.0), static_cast<double>(n.size()));
  }
  return sum / scale;
}

// Boundary flux of the plane n p = d in the unit cube, by the divergence theorem.
BoundaryFlux flux_of_plane(const Vector3& normal, double d) {
  Vector3 n = normal;
  for (double& x : n) {
    // Mirror axes along which the normal is negative.
    if (x < 0.0) d -= x;
    x = std::abs(x);
  }
  const double volume = volume_below({n[0], n[1], n[2]}, d);
  BoundaryFlux flux;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::vector<double> others = {n[(a + 1) % 3], n[(a + 2) % 3]};
    const double low = volume_below(others, d);
    const double high = volume_below(others, d - n[a]);
    flux.area[a] = low - high;
    flux.moment[a] = volume - high;
    if (normal[a] < 0.0) {
      flux.moment[a] -= flux.area[a];
      flux.area[a] = -flux.area[a];
    }
  }
  return flux;
}

// Random points of the plane in a cell; none if none is hit within the allowed tries.
std::optional<SampleCell> samples_in(const CellPosition& at, const Vector3& n, double d,
                                     std::mt19937* random) {
  std::uniform_real_distribution<double> uniform;
  SampleCell cell;
  cell.key = cell_key(at);
  for (int i = 0; i < 200 && cell.weight < 3.0F; ++i) {
    Vector3 p = {uniform(*random), uniform(*random), uniform(*random)};
    double height = -d;
    for (std::size_t a = 0; a < 3; ++a) height += n[a] * (at[a] + p[a]);
    bool is_in = true;
    for (std::size_t a = 0; a < 3; ++a) {
      p[a] -= height * n[a];
      is_in = is_in && p[a] >= 0.0 && p[a] < 1.0;
    }
    if (!is_in) continue;
    cell.weight += 1.0F;
    for (std::size_t a = 0; a < 3; ++a) {
      cell.normal[a] += static_cast<float>(n[a]);
      cell.position[a] += static_cast<float>(p[a]);
      cell.flux[a] += static_cast<float>(p[a] * n[a]);
    }
  }
  if (cell.weight == 0.0F) return std::nullopt;
  return cell;
}

// Cells with samples of the plane, in slabs two cells high.
std::array<SampleLevel, kSide / 2> sampled_plane(const Vector3& n, double d, double missing,
                                                 unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform;
  std::array<SampleLevel, kSide / 2> slabs;
  bool is_last_missing = false;
  for (int z = 0; z < kSide; ++z) {
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const std::optional<SampleCell> cell = samples_in({x, y, z}, n, d, &random);
        if (!cell) continue;
        is_last_missing = !is_last_missing && uniform(random) < missing;
        if (is_last_missing) continue;
        SampleLevel& slab = slabs[static_cast<std::size_t>(z / 2)];
        slab.samples.cells.push_back(*cell);
        slab.is_leaf.push_back(1);
        slab.is_split.push_back(0);
      }
    }
  }
  return slabs;
}

std::map<std::uint64_t, BoundaryFlux> patches_of(const std::array<SampleLevel, kSide / 2>& slabs) {
  std::map<std::uint64_t, BoundaryFlux> found;
  for (std::size_t s = 0; s < slabs.size(); ++s) {
    const int low = 2 * static_cast<int>(s);
    PooledFlux patches(kDepth + 1);
    const SampleLevel* below = s > 0 ? &slabs[s - 1] : nullptr;
    const SampleLevel* above = s + 1 < slabs.size() ? &slabs[s + 1] : nullptr;
    add_patches({below, &slabs[s], above, nullptr}, kDepth, low, low + 2, SplitCells(), &patches);
    for (const CellFlux& patch : patches.back()) {
      EXPECT_TRUE(found.emplace(patch.place, patch.flux).second) << "a cell has two patches";
      const int z = morton_cell(patch.place)[2];
      EXPECT_TRUE(z >= low && z < low + 2);
    }
  }
  return found;
}

// Cells on the plane without samples get patches from their neighbors, across slabs as well.
TEST(PlanePatches, ReproduceThePlaneInEveryCell) {
  const std::array<Vector3, 4> directions = {
      {{0.3, 0.5, 0.8}, {-0.7, 0.4, 0.6}, {0.3, -0.4, -0.5}, {-0.5, -0.5, -0.2}}};
  for (std::size_t i = 0; i < directions.size(); ++i) {
    for (const double missing : {0.0, 0.2}) {
      Vector3 n = directions[i];
      const double length = std::sqrt(dot(n, n));
      for (double& x : n) x /= length;
      const double d = dot(n, Vector3{3.9, 4.2, 4.05});
      const auto found = patches_of(sampled_plane(n, d, missing, static_cast<unsigned>(i)));
      double area = 0.0;
      double largest = 0.0;
      for (std::uint64_t place = 0; place < kSide * kSide * kSide; ++place) {
        const std::array<int, 3> at = morton_cell(place);
        const BoundaryFlux wanted =
            flux_of_plane(n, d - n[0] * at[0] - n[1] * at[1] - n[2] * at[2]);
        const auto patch = found.find(place);
        const BoundaryFlux flux = patch == found.end() ? BoundaryFlux() : patch->second;
        for (std::size_t a = 0; a < 3; ++a) {
          EXPECT_NEAR(flux.area[a], wanted.area[a], 2e-6) << i << " " << place;
          EXPECT_NEAR(flux.moment[a], wanted.moment[a], 2e-6) << i << " " << place;
          area += flux.area[a] * n[a];
          largest = std::max(largest, std::abs(wanted.area[a]));
        }
      }
      EXPECT_GT(area, kSide * kSide * 0.7);
      EXPECT_GT(largest, 0.5);
    }
  }
}

TEST(PlanePatches, CoverWholeFacesForAnAxisAlignedPlane) {
  const auto found = patches_of(sampled_plane({0.0, 0.0, -1.0}, -3.25, 0.0, 1));
  EXPECT_EQ(found.size(), static_cast<std::size_t>(kSide * kSide));
  for (const auto& [place, flux] : found) {
    EXPECT_EQ(morton_cell(place)[2], 3);
    EXPECT_NEAR(flux.area[0], 0.0, 1e-6);
    EXPECT_NEAR(flux.area[1], 0.0, 1e-6);
    EXPECT_NEAR(flux.area[2], -1.0, 1e-6);
    EXPECT_NEAR(flux.moment[2], -0.25, 1e-6);
  }
}

TEST(PlanePatches, NeedACrossedCellAndNormalsThatDoNotCancel) {
  std::array<SampleLevel, kSide / 2> slabs = sampled_plane({0.0, 0.0, 1.0}, 3.25, 0.0, 1);
  for (std::uint8_t& is_leaf : slabs[1].is_leaf) is_leaf = 0;
  EXPECT_TRUE(patches_of(slabs).empty());
  slabs = sampled_plane({0.0, 0.0, 1.0}, 3.25, 0.0, 1);
  for (SampleCell& cell : slabs[1].samples.cells) cell.normal = {0.0F, 0.0F, 0.1F};
  EXPECT_TRUE(patches_of(slabs).empty());
}

}  // namespace
}  // namespace prefilter
