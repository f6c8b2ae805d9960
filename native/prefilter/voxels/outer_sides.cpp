// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/outer_sides.h"

#include <cmath>
#include <optional>

#include "prefilter/voxels/cube_keys.h"
#include "prefilter/voxels/inner_balls.h"

namespace prefilter {
namespace {

constexpr double kClear = 1.2;  // from a surface, in cells: what is empty there is outside
constexpr std::array<double, 3> kFarther = {2.1, 3.0, 3.9};  // likewise, where it is not
constexpr double kFarRadii = 2.0;  // of winding numbers that are compared with a half
constexpr double kLargestCube = 4.0;

// A point near the middle of the cube that holds one: off planes that cells have.
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
  return occupancy_(point + kClear * normal) < 1.0F;
}

bool OuterSides::is_outer(const Vector3& point, const Vector3& normal) const {
  const float beyond = occupancy_(point + kClear * normal);
  if (beyond <= 0.0F || beyond >= 1.0F) return beyond <= 0.0F;
  const Vector3 start = point + kJustOutside * normal;
  for (const double far : kFarther) {
    const Vector3 end = point + far * normal;
    const float there = occupancy_(end);
    if (there > 0.0F && there < 1.0F) continue;
    const std::optional<double> excess = winding_.excess(start, end);
    if (!excess) continue;
    if (there <= 0.0F) return *excess <= 0.5;
    // What is full is within one part, or several.
    if (*excess >= 0.0) return false;
  }
  return winding_at(start) <= 0.5;
}

double OuterSides::winding_at(const Vector3& point) const {
  const std::optional<double> excess = winding_.excess(point, middle_of_cube(point, 1.0));
  return excess ? winding_near(point, 1.0) + *excess : winding_.at(point, kFarRadii);
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
  if (side < kLargestCube) excess = winding_.excess(middle, middle_of_cube(middle, 2.0 * side));
  const double number =
      excess ? winding_near(middle, 2.0 * side) + *excess : winding_.at(middle, kFarRadii);
  const std::lock_guard lock(known.mutex);
  known.numbers.emplace(key, number);
  return number;
}

}  // namespace prefilter
