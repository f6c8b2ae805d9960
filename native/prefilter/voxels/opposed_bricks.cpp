// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/opposed_bricks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/base/sort.h"
#include "prefilter/geometry/spatial/triangle_pieces.h"
#include "prefilter/voxels/cube_keys.h"

namespace prefilter {
namespace {

constexpr std::int64_t kOpposedBricksRowsPerTask = 1 << 10;
constexpr double kCrowdedSheets = 8.0;  // number of sheets through a brick

// Directions are quantized to bins: three by three on each face of a cube.
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

// For each bin, the bins with directions that may be opposed.
std::array<std::uint64_t, kBins> bins_across() {
  constexpr double kMaxBinCosine = 0.1;  // kAcross plus the bins' own widths
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
      if (dot(middles[i], middles[j]) < kMaxBinCosine) across[i] |= std::uint64_t{1} << j;
    }
  }
  return across;
}

const std::array<std::uint64_t, kBins>& across_table() {
  static const std::array<std::uint64_t, kBins> table = bins_across();
  return table;
}

// Directions of triangles in a brick, and the area of the triangles centered in it.
struct Entry {
  std::uint64_t key;
  std::uint64_t bins;
  double area;
  bool operator<(const Entry& other) const {
    if (key != other.key) return key < other.key;
    return bins != other.bins ? bins < other.bins : area < other.area;
  }
};

// A list of entries that merges most duplicates.
class Entries {
 public:
  void add(const Entry& entry) {
    const std::uint64_t hash = (entry.key ^ entry.bins) * 0x9E3779B97F4A7C15U;
    std::size_t& recent = recent_[hash >> (64U - kBits)];
    if (recent < entries_.size() && entries_[recent].key == entry.key &&
        entries_[recent].bins == entry.bins) {
      entries_[recent].area += entry.area;
      return;
    }
    recent = entries_.size();
    entries_.push_back(entry);
  }
  std::vector<Entry>* all() { return &entries_; }

 private:
  static constexpr unsigned kBits = 10;  // binary logarithm of the entries compared
  std::vector<Entry> entries_;
  std::array<std::size_t, 1U << kBits> recent_{};
};

// Adds a piece of a triangle, no larger than a brick, to the bricks that it overlaps.
void add_bricks(const std::array<Vector3, 3>& piece, double side, std::uint64_t bin,
                Entries* entries) {
  const Box box = triangle_box(piece);
  const std::uint64_t low = cube_key(box.low, side);
  const std::uint64_t high = cube_key(box.high, side);
  const double area = triangle_area(piece);
  if (high == low) {
    entries->add({low, bin, area});
    return;
  }
  entries->add({cube_key(triangle_middle(piece), side), bin, area});
  entries->add({low, bin, 0.0});
  // Differences between the coordinates of the box's corners.
  constexpr std::uint64_t kCoordinate = (std::uint64_t{1} << 21U) - 1;
  std::array<std::uint64_t, 3> steps{};
  for (unsigned a = 0; a < 3; ++a) {
    const unsigned shift = 21U * (2 - a);
    steps[a] = (((high >> shift) & kCoordinate) - ((low >> shift) & kCoordinate)) << shift;
  }
  for (unsigned corner = 1; corner < 8; ++corner) {
    std::uint64_t key = low;
    bool is_new = true;
    for (unsigned a = 0; a < 3; ++a) {
      if (((corner >> a) & 1U) == 0) continue;
      is_new = is_new && steps[a] != 0;
      key += steps[a];
    }
    if (is_new) entries->add({key, bin, 0.0});
  }
}

// Merges entries of the same brick.
void merge(std::vector<Entry>* entries) {
  std::sort(entries->begin(), entries->end());
  std::size_t kept = 0;
  for (const Entry& entry : *entries) {
    if (kept > 0 && (*entries)[kept - 1].key == entry.key) {
      (*entries)[kept - 1].bins |= entry.bins;
      (*entries)[kept - 1].area += entry.area;
    } else {
      (*entries)[kept++] = entry;
    }
  }
  entries->resize(kept);
}

// Entries of all bricks, sorted.
std::vector<Entry> directions_of(const MeshView<std::int32_t>& mesh,
                                 std::span<const Vector3> normals, double side, const Box& bounds,
                                 const Run& run) {
  const auto rows = static_cast<std::int64_t>(mesh.triangles.size());
  std::vector<std::vector<Entry>> tasks(
      static_cast<std::size_t>(range_count(rows, kOpposedBricksRowsPerTask)));
  const auto find = [&](std::int64_t begin, std::int64_t end) {
    Entries entries;
    for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t) {
      if (dot(normals[t], normals[t]) == 0.0) continue;
      const std::uint64_t bin = direction_bit(normals[t]);
      for_pieces(
          mesh.corners(t), side,
          [&](const auto& piece) { return triangle_box(piece).overlaps(bounds); },
          [&](const auto& piece) { add_bricks(piece, side, bin, &entries); });
    }
    merge(entries.all());
    tasks[static_cast<std::size_t>(begin / kOpposedBricksRowsPerTask)] = std::move(*entries.all());
  };
  parallel_ranges(rows, kOpposedBricksRowsPerTask, run, find);
  std::vector<Entry> directions;
  for (std::vector<Entry>& entries : tasks) {
    directions.insert(directions.end(), entries.begin(), entries.end());
    entries = {};
  }
  merge(&directions);
  return directions;
}

// For each brick, the directions in it and its neighbors.
std::vector<std::uint64_t> directions_around(const std::vector<Entry>& directions) {
  std::vector<std::uint64_t> around(directions.size(), 0);
  for (int column = 0; column < 9; ++column) {
    const std::int64_t step =
        (column / 3 - 1) * (std::int64_t{1} << 42) + (column % 3 - 1) * (std::int64_t{1} << 21);
    // Columns are consecutive, like the bricks.
    std::size_t next = 0;
    for (std::size_t i = 0; i < directions.size(); ++i) {
      const std::uint64_t first = directions[i].key + static_cast<std::uint64_t>(step) - 1;
      while (next < directions.size() && directions[next].key < first) ++next;
      for (std::size_t k = next; k < directions.size() && directions[k].key <= first + 2; ++k) {
        around[i] |= directions[k].bins;
      }
    }
  }
  return around;
}

}  // namespace

std::uint64_t direction_bit(const Vector3& direction) {
  return std::uint64_t{1} << bin_of(direction);
}

std::uint64_t bits_across(const Vector3& direction) {
  return across_table()[static_cast<std::size_t>(bin_of(direction))];
}

OpposedBricks::OpposedBricks(const MeshView<std::int32_t>& mesh, std::span<const Vector3> normals,
                             double side, const Box& bounds, const Run& run)
    : side_(side), bounds_(bounds) {
  const std::vector<Entry> directions =
      directions_of(mesh, normals, side, bounds, run.part(0.0, 0.7));
  const std::vector<std::uint64_t> around = directions_around(directions);
  const std::array<std::uint64_t, kBins>& across = across_table();
  for (std::size_t i = 0; i < directions.size(); ++i) {
    for (std::uint64_t rest = directions[i].bins; rest != 0; rest &= rest - 1) {
      if ((across[static_cast<std::size_t>(std::countr_zero(rest))] & around[i]) == 0) continue;
      opposed_[directions[i].key].is_crowded = directions[i].area > kCrowdedSheets * side * side;
      break;
    }
  }
  run.report(1.0);
}

bool OpposedBricks::holds(const Vector3& point) const {
  return opposed_.find(cube_key(point, side_)) != nullptr;
}

bool OpposedBricks::is_crowded(const Vector3& point) const {
  const Brick* brick = opposed_.find(cube_key(point, side_));
  return brick != nullptr && brick->is_crowded;
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
  constexpr double kMaxBricks = 27.0;  // a triangle in more counts as overlapping
  if (count > kMaxBricks) return true;
  const std::uint64_t first = cube_key(box.low, side_);
  for (std::int64_t x = low[0]; x <= high[0]; ++x) {
    for (std::int64_t y = low[1]; y <= high[1]; ++y) {
      for (std::int64_t z = low[2]; z <= high[2]; ++z) {
        const std::uint64_t step = (static_cast<std::uint64_t>(x - low[0]) << 42U) +
                                   (static_cast<std::uint64_t>(y - low[1]) << 21U) +
                                   static_cast<std::uint64_t>(z - low[2]);
        if (opposed_.find(first + step) != nullptr) return true;
      }
    }
  }
  return false;
}

}  // namespace prefilter
