// SPDX-License-Identifier: GPL-3.0-or-later

// Divides x and y into cells, fits a plane to each, and counts cells with a single sheet, two
// sheets, or a wall.
#include "prefilter/points/height_field.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/base/cancel_check.h"
#include "prefilter/points/normals/sampled_positions.h"

namespace prefilter {
namespace {

constexpr std::size_t kMinHeightPoints = 100;
constexpr std::size_t kMaxHeightPoints = std::size_t{1} << 20;
constexpr double kPointsPerCell = 16.0;
constexpr std::size_t kMinPointsInCell = 6;
// Minimum number of cells per side.
constexpr double kMinCellsPerSide = 3.0;
// Largest fraction of points in cells without a single sheet, and smallest fraction in cells with
// enough points.
constexpr double kMaxOtherShare = 0.3;
constexpr double kMinClassifiedShare = 0.5;
// Number of cell sizes, each twice the last: noise thicker than fine cells looks like walls.
constexpr int kScales = 3;
// Standard deviation from a cell's plane, in cell sides. Below kMinLayeredDeviation it is a rough
// single sheet: two sheets 0.7 sides apart deviate by 0.35. Above kMinWallDeviation it is a wall.
constexpr double kMinLayeredDeviation = 0.35;
constexpr double kMinWallDeviation = 1.0;
// Fraction of the variance that two heights explain: 3/4 for a uniform wall, 2/3 for noise, all of
// it for two sheets.
constexpr double kMinTwoSheetShare = 0.85;

// A point with the key of its cell.
struct KeyedPoint {
  std::uint64_t key;
  Vector3 point;

  bool operator<(const KeyedPoint& other) const {
    return key != other.key ? key < other.key : point < other.point;
  }
};

// Range of the middle 98 % of values.
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

// Sorted distances along z from the least-squares plane over x and y, in cell sides.
std::vector<double> heights_over_plane(std::span<const KeyedPoint> cell, double side) {
  const auto count = static_cast<double>(cell.size());
  std::vector<Vector3> offsets;
  Vector3 mean{};
  for (const KeyedPoint& keyed_point : cell) {
    // Relative to a point of the cell, so that offsets are neither large nor tiny.
    Vector3 offset = keyed_point.point - cell.front().point;
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

// Largest fraction of the variance of sorted values of mean 0 that lies between two groups of them.
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

// Numbers of points in cells of one size, by what their cell looks like.
struct CellCounts {
  std::size_t classified = 0;
  std::size_t layered = 0;
  std::size_t steep = 0;
};

void classify_cell(std::span<const KeyedPoint> cell, double side, CellCounts* counts) {
  if (cell.size() < kMinPointsInCell) return;
  counts->classified += cell.size();
  const std::vector<double> heights = heights_over_plane(cell, side);
  double squares = 0.0;
  for (const double height : heights) squares += height * height;
  const double deviation = std::sqrt(squares / static_cast<double>(cell.size()));
  if (deviation > kMinLayeredDeviation && share_between_two(heights, squares) > kMinTwoSheetShare) {
    counts->layered += cell.size();
  } else if (deviation > kMinWallDeviation) {
    counts->steep += cell.size();
  }
}

CellCounts classify_cells(std::span<const Vector3> points, const Range& x, const Range& y,
                          double side, CancelCheck* cancel_check) {
  const auto index = [side](double value, const Range& range) {
    // Far outliers are counted in the border cells.
    const double last = std::floor(range.size / side) + 2.0;
    return static_cast<std::uint64_t>(
        std::clamp(std::floor((value - range.low) / side) + 1.0, 0.0, last));
  };
  std::vector<KeyedPoint> keyed;
  keyed.reserve(points.size());
  for (const Vector3& p : points) keyed.push_back({index(p[0], x) << 32U | index(p[1], y), p});
  std::sort(keyed.begin(), keyed.end());
  CellCounts counts;
  for (std::size_t begin = 0, end = 0; begin < keyed.size(); begin = end) {
    while (end < keyed.size() && keyed[end].key == keyed[begin].key) ++end;
    for (std::size_t i = begin; i < end; ++i) cancel_check->step();
    classify_cell(std::span(keyed).subspan(begin, end - begin), side, &counts);
  }
  return counts;
}

}  // namespace

bool is_height_field(std::span<const Vector3> all, const Run& run) {
  const std::vector<Vector3> points = sample_positions(all, kMaxHeightPoints);
  if (points.size() < kMinHeightPoints) return false;
  const Range x = range_along(points, 0);
  const Range y = range_along(points, 1);
  const auto count = static_cast<double>(points.size());
  double side = std::sqrt(x.size / count) * std::sqrt(kPointsPerCell * y.size);
  CancelCheck cancel_check(run);
  for (int scale = 0; scale < kScales; ++scale, side *= 2.0) {
    if (!(side > 0.0 && kMinCellsPerSide * side <= std::min(x.size, y.size))) return false;
    const CellCounts counts = classify_cells(points, x, y, side, &cancel_check);
    const auto classified = static_cast<double>(counts.classified);
    if (classified < kMinClassifiedShare * count) continue;
    if (static_cast<double>(counts.layered) > kMaxOtherShare * classified) return false;
    if (static_cast<double>(counts.layered + counts.steep) <= kMaxOtherShare * classified)
      return true;
  }
  return false;
}

}  // namespace prefilter
