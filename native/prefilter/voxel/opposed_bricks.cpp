// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxel/opposed_bricks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <unordered_map>

#include "prefilter/base/parallel.h"
#include "prefilter/base/sort.h"
#include "prefilter/spatial/triangle_pieces.h"
#include "prefilter/voxel/cube_keys.h"

namespace prefilter {
namespace {

constexpr std::int64_t kRowsPerTask = 1 << 10;

// Directions in bins: three by three on each side of a cube.
constexpr int kBins = 54;

int bin_of(const Vector3& direction) {
  std::size_t axis = 0;
  for (std::size_t a = 1; a < 3; ++a) {
    if (std::abs(direction[a]) > std::abs(direction[axis])) axis = a;
  }
  const double most = std::abs(direction[axis]);
  const auto third = [&](std::size_t a) {
    const double x = direction[a] / most;
    return x < -1.0 / 3.0 ? 0 : x < 1.0 / 3.0 ? 1 : 2;
  };
  const int side = static_cast<int>(2 * axis) + (direction[axis] > 0.0 ? 1 : 0);
  return 9 * side + 3 * third((axis + 1) % 3) + third((axis + 2) % 3);
}

// Of each bin, those with directions that may be across.
std::array<std::uint64_t, kBins> bins_across() {
  constexpr double kNearest = 0.1;  // the bins' own widths away from kAcross
  std::array<Vector3, kBins> middles;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (int k = 0; k < 18; ++k) {
      Vector3 middle;
      middle[axis] = k < 9 ? -1.0 : 1.0;
      middle[(axis + 1) % 3] = (k / 3 % 3 - 1) * 2.0 / 3.0;
      middle[(axis + 2) % 3] = (k % 3 - 1) * 2.0 / 3.0;
      middles[static_cast<std::size_t>(bin_of(middle))] = (1.0 / length(middle)) * middle;
    }
  }
  std::array<std::uint64_t, kBins> across{};
  for (std::size_t i = 0; i < kBins; ++i) {
    for (std::size_t j = 0; j < kBins; ++j) {
      if (dot(middles[i], middles[j]) < kNearest) across[i] |= std::uint64_t{1} << j;
    }
  }
  return across;
}

// A brick, and the directions of triangles in it.
struct Entry {
  std::uint64_t key;
  std::uint64_t bins;
  bool operator<(const Entry& other) const {
    return key != other.key ? key < other.key : bins < other.bins;
  }
};

// Those of a piece of a triangle that is no larger than a brick.
void add_bricks(const std::array<Vector3, 3>& piece, double side, std::uint64_t bin,
                std::vector<Entry>* entries) {
  const Box box = triangle_box(piece);
  std::uint64_t last = 0;
  for (int corner = 0; corner < 8; ++corner) {
    Vector3 at;
    for (int a = 0; a < 3; ++a) at[a] = ((corner >> a) & 1) != 0 ? box.high[a] : box.low[a];
    const std::uint64_t key = cube_key(at, side);
    if (corner == 0 || key != last) entries->push_back({key, bin});
    last = key;
  }
}

// One of each brick.
void merge(std::vector<Entry>* entries) {
  std::sort(entries->begin(), entries->end());
  std::size_t kept = 0;
  for (const Entry& entry : *entries) {
    if (kept > 0 && (*entries)[kept - 1].key == entry.key) {
      (*entries)[kept - 1].bins |= entry.bins;
    } else {
      (*entries)[kept++] = entry;
    }
  }
  entries->resize(kept);
}

std::unordered_map<std::uint64_t, std::uint64_t> directions_of(const MeshView<std::int32_t>& mesh,
                                                               std::span<const Vector3> normals,
                                                               double side, const Box& bounds,
                                                               const Progress& progress,
                                                               int threads) {
  const auto rows = static_cast<std::int64_t>(mesh.triangles.size());
  std::vector<std::vector<Entry>> tasks(static_cast<std::size_t>(range_count(rows, kRowsPerTask)));
  const auto find = [&](std::int64_t begin, std::int64_t end) {
    std::vector<Entry>& entries = tasks[static_cast<std::size_t>(begin / kRowsPerTask)];
    for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t) {
      if (dot(normals[t], normals[t]) == 0.0) continue;
      const std::uint64_t bin = std::uint64_t{1} << bin_of(normals[t]);
      for_pieces(
          mesh.corners(t), side,
          [&](const auto& piece) { return triangle_box(piece).overlaps(bounds); },
          [&](const auto& piece) { add_bricks(piece, side, bin, &entries); });
    }
    merge(&entries);
  };
  parallel_ranges(rows, kRowsPerTask, threads, progress, find);
  std::unordered_map<std::uint64_t, std::uint64_t> directions;
  for (const std::vector<Entry>& entries : tasks) {
    for (const Entry& entry : entries) directions[entry.key] |= entry.bins;
  }
  return directions;
}

}  // namespace

OpposedBricks::OpposedBricks(const MeshView<std::int32_t>& mesh, std::span<const Vector3> normals,
                             double side, const Box& bounds, const Progress& progress, int threads)
    : side_(side), bounds_(bounds) {
  const auto directions =
      directions_of(mesh, normals, side, bounds, progress.part(0.0, 0.7), threads);
  const std::array<std::uint64_t, kBins> across = bins_across();
  for (const auto& [key, bins] : directions) {
    std::uint64_t around = 0;
    for_cubes_around(key, [&](std::uint64_t other) {
      const auto found = directions.find(other);
      if (found != directions.end()) around |= found->second;
    });
    for (std::uint64_t rest = bins; rest != 0; rest &= rest - 1) {
      if ((across[static_cast<std::size_t>(std::countr_zero(rest))] & around) == 0) continue;
      opposed_.insert(key);
      break;
    }
  }
  progress.report(1.0);
}

bool OpposedBricks::holds(const Vector3& point) const {
  return opposed_.contains(cube_key(point, side_));
}

bool OpposedBricks::may_meet(const std::array<Vector3, 3>& corners) const {
  const Box box = triangle_box(corners);
  if (!box.overlaps(bounds_)) return false;
  std::array<std::int64_t, 3> low;
  std::array<std::int64_t, 3> high;
  double count = 1.0;
  for (int a = 0; a < 3; ++a) {
    low[a] = static_cast<std::int64_t>(std::floor(box.low[a] / side_));
    high[a] = static_cast<std::int64_t>(std::floor(box.high[a] / side_));
    count *= static_cast<double>(high[a] - low[a] + 1);
  }
  constexpr double kMany = 27.0;
  if (count > kMany) return true;
  for (std::int64_t x = low[0]; x <= high[0]; ++x) {
    for (std::int64_t y = low[1]; y <= high[1]; ++y) {
      for (std::int64_t z = low[2]; z <= high[2]; ++z) {
        const Vector3 at = {(static_cast<double>(x) + 0.5) * side_,
                            (static_cast<double>(y) + 0.5) * side_,
                            (static_cast<double>(z) + 0.5) * side_};
        if (holds(at)) return true;
      }
    }
  }
  return false;
}

}  // namespace prefilter
