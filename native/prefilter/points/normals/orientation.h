// SPDX-License-Identifier: GPL-3.0-or-later

// Consistent orientation of normals.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/points/normals.h"

namespace prefilter {

/// How certainly two neighboring normals have the same orientation, from -1 to 1. The mean of two
/// models: on a plane they are parallel, and on a circle through both points they are mirror images
/// (Xie et al. 2003). If the models contradict each other, as across a thin sheet, it is near 0.
double agreement(const Vector3& a, const Vector3& b, const Vector3& offset);

/// Points and their neighbors.
struct LinkedPoints {
  std::span<const Vector3> positions;  // distinct; fewer than 2^31
  std::span<const double> areas;       // of the surface around each point, in any unit
  std::size_t degree = 0;
  // `degree` neighbors of each point, which may include the point itself.
  std::span<const std::uint32_t> links;
};

/// Reverses normals, of length 1 or zero, so that neighbors agree. For kOutward, each connected
/// part points outward on the whole; for kUp, all normals that are not almost horizontal point up,
/// and the others agree with their neighbors. Throws Error(kCancelled).
void orient_normals(const LinkedPoints& points, NormalSide side, const Run& run,
                    std::vector<Vector3>* normals);

}  // namespace prefilter
