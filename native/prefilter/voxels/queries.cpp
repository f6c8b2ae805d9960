// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/queries.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "prefilter/base/memory.h"
#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {

constexpr std::int64_t kPointsPerTask = 1 << 14;

// A box in coordinates in which the root is the unit cube.
using UnitBox = std::array<std::array<double, 2>, 3>;

// Volume of the intersection of the box and a cell.
double overlap(const UnitBox& box, const Vector3& low, double side) {
  double volume = 1.0;
  for (int a = 0; a < 3; ++a) {
    const double length = std::min(box[a][1], low[a] + side) - std::max(box[a][0], low[a]);
    if (length <= 0.0) return 0.0;
    volume *= length;
  }
  return volume;
}

bool holds(const UnitBox& box, const Vector3& low, double side) {
  for (int a = 0; a < 3; ++a) {
    if (low[a] < box[a][0] || low[a] + side > box[a][1]) return false;
  }
  return true;
}

double integral(const CellTree& tree, std::size_t level, std::size_t block, const Vector3& low,
                double side, const UnitBox& box) {
  const TreeLevel& cells = tree.levels[level];
  const double half = side / 2.0;
  double sum = 0.0;
  for (int o = 0; o < 8; ++o) {
    const Vector3 corner = {low[0] + ((o & 1) != 0 ? half : 0.0),
                            low[1] + ((o & 2) != 0 ? half : 0.0),
                            low[2] + ((o & 4) != 0 ? half : 0.0)};
    const double common = overlap(box, corner, half);
    if (common <= 0.0) continue;
    if (cells.is_split(block, o) && !holds(box, corner, half)) {
      sum += integral(tree, level + 1, cells.child(block, o), corner, half, box);
    } else {
      sum += common * static_cast<double>(cells.blocks[block][o]);
    }
  }
  return sum;
}

template <typename T, typename ValueOf>
std::vector<T> for_points(std::span<const Vector3> points, int threads, const ValueOf& value_of) {
  std::vector<T> values(points.size());
  parallel_ranges(static_cast<std::int64_t>(points.size()), kPointsPerTask, Run(threads),
                  [&](std::int64_t begin, std::int64_t end) {
                    std::transform(points.begin() + begin, points.begin() + end,
                                   values.begin() + begin, value_of);
                  });
  return values;
}

// Output array of cells at one depth.
class DenseCells {
 public:
  DenseCells(const CellTree& tree, int depth, std::vector<float>* values)
      : tree_(tree), depth_(depth), side_(std::size_t{1} << depth), values_(*values) {}

  // Fills the cells that cell `cell` of depth `at_depth` covers.
  void fill(const std::array<std::size_t, 3>& cell, int at_depth, float value) {
    const int shift = depth_ - at_depth;
    const std::size_t width = std::size_t{1} << shift;
    const std::array<std::size_t, 3> low = {cell[0] << shift, cell[1] << shift, cell[2] << shift};
    for (std::size_t x = low[0]; x < low[0] + width; ++x) {
      for (std::size_t y = low[1]; y < low[1] + width; ++y) {
        const auto row = values_.begin() + static_cast<std::ptrdiff_t>((x * side_ + y) * side_);
        std::fill_n(row + static_cast<std::ptrdiff_t>(low[2]), width, value);
      }
    }
  }

  // Fills the octants of a cell.
  void fill_block(std::size_t level, std::size_t block, const std::array<std::size_t, 3>& cell) {
    const TreeLevel& cells = tree_.levels[level];
    const int at_depth = static_cast<int>(level) + 1;
    for (std::size_t o = 0; o < 8; ++o) {
      const std::array<std::size_t, 3> octant = {
          2 * cell[0] + (o & 1U), 2 * cell[1] + ((o >> 1U) & 1U), 2 * cell[2] + ((o >> 2U) & 1U)};
      const int octant_number = static_cast<int>(o);
      if (at_depth < depth_ && cells.is_split(block, octant_number)) {
        fill_block(level + 1, cells.child(block, octant_number), octant);
      } else {
        fill(octant, at_depth, cells.blocks[block][o]);
      }
    }
  }

 private:
  const CellTree& tree_;
  int depth_;
  std::size_t side_;
  std::vector<float>& values_;
};
}  // namespace

float value_at(const Octree& octree, const Vector3& point) {
  constexpr int kCells = 1 << kMaxTreeDepth;
  std::array<int, 3> cell{};
  for (int a = 0; a < 3; ++a) {
    const double x = (point[a] - octree.bounds.low[a]) / octree.bounds.size(a);
    if (!(x >= 0.0 && x <= 1.0)) return 0.0F;
    cell[a] = std::min(static_cast<int>(x * kCells), kCells - 1);
  }
  const CellTree& tree = octree.cells;
  if (tree.levels.empty()) return tree.root;
  std::size_t block = 0;
  for (std::size_t k = 0;; ++k) {
    const int bit = kMaxTreeDepth - 1 - static_cast<int>(k);
    const int o =
        ((cell[0] >> bit) & 1) | (((cell[1] >> bit) & 1) << 1) | (((cell[2] >> bit) & 1) << 2);
    const TreeLevel& level = tree.levels[k];
    if (!level.is_split(block, o)) return level.blocks[block][o];
    block = level.child(block, o);
  }
}

double volume(const Octree& octree) {
  // Sum in double precision, since the root's mean is a float.
  const CellTree& tree = octree.cells;
  if (tree.levels.empty()) return static_cast<double>(tree.root) * octree.bounds.volume();
  double sum = 0.0;
  double cell = 1.0;
  for (const TreeLevel& level : tree.levels) {
    cell /= 8.0;
    double of_level = 0.0;
    for (std::size_t b = 0; b < level.size(); ++b) {
      double of_block = 0.0;
      for (int o = 0; o < 8; ++o) {
        if (!level.is_split(b, o)) of_block += static_cast<double>(level.blocks[b][o]);
      }
      of_level += of_block;
    }
    sum += of_level * cell;
  }
  return sum * octree.bounds.volume();
}

double box_occupancy(const Octree& octree, const Box& box) {
  check_box(box, "box");
  UnitBox unit;
  double whole = 1.0;
  for (int a = 0; a < 3; ++a) {
    for (int end = 0; end < 2; ++end) {
      const double x = end == 0 ? box.low[a] : box.high[a];
      unit[a][end] = (x - octree.bounds.low[a]) / octree.bounds.size(a);
    }
    whole *= unit[a][1] - unit[a][0];
  }
  const CellTree& tree = octree.cells;
  const Vector3 origin{};
  const double inside = tree.levels.empty()
                            ? overlap(unit, origin, 1.0) * static_cast<double>(tree.root)
                            : integral(tree, 0, 0, origin, 1.0, unit);
  return std::clamp(inside / whole, 0.0, 1.0);
}

std::vector<float> values_at(const Octree& octree, std::span<const Vector3> points, int threads) {
  return for_points<float>(points, threads,
                           [&](const auto& point) { return value_at(octree, point); });
}

std::vector<std::int8_t> classify(const Octree& octree, std::span<const Vector3> points,
                                  double tolerance, int threads) {
  return for_points<std::int8_t>(points, threads, [&](const auto& point) {
    const auto value = static_cast<double>(value_at(octree, point));
    if (value <= tolerance) return std::int8_t{-1};
    return value >= 1.0 - tolerance ? std::int8_t{1} : std::int8_t{0};
  });
}

std::vector<float> dense_values(const Octree& octree, int depth, const Run& run) {
  check_depth(depth, 0, "depth");
  const double count = std::ldexp(1.0, 3 * depth);
  check_memory("depth: a grid of " + std::to_string(1 << depth) + "^3 cells", 4.0 * count);
  std::vector<float> values(static_cast<std::size_t>(count));
  const CellTree& tree = octree.cells;
  DenseCells cells(tree, depth, &values);
  if (tree.levels.empty() || depth == 0) {
    cells.fill({0, 0, 0}, 0, tree.root);
    return values;
  }
  // One task per cell of the second level.
  const TreeLevel& top = tree.levels.front();
  parallel_for(64, run, [&](std::int64_t task) {
    const int o = static_cast<int>(task) / 8;
    const auto inner = static_cast<int>(task) % 8;
    const std::array<std::size_t, 3> octant = {static_cast<std::size_t>(o & 1),
                                               static_cast<std::size_t>((o >> 1) & 1),
                                               static_cast<std::size_t>((o >> 2) & 1)};
    if (depth < 2 || !top.is_split(0, o)) {
      if (inner == 0) cells.fill(octant, 1, top.blocks[0][o]);
      return;
    }
    const std::size_t block = top.child(0, o);
    const TreeLevel& second = tree.levels[1];
    const std::array<std::size_t, 3> cell = {
        2 * octant[0] + static_cast<std::size_t>(inner & 1),
        2 * octant[1] + static_cast<std::size_t>((inner >> 1) & 1),
        2 * octant[2] + static_cast<std::size_t>((inner >> 2) & 1)};
    if (depth > 2 && second.is_split(block, inner)) {
      cells.fill_block(2, second.child(block, inner), cell);
    } else {
      cells.fill(cell, 2, second.blocks[block][inner]);
    }
  });
  return values;
}

}  // namespace prefilter
