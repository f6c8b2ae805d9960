// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/height_field.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/base/cancel_check.h"
#include "prefilter/points/normals/some_points.h"

namespace prefilter {
namespace {

constexpr std::size_t kLeastPoints = 100;
constexpr std::size_t kMostPoints = std::size_t{1} << 20;
constexpr double kPointsPerCell = 16.0;
constexpr std::size_t kLeastInCell = 6;
// Cells per side, at the least: fewer say little about a shape.
constexpr double kLeastCells = 3.0;
// Of the points: in cells that hold no single sheet, at the most, and in cells that tell.
constexpr double kMostElsewhere = 0.3;
constexpr double kLeastTold = 0.5;
// Noise is thicker than fine cells are wide, and looks like a wall in them.
constexpr int kScales = 3;
// Deviations from the plane of a cell, in sides of it: what is less is a rough sheet; two sheets
// that are as far apart as 0.7 sides deviate by half of that. More is steep: a wall.
constexpr double kRough = 0.35;
constexpr double kSteep = 1.0;
// The share of the variance that two heights instead of one leave out: 3/4 for a wall, which is
// even, 2/3 for noise, all of it for two sheets.
constexpr double kTwoSheets = 0.85;

// A point in the cell that its key names.
struct Placed {
  std::uint64_t key;
  Vector3 point;

  bool operator<(const Placed& other) const {
    return key != other.key ? key < other.key : point < other.point;
  }
};

// Where the middle 98 % of values begin, and how far they reach.
struct Range {
  double low = 0.0;
  double size = 0.0;
};

Range range_along(std::span<const Vector3> points, std::size_t axis) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const Vector3& p : points) values.push_back(p[axis]);
  const auto at = [&](std::size_t rank) {
    const auto place = values.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(values.begin(), place, values.end());
    return *place;
  };
  const std::size_t edge = points.size() / 100;
  const double low = at(edge);
  return {low, at(points.size() - 1 - edge) - low};
}

// Heights above the plane that fits points best, as z over x and y, in sides of the cell, from
// least to most.
std::vector<double> heights_over_plane(std::span<const Placed> cell, double side) {
  const auto count = static_cast<double>(cell.size());
  std::vector<Vector3> offsets;
  Vector3 mean{};
  for (const Placed& one : cell) {
    // From a point of the cell: neither far away nor tiny.
    Vector3 offset = one.point - cell.front().point;
    for (double& x : offset) x /= side;
    offsets.push_back(offset);
    mean = mean + (1.0 / count) * offset;
  }
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  double xz = 0.0;
  double yz = 0.0;
  for (Vector3& offset : offsets) {
    offset = offset - mean;
    const auto& [x, y, z] = offset;
    xx += x * x;
    xy += x * y;
    yy += y * y;
    xz += x * z;
    yz += y * z;
  }
  const double determinant = xx * yy - xy * xy;
  const bool is_plane = determinant > 1e-6 * xx * yy;
  const double along_x = is_plane ? (xz * yy - yz * xy) / determinant : 0.0;
  const double along_y = is_plane ? (yz * xx - xz * xy) / determinant : 0.0;
  std::vector<double> heights;
  for (const Vector3& offset : offsets) {
    heights.push_back(offset[2] - along_x * offset[0] - along_y * offset[1]);
  }
  std::sort(heights.begin(), heights.end());
  return heights;
}

// The share of the variance of sorted values of mean zero that is between two groups of them, at
// the most.
double share_between_two(std::span<const double> values, double squares) {
  const auto count = static_cast<double>(values.size());
  double sum = 0.0;
  double best = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    sum += values[i - 1];
    const auto low = static_cast<double>(i);
    best = std::max(best, sum * sum * count / (low * (count - low)));
  }
  return best / squares;
}

// What the cells of one size say of the points in them.
struct CellFindings {
  std::size_t told = 0;
  std::size_t layered = 0;
  std::size_t steep = 0;
};

void look_at_cell(std::span<const Placed> cell, double side, CellFindings* found) {
  if (cell.size() < kLeastInCell) return;
  found->told += cell.size();
  const std::vector<double> heights = heights_over_plane(cell, side);
  double squares = 0.0;
  for (const double height : heights) squares += height * height;
  const double deviation = std::sqrt(squares / static_cast<double>(cell.size()));
  if (deviation > kRough && share_between_two(heights, squares) > kTwoSheets) {
    found->layered += cell.size();
  } else if (deviation > kSteep) {
    found->steep += cell.size();
  }
}

CellFindings look_at_cells(std::span<const Vector3> points, const Range& x, const Range& y,
                           double side, CancelCheck* cancel_check) {
  const auto index = [side](double value, const Range& range) {
    // What is far outside is in the cells of the border.
    const double last = std::floor(range.size / side) + 2.0;
    return static_cast<std::uint64_t>(
        std::clamp(std::floor((value - range.low) / side) + 1.0, 0.0, last));
  };
  std::vector<Placed> placed;
  placed.reserve(points.size());
  for (const Vector3& p : points) placed.push_back({index(p[0], x) << 32U | index(p[1], y), p});
  std::sort(placed.begin(), placed.end());
  CellFindings found;
  for (std::size_t begin = 0, end = 0; begin < placed.size(); begin = end) {
    while (end < placed.size() && placed[end].key == placed[begin].key) ++end;
    for (std::size_t i = begin; i < end; ++i) cancel_check->step();
    look_at_cell(std::span(placed).subspan(begin, end - begin), side, &found);
  }
  return found;
}

}  // namespace

bool is_height_field(std::span<const Vector3> all, const Progress& progress) {
  const std::vector<Vector3> points = some_points(all, kMostPoints);
  if (points.size() < kLeastPoints) return false;
  const Range x = range_along(points, 0);
  const Range y = range_along(points, 1);
  const auto count = static_cast<double>(points.size());
  double side = std::sqrt(x.size / count) * std::sqrt(kPointsPerCell * y.size);
  CancelCheck cancel_check(progress);
  for (int scale = 0; scale < kScales; ++scale, side *= 2.0) {
    if (!(side > 0.0 && kLeastCells * side <= std::min(x.size, y.size))) return false;
    const CellFindings found = look_at_cells(points, x, y, side, &cancel_check);
    const auto told = static_cast<double>(found.told);
    if (told < kLeastTold * count) continue;
    if (static_cast<double>(found.layered) > kMostElsewhere * told) return false;
    if (static_cast<double>(found.layered + found.steep) <= kMostElsewhere * told) return true;
  }
  return false;
}

}  // namespace prefilter
