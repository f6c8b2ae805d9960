// SPDX-License-Identifier: GPL-3.0-or-later

// Rotations and translations.
#pragma once

#include <array>
#include <cstddef>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// A motion of points: p becomes the scalar products of the rows with p, plus the shift.
struct RigidMotion {
  std::array<Vector3, 3> rows = {Vector3{1.0, 0.0, 0.0}, Vector3{0.0, 1.0, 0.0},
                                 Vector3{0.0, 0.0, 1.0}};
  Vector3 shift{};
};

/// Rotates a direction.
inline Vector3 turned(const RigidMotion& motion, const Vector3& direction) {
  return {dot(motion.rows[0], direction), dot(motion.rows[1], direction),
          dot(motion.rows[2], direction)};
}

/// Transforms a point.
inline Vector3 moved(const RigidMotion& motion, const Vector3& point) {
  return turned(motion, point) + motion.shift;
}

/// Transforms a point by the inverse motion.
inline Vector3 moved_back(const RigidMotion& motion, const Vector3& point) {
  const Vector3 offset = point - motion.shift;
  Vector3 result{};
  for (std::size_t r = 0; r < 3; ++r) result = result + offset[r] * motion.rows[r];
  return result;
}

/// The composition of two motions.
inline RigidMotion then(const RigidMotion& first, const RigidMotion& second) {
  RigidMotion result;
  for (std::size_t r = 0; r < 3; ++r) {
    result.rows[r] = {};
    for (std::size_t k = 0; k < 3; ++k) {
      result.rows[r] = result.rows[r] + second.rows[r][k] * first.rows[k];
    }
  }
  result.shift = moved(second, first.shift);
  return result;
}

}  // namespace prefilter
