// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/normal_probe.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "prefilter/geometry/spatial/nearest_neighbors.h"
#include "prefilter/points/reconstruct/gather_samples.h"

namespace prefilter {
namespace {

constexpr std::size_t kMaxProbes = 512;  // points whose neighbors are compared
// With fewer pairs the share is not significant.
constexpr std::size_t kMinPairs = 256;
constexpr std::size_t kProbeNeighbors = 8;
// Includes copies of the neighbors.
constexpr std::size_t kMaxNearest = 24;
constexpr int kCellsPerSide = 32;
// Normals are opposed if the cosine between one and the mirror image of the other is below this.
constexpr double kMaxOpposedCosine = 0.0;
// Largest thickness of a thin part, as a share of the distance between two points on its sides.
constexpr double kMaxThicknessRatio = 0.2;

bool is_nearer(const NormalProbe::NearPoint& a, const NormalProbe::NearPoint& b) {
  return std::tie(a.squared, a.position, a.normal) < std::tie(b.squared, b.position, b.normal);
}

Vector3 unit(const std::array<float, 3>& normal) {
  const Vector3 wide = {static_cast<double>(normal[0]), static_cast<double>(normal[1]),
                        static_cast<double>(normal[2])};
  return 1.0 / length(wide) * wide;
}

int index_along(double scaled) {
  return static_cast<int>(
      std::clamp(std::floor(scaled * kCellsPerSide), 0.0, static_cast<double>(kCellsPerSide - 1)));
}

}  // namespace

NormalProbe::NormalProbe(const ThinnedPoints& thinned, const Box& box, const Run& run)
    : box_(box), longest_(std::max({box.size(0), box.size(1), box.size(2)})) {
  if (!(longest_ > 0.0)) return;
  std::vector<Vector3> positions;
  for (const ThinnedPoints::Entry& entry : thinned.entries()) {
    if (box.squared_distance(entry.position) == 0.0) positions.push_back(scaled(entry.position));
  }
  const NeighborSearch search(positions, run);
  Neighbors neighbors;
  for (std::size_t i = 0; i < std::min(kMaxProbes, positions.size()); ++i) {
    search.find(search.places()[i], kProbeNeighbors + 1, &neighbors);
    probed_.push_back({positions[i], neighbors.squares().back(), {}});
  }
  cells_.resize(std::size_t{kCellsPerSide} * kCellsPerSide * kCellsPerSide);
  for (std::size_t k = 0; k < probed_.size(); ++k) {
    const double reach = std::sqrt(probed_[k].squared);
    std::array<int, 3> low{};
    std::array<int, 3> high{};
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = index_along(probed_[k].position[a] - reach);
      high[a] = index_along(probed_[k].position[a] + reach);
    }
    for (int z = low[2]; z <= high[2]; ++z) {
      for (int y = low[1]; y <= high[1]; ++y) {
        for (int x = low[0]; x <= high[0]; ++x) {
          const int cell = (z * kCellsPerSide + y) * kCellsPerSide + x;
          cells_[static_cast<std::size_t>(cell)].push_back(static_cast<std::uint32_t>(k));
        }
      }
    }
  }
}

Vector3 NormalProbe::scaled(const Vector3& position) const {
  Vector3 result;
  for (std::size_t a = 0; a < 3; ++a) result[a] = (position[a] - box_.low[a]) / longest_;
  return result;
}

std::size_t NormalProbe::cell_of(const Vector3& scaled) const {
  const int cell =
      (index_along(scaled[2]) * kCellsPerSide + index_along(scaled[1])) * kCellsPerSide +
      index_along(scaled[0]);
  return static_cast<std::size_t>(cell);
}

std::vector<NormalProbe::NearPoint> NormalProbe::find_near(const PointBatch& batch) const {
  std::vector<NearPoint> near;
  if (probed_.empty()) return near;
  for (std::size_t i = 0; i < batch.positions.size(); ++i) {
    if (!is_valid_point(batch, i) || box_.squared_distance(batch.positions[i]) > 0.0) continue;
    const Vector3 position = scaled(batch.positions[i]);
    for (const std::uint32_t k : cells_[cell_of(position)]) {
      const Vector3 offset = position - probed_[k].position;
      const double squared = dot(offset, offset);
      if (squared > probed_[k].squared) continue;
      near.push_back({k, squared, position, batch.normals[i]});
    }
  }
  return near;
}

void NormalProbe::add(const std::vector<NearPoint>& near) {
  for (const NearPoint& point : near) {
    std::vector<NearPoint>& nearest = probed_[point.probed].nearest;
    if (nearest.size() == kMaxNearest && !is_nearer(point, nearest.back())) continue;
    nearest.insert(std::upper_bound(nearest.begin(), nearest.end(), point, is_nearer), point);
    if (nearest.size() > kMaxNearest) nearest.pop_back();
  }
}

double NormalProbe::contradiction() const {
  std::size_t pairs = 0;
  std::size_t opposed = 0;
  for (const Probed& probed : probed_) {
    if (probed.nearest.empty() || probed.nearest.front().squared > 0.0) continue;
    const Vector3 own = unit(probed.nearest.front().normal);
    for (const NearPoint& near : probed.nearest) {
      if (!(near.squared > 0.0)) continue;
      const Vector3 other = unit(near.normal);
      const Vector3 offset = probed.position - near.position;
      const double along_own = dot(own, offset);
      const double along_other = dot(other, offset);
      ++pairs;
      if (!(dot(own, other) - along_own * along_other / near.squared < kMaxOpposedCosine)) continue;
      if (along_own - along_other > kMaxThicknessRatio * std::sqrt(near.squared)) continue;
      ++opposed;
    }
  }
  if (pairs < kMinPairs) return 0.0;
  return static_cast<double>(opposed) / static_cast<double>(pairs);
}

}  // namespace prefilter
