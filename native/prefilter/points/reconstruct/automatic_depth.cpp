// SPDX-License-Identifier: GPL-3.0-or-later

// Estimates density from the distance to the k-th nearest neighbor (D. Loftsgaarden, C.
// Quesenberry, A nonparametric estimate of a multivariate density function, 1965), on a subset of
// the positions chosen by their hashes.
#include "prefilter/points/reconstruct/automatic_depth.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>

#include "prefilter/base/parallel.h"
#include "prefilter/geometry/spatial/nearest_neighbors.h"
#include "prefilter/voxels/voxelize.h"

namespace prefilter {
namespace {

// The finalizer of splitmix64: every output bit depends on every input bit.
std::uint64_t mixed(std::uint64_t bits) {
  bits ^= bits >> 30U;
  bits *= 0xbf58476d1ce4e5b9U;
  bits ^= bits >> 27U;
  bits *= 0x94d049bb133111ebU;
  return bits ^ bits >> 31U;
}

// Number of points whose neighbors are searched: with so many, the median's error is about 1/100 of
// a level.
constexpr std::size_t kMaxDensityQueries = 4096;
// Large enough to span adjacent scan lines, small enough to stay on one sheet of the surface.
constexpr std::size_t kDensityNeighbors = 16;
constexpr double kPi = 3.14159265358979323846;
// Points per face of a finest cell. With fewer than one the surface folds, with more detail is
// lost. It corresponds to about 1.5 points per occupied cell, the default of Poisson
// reconstruction.
constexpr double kPointsPerFace = 1.0;

// Part of the surface around one point: its area, and the point density in it.
struct Patch {
  double density = 0.0;
  double area = 0.0;
};

Patch patch_of(const Neighbors& neighbors) {
  // Area of the disk that is expected to hold all neighbors except the point itself and the last.
  const auto held = static_cast<double>(neighbors.squares().size() - 1);
  Patch patch;
  patch.area = kPi * neighbors.squares().back() / std::max(held - 1.0, 1.0);
  patch.density = 1.0 / patch.area;
  return patch;
}

// Density at the area-weighted median.
double median_density(std::vector<Patch>* patches) {
  std::sort(patches->begin(), patches->end(),
            [](const Patch& a, const Patch& b) { return a.density < b.density; });
  // Excludes isolated points: the area of one outlier would exceed that of the whole surface.
  constexpr double kMinDensityRatio = 1.0 / 64.0;
  const double middle = (*patches)[patches->size() / 2].density;
  const auto first = std::find_if(patches->begin(), patches->end(), [&](const Patch& patch) {
    return patch.density >= kMinDensityRatio * middle;
  });
  patches->erase(patches->begin(), first);
  double whole = 0.0;
  for (const Patch& patch : *patches) whole += patch.area;
  double below = 0.0;
  for (const Patch& patch : *patches) {
    below += patch.area;
    if (below >= 0.5 * whole) return patch.density;
  }
  return patches->back().density;
}

}  // namespace

ThinnedPoints::Entry ThinnedPoints::entry_of(const Vector3& position) {
  std::uint64_t hash = 0;
  for (const double value : position) {
    // Adding 0.0 maps -0.0 to 0.0, as they are the same position.
    hash = mixed((hash ^ std::bit_cast<std::uint64_t>(value + 0.0)) + 0x9e3779b97f4a7c15U);
  }
  return {hash, position};
}

void ThinnedPoints::add(const std::vector<Entry>& entries) {
  for (const Entry& entry : entries) {
    if (keeps(entry)) entries_.push_back(entry);
  }
  if (entries_.size() >= 2 * kMaxEntries) thin();
}

void ThinnedPoints::thin() {
  std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
    return std::tie(a.hash, a.position) < std::tie(b.hash, b.position);
  });
  const auto same = [](const Entry& a, const Entry& b) { return a.position == b.position; };
  entries_.erase(std::unique(entries_.begin(), entries_.end(), same), entries_.end());
  while (entries_.size() > kMaxEntries && largest_ > 0) {
    largest_ /= 2;
    share_ *= 2.0;
    const auto end = std::partition_point(entries_.begin(), entries_.end(),
                                          [&](const Entry& entry) { return keeps(entry); });
    entries_.erase(end, entries_.end());
  }
}

int automatic_depth(const ThinnedPoints& points, const Box& box, const Run& run) {
  const double longest = std::max({box.size(0), box.size(1), box.size(2)});
  std::vector<Vector3> positions;
  positions.reserve(points.entries().size());
  for (const ThinnedPoints::Entry& entry : points.entries()) {
    if (box.squared_distance(entry.position) > 0.0) continue;
    Vector3 scaled;
    for (std::size_t a = 0; a < 3; ++a) scaled[a] = (entry.position[a] - box.low[a]) / longest;
    positions.push_back(scaled);
  }
  const Stages stages(run, {1, 1});
  const NeighborSearch search(positions, stages[0]);
  const std::size_t queried = std::min(kMaxDensityQueries, positions.size());
  std::vector<Patch> patches(queried);
  parallel_for(static_cast<std::int64_t>(queried), stages[1], [&](std::int64_t i) {
    Neighbors neighbors;
    const auto k = static_cast<std::size_t>(i);
    search.find(search.places()[k], kDensityNeighbors + 1, &neighbors);
    patches[k] = patch_of(neighbors);
  });
  const double density = points.share() * median_density(&patches);
  int depth = 1;
  while (depth < kMaxTreeDepth) {
    const double cube = cube_around(box, depth + 1).size(0) / longest;
    const double cell = std::ldexp(cube, -(depth + 1));
    if (!(density * cell * cell >= kPointsPerFace)) break;
    ++depth;
  }
  return depth;
}

}  // namespace prefilter
