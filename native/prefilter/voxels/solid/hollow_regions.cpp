// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/solid/hollow_regions.h"

#include <algorithm>

#include "prefilter/voxels/queries.h"

namespace prefilter {
namespace {

// Share of a region from which winding numbers are considered to fill it.
constexpr double kMinFilledShare = 0.9;
constexpr std::size_t kMaxRegionSamples = 1U << 16;

// Evenly chosen centers of region cells, and their labels.
struct RegionSamples {
  std::vector<Vector3> points;
  std::vector<ReachGrid::Label> labels;
};

RegionSamples samples_of_regions(const ReachGrid& grid) {
  const auto& labels = grid.labels();
  const auto cells = static_cast<std::size_t>(std::count_if(
      labels.begin(), labels.end(), [](auto l) { return l >= ReachGrid::kFirstRegion; }));
  const std::size_t step = cells / kMaxRegionSamples + 1;
  RegionSamples samples;
  std::size_t place = 0;
  const auto& [nx, ny, nz] = grid.size();
  for (int x = 0; x < nx; ++x) {
    for (int y = 0; y < ny; ++y) {
      for (int z = 0; z < nz; ++z) {
        const ReachGrid::Label label = labels[grid.index(x, y, z)];
        if (label < ReachGrid::kFirstRegion || place++ % step != 0) continue;
        samples.labels.push_back(label);
        samples.points.push_back({grid.origin()[0] + (x + 0.5) * grid.cell(),
                                  grid.origin()[1] + (y + 0.5) * grid.cell(),
                                  grid.origin()[2] + (z + 0.5) * grid.cell()});
      }
    }
  }
  return samples;
}

}  // namespace

std::vector<double> filled_shares(const ReachGrid& grid, const Octree& octree, int threads) {
  std::vector<double> sums(grid.region_end(), 0.0);
  std::vector<double> counts(grid.region_end(), 0.0);
  const auto [points, labels] = samples_of_regions(grid);
  const std::vector<float> values = values_at(octree, points, threads);
  for (std::size_t i = 0; i < points.size(); ++i) {
    sums[labels[i]] += values[i] >= 0.5F ? 1.0 : 0.0;
    counts[labels[i]] += 1.0;
  }
  for (std::size_t r = 0; r < sums.size(); ++r) sums[r] /= std::max(counts[r], 1.0);
  return sums;
}

std::vector<bool> hollow_regions(const Patches& patches, std::span<const double> areas,
                                 std::span<const TriangleSides> sides,
                                 std::span<const double> filled_shares) {
  const std::size_t labels = filled_shares.size();
  std::vector<double> open(labels, 0.0);
  std::vector<double> closed(labels, 0.0);
  for (std::size_t t = 0; t < sides.size(); ++t) {
    const FacePatch& patch = patches.patches[patches.patch_of[t]];
    (patch.is_closed() ? closed : open)[sides[t].region] += areas[t];
  }
  std::vector<bool> is_hollow(labels, false);
  for (std::size_t r = ReachGrid::kFirstRegion; r < labels; ++r) {
    is_hollow[r] = open[r] > closed[r] && filled_shares[r] < kMinFilledShare;
  }
  return is_hollow;
}

std::vector<std::size_t> parts_around(const Patches& patches, std::span<const double> areas,
                                      std::span<const TriangleSides> sides,
                                      const std::vector<bool>& is_hollow) {
  std::vector<double> bounding(patches.patches.size(), 0.0);
  for (std::size_t t = 0; t < sides.size(); ++t) {
    if (!is_hollow[sides[t].region]) continue;
    bounding[patches.patch_of[t]] += areas[t] * (sides[t].outside_front + sides[t].outside_back);
  }
  std::vector<std::size_t> parts;
  for (std::size_t p = 0; p < bounding.size(); ++p) {
    const FacePatch& patch = patches.patches[p];
    if (!patch.is_closed() && bounding[p] > patch.area / 2.0) parts.push_back(p);
  }
  return parts;
}

}  // namespace prefilter
