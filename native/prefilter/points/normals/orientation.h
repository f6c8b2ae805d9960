// SPDX-License-Identifier: GPL-3.0-or-later

// Which of its two directions each normal of a cloud of points has.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/points/normals.h"

namespace prefilter {

/// How surely two near normals have the same direction, from -1 to 1: the mean of what holds on a
/// plane, where they are parallel, and on a circle through both, where they are mirror images (Xie
/// et al. 2003). Where these contradict each other, as across a thin sheet, it is near 0.
double agreement(const Vector3& a, const Vector3& b, const Vector3& offset);

/// Points, and which of them are near each other.
struct LinkedPoints {
  std::span<const Vector3> positions;  // no two the same; fewer than 2^31
  std::span<const double> areas;       // of the surface around each point, in any unit
  std::size_t degree = 0;
  // `degree` points near each point, which may be the point itself.
  std::span<const std::uint32_t> links;
};

/// Reverses normals, 1 long or zero, so that those of near points agree, and those of each
/// connected part point outward as a whole; or so that each points up that is not nearly level, and
/// those that are agree with near points. Throws Error(kCancelled).
void orient_normals(const LinkedPoints& points, NormalSide side, const Progress& progress,
                    int threads, std::vector<Vector3>* normals);

}  // namespace prefilter
