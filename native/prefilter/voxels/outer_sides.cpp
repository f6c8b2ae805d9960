// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/outer_sides.h"

#include <cmath>
#include <optional>

#include "prefilter/voxels/cube_keys.h"
#include "prefilter/voxels/inner_balls.h"

namespace prefilter {
namespace {

// distance from a surface, in cells, at which an empty cell proves that a point is outer
constexpr double kClearCells = 1.2;
// larger distances, tried if it is partly full
constexpr std::array<double, 3> kFartherCells = {2.1, 3.0, 3.9};
constexpr double kWindingRadii = 2.0;  // error radius of winding numbers compared with 1/2
constexpr double kMaxCubeSide = 4.0;

// A point near the center of the cube that contains `point`, offset to avoid axis-aligned planes.
Vector3 middle_of_cube(const Vector3& point, double side) {
  constexpr Vector3 kOff = {0.5 + 0.0271828, 0.5 - 0.0314159, 0.5 + 0.0141421};
  Vector3 middle;
  for (std::size_t a = 0; a < 3; ++a) {
    middle[a] = (std::floor(point[a] / side) + kOff[a]) * side;
  }
  return middle;
}

}  // namespace

bool OuterSides::may_be(const Vector3& point, const Vector3& normal) const {
  return occupancy_(point + kClearCells * normal) < 1.0F;
}

bool OuterSides::is_outer(const Vector3& point, const Vector3& normal) const {
  const float beyond = occupancy_(point + kClearCells * normal);
  if (beyond <= 0.0F || beyond >= 1.0F) return beyond <= 0.0F;
  const Vector3 start = point + kJustOutside * normal;
  for (const double far : kFartherCells) {
    const Vector3 end = point + far * normal;
    const float there = occupancy_(end);
    if (there > 0.0F && there < 1.0F) continue;
    const std::optional<double> excess = winding_.excess(start, end);
    if (!excess) continue;
    if (there <= 0.0F) return *excess <= 0.5;
    // A full cell may be inside several parts.
    if (*excess >= 0.0) return false;
  }
  return winding_at(start) <= 0.5;
}

double OuterSides::winding_at(const Vector3& point) const {
  const std::optional<double> excess = winding_.excess(point, middle_of_cube(point, 1.0));
  return excess ? winding_near(point, 1.0) + *excess : winding_.at(point, kWindingRadii);
}

double OuterSides::winding_near(const Vector3& point, double side) const {
  const std::uint64_t key = cube_key(point, side);
  const auto level = static_cast<std::size_t>(std::ilogb(side));
  Known& known = known_[level][(key * 0x9E3779B97F4A7C15U) >> 58U];
  {
    const std::lock_guard lock(known.mutex);
    const auto found = known.numbers.find(key);
    if (found != known.numbers.end()) return found->second;
  }
  const Vector3 middle = middle_of_cube(point, side);
  std::optional<double> excess;
  if (side < kMaxCubeSide) excess = winding_.excess(middle, middle_of_cube(middle, 2.0 * side));
  const double number =
      excess ? winding_near(middle, 2.0 * side) + *excess : winding_.at(middle, kWindingRadii);
  const std::lock_guard lock(known.mutex);
  known.numbers.emplace(key, number);
  return number;
}

}  // namespace prefilter
